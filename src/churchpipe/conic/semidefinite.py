"""Solve with one positive semidefinite sparse matrix, as large as a building."""

from collections.abc import Callable

import numpy as np
import scipy.sparse as sp

from churchpipe.conic.cholesky import Cholesky, NotDefiniteError
from churchpipe.model.arrays import FloatArray

# Rows of the balance of one rigid body.
BLOCK = 6


def semidefinite_solver(matrix: sp.csc_matrix[np.float64]) -> Callable[[FloatArray], FloatArray]:
    """Return the function right (n,) -> solution (n,) of a positive semidefinite matrix (n, n).

    The matrix is scaled to a unit diagonal, and gets as little on it as its Cholesky factor needs in double precision: the
    answer is exact only up to that, so refine it where it matters.

    Raises
    ------
    NotDefiniteError: not even 1e-6 on the diagonal is enough.
    """
    scale = np.sqrt(np.maximum(matrix.diagonal(), 1e-300))
    lower = sp.csc_matrix(sp.tril(sp.diags(1 / scale) @ matrix @ sp.diags(1 / scale) + sp.identity(len(scale))))
    lower.sort_indices()
    # A row without any entry keeps a unit diagonal; the others lose the one that held their place in the pattern.
    diagonal = lower.indptr[:-1]
    present = matrix.diagonal() > 0
    cholesky = Cholesky(lower, BLOCK)
    for extra in (1e-14, 1e-13, 1e-12, 1e-11, 1e-10, 1e-8, 1e-6):
        values = lower.data.copy()
        values[diagonal] -= np.where(present, 1.0 - extra, 0.0)
        try:
            cholesky.factor(values)
        except NotDefiniteError:
            continue
        return lambda right: cholesky.solve(right / scale) / scale
    raise NotDefiniteError("not positive semidefinite")
