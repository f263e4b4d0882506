"""Walls that stand on thicker ones: a building cut into tiers at the heights where they begin, each with its own mid-planes."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise, permutations

import numpy as np

from churchpipe.bond.junction import crossings
from churchpipe.bond.walls import wall_region
from churchpipe.errors import InputError
from churchpipe.geometry.charts import base_level, footprint_of
from churchpipe.geometry.planar import Region, area, boxes, common, pieces, polygon
from churchpipe.geometry.polygons import TOLERANCE, corners
from churchpipe.model.arrays import FloatArray
from churchpipe.model.building import Building, Panel, PlaneChart


def tier_levels(panels: Sequence[Panel]) -> list[float]:
    """Return the heights z, m, at which a straight wall begins on the top of another one along it, from below upwards."""
    plane = [panel for panel in panels if isinstance(panel.chart, PlaneChart)]
    feet = np.array([panel.outline[:, 1].min() + base_level(panel.chart) for panel in plane])
    tops = np.array([panel.outline[:, 1].max() + base_level(panel.chart) for panel in plane])
    found = {
        float(feet[upper])
        for upper, lower in permutations(range(len(plane)), 2)
        if abs(feet[upper] - tops[lower]) < TOLERANCE and _along(plane[upper], plane[lower])
    }
    levels = sorted(found)
    return [level for number, level in enumerate(levels) if number == 0 or level - levels[number - 1] > TOLERANCE]


def tiers(building: Building, levels: Sequence[float]) -> Iterator[Building]:
    """Yield the walls of a building between some heights, m, from below upwards, with the junctions of those that meet there.

    Raises
    ------
    InputError: an arch that one of the heights cuts.
    """
    for low, high in pairwise([-np.inf, *levels, np.inf]):
        found = (_within(panel, low, high) for panel in building.panels)
        panels = tuple(panel for panel in found if panel is not None)
        meeting = crossings(panels, [wall_region(panel) for panel in panels])
        pairs = [{panels[wall].name for wall in crossing.walls} for crossing in meeting]
        junctions = tuple(junction for junction in building.junctions if set(junction.walls) in pairs)
        yield replace(building, panels=panels, junctions=junctions, vaults=(), ring_beams=())


def _along(upper: Panel, lower: Panel) -> bool:
    """Whether two walls run along each other, and their footprints overlap."""
    one, other = upper.chart, lower.chart
    assert isinstance(one, PlaneChart)
    assert isinstance(other, PlaneChart)
    if np.linalg.norm(np.cross(one.s_axis, other.s_axis)) > TOLERANCE:
        return False
    plans = [footprint_of(p) for p in (upper, lower)]
    return area(common(*plans)) > TOLERANCE * min(upper.thickness, lower.thickness) ** 2


def _within(panel: Panel, low: float, high: float) -> Panel | None:
    """Return the part of a wall between two heights z, m; None where it has none there."""
    base, (start, bottom), (stop, top) = base_level(panel.chart), panel.outline.min(axis=0), panel.outline.max(axis=0)
    bottom, top = max(bottom, low - base), min(top, high - base)
    if top - bottom < TOLERANCE:
        return None
    window = boxes(np.array([[start - 1.0, bottom, stop + 1.0, top]]))[0]
    for region in panel.regions:
        under, over = region.outline[:, 1].min(), region.outline[:, 1].max()
        for level in (bottom, top):
            if region.pattern == "voussoir" and under + TOLERANCE < level < over - TOLERANCE:
                raise InputError(
                    f"shell of {panel.name}",
                    "an arch at the height where a wall beside it gets thinner",
                    found=f"{region.name} from {under + base:.4g} to {over + base:.4g} m, cut at {level + base:g} m",
                    expected="arches below or above it",
                    remedy="Rigid blocks take it as it is.",
                )
    outline = _cut(panel.name, panel.outline, window)
    if outline is None:
        return None
    parts: dict[str, tuple[object, ...]] = {}
    for key in ("regions", "openings", "parts"):
        cut = ((item, _cut(panel.name, item.outline, window)) for item in getattr(panel, key))
        parts[key] = tuple(replace(item, outline=own) for item, own in cut if own is not None)
    return replace(panel, outline=outline, **parts)


def _cut(name: str, outline: FloatArray, window: Region) -> FloatArray | None:
    """Return the part of an outline (n, 2) m in a window, None where there is none."""
    own = polygon(outline)
    found = [piece for piece in pieces(common(own, window)) if area(piece) > TOLERANCE]
    if len(found) > 1:
        raise InputError(
            f"shell of {name}",
            "in several pieces at the height where a wall beside it gets thinner",
            found=len(found),
            expected="one",
            remedy="Rigid blocks take it as it is.",
        )
    if not found:
        return None
    # What lies within is left as it is, to the last digit.
    return outline if area(found[0]) > area(own) - TOLERANCE**2 else corners(np.array(found, dtype=np.object_))[0]
