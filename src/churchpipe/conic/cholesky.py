"""Sparse Cholesky factorisation of many matrices with one pattern. The order is found on the graph of blocks."""

from importlib.util import find_spec

import numpy as np
import scipy.sparse as sp

from churchpipe.conic.multifrontal import Multifrontal
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
        order = _block_order(rows, columns, n, block)
        self._fronts = Multifrontal(pattern, order)

    def factor(self, values: FloatArray) -> None:
        """Factorise the matrix with these nonzeros, in the order of the pattern.

        Raises
        ------
        NotDefiniteError
        """
        self._fronts.take(values)
        self.factor_again()

    def factor_again(self) -> None:
        """Factorise the last matrix once more, as a benchmark does."""
        try:
            self._fronts.factor()
        except ArithmeticError as error:
            raise NotDefiniteError(f"at column {error.args[0]}") from error

    def solve(self, right: FloatArray) -> FloatArray:
        """Return N^-1 right, right (n,) or (n, k)."""
        return self._fronts.solve(right)

    def nonzeros(self) -> int:
        """Number of stored entries of the factor."""
        return self._fronts.nonzeros()


def _block_order(rows: IntArray, columns: IntArray, n: int, block: int) -> IntArray:
    """Return an order of the rows with little fill: nested dissection of the block graph where METIS is installed, else AMD."""
    count = -(-n // block)
    graph = sp.csr_matrix((np.ones(len(rows)), (rows // block, columns // block)), shape=(count, count))
    order = _dissection(graph) if find_spec("pymetis") else _minimum_degree(graph)
    full = (block * order[:, None] + np.arange(block)).ravel()
    return full[full < n].astype(np.int64)


def _dissection(graph: sp.csr_matrix[np.float64]) -> IntArray:
    import pymetis

    both = sp.csr_matrix(graph + graph.T)
    both.setdiag(0.0)
    both.eliminate_zeros()
    order = pymetis.nested_dissection(pymetis.CSRAdjacency(both.indptr, both.indices))
    return np.asarray(order[0], dtype=np.int64)


def _minimum_degree(graph: sp.csr_matrix[np.float64]) -> IntArray:
    from cvxopt import amd, spmatrix

    entry = sp.coo_matrix(graph)
    return np.array(amd.order(spmatrix(1.0, entry.row, entry.col, graph.shape))).ravel().astype(np.int64)
