"""Products with matrices of rigid bodies, sum_k B_k S_k B_k^T, whose blocks S_k need not be symmetric.

Where such a matrix is multiplied many times, its blocks of two bodies are a fifth of the work of all points between them.
"""

from dataclasses import dataclass

import numba
import numpy as np

from churchpipe.conic.interior_point.normal import NormalMatrix
from churchpipe.conic.wrenches import BODY
from churchpipe.model.arrays import FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class BodyMatrix:
    """A matrix (6 nf, 6 nf) of blocks of two bodies.

    pointer (nf + 1,): where the blocks of each body's rows start; columns (blocks,): the other body; values_kcr (blocks, 6, 6):
    entry in column c and row r of block k.
    """

    pointer: IntArray
    columns: IntArray
    values: FloatArray

    def times(self, y: FloatArray) -> FloatArray:
        """Return M y (6 nf,)."""
        out = np.empty_like(y)
        _times(self.pointer, self.columns, self.values, y, out)
        return out

    def transposed_times(self, y: FloatArray) -> FloatArray:
        """Return M^T y (6 nf,)."""
        out = np.zeros_like(y)
        _transposed_times(self.pointer, self.columns, self.values, y, out)
        return out


class BodyMatrices:
    """The pattern that all such matrices of one structure have in common."""

    def __init__(self, normal: NormalMatrix) -> None:
        self._normal = normal
        pattern = normal.pattern
        column, row = np.repeat(np.arange(pattern.shape[1]), np.diff(pattern.indptr)), pattern.indices.astype(np.int64)
        entry, bodies = np.arange(len(row)), pattern.shape[0] // BODY
        # The lower triangle has column >= row; the upper one is that of the transposed matrix, whose values follow.
        strictly = row > column
        rows, columns = np.append(row, column[strictly]), np.append(column, row[strictly])
        taken = np.append(entry, len(entry) + entry[strictly])
        blocks, number = np.unique(rows // BODY * bodies + columns // BODY, return_inverse=True)
        self._taken = np.empty((len(blocks), BODY, BODY), dtype=np.int64)
        self._taken[number, columns % BODY, rows % BODY] = taken
        self._pointer = np.searchsorted(blocks, bodies * np.arange(bodies + 1)).astype(np.int64)
        self._columns = (blocks % bodies).astype(np.int64)

    def matrix(self, compliance: FloatArray) -> BodyMatrix:
        """Return the matrix of blocks S (3, 3, nc) of the points."""
        upper = self._normal.assemble(np.ascontiguousarray(compliance))
        return self._made(self._normal.assemble(np.ascontiguousarray(compliance.transpose(1, 0, 2))), upper)

    def symmetric(self, lower: FloatArray) -> BodyMatrix:
        """Return the matrix with these nonzeros of its lower triangle, in the order of the pattern."""
        return self._made(lower, lower)

    def _made(self, lower: FloatArray, upper: FloatArray) -> BodyMatrix:
        return BodyMatrix(self._pointer, self._columns, np.concatenate([lower, upper])[self._taken])


@numba.njit(cache=True, fastmath={"reassoc", "contract"})
def _times(pointer: IntArray, columns: IntArray, values: FloatArray, y: FloatArray, out: FloatArray) -> None:
    for body in range(len(pointer) - 1):
        sums = out[6 * body : 6 * body + 6]
        sums[:] = 0.0
        for k in range(pointer[body], pointer[body + 1]):
            first = 6 * columns[k]
            for c in range(6):
                other, block = y[first + c], values[k, c]
                for r in range(6):
                    sums[r] += block[r] * other


@numba.njit(cache=True, fastmath={"reassoc", "contract"})
def _transposed_times(pointer: IntArray, columns: IntArray, values: FloatArray, y: FloatArray, out: FloatArray) -> None:
    for body in range(len(pointer) - 1):
        own = y[6 * body : 6 * body + 6]
        for k in range(pointer[body], pointer[body + 1]):
            first = 6 * columns[k]
            for c in range(6):
                block, value = values[k, c], 0.0
                for r in range(6):
                    value += block[r] * own[r]
                out[first + c] += value
