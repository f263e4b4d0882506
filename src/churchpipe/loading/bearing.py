"""Which stones bear a line, and where."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull

from churchpipe.errors import InputError
from churchpipe.geometry.walls import points_of
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.polyhedra import face_normals

# Lengths below this are rounding, m.
CLOSE = 1e-5
# A face that looks up has at least this z in its normal.
_UP = 0.05


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
    the line runs along a joint both sides take half. Stones count by the convex hull of their plan.

    Raises
    ------
    InputError: a part of the line has no stone under it.
    """
    length = float(np.linalg.norm(end - start))
    axis = (end - start) / length if length else np.array([1.0, 0.0])
    low, high, candidates = _spans(stones, start, axis, length, height, on_top=on_top)
    stops = np.unique(np.clip(np.concatenate([[0.0, length], low, high]), 0.0, length))
    stops = stops[np.append(True, np.diff(stops) > CLOSE)]
    stops[-1] = length
    ends = np.stack([stops[:-1], stops[1:]], axis=1) if len(stops) > 1 else np.array([[0.0, 0.0]])
    found: list[tuple[float, float, int, float, FloatArray]] = []
    for first, last in ends.tolist():
        middle = 0.5 * (first + last)
        there = candidates[(low <= middle) & (high >= middle)]
        tops = np.array([_top(stones, int(stone), start + middle * axis) for stone in there])
        bearing = there[tops > tops.max() - CLOSE] if on_top and len(there) else there
        if not len(bearing):
            raise InputError(
                where,
                "no stone under it",
                found=f"nothing at {np.append(start + middle * axis, height).round(4).tolist()} m",
                expected="masonry along all of it, at its height",
                remedy="Look for an opening, a wall that ends before it, or a height above the wall.",
            )
        for stone in bearing.tolist():
            z = np.array([_top(stones, stone, start + place * axis) if on_top else height for place in (first, last)])
            found.append((first, last, stone, 1.0 / len(bearing), z))
    columns = list(zip(*found, strict=True))
    return Stretches(
        np.array(columns[0]),
        np.array(columns[1]),
        np.array(columns[2], dtype=np.int64),
        np.array(columns[3]),
        np.array(columns[4]),
    )


def _spans(
    stones: Assemblage, start: FloatArray, axis: FloatArray, length: float, height: float, *, on_top: bool
) -> tuple[FloatArray, FloatArray, IntArray]:
    """Return where the line enters and leaves the plan of each free stone at its level (n,), m, and those stones (n,)."""
    low, high = (edge.reduceat(stones.points, stones.block_point_ptr[:-1], axis=0) for edge in (np.minimum, np.maximum))
    first, last = np.minimum(start, start + length * axis), np.maximum(start, start + length * axis)
    near = ((low[:, :2] <= last + CLOSE) & (high[:, :2] >= first - CLOSE)).all(axis=1) & ~stones.fixed
    near &= high[:, 2] <= height + CLOSE if on_top else (low[:, 2] < height - CLOSE) & (high[:, 2] >= height - CLOSE)
    chosen = np.flatnonzero(near)
    spans = [_clipped(points_of(stones, np.array([stone]))[:, :2], start, axis) for stone in chosen]
    met = [number for number, span in enumerate(spans) if span is not None]
    kept = np.array([span for span in spans if span is not None]).reshape(-1, 2)
    return kept[:, 0], kept[:, 1], chosen[met]


def _clipped(plan: FloatArray, start: FloatArray, axis: FloatArray) -> tuple[float, float] | None:
    """Return where a line enters and leaves the convex hull of points (n, 2), None if it misses it."""
    hull = ConvexHull(plan).equations
    along, room = hull[:, :2] @ axis, CLOSE - hull[:, 2] - hull[:, :2] @ start
    level = np.abs(along) < 1e-12
    if (room[level] < 0).any():
        return None
    cuts = room[~level] / along[~level]
    enters, leaves = cuts[along[~level] < 0].max(initial=-np.inf), cuts[along[~level] > 0].min(initial=np.inf)
    return (float(enters), float(leaves)) if enters <= leaves else None


def _top(stones: Assemblage, stone: int, place: FloatArray) -> float:
    """Return the z of the upper side of a stone, taken as convex, at a place (2,) m."""
    faces = range(*stones.block_face_ptr[stone : stone + 2])
    count = [int(stones.face_ptr[face + 1] - stones.face_ptr[face]) for face in faces]
    nodes = stones.face_nodes[stones.face_ptr[faces[0]] : stones.face_ptr[faces[-1] + 1]]
    _, normal, mean = face_normals(stones.points, nodes, np.concatenate(([0], np.cumsum(count))))
    up = normal[:, 2] > _UP
    z = mean[up, 2] - ((place - mean[up, :2]) * normal[up, :2]).sum(axis=1) / normal[up, 2]
    own = stones.points[slice(*stones.block_point_ptr[stone : stone + 2]), 2]
    return float(np.clip(z.min(initial=np.inf), own.min(), own.max()))
