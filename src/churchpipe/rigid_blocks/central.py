"""Sliding without dilatancy as one interior-point run, from forces and rates in the middle of their cones.

The searches of `iterations` begin with forces that somebody chose, and rounding decides which state they end at. This run begins
without any: all points press and open alike, and the products of forces and rates (`contact_newton`) fall together to zero.
"""

from dataclasses import dataclass, replace

import numpy as np

from churchpipe.conic.cholesky import NotDefiniteError
from churchpipe.conic.solve import Solve
from churchpipe.model.arrays import FloatArray
from churchpipe.model.results import Iteration
from churchpipe.rigid_blocks.certificate import FLOW_TOLERANCE, RESIDUAL_TOLERANCE, Strength
from churchpipe.rigid_blocks.contact_newton import ContactState, ContactSystem, Linearisation
from churchpipe.rigid_blocks.coulomb import CoulombState, bipotential_gap
from churchpipe.rigid_blocks.equilibrium import Equilibrium
from churchpipe.rigid_blocks.iterations import Progress, SlidingRun, closed_gap, sliding_run
from churchpipe.rigid_blocks.settings import BIPOTENTIAL_GAP, CentralSettings, SchemeSettings

# Steps in which the points begin to open and the load does unit work, at most, and the error of that work after which the
# products follow from the rates.
_FIRST_STEPS, _WORKS = 40, 0.1
# A step keeps the least eigenvalue of the products above this share of their mean, which may grow by the second factor.
_LEAST, _GROWTH = 1e-3, 1.3
_SHORTER, _SHORTEST = 0.8, 1e-4
# The first steps lower the products to the first share, or to the second, and start again where one is shorter than the third.
_LOWER, _CENTRE, _TINY = 0.2, 0.9, 0.1
_CENTRING = (0.01, 0.9)
# Centrality correctors aim this much farther, for products within these multiples of the target, and must win this much.
_REACH, _FARTHER, _BAND, _WIN = 1.1, 0.15, (0.1, 10.0), 0.01
# Steps shorter than the first are repeated with more damping, those shorter than the second get more of it next time, those
# longer than the third less.
_SHORT, _MODEST, _LONG = 0.02, 0.25, 0.6


def runs_from_centre(balance: Equilibrium, strength: Strength) -> bool:
    """Say whether the run knows all these points: friction everywhere, no cohesion, no ties, no bound."""
    plain = not strength.cohesion.any() and not strength.bounded.any() and not balance.ties and balance.pressed is None
    return plain and bool((strength.friction > 0).all())


def from_centre(
    balance: Equilibrium, strength: Strength, bipotential_gap: float, solve: Solve, progress: Progress | None = None
) -> SlidingRun | None:
    """Return the run from the centre, closed by stage B where it stops near a state, or a second one where it does not."""
    settings = CentralSettings()
    best: SlidingRun | None = None
    solves = spent = 0
    for roundness in (settings.roundness, settings.other_roundness):
        run = central_run(balance, strength, bipotential_gap, replace(settings, roundness=roundness), progress)
        if run is None:
            continue
        spent += run.iterations
        if bipotential_gap < run.relative_gap <= settings.near:
            polish = SchemeSettings(bipotential_gap=bipotential_gap, stage_b=settings.polish)
            closed = closed_gap(balance, strength, np.maximum(run.x[:, 0], 0.0), solve, polish, progress)
            if closed is not None:
                solves, spent = solves + closed.solves, spent + closed.iterations
                history = (*run.history, *closed.history)
                run = replace(closed if closed.relative_gap < run.relative_gap else run, history=history)
        best = run if best is None or run.relative_gap < best.relative_gap else best
        if best.relative_gap <= bipotential_gap:
            break
    return None if best is None else replace(best, solves=solves, iterations=spent)


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
    settings = settings or CentralSettings()
    system = ContactSystem(balance, strength, settings)
    history: list[Iteration] = []
    best: CoulombState | None = None
    # The step at which the gap was last halved, and the gap then.
    halved, mark = 0, np.inf
    try:
        at = _first_rates(system)
        damping = settings.damping[0]
        for step in range(settings.steps):
            state = _coulomb_state(balance, strength, system, at)
            if state is not None:
                history.append(Iteration(state.load_factor, 0.0, state.relative_gap))
                halved, mark = (step, state.gap) if state.gap < 0.5 * mark else (halved, mark)
                best = state if best is None or state.gap < best.gap else best
                if state.relative_gap <= bipotential_gap:
                    break
            near = best is not None and best.relative_gap <= settings.near
            if step - halved > settings.patience[near]:
                break
            if progress:
                progress("non-associative", step / settings.steps)
            with np.errstate(all="ignore"):
                move = _advance(system, at, damping)
            damping = min(max(damping * move.stiffer, settings.damping[0]), settings.damping[1])
            at = move.at
            if not (np.isfinite(at.forces).all() and np.isfinite(at.rates).all()):
                break
    except NotDefiniteError:
        pass
    return None if best is None else sliding_run(best, history, 0, system.factorisations)


