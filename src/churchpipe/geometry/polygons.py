"""Polygons in chart coordinates: exact shared corners, flat corner arrays, areas."""

import numpy as np
import shapely

from churchpipe.geometry.planar import Polygons, all_coordinates, moved, outer_rings, simple_parts
from churchpipe.model.arrays import FloatArray, IntArray, pointer_of

# Coordinates closer than this are taken as equal, m.
TOLERANCE = 1e-9
# A corner this close to the line through its neighbours, m, is left out. The check of volumes does not notice the difference.
STRAIGHT = 1e-10


def snap(values: FloatArray) -> FloatArray:
    """Return the values with every cluster closer than `TOLERANCE` replaced by its smallest member."""
    flat = values.ravel()
    if not flat.size:
        return values
    order = np.argsort(flat, kind="stable")
    ordered = flat[order]
    leader = np.maximum.accumulate(np.where(np.diff(ordered, prepend=-np.inf) > TOLERANCE, np.arange(flat.size), 0))
    out = np.empty_like(flat)
    out[order] = ordered[leader]
    return out.reshape(values.shape)


def snap_onto(values: FloatArray, marks: FloatArray) -> FloatArray:
    """Return the values, those closer than `TOLERANCE` to one of the marks replaced by it."""
    if not len(marks) or not values.size:
        return values
    ordered = np.sort(marks)
    place = np.searchsorted(ordered, values)
    left, right = ordered[np.maximum(place - 1, 0)], ordered[np.minimum(place, len(ordered) - 1)]
    nearest = np.where(np.abs(values - left) <= np.abs(right - values), left, right)
    return np.where(np.abs(nearest - values) <= TOLERANCE, nearest, values)


def snap_polygons(polygons: Polygons) -> tuple[Polygons, IntArray]:
    """Return the polygons with nearly equal s and nearly equal t coordinates made equal, and the polygon (n,) each comes from.

    Where a polygon is narrower than the tolerance it falls into two that touch in a point.
    """
    point = all_coordinates(polygons)
    return simple_parts(moved(polygons, np.stack([snap(point[:, 0]), snap(point[:, 1])], axis=1)))


def corners(polygons: Polygons) -> tuple[FloatArray, IntArray]:
    """Return the corners (nc, 2) m of simple polygons, counter-clockwise from the lowest left one, and their pointer array.

    Repeated corners and corners on a straight edge are left out.
    """
    point, owner = outer_rings(polygons)
    before, after = _neighbours(owner, len(polygons))
    clockwise = np.bincount(owner, _cross(point, point[after]), minlength=len(polygons)) < 0
    while True:
        repeated = (point == point[before]).all(axis=1)
        chord, reach = point[after] - point[before], point - point[before]
        length = np.linalg.norm(chord, axis=1)
        straight = np.abs(_cross(chord, reach)) <= STRAIGHT * length
        drop = repeated | (straight & ~repeated[before] & ~repeated[after])
        if not drop.any():
            break
        point, owner = point[~drop], owner[~drop]
        before, after = _neighbours(owner, len(polygons))
    pointer = pointer_of(np.bincount(owner, minlength=len(polygons)))
    turned = np.where(clockwise[owner], pointer[owner] + pointer[owner + 1] - 1 - np.arange(len(owner)), np.arange(len(owner)))
    return _from_lowest_left(point[turned], owner, pointer), pointer


def polygon_areas(corner: FloatArray, corner_ptr: IntArray) -> FloatArray:
    """Return the signed areas (n,) m2 of polygons given as a flat corner array."""
    owner = np.repeat(np.arange(len(corner_ptr) - 1), np.diff(corner_ptr))
    local = corner - corner[corner_ptr[owner]]
    _, after = _neighbours(owner, len(corner_ptr) - 1)
    twice = np.bincount(owner, _cross(local, local[after]), minlength=len(corner_ptr) - 1)
    return 0.5 * twice.astype(np.float64)


def symmetric_parts(corner: FloatArray, corner_ptr: IntArray, centre: FloatArray) -> tuple[FloatArray, IntArray]:
    """Return what convex polygons share with their reflections about a point (n, 2) inside each, both as flat corner arrays."""
    owner = np.repeat(np.arange(len(corner_ptr) - 1), np.diff(corner_ptr))
    whole = shapely.polygons(shapely.linearrings(corner, indices=owner))
    reflected = shapely.polygons(shapely.linearrings(2.0 * centre[owner] - corner, indices=owner))
    return corners(np.asarray(shapely.intersection(whole, reflected)))


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


def _neighbours(owner: IntArray, count: int) -> tuple[IntArray, IntArray]:
    """Return the positions of the corners before and after each corner of its ring."""
    sizes = np.bincount(owner, minlength=count)
    stop = np.cumsum(sizes)
    start = stop - sizes
    position = np.arange(len(owner))
    before = np.where(position == start[owner], stop[owner], position) - 1
    after = np.where(position == stop[owner] - 1, start[owner], position + 1)
    return before, after


def _from_lowest_left(point: FloatArray, owner: IntArray, pointer: IntArray) -> FloatArray:
    """Rotate each ring so that it starts at its lowest, then leftmost corner."""
    order = np.lexsort((point[:, 0], point[:, 1], owner))
    shift = order[pointer[owner]] - pointer[owner]
    local = np.arange(len(owner)) - pointer[owner]
    size = np.diff(pointer)[owner]
    return point[pointer[owner] + (local + shift) % size]


def below(corner: FloatArray, level: float) -> FloatArray:
    """Return the part (n, 3) m of a plane polygon in space with corners (k, 3) m below a level z, m."""
    return behind(corner, np.array([0.0, 0.0, 1.0]), level)


def behind(corner: FloatArray, axis: FloatArray, level: float) -> FloatArray:
    """Return the part (n, 3) m of a plane polygon in space with corners (k, 3) m up to a level, m, along an axis (3,)."""
    beyond = corner @ axis - level
    found: list[FloatArray] = []
    for k, first in enumerate(corner):
        following = (k + 1) % len(corner)
        if beyond[k] <= 0:
            found.append(first)
        if np.sign(beyond[k]) * np.sign(beyond[following]) < 0:
            found.append(first - beyond[k] / (beyond[following] - beyond[k]) * (corner[following] - first))
    return np.array(found).reshape(-1, 3)
