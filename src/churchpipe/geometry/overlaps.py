"""What polygons have in common, pair by pair, as convex outlines: of faces that lie on each other, mostly convex and many."""

from typing import NamedTuple

import numba
import numpy as np

from churchpipe.geometry.planar import areas, intersections, outer_rings, perimeters, polygons_of, simple_hulls
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray, pointer_of, ragged_indices

# A corner turns the other way where the product of its edges is below this share of the squared length of the outline.
_TURNED = 1e-12


class Outlines(NamedTuple):
    """Polygons (n,) without holes: corner (nc, 2), and start (n + 1,) where those of each begin."""

    corner: FloatArray
    start: IntArray

    def of(self, chosen: IntArray) -> "Outlines":
        """Return the chosen ones (k,)."""
        count = np.diff(self.start)[chosen]
        return Outlines(self.corner[ragged_indices(self.start[chosen], count)], pointer_of(count))


class Overlaps(NamedTuple):
    """What pairs of polygons (n,) have in common: area and perimeter (n,), and the convex hulls.

    These run clockwise from the corner that is farthest to the left, and have no corners where there is nothing.
    """

    hull: Outlines
    area: FloatArray
    perimeter: FloatArray


def overlaps(first: Outlines, second: Outlines, tolerance: float) -> Overlaps:
    """Return what the polygons of two lists (n,) have in common; corners less than a tolerance off a straight edge are left out.

    Convex ones are clipped by each other's edges (Sutherland and Hodgman 1974), which loses no area between edges that all but
    coincide; others are left to GEOS.
    """
    convex = _convex(*first) & _convex(*second)
    room = np.where(convex, np.diff(first.start) + np.diff(second.start), 0)
    start = pointer_of(room)
    corner, count = np.empty((start[-1], 2)), np.zeros(len(room), dtype=np.int64)
    area, perimeter = np.zeros(len(room)), np.zeros(len(room))
    _clip(*first, *second, start, tolerance, corner, count, area, perimeter)
    hull = Outlines(corner[ragged_indices(start[:-1], count)], pointer_of(count))
    if convex.all():
        return Overlaps(hull, area, perimeter)
    rest = np.flatnonzero(~convex)
    common = intersections(*(polygons_of(*polygons.of(rest)) for polygons in (first, second)))
    area[rest], perimeter[rest] = areas(common), perimeters(common)
    more, owner = outer_rings(simple_hulls(common, tolerance))
    every, of = np.concatenate([hull.corner, more]), np.concatenate([np.repeat(np.arange(len(count)), count), rest[owner]])
    order = np.argsort(of, kind="stable")
    return Overlaps(Outlines(every[order], pointer_of(np.bincount(of, minlength=len(count)))), area, perimeter)


@numba.njit(cache=True)
def _convex(corner: FloatArray, start: IntArray) -> BoolArray:
    """Return which outlines, none of which crosses itself, turn one way at all of their corners."""
    out = np.ones(len(start) - 1, dtype=np.bool_)
    for k in range(len(out)):
        low, count = start[k], start[k + 1] - start[k]
        length = least = most = 0.0
        for i in range(count):
            a, b, c = corner[low + i], corner[low + (i + 1) % count], corner[low + (i + 2) % count]
            turn = (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])
            least, most = min(least, turn), max(most, turn)
            length += np.hypot(b[0] - a[0], b[1] - a[1])
        out[k] = least >= -_TURNED * length**2 or most <= _TURNED * length**2
    return out


@numba.njit(cache=True)
def _clip(
    corner: FloatArray,
    start: IntArray,
    other: FloatArray,
    other_start: IntArray,
    place: IntArray,
    tolerance: float,
    hull: FloatArray,
    count: IntArray,
    area: FloatArray,
    perimeter: FloatArray,
) -> None:
    """Clip the polygons for which there is room in hull, from place on, and write how many corners each one has there."""
    widest = 0
    for k in range(len(count)):
        widest = max(widest, place[k + 1] - place[k])
    one, two = np.empty((widest + 1, 2)), np.empty((widest + 1, 2))
    for k in range(len(count)):
        if place[k + 1] == place[k]:
            continue
        found = start[k + 1] - start[k]
        one[:found] = corner[start[k] : start[k + 1]]
        low, sides = other_start[k], other_start[k + 1] - other_start[k]
        turn = 1.0 if _doubled(other[low : low + sides], sides) > 0 else -1.0
        for i in range(sides):
            if found > 0:
                found = _cut(one, found, other[low + i], other[low + (i + 1) % sides], turn, two)
                one, two = two, one
        if found < 3:
            continue
        size = _doubled(one, found)
        area[k] = 0.5 * abs(size)
        for i in range(found):
            j = (i + 1) % found
            perimeter[k] += np.hypot(one[j, 0] - one[i, 0], one[j, 1] - one[i, 1])
        found = _straightened(one, found, tolerance)
        first = 0
        for i in range(1, found):
            if one[i, 0] < one[first, 0] or (one[i, 0] == one[first, 0] and one[i, 1] < one[first, 1]):
                first = i
        for i in range(found):
            hull[place[k] + i] = one[(first + (found - i if size > 0 else i)) % found]
        count[k] = found


@numba.njit(cache=True)
def _doubled(ring: FloatArray, count: int) -> float:
    """Return twice the area of a ring of so many corners, positive where it runs counter-clockwise."""
    total = 0.0
    for i in range(1, count - 1):
        total += (ring[i, 0] - ring[0, 0]) * (ring[i + 1, 1] - ring[0, 1])
        total -= (ring[i, 1] - ring[0, 1]) * (ring[i + 1, 0] - ring[0, 0])
    return total


@numba.njit(cache=True)
def _cut(ring: FloatArray, count: int, a: FloatArray, b: FloatArray, turn: float, out: FloatArray) -> int:
    """Write what of a ring lies to the left of the line from a to b, to the right where turn is -1, and return its corners."""
    u, v = turn * (b[0] - a[0]), turn * (b[1] - a[1])
    found = 0
    before = u * (ring[count - 1, 1] - a[1]) - v * (ring[count - 1, 0] - a[0])
    for i in range(count):
        p = ring[i]
        here = u * (p[1] - a[1]) - v * (p[0] - a[0])
        if (here > 0.0 and before < 0.0) or (here < 0.0 and before > 0.0):
            q = ring[i - 1 if i > 0 else count - 1]
            share = before / (before - here)
            out[found, 0], out[found, 1] = q[0] + share * (p[0] - q[0]), q[1] + share * (p[1] - q[1])
            found += 1
        if here >= 0.0:
            out[found] = p
            found += 1
        before = here
    return found


@numba.njit(cache=True)
def _straightened(ring: FloatArray, count: int, tolerance: float) -> int:
    """Leave out corners less than a tolerance off the line between their neighbours, in place, and return how many are left."""
    i = kept_in_a_row = 0
    while count > 3 and kept_in_a_row < count:
        p, q, r = ring[(i - 1) % count], ring[i], ring[(i + 1) % count]
        u, v = r[0] - p[0], r[1] - p[1]
        length = np.hypot(u, v)
        off = u * (q[1] - p[1]) - v * (q[0] - p[0])
        if abs(off) < tolerance * length or length == 0.0:
            ring[i : count - 1] = ring[i + 1 : count].copy()
            count -= 1
            i, kept_in_a_row = (i - 1) % count, 0
        else:
            i, kept_in_a_row = (i + 1) % count, kept_in_a_row + 1
    return count
