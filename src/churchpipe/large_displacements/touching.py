"""Stones that touch, or nearly, wherever they have moved to."""

from typing import NamedTuple

import numpy as np

from churchpipe.geometry.overlaps import Outlines, overlaps
from churchpipe.geometry.planar import meeting
from churchpipe.large_displacements.crushed import bearing_margin, rectangles_of, with_lines_of_equal_gap
from churchpipe.large_displacements.edges import edge_normals
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray, pointer_of, ragged_indices
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.model.polyhedra import face_normals

# Faces turned further than this from facing each other, rad, do not bear on each other.
_STEEPEST = np.radians(50.0)
# A corner this near to the line between its neighbours, over the width of the narrowest overlap, is none. Where edges of two
# stones all but coincide, corner and crossing lie side by side: to take one for the other would move a hinge by as much.
_STRAIGHT = 1e-3


class Touching(NamedTuple):
    """Contacts of displaced stones.

    gap (nc,) m of their points. Of joints that crush: place (nc, 2) of the points in the rectangle that bears, from -1 to 1;
    rectangle (ni,) m2, its area; margin (ni,) m, up to which gap it bears. Zeros where joints do not crush.
    """

    contacts: Contacts
    gap: FloatArray
    place: FloatArray
    rectangle: FloatArray
    margin: FloatArray


def touching(
    stones: Assemblage, left_out: BoolArray, reach: float, depth: float, narrow: float, *, crushing: bool = False
) -> Touching:
    """Return the contacts of displaced stones.

    Faces that look at each other are projected onto the plane between them; where the projections overlap, the distance of
    the faces is linear. It is a joint where its least distance lies between -depth and reach, and its points are the corners no
    further apart than reach. The point of a contact lies on its second stone, and its normal is that of `edge_normals`.

    Parameters
    ----------
    stones: as displaced. left_out (nb,): stones that touch nothing. reach, depth: m. narrow: m; stones that meet along an edge
    overlap in a strip as wide as one has sunk into the other, so that overlaps narrower than this are no joints. crushing: joints
    press along the normal of the second face, in which their points lie, and have points on lines of equal gap (`crushed`).
    """
    _, normal, mean = face_normals(stones.points, stones.face_nodes, stones.face_ptr)
    first, second = _face_pairs(stones, normal, _stone_pairs(stones, left_out, reach), reach)
    n = -normal[second] if crushing else normal[first] - normal[second]
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    axes = frames(n)[:, 1:]
    centre = 0.5 * (mean[first] + mean[second])
    one, other = (_projected(stones, face, axes, centre) for face in (first, second))
    hull, area, perimeter = overlaps(one, other, _STRAIGHT * narrow)
    chosen = np.flatnonzero(2 * area > narrow * perimeter)
    corner, start = hull.of(chosen)
    owner = np.repeat(np.arange(len(chosen)), np.diff(start))

    def on_second(corner: FloatArray, pair: IntArray) -> tuple[FloatArray, FloatArray]:
        flat = centre[pair] + np.einsum("ka,kac->kc", corner, axes[pair])
        height = [
            np.einsum("kc,kc->k", mean[f[pair]] - flat, normal[f[pair]]) / np.einsum("kc,kc->k", n[pair], normal[f[pair]])
            for f in (first, second)
        ]
        return flat + height[1][:, None] * n[pair], height[1] - height[0]

    _, gap = on_second(corner, chosen[owner])
    least = np.full(len(chosen), np.inf)
    np.minimum.at(least, owner, gap)
    place, rectangle, margin = np.zeros((len(corner), 2)), np.zeros(len(chosen)), np.zeros(len(chosen))
    if crushing and len(chosen):
        place, share = rectangles_of(corner, start[:-1])
        rectangle, margin = share * area[chosen], bearing_margin(least, reach)
        both, owner = with_lines_of_equal_gap(np.column_stack([corner, place]), gap, owner, margin, reach)
        corner, place = both[:, :2], both[:, 2:]
    pair = chosen[owner]
    point, gap = on_second(corner, pair)
    keep = (gap <= reach) & ((least >= -depth) & (least <= reach))[owner]
    pair, owner, point, place = pair[keep], owner[keep], point[keep], place[keep]
    edge = n[pair] if crushing else edge_normals(stones, first[pair], second[pair], normal, point, 0.1 * narrow)
    # Points side by side share an interface where they share a normal.
    begins = np.append(True, (np.diff(pair) != 0) | (np.abs(np.diff(edge, axis=0)) > 0).any(axis=1))[: len(pair)]
    start = np.flatnonzero(begins)
    block = np.repeat(np.arange(stones.count), np.diff(stones.block_face_ptr))
    contacts = Contacts(
        blocks=np.stack([block[first[pair[start]]], block[second[pair[start]]]], axis=1),
        frame=frames(edge[start]),
        area=area[pair[start]],
        point=point,
        point_ptr=np.append(start, len(pair)),
        kind=np.full(len(start), "bed"),
    )
    return Touching(contacts, gap[keep], place, rectangle[owner[start]], margin[owner[start]])


