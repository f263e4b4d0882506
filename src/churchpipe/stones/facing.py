"""Facets that face each other, and what they share on the plane midway between them."""

import math
from dataclasses import dataclass

import numpy as np

from churchpipe.geometry.planar import Polygons, areas, centroids, coordinates_of, intersections, meeting, outlined, pieces_of
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray, ragged_indices
from churchpipe.model.contacts import TOUCHING
from churchpipe.stones.facets import Facets
from churchpipe.stones.interfaces import frames

# An overlap smaller than this share of the smaller facet is none.
LEAST_SHARE = 1e-6
# For facets of curved surfaces the angle of the search is larger, by at most this, rad.
MOST_TWIST = math.radians(10.0)


@dataclass(frozen=True, slots=True)
class Overlaps:
    """What pairs of facets share, seen along the normal of the plane midway between them (their mean plane).

    side (n, 2): the facets. frame (n, 3, 3): rows n, t1, t2, with n from the first facet to the second. origin (n, 3) m: on the
    mean plane. polygon (n,): the shared region in t1, t2. area (n,) m2. height (n, 3): a, b, c of the surface midway between
    both facets, a + b t1 + c t2 along n. middle (n,) m: distance between the facets at the polygon's centroid, negative where
    they interpenetrate. gap (n, 2) m: least and greatest distance over the polygon. slack (n,) m: how far the corners of both
    facets are from their planes. lean (n,) rad: angle between the facets. bend (n,) rad: the part of that angle that the twist
    of the facets explains.
    """

    side: IntArray
    frame: FloatArray
    origin: FloatArray
    polygon: Polygons
    area: FloatArray
    height: FloatArray
    middle: FloatArray
    gap: FloatArray
    slack: FloatArray
    lean: FloatArray
    bend: FloatArray

    def __len__(self) -> int:
        return len(self.side)

    def __getitem__(self, rows: IntArray | BoolArray) -> "Overlaps":
        """Return some of the rows."""
        return Overlaps(*(getattr(self, name)[rows] for name in self.__slots__))

    @property
    def opening(self) -> FloatArray:
        """How far the facets are apart at their nearest (n,) m, less what their warp explains."""
        return np.maximum(self.gap[:, 0] - self.slack, 0.0)

    @property
    def penetration(self) -> FloatArray:
        """How deep the facets interpenetrate at their shallowest place (n,) m, less what their warp explains."""
        return np.maximum(-self.gap[:, 1] - self.slack, 0.0)

    @property
    def angle(self) -> FloatArray:
        """Angle between the facets (n,) rad, less what their twist explains."""
        return np.maximum(self.lean - self.bend, 0.0)


def facing(facets: Facets, chosen: BoolArray, reach: float, angle: float) -> Overlaps:
    """Return what the chosen facets (n,) share with those that they face within the reach, m, and the angle, rad."""
    reach += TOUCHING
    pairs = _pairs(facets, chosen, reach, angle)
    frame, origin = _mean_planes(facets, pairs)
    near = _near(facets, pairs, frame, origin, reach)
    pairs, frame, origin = pairs[near], frame[near], origin[near]
    first, second = (outlines(facets, pairs[:, side], frame, origin) for side in (0, 1))
    part, pair = pieces_of(intersections(first, second))
    enough = areas(part) > LEAST_SHARE * facets.area[pairs].min(axis=1)[pair]
    part, pair = part[enough], pair[enough]
    return measured(facets, pairs[pair], frame[pair], origin[pair], part)


def measured(facets: Facets, side: IntArray, frame: FloatArray, origin: FloatArray, polygon: Polygons) -> Overlaps:
    """Return the measures of polygons (n,) on the mean planes of pairs of facets (n, 2)."""
    heights: list[FloatArray] = []
    for facet in side.T:
        normal = facets.normal[facet]
        along = np.einsum("iac,ic->ia", frame, normal)
        level = np.einsum("ic,ic->i", facets.centre[facet] - origin, normal)
        heights.append(np.stack([level, -along[:, 1], -along[:, 2]], axis=1) / along[:, :1])
    apart = heights[1] - heights[0]
    corner, owner = coordinates_of(polygon)
    distance = apart[owner, 0] + np.einsum("ij,ij->i", apart[owner, 1:], corner)
    start = np.searchsorted(owner, np.arange(len(polygon)))
    empty = not len(polygon)
    gap = np.zeros((0, 2)) if empty else np.stack([edge.reduceat(distance, start) for edge in (np.minimum, np.maximum)], axis=1)
    facing_normal = facets.normal[side[:, 0]] + facets.normal[side[:, 1]]
    return Overlaps(
        side=side,
        frame=frame,
        origin=origin,
        polygon=polygon,
        area=areas(polygon),
        height=0.5 * (heights[0] + heights[1]),
        middle=apart[:, 0] + np.einsum("ij,ij->i", apart[:, 1:], centroids(polygon)),
        gap=gap,
        slack=facets.warp[side].sum(axis=1),
        lean=2.0 * np.arcsin(np.clip(0.5 * np.linalg.norm(facing_normal, axis=1), 0.0, 1.0)),
        bend=0.5 * facets.twist[side].sum(axis=1),
    )


