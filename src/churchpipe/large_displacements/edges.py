"""The direction in which two stones press at a point where their faces are not parallel."""

import numpy as np

from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage

# Faces turned by less than this, rad, are parallel; edges that cross at a point count alike within this share.
_PARALLEL, _ALIKE = 1e-6, 1e-3


def edge_normals(
    stones: Assemblage, first: IntArray, second: IntArray, normal: FloatArray, point: FloatArray, tolerance: float
) -> FloatArray:
    """Return the unit normals (k, 3) of contact points (k, 3) of faces first and second (k,), from the first to the second.

    A corner or an edge on a face presses along the normal of the face, two edges along their cross product; where it is not
    determined, as for flush edges, the mean of the normals that meet there.

    Parameters
    ----------
    normal (nf, 3): of all faces, outward. tolerance: m, how near to the border of a face a point is on it.
    """
    mean = normal[first] - normal[second]
    mean /= np.linalg.norm(mean, axis=1, keepdims=True)
    tilted = np.flatnonzero(np.linalg.norm(normal[first] + normal[second], axis=1) > _PARALLEL)
    if not len(tilted):
        return mean
    out, n = mean.copy(), mean[tilted]
    one, other = first[tilted], second[tilted]
    (along, at_one), (across, at_other) = (_edges_at(stones, face, point[tilted], n, tolerance) for face in (one, other))
    cross = np.cross(along[:, :, None], across[:, None])
    cross *= np.where(np.einsum("kabc,kc->kab", cross, n) < 0, -1.0, 1.0)[..., None]
    size = np.where(at_one[:, :, None] & at_other[:, None], np.linalg.norm(cross, axis=3), 0.0)
    largest = size.max(axis=(1, 2))
    alike = (size >= (1 - _ALIKE) * largest[:, None, None]) & (size > 0)
    crossing = (cross * alike[..., None]).sum(axis=(1, 2))
    length = np.linalg.norm(crossing, axis=1)
    crossing = np.where(length[:, None] > 0, crossing / np.where(length > 0, length, 1.0)[:, None], n)
    on_one, on_other = at_one.any(axis=1, keepdims=True), at_other.any(axis=1, keepdims=True)
    inside = np.where(on_one, -normal[other], np.where(on_other, normal[one], n))
    out[tilted] = np.where(on_one & on_other, crossing, inside)
    return out


def _edges_at(
    stones: Assemblage, face: IntArray, point: FloatArray, n: FloatArray, tolerance: float
) -> tuple[FloatArray, BoolArray]:
    """Return the directions (k, m, 3) of the edges of faces (k,), and which of them pass a point (k, 3) when seen along n."""
    start, count = stones.face_ptr[face], np.diff(stones.face_ptr)[face]
    place = np.arange(count.max())
    real = place < count[:, None]
    node = start[:, None] + np.minimum(place, count[:, None] - 1)
    after = start[:, None] + np.where(place + 1 < count[:, None], place + 1, 0)
    corner, end = (stones.points[stones.face_nodes[index]] for index in (node, after))
    edge = end - corner
    length = np.linalg.norm(edge, axis=2, keepdims=True)
    direction = edge / np.where(length > 0, length, 1.0)

    def seen(vector: FloatArray) -> FloatArray:
        return vector - np.einsum("kmc,kc->km", vector, n)[..., None] * n[:, None]

    flat, arm = seen(edge), seen(point[:, None] - corner)
    share = np.einsum("kmc,kmc->km", arm, flat) / np.maximum(np.einsum("kmc,kmc->km", flat, flat), 1e-300)
    distance = np.linalg.norm(arm - np.clip(share, 0.0, 1.0)[..., None] * flat, axis=2)
    return direction, real & (distance <= tolerance)
