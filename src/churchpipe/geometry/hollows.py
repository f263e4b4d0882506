"""Which closed parts of a body bound voids in other parts."""

from collections.abc import Sequence

import numpy as np

from churchpipe.geometry.locate import solid_angles
from churchpipe.geometry.mending import Face, signed_volumes
from churchpipe.geometry.planar import overlapping
from churchpipe.model.arrays import FloatArray, IntArray

# Winding number of a surface about a point in it: one inside, a half on the surface, zero outside.
INSIDE = 0.75


def with_voids(points: FloatArray, faces: Sequence[Face], parts: Sequence[list[int]]) -> list[list[int]]:
    """Return the numbers of the faces of each stone, in order of their first: its part, and the parts that bound voids in it.

    A part bounds a void if it lies wholly within another one and its faces look the other way. What lies within a void is a
    stone.

    Parameters
    ----------
    points: (n, 3). faces: polygons, by indices of points. parts: numbers of the faces of each closed part.
    """
    if len(parts) < 2:
        return [*parts]
    nodes = [np.unique(np.concatenate([faces[k] for k in part])) for part in parts]
    low, high = (np.array([edge(points[own], axis=0) for own in nodes]) for edge in (np.min, np.max))
    nested = _nested_boxes(low, high).tolist()
    if not nested:
        return [*parts]
    volume = signed_volumes([(points, [faces[k] for k in part]) for part in parts])
    around: list[list[int]] = [[] for _ in parts]
    for inner, outer in nested:
        if _lies_in(points, [faces[k] for k in parts[inner]], [faces[k] for k in parts[outer]]):
            around[inner].append(outer)
    void_of: dict[int, int] = {}
    for inner in np.argsort(-np.abs(volume), kind="stable").tolist():
        nearest = min(around[inner], key=lambda outer: abs(volume[outer]), default=None)
        if nearest is not None and nearest not in void_of and volume[nearest] * volume[inner] < 0:
            void_of[inner] = nearest
    stones = {number: [*part] for number, part in enumerate(parts) if number not in void_of}
    for inner, outer in void_of.items():
        stones[outer] += parts[inner]
    return sorted(map(sorted, stones.values()))


def _nested_boxes(low: FloatArray, high: FloatArray) -> IntArray:
    """Return the pairs (k, 2) of boxes, of which the first lies within the second and touches no side of it."""
    # The tree of boxes has two dimensions: those in which the parts spread most.
    across = np.argsort(np.ptp(np.concatenate([low, high]), axis=0))[1:]
    pairs = overlapping(np.concatenate([low[:, across], high[:, across]], axis=1))
    pairs = np.concatenate([pairs, pairs[:, ::-1]])
    inner, outer = pairs.T
    return pairs[((low[inner] > low[outer]) & (high[inner] < high[outer])).all(axis=1)]


def _lies_in(points: FloatArray, inner: Sequence[Face], outer: Sequence[Face]) -> bool:
    """Return whether the middles of all inner faces lie within the outer faces, whichever way these look."""
    fans = points[[(face[0], face[k], face[k + 1]) for face in outer for k in range(1, len(face) - 1)]]
    middles = [points[list(face)].mean(axis=0) for face in inner]
    return all(abs(float(solid_angles(fans - middle).sum())) > INSIDE * 4.0 * np.pi for middle in middles)
