"""The limit analysis of a shell stated in cvxpy, as close to the formulas as it can be written."""

from typing import Any

import cvxpy
import numpy as np

from churchpipe.homogenised_shell.program import ShellProgram

# Its functions are only partly typed.
cp: Any = cvxpy


def reference_load_factor(program: ShellProgram, solver: str = "CLARABEL", **options: Any) -> float:
    """Return the largest tau of a shell's program by any conic solver that cvxpy knows; NaN unless solved to optimality."""
    tau, x = cp.Variable(), cp.Variable(program.stress_of.shape[1])
    stress = program.offset + program.stress_of @ x
    constraints: list[Any] = [program.equilibrium @ stress == program.dead + tau * program.live]
    if program.still.shape[0]:
        constraints.append(program.still @ x == 0)
    if len(program.limit):
        constraints.append(program.planes @ x <= program.limit)
    if len(program.friction):
        force = cp.reshape(x[: 3 * len(program.friction)], (len(program.friction), 3), order="C")
        constraints.append(cp.norm(force[:, 1:], axis=1) <= cp.multiply(program.friction, force[:, 0]))
    if np.isfinite(program.cap):
        constraints.append(tau <= program.cap)
    problem = cp.Problem(cp.Maximize(tau), constraints)
    problem.solve(solver=solver, **options)
    return float(tau.value) if problem.status == "optimal" else np.nan
