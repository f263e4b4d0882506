"""Lintels of walls that are given whole: known by their names, or laid over openings that have a flat head."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from churchpipe.bond.junction import wall_junctions
from churchpipe.bond.walls import wall_region
from churchpipe.errors import InputError
from churchpipe.geometry.charts import ALONG, counted_from
from churchpipe.geometry.planar import Polygons, Region, area, boxes, common, extent, less, pieces, polygon, rings
from churchpipe.model.arrays import FloatArray
from churchpipe.model.building import BondRegion, Panel

_LINTEL = re.compile(r"(?:.*/)?lintels?(?![a-z])", re.IGNORECASE)
# Edges that are off by less are level or upright, m.
LEVEL = 1e-6
# A lintel is at least this share of a course high, and bears on either side at least this share of what was asked.
LEAST_HEIGHT, LEAST_BEARING = 0.5, 0.25
# What is left of a wall beside a lintel is at least this share of a stone long; the bond refuses less.
LEAST_REST = 0.25
# An opening has a lintel, or an arch, where this share of its head lies under one.
UNDER = 0.9
# A lintel that is lower than this share of its length, or bears on less, is asked about.
SLIGHT = 0.02
# So does one that bears on less than this, m, where it is as high, unlike those of small models: the edge below it spalls.
SEAT = 0.05
# How far above a head what lies over it is looked for, m.
ABOVE = 1e-3


@dataclass(frozen=True, slots=True)
class Head:
    """The top of an opening, m in the chart of its wall: it goes from start to stop at the height `level`; flat, or curved."""

    start: float
    stop: float
    level: float
    flat: bool


@dataclass(frozen=True, slots=True)
class LaidLintel:
    """A lintel that was laid over the head of an opening: its wall, and how far it bears on the left and the right, m."""

    wall: str
    head: Head
    bearing: tuple[float, float]


def is_lintel(name: str) -> bool:
    """Return whether a body or a layer of this name is a lintel; a body may have the name of its file before its own."""
    return _LINTEL.match(name) is not None


def bare_heads(panel: Panel) -> list[Head]:
    """Return the heads of openings over which the wall has neither a lintel nor an arch."""
    over = [polygon(region.outline) for region in panel.regions if region.pattern in ("single", "voussoir")]
    return [head for head in _heads(wall_region(panel)) if not _is_under(head, over)]


def bearings(panel: Panel) -> list[tuple[str, float, float]]:
    """Return the name of each lintel of a wall, and how far it rests on the wall on the left and on the right, m.

    One below which the wall goes on from end to end rests on half of its length on either side, one beside which nothing stands
    on nothing.
    """
    solid = wall_region(panel)
    found: list[tuple[str, float, float]] = []
    for region in panel.regions:
        if region.pattern != "single":
            continue
        start, level, stop, _ = extent(polygon(region.outline)).tolist()
        strip = boxes(np.array([[start, level - ABOVE, stop, level]]))[0]
        spans = [extent(piece)[[0, 2]] for piece in pieces(common(strip, solid)) if area(piece) > LEVEL * area(strip)]
        middle = 0.5 * (start + stop)
        left = sum(max(0.0, min(float(high), middle) - float(low)) for low, high in spans)
        right = sum(max(0.0, float(high) - max(float(low), middle)) for low, high in spans)
        found.append((region.name, left, right))
    return found


def beyond(panel: Panel) -> list[tuple[str, float]]:
    """Return the name of each lintel that reaches beyond the ends or the top of its wall, and by how far, m."""
    lintels = [region for region in panel.regions if region.pattern == "single"]
    start, _, stop, top = extent(less(wall_region(panel), [polygon(region.outline) for region in lintels])).tolist()
    reach = [(region.name, extent(polygon(region.outline))) for region in lintels]
    out = [(name, float(max(start - each[0], each[2] - stop, each[3] - top))) for name, each in reach]
    return [(name, by) for name, by in out if by > LEVEL]


def slight(panel: Panel) -> list[tuple[str, float, float, float]]:
    """Return name, height, length and least bearing, m, of lintels that hardly are any, as slips of the hand are: lower than a
    fiftieth of their length, or borne on one side by less than that, or by less than `SEAT`, though by more than nothing."""
    size = {region.name: extent(polygon(region.outline)) for region in panel.regions if region.pattern == "single"}
    found = [(name, size[name], min(left, right)) for name, left, right in bearings(panel)]
    least = [(name, float(box[3] - box[1]), float(box[2] - box[0]), rests) for name, box, rests in found]
    return [one for one in least if one[1] < SLIGHT * one[2] or LEVEL < one[3] < max(SLIGHT * one[2], min(SEAT, one[1]) - LEVEL)]


def with_lintels(panels: Sequence[Panel], bearing: float) -> tuple[list[Panel], list[LaidLintel]]:
    """Return walls with a lintel over each flat head that has none, and the lintels that were laid.

    A lintel goes from the head up to the first bed joint that makes it half a course high, or to the top of the wall. It bears on
    both sides as far as asked (m), less where the wall ends, another wall crosses it, or a narrow pier is shared with the next.

    Raises
    ------
    InputError: an opening that has no room for a lintel.
    """
    solids = [wall_region(panel) for panel in panels]
    junctions = wall_junctions(panels, solids)
    out: list[Panel] = []
    laid: list[LaidLintel] = []
    for panel, solid, junction in zip(panels, solids, junctions, strict=True):
        heads = [head for head in bare_heads(panel) if head.flat]
        if not heads:
            out.append(panel)
            continue
        low, high = float(panel.outline[:, 1].min()), float(panel.outline[:, 1].max())
        zones = np.array([[start, low, stop, high] for start, stop in junction.zones]).reshape(-1, 4)
        insets = [polygon(region.outline) for region in panel.regions if region.pattern in ("single", "voussoir")]
        free = less(solid, [*boxes(zones), *insets])
        levels = [_top(head, panel.regions[0].cell.a, high) for head in heads]
        rest = LEAST_REST * panel.regions[0].cell.b
        ends = [_ends(head, top, free, bearing, rest) for head, top in zip(heads, levels, strict=True)]
        _share_piers(heads, levels, ends, rest)
        lintels: list[BondRegion] = []
        for head, top, (start, stop) in zip(heads, levels, ends, strict=True):
            own = (head.start - start, stop - head.stop)
            stone = boxes(np.array([[start, head.level, stop, top]]))[0]
            low_stone = top - head.level < (LEAST_HEIGHT - LEVEL) * panel.regions[0].cell.a
            if low_stone or min(own) < LEAST_BEARING * bearing or area(less(stone, [free])) > LEVEL * area(stone):
                raise _no_room(panel, head, own, bearing, top, free, boxes(zones))
            outline = np.array([[start, head.level], [stop, head.level], [stop, top], [start, top]])
            lintels.append(BondRegion(f"lintel-{len(lintels) + 1}", outline, "single", panel.regions[0].cell, yields=False))
            laid.append(LaidLintel(panel.name, head, own))
        out.append(replace(panel, regions=(*panel.regions, *lintels)))
    return out, laid


def undersides(solid: Region) -> Iterator[tuple[FloatArray, bool, bool]]:
    """Yield each chain (n, 2) m of edges of a wall that run to the right, with the wall above them; whether the wall goes down
    before it, and whether after it."""
    for piece in pieces(solid):
        for number, ring in enumerate(rings(piece)):
            points = ring[:-1]
            area_twice = float(np.sum(points[:, 0] * np.roll(points[:, 1], -1) - np.roll(points[:, 0], -1) * points[:, 1]))
            # The wall lies on the left of its outline, and of the outlines of its holes, when these are run backwards.
            points = points if (area_twice > 0) == (number == 0) else points[::-1]
            step = np.roll(points, -1, axis=0) - points
            right = step[:, 0] > LEVEL
            for first in np.flatnonzero(right & ~np.roll(right, 1)):
                count = int(np.argmin(np.roll(right, -first)))
                chain = np.take(points, range(first, first + count + 1), axis=0, mode="wrap")
                yield chain, bool(step[first - 1, 1] > LEVEL), bool(step[(first + count) % len(points), 1] < -LEVEL)


def _heads(solid: Region) -> list[Head]:
    """Return the heads of openings: undersides of a wall from one upright side to another."""
    found: list[Head] = []
    base = float(extent(solid)[1])
    for chain, rises, falls in undersides(solid):
        if rises and falls and chain[:, 1].max() > base + LEVEL:
            flat = bool(np.ptp(chain[:, 1]) <= LEVEL)
            found.append(Head(float(chain[0, 0]), float(chain[-1, 0]), float(chain[:, 1].max()), flat))
    return sorted(found, key=lambda head: (head.start, head.level))


def _is_under(head: Head, over: Sequence[Region]) -> bool:
    strip = boxes(np.array([[head.start, head.level, head.stop, head.level + ABOVE]]))[0]
    return sum(area(common(strip, region)) for region in over) > UNDER * area(strip)


def _top(head: Head, course: float, highest: float) -> float:
    """Return up to where a lintel goes, m: a bed joint, or the top of its wall."""
    bed = float(np.ceil(head.level / course + LEAST_HEIGHT - LEVEL)) * course
    return min(bed, highest)


def _ends(head: Head, top: float, free: Region, bearing: float, rest: float) -> list[float]:
    """Return from where to where a lintel may go, m: as far as asked, or to the first place beside the head that is not free.

    What would be left of the wall between the two is too narrow to lay below `rest`, m: the lintel takes it as well.
    """
    low, reach = 2.0 * head.level - top, bearing + rest
    sides = np.array([[head.start - reach, low, head.start, top], [head.stop, low, head.stop + reach, top]])
    left, right = (less(side, [free]) for side in boxes(sides))
    start = float(extent(left)[2]) if area(left) > LEVEL**2 else head.start - bearing
    stop = float(extent(right)[0]) if area(right) > LEVEL**2 else head.stop + bearing
    return [start, stop]


def _share_piers(heads: Sequence[Head], tops: Sequence[float], ends: list[list[float]], rest: float) -> None:
    """Let lintels that would lie in each other, or leave too little between them, end over the middle of the pier."""
    order = sorted(range(len(heads)), key=lambda number: heads[number].start)
    for one, other in [(a, b) for place, a in enumerate(order) for b in order[place + 1 :]]:
        apart = heads[one].level > tops[other] - LEVEL or heads[other].level > tops[one] - LEVEL
        if not apart and heads[other].start >= heads[one].stop and ends[one][1] > ends[other][0] - rest:
            ends[one][1] = ends[other][0] = 0.5 * (heads[one].stop + heads[other].start)


def _no_room(
    panel: Panel, head: Head, own: tuple[float, float], bearing: float, top: float, free: Region, crossing: Polygons
) -> InputError:
    """Return what to say of a head, over which no lintel can go up to `top`, m; free: where it may lie; crossing: other walls."""
    wanted = boxes(np.array([[head.start - bearing, head.level, head.stop + bearing, top]]))[0]
    taken = less(boxes(np.array([[head.start, head.level, head.stop, top]]))[0], [free])
    above = float(extent(taken)[1]) if area(taken) > LEVEL**2 else top
    kinds = {"single": "the lintel", "voussoir": "the arch"}
    there = [
        f"{kinds[region.pattern]} {region.name}"
        for region in panel.regions
        if region.pattern in kinds and area(common(wanted, polygon(region.outline))) > LEVEL**2
    ]
    drawn = ", ".join(there)
    crosses = any(area(common(wanted, zone)) > LEVEL**2 for zone in crossing)
    there += ["a wall that crosses"] * crosses
    remedy = "Draw the lintel of this opening as an outline on a layer LINTEL, or ask for a smaller bearing."
    if crosses:
        remedy = "Move the opening away from the wall that crosses, or draw its lintel, on a layer LINTEL, into that wall."
    if drawn:
        remedy = f"Draw {drawn} on the head, as wide as the opening and its bearings, or leave it out."
    return InputError(
        panel.name,
        "no room for a lintel over an opening",
        found=f"{own[0]:.3g} m on the left, {own[1]:.3g} m on the right and {above - head.level:.3g} m above the opening from "
        f"{head.start:.4g} to {head.stop:.4g} {ALONG}, {counted_from(panel.chart)}; its head is {head.level:.4g} m high"
        + (f", beside {' and '.join(there)}" if there else ""),
        expected=f"wall on both sides, {LEAST_BEARING * bearing:.3g} m at least, and {LEAST_HEIGHT:g} of a course above it",
        remedy=remedy,
    )
