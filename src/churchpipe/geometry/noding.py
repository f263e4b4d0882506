# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false
"""Lines and regions that nearly meet: faces between lines, union of polygons across gaps, notches of an outline."""

from collections.abc import Sequence

import numpy as np
import shapely

from churchpipe.geometry.planar import Polygons, Region, contains, extent, inner_points, pieces
from churchpipe.model.arrays import FloatArray


def faces_between(region: Region, lines: Sequence[FloatArray], grid: float) -> Polygons:
    """Return the faces (n,) that lines cut a region into.

    Lines that cross, or end on one another, meet in a node. A line that ends inside the region divides nothing.

    Parameters
    ----------
    lines: points (k, 2) of each. grid: coordinates are rounded to it, m, so that lines that nearly meet do.
    """
    noded = shapely.union_all([shapely.boundary(region), *(shapely.LineString(line) for line in lines)], grid_size=grid)
    faces = np.asarray(shapely.get_parts(shapely.polygonize(shapely.get_parts(noded))), dtype=np.object_)
    shapely.prepare(region)
    return faces[contains(region, inner_points(faces))]


def joined_over_gaps(polygons: Polygons, gap: float, grid: float) -> list[shapely.Polygon]:
    """Return the connected pieces of the union of polygons after gaps of less than 2 `gap` are closed.

    Coordinates are rounded to the grid (both in m), and corners that lie on a straight side within it are left out.
    """
    grown = shapely.buffer(shapely.union_all(polygons, grid_size=grid), gap, join_style="mitre", mitre_limit=10.0)
    shrunk = shapely.buffer(grown, -gap, join_style="mitre", mitre_limit=10.0)
    return pieces(shapely.simplify(shapely.set_precision(shrunk, grid), 2 * grid))


def notches(region: shapely.Polygon, grid: float) -> list[tuple[shapely.Polygon, FloatArray]]:
    """Return the regions between a region and its convex hull, each with the rectangle s0, t0, s1, t1 around its open side.

    grid: notches whose open side is shorter than this, m, are left out.
    """
    hull = shapely.convex_hull(region)
    found: list[tuple[shapely.Polygon, FloatArray]] = []
    for piece in pieces(shapely.difference(hull, region)):
        mouth = shapely.intersection(shapely.boundary(hull), shapely.boundary(piece))
        if mouth.length > grid:
            found.append((piece, extent(mouth)))
    return found
