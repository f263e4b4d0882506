"""The volume of a set of walls, counted without laying a stone."""

from collections.abc import Sequence

import numpy as np

from churchpipe.bond.charts import base_level, footprint
from churchpipe.bond.planar import Region, area, edges, level_section, united, vertices
from churchpipe.bond.polygons import TOLERANCE
from churchpipe.model.arrays import FloatArray
from churchpipe.model.building import Panel


def masonry_volume(
    panels: Sequence[Panel], solids: Sequence[Region], faces: Sequence[FloatArray], stations: Sequence[FloatArray]
) -> float:
    """Return the volume of the union of the walls, m3.

    The area of the horizontal section is integrated over the height by Gauss' rule with two points, exact while it is at
    most cubic: between the levels at which an outline turns or a sloping edge passes the face of a crossing wall.

    Parameters
    ----------
    panels: the walls, upright. solids: outline less openings of each, chart coordinates. faces: s of the junction faces
    of each, m. stations: s of the joints of each, m (curved walls are straight between joints).
    """
    levels = np.unique(np.concatenate([_levels(p, s, f) for p, s, f in zip(panels, solids, faces, strict=True)]))
    levels = levels[np.append(True, np.diff(levels) > TOLERANCE)]
    height = np.diff(levels)
    volume = 0.0
    for point in (0.5 - np.sqrt(1 / 12), 0.5 + np.sqrt(1 / 12)):
        section = [_section_area(panels, solids, stations, z) for z in levels[:-1] + point * height]
        volume += float(0.5 * height @ np.array(section))
    return volume


def _levels(panel: Panel, solid: Region, faces: FloatArray) -> FloatArray:
    """Return z of the corners of a wall and of the points where its sloping edges pass a junction face, m."""
    (s0, t0), (s1, t1) = edges(solid).transpose(1, 2, 0)[..., None]
    crossed = (s0 - faces) * (s1 - faces) < 0
    share = (faces - s0) / np.where(crossed, s1 - s0, 1.0)
    levels = [vertices(solid)[:, 1], (t0 + share * (t1 - t0))[crossed]]
    return np.concatenate(levels) + base_level(panel.chart)


def _section_area(panels: Sequence[Panel], solids: Sequence[Region], stations: Sequence[FloatArray], z: float) -> float:
    pieces: list[Region] = []
    for panel, solid, joints in zip(panels, solids, stations, strict=True):
        for start, stop in level_section(solid, z - base_level(panel.chart)):
            pieces.append(footprint(panel.chart, panel.thickness, start, stop, joints))
    return area(united(pieces))
