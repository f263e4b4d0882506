"""Header-and-stretcher bond: walls two stones thick, whose leaves headers tie together."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from churchpipe.bond.courses import lay_courses
from churchpipe.bond.field import Field, HorizontalBeds
from churchpipe.bond.joints import bays, grid_joints, joints_by_bay, laid_length, stones_in
from churchpipe.bond.tiles import TileSet, leaves_of
from churchpipe.errors import InputError
from churchpipe.geometry.planar import centroids
from churchpipe.geometry.polygons import TOLERANCE
from churchpipe.model.arrays import FloatArray
from churchpipe.model.building import BondRegion, Panel, PlaneChart, UnitCell

# Across a junction: least and greatest length of a piece, as shares of a stone, and the lap over the joints of the next course
# that is enough, as a share of a piece.
LEAST, MOST, ENOUGH = 0.5, 1.25, 0.25
NO_HEADERS = np.empty((0, 2))


@dataclass(frozen=True, slots=True)
class HeaderStretcherBond(HorizontalBeds):
    """Courses of height a. Stretchers, b long, fill one half of the wall's thickness; headers, b/2 wide, go through all of it.

    headers: "english", courses of stretchers and courses of headers in turn; "flemish", a stretcher and a header in turn in each
    course; "none", two leaves in running bond. The vertical joints of one course are at least b/4 away from those of the next,
    b/2 without headers.

    Courses run through a junction as stretchers. Headers next to other walls and at free ends are 3/4 b wide, so that no closer
    of b/4 is needed.

    The offsets, m, are for the rule "grid": where a stretcher begins on courses that run through, and where a header begins on
    the others (without headers, a stretcher). What is left at the far end of the wall is filled with or without a header.
    """

    cell: UnitCell
    rule: Literal["grid", "bay"]
    through_offset: float
    cut_offset: float
    headers: Literal["english", "flemish", "none"]

    def tiles(self, field: Field) -> TileSet:
        """Return the stones of the field: one tile for a header, two for stretchers side by side."""
        faces = lay_courses(field, self.cell, lambda course: self._joints(field, course))
        middle = centroids(faces.polygons)[:, 0]
        header = np.zeros(faces.count, dtype=np.bool_)
        for course in np.unique(faces.course):
            own = faces.course == course
            start, stop = self._headers(field, int(course)).T
            header[own] = ((start < middle[own, None]) & (middle[own, None] < stop)).any(axis=1)
        return leaves_of(faces, ~header)

    def stone_length(self, bay: float) -> float:
        """Return how long the stretchers of a clear bay are, m."""
        if self.rule == "grid":
            return self.cell.b
        periods = self._periods(bay)
        return bay / (1 + 1.5 * periods) if periods else laid_length(bay, self.cell.b)

    def _joints(self, field: Field, course: int) -> FloatArray:
        through = course % 2 == field.through
        if self.rule == "grid":
            return self._grid(field, through)[0]
        piece = self.cell.b if through or self.headers == "none" else self.cell.b / 2

        def across(zone: FloatArray, start: float, stop: float) -> FloatArray:
            return _across(zone, start, stop, piece)

        return joints_by_bay(field, (course + 0.5) * self.cell.a, lambda length: self._bay(length, through)[0], across)

    def _headers(self, field: Field, course: int) -> FloatArray:
        """Return where headers lie in one course (n, 2), from s to s in m."""
        through = course % 2 == field.through
        if self.rule == "grid":
            return self._grid(field, through)[1]
        spans = [
            start + self._bay(stop - start, through)[1]
            for start, stop in bays(field.span, field.zones)
            if stop - start > TOLERANCE
        ]
        junctions = field.zones if not through and self.headers != "none" else NO_HEADERS
        return np.concatenate([*spans, junctions])

    def _grid(self, field: Field, through: bool) -> tuple[FloatArray, FloatArray]:
        """Return joints and headers of a course by rule "grid", s in m."""
        b, offset = self.cell.b, self.through_offset if through else self.cut_offset
        if self.headers == "none" or (self.headers == "english" and through):
            return grid_joints(field, b, offset), NO_HEADERS
        if self.headers == "english":
            return grid_joints(field, b / 2, offset), np.array([field.span])
        start = grid_joints(field, 1.5 * b, offset + b if through else offset)
        # A header may begin before the wall does.
        start = np.concatenate(([start[0] - 1.5 * b], start)) if len(start) else np.empty(0)
        headers = np.stack([start, start + b / 2], axis=1)
        return np.sort(headers.ravel()), headers

    def _bay(self, length: float, through: bool) -> tuple[FloatArray, FloatArray]:
        """Return joints and headers of a course in a clear bay of some length, from its start, m."""
        periods, unit = self._periods(length), self.stone_length(length)
        if periods:
            if through:
                headers = (unit * (np.array([1.0, 1.5]) + 1.5 * np.arange(periods)[:, None])).astype(np.float64)
                return headers.ravel(), headers
            stretchers = unit * (np.array([0.75, 1.75]) + 1.5 * np.arange(periods)[:, None])
            joints = np.concatenate(([0.0], stretchers.ravel(), [length]))
            return joints, joints.reshape(-1, 2)
        count = stones_in(length, self.cell.b)
        if through:
            return (unit * np.arange(0.5, count)).astype(np.float64), NO_HEADERS
        if self.headers == "none":
            return (unit * np.arange(0.0, count + 1)).astype(np.float64), NO_HEADERS
        inside = unit * (0.75 + 0.5 * np.arange(2 * count - 2))
        return np.concatenate(([0.0], inside, [length])), np.array([[0.0, length]])

    def _periods(self, length: float) -> int:
        """Return how many headers, each with a stretcher, follow the first stretcher of a Flemish bay; none in other bonds."""
        return max(0, int(np.floor((length / self.cell.b - 1) / 1.5 + 0.5 + TOLERANCE))) if self.headers == "flemish" else 0


def check_leaves(panel: Panel, region: BondRegion) -> None:
    """Raise InputError unless the wall is straight and as thick as two of its stones side by side."""
    b = region.cell.b
    if not isinstance(panel.chart, PlaneChart):
        raise InputError(
            region.name,
            "a curved wall cannot be laid in header-stretcher bond",
            found=f"mid-radius {panel.chart.radius:g} m",
            expected="a straight wall",
            remedy='Use pattern = "running" there.',
        )
    if not (1 - TOLERANCE) * b / 2 <= panel.thickness <= (1 + TOLERANCE) * 2 * b:
        thin = panel.thickness < b
        raise InputError(
            region.name,
            "the wall is thinner than its headers are wide" if thin else "its leaves are deeper than the stretchers are long",
            found=f"{panel.thickness:g} m thick, " + (f"headers {b / 2:g} m wide" if thin else f"stretchers {b:g} m long"),
            expected=f"{b / 2:g} to {2 * b:g} m thick, half a stretcher to two",
            remedy="Use shorter stones." if thin else "Use longer stones.",
        )


def _across(zone: FloatArray, start: float, stop: float, piece: float) -> FloatArray:
    """Return the joints that divide the stretch across a junction evenly, s in m.

    They stay a quarter of a piece (m) away from the joints that the crossing wall has in the courses below and above: at its two
    faces and between its leaves. Where that is impossible they stay as far away as pieces of 1/2 to 5/4 of a stone allow.
    """
    length = stop - start
    if length <= TOLERANCE:
        return np.array([start, stop])
    counts = np.arange(max(1, np.ceil(length / (MOST * piece) - TOLERANCE)), max(1, np.floor(length / (LEAST * piece))) + 1)
    avoid = np.array([zone[0], zone.mean(), zone[1]])
    laps: list[float] = []
    for count in counts:
        inner = np.linspace(start, stop, int(count) + 1)[1:-1]
        laps.append(float(np.abs(inner[:, None] - avoid).min(initial=ENOUGH * piece)))
    best = np.lexsort((np.abs(length / counts - piece), -np.round(laps, 9)))[0]
    return np.linspace(start, stop, int(counts[best]) + 1)
