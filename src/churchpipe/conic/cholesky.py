"""Sparse Cholesky factorisation of many matrices with one pattern. The order is found on the graph of blocks.

Small ones are CHOLMOD's, which knows one thread only; large ones are shared out to threads (`multifrontal`).
"""

from importlib.util import find_spec

import numpy as np
import scipy.sparse as sp
from cvxopt import amd, cholmod, matrix, spmatrix

from churchpipe.conic.multifrontal import Multifrontal
from churchpipe.model.arrays import FloatArray, IntArray

# From about so many rows on a factor no longer fits the cache. `multifrontal` then wins more in the solves, of which each
# factorisation is followed by several, than it loses itself.
_LARGE = 12_000


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
        self._engine = Multifrontal(pattern, order) if n >= _LARGE else _Cholmod(rows, columns, order)

    def factor(self, values: FloatArray) -> None:
        """Factorise the matrix with these nonzeros, in the order of the pattern.

        Raises
        ------
        NotDefiniteError
        """
        self._engine.take(values)
        self.factor_again()

    def factor_again(self) -> None:
        """Factorise the last matrix once more, as a benchmark does."""
        try:
            self._engine.factor()
        except ArithmeticError as error:
            raise NotDefiniteError(f"at column {error.args[0]}") from error

    def solve(self, right: FloatArray) -> FloatArray:
        """Return N^-1 right, right (n,) or (n, k)."""
        return self._engine.solve(right)

    def nonzeros(self) -> int:
        """Number of stored entries of the factor."""
        return self._engine.nonzeros()


class _Cholmod:
    """Supernodal factor by CHOLMOD of a lower triangle with entries at these rows and columns."""

    def __init__(self, rows: IntArray, columns: IntArray, order: IntArray) -> None:
        self._matrix = spmatrix(1.0, rows, columns, (len(order), len(order)))
        self._factor = cholmod.symbolic(self._matrix, p=matrix(order))

    def take(self, values: FloatArray) -> None:
        self._matrix.V = matrix(values)

    def factor(self) -> None:
        cholmod.numeric(self._matrix, self._factor)

    def solve(self, right: FloatArray) -> FloatArray:
        solved = matrix(np.asfortranarray(right))
        cholmod.solve(self._factor, solved)
        return np.array(solved).reshape(right.shape)

    def nonzeros(self) -> int:
        return len(cholmod.getfactor(self._factor))


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
    entry = sp.coo_matrix(graph)
    return np.array(amd.order(spmatrix(1.0, entry.row, entry.col, graph.shape))).ravel().astype(np.int64)
