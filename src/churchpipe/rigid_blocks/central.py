"""Sliding without dilatancy as one interior-point run, from forces and rates in the middle of their cones.

The searches of `iterations` begin with forces that somebody chose, and rounding decides which state they end at. This run begins
without any: all points press and open alike, and the products of forces and rates (`contact_newton`) fall together to zero.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from churchpipe.conic.cholesky import NotDefiniteError
from churchpipe.conic.solve import Solve
from churchpipe.model.arrays import FloatArray
from churchpipe.model.results import Iteration
from churchpipe.rigid_blocks.central_start import first_rates
from churchpipe.rigid_blocks.central_steps import advance
from churchpipe.rigid_blocks.certificate import FLOW_TOLERANCE, RESIDUAL_TOLERANCE, Strength
from churchpipe.rigid_blocks.contact_newton import ContactState, ContactSystem
from churchpipe.rigid_blocks.coulomb import CoulombState, Near, bipotential_gap
from churchpipe.rigid_blocks.equilibrium import Equilibrium
from churchpipe.rigid_blocks.iterations import Progress, SlidingRun, SolveCount, closed_gap, sliding_run
from churchpipe.rigid_blocks.settings import BIPOTENTIAL_GAP, CentralSettings, SchemeSettings

# Steps whose mean tells how fast the gap falls.
_LAST_STEPS = 3


def runs_from_centre(balance: Equilibrium, strength: Strength) -> bool:
    """Say whether the run knows all these points: friction everywhere, no cohesion, no ties, no bound."""
    plain = not strength.cohesion.any() and not strength.bounded.any() and not balance.ties and balance.pressed is None
    return plain and bool((strength.friction > 0).all())


def from_centre(
    balance: Equilibrium, strength: Strength, bipotential_gap: float, solve: Solve, progress: Progress | None = None
) -> SlidingRun | None:
    """Return the run from the centre, closed by stage B where it stops near a state.

    Where that is not certified another run follows, in which no point stops short, and whose programs do not begin near each
    other: they find the most central forces, which a joint that holds the gap may need. A third one has other multipliers.
    """
    settings = CentralSettings()
    whole = replace(settings, patience=settings.whole_patience)
    other = replace(whole, roundness=settings.other_roundness)
    best: SlidingRun | None = None
    count, spent = SolveCount(solve), 0
    for each, short in ((settings, True), (whole, False), (other, False)):
        run, nearest, iterations = _lowered(balance, strength, bipotential_gap, each, progress, short=short)
        spent += iterations
        certified = run is not None and run.relative_gap <= bipotential_gap
        if nearest is not None and not certified and nearest.relative_gap <= settings.near:
            closed = _closed(balance, strength, nearest, bipotential_gap, each, count, progress, light=short)
            if closed is not None:
                history = (*(run.history if run else ()), *closed.history)
                run = replace(closed if run is None or closed.relative_gap < run.relative_gap else run, history=history)
        if run is not None and (best is None or run.relative_gap < best.relative_gap):
            best = run
        if best is not None and best.relative_gap <= bipotential_gap:
            break
    return None if best is None else replace(best, solves=count.solves, iterations=spent + count.iterations)


def _closed(
    balance: Equilibrium,
    strength: Strength,
    near: CoulombState,
    bipotential_gap: float,
    settings: CentralSettings,
    solve: Solve,
    progress: Progress | None,
    *,
    light: bool,
) -> SlidingRun | None:
    """Return the run that stage B makes of a state that is near.

    light: whether its programs begin near each other and have small proximal weights, as after a run whose points may stop short.
    """
    n = np.maximum(near.x[:, 0], 0.0)
    usual = SchemeSettings(bipotential_gap=bipotential_gap, stage_b=settings.polish)
    if not light:
        return closed_gap(balance, strength, n, solve, usual, progress)
    own = replace(
        usual,
        nearness=settings.nearness,
        momentum=settings.momentum,
        patience=settings.light_patience,
        duality_gap=settings.duality_gap,
        roughest=settings.duality_gap,
    )
    return closed_gap(balance, strength, n, solve, own, progress, near=Near(near.x, near.y), gap=near.relative_gap)


def central_run(
    balance: Equilibrium,
    strength: Strength,
    bipotential_gap: float = BIPOTENTIAL_GAP,
    settings: CentralSettings | None = None,
    progress: Progress | None = None,
) -> SlidingRun | None:
    """Lower all products of forces and rates alike, to a collapse state without dilatancy; None where no forces balanced.

    Every step is pulled towards low load factors a little. Of the states that differ in self-stress it thus ends at a careful
    one, and the pull also leads around the folds of the path.

    The gap is that of the arrays: the forces balance and lie inside their cones, all points open.
    """
    return _lowered(balance, strength, bipotential_gap, settings or CentralSettings(), progress, short=True).run


class _Lowered(NamedTuple):
    """The run to its best exact state, None without one; the state with the least gap, exact or not; factorisations."""

    run: SlidingRun | None
    nearest: CoulombState | None
    iterations: int


def _lowered(
    balance: Equilibrium,
    strength: Strength,
    bipotential_gap: float,
    settings: CentralSettings,
    progress: Progress | None,
    *,
    short: bool,
) -> _Lowered:
    """Lower the products as in `central_run`; short: whether a few points may stop short where they hold the steps."""
    system = ContactSystem(balance, strength, settings)
    history: list[Iteration] = []
    best: CoulombState | None = None
    nearest: CoulombState | None = None
    # The step at which the gap was last halved, and the gap then.
    halved, mark = 0, np.inf
    gaps: list[float] = []
    try:
        at = first_rates(system)
        damping, ignored = settings.damping[0], 0
        for step in range(settings.steps):
            state = _coulomb_state(balance, strength, at)
            gaps.append(state.relative_gap)
            if ignored or _exact(system, at):
                history.append(Iteration(state.load_factor, 0.0, state.relative_gap))
                halved, mark = (step, state.gap) if state.gap < 0.5 * mark else (halved, mark)
                nearest = state if nearest is None or state.gap < nearest.gap else nearest
                if _exact(system, at) and (best is None or state.gap < best.gap):
                    best = state
                    if best.relative_gap <= bipotential_gap:
                        break
            near = nearest is not None and nearest.relative_gap <= settings.near
            if step - halved > settings.patience[near]:
                break
            if ignored and nearest is not None and nearest.relative_gap <= max(settings.handed_on, bipotential_gap):
                break
            if short and falls_too_slowly(gaps, bipotential_gap, settings):
                break
            if progress:
                progress("non-associative", step / settings.steps)
            with np.errstate(all="ignore"):
                move = advance(system, at, damping, ignored)
            damping = min(max(damping * move.stiffer, settings.damping[0]), settings.damping[1])
            if short and move.length < settings.blocked and not near:
                ignored = min(int(settings.ignored * system.points), settings.most_ignored)
            at = move.at
            if not (np.isfinite(at.forces).all() and np.isfinite(at.rates).all()):
                break
    except NotDefiniteError:
        pass
    run = None if best is None else sliding_run(best, history, 0, system.factorisations)
    return _Lowered(run, nearest, system.factorisations)


def falls_too_slowly(gaps: list[float], wanted: float, settings: CentralSettings) -> bool:
    """Say whether at the rate of the last steps the gap would be closed later than a pair of programs closes it."""
    if len(gaps) <= _LAST_STEPS or not wanted < gaps[-1] <= settings.foreseen:
        return False
    fall = np.log(gaps[-1 - _LAST_STEPS] / gaps[-1]) / _LAST_STEPS
    return bool(np.log(gaps[-1] / wanted) > settings.outlook * fall)


def _coulomb_state(balance: Equilibrium, strength: Strength, at: ContactState) -> CoulombState:
    """Return the state in the units of the certificate."""
    x = np.ascontiguousarray(np.stack([at.forces[0] / strength.friction, at.forces[1], at.forces[2]], axis=1))
    return _state(balance, strength, x, at.load_factor, at.y / float(balance.live @ at.y))


def _state(balance: Equilibrium, strength: Strength, x: FloatArray, load_factor: float, y: FloatArray) -> CoulombState:
    return CoulombState(x, load_factor, y, bipotential_gap(balance, strength, x, y))


def _exact(system: ContactSystem, at: ContactState) -> bool:
    """Say whether the forces balance and no point closes."""
    closing = -float(system.rates(at.y)[0].min(initial=0.0))
    return float(np.abs(system.residual(at)).max()) <= RESIDUAL_TOLERANCE and closing <= FLOW_TOLERANCE