def frames(n: FloatArray) -> FloatArray:
    """Return right-handed frames (k, 3, 3), rows n, t1, t2, of unit normals (k, 3)."""
    helper = np.where(np.abs(n[:, 2:]) > 0.9, [1.0, 0.0, 0.0], [0.0, 0.0, 1.0])
    t1 = np.cross(helper, n)
    t1 /= np.linalg.norm(t1, axis=1, keepdims=True)
    return np.stack([n, t1, np.cross(n, t1)], axis=1).astype(np.float64)


def _stone_pairs(stones: Assemblage, left_out: BoolArray, reach: float) -> IntArray:
    """Return pairs (k, 2) of stones, first < second, whose boxes come within reach; not both of them fixed."""
    low, high = (edge.reduceat(stones.points, stones.block_point_ptr[:-1], axis=0) for edge in (np.minimum, np.maximum))
    half = 0.5 * reach
    plan = np.column_stack([low[:, :2] - half, high[:, :2] + half])
    # Most stones of a large structure are held: only those near free ones are looked for.
    free, chosen = np.flatnonzero(~left_out & ~stones.fixed), np.flatnonzero(~left_out)
    one, other = meeting(plan[free], plan[chosen]).T
    one, other = free[one], chosen[other]
    once = stones.fixed[other] | (one < other)
    one, other = np.minimum(one, other)[once], np.maximum(one, other)[once]
    near = (low[one, 2] <= high[other, 2] + reach) & (low[other, 2] <= high[one, 2] + reach)
    return np.stack([one[near], other[near]], axis=1)


def _face_pairs(stones: Assemblage, normal: FloatArray, pairs: IntArray, reach: float) -> tuple[IntArray, IntArray]:
    """Return the faces (k,) and (k,) of pairs of stones that look at each other, boxes within reach."""
    start, count = stones.block_face_ptr[:-1], np.diff(stones.block_face_ptr)
    one, other = pairs.T
    first = ragged_indices(start[one], count[one])
    partner = np.repeat(other, count[one])
    times = count[partner]
    second = ragged_indices(start[partner], times)
    first = np.repeat(first, times)
    facing = np.einsum("kc,kc->k", normal[first], normal[second]) < -np.cos(_STEEPEST)
    first, second = first[facing], second[facing]
    corner = stones.points[stones.face_nodes]
    low, high = (edge.reduceat(corner, stones.face_ptr[:-1], axis=0) for edge in (np.minimum, np.maximum))
    near = ((low[first] <= high[second] + reach) & (low[second] <= high[first] + reach)).all(axis=1)
    return first[near], second[near]


def _projected(stones: Assemblage, face: IntArray, axes: FloatArray, centre: FloatArray) -> Outlines:
    """Return the outlines of faces (k,) in planes of their own, with axes (k, 2, 3) and origins (k, 3)."""
    start, count = stones.face_ptr[face], np.diff(stones.face_ptr)[face]
    owner = np.repeat(np.arange(len(face)), count)
    arm = stones.points[stones.face_nodes[ragged_indices(start, count)]] - centre[owner]
    return Outlines(np.einsum("kc,kac->ka", arm, axes[owner]), pointer_of(count))
