"""Choose a solver by name."""

from dataclasses import replace

import numpy as np

from churchpipe.conic.program import ConeProgram, ConeSolution
from churchpipe.errors import InputError

SOLVERS = ("auto", "clarabel", "cvxpy", "cvxpy:NAME")


def solve(program: ConeProgram, solver: str = "auto") -> ConeSolution:
    """Solve a cone program.

    solver: "auto" or "clarabel"; "cvxpy" or "cvxpy:NAME" with any conic solver that cvxpy knows ("cvxpy:MOSEK").
    """
    name, _, backend = solver.partition(":")
    if name in ("auto", "clarabel") and not backend:
        from churchpipe.conic.clarabel import solve_clarabel

        return _checked(program, solve_clarabel(program))
    if name == "cvxpy":
        from churchpipe.conic.cvxpy import solve_cvxpy

        return _checked(program, solve_cvxpy(program, backend or "CLARABEL"))
    raise InputError("solver", "unknown solver", found=solver, expected=", ".join(SOLVERS))


def _checked(program: ConeProgram, answer: ConeSolution) -> ConeSolution:
    """Take a solver's word only when its forces balance: some call an infeasible program solved, with huge numbers."""
    if answer.outcome != "solved":
        return answer
    residual = np.abs(program.balance @ answer.x.ravel() + program.constant + answer.tau * program.growth)
    size = max(float(np.abs(program.constant).max()), float(np.abs(program.growth).max()))
    if np.isfinite(residual).all() and residual.max() <= 1e-5 * size:
        return answer
    return replace(answer, outcome="failed", message=f"forces out of balance by {residual.max():.1e} after {answer.message}")
