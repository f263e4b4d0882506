"""Limit analysis of a shell by Clarabel, with all stresses as variables: the reference for meshes of a few thousand facets."""

import clarabel
import numpy as np
import scipy.sparse as sp

from churchpipe.conic.interior_point.cones import cone_shape
from churchpipe.conic.interior_point.iterate import Iterate
from churchpipe.conic.interior_point.nonnegative import Nonnegative
from churchpipe.conic.interior_point.problem import CoupledProblem
from churchpipe.conic.program import Outcome
from churchpipe.model.arrays import IntArray

_OUTCOMES: dict[str, Outcome] = {"Solved": "solved", "DualInfeasible": "unbounded", "PrimalInfeasible": "infeasible"}
# With a smaller regularisation Clarabel ends "almost solved" for quadratic membranes.
_SETTINGS = {"verbose": False, "max_threads": 1, "max_iter": 300, "static_regularization_constant": 1e-7}


def solve_directly(problem: CoupledProblem, matrix: sp.csr_matrix[np.float64]) -> tuple[Iterate, Outcome, int, str]:
    """Return the solution of a linear problem, its outcome, the number of iterations and Clarabel's status.

    "Almost solved" counts as failed. matrix: G of all local problems, rows in the order of the cones.
    """
    columns, rows = problem.local.dimension * problem.local.count, problem.rows
    order, kinds = _order(problem)
    stacked = sp.vstack(
        [sp.hstack([problem.coupling.matrix(), sp.csr_matrix(problem.growth[:, None])]), _with_load(problem, matrix)[order]]
    )
    right = np.concatenate([-problem.constant, problem.right[order]])
    settings = clarabel.DefaultSettings()
    for key, value in _SETTINGS.items():
        setattr(settings, key, value)
    cost = np.append(problem.linear, -problem.reward)
    solver = clarabel.DefaultSolver(
        sp.csc_matrix((columns + 1, columns + 1)),
        cost,
        sp.csc_matrix(stacked),
        right,
        [clarabel.ZeroConeT(rows), *kinds],
        settings,
    )
    found = solver.solve()
    x, z = np.asarray(found.x), np.asarray(found.z)
    multipliers = np.empty(len(order))
    multipliers[order] = z[rows:]
    s = problem.right - problem.constrain(x[:-1], float(x[-1]))
    status = str(found.status)
    at = Iterate(x[:-1], float(x[-1]), z[:rows], s, multipliers, 1.0, 0.0)
    return at, _OUTCOMES.get(status, "failed"), int(found.iterations), status


def _with_load(problem: CoupledProblem, matrix: sp.csr_matrix[np.float64]) -> sp.csr_matrix[np.float64]:
    """Return the rows of the cones in x and the load, the last that of the cap."""
    width = matrix.shape[1]
    wide = sp.csr_matrix((matrix.data, matrix.indices, matrix.indptr), shape=(matrix.shape[0], width + 1))
    if not problem.capped:
        return wide
    return sp.csr_matrix(sp.vstack([wide, sp.csr_matrix(([1.0], ([0], [width])), shape=(1, width + 1))]))


def _order(problem: CoupledProblem) -> "tuple[IntArray, list[clarabel.Cone]]":
    """Return the rows as Clarabel takes them, cone by cone, and the cones."""
    rows: list[IntArray] = []
    kinds: list[clarabel.Cone] = []
    start = 0
    for cone in problem.cone.cones:
        size = cone.rows * cone.count
        mine = start + np.arange(size)
        start += size
        if isinstance(cone, Nonnegative):
            rows.append(mine)
            kinds.append(clarabel.NonnegativeConeT(size))
        else:
            rows.append(np.moveaxis(mine.reshape(cone_shape(cone)), 0, 2).ravel())
            kinds += [clarabel.SecondOrderConeT(cone.dimension)] * cone.degree
    return np.concatenate(rows), kinds
