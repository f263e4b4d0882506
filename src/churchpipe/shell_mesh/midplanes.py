"""The mid-surfaces of the walls: how far each reaches, and the upright lines on which they meet."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from churchpipe.bond.junction import Crossing, crossings
from churchpipe.bond.walls import wall_region
from churchpipe.errors import InputError
from churchpipe.geometry.charts import base_level, lift
from churchpipe.geometry.clusters import NODE_TOLERANCE
from churchpipe.geometry.planar import Region, area, boxes, common, extent, less, polygon, vertices
from churchpipe.geometry.polygons import TOLERANCE
from churchpipe.model.arrays import FloatArray
from churchpipe.model.building import Junction, Panel


@dataclass(frozen=True, slots=True)
class MidSurface:
    """The mid-surface of one wall, in chart coordinates, m.

    solid: what the wall's stones fill, junctions included. region: what the shell covers, walls clipped at the mid-planes
    of those that they end at. regions: outlines (n, 2) of the bond regions, moved along with it. lines (nl,): s of the mid-planes
    of crossing walls, sorted. zones (nz, 2): s of the faces of each crossing wall. ceded (nl, 4): rectangles s0, t0, s1, t1 of
    the junctions that belong to other walls. levels (k,): t at which crossing walls begin or end.
    """

    panel: Panel
    solid: Region
    region: Region
    regions: tuple[FloatArray, ...]
    lines: FloatArray
    zones: FloatArray
    ceded: FloatArray
    levels: FloatArray


def mid_surfaces(panels: Sequence[Panel], junctions: Sequence[Junction] = ()) -> list[MidSurface]:
    """Return the mid-surface of each wall.

    Raises
    ------
    InputError: walls that cannot be laid either; see `crossings`.
    """
    solids = [wall_region(panel) for panel in panels]
    found = crossings(panels, solids, junctions)
    return [_mid_surface(panel, number, solids[number], found) for number, panel in enumerate(panels)]


def line_plan(surface: MidSurface, s: FloatArray) -> FloatArray:
    """Return the places in plan (n, 2) m of upright lines at s (n,)."""
    return lift(surface.panel.chart, np.stack([s, np.zeros(len(s))], axis=1))[:, :2]


def _mid_surface(panel: Panel, number: int, solid: Region, found: Sequence[Crossing]) -> MidSurface:
    base = base_level(panel.chart)
    spans, ceded, levels = [np.empty((0, 2))], [np.empty((0, 4))], [np.empty(0)]
    for crossing in found:
        for place, wall in enumerate(crossing.walls):
            if wall == number:
                span, z, loses = crossing.spans[place], crossing.levels - base, crossing.owner == 1 - place
                rectangles = [(span[0], low, span[1], high) for low, high in zip(z[:-1][loses], z[1:][loses], strict=True)]
                spans.append(span[None])
                ceded.append(np.array(rectangles).reshape(-1, 4))
                alone = crossing.owner < 0
                levels.append(z[np.concatenate(([True], alone[1:] != alone[:-1], [True]))])
    zones = np.concatenate(spans)
    lines = zones.mean(axis=1)
    region, regions = _clipped(panel, zones, lines)
    return MidSurface(
        panel, solid, region, regions, np.unique(lines), zones, np.concatenate(ceded), np.unique(np.concatenate(levels))
    )


def _clipped(panel: Panel, zones: FloatArray, lines: FloatArray) -> tuple[Region, tuple[FloatArray, ...]]:
    """Return the wall without its openings, ended at the mid-planes of crossing walls, and the outlines of its bond regions."""
    low, high = panel.outline[:, 0].min(), panel.outline[:, 0].max()
    first = lines[np.abs(zones - low).min(axis=1) < TOLERANCE]
    last = lines[np.abs(zones - high).min(axis=1) < TOLERANCE]
    left = first.min() if len(first) else low
    right = last.max() if len(last) else high
    if right - left < NODE_TOLERANCE:
        raise InputError(f"wall {panel.name}", "nothing is left between the mid-planes of the walls it ends at")
    _, bottom, _, top = extent(polygon(panel.outline))
    inner = (zones[:, 0] > low + TOLERANCE) & (zones[:, 1] < high - TOLERANCE)
    outline, *regions = (
        _steps_on_lines(ring, zones[inner], lines[inner]) for ring in (panel.outline, *(r.outline for r in panel.regions))
    )
    window = boxes(np.array([[left, bottom, right, top]]))[0]
    whole = common(polygon(outline), window)
    region = less(whole, [polygon(opening.outline) for opening in panel.openings])
    if area(region) == 0:
        raise InputError(f"wall {panel.name}", "nothing is left of its mid-surface", remedy="Check its openings.")
    return region, tuple(regions)


def _steps_on_lines(outline: FloatArray, zones: FloatArray, lines: FloatArray) -> FloatArray:
    """Return the outline with its upright edges at the face of a crossing wall, or within it, moved to that wall's mid-plane.

    A tower rises from the far or the near face of the wall that carries it; its mid-surface rises from that wall's own. A slope
    that starts at the edge starts there too, on its own line.
    """
    moved = outline.copy()
    after = np.roll(np.arange(len(outline)), -1)
    before = np.roll(np.arange(len(outline)), 1)
    upright = np.abs(outline[:, 0] - outline[after, 0]) < TOLERANCE
    for (start, stop), line in zip(zones, lines, strict=True):
        edge = upright & (outline[:, 0] > start - TOLERANCE) & (outline[:, 0] < stop + TOLERANCE)
        for corner, beside in ((np.flatnonzero(edge), before[edge]), (after[edge], after[after[edge]])):
            run, rise = (outline[corner] - outline[beside]).T
            sloping = np.abs(run) > TOLERANCE
            slope = np.where(sloping, rise / np.where(sloping, run, 1.0), 0.0)
            moved[corner] = np.stack(
                [np.full(len(corner), line), outline[corner, 1] + slope * (line - outline[corner, 0])], axis=1
            )
    return moved


def corner_levels(surface: MidSurface, span: FloatArray) -> FloatArray:
    """Return the heights t between the faces `span` (2,) of a crossing wall at which the wall or its junctions change, m."""
    point = np.concatenate([vertices(surface.solid), vertices(surface.region)])
    inside = (point[:, 0] > span[0] - TOLERANCE) & (point[:, 0] < span[1] + TOLERANCE)
    bounds = extent(surface.solid)[[1, 3]]
    marks = np.unique(np.concatenate([point[inside, 1], surface.levels, bounds]))
    marks = marks[(marks >= bounds[0]) & (marks <= bounds[1])]
    return marks[np.append(True, np.diff(marks) > TOLERANCE)]
