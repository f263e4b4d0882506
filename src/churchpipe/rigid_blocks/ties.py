"""Ties in the balance of rigid blocks: one more point each, whose normal force is the tension."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from churchpipe.conic.wrenches import Wrenches
from churchpipe.errors import InputError
from churchpipe.loading.ties import anchors_of
from churchpipe.model.arrays import FloatArray, IntArray, pointer_of
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.results import LimitState
from churchpipe.model.ties import Tie
from churchpipe.rigid_blocks.certificate import Strength
from churchpipe.rigid_blocks.equilibrium import Equilibrium
from churchpipe.stones.interfaces import frames


def with_ties(balance: Equilibrium, strength: Strength, stones: Assemblage, ties: Sequence[Tie]) -> tuple[Equilibrium, Strength]:
    """Return balance and strength of the contact points with one more point for each tie.

    Its normal force is the tension: it pulls at the start along the tie, at the end against it, and is bounded by the strength
    of the tie. Friction and cohesion are 0. Where an end pulls on several stones each takes its share.

    Raises
    ------
    InputError: an anchor without a stone or with several, both ends on one stone, or on stones that cannot move; two ties of one
    name, which results would not tell apart.
    """
    if not ties:
        return balance, strength
    names = [tie.name for tie in ties]
    if (twice := next((name for name in names if names.count(name) > 1), None)) is not None:
        raise InputError("ties", "two ties of one name", found=twice, expected="a name each")
    row_of = np.full(stones.count, -1, dtype=np.int64)
    row_of[balance.free] = np.arange(len(balance.free))
    pulls = [_pulls(stones, tie, row_of) for tie in ties]
    bodies, arms, signs = (np.concatenate(parts) for parts in zip(*pulls, strict=True))
    tensions = Wrenches(
        len(balance.free),
        pointer_of([len(pull[0]) for pull in pulls]),
        bodies,
        arms / balance.length,
        signs,
        frames(np.array([-tie.axis for tie in ties])),
        np.arange(len(ties)),
        np.zeros((len(ties), 2)),
    )
    tied = replace(balance, wrenches=balance.wrenches.joined(tensions), ties=len(ties))
    none = np.zeros(len(ties))
    bound = np.array([tie.strength for tie in ties]) / balance.force
    values = ((strength.friction, none), (strength.cohesion, none), (strength.bound, bound))
    return tied, Strength(*(np.concatenate(pair) for pair in values))


def with_tensions(balance: Equilibrium, strength: Strength, tension: FloatArray) -> tuple[Equilibrium, Strength]:
    """Return balance and strength with the ties as dead loads, of given tensions (nt,) in the unit of force."""
    x = np.zeros((balance.points, 3))
    x[balance.contacts :, 0] = tension
    dead = balance.dead + balance.wrenches.apply(x)
    held = replace(balance, wrenches=balance.wrenches.first(balance.contacts), dead=dead, ties=0)
    return held, Strength(*(part[: balance.contacts] for part in (strength.friction, strength.cohesion, strength.bound)))


def _pulls(stones: Assemblage, tie: Tie, row_of: IntArray) -> tuple[IntArray, FloatArray, FloatArray]:
    """Return the free stones (k,), ascending, that a tie pulls on, as rows of the balance, the arms (k, 3) m of the pull on
    each, and its share (k,) along the tie from end to start."""
    first, second = anchors_of(stones, tie)
    stone = np.concatenate([first.stone, second.stone])
    point = np.concatenate([first.point, second.point])
    share = np.concatenate([-first.share, second.share])
    moving = row_of[stone] >= 0
    order = np.flatnonzero(moving)[np.argsort(row_of[stone[moving]])]
    return row_of[stone[order]], (point - stones.centroid[stone])[order], share[order]


@dataclass(frozen=True, slots=True)
class PointForces:
    """The forces of a solution by what they act in: contacts (nc, 3) N; ties (nt,) N; what a tie's strength adds (nt,) 1/N."""

    contacts: FloatArray
    ties: FloatArray
    sensitivity: FloatArray


def point_forces(balance: Equilibrium, x: FloatArray, y: FloatArray) -> PointForces:
    """Return the forces of a solution x (nc + nt, 3) and what the strength of each tie adds to the load factor.

    By virtual work that is the rate at which the mechanism y (6 nf,), f_L . u = 1, lengthens the tie. It is zero for a tie that
    the mechanism does not lengthen, and NaN where there is no mechanism of the lateral load.
    """
    first = balance.contacts
    power = float(balance.live @ y)
    ties = slice(first, balance.points)
    shortening = balance.rates(y)[ties, 0] / (power if power > 0 else np.nan)
    return PointForces(
        x[:first] * balance.force, np.maximum(x[ties, 0], 0.0) * balance.force, np.maximum(-shortening, 0.0) / balance.force
    )


def all_forces(balance: Equilibrium, state: LimitState) -> FloatArray:
    """Return the forces x (points, 3) of contacts and ties that a state has, with those that fit them where joints crush."""
    ties = np.zeros((balance.ties, 3))
    ties[:, 0] = state.tie_forces / balance.force
    x = np.concatenate([state.forces / balance.force, ties])
    return x if balance.pressed is None else np.concatenate([x, balance.pressed.further(x[:, 0])])
