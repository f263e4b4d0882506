"""The steps of the run from the centre: direction, centrality correctors and length.

*Long steps.* In large models a few points of ten thousand hold every step, and others hold the next one. Where that has happened,
directions are judged without them, and each stops short on its own way. A force that stops short takes the balance from its two
stones; the least change of all others, in the scaling of the step, gives it back. What is left of that, and of rates that are
not those of the velocities, the next steps remove.

*Points left behind.* Where the path folds, the product of a single joint is the largest that it can be between two states, closed
or open. A step changes it in the second order only, and all other points, central, wait for it. Such points have a product
several times the mean. They are released from their rates: their forces alone make the product fall, as those of a joint that
opens at whatever rate, until it is one among the others. A point that would close where it is released keeps its rates.
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from churchpipe.model.arrays import BoolArray, FloatArray
from churchpipe.rigid_blocks.contact_newton import ContactState, ContactSystem, Linearisation

# A step keeps the least eigenvalue of the products above this share of their mean, which may grow by the second factor.
LEAST, _GROWTH = 1e-3, 1.3
SHORTER, SHORTEST = 0.8, 1e-4
# Least and most share of the products that a step keeps.
CENTRING = (0.01, 0.9)
# Centrality correctors aim this much farther, for products within these multiples of the target, and must win this much.
_REACH, _FARTHER, _BAND, WIN = 1.1, 0.15, (0.1, 10.0), 0.01
# Steps shorter than the first are repeated with more damping, those shorter than the second get more of it next time, those
# longer than the third less.
_SHORT, _MODEST, _LONG = 0.02, 0.25, 0.6
# A point that stops short goes the first share of its own way. Forces get their balance back in at most so many sweeps, in which
# a point goes the third share of the way to the boundary of its cone where it would go farther than the last.
_OWN, _SWEEPS, _HALF, _NEAR = 0.6, 3, 0.5, 0.95
# A point is left behind whose product is so many times the mean. It keeps its rates where a step would close it so many times
# over.
_BEHIND, _OVER = 4.0, 2.0


@dataclass(frozen=True, slots=True)
class Move:
    """The next state, by how much the damping should change, and how long the step was.

    released: how many points were; kept (nc,): which ones were left behind and would have closed if released.
    """

    at: ContactState
    stiffer: float
    length: float
    released: int
    kept: BoolArray


class _Direction(NamedTuple):
    """A step, its length, the matrices that it is made with, and the mean product that it starts from."""

    step: ContactState
    length: float
    linear: Linearisation
    mean: float


def advance(system: ContactSystem, at: ContactState, damping: float, ignored: int = 0, kept: BoolArray | None = None) -> Move:
    """Return the next state.

    ignored: so many forces, and rates, are left out of account where directions are judged. kept (nc,): points that are not
    released although they are left behind; None: no point is released.
    """
    behind = np.zeros(system.points, bool) if kept is None else left_behind(system, at)
    keeping = behind if kept is None else behind & kept
    while True:
        released = behind & ~keeping
        step, length, linear, mean = _direction(system, at, damping, ignored, released)
        closing = released & (_OVER * at.rates[0] < -step.rates[0])
        if not closing.any():
            break
        keeping = keeping | closing
    new, length = _central_part(system, linear, at, step, system.settings.fraction * length, mean, ignored)
    count = int(released.sum())
    if length < _SHORT and damping < system.settings.damping[1]:
        return Move(at, 10.0, length, count, keeping)
    return Move(new, 5.0 if length < _MODEST else 1.0 / 3.0 if length > _LONG else 1.0, length, count, keeping)


def left_behind(system: ContactSystem, at: ContactState) -> BoolArray:
    """Return which points (nc,) have a product several times the mean."""
    z = system.multipliers(at.rates)
    point = system.scaling(at.forces, z).point[:, 0]
    largest = (point[0] + np.hypot(point[1], point[2])) ** 2
    return largest > _BEHIND * float((at.forces * z).sum()) / system.points


def _direction(system: ContactSystem, at: ContactState, damping: float, ignored: int, released: BoolArray) -> _Direction:
    """Return the step from a state, judged without the `ignored` points that end it first."""
    settings, points = system.settings, system.points
    z = system.multipliers(at.rates)
    mean = float((at.forces * z).sum()) / points
    residual, excess = system.residual(at), float(system.live @ at.y) - 1.0
    pull = settings.pull * mean * points
    linear = Linearisation(system, at.forces, z, at.rates, damping, released)
    # What the rates of the velocities are ahead of those of points that stopped short.
    lack = system.rates(at.y) - at.rates if ignored else np.zeros((3, points))
    shift = linear.scaled(linear.tangent(lack))

    def towards(target: FloatArray) -> ContactState:
        step = linear.step(target - shift, residual, excess, pull)
        return replace(step, rates=step.rates + lack)

    products = system.product(linear.point, linear.point)
    affine = towards(linear.divide(-products))
    reach = _longest(system, at, affine, ignored)
    centring = min(max((1.0 - reach) ** 3, CENTRING[0]), CENTRING[1])
    target = centring * mean * system.unit
    second = _second_order(system, linear, at, z, affine, 0.999 * _longest(system, at, affine, 0))
    size = np.sqrt((second**2).sum(axis=0))
    second *= np.minimum(1.0, settings.clip * mean / np.maximum(size, 1e-300))
    step = towards(linear.divide(target - products - second))
    length = _longest(system, at, step, ignored)
    for _ in range(settings.correctors):
        if length >= 1.0:
            break
        ahead = ahead_of(length)
        there = linear.scaled_forces(at.forces + ahead * step.forces), linear.scaled(z + ahead * linear.tangent(step.rates))
        fix = recentring(system, system.product(*there), centring * mean)
        longer = step.plus(linear.step(linear.divide(fix), np.zeros_like(residual), 0.0, 0.0))
        found = _longest(system, at, longer, ignored)
        if found < length + WIN:
            break
        step, length = longer, found
    return _Direction(step, length, linear, mean)


def ahead_of(length: float) -> float:
    """Return the length at which centrality correctors of a step of this length aim."""
    return min(1.0, _REACH * length + _FARTHER)


def recentring(system: ContactSystem, product: FloatArray, target: float) -> FloatArray:
    """Return the correction that brings products (3, nc) near a target."""
    return system.recentre(product, _BAND[0] * target, _BAND[1] * target)


def least_product(system: ContactSystem, forces: FloatArray, z: FloatArray, ignored: int = 0) -> float:
    """Return the least eigenvalue of the products of forces and multipliers, over their mean, but for the `ignored` least."""
    point = system.scaling(forces, z).point[:, 0]
    mean = float((forces * z).sum()) / system.points
    least = (point[0] - np.hypot(point[1], point[2])) ** 2
    return float(np.partition(least, ignored)[ignored]) / mean


def _second_order(
    system: ContactSystem, linear: Linearisation, at: ContactState, z: FloatArray, step: ContactState, length: float
) -> FloatArray:
    """Return the products that a linear step neglects, of a step of this length with the true multipliers."""
    change = (system.multipliers(at.rates + length * step.rates) - z) / length
    bent = linear.scaled(change - linear.tangent(step.rates))
    both = system.product(linear.scaled_forces(step.forces), linear.scaled(change))
    return length * both + system.product(linear.point, bent)


def _steepness(system: ContactSystem, at: ContactState, step: ContactState) -> tuple[FloatArray, FloatArray]:
    """Return 1 over the length at which each force leaves its cone, and each point begins to close, both (nc,)."""
    return system.reaches(at.forces, step.forces), -step.rates[0] / at.rates[0]


def _longest(system: ContactSystem, at: ContactState, step: ContactState, ignored: int) -> float:
    """Return the length, at most 1, that keeps the forces in their cones and all points opening, but for the `ignored` first."""
    last = system.points - 1 - ignored
    steepest = (float(np.partition(each, last)[last]) for each in _steepness(system, at, step))
    return min(1.0, 1.0 / max(*steepest, 1e-3))


def _central_part(
    system: ContactSystem,
    linear: Linearisation,
    at: ContactState,
    step: ContactState,
    length: float,
    mean: float,
    ignored: int,
) -> tuple[ContactState, float]:
    """Return the state so far along a step that no product falls far behind the others, and the length."""
    while True:
        new = _stopped_short(system, linear, at, step, length) if ignored else at.plus(step, length)
        z = system.multipliers(new.rates)
        grown = float((new.forces * z).sum()) / system.points > _GROWTH * mean
        if (least_product(system, new.forces, z, 2 * ignored) >= LEAST and not grown) or length < SHORTEST:
            return new, length
        length *= SHORTER


def _stopped_short(
    system: ContactSystem, linear: Linearisation, at: ContactState, step: ContactState, length: float
) -> ContactState:
    """Return the state so far along a step, at points that would leave their cones a share of their own way."""
    new = at.plus(step, length)
    forces, rates = (
        np.where(length * steep > system.settings.fraction * (1.0 + 1e-12), _OWN / np.maximum(steep, 1e-300), length)
        for steep in _steepness(system, at, step)
    )
    new = replace(new, forces=at.forces + forces * step.forces, rates=at.rates + rates * step.rates)
    # What the step as such would leave of the balance is left to later ones.
    left = (1.0 - length) * system.residual(at)
    for _ in range(_SWEEPS if (forces < length).any() else 0):
        change = linear.balancing(system.residual(new) - left)
        steep = system.reaches(new.forces, change.forces)
        share = np.where(steep > _NEAR, _HALF / np.maximum(steep, 1e-300), 1.0)
        new = replace(new, forces=new.forces + share * change.forces, load_factor=new.load_factor + change.load_factor)
        if (share == 1.0).all():
            break
    return new