def outlines(facets: Facets, chosen: IntArray, frame: FloatArray, origin: FloatArray) -> Polygons:
    """Return the outlines of facets as polygons (n,) in t1, t2 of frames (n, 3, 3) at origins (n, 3), holes left open."""
    rings = np.diff(facets.ring_ptr)[chosen]
    ring = ragged_indices(facets.ring_ptr[:-1][chosen], rings)
    counts = np.diff(facets.corner_ptr)[ring]
    row = np.repeat(np.repeat(np.arange(len(chosen)), rings), counts)
    corner = facets.corner[ragged_indices(facets.corner_ptr[:-1][ring], counts)] - origin[row]
    return outlined(np.einsum("ic,iac->ia", corner, frame[row][:, 1:]), counts, rings)


def _pairs(facets: Facets, chosen: BoolArray, reach: float, angle: float) -> IntArray:
    """Return pairs (n, 2) of facets of different stones that face each other and whose boxes, enlarged, overlap."""
    rows = np.flatnonzero(chosen & (facets.area > 0))
    if not len(rows):
        return np.zeros((0, 2), dtype=np.int64)
    first_corner = facets.corner_ptr[facets.ring_ptr[:-1]]
    low, high = (edge.reduceat(facets.corner, first_corner, axis=0)[rows] for edge in (np.minimum, np.maximum))
    low, high = low - 0.5 * reach, high + 0.5 * reach
    normal = facets.normal[rows]
    twist = np.minimum(facets.twist[rows], MOST_TWIST)
    steepest = np.abs(normal).max(axis=1)
    extent = np.ptp(facets.corner, axis=0)
    found: list[IntArray] = []
    for axis in range(3):
        others = [k for k in range(3) if k != axis]
        along, across = sorted(others, key=lambda k: -extent[k])
        likely = np.abs(normal[:, axis]) >= steepest - 2.0 * np.sin(angle + twist)
        up, down = (np.flatnonzero(likely & (sign * normal[:, axis] > 0)) for sign in (1.0, -1.0))
        boxes = np.stack([low[:, axis], low[:, along], high[:, axis], high[:, along]], axis=1)
        query, hit = meeting(boxes[up], boxes[down]).T
        i, j = up[query], down[hit]
        keep = (low[i, across] <= high[j, across]) & (low[j, across] <= high[i, across])
        i, j = i[keep], j[keep]
        keep = facets.stone[rows[i]] != facets.stone[rows[j]]
        keep &= np.einsum("ij,ij->i", normal[i], normal[j]) <= -np.cos(angle + 0.5 * (twist[i] + twist[j]))
        found.append(np.sort(np.stack([rows[i[keep]], rows[j[keep]]], axis=1), axis=1))
    pairs = np.concatenate(found)
    code = np.unique(pairs[:, 0] * len(facets) + pairs[:, 1])
    return np.stack([code // len(facets), code % len(facets)], axis=1)


def _mean_planes(facets: Facets, pairs: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return frames (n, 3, 3) and origins (n, 3) of the planes between pairs of facets, the larger one counting more."""
    first, second = pairs.T
    n = facets.area[first, None] * facets.normal[first] - facets.area[second, None] * facets.normal[second]
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    smaller = np.where(facets.area[first] <= facets.area[second], first, second)
    return frames(n), facets.centre[smaller]


def _near(facets: Facets, pairs: IntArray, frame: FloatArray, origin: FloatArray, reach: float) -> BoolArray:
    """Return which pairs (n,) overlap with their boxes on the mean plane and are near enough there."""
    low, high, level, slope = [], [], [], []
    for facet in pairs.T:
        ring = facets.ring_ptr[:-1][facet]
        counts = np.diff(facets.corner_ptr)[ring]
        row = np.repeat(np.arange(len(pairs)), counts)
        corner = facets.corner[ragged_indices(facets.corner_ptr[:-1][ring], counts)] - origin[row]
        flat = np.einsum("ic,iac->ia", corner, frame[row][:, 1:])
        start = np.concatenate(([0], np.cumsum(counts)[:-1])) if len(counts) else np.zeros(0, dtype=np.int64)
        low.append(np.minimum.reduceat(flat, start, axis=0) if len(start) else flat)
        high.append(np.maximum.reduceat(flat, start, axis=0) if len(start) else flat)
        along = np.einsum("iac,ic->ia", frame, facets.normal[facet])
        level.append(np.einsum("ic,ic->i", facets.centre[facet] - origin, facets.normal[facet]) / along[:, 0])
        slope.append(-along[:, 1:] / along[:, :1])
    box_low, box_high = np.maximum(*low), np.minimum(*high)
    middle, half = 0.5 * (box_low + box_high), 0.5 * np.linalg.norm(box_high - box_low, axis=1)
    tilt = slope[1] - slope[0]
    apart = np.abs(level[1] - level[0] + np.einsum("ij,ij->i", tilt, middle))
    limit = reach + facets.warp[pairs].sum(axis=1) + half * np.linalg.norm(tilt, axis=1)
    return (box_high > box_low).all(axis=1) & (apart <= limit)
