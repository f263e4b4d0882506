"""How far a given direction lies outside the bed joints of stones that lie in no course."""

import numpy as np

from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.model.polyhedra import face_normals

# A joint crosses the line through a voussoir where the sine of their angle is at least this.
LEAST_CROSSING = 0.4
# Weight of that line among the joints of its stone when their mean direction is formed.
SLIGHT = 1e-3
# A joint is level or upright within this angle, rad: a millimetre of rounding in the height of a brick.
ALIGNED = 0.02
# A stone is laid in a wall, and no voussoir, if more than this part of its joints is level or upright. Of the crown of an arch a
# chord or two are.
LAID = 0.4
# Joints of a stone lie in two directions at right angles if the mean of their directions, repeated after a quarter turn, is at
# least this long: 1 where they do exactly, .98 with deviations of 3 degrees.
SQUARE = 0.98


def angle_to_joints(stones: Assemblage, contacts: Contacts, along: FloatArray, across: FloatArray) -> FloatArray:
    """Return how far the bed direction lies outside the directions of each stone's bed joints (nb,), degrees; nan without any.

    The joints of a voussoir are not parallel: inside it the bed direction turns from one joint to the other, so any direction
    between the two fits. Its bed joints are those with its neighbours in the ring, stones without a course like itself. The last
    voussoir of a ring has one such neighbour; the joint opposite, with a stone of a pier, counts too, and where there is none,
    as at the end of a ruined arch, the face opposite. A stone with more neighbours, or with none, lies in a wall drawn without
    courses or stands alone: there the joints count that are within 45 degrees of the mean by area, and head joints do not. Where
    one of its joints is level and one upright, the level ones lead: the heads of a short stone, or the back of an arch that cuts
    it, may be larger than its beds. In rings of voussoirs side by side the joints between two rings are upright, and larger than
    the beds where rings are narrow: so inclined joints lead where upright ones meet them at right angles. No voussoir has
    both: a stone with level and upright faces alone that has joints of both kinds is none, however few neighbours it has. A
    voussoir in the middle of a wall has more than two, but only two that are not laid in the wall; of both ways to read such
    a stone the one that fits better counts.

    Parameters
    ----------
    along, across: unit vectors (nb, 3) in the plane of each stone's wall: the bed direction, and that at right angles to it.
    """
    owner = contacts.blocks.ravel()
    normal, area = np.repeat(contacts.frame[:, 0], 2, axis=0), np.repeat(contacts.area, 2)
    share, _ = _within_wall(normal, along[owner], across[owner])
    loose = ~stones.coursed & ~stones.fixed
    in_ring = np.repeat(loose[contacts.blocks].all(axis=1), 2) & (share > 0.5)
    laid, square = _laid(stones, owner, normal, np.where(share > 0.5, area, 0.0))
    unlaid = in_ring & np.repeat(~laid[contacts.blocks].any(axis=1), 2)
    neighbours, others = (np.bincount(owner[own], minlength=stones.count) for own in (in_ring, unlaid))
    within_wall = (neighbours > 2) & np.isin(others, (1, 2))
    apart = np.where(within_wall[owner], unlaid, in_ring), np.where(within_wall, others, neighbours)
    readings = ((in_ring, neighbours), apart)
    return np.fmin(*(_outside(stones, contacts, along, across, *reading, square) for reading in readings))


def _outside(
    stones: Assemblage,
    contacts: Contacts,
    along: FloatArray,
    across: FloatArray,
    in_ring: BoolArray,
    neighbours: IntArray,
    square: BoolArray,
) -> FloatArray:
    """Return the angles (nb,) of `angle_to_joints` for one way to read the stones.

    in_ring: which joints, as seen from either stone, are those of a ring. neighbours (nb,): how many of them each stone has.
    square (nb,): stones that are no voussoirs.
    """
    owner = contacts.blocks.ravel()
    normal, area = np.repeat(contacts.frame[:, 0], 2, axis=0), np.repeat(contacts.area, 2)
    share, turn = _within_wall(normal, along[owner], across[owner])
    voussoir = np.isin(neighbours, (1, 2)) & ~square
    alone: BoolArray = ((neighbours == 0) | square)[owner]
    leading: BoolArray = (in_ring & ~alone) | (alone & (share > 0.5))
    line = _inward_lines(stones, contacts, in_ring, along, across)
    # The extrados does not cross the line through its voussoir.
    crosses = np.abs(np.sin(turn - line[owner])) > LEAST_CROSSING
    leading |= (neighbours == 1)[owner] & crosses & (share > 0.5)
    one_joint = (neighbours == 1) & ~_any(stones.count, owner[leading & ~in_ring])
    end, end_normal, end_area = _free_ends(stones, np.flatnonzero(one_joint), line, along, across)
    owner, normal, area = np.concatenate([owner, end]), np.concatenate([normal, end_normal]), np.concatenate([area, end_area])
    leading = np.concatenate([leading, np.ones(len(end), dtype=np.bool_)])
    share, turn = _within_wall(normal, along[owner], across[owner])
    level, upright = _aligned(normal)
    steep = leading & upright
    weight = np.where(leading, area * share**2, 0.0)
    flat = leading & (level | _inclined_beds(stones.count, owner, turn, weight, level, upright))
    squared = ((neighbours > 2) | square) & (_any(stones.count, owner[flat]) & _any(stones.count, owner[steep]))
    weight *= np.where(squared[owner] & ~flat, SLIGHT, 1.0)
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


