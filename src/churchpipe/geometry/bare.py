"""What other stones leave bare of the faces of stones."""

from collections.abc import Iterator

import numpy as np

from churchpipe.geometry.planar import Polygons, less, outlined, triangles_of
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.polyhedra import face_normals

# A face lies on another if it looks against it to this cosine, and all its corners are within this distance of its plane, m.
_AGAINST = 0.99
_APART = 1e-4


def bare_triangles(stones: Assemblage, faces: IntArray) -> Iterator[tuple[int, FloatArray]]:
    """Yield each face (n,) of stones with the triangles (k, 3, 3) m that make up what no face of another stone lies on."""
    _, normal, mean = face_normals(stones.points, stones.face_nodes, stones.face_ptr)
    owner = np.repeat(np.arange(stones.count), np.diff(stones.block_face_ptr))
    corner = stones.points[stones.face_nodes]
    low, high = (edge.reduceat(corner, stones.face_ptr[:-1], axis=0) for edge in (np.minimum, np.maximum))
    for face in faces.tolist():
        near = ((low <= high[face] + _APART) & (high >= low[face] - _APART)).all(axis=1)
        covers = np.flatnonzero(near)
        covers = covers[(owner[covers] != owner[face]) & (normal[covers] @ normal[face] < -_AGAINST)]
        frame = _frame(normal[face])
        own, *others = (
            (corner[stones.face_ptr[k] : stones.face_ptr[k + 1]] - mean[face]) @ frame.T for k in (face, *covers.tolist())
        )
        lying = [_flat(other) for other in others if np.abs(other[:, 2]).max() <= _APART]
        flat = triangles_of(less(_flat(own)[0], [region for (region,) in lying]))
        yield face, mean[face] + np.concatenate([flat, np.zeros((*flat.shape[:2], 1))], axis=2) @ frame


def _frame(normal: FloatArray) -> FloatArray:
    """Return two unit vectors in a plane and its normal (3, 3)."""
    along = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    along /= np.linalg.norm(along)
    return np.array([along, np.cross(normal, along), normal], dtype=np.float64)


def _flat(corners: FloatArray) -> Polygons:
    """Return the polygon of a face (k, 3) as the one entry of a list; outlines that touch themselves are repaired."""
    ring = np.concatenate([corners[:, :2], corners[:1, :2]])
    return outlined(ring, np.array([len(ring)]), np.array([1]))
