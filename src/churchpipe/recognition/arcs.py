"""Stones of round walls with rounded coordinates put back onto their two circles and onto common joints."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from churchpipe.geometry.charts import lift
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import CylinderChart
from churchpipe.recognition.curved_walls import curved_coordinates, points_of
from churchpipe.recognition.gathering import gathered
from churchpipe.recognition.stone_walls import StoneWall

# Corners on the inner face turn more by their rounding than the middle does; those near the axis of a solid drum tell nothing.
_MOST_TURNED = 4.0


@dataclass(frozen=True, slots=True)
class Arc:
    """A round wall and where its corners belong.

    chart: with the ends of the arc square to the plane walls that they meet. frames: numbers of the directions of these walls.
    faces: distances (5,) from the axis at which lines along these directions run: the axis and both faces on both sides, m.
    legs: numbers of the corners on straight legs along such walls, which lie on their lines. bend: of all others; places: theirs
    in plan (n, 2) m.
    """

    chart: CylinderChart
    frames: frozenset[int]
    faces: FloatArray
    legs: IntArray
    bend: IntArray
    places: FloatArray


def off_circles(stones: Assemblage, wall: StoneWall, chart: CylinderChart) -> float:
    """Return how far corners of a round wall lie off its faces at most, m."""
    distance = curved_coordinates(chart, stones.points[points_of(stones, wall.stones)])[1]
    return float(np.abs(np.abs(distance) - 0.5 * wall.thickness).max())


def fitted_arc(stones: Assemblage, wall: StoneWall, chart: CylinderChart, axes: Sequence[FloatArray], spread: float) -> Arc:
    """Return a round wall with its corners on two circles and common joints.

    Parameters
    ----------
    axes
        Directions (3,) of plane walls: an end of the arc that is square to one within `spread` m is made exactly so.
    """
    chart, frames = _squared(chart, axes, spread)
    own = points_of(stones, wall.stones)
    flat, distance = curved_coordinates(chart, stones.points[own])
    s, end = flat[:, 0], chart.radius * chart.sweep
    inner = chart.radius - 0.5 * wall.thickness
    wide = spread * min(chart.radius / max(inner, 1e-9), _MOST_TURNED)
    if chart.sweep < 2 * np.pi:
        marks = [0.0, end]
    else:
        marks, s = [], np.where(s > end - wide, s - end, s)
    on_legs = ((s < -wide) & (0 in frames)) | ((s > end + wide) & (1 in frames))
    bend = own[~on_legs]
    joint = np.stack([gathered(s[~on_legs], wide, marks), flat[~on_legs, 1]], axis=1)
    places = lift(chart, joint, np.copysign(0.5 * wall.thickness, distance[~on_legs]))[:, :2]
    near, far = inner, chart.radius + 0.5 * wall.thickness
    return Arc(chart, frozenset(frames.values()), np.array([-far, -near, 0.0, near, far]), own[on_legs], bend, places)


def _squared(chart: CylinderChart, axes: Sequence[FloatArray], near: float) -> tuple[CylinderChart, dict[int, int]]:
    """Return the chart of an arc with its ends square to plane walls where they nearly are, and for each such end, 0 and 1, the
    number of the direction of these walls."""
    ends = [chart.start, chart.start + chart.sweep]
    frames: dict[int, int] = {}
    if chart.sweep == 2 * np.pi:
        return chart, frames
    for end, angle in enumerate(ends):
        for number, axis in enumerate(axes):
            turn = angle - np.arctan2(axis[1], axis[0])
            turn -= 0.5 * np.pi * np.round(turn / (0.5 * np.pi))
            if chart.radius * abs(turn) < near and end not in frames:
                ends[end], frames[end] = angle - turn, number
    return replace(chart, start=ends[0], sweep=ends[1] - ends[0]), frames
