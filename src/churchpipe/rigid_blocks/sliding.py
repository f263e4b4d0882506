"""Non-associative limit analysis: several starts, one headline, and the certificate of each."""

from collections.abc import Callable
from typing import Literal

import numpy as np

from churchpipe.conic.solve import Solve
from churchpipe.errors import InputError
from churchpipe.model.arrays import FloatArray
from churchpipe.model.results import LimitState
from churchpipe.rigid_blocks.certificate import Strength, cone_violation
from churchpipe.rigid_blocks.coulomb import (
    CoulombState,
    admissible,
    coulomb_step,
    dead_load_start,
    friction_violation,
    mechanism_interval,
    sliding_velocities,
)
from churchpipe.rigid_blocks.equilibrium import Equilibrium
from churchpipe.rigid_blocks.iterations import SchemeSettings, SlidingRun, certified_iteration, paper_iteration

GAP_TOLERANCE = 1e-5
Progress = Callable[[str, float], None]


def sliding_analysis(
    balance: Equilibrium,
    strength: Strength,
    associative: LimitState,
    method: Literal["default", "paper"],
    start: Literal["associative", "uniform"],
    solve: Solve,
    progress: Progress | None = None,
    gap_tolerance: float = GAP_TOLERANCE,
) -> LimitState:
    """Return a load factor of sliding without dilatancy, with its gap.

    No such load factor is unique: self-stress at sliding contacts is statically free, so it depends on the start. Every
    distinct value found is in `fixed_points`.

    method: "default", the certified scheme from the canonical dead-load start (headline) and from the associative one;
    "paper", the iteration of eq. (3) from `start` (the associative forces, or the mean of the least-squares dead-load
    forces at every point) with n = 0 and n = n_0 before it, headline the lowest that settled.
    gap_tolerance: g / alpha at which the certified scheme stops looking. More than 1e-5 saves time on large models, but only
    1e-5 is called "converged".
    """
    normal = associative.forces[:, 0] / balance.force
    if method == "default":
        settings = SchemeSettings(gap=gap_tolerance)
        starts = (dead_load_start(balance), np.maximum(normal, 0.0))
        runs = [certified_iteration(balance, strength, n, solve, settings, progress) for n in starts]
        found = [run for run in runs if run is not None]
        if not found:
            return _nothing(associative)
        # The canonical start is the headline unless only the other one was certified.
        chosen = next((run for run in found if run.settled), found[0])
        state = CoulombState(chosen.x, chosen.load_factor, chosen.y, chosen.gap)
        return _state(balance, strength, associative, chosen, found, state)
    if method != "paper":
        raise InputError("limit_analysis: method", "unknown method", found=method, expected='"default" or "paper"')
    n0 = _paper_start(start, normal, balance)
    runs = [paper_iteration(balance, strength, n0, before, solve, progress=progress) for before in (np.zeros_like(n0), n0)]
    found = [run for run in runs if run is not None]
    if not found:
        return _nothing(associative)
    chosen = min(found, key=lambda run: (not run.settled, run.load_factor))
    y = sliding_velocities(balance, strength, np.maximum(chosen.x[:, 0], 0.0), solve)
    state = None
    if y is not None:
        # The iteration overdraws friction: its certificate is that of the nearest forces that do not.
        nearness = SchemeSettings().weight_b
        state = coulomb_step(balance, strength, np.maximum(chosen.x[:, 0], 0.0), y, solve, nearness=nearness)
    return _state(balance, strength, associative, chosen, found, state)


def _paper_start(start: str, normal: FloatArray, balance: Equilibrium) -> FloatArray:
    if start == "associative":
        return np.maximum(normal, 0.0)
    if start == "uniform":
        return np.full_like(normal, float(dead_load_start(balance).mean()))
    raise InputError("limit_analysis: start", "unknown start", found=start, expected='"associative" or "uniform"')


def _state(
    balance: Equilibrium,
    strength: Strength,
    associative: LimitState,
    chosen: SlidingRun,
    found: list[SlidingRun],
    certified: CoulombState | None,
) -> LimitState:
    gap, interval = (np.nan, (np.nan, np.nan))
    if certified is not None:
        gap, interval = certified.gap, mechanism_interval(balance, strength, certified)
    slack = 1e-3 * max(abs(associative.load_factor), 1e-3)
    proven = (
        chosen.settled
        and certified is not None
        and certified.relative_gap <= GAP_TOLERANCE
        and abs(certified.load_factor - chosen.load_factor) <= slack
        and admissible(balance, strength, certified)
        and chosen.load_factor <= associative.load_factor + slack
    )
    # What is called converged is the certified state itself, not the iterate beside it that still overdraws friction.
    x, y, load_factor = chosen.x, chosen.y, chosen.load_factor
    last = chosen.history[-1].load_factor
    if proven and certified is not None:
        x, y, load_factor = certified.x, certified.y, certified.load_factor
        last = load_factor
    residual = balance.matrix @ x.ravel() + balance.dead + last * balance.live
    overdrawn = friction_violation(strength, x)
    return LimitState(
        load_factor=load_factor,
        status="converged" if proven else "not-converged",
        lower_bound=np.nan,
        upper_bound=np.nan,
        forces=x * balance.force,
        velocities=balance.velocities(y / max(float(balance.live @ y), 1e-300)),
        equilibrium_residual=float(np.abs(residual).max()),
        cone_violation=cone_violation(x, strength),
        iterations=sum(run.solves for run in found),
        solver=associative.solver,
        flow="non-associative",
        history=chosen.history,
        gap=gap,
        interval=interval,
        friction_violation=overdrawn,
        fixed_points=tuple(run.load_factor for run in found if run.settled),
        message=_cost(found, associative.iterations) if proven else _why(chosen, certified, overdrawn),
    )


def _cost(found: list[SlidingRun], associative: int) -> str:
    """Say what each start cost, in convex programs and in solves of the associative problem with as many iterations."""
    parts = [
        f"{run.solves} convex programs, {run.iterations} iterations"
        + (f" = {run.iterations / associative:.1f} associative solves" if associative else "")
        for run in found
    ]
    return "; ".join(parts)


def _why(chosen: SlidingRun, certified: CoulombState | None, violation: float) -> str:
    settled = "the iteration settled" if chosen.settled else "the iteration did not settle"
    if certified is None:
        return f"{settled}; no forces within friction were found near its last iterate"
    if certified.relative_gap > GAP_TOLERANCE:
        return f"{settled}; gap g/alpha {certified.relative_gap:.1e}, wanted {GAP_TOLERANCE:.0e}"
    return (
        f"{settled} with {100 * violation:.2g} % of friction overdrawn; the nearest state within friction"
        f" has load factor {certified.load_factor:.4f} and gap g/alpha {certified.relative_gap:.1e}"
    )


def _nothing(associative: LimitState) -> LimitState:
    return LimitState(
        load_factor=np.nan,
        status="failed",
        lower_bound=np.nan,
        upper_bound=np.nan,
        forces=associative.forces,
        velocities=associative.velocities,
        flow="non-associative",
        solver=associative.solver,
        message="no start of the non-associative iteration gave a feasible step",
    )
