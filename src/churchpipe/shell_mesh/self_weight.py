"""The weight carried by each part of a mid-surface, chosen so that the shell weighs what the stones weigh.

Mid-planes of walls that meet overlap, or leave a corner uncovered. The stones of a junction belong to one wall on some courses
and to the other on the rest. Convention: between the faces of a crossing wall, a mid-surface carries the stones that its own
wall has there, spread evenly over its area in the junction. A wall without stones in a junction weighs nothing there. Where
courses of two crossing walls alternate, each carries half. At a corner, where each mid-surface covers only half of the junction,
each carries its half of the stones on that smaller area. The weight in all and of each wall is exact for plane walls.
"""

from itertools import pairwise

import numpy as np

from churchpipe.geometry.planar import area, areas, boxes, common, common_areas, less, polygons_of
from churchpipe.geometry.polygons import TOLERANCE
from churchpipe.model.arrays import FloatArray
from churchpipe.shell_mesh.midplanes import MidSurface, corner_levels


def weight_factors(surface: MidSurface, corners: FloatArray) -> FloatArray:
    """Return for each facet the share (nt,) of thickness x unit weight that it carries.

    Parameters
    ----------
    surface: the mid-surface. corners: corners (nt, 3, 2) m of its facets, chart coordinates.
    """
    facets = polygons_of(corners.reshape(-1, 2), 3 * np.arange(len(corners) + 1))
    whole = areas(facets)
    factor = np.ones(len(facets))
    for rectangle, share in _junction_shares(surface):
        near = (corners[:, :, 0].max(axis=1) > rectangle[0]) & (corners[:, :, 0].min(axis=1) < rectangle[2])
        factor[near] += (share - 1.0) * common_areas(facets[near], boxes(rectangle[None])[0]) / whole[near]
    return np.where(np.abs(factor) < 1e-9, 0.0, factor)


def _junction_shares(surface: MidSurface) -> list[tuple[FloatArray, float]]:
    """Return rectangles s0, t0, s1, t1, and for each the area of the wall's stones over that of its mid-surface."""
    owned = less(surface.solid, boxes(surface.ceded))
    shares: list[tuple[FloatArray, float]] = []
    for span in _merged(surface.zones):
        levels = corner_levels(surface, span)
        for low, high in pairwise(levels):
            rectangle = np.array([span[0], low, span[1], high])
            band = boxes(rectangle[None])[0]
            covered = area(common(surface.region, band))
            if covered > TOLERANCE:
                shares.append((rectangle, area(common(owned, band)) / covered))
    return shares


def _merged(zones: FloatArray) -> FloatArray:
    """Return the zones (n, 2), those that overlap as one, sorted."""
    joined: list[FloatArray] = []
    for span in zones[np.lexsort((zones[:, 1], zones[:, 0]))]:
        if joined and span[0] < joined[-1][1] - TOLERANCE:
            joined[-1] = np.array([joined[-1][0], max(joined[-1][1], span[1])])
        else:
            joined.append(span)
    return np.array(joined).reshape(-1, 2)
