"""Stones of walls with rounded coordinates put back onto the straight lines and circles of their walls in plan.

Of walls along x and y equal places are rounded alike. Of walls at an angle to the axes each corner is off by an amount of its
own: their faces, ends and reveals are ragged, and where two walls meet the teeth of one overlap with the other, or end before it.
So it is of round walls and their legs, however they stand.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from churchpipe.geometry.planar import total_extent
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import CylinderChart, PlaneChart
from churchpipe.model.polyhedra import FLATNESS, LEAST_WARP, face_normals, face_warps
from churchpipe.recognition.arcs import fitted_arc, off_circles
from churchpipe.recognition.curved_walls import points_of
from churchpipe.recognition.gathering import gathered
from churchpipe.recognition.stone_walls import StoneWall
from churchpipe.stones.raggedness import STRAIGHT, Raggedness

# Faces of walls less ragged than this, m, are straight: the computer rounds coordinates of a map to some nanometres.
_STRAIGHT = 1e-8
# Corners on one line lie on both sides of it, as far as rounding takes them, which the faces of walls may show only in part.
_SPREAD = 4.0
# A face of a stone that is left with a smaller share of its area than this was only as wide as the rounding.
_LEFT = 0.5


def straightened(
    stones: Assemblage, walls: Sequence[StoneWall], unfit: IntArray, told: Raggedness = STRAIGHT
) -> tuple[Assemblage, FloatArray]:
    """Return stones whose corners lie on straight lines in plan along and across their walls, or on the circles and joints of
    round ones, and how far each was moved.

    How ragged the faces of the walls are tells how far apart corners on one line may be. Nothing is moved where these faces are
    straight, nor in z, where equal heights are rounded alike.

    Parameters
    ----------
    stones
        As drawn.
    walls
        The walls fitted to them. Lines of plane walls near the axis or the faces of a round one that meets them go there.
    unfit
        Stones that fit none. Those that reach from face to face of a wall are moved like its own: voussoirs, and stones below the
        slope of a gable, whose fronts rounding has bent.
    told
        How far corners lie off their walls, as the stones tell with which these were found.

    Returns
    -------
    stones, moved
        moved (nb,): the furthest that a corner of the stone was moved, m.
    """
    curved = [(wall, wall.chart) for wall in walls if isinstance(wall.chart, CylinderChart)]
    fitted = [(wall, *_fitted(stones, wall, wall.chart, told.flat)) for wall in walls if isinstance(wall.chart, PlaneChart)]
    plane = [(wall, chart) for wall, chart, _ in fitted]
    uneven = [ragged for _, _, ragged in fitted] + [off_circles(stones, wall, chart) for wall, chart in curved]
    ragged = max(uneven, default=0.0)
    if ragged < _STRAIGHT:
        return stones, np.zeros(stones.count)
    spread = _SPREAD * ragged
    points = stones.points.copy()
    middle = points.mean(axis=0)
    # Of the wall that each stone is of, zero where there is no plane one.
    normal = np.zeros((stones.count, 3))
    frames = _frames(plane, spread)
    arcs = [fitted_arc(stones, wall, chart, [axis for axis, _ in frames], spread) for wall, chart in curved]
    for number, (axis, group) in enumerate(frames):
        blocks: list[IntArray] = []
        for wall, chart in group:
            blocks.append(np.concatenate([wall.stones, unfit[_between_faces(stones, unfit, wall, chart, told.flat)]]))
            normal[blocks[-1]] = np.cross(chart.s_axis, chart.t_axis)
        own = points_of(stones, np.unique(np.concatenate(blocks)))
        own = np.concatenate([own, *(arc.legs for arc in arcs if number in arc.frames)])
        for line in (axis, np.array([-axis[1], axis[0], 0.0])):
            place = (stones.points[own] - middle) @ line
            marks = [(arc.chart.centre - middle) @ line + arc.faces for arc in arcs if number in arc.frames]
            points[own] += (gathered(place, spread, np.concatenate([[], *marks])) - place)[:, None] * line
    for arc in arcs:
        points[arc.bend, :2] = arc.places
    owner = np.repeat(np.arange(stones.count), np.diff(stones.block_point_ptr))
    points = np.where(_spoilt(stones, points, normal, spread)[owner, None], stones.points, points)
    moved = np.maximum.reduceat(np.linalg.norm(points - stones.points, axis=1), stones.block_point_ptr[:-1])
    return replace(stones, points=points), np.where(moved < _STRAIGHT, 0.0, moved)


def _fitted(stones: Assemblage, wall: StoneWall, chart: PlaneChart, flat: float) -> tuple[PlaneChart, float]:
    """Return the chart of a wall midway between its two faces, fitted to all corners on them, and how far these lie off the faces
    at most, m: stones that were not recognised as its own may have left it turned."""
    place = stones.points[points_of(stones, wall.stones)] - chart.origin
    normal = np.cross(chart.s_axis, chart.t_axis)
    apart = place @ normal
    off = np.abs(apart) - 0.5 * wall.thickness
    near = np.abs(off) < flat
    if np.abs(off[near]).max(initial=0.0) < _STRAIGHT:
        return chart, 0.0
    side, s = np.sign(apart[near]), place[near] @ chart.s_axis
    unknown = np.stack([np.ones(len(s)), s, side], axis=1)
    (middle, slope, half), *_ = np.linalg.lstsq(unknown, apart[near], rcond=None)
    along = chart.s_axis + slope * normal
    fitted = replace(chart, origin=chart.origin + middle * normal, s_axis=along / np.linalg.norm(along))
    return fitted, float(np.abs(apart[near] - unknown @ [middle, slope, half]).max())


def _off_faces(stones: Assemblage, blocks: IntArray, wall: StoneWall, chart: PlaneChart) -> FloatArray:
    """Return how far each corner (k,) of some stones is from the nearer face of a wall, m."""
    apart = np.abs((stones.points[points_of(stones, blocks)] - chart.origin) @ np.cross(chart.s_axis, chart.t_axis))
    return np.abs(apart - 0.5 * wall.thickness)


def _between_faces(stones: Assemblage, blocks: IntArray, wall: StoneWall, chart: PlaneChart, flat: float) -> BoolArray:
    """Return which of some stones (n,) have all of their corners on the two faces of a wall, to `flat` m."""
    off = _off_faces(stones, blocks, wall, chart)
    start = np.cumsum(np.diff(stones.block_point_ptr)[blocks]) - np.diff(stones.block_point_ptr)[blocks]
    return np.maximum.reduceat(off, start) < flat if len(blocks) else np.zeros(0, dtype=np.bool_)


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


def _spoilt(stones: Assemblage, points: FloatArray, normal: FloatArray, spread: float) -> BoolArray:
    """Return which stones (nb,) would lose a face, or have a warped one, if their corners were at other points (n, 3).

    normal (nb, 3): of their walls. Faces that lie on a face of the wall, to `spread` m, may vanish: a front that rounding has
    bent is drawn in triangles, of which those between corners that are nearly in line are only as wide as the rounding.
    """
    before, after = (
        np.linalg.norm(face_normals(place, stones.face_nodes, stones.face_ptr)[0], axis=1) for place in (stones.points, points)
    )
    height, extent = face_warps(points, stones.face_nodes, stones.face_ptr)
    owner = np.repeat(np.arange(stones.count), np.diff(stones.block_face_ptr))
    depth = np.einsum("nc,nc->n", stones.points[stones.face_nodes], np.repeat(normal[owner], np.diff(stones.face_ptr), axis=0))
    start = stones.face_ptr[:-1]
    front = normal[owner].any(axis=1) & (np.maximum.reduceat(depth, start) - np.minimum.reduceat(depth, start) < spread)
    bad = (~front & (after < _LEFT * before)) | (height > FLATNESS * extent + LEAST_WARP)
    return np.bincount(owner[bad], minlength=stones.count) > 0
