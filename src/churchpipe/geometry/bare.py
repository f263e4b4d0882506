"""What other stones leave bare of the faces of stones."""

from collections.abc import Iterator

import numpy as np

from churchpipe.geometry.manifolds import manifold
from churchpipe.geometry.planar import Polygons, Region, less, outlined, polygon, triangles_of, united
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.polyhedra import face_normals

# A face lies on another if it looks against it to this cosine, and all its corners are near its plane: to the first distance, m,
# or to a share of its size, as where joints are drawn with little care, but no further than the last.
_AGAINST = 0.99
_APART, _SHARE, _FURTHEST = 1e-4, 5e-3, 5e-3


def bare_triangles(stones: Assemblage, faces: IntArray) -> Iterator[tuple[int, FloatArray]]:
    """Yield each face (n,) of stones with the triangles (k, 3, 3) m that make up what no face of another stone lies on."""
    vector, normal, mean = face_normals(stones.points, stones.face_nodes, stones.face_ptr)
    owner = np.repeat(np.arange(stones.count), np.diff(stones.block_face_ptr))
    corner = stones.points[stones.face_nodes]
    low, high = (edge.reduceat(corner, stones.face_ptr[:-1], axis=0) for edge in (np.minimum, np.maximum))
    apart = np.clip(_SHARE * np.linalg.norm(vector, axis=1) ** 0.5, _APART, _FURTHEST)
    for face in faces.tolist():
        near = ((low <= high[face] + apart[face]) & (high >= low[face] - apart[face])).all(axis=1)
        covers = np.flatnonzero(near)
        covers = covers[(owner[covers] != owner[face]) & (normal[covers] @ normal[face] < -_AGAINST)]
        frame = _frame(normal[face])
        own, *others = (
            (corner[stones.face_ptr[k] : stones.face_ptr[k + 1]] - mean[face]) @ frame.T for k in (face, *covers.tolist())
        )
        lying = [_flat(other) for other in others if np.abs(other[:, 2]).max() <= apart[face]]
        flat = triangles_of(less(_flat(own)[0], [region for (region,) in lying]))
        yield face, mean[face] + np.concatenate([flat, np.zeros((*flat.shape[:2], 1))], axis=2) @ frame


def open_triangles(stones: Assemblage, faces: IntArray, level: float) -> Iterator[tuple[int, FloatArray]]:
    """Yield each face (n,) of stones that looks up with the triangles (k, 3, 3) m that make up what no stone stands over.

    A stone counts that is above the face and below a level z, m, at any distance: joints need not be closed.
    """
    _, normal, mean = face_normals(stones.points, stones.face_nodes, stones.face_ptr)
    low, high = (edge.reduceat(stones.points, stones.block_point_ptr[:-1], axis=0) for edge in (np.minimum, np.maximum))
    for face, triangles in bare_triangles(stones, faces):
        if not len(triangles):
            continue
        n, place = normal[face], triangles.reshape(-1, 3)
        over = ((low[:, :2] < place[:, :2].max(axis=0) - _APART) & (high[:, :2] > place[:, :2].min(axis=0) + _APART)).all(axis=1)
        over &= (low[:, 2] < level) & (high[:, 2] > place[:, 2].min() + _APART)
        shadows = [part for stone in np.flatnonzero(over).tolist() for part in _shadow(stones, stone, n, n @ mean[face], level)]
        if shadows:
            flat = triangles_of(less(united([polygon(triangle[:, :2]) for triangle in triangles]), shadows))
            triangles = np.dstack([flat, mean[face, 2] - (flat - mean[face, :2]) @ n[:2] / n[2]])
        yield face, triangles


def _shadow(stones: Assemblage, stone: int, normal: FloatArray, offset: float, level: float) -> list[Region]:
    """Return in plan what of a stone lies in front of a plane, normal (3,) and offset m, and below a level z, m."""
    points, faces = stones.solid(stone)
    if (points @ normal).max() <= offset + _APART:
        return []
    x, y, z = normal.tolist()
    body = manifold(points, faces)
    body = body.trim_by_plane((x, y, z), offset + _APART).trim_by_plane((0.0, 0.0, -1.0), -level)
    mesh = body.to_mesh64()
    plan = np.asarray(mesh.vert_properties)[np.asarray(mesh.tri_verts, dtype=np.int64), :2]
    return [polygon(triangle) for triangle in plan[_turn(plan) > 0]]


def _turn(triangles: FloatArray) -> FloatArray:
    """Return twice the area (n,) of plane triangles (n, 3, 2), above zero where their corners are counter-clockwise."""
    one, other = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    return one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]


def _frame(normal: FloatArray) -> FloatArray:
    """Return two unit vectors in a plane and its normal (3, 3)."""
    along = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    along /= np.linalg.norm(along)
    return np.array([along, np.cross(normal, along), normal], dtype=np.float64)


def _flat(corners: FloatArray) -> Polygons:
    """Return the polygon of a face (k, 3) as the one entry of a list; outlines that touch themselves are repaired."""
    ring = np.concatenate([corners[:, :2], corners[:1, :2]])
    return outlined(ring, np.array([len(ring)]), np.array([1]))
