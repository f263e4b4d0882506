"""Stones of plane walls with rounded coordinates put back onto the straight lines of their walls in plan.

Of walls along x and y equal places are rounded alike. Of walls at an angle to the axes each corner is off by an amount of its
own: their faces, ends and reveals are ragged, and where two walls meet the teeth of one overlap with the other, or end before it.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from churchpipe.geometry.planar import total_extent
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray, ragged_indices
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import PlaneChart
from churchpipe.model.polyhedra import FLATNESS, LEAST_WARP, face_normals, face_warps
from churchpipe.recognition.stone_walls import StoneWall
from churchpipe.recognition.wall_planes import FLAT

# Faces of walls less ragged than this, m, are straight: the computer rounds coordinates of a map to some nanometres.
_STRAIGHT = 1e-8
# Corners on one line lie on both sides of it, as far as rounding takes them, which the faces of walls may show only in part.
_SPREAD = 4.0
# A face of a stone that is left with a smaller share of its area than this was only as wide as the rounding.
_LEFT = 0.5


def straightened(stones: Assemblage, walls: Sequence[StoneWall], unfit: IntArray) -> tuple[Assemblage, FloatArray]:
    """Return stones whose corners lie on straight lines in plan along and across their walls, and how far each was moved.

    How ragged the faces of the walls are tells how far apart corners on one line may be. Nothing is moved where these faces are
    straight, nor in z, where equal heights are rounded alike.

    Parameters
    ----------
    stones
        As drawn.
    walls
        The walls fitted to them; stones of curved walls stay where they are.
    unfit
        Stones that fit none. Those that reach from face to face of a wall are moved like its own: voussoirs, and stones below the
        slope of a gable, whose fronts rounding has bent.

    Returns
    -------
    stones, moved
        moved (nb,): the furthest that a corner of the stone was moved, m.
    """
    plane = [(wall, wall.chart) for wall in walls if isinstance(wall.chart, PlaneChart)]
    ragged = max((_raggedness(stones, wall, chart) for wall, chart in plane), default=0.0)
    if ragged < _STRAIGHT:
        return stones, np.zeros(stones.count)
    points = stones.points.copy()
    middle = points.mean(axis=0)
    for axis, group in _frames(plane, _SPREAD * ragged):
        blocks = [part for wall, chart in group for part in (wall.stones, unfit[_between_faces(stones, unfit, wall, chart)])]
        own = _points(stones, np.unique(np.concatenate(blocks)))
        for line in (axis, np.array([-axis[1], axis[0], 0.0])):
            place = (stones.points[own] - middle) @ line
            points[own] += (_gathered(place, _SPREAD * ragged) - place)[:, None] * line
    owner = np.repeat(np.arange(stones.count), np.diff(stones.block_point_ptr))
    points = np.where(_spoilt(stones, points)[owner, None], stones.points, points)
    moved = np.maximum.reduceat(np.linalg.norm(points - stones.points, axis=1), stones.block_point_ptr[:-1])
    return replace(stones, points=points), np.where(moved < _STRAIGHT, 0.0, moved)


def _points(stones: Assemblage, blocks: IntArray) -> IntArray:
    """Return the numbers of the corners of some stones."""
    return ragged_indices(stones.block_point_ptr[blocks], np.diff(stones.block_point_ptr)[blocks])


def _raggedness(stones: Assemblage, wall: StoneWall, chart: PlaneChart) -> float:
    """Return how far corners of the stones of a wall lie off its two faces, m."""
    off = _off_faces(stones, wall.stones, wall, chart)
    return float(off[off < FLAT].max(initial=0.0))


def _off_faces(stones: Assemblage, blocks: IntArray, wall: StoneWall, chart: PlaneChart) -> FloatArray:
    """Return how far each corner (k,) of some stones is from the nearer face of a wall, m."""
    apart = np.abs((stones.points[_points(stones, blocks)] - chart.origin) @ np.cross(chart.s_axis, chart.t_axis))
    return np.abs(apart - 0.5 * wall.thickness)


def _between_faces(stones: Assemblage, blocks: IntArray, wall: StoneWall, chart: PlaneChart) -> BoolArray:
    """Return which of some stones (n,) have all of their corners on the two faces of a wall, as far as rounding goes."""
    off = _off_faces(stones, blocks, wall, chart)
    start = np.cumsum(np.diff(stones.block_point_ptr)[blocks]) - np.diff(stones.block_point_ptr)[blocks]
    return np.maximum.reduceat(off, start) < FLAT if len(blocks) else np.zeros(0, dtype=np.bool_)


def _frames(
    walls: Sequence[tuple[StoneWall, PlaneChart]], near: float
) -> list[tuple[FloatArray, list[tuple[StoneWall, PlaneChart]]]]:
    """Return the directions (3,) of walls, each with those that go along or across it, to `near` m at their ends."""
    angle = np.array([np.arctan2(chart.s_axis[1], chart.s_axis[0]) for _, chart in walls])
    length = np.array([np.ptp(total_extent(wall.elevations)[[0, 2]]) for wall, _ in walls])
    left = np.argsort(-length).tolist()
    found: list[tuple[FloatArray, list[tuple[StoneWall, PlaneChart]]]] = []
    while left:
        # Angles between walls are those to the nearest right angle.
        turn = angle[left] - angle[left[0]]
        turn -= 0.5 * np.pi * np.round(turn / (0.5 * np.pi))
        along = 0.5 * length[left] * np.abs(turn) < near
        own = np.array(left)[along]
        # A direction is known as well as the wall is long and has stones.
        mean = angle[left[0]] + np.average(turn[along], weights=length[own] ** 3)
        found.append((np.array([np.cos(mean), np.sin(mean), 0.0]), [walls[number] for number in own]))
        left = [number for number, chosen in zip(left, along, strict=True) if not chosen]
    return found


def _gathered(values: FloatArray, spread: float) -> FloatArray:
    """Return values (n,) with those of one line made equal: parted at the widest gaps until each part is within `spread`."""
    order = np.argsort(values)
    given = values[order]
    cuts = np.flatnonzero(np.diff(given) > spread) + 1
    parts = list(zip([0, *cuts.tolist()], [*cuts.tolist(), len(given)], strict=True))
    out = np.empty(len(given))
    while parts:
        start, stop = parts.pop()
        part = given[start:stop]
        if part[-1] - part[0] > spread:
            cut = start + 1 + int(np.argmax(np.diff(part)))
            parts += [(start, cut), (cut, stop)]
        else:
            out[order[start:stop]] = part.mean()
    return out


def _spoilt(stones: Assemblage, points: FloatArray) -> BoolArray:
    """Return which stones (nb,) would lose a face, or have a warped one, if their corners were at other points (n, 3)."""
    before, after = (
        np.linalg.norm(face_normals(place, stones.face_nodes, stones.face_ptr)[0], axis=1) for place in (stones.points, points)
    )
    height, extent = face_warps(points, stones.face_nodes, stones.face_ptr)
    owner = np.repeat(np.arange(stones.count), np.diff(stones.block_face_ptr))
    bad = (after < _LEFT * before) | (height > FLATNESS * extent + LEAST_WARP)
    return np.bincount(owner[bad], minlength=stones.count) > 0
