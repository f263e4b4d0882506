"""Sparse Cholesky of one pattern, many times: CHOLMOD, ordered on the graph of blocks."""

import numpy as np
import scipy.sparse as sp
from cvxopt import amd, cholmod, matrix, spmatrix

from churchpipe.model.arrays import FloatArray, IntArray


class NotDefiniteError(ArithmeticError):
    """The matrix has no Cholesky factor in double precision."""


class Cholesky:
    """Factor of matrices with one sparsity pattern: symbolic analysis once, then `factor(values)` and `solve`."""

    def __init__(self, pattern: sp.csc_matrix[np.float64], block: int) -> None:
        """Analyse a lower triangle (n, n) with sorted indices, whose rows come in blocks of `block`."""
        n = pattern.shape[0]
        columns = np.repeat(np.arange(n), np.diff(pattern.indptr))
        rows = np.asarray(pattern.indices, dtype=np.int64)
        self._matrix = spmatrix(1.0, rows, columns, (n, n))
        self._symbolic = cholmod.symbolic(self._matrix, p=matrix(_block_order(rows, columns, n, block)))
        self._factor = self._symbolic

    def factor(self, values: FloatArray) -> None:
        """Factorise the matrix with these nonzeros, in the order of the pattern.

        Raises
        ------
        NotDefiniteError
        """
        self._matrix.V = matrix(values)
        try:
            cholmod.numeric(self._matrix, self._factor)
        except ArithmeticError as error:
            raise NotDefiniteError(f"at column {error.args[0]}") from error

    def solve(self, right: FloatArray) -> FloatArray:
        """Return N^-1 right, right (n,) or (n, k)."""
        solved = matrix(np.asfortranarray(right))
        cholmod.solve(self._factor, solved)
        return np.array(solved).reshape(right.shape)

    def nonzeros(self) -> int:
        """Number of stored entries of the factor."""
        return len(cholmod.getfactor(self._factor))


def _block_order(rows: IntArray, columns: IntArray, n: int, block: int) -> IntArray:
    count = -(-n // block)
    graph = sp.coo_matrix((np.ones(len(rows)), (rows // block, columns // block)), shape=(count, count))
    graph = sp.coo_matrix(sp.csc_matrix(graph))
    order = np.array(amd.order(spmatrix(1.0, graph.row, graph.col, (count, count)))).ravel()
    full = (block * order[:, None] + np.arange(block)).ravel()
    return full[full < n].astype(np.int64)
