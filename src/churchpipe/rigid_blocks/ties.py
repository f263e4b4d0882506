"""Ties in the balance of rigid blocks: one more point each, whose normal force is the tension."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from churchpipe.conic.wrenches import pair_wrenches
from churchpipe.errors import InputError
from churchpipe.geometry.locate import stones_at
from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.results import LimitState
from churchpipe.model.ties import Tie
from churchpipe.rigid_blocks.certificate import Strength
from churchpipe.rigid_blocks.equilibrium import Equilibrium
from churchpipe.stones.interfaces import frames


def with_ties(balance: Equilibrium, strength: Strength, stones: Assemblage, ties: Sequence[Tie]) -> tuple[Equilibrium, Strength]:
    """Return balance and strength of the contact points with one more point for each tie.

    Its normal force is the tension: it pulls at the start along the tie, at the end against it, and is bounded by the strength
    of the tie. Friction and cohesion are 0.

    Raises
    ------
    InputError: an anchor without a stone or with several, both ends on one stone, or on stones that cannot move.
    """
    if not ties:
        return balance, strength
    pairs = np.array([_anchored(stones, tie) for tie in ties])
    anchors = np.array([(tie.start, tie.end) for tie in ties])
    row_of = np.full(stones.count, -1, dtype=np.int64)
    row_of[balance.free] = np.arange(len(balance.free))
    tensions = pair_wrenches(
        len(balance.free),
        row_of[pairs],
        (anchors - stones.centroid[pairs]) / balance.length,
        frames(np.array([-tie.axis for tie in ties])),
        np.arange(len(ties)),
    )
    tied = replace(balance, wrenches=balance.wrenches.joined(tensions), ties=len(ties))
    none = np.zeros(len(ties))
    bound = np.array([tie.strength for tie in ties]) / balance.force
    values = ((strength.friction, none), (strength.cohesion, none), (strength.bound, bound))
    return tied, Strength(*(np.concatenate(pair) for pair in values))


def _anchored(stones: Assemblage, tie: Tie) -> tuple[int, int]:
    where = f"tie {tie.name}"
    if tie.stones is None:
        i, j = (_stone_at(stones, where, end, anchor) for end, anchor in (("start", tie.start), ("end", tie.end)))
    else:
        i, j = tie.stones
    if max(i, j) >= stones.count:
        raise InputError(f"{where}: stones", "no such stone", found=max(i, j), expected=f"indices < {stones.count}")
    if i == j:
        raise InputError(where, "both ends on one stone", found=stones.block_id[i], expected="anchors on two stones")
    if stones.fixed[[i, j]].all():
        found = f"{stones.block_id[i]} and {stones.block_id[j]}"
        raise InputError(where, "both ends on fixed stones", found=found, expected="at least one free stone")
    return i, j


def _stone_at(stones: Assemblage, where: str, end: str, anchor: FloatArray) -> int:
    found = stones_at(stones, anchor).tolist()
    place = f"{anchor.round(4).tolist()} m"
    if not found:
        raise InputError(f"{where}: {end}", "no stone at the anchor", found=place, expected="a point in or on a stone")
    if len(found) > 1:
        raise InputError(
            f"{where}: {end}",
            "several stones at the anchor",
            found=f"{', '.join(f'{stones.block_id[i]} ({i})' for i in found)} at {place}",
            expected="one stone",
            remedy="Move the anchor into one of them, or give the tie's stones=(i, j).",
        )
    return int(found[0])


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
    shortening = balance.rates(y)[first:, 0] / (power if power > 0 else np.nan)
    return PointForces(
        x[:first] * balance.force, np.maximum(x[first:, 0], 0.0) * balance.force, np.maximum(-shortening, 0.0) / balance.force
    )


def all_forces(balance: Equilibrium, state: LimitState) -> FloatArray:
    """Return the forces x (nc + nt, 3) of contacts and ties that a state has."""
    ties = np.zeros((balance.ties, 3))
    ties[:, 0] = state.tie_forces / balance.force
    return np.concatenate([state.forces / balance.force, ties])
