"""Choose a solver by name."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Protocol

import numpy as np
import scipy.sparse as sp

from churchpipe.conic.program import ConeProgram, ConeSolution
from churchpipe.errors import InputError
from churchpipe.model.arguments import text


class Solve(Protocol):
    """Solves programs of one balance."""

    def __call__(self, program: ConeProgram, /, *, error: float | None = None) -> ConeSolution:
        """Solve a program.

        error: relative error of the objective that will do, for solvers that can stop early. Where it is given, the forces and
        velocities matter too: of all optimal ones the most central are wanted.
        """
        ...


SOLVERS = ("auto", "interior-point", "clarabel", "cvxpy", "cvxpy:NAME")


def solver_for(balance: sp.csc_matrix[np.float64], name: str = "auto") -> Solve:
    """Return a solver of the cone programs that share a balance (m, 3c).

    name: "interior-point" (our own: one symbolic analysis serves all programs), "clarabel", "cvxpy" or "cvxpy:NAME" with any
    conic solver that cvxpy knows ("cvxpy:MOSEK"); "auto": our own, and Clarabel where that fails.

    Raises
    ------
    InputError: a name that is not one of these.
    """
    family, _, backend = text("solver", name).partition(":")
    if family == "cvxpy":
        from churchpipe.conic.cvxpy import solve_cvxpy

        return _checked(_whole(partial(solve_cvxpy, solver=backend or "CLARABEL")))
    if name == "clarabel":
        from churchpipe.conic.clarabel import solve_clarabel

        return _checked(_whole(solve_clarabel))
    if name in ("auto", "interior-point"):
        own = _checked_own(balance)
        return own if name == "interior-point" else _with_fallback(own, solver_for(balance, "clarabel"))
    raise InputError("solver", "unknown solver", found=name, expected=", ".join(SOLVERS))


def solve(program: ConeProgram, name: str = "auto") -> ConeSolution:
    """Solve one cone program; names as in `solver_for`."""
    return solver_for(program.balance, name)(program)


def _with_fallback(first: Solve, second: Solve) -> Solve:
    def solve(program: ConeProgram, /, *, error: float | None = None) -> ConeSolution:
        answer = first(program, error=error)
        if answer.outcome != "failed":
            return answer
        other = second(program, error=error)
        return replace(other, message=f"{answer.solver} failed ({answer.message}); {other.solver}: {other.message}")

    return solve


def _checked_own(balance: sp.csc_matrix[np.float64]) -> Solve:
    """Return our own solver, which stops as early as it may."""
    from churchpipe.conic.interior_point import InteriorPointSolver
    from churchpipe.conic.interior_point.settings import CENTRAL

    own = InteriorPointSolver(balance)

    def solve(program: ConeProgram, error: float | None) -> ConeSolution:
        return own.solve(program, None if error is None else replace(CENTRAL, error=error))

    return _checked(solve)


def _whole(solve: Callable[[ConeProgram], ConeSolution]) -> Callable[[ConeProgram, float | None], ConeSolution]:
    """Return a solver that never stops early."""

    def whole(program: ConeProgram, _: float | None) -> ConeSolution:
        return solve(program)

    return whole


def _checked(solve: Callable[[ConeProgram, float | None], ConeSolution]) -> Solve:
    """Take a solver's word only when its forces balance: some call an infeasible program solved, with huge numbers."""

    def checked(program: ConeProgram, /, *, error: float | None = None) -> ConeSolution:
        answer = solve(program, error)
        if answer.outcome != "solved":
            return answer
        residual = np.abs(program.balance @ answer.x.ravel() + program.constant + answer.tau * program.growth)
        size = max(float(np.abs(program.constant).max()), float(np.abs(program.growth).max()))
        if np.isfinite(residual).all() and residual.max() <= 1e-5 * size:
            return answer
        return replace(answer, outcome="failed", message=f"forces out of balance by {residual.max():.1e} after {answer.message}")

    return checked
