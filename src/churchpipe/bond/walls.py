"""Laying a whole wall: its junctions, then each bond region in turn."""

from collections.abc import Iterator

import numpy as np

from churchpipe.bond.field import Field
from churchpipe.bond.header_stretcher import check_leaves
from churchpipe.bond.junction import WallJunctions
from churchpipe.bond.patterns import bond_of
from churchpipe.bond.tiles import TileSet, join, sorted_by_course
from churchpipe.bond.voids import voids_of
from churchpipe.bond.zones import Band, bands_of
from churchpipe.errors import InputError
from churchpipe.geometry.charts import ALONG, check_upright, closes, counted_from
from churchpipe.geometry.planar import Region, area, boxes, common, extent, less, polygon, why_invalid
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
    panel: the wall. solid: its outline less openings. junctions: where other walls cross it, and the rectangles that they own.
    """
    own = less(solid, boxes(junctions.ceded))
    sets: list[TileSet] = []
    for number, region in enumerate(panel.regions):
        above = [polygon(later.outline) for later in panel.regions[number + 1 :]]
        part = less(common(polygon(region.outline), own), above)
        in_courses = region.pattern in ("running", "stack", "header-stretcher")
        try:
            if area(part) > 0 and region.pattern == "header-stretcher":
                check_leaves(panel, region)
            fields = _fields(panel, region.name, part, junctions, in_bands=in_courses)
            sets += [bond_of(region).tiles(field) for field in fields if area(field.solid) > 0 or not in_courses]
        except InputError as error:
            raise InputError(
                f"wall {panel.name}, {error.where}",
                error.problem,
                # A bond lies in flat coordinates: only here it is known where they are.
                found=f"{error.found}, {counted_from(panel.chart)}" if ALONG in str(error.found) else error.found,
                expected=error.expected,
                remedy=error.remedy,
            ) from error
    if not sets:
        raise InputError(f"wall {panel.name}", "nothing is left of the wall", remedy="Other walls own all of it.")
    return sorted_by_course(join(sets))


def _fields(panel: Panel, name: str, part: Region, junctions: WallJunctions, *, in_bands: bool) -> Iterator[Field]:
    """Yield what one bond fills: one field, or where crossing walls get thinner one for each band of height (in_bands)."""
    span = (float(panel.outline[:, 0].min()), float(panel.outline[:, 0].max()))
    bands = bands_of(junctions.crossed)
    curved = isinstance(panel.chart, CylinderChart)
    if curved or not in_bands or len(bands) == 1:
        bands = [Band(-np.inf, np.inf, junctions.zones)]
    _, bottom, _, top = extent(polygon(panel.outline))
    for band in bands:
        window = boxes(np.array([[span[0], max(band.low, bottom), span[1], min(band.high, top)]]))[0]
        yield Field(
            name=name,
            solid=part if len(bands) == 1 else common(part, window),
            span=span,
            through=panel.runs_through or 0,
            zones=band.zones,
            ceded=junctions.ceded,
            closed=closes(panel.chart, *span),
            voids=voids_of(panel),
            radius=panel.chart.radius if isinstance(panel.chart, CylinderChart) else np.inf,
        )
