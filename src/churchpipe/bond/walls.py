"""Laying a whole wall: its junctions, then each bond region in turn."""

import numpy as np

from churchpipe.bond.field import Field
from churchpipe.bond.header_stretcher import check_leaves
from churchpipe.bond.junction import WallJunctions
from churchpipe.bond.patterns import bond_of
from churchpipe.bond.tiles import TileSet, join, sorted_by_course
from churchpipe.bond.voids import voids_of
from churchpipe.errors import InputError
from churchpipe.geometry.charts import check_upright, closes
from churchpipe.geometry.planar import Region, area, boxes, common, less, polygon, why_invalid
from churchpipe.model.building import CylinderChart, Panel


def wall_region(panel: Panel) -> Region:
    """Return the outline of a wall less its openings, chart coordinates, m2."""
    check_upright(panel.name, panel.chart)
    outline, openings = polygon(panel.outline), [polygon(o.outline) for o in panel.openings]
    for name, ring in zip((panel.name, *(o.name for o in panel.openings)), (outline, *openings), strict=True):
        if flaw := why_invalid(ring):
            raise InputError(f"wall {panel.name}: outline of {name}", "not a simple polygon", found=flaw)
    region = less(outline, openings)
    if area(region) == 0:
        raise InputError(f"wall {panel.name}", "nothing is left of the wall", remedy="Check its openings.")
    return region


def lay_wall(panel: Panel, solid: Region, junctions: WallJunctions) -> TileSet:
    """Return the stones of one wall in chart coordinates, region by region, without the junctions that belong to other walls.

    Parameters
    ----------
    panel: the wall. solid: its outline less openings. junctions: its zones, and the rectangles of them that other walls own.
    """
    own = less(solid, boxes(junctions.ceded))
    span = (float(panel.outline[:, 0].min()), float(panel.outline[:, 0].max()))
    voids = voids_of(panel)
    sets: list[TileSet] = []
    for number, region in enumerate(panel.regions):
        above = [polygon(later.outline) for later in panel.regions[number + 1 :]]
        part = less(common(polygon(region.outline), own), above)
        if area(part) == 0 and region.pattern in ("running", "stack", "header-stretcher"):
            continue
        field = Field(
            name=region.name,
            solid=part,
            span=span,
            through=panel.runs_through or 0,
            zones=junctions.zones,
            ceded=junctions.ceded,
            closed=closes(panel.chart, *span),
            voids=voids,
            radius=panel.chart.radius if isinstance(panel.chart, CylinderChart) else np.inf,
        )
        try:
            if region.pattern == "header-stretcher":
                check_leaves(panel, region)
            sets.append(bond_of(region).tiles(field))
        except InputError as error:
            raise InputError(
                f"wall {panel.name}, {error.where}",
                error.problem,
                found=error.found,
                expected=error.expected,
                remedy=error.remedy,
            ) from error
    if not sets:
        raise InputError(f"wall {panel.name}", "nothing is left of the wall", remedy="Other walls own all of it.")
    return sorted_by_course(join(sets))