def _laid(stones: Assemblage, owner: IntArray, normal: FloatArray, area: FloatArray) -> tuple[BoolArray, BoolArray]:
    """Return which stones (nb,) are laid in a wall, and which have level and upright faces alone, and joints of both kinds.

    Half an arch has such joints as well, but no such intrados. owner, normal, area: of each joint as seen from either of its
    stones; an area of 0 does not count.
    """
    level, upright = _aligned(normal)
    whole, flat, steep = (np.bincount(owner, np.where(own, area, 0.0), stones.count) for own in (area > 0, level, upright))
    _, unit, _ = face_normals(stones.points, stones.face_nodes, stones.face_ptr)
    straight = np.logical_and.reduceat(np.logical_or(*_aligned(unit)), stones.block_face_ptr[:-1])
    return flat + steep > LAID * whole, (flat > 0) & (steep > 0) & straight


def _inclined_beds(
    count: int, owner: IntArray, turn: FloatArray, weight: FloatArray, level: BoolArray, upright: BoolArray
) -> BoolArray:
    """Return the joints (k,) neither level nor upright of stones without level ones, whose joints meet at right angles."""
    sine, cosine, whole = (np.bincount(owner, weight * part, count) for part in (np.sin(4 * turn), np.cos(4 * turn), 1.0))
    square = np.hypot(sine, cosine) > SQUARE * whole
    return ~level & ~upright & (square & ~_any(count, owner[level & (weight > 0)]))[owner]


def _aligned(normal: FloatArray) -> tuple[BoolArray, BoolArray]:
    """Return which faces with these normals (k, 3) are level, and which upright."""
    return np.abs(normal[:, 2]) > 1 - ALIGNED**2 / 2, np.abs(normal[:, 2]) < ALIGNED


def _within_wall(normal: FloatArray, along: FloatArray, across: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the part of unit normals (k, 3) within the plane of the wall (k,), and the direction of their joints (k,), rad.

    A joint is at right angles to its normal. What faces the front or back of the wall has no direction within it.
    """
    up, level = np.einsum("kc,kc->k", normal, across), np.einsum("kc,kc->k", normal, along)
    return np.hypot(up, level), np.arctan2(-level, up)


def _free_ends(
    stones: Assemblage, last: IntArray, line: FloatArray, along: FloatArray, across: FloatArray
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Return the last voussoirs (k,) that end in a face across the line through them, its normal (k, 3) and its area (k,), m2.

    last (m,): voussoirs that bear on one neighbour only. line (nb,): from that joint through the stone, rad from the bed.
    """
    found: list[int] = []
    normals: list[FloatArray] = []
    for stone in last.tolist():
        faces = slice(*stones.block_face_ptr[stone : stone + 2])
        pointer = stones.face_ptr[faces.start : faces.stop + 1]
        vector, unit, _ = face_normals(stones.points, stones.face_nodes[pointer[0] : pointer[-1]], pointer - pointer[0])
        inwards = np.cos(line[stone]) * along[stone] + np.sin(line[stone]) * across[stone]
        facing = int(np.argmax(unit @ inwards))
        if unit[facing] @ inwards > LEAST_CROSSING:
            found.append(stone)
            normals.append(vector[facing])
    normal = np.array(normals).reshape(-1, 3)
    area = np.linalg.norm(normal, axis=1)
    return np.array(found, dtype=np.int64), normal / area[:, None], area


def _any(count: int, owner: IntArray) -> BoolArray:
    """Return which of `count` stones are among the owners of joints."""
    found = np.zeros(count, dtype=np.bool_)
    found[owner] = True
    return found


def _inward_lines(
    stones: Assemblage, contacts: Contacts, in_ring: BoolArray, along: FloatArray, across: FloatArray
) -> FloatArray:
    """Return the direction (nb,) rad, from the bed direction, of the line from a joint in a ring to the centroid of the stone.

    in_ring (2 ni,): of each joint as seen from its first stone, then from its second.
    """
    owner = contacts.blocks.ravel()
    count = np.diff(contacts.point_ptr)
    place = np.repeat(np.add.reduceat(contacts.point, contacts.point_ptr[:-1], axis=0) / count[:, None], 2, axis=0)
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
