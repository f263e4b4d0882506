"""Solution of linear systems with a positive semidefinite sparse matrix of the size of a building."""

from collections.abc import Callable

import numpy as np
import scipy.sparse as sp

from churchpipe.conic.cholesky import Cholesky, NotDefiniteError
from churchpipe.conic.wrenches import BODY
from churchpipe.model.arrays import FloatArray


def semidefinite_solver(root: sp.csc_matrix[np.float64]) -> Callable[[FloatArray], FloatArray]:
    """Return the function right (n,) -> solution (n,) of the positive semidefinite matrix root root^T, root (n, k).

    The matrix is scaled to a unit diagonal, and gets as little on it as its Cholesky factor needs in double precision: the
    answer is exact only up to that, so refine it where it matters. Formed as a square it is semidefinite up to rounding
    relative to its diagonal, whatever the sizes of its entries: summed up otherwise, a row whose stiffness is tiny beside its
    terms has come out negative.

    Raises
    ------
    NotDefiniteError: not even 1e-6 on the diagonal is enough, as for entries that are not finite.
    """
    length = np.sqrt(np.asarray(root.multiply(root).sum(axis=1)).ravel())
    scale = np.where(length > 0, length, 1.0)
    unit = sp.csr_matrix(sp.diags(1.0 / scale) @ root)
    lower = sp.csc_matrix(sp.tril(unit @ unit.T + sp.identity(len(scale))))
    lower.sort_indices()
    # A row without any entry keeps a unit diagonal; the others lose the one that held their place in the pattern.
    diagonal = lower.indptr[:-1]
    cholesky = Cholesky(lower, BODY)
    for extra in (1e-14, 1e-13, 1e-12, 1e-11, 1e-10, 1e-8, 1e-6):
        values = lower.data.copy()
        values[diagonal] -= np.where(length > 0, 1.0 - extra, 0.0)
        try:
            cholesky.factor(values)
        except NotDefiniteError:
            continue
        return lambda right: cholesky.solve(right / scale) / scale
    raise NotDefiniteError("not positive semidefinite")
