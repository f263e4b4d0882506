"""Joints that crush while stones move: where in a joint its points lie, and where it still bears when it has opened.

A stone that turns about a strip of its joint sinks in there, by the width of the strip times its angle, and opens beyond. What
bears is the part whose gap is not above the `margin`, in which the program finds the pressed part (`conic.pressed`). A joint that
needs more has to close gaps beyond the margin first, at lines of equal gap between the margin and the reach.
"""

import numpy as np

from churchpipe.large_displacements.settings import PATH
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.rigid_blocks.polygons import cross, summed


def rectangles_of(corner: FloatArray, start: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return where the corners (nc, 2) of convex polygons lie in rectangles within these (nc, 2), from -1 to 1 along either side,
    and the shares (np,) that these have of their areas. start (np,): the first corner of each polygon.

    The sides of a rectangle are parallel to the longest side of its polygon and across. It has the shape of the bounding box,
    and is the largest one about the centroid of the polygon: of a rectangle, itself.
    """
    count = np.diff(np.append(start, len(corner)))
    owner, after = np.repeat(np.arange(len(start)), count), np.arange(len(corner)) + 1
    after[start + count - 1] = start
    middle = summed(corner, start) / count[:, None]
    flat = corner - middle[owner]
    turned = cross(flat, flat[after])
    centre = summed((flat + flat[after]) * turned[:, None], start) / (3.0 * summed(turned, start)[:, None])
    flat = flat - centre[owner]
    edge = flat[after] - flat
    length = np.hypot(*edge.T)
    longest = np.lexsort((-length, owner))[start]
    along = (edge[longest] / length[longest, None])[owner]
    flat, edge = (np.stack([(vector * along).sum(axis=1), cross(along, vector)], axis=1) for vector in (flat, edge))
    half = 0.5 * (np.maximum.reduceat(flat, start) - np.minimum.reduceat(flat, start))
    # An edge is as far from the centroid as that of the rectangle when it touches a corner of this.
    needed = np.abs(edge[:, 1]) * half[owner, 0] + np.abs(edge[:, 0]) * half[owner, 1]
    half *= np.minimum.reduceat(np.abs(cross(flat, edge)) / needed, start)[:, None]
    return flat / half[owner], 8.0 * half.prod(axis=1) / np.abs(summed(turned, start))


def bearing_margin(least: FloatArray, reach: float) -> FloatArray:
    """Return how far open (np,) m joints still bear; least (np,) m: their least gap, negative where stones have sunk in."""
    return np.minimum(PATH.bearing * reach + np.maximum(-least, 0.0), reach)


def with_lines_of_equal_gap(
    corner: FloatArray, gap: FloatArray, owner: IntArray, margin: FloatArray, reach: float
) -> tuple[FloatArray, IntArray]:
    """Return the corners of polygons with the points where their sides cross lines of equal gap, in order, and their polygons.

    corner (nc, m): whatever is linear along a side; gap (nc,) m, linear over a polygon; owner (nc,), ascending. The lines are
    those of the margin (np,) m of each polygon, of the reach, and of the gap half-way between them by ratio.
    """
    start, after = np.searchsorted(owner, np.arange(len(margin))), np.arange(len(corner)) + 1
    after[np.append(start[1:], len(corner)) - 1] = start
    whole = (1.0 - 1e-9) * reach
    further = margin * PATH.further**2 < whole
    points, owners, places = [corner], [owner], [np.arange(len(corner), dtype=np.float64)]
    for level in (margin, np.where(further, np.sqrt(margin * whole), np.inf), np.where(further, whole, np.inf)):
        crossed = np.flatnonzero((gap < level[owner]) != (gap[after] < level[owner]))
        share = (level[owner[crossed]] - gap[crossed]) / (gap[after[crossed]] - gap[crossed])
        points.append(corner[crossed] + share[:, None] * (corner[after[crossed]] - corner[crossed]))
        owners.append(owner[crossed])
        places.append(crossed + share)
    order = np.argsort(np.concatenate(places))
    return np.concatenate(points)[order], np.concatenate(owners)[order]
