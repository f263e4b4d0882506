"""Volumes, centroids and face planes of polyhedra given as flat arrays."""

import numpy as np

from churchpipe.model.arrays import FloatArray, IntArray

# The corners of a face lie in its mean plane within this part of its size, and the rounding of coordinates to 6 decimals, m.
FLATNESS = 1e-6
LEAST_WARP = 1e-6


def face_normals(points: FloatArray, face_nodes: IntArray, face_ptr: IntArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return area vectors (nf, 3) m2, unit normals (nf, 3) and vertex means (nf, 3) m of planar faces.

    The area vector is half the sum of cross products of successive vertices (Newell), so it is exact for
    planar faces, convex or not. Faces are counter-clockwise seen from outside.
    """
    counts = np.diff(face_ptr)
    face_of = np.repeat(np.arange(len(counts)), counts)
    successor = np.arange(len(face_nodes)) + 1
    successor[face_ptr[1:] - 1] = face_ptr[:-1]
    corner = points[face_nodes]
    mean = np.zeros((len(counts), 3))
    np.add.at(mean, face_of, corner)
    mean /= counts[:, None]
    local = corner - mean[face_of]
    area_vector = np.zeros((len(counts), 3))
    np.add.at(area_vector, face_of, 0.5 * np.cross(local, local[successor]))
    area = np.linalg.norm(area_vector, axis=1, keepdims=True)
    return area_vector, area_vector / np.where(area > 0, area, 1.0), mean


def face_warps(points: FloatArray, face_nodes: IntArray, face_ptr: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return how far corners of each face lie off its plane at most (nf,), m, and how far from their mean at most (nf,), m."""
    _, normal, mean = face_normals(points, face_nodes, face_ptr)
    face_of = np.repeat(np.arange(len(mean)), np.diff(face_ptr))
    reach = points[face_nodes] - mean[face_of]
    height, extent = np.zeros(len(mean)), np.zeros(len(mean))
    np.maximum.at(height, face_of, np.abs(np.einsum("ij,ij->i", reach, normal[face_of])))
    np.maximum.at(extent, face_of, np.linalg.norm(reach, axis=1))
    return height, extent


def solid_properties(
    points: FloatArray, face_nodes: IntArray, face_ptr: IntArray, block_face_ptr: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Return volume (nb,) m3 and centroid (nb, 3) m of polyhedra with planar, outward faces.

    Each face is split into a fan of triangles about its first vertex; each triangle and a point near the solid
    span a signed tetrahedron (divergence theorem), which is exact for any closed polyhedron, convex or not.
    """
    counts = np.diff(face_ptr)
    block_of_face = np.repeat(np.arange(len(block_face_ptr) - 1), np.diff(block_face_ptr))
    face_of = np.repeat(np.arange(len(counts)), counts)
    position = np.arange(len(face_nodes)) - face_ptr[face_of]
    second = np.flatnonzero((position >= 1) & (position < counts[face_of] - 1))
    block = block_of_face[face_of[second]]
    corner = points[face_nodes]
    # One reference point per solid keeps the tetrahedra small: no cancellation far from the origin.
    reference = corner[face_ptr[block_face_ptr[:-1]]]
    p0 = corner[face_ptr[face_of[second]]] - reference[block]
    p1 = corner[second] - reference[block]
    p2 = corner[second + 1] - reference[block]
    tetra = np.einsum("ij,ij->i", p0, np.cross(p1, p2)) / 6.0
    count = len(block_face_ptr) - 1
    volume = np.bincount(block, weights=tetra, minlength=count)
    moment = np.stack([np.bincount(block, weights=tetra * (p0 + p1 + p2)[:, i] / 4.0, minlength=count) for i in range(3)], axis=1)
    safe = np.where(volume != 0, volume, 1.0)[:, None]
    centroid: FloatArray = reference + moment / safe
    return volume.astype(np.float64), centroid
