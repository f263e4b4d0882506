"""Triangles and edges of the stones' faces."""

import manifold3d
import numpy as np

from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.polyhedra import face_normals


def triangles(stones: Assemblage, drawn: BoolArray) -> IntArray:
    """Return triangles (nt, 3), indices into `stones.points`, of the faces of the drawn stones (nb,) bool.

    Convex faces become fans; faces with a reflex corner are cut by ear clipping.
    """
    sizes, starts = np.diff(stones.face_ptr), stones.face_ptr[:-1]
    shown = np.repeat(drawn, np.diff(stones.block_face_ptr))
    _, normal, _ = face_normals(stones.points, stones.face_nodes, stones.face_ptr)
    convex = ~_has_reflex_corner(stones, normal)
    fan = np.flatnonzero(shown & convex)
    face = np.repeat(fan, sizes[fan] - 2)
    step = np.arange(len(face)) - np.repeat(np.cumsum(sizes[fan] - 2) - (sizes[fan] - 2), sizes[fan] - 2)
    corner = np.stack([starts[face], starts[face] + step + 1, starts[face] + step + 2], axis=1)
    parts = [stones.face_nodes[corner]]
    notched = np.flatnonzero(shown & ~convex)
    for f, plane in zip(notched, _planes(normal[notched]), strict=True):
        nodes = stones.face_nodes[stones.face_ptr[f] : stones.face_ptr[f + 1]]
        flat = (stones.points[nodes] - stones.points[nodes[0]]) @ plane.T
        parts.append(nodes[np.asarray(manifold3d.triangulate([flat]), dtype=np.int64)])
    return np.concatenate(parts)


def edges(stones: Assemblage, drawn: BoolArray) -> IntArray:
    """Return the edges (ne, 2) of the drawn stones, each once."""
    corner = np.repeat(drawn, np.diff(stones.block_face_ptr))[_face_of_corner(stones)]
    pair = np.stack([stones.face_nodes, stones.face_nodes[_successor(stones)]], axis=1)[corner]
    # A closed solid runs along each edge once in each direction.
    return pair[pair[:, 0] < pair[:, 1]]


def _face_of_corner(stones: Assemblage) -> IntArray:
    return np.repeat(np.arange(len(stones.face_ptr) - 1), np.diff(stones.face_ptr))


def _successor(stones: Assemblage) -> IntArray:
    successor = np.arange(len(stones.face_nodes)) + 1
    successor[stones.face_ptr[1:] - 1] = stones.face_ptr[:-1]
    return successor


def _has_reflex_corner(stones: Assemblage, normal: FloatArray) -> BoolArray:
    face, successor = _face_of_corner(stones), _successor(stones)
    side = stones.points[stones.face_nodes[successor]] - stones.points[stones.face_nodes]
    turn = np.einsum("ij,ij->i", np.cross(side, side[successor]), normal[face])
    scale = np.linalg.norm(side, axis=1) * np.linalg.norm(side[successor], axis=1)
    return np.logical_or.reduceat(turn < -1e-9 * scale, stones.face_ptr[:-1])


def _planes(normal: FloatArray) -> FloatArray:
    """Return two unit vectors (n, 2, 3) along planes with these normals (n, 3), which they turn about to the left."""
    first: FloatArray = np.cross(normal, np.eye(3)[np.abs(normal).argmin(axis=1)])
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return np.stack([first, np.cross(normal, first)], axis=1)
