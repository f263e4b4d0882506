"""A plane region with holes as a prism whose faces have none."""

from itertools import pairwise

import numpy as np

from churchpipe.geometry.planar import Polygon, area, boxes, clip, extent, inner_points, polygon, rings, vertices
from churchpipe.model.arrays import FloatArray

Faces = tuple[tuple[int, ...], ...]


def prism_of(region: Polygon) -> tuple[FloatArray, Faces]:
    """Return a prism over a region: points (2 n, 3), u and v and 0 at the bottom, 1 at the top; and outward faces.

    Bottom and top of a region with holes are cut along an upright line through each hole, so that every face has one outline. A
    side that such a line ends on stays one face.
    """
    parts = _without_holes(region)
    corner = np.concatenate(parts)
    flat, number = np.unique(corner, axis=0, return_inverse=True)
    count = len(flat)
    rings_of = np.split(number.ravel(), np.cumsum([len(part) for part in parts])[:-1])
    around = [tuple(ring.tolist()) for ring in rings_of]
    edges = [edge for ring in around for edge in zip(ring, (*ring[1:], ring[0]), strict=True)]
    # Edges between two parts of the bottom run both ways; what is left is the border.
    inner = {(stop, start) for start, stop in edges}
    border = [edge for edge in edges if edge not in inner]
    corners = {tuple(corner) for corner in vertices(region).tolist()}
    after = {start: stop for start, stop in border if tuple(flat[start].tolist()) not in corners}
    sides: list[tuple[int, ...]] = []
    for edge in (edge for edge in border if edge[0] not in after):
        low = list(edge)
        while low[-1] in after:
            low.append(after[low[-1]])
        sides.append((*low, *(node + count for node in low[::-1])))
    points = np.column_stack([np.tile(flat, (2, 1)), np.repeat([0.0, 1.0], count)])
    lids = tuple(ring[::-1] for ring in around) + tuple(tuple(node + count for node in ring) for ring in around)
    return points, (*lids, *sides)


def _without_holes(region: Polygon) -> list[FloatArray]:
    """Return the parts, as closed outlines (n, 2) counter-clockwise, of a region cut through its holes."""
    outer, *inner = rings(region)
    if not inner:
        return [_turned_left(outer[:-1])]
    low, bottom, high, top = extent(region).tolist()
    cuts = sorted({float(inner_points(np.array([polygon(hole)], dtype=np.object_))[0, 0]) for hole in inner})
    marks = [low - 1.0, *cuts, high + 1.0]
    strips = boxes(np.array([[a, bottom - 1.0, b, top + 1.0] for a, b in pairwise(marks)]))
    parts, _ = clip(strips, region)
    return [_turned_left(rings(part)[0][:-1]) for part in parts if area(part) > 0]


def _turned_left(ring: FloatArray) -> FloatArray:
    x, y = (ring - ring[0]).T
    return ring if (x[:-1] * y[1:] - x[1:] * y[:-1]).sum() > 0 else ring[::-1]
