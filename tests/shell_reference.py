"""The limit analysis of a shell and a step of its capacity curve in cvxpy, written as close to the formulas as possible."""

from typing import Any

import cvxpy
import numpy as np
import scipy.sparse as sp

from churchpipe.homogenised_shell.program import ShellProgram
from churchpipe.model.arrays import FloatArray

# Its functions are only partly typed.
cp: Any = cvxpy


def reference_load_factor(program: ShellProgram, solver: str = "CLARABEL", **options: Any) -> float:
    """Return the largest tau of a shell's program by any conic solver that cvxpy knows; NaN unless solved to optimality."""
    tau, x = cp.Variable(), cp.Variable(program.stress_of.shape[1])
    stress = program.offset + program.stress_of @ x
    constraints: list[Any] = [program.equilibrium @ stress == program.dead + tau * program.live]
    constraints += _within_strength(program, x)
    if np.isfinite(program.cap):
        constraints.append(tau <= program.cap)
    problem = cp.Problem(cp.Maximize(tau), constraints)
    return float(tau.value) if _solved(problem, solver, options) else np.nan


def reference_step(
    program: ShellProgram,
    flexibility: FloatArray,
    before: FloatArray,
    displacement: float,
    solver: str = "CLARABEL",
    **options: Any,
) -> tuple[float, FloatArray]:
    """Return load factor and stresses (nq, 6) after a step of a pushover; NaN unless solved to optimality.

    flexibility_qab (nq, 6, 6): C^-1 times the area of each point; before (nq, 6): stresses, N/m and N; displacement: f_L . u
    per total weight that the step adds, m.
    """
    factor, x = cp.Variable(), cp.Variable(program.stress_of.shape[1])
    stress = program.offset + program.stress_of @ x
    # Energies over the weight and the displacement.
    unit = program.unit / np.sqrt(program.weight * displacement)
    root = np.swapaxes(np.linalg.cholesky(unit[:, :, None] * flexibility * unit[:, None, :]), 1, 2)
    nq = len(root)
    block = sp.bsr_matrix((root, np.arange(nq), np.arange(nq + 1)), shape=(6 * nq, 6 * nq))
    constraints: list[Any] = [program.equilibrium @ stress == program.dead + factor * program.live]
    constraints += _within_strength(program, x)
    change = block @ (stress - (before / program.unit).ravel())
    problem = cp.Problem(cp.Minimize(0.5 * cp.sum_squares(change) - factor), constraints)
    if not _solved(problem, solver, options):
        return np.nan, np.full_like(before, np.nan)
    return float(factor.value), np.asarray(stress.value).reshape(-1, 6) * program.unit


def _within_strength(program: ShellProgram, x: Any) -> list[Any]:
    constraints: list[Any] = []
    if program.still.shape[0]:
        constraints.append(program.still @ x == 0)
    if len(program.limit):
        constraints.append(program.planes @ x <= program.limit)
    if len(program.friction):
        force = cp.reshape(x[: 3 * len(program.friction)], (len(program.friction), 3), order="C")
        constraints.append(cp.norm(force[:, 1:], axis=1) <= cp.multiply(program.friction, force[:, 0]))
    return constraints


def _solved(problem: Any, solver: str, options: dict[str, Any]) -> bool:
    try:
        problem.solve(solver=solver, **options)
    except cp.SolverError:
        return False
    return problem.status == "optimal"
