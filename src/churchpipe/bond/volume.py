"""The volume of a set of walls, counted without laying a stone."""

from collections.abc import Sequence

import numpy as np

from churchpipe.bond.voids import Void, voids_of
from churchpipe.geometry.charts import base_level, footprint, lift, normals
from churchpipe.geometry.planar import Region, area, edges, less, level_section, polygon, united, vertices
from churchpipe.geometry.polygons import TOLERANCE
from churchpipe.model.arrays import FloatArray
from churchpipe.model.building import Chart, CylinderChart, Panel


def masonry_volume(
    panels: Sequence[Panel], solids: Sequence[Region], faces: Sequence[FloatArray], stations: Sequence[FloatArray]
) -> float:
    """Return the volume of the union of the walls, m3.

    The area of the horizontal section is integrated over the height, by Gauss' rule with two points. The heights are divided at
    every level at which an outline turns or a sloping edge passes the face of a crossing wall. Between two such levels the area
    is at most a cubic function of the height, for which the rule is exact.

    Parameters
    ----------
    panels: the walls, upright. solids: outline less openings of each, chart coordinates. faces: s of the junction faces
    of each, m. stations: s of the head joints of each, m; a curved wall is straight from one to the next.
    """
    voids = [voids_of(panel) for panel in panels]
    solids = [_with_voids_filled(panel, solid) for panel, solid in zip(panels, solids, strict=True)]
    levels = [_levels(p, s, f) for p, s, f in zip(panels, solids, faces, strict=True)]
    levels += [_void_levels(p, j, v) for p, j, own in zip(panels, stations, voids, strict=True) for v in own]
    levels = np.unique(np.concatenate(levels))
    levels = levels[np.append(True, np.diff(levels) > TOLERANCE)]
    height = np.diff(levels)
    volume = 0.0
    for point in (0.5 - np.sqrt(1 / 12), 0.5 + np.sqrt(1 / 12)):
        section = [_section_area(panels, solids, stations, voids, z) for z in levels[:-1] + point * height]
        volume += float(0.5 * height @ np.array(section))
    return volume


def _levels(panel: Panel, solid: Region, faces: FloatArray) -> FloatArray:
    """Return z of the corners of a wall and of the points where its sloping edges pass a junction face, m."""
    (s0, t0), (s1, t1) = edges(solid).transpose(1, 2, 0)[..., None]
    crossed = (s0 - faces) * (s1 - faces) < 0
    share = (faces - s0) / np.where(crossed, s1 - s0, 1.0)
    levels = [vertices(solid)[:, 1], (t0 + share * (t1 - t0))[crossed]]
    return np.concatenate(levels) + base_level(panel.chart)


def _with_voids_filled(panel: Panel, solid: Region) -> Region:
    """Return a wall with its arched openings filled, if it is curved. These openings are prisms and are subtracted from the
    section.

    The region is made of the outlines. Uniting a finished region with its openings can leave slits as narrow as rounding along
    their edges, and each slit would be taken for a joint, at which the wall bends.
    """
    if not isinstance(panel.chart, CylinderChart):
        return solid
    return less(polygon(panel.outline), [polygon(o.outline) for o in panel.openings if o.kind != "arched"])


def _void_levels(panel: Panel, stations: FloatArray, void: Void) -> FloatArray:
    """Return z of the corners of an opening, and of the points where its edges pass a bend in a face of the wall, m."""
    chart = panel.chart
    assert isinstance(chart, CylinderChart)
    turn = (stations - void.middle) / chart.radius
    bends = np.outer(void.radii, np.sin(turn[np.abs(turn) < np.pi / 2])).ravel()
    (x0, t0), (x1, t1) = edges(polygon(void.opening)).transpose(1, 2, 0)[..., None]
    passed = (x0 - bends) * (x1 - bends) < 0
    share = (bends - x0) / np.where(passed, x1 - x0, 1.0)
    return np.concatenate([void.opening[:, 1], (t0 + share * (t1 - t0))[passed]]) + base_level(chart)


def _section_area(
    panels: Sequence[Panel],
    solids: Sequence[Region],
    stations: Sequence[FloatArray],
    voids: Sequence[Sequence[Void]],
    z: float,
) -> float:
    parts: list[Region] = []
    for panel, solid, joints, own in zip(panels, solids, stations, voids, strict=True):
        level = z - base_level(panel.chart)
        wall = [footprint(panel.chart, panel.thickness, start, stop, joints) for start, stop in level_section(solid, level)]
        holes = [_strip(panel.chart, void, *span) for void in own for span in level_section(polygon(void.opening), level)]
        parts += [less(united(wall), holes)] if holes else wall
    return area(united(parts))


def _strip(chart: Chart, void: Void, start: float, stop: float) -> Region:
    """Return in plan what an opening removes at one level: from x = start to x = stop, m, and from the wall's axis outwards."""
    middle = np.array([[void.middle, 0.0]])
    normal = normals(chart, middle)[0, :2]
    across = np.array([-normal[1], normal[0]])
    foot = lift(chart, middle)[0, :2] - 0.5 * (void.radii[0] + void.radii[1]) * normal
    far = 2 * void.radii[1] * normal
    near = [foot + start * across, foot + stop * across]
    return polygon([near[0], near[1], near[1] + far, near[0] + far])
