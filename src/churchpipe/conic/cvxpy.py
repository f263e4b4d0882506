"""The cone program in cvxpy, written as close to the formulas as possible: a reference, and the way to MOSEK and others."""

from time import perf_counter
from typing import Any

import cvxpy
import numpy as np

from churchpipe.conic.program import ConeProgram, ConeSolution, Outcome
from churchpipe.errors import InputError

# Its functions are only partly typed.
cp: Any = cvxpy

# Clarabel's own tolerances, 1e-8, leave velocities that miss the certificate's by a little.
_PRECISE = {"CLARABEL": dict.fromkeys(("tol_gap_abs", "tol_gap_rel", "tol_feas"), 1e-9) | {"equilibrate_enable": False}}
_OUTCOMES: dict[str, Outcome] = {"optimal": "solved", "infeasible": "infeasible", "unbounded": "unbounded"}


def solve_cvxpy(program: ConeProgram, solver: str = "CLARABEL", **options: Any) -> ConeSolution:
    """Solve a cone program through cvxpy with any installed conic solver ("CLARABEL", "MOSEK", "ECOS", "SCS").

    Certificates of infeasibility are not passed on by cvxpy: x and y are NaN then.
    """
    if solver not in cp.installed_solvers():
        raise InputError(f'solver "cvxpy:{solver}"', "not installed", expected=" or ".join(cp.installed_solvers()))
    begin = perf_counter()
    # Unknowns are in units of the largest load, so that a solver's absolute tolerances mean the same at every size.
    unit = program.force
    tau = cp.Variable()
    n = cp.Variable(program.points)
    t = cp.Variable((program.points, 2))
    normal, first, second = (program.matrix()[:, k::3] for k in range(3))
    balance = normal @ n + first @ t[:, 0] + second @ t[:, 1] + (program.constant + tau * program.growth) / unit == 0
    constraints: list[Any] = [
        balance,
        n >= 0,
        cp.norm(t, axis=1) <= program.limit / unit + cp.multiply(program.slope, n),
    ]
    bounded = np.flatnonzero(np.isfinite(program.bound))
    if len(bounded):
        constraints.append(n[bounded] <= program.bound[bounded] / unit)
    if np.isfinite(program.cap):
        constraints.append(tau <= program.cap)
    cost = (program.linear * unit) @ n + cp.sum(cp.multiply(program.quadratic * unit**2 / 2, cp.square(n)))
    problem = cp.Problem(cp.Maximize(tau - cost), constraints)
    try:
        problem.solve(solver=solver, **(_PRECISE.get(solver, {}) | options))
    except cp.SolverError as error:
        return _failure(program, perf_counter() - begin, solver, str(error))
    outcome = _OUTCOMES.get(str(problem.status), "failed")
    if n.value is None or t.value is None or tau.value is None or balance.dual_value is None:
        return _failure(program, perf_counter() - begin, solver, str(problem.status), outcome)
    return ConeSolution(
        x=np.column_stack([n.value, t.value]) * unit,
        tau=float(tau.value),
        y=np.asarray(balance.dual_value) / unit,
        outcome=outcome,
        iterations=int(getattr(problem.solver_stats, "num_iters", 0) or 0),
        seconds=perf_counter() - begin,
        solver=f"cvxpy:{solver}",
        message=str(problem.status),
    )


def _failure(program: ConeProgram, seconds: float, solver: str, message: str, outcome: Outcome = "failed") -> ConeSolution:
    return ConeSolution(
        x=np.full((program.points, 3), np.nan),
        tau=np.nan,
        y=np.full(len(program.constant), np.nan),
        outcome=outcome,
        iterations=0,
        seconds=seconds,
        solver=f"cvxpy:{solver}",
        message=message,
    )
