"""Walls that stand in one plane and do not touch: two piers, the halves of an arch that has lost its crown."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import count

import numpy as np

from churchpipe.geometry.noding import joined_over_gaps
from churchpipe.geometry.planar import Polygon, Polygons, boxes, clip, common_areas, less, total_extent, touching
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray, NameArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import PlaneChart
from churchpipe.recognition.elevations import elevations, sections
from churchpipe.recognition.stone_walls import StoneWall, stretches
from churchpipe.recognition.wall_parts import junction_boxes
from churchpipe.recognition.wall_planes import LEAST_STONES

# Coordinates of elevations are rounded to this, m, where they are united.
GRID = 1e-6


def separate_walls(stones: Assemblage, walls: Sequence[StoneWall], contact_gap: float) -> tuple[list[StoneWall], IntArray]:
    """Return walls of which each hangs together, and the stones left over, too few to be a wall.

    The largest part of a wall keeps its name. The others are walls of their own. Of stones without a name they take the next
    free number; of stones with one, that name and a number, and the name stays that of their stones, so that a load on it
    reaches them. Walls on both sides of a wall that crosses them are one.
    """
    found: list[StoneWall] = []
    loose = [np.empty(0, dtype=np.int64)]
    # Names of stones joined to a wall of another name are names of its parts.
    taken = {str(name) for wall in walls for name in (wall.name, *wall.tag)}
    for wall in walls:
        parts = _parts(stones, wall, walls, contact_gap)
        if len(parts) == 1:
            found.append(wall)
            continue
        main, *others = parts
        found.append(_part(stones, wall, main, taken, main=True))
        for part in others:
            if len(part) >= LEAST_STONES:
                found.append(_part(stones, wall, part, taken, main=False))
            else:
                loose.append(wall.stones[part])
    found.sort(key=lambda wall: wall.name)
    return found, np.concatenate(loose)


def filled(stones: Assemblage, wall: StoneWall, walls: Sequence[StoneWall], contact_gap: float) -> Polygons:
    """Return the elevations of a wall with the sections of all other stones with its plane stretches, within its extent.

    In a junction the wall is as high as its own stones in it or beside it. What is higher there belongs to the crossing wall, as
    far as that reaches: below it another one may cross, as a thicker lower storey does.
    """
    others = np.setdiff1d(np.flatnonzero(~stones.fixed), wall.stones)
    _, bottom, _, top = total_extent(wall.elevations)
    alone: list[FloatArray] = []
    for start, foot, stop, head in junction_boxes(wall, walls):
        near = touching(wall.elevations, boxes(np.array([[start - contact_gap, bottom, stop + contact_gap, top]]))[0])
        if near.any():
            _, low, _, high = total_extent(wall.elevations[near])
            alone += [np.array([start, foot, stop, low])] if foot < low else []
            alone += [np.array([start, high, stop, head])] if high < head else []
    found = [wall.elevations]
    for stretch in stretches(wall):
        window: Polygon = boxes(np.array([[stretch.low, bottom, stretch.high, top]]))[0]
        left = less(window, boxes(np.array(alone).reshape(-1, 4)))
        found.append(clip(sections(stones, others, stretch.chart, contact_gap), left)[0])
    return np.concatenate(found)


def closed(polygons: Polygons, contact_gap: float) -> list[Polygon]:
    """Return the connected pieces of the union of elevations (n,), closed across joints."""
    return joined_over_gaps(polygons, contact_gap, GRID)


def _parts(stones: Assemblage, wall: StoneWall, walls: Sequence[StoneWall], contact_gap: float) -> list[IntArray]:
    """Return which of a wall's stones hang together, as numbers into them, the largest part of enough stones first."""
    regions = closed(filled(stones, wall, walls, contact_gap), contact_gap)
    if len(regions) == 1:
        return [np.arange(len(wall.stones))]
    inside = np.argmax([common_areas(wall.elevations, region) for region in regions], axis=0)
    parts = [np.flatnonzero(inside == number) for number in np.unique(inside)]
    return sorted(parts, key=lambda part: (len(part) < LEAST_STONES, -float(stones.volume[wall.stones[part]].sum())))


def _part(stones: Assemblage, wall: StoneWall, part: IntArray, taken: set[str], *, main: bool) -> StoneWall:
    """Return a part of a wall as a wall; taken: names of walls so far, to which its own is added."""
    own, tag, chart = wall.stones[part], wall.tag[part], wall.chart
    name = wall.name
    if not main:
        name = _name(tag, stones.panel[own] == "", taken)
        tag = np.where(stones.panel[own] == "", name, tag)
        taken.add(name)
    if isinstance(chart, PlaneChart):
        start = float(total_extent(wall.elevations[part])[0])
        chart = replace(chart, origin=chart.origin + start * chart.s_axis)
    return StoneWall(name, own, tag, elevations(stones, own, chart, wall.thickness), chart, wall.thickness)


def _name(tag: NameArray, nameless: BoolArray, taken: set[str]) -> str:
    """Return a name for a wall of stones with these tags (n,) that none has as yet."""
    if nameless.all():
        return next(name for name in map("wall-{}".format, count(1)) if name not in taken)
    stem = str(tag[~nameless][0])
    return stem if stem not in taken else next(name for name in map(f"{stem}-{{}}".format, count(2)) if name not in taken)
