"""Warped faces split into triangles. Two stones that share such a face get the same triangles."""

from collections.abc import Iterable, Sequence

import numpy as np

from churchpipe.model.arrays import FloatArray
from churchpipe.model.polyhedra import FLATNESS, LEAST_WARP


def split_warped(points: FloatArray, faces: Iterable[Sequence[int]]) -> tuple[list[tuple[int, ...]], int, float]:
    """Return faces, the warped ones split into triangles; how many those were, and how far the worst was warped, m."""
    out: list[tuple[int, ...]] = []
    count, worst = 0, 0.0
    for face in faces:
        height, size = warp(points[list(face)]) if len(face) > 3 else (0.0, 0.0)
        if height <= FLATNESS * size + LEAST_WARP:
            out.append(tuple(face))
        else:
            out += triangles(points, face)
            count, worst = count + 1, max(worst, height)
    return out, count, worst


def warp(corners: FloatArray) -> tuple[float, float]:
    """Return how far corners (n, 3) are from their mean plane at most, and the largest distance from their mean, m."""
    reach = corners - corners.mean(axis=0)
    normal = np.cross(reach, np.roll(reach, -1, axis=0)).sum(axis=0)
    length = float(np.linalg.norm(normal))
    size = float(np.linalg.norm(reach, axis=1).max())
    return (float(np.abs(reach @ normal).max()) / length if length else size), size


def triangles(points: FloatArray, face: Sequence[int]) -> list[tuple[int, ...]]:
    """Split a face, convex or not, where its shortest diagonals are.

    Which diagonals these are depends on the corners alone, neither on the first of them nor on the side they are seen from.
    """
    ring = list(face)
    normal = _normal(points[ring])
    out: list[tuple[int, ...]] = []
    while len(ring) > 3:
        ears = [k for k in range(len(ring)) if _is_ear(points, ring, k, normal)] or list(range(len(ring)))
        cut = min(ears, key=lambda k: _diagonal(points, ring[k - 1], ring[(k + 1) % len(ring)]))
        out.append((ring[cut - 1], ring[cut], ring[(cut + 1) % len(ring)]))
        del ring[cut]
    return [*out, (ring[0], ring[1], ring[2])]


def _diagonal(points: FloatArray, start: int, stop: int) -> tuple[float, ...]:
    """Return the key by which diagonals are ordered: the length, rounded so that it is equal from both sides, then the ends."""
    ends = sorted((points[start].tolist(), points[stop].tolist()))
    return (float(f"{np.linalg.norm(points[start] - points[stop]):.9g}"), *ends[0], *ends[1])


def _normal(corners: FloatArray) -> FloatArray:
    reach = corners - corners.mean(axis=0)
    return np.cross(reach, np.roll(reach, -1, axis=0)).sum(axis=0)


def _is_ear(points: FloatArray, ring: list[int], k: int, normal: FloatArray) -> bool:
    """Return whether a corner is convex and no other corner lies in the triangle that would be cut off there."""
    a, b, c = (points[ring[i]] for i in (k - 1, k, (k + 1) % len(ring)))
    if np.cross(b - a, c - b) @ normal <= 0:
        return False
    others = points[[i for i in ring if i not in (ring[k - 1], ring[k], ring[(k + 1) % len(ring)])]]
    sides = [np.cross(stop - start, others - start) @ normal for start, stop in ((a, b), (b, c), (c, a))]
    return not (np.min(sides, axis=0) > 0).any()
