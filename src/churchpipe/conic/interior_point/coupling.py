"""The coupling of local problems: a dense block for every local problem and every block of rows that it touches."""

from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple, TypeAlias

import numba
import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

from churchpipe.conic.interior_point.division import Division, divided
from churchpipe.conic.threads import bounds_of, in_shares, shares_of
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray

_Indices: TypeAlias = npt.NDArray[np.int32] | npt.NDArray[np.int64]
_Entries: TypeAlias = tuple[_Indices, _Indices, FloatArray]


class _Kernels(NamedTuple):
    couple: Callable[..., None]
    spread: Callable[..., None]


class Touches(NamedTuple):
    """The parts of a matrix B (rows, dimension * count) by local problem and by block of rows.

    Local problem k touches blocks[pointer[k] : pointer[k + 1]] (ascending); values_sij (touches, dimension, block) are its parts.
    """

    rows: int
    pointer: IntArray
    blocks: IntArray
    values: FloatArray


def touches(matrix: sp.csc_matrix[np.float64], dimension: int, block: int, *, by_point: bool = False) -> Touches:
    """Return the parts of a matrix (m, dimension * count), its columns component first, or `by_point`, all of a point together.

    Rows are added to fill the last block.
    """
    rows, columns = matrix.shape
    count = columns // dimension
    columnwise = sp.csc_matrix(matrix)
    steps = (1, dimension) if by_point else (count, 1)
    entries = (columnwise.indptr, columnwise.indices, columnwise.data)
    pointer: IntArray = np.zeros(count + 1, dtype=np.int64)
    _count_touches(entries, dimension, block, steps, pointer)
    np.cumsum(pointer, out=pointer)
    blocks: IntArray = np.empty(int(pointer[-1]), dtype=np.int64)
    values: FloatArray = np.zeros((len(blocks), dimension, block))
    _fill_touches(entries, dimension, block, steps, pointer, blocks, values)
    return Touches(-(-rows // block) * block, pointer, blocks, values)


class Coupling:
    """A matrix B (m, dimension * count), columns component first, rows in blocks of `block`, kept as its `Touches`."""

    def __init__(self, parts: Touches) -> None:
        self.rows, self.pointer, self.blocks, self.values = parts
        _, self.dimension, self.block = self.values.shape
        self.count = len(self.pointer) - 1
        self._kernels = _kernels(self.dimension, self.block)
        self._division: Division | None = None

    def masked(self, active: BoolArray) -> "Coupling":
        """Return the coupling without the columns that are not active (dimension, count), in the same pattern."""
        if active.all():
            return self
        values = self.values * active.T[np.repeat(np.arange(self.count), np.diff(self.pointer)), :, None]
        return Coupling(Touches(self.rows, self.pointer, self.blocks, values))

    def largest_entries(self) -> FloatArray:
        """Return the largest entry of each row (m,), 1 for rows without any."""
        out = np.zeros((self.rows // self.block, self.block))
        np.maximum.at(out, self.blocks, np.abs(self.values).max(axis=1))
        return np.where(out > 0, out, 1.0).ravel()

    def touched_units(self, unit: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the smallest and the largest, over the blocks that a local problem touches, of the largest unit (m,) in each.

        Both (count,), 1 for a local problem that touches none.
        """
        low, high = np.full(self.count, np.inf), np.zeros(self.count)
        local = np.repeat(np.arange(self.count), np.diff(self.pointer))
        touched = unit.reshape(-1, self.block).max(axis=1)[self.blocks]
        np.minimum.at(low, local, touched)
        np.maximum.at(high, local, touched)
        return np.where(np.isfinite(low), low, 1.0), np.where(high > 0, high, 1.0)

    def passing(self, x: FloatArray) -> FloatArray:
        """Return the largest |x| among the local problems that touch the block of each row (m,)."""
        size = np.abs(x.reshape(self.dimension, self.count)).max(axis=0)
        out = np.zeros(self.rows // self.block)
        np.maximum.at(out, self.blocks, np.repeat(size, np.diff(self.pointer)))
        return np.repeat(out, self.block)

    def touched_rows(self) -> BoolArray:
        """Return which rows have an entry (m,)."""
        out = np.zeros((self.rows // self.block, self.block), dtype=np.bool_)
        np.logical_or.at(out, self.blocks, (self.values != 0.0).any(axis=1))
        return out.ravel()

    def matrix(self) -> sp.csr_matrix[np.float64]:
        """Return B (m, dimension * count), for solvers that take matrices."""
        touch, i, j = np.nonzero(self.values)
        local = np.repeat(np.arange(self.count), np.diff(self.pointer))[touch]
        place = (self.block * self.blocks[touch] + j, i * self.count + local)
        return sp.csr_matrix((self.values[touch, i, j], place), shape=(self.rows, self.dimension * self.count))

    def couple(self, x: FloatArray) -> FloatArray:
        """Return B x."""
        shares = shares_of(self.count)
        if self._division is None or self._division.shares != shares:
            self._division = divided(self.pointer[:-1], np.diff(self.pointer), self.blocks, self.rows // self.block, shares)
        out = np.zeros(self.rows)
        in_shares(self._kernels.couple, self.count, *self._division, self.pointer, self.blocks, self.values, x, out)
        return out

    def spread(self, y: FloatArray) -> FloatArray:
        """Return B^T y."""
        out = np.empty(self.dimension * self.count)
        in_shares(self._kernels.spread, self.count, self.pointer, self.blocks, self.values, y, out)
        return out


@lru_cache
def _kernels(dimension: int, block: int) -> _Kernels:
    """Compile the products for one size of block: loops of known length are three times as fast."""

    @numba.njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
    def couple(
        share: int,
        _: int,
        members: IntArray,
        first: IntArray,
        owner: IntArray,
        pointer: IntArray,
        blocks: IntArray,
        values: FloatArray,
        x: FloatArray,
        out: FloatArray,
    ) -> None:
        count = len(pointer) - 1
        own = np.empty(dimension)
        for member in range(first[share], first[share + 1]):
            k = members[member]
            for i in range(dimension):
                own[i] = x[i * count + k]
            for touch in range(pointer[k], pointer[k + 1]):
                if owner[blocks[touch]] != share:
                    continue
                begin = block * blocks[touch]
                for j in range(block):
                    total = 0.0
                    for i in range(dimension):
                        total += values[touch, i, j] * own[i]
                    out[begin + j] += total

    @numba.njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
    def spread(
        share: int, shares: int, pointer: IntArray, blocks: IntArray, values: FloatArray, y: FloatArray, out: FloatArray
    ) -> None:
        count = len(pointer) - 1
        total = np.empty(dimension)
        begin, end = bounds_of(count, share, shares)
        for k in range(begin, end):
            total[:] = 0.0
            for touch in range(pointer[k], pointer[k + 1]):
                first = block * blocks[touch]
                for i in range(dimension):
                    for j in range(block):
                        total[i] += values[touch, i, j] * y[first + j]
            for i in range(dimension):
                out[i * count + k] = total[i]

    return _Kernels(couple, spread)


@numba.njit(cache=True)
def _touched(entries: _Entries, dimension: int, block: int, steps: tuple[int, int], k: int, found: IntArray) -> int:
    """Write the blocks that local problem k touches into `found`, ascending, and return how many."""
    pointer, rows, _ = entries
    count = 0
    for i in range(dimension):
        column = i * steps[0] + k * steps[1]
        for at in range(pointer[column], pointer[column + 1]):
            touch = rows[at] // block
            place = count
            while place > 0 and found[place - 1] > touch:
                place -= 1
            if place > 0 and found[place - 1] == touch:
                continue
            for move in range(count, place, -1):
                found[move] = found[move - 1]
            found[place] = touch
            count += 1
    return count


@numba.njit(cache=True)
def _widest(pointer: _Indices, dimension: int, steps: tuple[int, int], count: int) -> int:
    most = 0
    for k in range(count):
        total = 0
        for i in range(dimension):
            column = i * steps[0] + k * steps[1]
            total += pointer[column + 1] - pointer[column]
        most = max(most, total)
    return most


@numba.njit(cache=True)
def _count_touches(entries: _Entries, dimension: int, block: int, steps: tuple[int, int], out: IntArray) -> None:
    found = np.empty(_widest(entries[0], dimension, steps, len(out) - 1), dtype=np.int64)
    for k in range(len(out) - 1):
        out[k + 1] = _touched(entries, dimension, block, steps, k, found)


@numba.njit(cache=True)
def _fill_touches(
    entries: _Entries,
    dimension: int,
    block: int,
    steps: tuple[int, int],
    pointer: IntArray,
    blocks: IntArray,
    values: FloatArray,
) -> None:
    found = np.empty(_widest(entries[0], dimension, steps, len(pointer) - 1), dtype=np.int64)
    for k in range(len(pointer) - 1):
        count = _touched(entries, dimension, block, steps, k, found)
        blocks[pointer[k] : pointer[k + 1]] = found[:count]
        for i in range(dimension):
            column = i * steps[0] + k * steps[1]
            for at in range(entries[0][column], entries[0][column + 1]):
                touch = pointer[k]
                while blocks[touch] != entries[1][at] // block:
                    touch += 1
                values[touch, i, entries[1][at] % block] += entries[2][at]
