"""How far a given direction lies outside the bed joints of stones that lie in no course."""

import numpy as np

from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts

# A joint crosses the line through a voussoir where the sine of their angle is at least this.
LEAST_CROSSING = 0.4
# Weight of that line among the joints of its stone when their mean direction is formed.
SLIGHT = 1e-3
# A joint is level where its normal is upright to this cosine, some 10 degrees. Where heads are as large as beds, the level bed
# below a stone leads by this share.
LEVEL, LEADING = 0.985, 0.02


def angle_to_joints(stones: Assemblage, contacts: Contacts, along: FloatArray, across: FloatArray) -> FloatArray:
    """Return how far the bed direction lies outside the directions of each stone's bed joints (nb,), degrees; nan without any.

    The joints of a voussoir are not parallel: inside it the bed direction turns from one joint to the other, so any direction
    between the two fits. Its bed joints are those with its neighbours in the ring, stones without a course like itself. The last
    voussoir of a ring has one such neighbour; the joint opposite, with a stone of a pier, counts too. A stone with more
    neighbours, or with none, lies in a wall drawn without courses or stands alone: there the joints count that are within
    45 degrees of the mean by area, and head joints do not. Of a stone of the lowest course or of the uppermost one the bed on
    the ground counts too, and the bed that it lies on for the one that it lacks above: else its two heads would outweigh it.

    Parameters
    ----------
    along, across: unit vectors (nb, 3) in the plane of each stone's wall: the bed direction, and that at right angles to it.
    """
    owner = contacts.blocks.ravel()
    normal, area = np.repeat(contacts.frame[:, 0], 2, axis=0), np.repeat(contacts.area, 2)
    # A joint is at right angles to its normal. What faces the front or back of the wall has no direction within it.
    up, level = np.einsum("kc,kc->k", normal, across[owner]), np.einsum("kc,kc->k", normal, along[owner])
    share: FloatArray = np.hypot(up, level)
    turn: FloatArray = np.arctan2(-level, up)
    loose = ~stones.coursed & ~stones.fixed
    in_ring = np.repeat(loose[contacts.blocks].all(axis=1), 2) & (share > 0.5)
    neighbours = np.bincount(owner[in_ring], minlength=stones.count)
    voussoir = np.isin(neighbours, (1, 2))
    alone: BoolArray = (neighbours == 0)[owner]
    leading: BoolArray = (in_ring & ~alone) | (alone & (share > 0.5))
    line = _inward_lines(stones, contacts, in_ring, along, across)
    # The extrados does not cross the line through its voussoir.
    crosses = np.abs(np.sin(turn - line[owner])) > LEAST_CROSSING
    leading |= (neighbours == 1)[owner] & crosses & (share > 0.5)
    in_wall: BoolArray = (neighbours > 2)[owner]
    leading |= in_wall & np.repeat(stones.fixed[contacts.blocks].any(axis=1), 2) & (share > 0.5)
    weight = np.where(leading, area * share**2, 0.0) * np.where(in_wall, _beds_below(stones, contacts, area), 1.0)
    # Two joints at right angles have no mean direction: of the two bisectors the bed is the one across the line.
    slight = SLIGHT * np.bincount(owner, weight, minlength=stones.count)
    mean = _mean_direction(
        stones.count,
        np.concatenate([owner, np.arange(stones.count)]),
        np.concatenate([turn, line + 0.5 * np.pi]),
        np.concatenate([weight, np.where(neighbours > 0, slight, 0.0)]),
    )
    off = _half_turn(turn - mean[owner])
    of_ring: BoolArray = voussoir[owner]
    beds: BoolArray = (of_ring & leading) | (~of_ring & (np.abs(off) < np.pi / 4) & (share > 0.5))
    low, high = np.full(stones.count, np.inf), np.full(stones.count, -np.inf)
    np.minimum.at(low, owner[beds], off[beds])
    np.maximum.at(high, owner[beds], off[beds])
    field = _half_turn(-mean)
    outside = np.maximum(np.maximum(low - field, field - high), 0.0)
    return np.degrees(np.where(np.isfinite(low), np.minimum(outside, np.pi - outside), np.nan))


def _beds_below(stones: Assemblage, contacts: Contacts, area: FloatArray) -> FloatArray:
    """Return by how much each joint (2 ni,), as seen from its first stone, then from its second, counts among those of the stone:
    a level joint below it up to twice, for as much of it as nothing lies on the stone above; all others once.

    A level joint on which a stone lies leads where its heads are as large, as those of cubes are.
    """
    owner = contacts.blocks.ravel()
    level = np.repeat(np.abs(contacts.frame[:, 0, 2]) > LEVEL, 2)
    below = np.repeat(_places(contacts)[:, 2], 2) < stones.centroid[owner, 2]
    under, over = (np.bincount(owner, area * (level & side), minlength=stones.count) for side in (below, ~below))
    bare = np.clip(1.0 - over / np.where(under > 0, under, 1.0), 0.0, 1.0)
    return np.where(level & below, (1.0 + bare[owner]) * (1.0 + LEADING), 1.0)


def _places(contacts: Contacts) -> FloatArray:
    """Return the middle (ni, 3) of the points of each joint, m."""
    count = np.diff(contacts.point_ptr)
    return np.add.reduceat(contacts.point, contacts.point_ptr[:-1], axis=0) / count[:, None]


def _inward_lines(
    stones: Assemblage, contacts: Contacts, in_ring: BoolArray, along: FloatArray, across: FloatArray
) -> FloatArray:
    """Return the direction (nb,) rad, from the bed direction, of the line from a joint in a ring to the centroid of the stone.

    in_ring (2 ni,): of each joint as seen from its first stone, then from its second.
    """
    owner = contacts.blocks.ravel()
    place = np.repeat(_places(contacts), 2, axis=0)
    inwards = np.zeros((stones.count, 3))
    inwards[owner[in_ring]] = stones.centroid[owner[in_ring]] - place[in_ring]
    return np.arctan2(np.einsum("bc,bc->b", inwards, across), np.einsum("bc,bc->b", inwards, along))


def _mean_direction(count: int, owner: IntArray, turn: FloatArray, weight: FloatArray) -> FloatArray:
    """Return the mean direction (count,) rad. Directions repeat after half a turn, so their doubles are averaged as angles."""
    sine, cosine = (np.bincount(owner, weight * part(2 * turn), minlength=count) for part in (np.sin, np.cos))
    return 0.5 * np.arctan2(sine, cosine)


def _half_turn(angle: FloatArray) -> FloatArray:
    """Return angles, rad, less whole half turns: from -pi/2 to pi/2."""
    return np.mod(angle + 0.5 * np.pi, np.pi) - 0.5 * np.pi
