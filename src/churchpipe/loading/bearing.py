"""Which stones bear a line, and where."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from churchpipe.errors import InputError
from churchpipe.geometry.walls import points_of
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray, pointer_of, ragged_indices
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.polyhedra import face_normals

# Lengths below this are rounding, m.
CLOSE = 1e-5
# A face that looks up has at least this z in its normal, and more than so much of plan, m2, unless it is a sliver.
_UP, _SLIVER = 0.05, 1e-7


@dataclass(frozen=True, slots=True)
class Stretches:
    """Where stones bear a line: start, end (n,) m along it, the stone (n,) and its share there; z (n, 2) m at both ends."""

    start: FloatArray
    end: FloatArray
    stone: IntArray
    share: FloatArray
    z: FloatArray


def bearing_stones(
    stones: Assemblage, start: FloatArray, end: FloatArray, height: float, *, on_top: bool, where: str
) -> Stretches:
    """Return the stones that bear a line between two points (2,) m in plan.

    on_top: the highest stones under it, none above `height`; else the stones at that height, at a bed joint those below it. Where
    the line runs along a joint both sides take half. On top, stones and their faces that look up count by the convex hull of
    their plan, at a height by their section.

    Raises
    ------
    InputError: a part of the line has no stone under it.
    """
    length = float(np.linalg.norm(end - start))
    axis = (end - start) / length if length else np.array([1.0, 0.0])
    low, high, candidates = _spans(stones, start, axis, length, height, on_top=on_top)
    sides = _upper_sides(stones, candidates, start, axis) if on_top else None
    # Where another face of a stone begins, such as at a ridge, its upper side goes on at another slope.
    edges = [] if sides is None else [sides.enters[sides.met], sides.leaves[sides.met]]
    stops = np.unique(np.clip(np.concatenate([[0.0, length], low, high, *edges]), 0.0, length))
    stops = stops[np.append(True, np.diff(stops) > CLOSE)]
    stops[-1] = length
    ends = np.stack([stops[:-1], stops[1:]], axis=1) if len(stops) > 1 else np.array([[0.0, 0.0]])
    middle = ends.mean(axis=1)
    part, rank = np.nonzero((low <= middle[:, None]) & (high >= middle[:, None]))
    z = np.full((len(part), 2), height)
    if sides is not None:
        top = _tops(sides, rank, middle[part], start + middle[part, None] * axis)
        highest = np.full(len(ends), -np.inf)
        np.maximum.at(highest, part, top)
        bears = top > highest[part] - CLOSE
        part, rank = part[bears], rank[bears]
        way = middle[part]
        z = np.stack([_tops(sides, rank, way, start + ends[part, side, None] * axis) for side in (0, 1)], axis=1)
    bearing = np.bincount(part, minlength=len(ends))
    if not bearing.all():
        nothing = np.append(start + middle[np.argmin(bearing)] * axis, height)
        raise InputError(
            where,
            "no stone under it",
            found=f"nothing at {nothing.round(4).tolist()} m",
            expected="masonry along all of it, at its height",
            remedy="Look for an opening, a wall that ends before it, or a height above the wall; a line may end beside it.",
        )
    return Stretches(ends[part, 0], ends[part, 1], candidates[rank], 1.0 / bearing[part], z)


def pressed_length(along: FloatArray, place: float, most: float) -> tuple[float, float]:
    """Return the middle, from a place on it, and half the length, m, over which a stone presses on its bed under a force.

    along (n,): how far its corners lie along the wall, m; place: where the force stands; most: the longest that such a length
    may be. A stone is rigid, and its bed bears no pull: the pressure is linear over all of the stone for a force on its middle
    third, else over three times the force's distance from the nearer end.
    """
    before, after = place - float(along.min()), float(along.max()) - place
    length = min(before + after, most, 3 * max(min(before, after), 0.0))
    return max(min(0.0, after - 0.5 * length), 0.5 * length - before), 0.5 * length


def _spans(
    stones: Assemblage, start: FloatArray, axis: FloatArray, length: float, height: float, *, on_top: bool
) -> tuple[FloatArray, FloatArray, IntArray]:
    """Return where the line enters and leaves free stones at its level (n,), m, and those stones (n,)."""
    low, high = (edge.reduceat(stones.points, stones.block_point_ptr[:-1], axis=0) for edge in (np.minimum, np.maximum))
    first, last = np.minimum(start, start + length * axis), np.maximum(start, start + length * axis)
    near = ((low[:, :2] <= last + CLOSE) & (high[:, :2] >= first - CLOSE)).all(axis=1) & ~stones.fixed
    near &= high[:, 2] <= height + CLOSE if on_top else (low[:, 2] < height - CLOSE) & (high[:, 2] >= height - CLOSE)
    spans: list[tuple[float, float]] = []
    owner: list[int] = []
    for stone in np.flatnonzero(near).tolist():
        if on_top:
            span = _clipped(points_of(stones, np.array([stone]))[:, :2], start, axis)
            met = [] if span is None else [span]
        else:
            met = _within(*stones.solid(stone), start, axis, height - CLOSE)
        spans += met
        owner += [stone] * len(met)
    kept = np.array(spans).reshape(-1, 2)
    return kept[:, 0], kept[:, 1], np.array(owner, dtype=np.int64)


def _within(
    points: FloatArray, faces: list[list[int]], start: FloatArray, axis: FloatArray, level: float
) -> list[tuple[float, float]]:
    """Return from where to where a line is in a stone at a level, m along it; a stone around an arch it may enter twice."""
    sides: list[FloatArray] = []
    for face in faces:
        corner, after = points[face], np.roll(points[face], -1, axis=0)
        passed = (corner[:, 2] > level) != (after[:, 2] > level)
        if passed.any():
            one, step = corner[passed], (after - corner)[passed]
            place = (one + ((level - one[:, 2]) / step[:, 2])[:, None] * step)[:, :2]
            # The level cuts a face that is not convex more than twice.
            sides += [place[np.argsort(place @ (place[1] - place[0]))].reshape(-1, 2, 2)]
    section = np.concatenate(sides) - start
    along, aside = section @ axis, section @ np.array([-axis[1], axis[0]])
    found: list[tuple[float, float]] = []
    # A line along a joint is in the stones on both sides of it.
    for offset in (-CLOSE, CLOSE):
        cut = (aside[:, 0] > offset) != (aside[:, 1] > offset)
        share = (offset - aside[cut, 0]) / (aside[cut, 1] - aside[cut, 0])
        ways = np.sort(along[cut, 0] + share * (along[cut, 1] - along[cut, 0])).tolist()
        found += [(enters - CLOSE, leaves + CLOSE) for enters, leaves in zip(ways[::2], ways[1::2], strict=True)]
    joined: list[tuple[float, float]] = []
    for enters, leaves in sorted(found):
        if joined and enters <= joined[-1][1]:
            joined[-1] = joined[-1][0], max(joined[-1][1], leaves)
        else:
            joined.append((enters, leaves))
    return joined


def _clipped(plan: FloatArray, start: FloatArray, axis: FloatArray) -> tuple[float, float] | None:
    """Return where a line enters and leaves the convex hull of points (n, 2), None if it misses it."""
    from scipy.spatial import ConvexHull

    hull = ConvexHull(plan).equations
    along, room = hull[:, :2] @ axis, CLOSE - hull[:, 2] - hull[:, :2] @ start
    level = np.abs(along) < 1e-12
    if (room[level] < 0).any():
        return None
    cuts = room[~level] / along[~level]
    enters, leaves = cuts[along[~level] < 0].max(initial=-np.inf), cuts[along[~level] > 0].min(initial=np.inf)
    return (float(enters), float(leaves)) if enters <= leaves else None


class _UpperSides(NamedTuple):
    """Faces that look up, of one stone after another: unit normals and means (k, 3) m; enters, leaves (k,) m: where a line enters
    and leaves their plan, NaN where it misses it. first, number (n,): those of each stone. least, most (n,) m: between which its
    upper side lies."""

    normal: FloatArray
    mean: FloatArray
    enters: FloatArray
    leaves: FloatArray
    first: IntArray
    number: IntArray
    least: FloatArray
    most: FloatArray

    @property
    def met(self) -> BoolArray:
        """Which faces (k,) the line meets."""
        return np.isfinite(self.enters)


def _upper_sides(stones: Assemblage, chosen: IntArray, start: FloatArray, axis: FloatArray) -> _UpperSides:
    """Return the upper sides of stones (n,), and where a line passes over them."""
    faces = np.diff(stones.block_face_ptr)[chosen]
    face = ragged_indices(stones.block_face_ptr[chosen], faces)
    count = np.diff(stones.face_ptr)[face]
    nodes = stones.face_nodes[ragged_indices(stones.face_ptr[face], count)]
    pointers = pointer_of(count)
    vector, normal, mean = face_normals(stones.points, nodes, pointers)
    up = normal[:, 2] > _UP
    span = np.full((len(face), 2), np.nan)
    for k in np.flatnonzero(up & (vector[:, 2] > _SLIVER)).tolist():
        met = _clipped(stones.points[nodes[pointers[k] : pointers[k + 1]], :2], start, axis)
        span[k] = np.nan if met is None else met
    number = np.bincount(np.repeat(np.arange(len(chosen)), faces)[up], minlength=len(chosen))
    first = np.cumsum(number) - number
    z = stones.points[:, 2]
    least, most = (edge.reduceat(z, stones.block_point_ptr[:-1])[chosen] for edge in (np.minimum, np.maximum))
    return _UpperSides(normal[up], mean[up], span[up, 0], span[up, 1], first, number, least, most)


def _tops(sides: _UpperSides, rank: IntArray, way: FloatArray, place: FloatArray) -> FloatArray:
    """Return the z (k,) of upper sides at places (k, 2) m: of the highest face that lies under the line where it has come so far
    (k,) m. Where none does, the stone is taken as convex."""
    face = ragged_indices(sides.first[rank], sides.number[rank])
    owner = np.repeat(np.arange(len(rank)), sides.number[rank])
    n, mean = sides.normal[face], sides.mean[face]
    height = mean[:, 2] - ((place[owner] - mean[:, :2]) * n[:, :2]).sum(axis=1) / n[:, 2]
    under = (sides.enters[face] <= way[owner]) & (sides.leaves[face] >= way[owner])
    highest, lowest = np.full(len(rank), -np.inf), np.full(len(rank), np.inf)
    np.maximum.at(highest, owner[under], height[under])
    np.minimum.at(lowest, owner, height)
    return np.clip(np.where(np.isfinite(highest), highest, lowest), sides.least[rank], sides.most[rank])