def _first_rates(system: ContactSystem, *, held: bool = False) -> ContactState:
    """Return a state whose points all open, near unit work: from multipliers of their own, which the rates approach.

    held: every step keeps the products together, and lowers them little after a short one. That takes more steps where the others
    would do, and arrives where a short step shows that they would not.
    """
    settings, points, live = system.settings, system.points, system.live
    unit = np.zeros((3, points))
    unit[0] = 1.0
    at = ContactState(settings.force / points * unit, 0.0, np.zeros_like(live), np.zeros((3, points)))
    z, length = unit, 1.0
    for _ in range(_FIRST_STEPS):
        excess = float(live @ at.y) - 1.0
        if at.rates[0].min(initial=np.inf) > 0 and abs(excess) < _WORKS:
            break
        lack = system.multipliers(at.rates) - z
        linear = Linearisation(system, at.forces, z, at.rates, settings.first_damping)
        mean = float((at.forces * z).sum()) / points
        target = max(1.0 / points, (_CENTRE if held and length < _MODEST else _LOWER) * mean)
        wanted = linear.divide(target * unit - system.product(linear.point, linear.point)) - linear.scaled(lack)
        step = linear.step(wanted, system.residual(at), excess, 0.0)
        change = linear.tangent(step.rates) + lack
        steepest = max(system.reach(at.forces, step.forces), system.reach(z, change))
        length = min(1.0, settings.fraction / max(steepest, 1e-3))
        if length < _TINY and not held:
            return _first_rates(system, held=True)
        while held and _least_product(system, at.forces + length * step.forces, z + length * change) < _LEAST:
            length *= _SHORTER
            if length < _SHORTEST:
                break
        at, z = at.plus(step, length), z + length * change
    return at


def _least_product(system: ContactSystem, forces: FloatArray, z: FloatArray) -> float:
    """Return the least eigenvalue of the products of forces and multipliers, over the mean product."""
    point = system.scaling(forces, z).point[:, 0]
    mean = float((forces * z).sum()) / system.points
    return float(((point[0] - np.hypot(point[1], point[2])) ** 2).min(initial=np.inf)) / mean


@dataclass(frozen=True, slots=True)
class _Move:
    """The next state, and by how much the damping should change."""

    at: ContactState
    stiffer: float


def _advance(system: ContactSystem, at: ContactState, damping: float) -> _Move:
    settings, points = system.settings, system.points
    z = system.multipliers(at.rates)
    mean = float((at.forces * z).sum()) / points
    residual, excess = system.residual(at), float(system.live @ at.y) - 1.0
    pull = settings.pull * mean * points
    linear = Linearisation(system, at.forces, z, at.rates, damping)
    products = system.product(linear.point, linear.point)
    affine = linear.step(linear.divide(-products), residual, excess, pull)
    reach = _longest(system, at, affine)
    centring = min(max((1.0 - reach) ** 3, _CENTRING[0]), _CENTRING[1])
    target = np.zeros((3, points))
    target[0] = centring * mean
    second = _second_order(system, linear, at, z, affine, 0.999 * reach)
    size = np.sqrt((second**2).sum(axis=0))
    second *= np.minimum(1.0, settings.clip * mean / np.maximum(size, 1e-300))
    step = linear.step(linear.divide(target - products - second), residual, excess, pull)
    length = _longest(system, at, step)
    for _ in range(settings.correctors):
        if length >= 1.0:
            break
        ahead = min(1.0, _REACH * length + _FARTHER)
        there = linear.scaled_forces(at.forces + ahead * step.forces), linear.scaled(z + ahead * linear.tangent(step.rates))
        low, high = (share * centring * mean for share in _BAND)
        fix = system.recentre(system.product(*there), low, high)
        longer = step.plus(linear.step(linear.divide(fix), np.zeros_like(residual), 0.0, 0.0))
        found = _longest(system, at, longer)
        if found < length + _WIN:
            break
        step, length = longer, found
    whole = settings.fraction * length
    new, length = _central_part(system, at, step, whole, mean)
    if length < _SHORT and damping < settings.damping[1]:
        return _Move(at, 10.0)
    return _Move(new, 5.0 if length < _MODEST else 1.0 / 3.0 if length > _LONG else 1.0)


def _second_order(
    system: ContactSystem, linear: Linearisation, at: ContactState, z: FloatArray, step: ContactState, length: float
) -> FloatArray:
    """Return the products that a linear step neglects, of a step of this length with the true multipliers."""
    change = (system.multipliers(at.rates + length * step.rates) - z) / length
    bent = linear.scaled(change - linear.tangent(step.rates))
    both = system.product(linear.scaled_forces(step.forces), linear.scaled(change))
    return length * both + system.product(linear.point, bent)


def _longest(system: ContactSystem, at: ContactState, step: ContactState) -> float:
    """Return the length, at most 1, that keeps the forces in their cones and all points opening."""
    closing = float((-step.rates[0] / at.rates[0]).max(initial=0.0))
    return min(1.0, 1.0 / max(system.reach(at.forces, step.forces), closing, 1e-3))


def _central_part(
    system: ContactSystem, at: ContactState, step: ContactState, length: float, mean: float
) -> tuple[ContactState, float]:
    """Return the state so far along a step that no product falls far behind the others, and the length."""
    while True:
        new = at.plus(step, length)
        z = system.multipliers(new.rates)
        grown = float((new.forces * z).sum()) / system.points > _GROWTH * mean
        if (_least_product(system, new.forces, z) >= _LEAST and not grown) or length < _SHORTEST:
            return new, length
        length *= _SHORTER


def _coulomb_state(balance: Equilibrium, strength: Strength, system: ContactSystem, at: ContactState) -> CoulombState | None:
    """Return the state in the units of the certificate, None while its forces do not balance."""
    if np.abs(system.residual(at)).max() > RESIDUAL_TOLERANCE or (at.rates[0] < -FLOW_TOLERANCE).any():
        return None
    x = np.ascontiguousarray(np.stack([at.forces[0] / strength.friction, at.forces[1], at.forces[2]], axis=1))
    y = at.y / float(balance.live @ at.y)
    return CoulombState(x, at.load_factor, y, bipotential_gap(balance, strength, x, y))
