"""Faces that face each other at a small distance without being a joint."""

import math

import numpy as np

from churchpipe.geometry.planar import Region, area, centroids, common, hull, united, vertices
from churchpipe.model.arrays import BoolArray, FloatArray
from churchpipe.model.contacts import NearMisses
from churchpipe.stones.contact_tolerances import HAIRLINE, Limits
from churchpipe.stones.facets import Facets
from churchpipe.stones.facing import Overlaps, facing
from churchpipe.stones.interfaces import Interfaces, frames

# Near misses are searched up to ten times the contact gap or the first share of the median stone's thickness, whichever is more,
# but no farther than the second share, or than a wider contact gap reaches: no tolerance joins stones that are farther apart than
# half their thickness.
NEAR = 0.25
FAR = 0.5
TIMES = 10.0
# Greatest angle between the two faces of a near miss, rad.
LEAN = math.radians(20.0)
# A facet is examined if more than this share of its area is free. The overlap of two must be more than this share of the smaller
# one, and more than half of it must be free of joints.
FREE = 0.05
SHARED = 0.05


def reach_of(limits: Limits) -> float:
    """Return up to which distance two faces are a near miss, m."""
    widest = TIMES * max(limits.tolerances.contact_gap, HAIRLINE * limits.typical)
    return max(
        min(max(NEAR * limits.typical, widest), FAR * limits.typical),
        min(limits.tolerances.contact_gap, 0.5 * float(limits.thickness.max())),
    )


def near_misses(facets: Facets, joints: Interfaces, limits: Limits) -> NearMisses:
    """Return the pairs of facets whose free parts nearly meet. joints: all joints, by their facets."""
    covered = np.bincount(joints.side.ravel(), np.repeat(joints.area, 2), minlength=len(facets))
    loose = covered < (1.0 - FREE) * facets.area
    found = facing(facets, loose, reach_of(limits), LEAN)
    pairs = np.sort(joints.side, axis=1) @ [len(facets), 1]
    apart = np.maximum(found.gap[:, 0] - found.slack, -found.gap[:, 1] - found.slack)
    keep = (apart <= reach_of(limits)) & (found.area > SHARED * facets.area[found.side].min(axis=1))
    found = found[keep & ~np.isin(np.sort(found.side, axis=1) @ [len(facets), 1], pairs)]
    found = found[_mostly_free(facets, joints, found)]
    place = np.einsum("ia,iac->ic", centroids(found.polygon), found.frame[:, 1:]) + found.origin
    level = found.height[:, 0] + np.einsum("ij,ij->i", found.height[:, 1:], centroids(found.polygon))
    return NearMisses(
        stones=facets.stone[found.side],
        gap=found.middle,
        angle=found.lean,
        area=found.area,
        place=place + level[:, None] * found.frame[:, 0],
        normal=found.frame[:, 0],
    )


def _mostly_free(facets: Facets, joints: Interfaces, found: Overlaps) -> BoolArray:
    """Return which overlaps (n,) are free of joints, and of nearer overlaps, over more than half of them on both facets."""
    held: dict[int, list[Region]] = {}
    planes = frames(facets.normal)
    for facet in np.unique(found.side).tolist():
        rows = np.flatnonzero((joints.side == facet).any(axis=1))
        held[facet] = [_on(facets, planes, facet, joints.point[slice(*joints.point_ptr[row : row + 2])]) for row in rows]
    keep = np.zeros(len(found), dtype=np.bool_)
    polygons: list[Region] = found.polygon.tolist()
    for row in np.argsort(np.abs(found.middle), kind="stable").tolist():
        points = found.origin[row] + vertices(polygons[row]) @ found.frame[row, 1:]
        own = {facet: _on(facets, planes, facet, points) for facet in found.side[row].tolist()}
        hidden = [area(common(shape, united(held[facet]))) / area(shape) for facet, shape in own.items()]
        keep[row] = max(hidden) < 0.5
        if keep[row]:
            for facet, shape in own.items():
                held[facet].append(shape)
    return keep


def _on(facets: Facets, planes: FloatArray, facet: int, points: FloatArray) -> Region:
    """Return points (n, 3) as the convex polygon that they make on a facet's plane."""
    flat = (points - facets.centre[facet]) @ planes[facet, 1:].T
    return hull(flat)
