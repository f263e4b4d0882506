"""Limit analysis of rigid blocks: eqs. (1)-(2), dead load first, every result certified."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from time import perf_counter
from typing import Literal

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

from churchpipe.conic.polish import restore_balance
from churchpipe.conic.program import ConeProgram, ConeSolution
from churchpipe.conic.solve import Solve, solver_for
from churchpipe.errors import InputError
from churchpipe.model.arguments import check_kind, listed
from churchpipe.model.arrays import FloatArray, array_of
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.model.loads import LoadCase
from churchpipe.model.results import LimitState, Status
from churchpipe.rigid_blocks.certificate import FLOW_TOLERANCE, Certificate, Strength, certify, project_cone
from churchpipe.rigid_blocks.equilibrium import Equilibrium, equilibrium
from churchpipe.rigid_blocks.iterations import GAP_TOLERANCE
from churchpipe.rigid_blocks.sliding import Method, SlidingOptions, Start, sliding_analysis

Progress = Callable[[str, float], None]
Flow = Literal["associative", "non-associative"]
# Dead load that is carried but for this share is carried.
_CARRIED = 1e-6


def limit_analysis(
    stones: Assemblage,
    contacts: Contacts,
    load: LoadCase,
    friction: npt.ArrayLike = 0.6,
    cohesion: npt.ArrayLike = 0.0,
    *,
    flow: Flow = "associative",
    method: Method = "default",
    start: Start | Sequence[Start] | None = None,
    solver: str = "auto",
    gap_tolerance: float = GAP_TOLERANCE,
    progress: Progress | None = None,
) -> LimitState:
    """Return the collapse load factor of an assemblage and its mechanism.

    Parameters
    ----------
    friction: coefficient, scalar or one an interface (ni,). cohesion: Pa, scalar or (ni,).
    flow: "associative" (sliding dilates, eq. (1)) or "non-associative" (no dilatancy, by iteration, eq. (3)).
    method, start (one or several), gap_tolerance: of the non-associative iteration, see `sliding.SlidingOptions`.
    solver: "auto" (our own interior point, Clarabel where that fails), "interior-point", "clarabel", "cvxpy", "cvxpy:MOSEK" ...
    progress: called with a text and the share done.

    Returns
    -------
    LimitState: status "unstable" when dead load alone brings the structure down (velocities: how it falls), "unbounded"
    when no lateral load of this kind does, "failed" when no certified answer was found.

    Raises
    ------
    InputError: arguments out of range, stones without a path to a support.
    """
    for name, value, kind in (("stones", stones, Assemblage), ("contacts", contacts, Contacts), ("load", load, LoadCase)):
        check_kind(f"limit_analysis: {name}", value, kind)
    if flow not in ("associative", "non-associative"):
        raise InputError("limit_analysis: flow", "unknown flow rule", found=flow, expected='"associative" or "non-associative"')
    starts: list[Start] = [start] if isinstance(start, str) else []
    if not starts and start is not None:
        starts = listed("limit_analysis: start", start, str)
    options = SlidingOptions(method, tuple(starts), gap_tolerance)
    begin = perf_counter()
    balance = equilibrium(stones, contacts, load)
    strength = point_strength(contacts, friction, cohesion, balance.force)
    _check_connected(stones, contacts, balance)
    if progress:
        progress("dead load", 0.0)
    solve = solver_for(balance.matrix, solver)
    standing, dead_answer = dead_load_analysis(balance, strength, solve)
    if standing == "failed" and solver == "auto":
        standing, dead_answer = dead_load_analysis(balance, strength, solver_for(balance.matrix, "clarabel"))
    if standing != "stable":
        return _fallen(balance, standing, dead_answer, flow, perf_counter() - begin)
    if progress:
        progress("associative", 0.1)
    state = associative_state(balance, strength, solve, begin)
    if state.status == "failed" and solver == "auto":
        state = associative_state(balance, strength, solver_for(balance.matrix, "clarabel"), begin)
    if flow == "associative" or state.status != "optimal":
        return replace(state, flow=flow)
    sliding = sliding_analysis(balance, strength, state, options, solve, progress)
    return replace(sliding, seconds=perf_counter() - begin)


def point_strength(contacts: Contacts, friction: npt.ArrayLike, cohesion: npt.ArrayLike, force: float) -> Strength:
    """Return friction and cohesion of each contact point; cohesion (Pa) acts on an equal share of the interface's area."""
    values: list[FloatArray] = []
    for name, value in (("friction", friction), ("cohesion", cohesion)):
        array = array_of(name, value, "iuf", "numbers").astype(np.float64)
        if array.ndim > 1 or (array.ndim == 1 and array.shape != contacts.area.shape):
            raise InputError(name, "wrong shape", found=array.shape, expected=f"a number or ({len(contacts.area)},)")
        if not np.isfinite(array).all() or (array < 0).any():
            bad = array[~(np.isfinite(array) & (array >= 0))].flat[0]
            raise InputError(name, "out of range", found=float(bad), expected="finite numbers >= 0")
        values.append(np.broadcast_to(array, contacts.area.shape))
    share = contacts.area / np.maximum(contacts.points_per_interface, 1)
    interface = contacts.interface_of_point
    return Strength(friction=values[0][interface], cohesion=(values[1] * share)[interface] / force)


