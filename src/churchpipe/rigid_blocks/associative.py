"""Associative limit analysis, eqs. (1)-(2), and the dead load before it: one cone program each, certified from its arrays."""

from dataclasses import replace
from time import perf_counter
from typing import Literal

import numpy as np

from churchpipe.conic.program import ConeProgram, ConeSolution
from churchpipe.conic.solve import Solve
from churchpipe.conic.wrenches import apply
from churchpipe.model.arrays import FloatArray
from churchpipe.model.names import Flow
from churchpipe.model.results import LimitState, Status
from churchpipe.rigid_blocks.certificate import FLOW_TOLERANCE, UNPROVED, Certificate, Strength, certify, kinematic_bound
from churchpipe.rigid_blocks.equilibrium import Equilibrium
from churchpipe.rigid_blocks.ties import point_forces

Standing = Literal["stable", "unstable", "failed"]
# Dead load that is carried but for this share is carried.
_CARRIED = 1e-6


def associative_program(balance: Equilibrium, strength: Strength) -> ConeProgram:
    """Return eqs. (1)-(2) as a cone program."""
    return balance.program(strength.cohesion, strength.friction, strength.bound)


def dead_load_analysis(balance: Equilibrium, strength: Strength, solve: Solve) -> tuple[Standing, ConeSolution]:
    """Say whether the structure carries its dead load, with the forces that do or the mechanism that falls."""
    share = _ShareOfLoad(balance, strength, balance.dead)
    answer = solve(share.program, proves=lambda answer: share.standing(answer) != "failed")
    standing = share.standing(answer)
    if standing == "failed":
        answer = replace(
            answer, message=f"share {answer.tau:.6g} of the dead load carried, neither all nor less; {answer.message}"
        )
    return standing, answer


class _ShareOfLoad:
    """The largest share tau <= 1 of a load that contacts and ties carry. It is always feasible, so no result depends on a ray."""

    def __init__(self, balance: Equilibrium, strength: Strength, load: FloatArray, weight: FloatArray | None = None) -> None:
        # What joints bear before they crush stays as it is.
        stones = np.arange(len(load)) < balance.rows
        self._alone = replace(balance, dead=np.where(stones, 0.0, balance.dead), live=np.where(stones, load, 0.0))
        self._strength, self._weight = strength, weight
        self.program = replace(associative_program(self._alone, strength), cap=1.0)

    def standing(self, answer: ConeSolution) -> Standing:
        """Say "stable" when the forces prove that all is carried, "unstable" when the multipliers, a mechanism, deny it."""
        if not _may_prove(answer):
            return "failed"
        certificate = certify(self._alone, self._strength, answer.x, answer.tau, answer.y, self._weight)
        if answer.tau > 1 - _CARRIED and certificate.balanced:
            return "stable"
        # Where stones overlap, the whole weight might press: a stone that weighs next to nothing falls so fast that its speed
        # alone is no measure of an overlap.
        most, violation = kinematic_bound(self._alone, self._strength, np.ones_like(answer.x[:, 0]), answer.y)
        return "unstable" if most < 1 - _CARRIED and violation < FLOW_TOLERANCE else "failed"


def _may_prove(answer: ConeSolution) -> bool:
    """Return whether the arrays of an answer may prove it, as those of a solver may that stops short of its own tolerance."""
    return answer.outcome in ("solved", "failed") and bool(np.isfinite(answer.x).all() and np.isfinite(answer.y).all())


def associative_state(balance: Equilibrium, strength: Strength, solve: Solve, begin: float) -> LimitState:
    """Solve eqs. (1)-(2) and turn the answer into a certified result; `begin`: when the analysis began (perf_counter)."""

    def certificate(answer: ConeSolution) -> Certificate:
        return certify(balance, strength, answer.x, answer.tau, answer.y) if _may_prove(answer) else UNPROVED

    answer = solve(
        associative_program(balance, strength),
        proves=lambda answer: answer.outcome == "unbounded" or certificate(answer).holds,
    )
    found = certificate(answer)
    if found.holds:
        return _state(balance, answer, "optimal", answer.tau, found, perf_counter() - begin)
    wedged = wedge(balance, strength, solve) if answer.outcome != "solved" else None
    seconds = perf_counter() - begin
    if wedged is not None:
        return unbounded_state(balance, wedged, seconds)
    lacks = "; ".join(found.lacks) if answer.outcome == "solved" else f"{answer.outcome}"
    return _state(balance, answer, "failed", np.nan, found, seconds, message=f"{lacks}; {answer.solver}: {answer.message}")


def wedge(balance: Equilibrium, strength: Strength, solve: Solve) -> ConeSolution | None:
    """Return forces within friction that balance the lateral load alone, so that it may grow for ever, or None."""
    # What is limited does not grow for ever: cohesion, ties, joints that crush.
    endless = replace(strength, cohesion=np.zeros_like(strength.cohesion), bound=np.where(strength.bounded, 0.0, np.inf))
    if strength.bounded.all():
        return None
    # Of stones that the load does not reach, rounding would be all of the load.
    share = _ShareOfLoad(replace(balance, dead=np.zeros_like(balance.dead)), endless, balance.live, balance.dead)
    answer = solve(share.program, proves=lambda answer: share.standing(answer) != "failed")
    return replace(answer, x=answer.x / answer.tau) if share.standing(answer) == "stable" else None


def unbounded_state(balance: Equilibrium, ray: ConeSolution, seconds: float, flow: Flow = "associative") -> LimitState:
    """Return the state of a structure that no lateral load of this kind brings down, with the forces that balance it."""
    residual = float(np.abs(apply(balance.balance, ray.x) + balance.live).max())
    message = (
        f"the stones are wedged: forces within friction balance the load that grows alone, residual {residual:.1e} of the weight"
    )
    if flow == "non-associative":
        message += "; they need no friction"
    message += "; stones that do not crush never fail so, and a compressive strength gives a load factor"
    still = replace(ray, y=np.full_like(ray.y, np.nan))
    proof = Certificate(np.inf, np.inf, residual, 0.0, residual, 0.0)
    return _state(balance, still, "unbounded", np.inf, proof, seconds, flow=flow, message=message)


def fallen_state(
    balance: Equilibrium, standing: Literal["unstable", "failed"], answer: ConeSolution, flow: Flow, seconds: float
) -> LimitState:
    """Return the state of a structure that its dead load brings down, or of which that was not decided, with its multipliers."""
    message = "the dead load alone brings it down" if standing == "unstable" else f"dead load not decided: {answer.message}"
    return _state(balance, answer, standing, np.nan, UNPROVED, seconds, flow=flow, message=message)


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
    found = point_forces(balance, answer.x, answer.y if np.isfinite(load_factor) else np.full_like(answer.y, np.nan))
    return LimitState(
        load_factor=load_factor,
        status=status,
        lower_bound=certificate.lower_bound,
        upper_bound=certificate.upper_bound,
        forces=found.contacts,
        tie_forces=found.ties,
        tie_sensitivity=found.sensitivity,
        velocities=balance.velocities(answer.y) if np.isfinite(answer.y).all() else np.zeros((balance.count, 6)),
        equilibrium_residual=certificate.equilibrium_residual,
        cone_violation=certificate.cone_violation,
        iterations=answer.iterations,
        seconds=seconds,
        solver=answer.solver,
        flow=flow,
        message=message or answer.message,
    )
