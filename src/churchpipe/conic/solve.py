"""Choose a solver by name."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial
from typing import NamedTuple, Protocol, TypeAlias

import numpy as np

from churchpipe.conic.polish import restore_balance
from churchpipe.conic.program import ConeProgram, ConeSolution, WarmStart
from churchpipe.conic.wrenches import Balance
from churchpipe.errors import InputError
from churchpipe.model.arguments import text

# Forces whose imbalance exceeds this share of the largest load are no solution.
_OUT_OF_BALANCE = 1e-5
Proves: TypeAlias = Callable[[ConeSolution], bool]
# Is called with the share of a solve that is done.
SolveProgress: TypeAlias = Callable[[float], None]


class _Wanted(NamedTuple):
    """What is asked of a solver beside the program, as in `Solve`."""

    duality_gap: float | None = None
    progress: SolveProgress | None = None
    near: WarmStart | None = None
    velocities: bool = False


_Solver: TypeAlias = Callable[[ConeProgram, _Wanted], ConeSolution]


class Solve(Protocol):
    """Solves programs of one balance."""

    def __call__(
        self,
        program: ConeProgram,
        /,
        *,
        duality_gap: float | None = None,
        proves: Proves | None = None,
        progress: SolveProgress | None = None,
        near: WarmStart | None = None,
        velocities: bool = False,
    ) -> ConeSolution:
        """Solve a program; the forces of what is called solved balance to rounding (`restore_balance`).

        duality_gap: relative error of the objective that will do, for solvers that can stop early. Where it is given, the forces
        and velocities matter too: of all optimal ones the most central are wanted. proves: whether an answer proves what it
        claims; where one does not, a solver that has a fallback turns to it. progress: called with the share done, by our own
        solver after each iteration. near: where a solver may begin. velocities: whether the multipliers alone are wanted; then
        the forces need not balance.
        """
        ...


SOLVERS = ("auto", "interior-point", "clarabel", "cvxpy", "cvxpy:NAME")


def solver_for(balance: Balance, name: str = "auto") -> Solve:
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

        return _in_turn(_whole(partial(solve_cvxpy, solver=backend or "CLARABEL")))
    if name in ("clarabel", "auto"):
        from churchpipe.conic.clarabel import solve_clarabel

        reference = _whole(solve_clarabel)
        return _in_turn(reference) if name == "clarabel" else _in_turn(_interior_point(balance), reference)
    if name == "interior-point":
        return _in_turn(_interior_point(balance))
    raise InputError("solver", "unknown solver", found=name, expected=", ".join(SOLVERS))


def solve(program: ConeProgram, name: str = "auto") -> ConeSolution:
    """Solve one cone program; names as in `solver_for`."""
    return solver_for(program.balance, name)(program)


def _in_turn(*solvers: _Solver) -> Solve:
    """Return the solver that tries these one after another, until a solution is found and proves what it should."""

    def solve(
        program: ConeProgram,
        /,
        *,
        duality_gap: float | None = None,
        proves: Proves | None = None,
        progress: SolveProgress | None = None,
        near: WarmStart | None = None,
        velocities: bool = False,
    ) -> ConeSolution:
        wanted = _Wanted(duality_gap, progress, near, velocities)
        *others, last = solvers
        failures: list[str] = []
        spent = 0
        for solver in others:
            answer = _checked(program, solver(program, wanted), wanted, proving=proves is not None)
            spent += answer.iterations
            # One that stops short of its own tolerance may have proved enough: what counts are its arrays.
            if answer.outcome != "failed" if proves is None else proves(answer):
                return replace(answer, iterations=spent)
            why = answer.message if answer.outcome == "failed" else "its answer proves nothing"
            failures.append(f"{answer.solver} failed ({why})")
        answer = _checked(program, last(program, wanted), wanted, proving=proves is not None)
        said = f"{answer.solver}: {answer.message}" if failures else answer.message
        return replace(answer, iterations=spent + answer.iterations, message="; ".join([*failures, said]))

    return solve


def _interior_point(balance: Balance) -> _Solver:
    """Return our own solver, which stops as early as it may."""
    from churchpipe.conic.interior_point import InteriorPointSolver
    from churchpipe.conic.interior_point.info import as_share
    from churchpipe.conic.interior_point.settings import CENTRAL, VELOCITIES, Settings, with_duality_gap

    # Made when it is first asked: its symbolic analysis takes as long as an iteration or two.
    solver = cache(partial(InteriorPointSolver, balance))

    def solve(program: ConeProgram, wanted: _Wanted) -> ConeSolution:
        central = VELOCITIES if wanted.velocities else CENTRAL
        settings = Settings() if wanted.duality_gap is None else with_duality_gap(central, wanted.duality_gap)
        report = as_share(wanted.progress, settings.duality_gap, settings.residual)
        return solver().solve(program, settings, report, wanted.near)

    return solve


def _whole(solve: Callable[[ConeProgram], ConeSolution]) -> _Solver:
    """Return a solver that never stops early."""

    def whole(program: ConeProgram, _: _Wanted) -> ConeSolution:
        return solve(program)

    return whole


def _checked(program: ConeProgram, answer: ConeSolution, wanted: _Wanted, *, proving: bool) -> ConeSolution:
    """Accept a solver's status only when its forces balance. Some report an infeasible program as solved, with huge numbers.

    proving: whether forces of a solver that failed are brought into balance as well. They may prove what it did not claim.
    """
    worth = ("solved", "failed") if proving else ("solved",)
    if answer.outcome not in worth or (wanted.velocities and np.isfinite(answer.y).all()):
        return answer
    residual = program.imbalance(answer.x, answer.tau)
    if not residual <= _OUT_OF_BALANCE:
        if answer.outcome == "failed":
            return answer
        return replace(answer, outcome="failed", message=f"forces out of balance by {residual:.1e} after {answer.message}")
    x, tau = restore_balance(program, answer.x, answer.tau)
    return replace(answer, x=x, tau=tau)
