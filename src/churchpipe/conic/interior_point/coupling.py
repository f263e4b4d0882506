"""The coupling of local problems: a dense block for every local problem and every block of rows that it touches."""

from functools import lru_cache
from typing import NamedTuple, Protocol

import numba
import numpy as np
import scipy.sparse as sp

from churchpipe.model.arrays import BoolArray, FloatArray, IntArray


class _Product(Protocol):
    def __call__(
        self, pointer: IntArray, blocks: IntArray, values: FloatArray, factor: FloatArray, out: FloatArray, /
    ) -> None: ...


class _Kernels(NamedTuple):
    couple: _Product
    spread: _Product


class Coupling:
    """A matrix B (m, dimension * count), columns component first, rows in blocks of `block`.

    Local problem k touches blocks[pointer[k] : pointer[k + 1]] (ascending); values_sij (touches, dimension, block) are its parts.
    """

    def __init__(self, matrix: sp.csr_matrix[np.float64], dimension: int, block: int) -> None:
        """matrix (m, dimension * count), m a multiple of `block`."""
        rows, columns = matrix.shape
        self.rows, self.dimension, self.block = rows, dimension, block
        self.count = columns // dimension
        entry = sp.coo_matrix(matrix)
        component, local = np.divmod(entry.col.astype(np.int64), max(self.count, 1))
        row_block, within = np.divmod(entry.row.astype(np.int64), block)
        touched = sp.csc_matrix((np.ones(len(local)), (row_block, local)), shape=(rows // block, self.count))
        touched.sort_indices()
        self.pointer: IntArray = touched.indptr.astype(np.int64)
        self.blocks: IntArray = touched.indices.astype(np.int64)
        keys = np.repeat(np.arange(self.count), np.diff(self.pointer)) * (rows // block) + self.blocks
        touch = np.searchsorted(keys, local * (rows // block) + row_block)
        self.values: FloatArray = np.zeros((len(self.blocks), dimension, block))
        self.values[touch, component, within] = entry.data
        self._kernels = _kernels(dimension, block)

    def masked(self, active: BoolArray) -> "Coupling":
        """Return the coupling without the columns that are not active (dimension, count), in the same pattern."""
        if active.all():
            return self
        out = object.__new__(Coupling)
        out.__dict__.update(self.__dict__)
        out.values = self.values * active.T[np.repeat(np.arange(self.count), np.diff(self.pointer)), :, None]
        return out

    def largest_entries(self) -> FloatArray:
        """Return the largest entry of each row (m,), 1 for rows without any."""
        out = np.zeros((self.rows // self.block, self.block))
        np.maximum.at(out, self.blocks, np.abs(self.values).max(axis=1))
        return np.where(out > 0, out, 1.0).ravel()

    def smallest(self, unit: FloatArray) -> FloatArray:
        """Return the smallest over the blocks that a local problem touches of the largest unit (m,) in each block (count,)."""
        out = np.full(self.count, np.inf)
        np.minimum.at(
            out, np.repeat(np.arange(self.count), np.diff(self.pointer)), unit.reshape(-1, self.block).max(axis=1)[self.blocks]
        )
        return np.where(np.isfinite(out), out, 1.0)

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

    def couple(self, x: FloatArray) -> FloatArray:
        """Return B x."""
        out = np.zeros(self.rows)
        self._kernels.couple(self.pointer, self.blocks, self.values, x, out)
        return out

    def spread(self, y: FloatArray) -> FloatArray:
        """Return B^T y."""
        out = np.empty(self.dimension * self.count)
        self._kernels.spread(self.pointer, self.blocks, self.values, y, out)
        return out


@lru_cache
def _kernels(dimension: int, block: int) -> _Kernels:
    """Compile the products for one size of block: loops of known length are three times as fast."""

    @numba.njit(cache=True, fastmath={"reassoc", "contract"})
    def couple(pointer: IntArray, blocks: IntArray, values: FloatArray, x: FloatArray, out: FloatArray) -> None:
        count = len(pointer) - 1
        for k in range(count):
            for touch in range(pointer[k], pointer[k + 1]):
                first = block * blocks[touch]
                for j in range(block):
                    total = 0.0
                    for i in range(dimension):
                        total += values[touch, i, j] * x[i * count + k]
                    out[first + j] += total

    @numba.njit(cache=True, fastmath={"reassoc", "contract"})
    def spread(pointer: IntArray, blocks: IntArray, values: FloatArray, y: FloatArray, out: FloatArray) -> None:
        count = len(pointer) - 1
        for k in range(count):
            for i in range(dimension):
                total = 0.0
                for touch in range(pointer[k], pointer[k + 1]):
                    first = block * blocks[touch]
                    for j in range(block):
                        total += values[touch, i, j] * y[first + j]
                out[i * count + k] = total

    return _Kernels(couple, spread)
