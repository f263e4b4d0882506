"""Which macro-element a place on a wall belongs to."""

import numpy as np

from churchpipe.geometry.planar import distances, polygon
from churchpipe.geometry.polygons import TOLERANCE
from churchpipe.model.arrays import FloatArray, NameArray
from churchpipe.model.building import Panel


def part_names(panel: Panel, points: FloatArray) -> NameArray:
    """Return for points (n, 2) m, chart coordinates, the name of the part of the wall that each lies in, else the panel's name
    (n,).

    A point on the border of two parts belongs to the one listed first.
    """
    width = max(len(name) for name in (panel.name, *(part.name for part in panel.parts)))
    names = np.full(len(points), panel.name, dtype=f"<U{width}")
    for part in reversed(panel.parts):
        names[distances(polygon(part.outline), points) < TOLERANCE] = part.name
    return names
