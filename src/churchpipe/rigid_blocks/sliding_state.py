"""The result of an analysis of sliding without dilatancy, once it is known which of its states is reported."""

from typing import NamedTuple

import numpy as np

from churchpipe.model.arrays import NameArray
from churchpipe.model.results import LimitState, StartRun
from churchpipe.rigid_blocks.certificate import Strength, cone_violation
from churchpipe.rigid_blocks.coulomb import CoulombState, admissible, friction_violation, gap_shares
from churchpipe.rigid_blocks.equilibrium import Equilibrium
from churchpipe.rigid_blocks.iterations import SlidingRun
from churchpipe.rigid_blocks.settings import BIPOTENTIAL_GAP
from churchpipe.rigid_blocks.ties import point_forces
from churchpipe.wording import counted


class End(NamedTuple):
    """What became of a start: its record, the best of its runs, and the certificate of that one."""

    record: StartRun
    run: SlidingRun
    state: CoulombState | None


def sliding_state(
    balance: Equilibrium,
    strength: Strength,
    associative: LimitState,
    end: End,
    starts: list[StartRun],
    found: list[SlidingRun],
    passed_over: list[str],
    names: NameArray | None = None,
) -> LimitState:
    """Return the result of an analysis that reports this end.

    starts: the ends of all starts; found: all runs; passed_over: what is said of lower ends, which are not reported. names
    (nf,): of the free stones.
    """
    reported, chosen, certified = end
    slack = 1e-3 * max(abs(associative.load_factor), 1e-3)
    proven = (
        chosen.converged
        and certified is not None
        and certified.relative_gap <= BIPOTENTIAL_GAP
        and abs(certified.load_factor - chosen.load_factor) <= slack
        and admissible(balance, strength, certified)
        and chosen.load_factor <= associative.load_factor + slack
    )
    # What is called converged is the certified state itself, not the iterate beside it that still overdraws friction.
    state = certified if proven and certified is not None else chosen
    x, y, load_factor = state.x, state.y, state.load_factor
    balanced = chosen.balanced if state is chosen else None
    residual = balance.residual(x, load_factor if balanced is None else balanced)
    overdrawn = friction_violation(strength, x)
    forces = point_forces(balance, x, y)
    return LimitState(
        load_factor=load_factor,
        status="converged" if proven else "not-converged",
        lower_bound=np.nan,
        upper_bound=np.nan,
        forces=forces.contacts,
        tie_forces=forces.ties,
        tie_sensitivity=forces.sensitivity,
        velocities=balance.velocities(y / max(float(balance.live @ y), 1e-300)),
        equilibrium_residual=float(np.abs(residual).max()),
        cone_violation=cone_violation(x, strength),
        iterations=sum(run.iterations for run in found),
        solver=associative.solver,
        flow="non-associative",
        history=chosen.history,
        gap=reported.gap,
        interval=reported.interval,
        friction_violation=overdrawn,
        fixed_points=tuple(run.load_factor for run in found if run.converged),
        starts=tuple(starts),
        message=_cost(found, associative.iterations, passed_over)
        if proven
        else "; ".join((_why(chosen, certified, overdrawn) + _where(balance, strength, certified, names), *passed_over)),
    )


def _cost(found: list[SlidingRun], associative: int, passed_over: list[str]) -> str:
    """Say what does not lead, and what all runs cost beside the associative analysis: a factorisation of a matrix is a step."""
    spent = sum(run.iterations for run in found)
    searches = f" of {len(found)} searches" if len(found) > 1 else ""
    times = f", {spent / associative:.1f} times as many as in the associative analysis" if associative else ""
    return "; ".join((*passed_over, f"found in {counted(spent, 'step')}{searches}{times}"))


def _why(chosen: SlidingRun, certified: CoulombState | None, violation: float) -> str:
    if not chosen.iterations:
        return f"no start gave a feasible step; the associative forces, with gap g {chosen.gap:.1e}, are an estimate from above"
    settled = "the iteration settled" if chosen.converged else "the iteration did not settle"
    if certified is None:
        return f"{settled}; no forces within friction were found near its last iterate"
    if certified.relative_gap > BIPOTENTIAL_GAP:
        return f"{settled}; gap g/alpha {certified.relative_gap:.1e}, wanted {BIPOTENTIAL_GAP:.0e}"
    return (
        f"{settled} with {100 * violation:.2g} % of friction overdrawn; the nearest state within friction"
        f" has load factor {certified.load_factor:.4f} and gap g/alpha {certified.relative_gap:.1e}"
    )


def _where(balance: Equilibrium, strength: Strength, state: CoulombState | None, names: NameArray | None) -> str:
    """Return at which joint most of the gap of a state lies: what is to be looked at, such as a flat head without a lintel."""
    if state is None or names is None or not state.relative_gap > BIPOTENTIAL_GAP:
        return ""
    wrenches, shares = balance.wrenches, gap_shares(balance, strength, state.x, state.y)[: balance.contacts]
    joint = wrenches.frame[: balance.contacts]
    of_joint = np.bincount(joint, shares)
    worst = int(of_joint.argmax())
    point = int(np.argmax(joint == worst))
    at = " and ".join(str(names[body]) for body in wrenches.bodies[wrenches.pointer[point] : wrenches.pointer[point + 1]])
    share = of_joint[worst] / max(float(shares.sum()), 1e-300)
    return f"; {100 * share:.0f} % of it at a joint of {at}: look whether it is as built"


def nothing_found(associative: LimitState) -> LimitState:
    """Return the result of an analysis none of whose starts gave a feasible step."""
    return LimitState(
        load_factor=np.nan,
        status="failed",
        lower_bound=np.nan,
        upper_bound=np.nan,
        forces=associative.forces,
        velocities=associative.velocities,
        tie_forces=associative.tie_forces,
        tie_sensitivity=associative.tie_sensitivity,
        flow="non-associative",
        solver=associative.solver,
        message="no start of the non-associative iteration gave a feasible step",
    )
