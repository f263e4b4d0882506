"""Sliding without dilatancy as one interior-point run, from forces and rates in the middle of their cones.

The searches of `iterations` begin with forces that somebody chose, and rounding decides which state they end at. This run begins
without any: all points press and open alike, and the products of forces and rates (`contact_newton`) fall together to zero.
"""

from dataclasses import replace

import numpy as np

from churchpipe.conic.solve import Solve
from churchpipe.model.progress import Progress
from churchpipe.rigid_blocks.central_descent import Descent
from churchpipe.rigid_blocks.certificate import Strength
from churchpipe.rigid_blocks.coulomb import CoulombState, Near
from churchpipe.rigid_blocks.equilibrium import Equilibrium
from churchpipe.rigid_blocks.iterations import SlidingRun, SolveCount, closed_gap
from churchpipe.rigid_blocks.settings import CentralSettings, SchemeSettings

# Rates are measured by the friction: below this, numbers overflow.
_LEAST_FRICTION = 1e-100


def runs_from_centre(balance: Equilibrium, strength: Strength) -> bool:
    """Say whether the run knows all these points: friction everywhere, no cohesion, no ties, no bound."""
    plain = not strength.cohesion.any() and not strength.bounded.any() and not balance.ties and balance.pressed is None
    return plain and bool((strength.friction > _LEAST_FRICTION).all())


def from_centre(
    balance: Equilibrium, strength: Strength, bipotential_gap: float, solve: Solve, progress: Progress | None = None
) -> SlidingRun | None:
    """Return the run from the centre, closed by stage B where it stops near a state.

    A run is left where a pair of programs may close the gap sooner. Where the pair does not, a run that falls fast goes on, and
    is left again ten times as near; otherwise stage B goes on. Where that is not certified another run follows, which takes
    another path: it has other multipliers, and the least damping throughout. In a third one no point stops short, and its
    programs do not begin near each other: they find the most central forces, which a joint that holds the gap may need.
    """
    settings = CentralSettings()
    least = settings.damping[0]
    other = replace(settings, roundness=settings.other_roundness, damping=(least, least))
    whole = replace(settings, patience=settings.whole_patience, damping=(least, least))
    found: list[SlidingRun] = []
    count, spent = SolveCount(solve), 0
    for each, short in ((settings, True), (other, True), (whole, False)):
        descent, goes_on = Descent(balance, strength, bipotential_gap, each, progress, short=short), True
        while goes_on and not _certified(found, bipotential_gap):
            goes_on = descent.lower()
            run, near = descent.run, descent.nearest
            if run is not None:
                found.append(run)
            if near is not None and not _certified(found, bipotential_gap) and near.relative_gap <= settings.near:
                pairs = 1 if goes_on else settings.polish
                closed = _closed(balance, strength, near, bipotential_gap, each, count, progress, light=short, pairs=pairs)
                if closed is not None:
                    found.append(replace(closed, history=(*(run.history if run else ()), *closed.history)))
        spent += descent.factorisations
        if _certified(found, bipotential_gap):
            break
    best = min(found, key=lambda run: run.relative_gap, default=None)
    return None if best is None else replace(best, solves=count.solves, iterations=spent + count.iterations)


def _certified(found: list[SlidingRun], bipotential_gap: float) -> bool:
    return any(run.relative_gap <= bipotential_gap for run in found)


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
    pairs: int,
) -> SlidingRun | None:
    """Return the run that stage B makes of a state that is near, in so many pairs of programs at most.

    light: whether its programs begin near each other and have small proximal weights, as after a run whose points may stop short.
    """
    n = np.maximum(near.x[:, 0], 0.0)
    usual = SchemeSettings(bipotential_gap=bipotential_gap, stage_b=pairs)
    if not light:
        return closed_gap(balance, strength, n, solve, usual, progress)
    own = replace(
        usual,
        nearness=settings.nearness,
        momentum=settings.momentum,
        outlook=settings.light_outlook,
        duality_gap=settings.duality_gap,
        roughest=settings.duality_gap,
    )
    return closed_gap(balance, strength, n, solve, own, progress, near=Near(near.x, near.y), gap=near.relative_gap)
