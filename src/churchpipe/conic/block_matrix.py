"""Square matrices B S B^T of one pattern, S not symmetric, kept as dense blocks of the rows of two bodies."""

import numba
import numpy as np

from churchpipe.conic.interior_point.coupling import Coupling
from churchpipe.conic.wrenches import BODY
from churchpipe.model.arrays import FloatArray, IntArray


class BlockPattern:
    """Which blocks of rows meet in a local problem, and where the blocks of each pair of them are kept; found once."""

    def __init__(self, coupling: Coupling) -> None:
        count = coupling.rows // BODY
        width = np.diff(coupling.pointer)
        # All pairs (row, column) of the touches of each local problem, row by row.
        pairs = width**2
        local = np.repeat(np.arange(coupling.count), pairs)
        rank = np.arange(len(local)) - np.repeat(np.cumsum(pairs) - pairs, pairs)
        start, wide = coupling.pointer[:-1][local], width[local]
        key = coupling.blocks[start + rank // wide] * count + coupling.blocks[start + rank % wide]
        kept, place = np.unique(key, return_inverse=True)
        self.place: IntArray = place.ravel().astype(np.int64)
        self.columns: IntArray = kept % count
        self.rows: IntArray = np.searchsorted(kept // count, np.arange(count + 1)).astype(np.int64)
        self.coupling = coupling


class BlockMatrix:
    """B S B^T as blocks (k, 6, 6), for products with vectors. They cost a third of those with B^T, S and B one after another."""

    def __init__(self, pattern: BlockPattern, inner: FloatArray) -> None:
        """inner: S_ijk (3, 3, count), entry i, j of local problem k."""
        self._pattern = pattern
        self._values = np.zeros((len(pattern.columns), BODY, BODY))
        coupling = pattern.coupling
        _assemble(coupling.pointer, coupling.values, inner, pattern.place, self._values)

    def times(self, y: FloatArray) -> FloatArray:
        """Return the matrix times y (rows,)."""
        out = np.empty_like(y)
        _times(self._pattern.rows, self._pattern.columns, self._values, y, out)
        return out

    def transposed_times(self, y: FloatArray) -> FloatArray:
        """Return the transposed matrix times y (rows,)."""
        out = np.zeros_like(y)
        _transposed_times(self._pattern.rows, self._pattern.columns, self._values, y, out)
        return out


@numba.njit(cache=True, fastmath={"reassoc", "contract"})
def _assemble(pointer: IntArray, coupled: FloatArray, inner: FloatArray, place: IntArray, out: FloatArray) -> None:
    """Add B_p S B_q^T of each pair p, q of the touches of each local problem to its block; coupled_sij: B^T of touch s."""
    flexed = np.empty((3, BODY))
    pair = 0
    for k in range(len(pointer) - 1):
        start, width = pointer[k], pointer[k + 1] - pointer[k]
        for q in range(width):
            for a in range(3):
                for c in range(BODY):
                    flexed[a, c] = (
                        inner[a, 0, k] * coupled[start + q, 0, c]
                        + inner[a, 1, k] * coupled[start + q, 1, c]
                        + inner[a, 2, k] * coupled[start + q, 2, c]
                    )
            for p in range(width):
                block = out[place[pair + p * width + q]]
                for r in range(BODY):
                    x, y, z = coupled[start + p, 0, r], coupled[start + p, 1, r], coupled[start + p, 2, r]
                    for c in range(BODY):
                        block[r, c] += x * flexed[0, c] + y * flexed[1, c] + z * flexed[2, c]
        pair += width * width


@numba.njit(cache=True, fastmath={"reassoc", "contract"})
def _times(rows: IntArray, columns: IntArray, values: FloatArray, y: FloatArray, out: FloatArray) -> None:
    total = np.empty(BODY)
    for i in range(len(rows) - 1):
        total[:] = 0.0
        for at in range(rows[i], rows[i + 1]):
            begin = BODY * columns[at]
            for r in range(BODY):
                for c in range(BODY):
                    total[r] += values[at, r, c] * y[begin + c]
        out[BODY * i : BODY * i + BODY] = total


@numba.njit(cache=True, fastmath={"reassoc", "contract"})
def _transposed_times(rows: IntArray, columns: IntArray, values: FloatArray, y: FloatArray, out: FloatArray) -> None:
    for i in range(len(rows) - 1):
        for at in range(rows[i], rows[i + 1]):
            begin = BODY * columns[at]
            for r in range(BODY):
                factor = y[BODY * i + r]
                for c in range(BODY):
                    out[begin + c] += values[at, r, c] * factor
