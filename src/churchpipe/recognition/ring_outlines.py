"""The outline of an arch or of a ring that is drawn whole: whether it is one, and about which centre."""

from dataclasses import dataclass

import numpy as np

from churchpipe.geometry.planar import Polygon, boxes, common, pieces, rings
from churchpipe.geometry.polygons import corners, snap_polygons
from churchpipe.model.arrays import FloatArray, IntArray

# At a corner between the arc and the end of a ring the outline turns by more than this (rad), from chord to chord by less.
TURN = np.radians(50.0)
# Corners of a ring lie on its two circles within this share of its radius.
ROUND = 0.02


@dataclass(frozen=True, slots=True)
class RingOutline:
    """A ring, or half of a full one: its outline (n, 2) m, extrados first and both counter-clockwise as `ring_outline` has them,
    its centre, and the length of its mid-line, m."""

    outline: FloatArray
    centre: tuple[float, float]
    length: float
    depth: float


def main_corners(ring: FloatArray) -> IntArray:
    """Return the numbers of the corners at which a closed outline (n, 2), counter-clockwise, turns sharply."""
    side = np.roll(ring, -1, axis=0) - ring
    before = np.roll(side, 1, axis=0)
    cross = before[:, 0] * side[:, 1] - before[:, 1] * side[:, 0]
    return np.flatnonzero(np.abs(np.arctan2(cross, np.einsum("nc,nc->n", before, side))) > TURN)


def ring_outlines(region: Polygon) -> list[RingOutline]:
    """Return the ring that a region is, a full one as two halves; nothing for any other shape.

    A ring lies between two arcs about one centre, each of two chords or more, and two straight ends.
    """
    outer, *inner = rings(region)
    if len(inner) == 1:
        circles = outer[:-1], inner[0][:-1]
        centre, radii = _circles(*circles)
        if min(map(len, circles)) < 6 or not _on(centre, radii, *circles):
            return []
        reach = 2 * radii[0]
        boxed = boxes(np.tile(centre, 2) + reach * np.array([[-1, 0, 1, 1], [-1, -1, 1, 0]]))
        found = [half for box in boxed for half in pieces(common(region, box))]
        return [ring for half in found for ring in ring_outlines(half)] if len(found) == 2 else []
    return _open_ring(region) if not inner else []


def _open_ring(region: Polygon) -> list[RingOutline]:
    ring = corners(snap_polygons(np.array([region], dtype=np.object_))[0])[0]
    sharp = main_corners(ring)
    if len(sharp) != 4:
        return []
    ring, sharp = np.roll(ring, -int(sharp[0]), axis=0), sharp - sharp[0]
    ends = [*sharp[1:].tolist(), len(ring)]
    sides = [np.concatenate([ring, ring[:1]])[start : stop + 1] for start, stop in zip(sharp, ends, strict=True)]
    if len(sides[0]) == 2:
        sides = [*sides[1:], sides[0]]
    if [len(side) > 2 for side in sides] != [True, False, True, False]:
        return []
    # Counter-clockwise about the region, the extrados is the arc that turns to the left.
    first, second = sides[0], sides[2]
    outside, inside = (first, second) if _swept(first) > 0 else (second, first)
    centre, radii = _circles(outside, inside)
    if not _on(centre, radii, outside, inside):
        return []
    spoke = 0.5 * (outside[[0, -1]] + inside[[-1, 0]]) - centre
    angle = np.arctan2(spoke[:, 1], spoke[:, 0])
    sweep = float(np.mod(angle[1] - angle[0], 2 * np.pi))
    mean = 0.5 * (radii[0] + radii[1])
    x, y = centre.tolist()
    return [RingOutline(np.concatenate([outside, inside]), (x, y), sweep * mean, radii[0] - radii[1])]


def _swept(arc: FloatArray) -> float:
    """Return twice the area between an arc and its chord, positive where it turns to the left."""
    local = arc - arc[0]
    return float((local[:-1, 0] * local[1:, 1] - local[:-1, 1] * local[1:, 0]).sum())


def _circles(outside: FloatArray, inside: FloatArray) -> tuple[FloatArray, tuple[float, float]]:
    """Return the common centre (2,) of two arcs (n, 2) and their radii, by least squares."""
    points = np.concatenate([outside, inside])
    of_first = np.arange(len(points)) < len(outside)
    middle = points.mean(axis=0)
    local = points - middle
    matrix = np.column_stack([2 * local, of_first, ~of_first])
    found = np.linalg.lstsq(matrix, (local**2).sum(axis=1), rcond=None)[0]
    square = found[2:] + found[:2] @ found[:2]
    return middle + found[:2], (float(np.sqrt(max(square[0], 0.0))), float(np.sqrt(max(square[1], 0.0))))


def _on(centre: FloatArray, radii: tuple[float, float], outside: FloatArray, inside: FloatArray) -> bool:
    """Return whether the corners lie on their circles, one inside the other."""
    arcs = zip((outside, inside), radii, strict=True)
    off = [np.abs(np.linalg.norm(arc - centre, axis=1) - radius).max() for arc, radius in arcs]
    return radii[0] > radii[1] > 0 and max(off) < ROUND * radii[0]
