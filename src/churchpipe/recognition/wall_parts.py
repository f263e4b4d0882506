"""Where walls cross one another, and where one macro-element of a wall ends and the next begins."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations

import numpy as np
from scipy.optimize import brentq

from churchpipe.geometry.charts import base_level
from churchpipe.geometry.clusters import components
from churchpipe.geometry.planar import (
    Polygons,
    area,
    areas,
    bounds,
    boxes,
    centroids,
    common_areas,
    contains,
    overlapping,
    polygon,
    total_extent,
    united,
    within,
)
from churchpipe.model.arrays import FloatArray
from churchpipe.model.building import Part
from churchpipe.recognition.stone_walls import StoneWall, stretches

TOUCH = 1e-6
# A border of two parts: the part that ends there and the one that begins (None: neither), the axis across, and, m, the place and
# how far the parts reach into each other or are apart there.
_Border = tuple[int | None, int | None, int, tuple[float, float]]


def junction_spans(wall: StoneWall, walls: Sequence[StoneWall]) -> list[tuple[float, float]]:
    """Return s of the two faces of each wall that crosses, or ends at, a wall at some height of both, m."""
    return [(start, stop) for start, _, stop, _ in junction_boxes(wall, walls)]


def junction_boxes(wall: StoneWall, walls: Sequence[StoneWall]) -> list[tuple[float, float, float, float]]:
    """Return s of the two faces of each wall that crosses, or ends at, a wall, and t of its lowest and highest point in the chart
    of that: s, t, s, t in m."""
    found: list[tuple[float, float, float, float]] = []
    base = base_level(wall.chart)
    low, high = _heights(wall)
    beside = [other for other in walls if _heights(other)[0] < high - TOUCH and _heights(other)[1] > low + TOUCH]
    for own in stretches(wall):
        for other in beside:
            for cross in stretches(other) if other is not wall else ():
                normal = np.cross(cross.chart.s_axis, cross.chart.t_axis)
                slope = float(normal @ own.chart.s_axis)
                if abs(slope) < 0.5:
                    continue
                centre = float(normal @ (cross.chart.origin - own.chart.origin)) / slope
                start, stop = centre - 0.5 * other.thickness, centre + 0.5 * other.thickness
                reach = float((own.chart.origin + centre * own.chart.s_axis - cross.chart.origin) @ cross.chart.s_axis)
                meets = cross.low - wall.thickness < reach < cross.high + wall.thickness
                if meets and stop > own.low + TOUCH and start < own.high - TOUCH:
                    bottom, top = _heights(other)
                    found.append((start, bottom - base, stop, top - base))
    return found


def _heights(wall: StoneWall) -> tuple[float, float]:
    """Return z of the lowest and the highest point of a wall, m."""
    _, low, _, high = total_extent(wall.elevations)
    return float(low) + base_level(wall.chart), float(high) + base_level(wall.chart)


def wall_parts(
    wall: StoneWall, walls: Sequence[StoneWall], outline: FloatArray, near: float, known: Sequence[str] = ()
) -> tuple[Part, ...]:
    """Return the parts of a wall: for each other name of stones in it the box around these stones, from border to border, and a
    box for each group of them that stones of another name part, smallest boxes first.

    The border of two parts is an upright line, or a level one if they are above each other. It lies so that each part has as
    much area beyond it as the other; for a toothed border that is the mean. A part within another, as a band of courses or a
    bay, or one that rises out of its middle, has a border on each side where the other goes on. A border is moved to a step of
    the outline or to the face of a wall that crosses within its teeth and `near` m. A side that is no border ends with the last
    stones, a few millimetres below the slope of a gable; where the wall goes on by less than a square of `near`, it goes to the
    end of the wall. known: names left out.
    """
    names = [name for name in dict.fromkeys(wall.tag.tolist()) if name not in (wall.name, *known)]
    if not names:
        return ()
    marks = [
        np.concatenate([outline[:, 0], np.array(junction_spans(wall, walls)).reshape(-1)]),
        outline[:, 1],
    ]
    # A wall that stands apart from another of its name has stones of that name alone.
    present = [name for name in (wall.name, *names) if (wall.tag == name).any()]
    apart = [(name, own) for name in present for own in _apart(wall, name, near)]
    elevations = [own for _, own in apart]
    extents = [total_extent(own) for own in elevations]
    free = [[True] * 4 for _ in elevations]
    unions = [united(own) for own in elevations]
    for first, second in combinations(range(len(elevations)), 2):
        if not within(unions[first], unions[second], near):
            continue
        for ends, begins, axis, (line, teeth) in _borders(elevations, first, second):
            sides = [(part, side) for part, side in ((ends, 2 + axis), (begins, axis)) if part is not None]
            # A step beyond the teeth is not the border, as where parts meet in a bed; nor is one so far away that a part would
            # lose half of it.
            reach = min(near, teeth + TOUCH, *(0.5 * np.ptp(total_extent(elevations[part])[axis::2]) for part, _ in sides))
            mark = marks[axis][np.argmin(np.abs(marks[axis] - line))]
            line = mark if abs(mark - line) < reach else line
            for part, side in sides:
                extents[part][side], free[part][side] = line, False
    found = [
        Part(name, _box(_to_the_end(extents[part], free[part], outline, near)))
        for part, (name, _) in enumerate(apart)
        if name != wall.name
    ]
    # Of two parts one of which lies within the box of the other, the first one that is listed has the place.
    return tuple(sorted(found, key=lambda part: area(polygon(part.outline))))


def _apart(wall: StoneWall, name: str, near: float) -> list[Polygons]:
    """Return the stones of one name, those that stand apart from each other by themselves where stones of another name are
    between them, such as the wings beside a tower."""
    own = wall.tag == name
    stones, others = wall.elevations[own], centroids(wall.elevations[~own])
    if not contains(boxes(total_extent(stones)[None])[0], others).any():
        return [stones]
    piece = components(len(stones), overlapping(bounds(stones) + 0.5 * near * np.array([-1, -1, 1, 1])))
    return [stones[piece == number] for number in range(piece.max() + 1)]


def _to_the_end(extent: FloatArray, free: list[bool], outline: FloatArray, near: float) -> FloatArray:
    """Return the box (4,) of a part, with the sides that are free moved to the end of a wall that hardly goes on beyond them."""
    ends = np.concatenate([outline.min(axis=0), outline.max(axis=0)])
    for side in np.flatnonzero(free):
        longer = np.where(np.arange(4) == side, ends, extent)
        short, long = common_areas(boxes(np.array([extent, longer])), polygon(outline))
        extent = longer if long - short < near**2 else extent
    return extent


def _borders(elevations: Sequence[Polygons], first: int, second: int) -> Iterator[_Border]:
    """Yield the borders of two parts that meet: the part that ends there, the one that begins, the axis across, and the place.

    A part that lies within another, as a band in a wall or a bay that reaches its top, or that rises out of the middle of
    another, as a tower above a facade, has a border on each side where the other goes on, and the other neither ends nor begins
    there: it is None.
    """
    extent = {part: total_extent(elevations[part]).reshape(2, 2) for part in (first, second)}
    for inner, outer in ((first, second), (second, first)):
        start, stop = extent[inner] - extent[outer]
        before, beyond = start > TOUCH, stop < -TOUCH
        contained = (start > -TOUCH).all() and (stop < TOUCH).all() and (before | beyond).any()
        if contained or (before & beyond & (_depth(elevations, extent, first, second) > 0)[::-1]).any():
            for across in range(2):
                sides = bool(before[across]), bool(beyond[across])
                yield from _around(elevations[inner], elevations[outer], inner, across, sides)
            return
    apart = _middle(elevations[second]) - _middle(elevations[first])
    axis = int(np.argmax(np.abs(apart)))
    low, high = (first, second) if apart[axis] > 0 else (second, first)
    yield low, high, axis, _border(elevations[low], elevations[high], axis)


def _depth(elevations: Sequence[Polygons], extent: Mapping[int, FloatArray], first: int, second: int) -> FloatArray:
    """Return how deep two parts reach into each other along both axes (2,), m, beyond what the teeth of a bond do along s."""
    overlap = np.minimum(extent[first][1], extent[second][1]) - np.maximum(extent[first][0], extent[second][0])
    stones = bounds(np.concatenate([elevations[first], elevations[second]]))
    return overlap - [float((stones[:, 2] - stones[:, 0]).max()) + TOUCH, TOUCH]


def _around(inner: Polygons, outer: Polygons, part: int, axis: int, sides: tuple[bool, bool]) -> Iterator[_Border]:
    """Yield the borders at the ends of a part that lies within another: with the stones before it, and with those beyond.

    sides: whether the other part goes on before, and beyond.
    """
    extents, own = bounds(outer), total_extent(inner)
    aside, size = 1 - axis, np.ptp(own.reshape(2, 2), axis=0)
    level = (extents[:, aside] < own[2 + aside] - TOUCH) & (extents[:, 2 + aside] > own[aside] + TOUCH)
    away = (centroids(outer) - _middle(inner)) / size
    beside = level & (np.abs(away[:, axis]) > np.abs(away[:, aside]))
    before, beyond = beside & (away[:, axis] < 0), beside & (away[:, axis] > 0)
    if sides[0] and before.any():
        yield None, part, axis, _border(outer[before], inner, axis)
    if sides[1] and beyond.any():
        yield part, None, axis, _border(inner, outer[beyond], axis)


def _middle(polygons: Polygons) -> FloatArray:
    return np.average(centroids(polygons), axis=0, weights=areas(polygons))


def _border(low: Polygons, high: Polygons, axis: int) -> tuple[float, float]:
    """Return the line beyond which both parts have the same area, and how far they reach into each other, or are apart, there."""
    extent = total_extent(np.concatenate([low, high]))
    stop, start = float(total_extent(low)[2 + axis]), float(total_extent(high)[axis])
    if stop <= start + TOUCH:
        return 0.5 * (start + stop), start - stop

    # All others lie on one side of every line between.
    low, high = low[bounds(low)[:, 2 + axis] > start], high[bounds(high)[:, axis] < stop]

    def excess(line: float) -> float:
        over, under = boxes(np.where(np.arange(4) == [[axis], [2 + axis]], line, extent))
        return float(common_areas(low, over).sum() - common_areas(high, under).sum())

    return float(brentq(excess, start, stop, xtol=TOUCH)), stop - start


def _box(extent: FloatArray) -> FloatArray:
    s0, t0, s1, t1 = extent
    return np.array([[s0, t0], [s1, t0], [s1, t1], [s0, t1]])