def associative_program(balance: Equilibrium, strength: Strength) -> ConeProgram:
    """Return eqs. (1)-(2) as a cone program."""
    zero = np.zeros(len(strength.friction))
    return ConeProgram(balance.matrix, balance.dead, balance.live, strength.cohesion, strength.friction, zero, zero)


def dead_load_analysis(
    balance: Equilibrium, strength: Strength, solve: Solve
) -> tuple[Literal["stable", "unstable", "failed"], ConeSolution]:
    """Say whether the structure carries its dead load, with the forces that do or the mechanism that falls.

    The largest share tau <= 1 of the dead load that the contacts can carry is sought: always feasible, so the answer never
    hangs on a certificate of infeasibility. tau = 1: stable, when the forces prove it; tau < 1: unstable, when the multipliers
    do, the mechanism that falls; "failed" when neither.
    """
    zero = np.zeros(len(strength.friction))
    program = ConeProgram(
        balance.matrix, np.zeros_like(balance.dead), balance.dead, strength.cohesion, strength.friction, zero, zero, cap=1.0
    )
    answer = solve(program)
    if answer.outcome != "solved":
        return "failed", answer
    x, tau = restore_balance(program, answer.x, answer.tau)
    certificate = certify(replace(balance, dead=program.constant, live=program.growth), strength, x, tau, answer.y)
    if tau > 1 - _CARRIED and certificate.balanced:
        return "stable", answer
    if certificate.upper_bound < 1 - _CARRIED and certificate.flow_violation < FLOW_TOLERANCE:
        return "unstable", answer
    return "failed", replace(answer, message=f"share {tau:.6g} found, at most {certificate.upper_bound:.6g}; {answer.message}")


def associative_state(balance: Equilibrium, strength: Strength, solve: Solve, begin: float) -> LimitState:
    """Solve eqs. (1)-(2) and turn the answer into a certified result; `begin`: when the analysis began (perf_counter)."""
    program = associative_program(balance, strength)
    answer = solve(program)
    if answer.outcome == "solved":
        x, tau = restore_balance(program, answer.x, answer.tau)
        answer = replace(answer, x=x, tau=tau)
    seconds = perf_counter() - begin
    if answer.outcome == "unbounded":
        ray = project_cone(answer.x, Strength(strength.friction, np.zeros_like(strength.cohesion)))
        residual = float(np.abs(balance.matrix @ ray.ravel() + balance.live).max())
        if residual < 1e-6:
            return _state(
                balance, answer, "unbounded", np.inf, Certificate(np.inf, np.inf, residual, 0.0, residual, 0.0), seconds
            )
    if answer.outcome != "solved":
        return _state(balance, answer, "failed", np.nan, Certificate(*[np.nan] * 6), seconds)
    certificate = certify(balance, strength, answer.x, answer.tau, answer.y)
    status = "optimal" if certificate.holds else "failed"
    return _state(balance, answer, status, answer.tau if certificate.holds else np.nan, certificate, seconds)


def _check_connected(stones: Assemblage, contacts: Contacts, balance: Equilibrium) -> None:
    """Raise when a free stone has no contact at all or no path to a support: a solver would only say "infeasible"."""
    ones = np.ones(len(contacts.blocks))
    graph = sp.coo_matrix((ones, (contacts.blocks[:, 0], contacts.blocks[:, 1])), shape=(stones.count, stones.count))
    _, component = sp.csgraph.connected_components(graph, directed=False)
    loose = balance.free[~np.isin(component[balance.free], component[stones.fixed])]
    if len(loose):
        shown = ", ".join(stones.block_id[loose[:8]]) + (f" and {len(loose) - 8} more" if len(loose) > 8 else "")
        raise InputError(
            "stones",
            "no path of contacts to a support",
            found=shown,
            expected="every free stone connected to a fixed one",
            remedy="Fix a stone that rests on the ground, or close the gaps between stones (gap_tolerance).",
        )


def _fallen(
    balance: Equilibrium, standing: Literal["unstable", "failed"], answer: ConeSolution, flow: Flow, seconds: float
) -> LimitState:
    nothing = Certificate(*[np.nan] * 6)
    message = "the dead load alone brings it down" if standing == "unstable" else f"dead load not decided: {answer.message}"
    return _state(balance, answer, standing, np.nan, nothing, seconds, flow=flow, message=message)


def _state(
    balance: Equilibrium,
    answer: ConeSolution,
    status: Status,
    load_factor: float,
    certificate: Certificate,
    seconds: float,
    *,
    flow: Flow = "associative",
    message: str = "",
) -> LimitState:
    return LimitState(
        load_factor=load_factor,
        status=status,
        lower_bound=certificate.lower_bound,
        upper_bound=certificate.upper_bound,
        forces=answer.x * balance.force,
        velocities=balance.velocities(answer.y) if np.isfinite(answer.y).all() else np.zeros((balance.count, 6)),
        equilibrium_residual=certificate.equilibrium_residual,
        cone_violation=certificate.cone_violation,
        iterations=answer.iterations,
        seconds=seconds,
        solver=answer.solver,
        flow=flow,
        message=message or answer.message,
    )
