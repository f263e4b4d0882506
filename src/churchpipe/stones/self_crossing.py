"""Stones whose own surface crosses itself: closed by their edges, but no solid."""

import numpy as np

from churchpipe.geometry.manifolds import manifold
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.polyhedra import face_normals

# An edge crosses a face when it reaches through it by more than this share of the stone's size.
THROUGH = 1e-5
# Edges looked at together, so that a stone of many faces takes little memory.
CHUNK = 500


def self_crossing_stones(stones: Assemblage) -> list[tuple[int, FloatArray]]:
    """Return the stones whose surface crosses itself, each with a place (3,) m where it does.

    A convex stone cannot. Of the others each edge is held against each face.
    """
    _, normal, mean = face_normals(stones.points, stones.face_nodes, stones.face_ptr)
    found: list[tuple[int, FloatArray]] = []
    for block in range(stones.count):
        own = slice(*stones.block_face_ptr[block : block + 2])
        points = stones.points[slice(*stones.block_point_ptr[block : block + 2])]
        slack = THROUGH * float(np.linalg.norm(np.ptp(points, axis=0)))
        height = points @ normal[own].T - np.einsum("fc,fc->f", normal[own], mean[own])
        if (height <= slack).all():
            continue
        mesh = manifold(*stones.solid(block)).to_mesh64()
        corners, triangles = np.asarray(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts, dtype=np.int64)
        place = _crossing(corners, triangles, slack)
        if place is not None:
            found.append((block, place))
    return found


def _crossing(points: FloatArray, triangles: IntArray, slack: float) -> FloatArray | None:
    """Return a point (3,) in which an edge of triangles (n, 3) goes through another triangle, None where none does."""
    pair = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    pair = pair[pair[:, 0] < pair[:, 1]]
    a, b, c = (points[triangles[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    size = np.linalg.norm(normal, axis=1)
    keep = size > 0
    a, b, c, normal = a[keep], b[keep], c[keep], normal[keep] / size[keep, None]
    level = np.einsum("fc,fc->f", normal, a)
    for start in range(0, len(pair), CHUNK):
        p, q = (points[pair[start : start + CHUNK, side]] for side in (0, 1))
        before, after = p @ normal.T - level, q @ normal.T - level
        edge, face = np.nonzero((np.minimum(before, after) < -slack) & (np.maximum(before, after) > slack))
        share = before[edge, face] / (before[edge, face] - after[edge, face])
        at = p[edge] + share[:, None] * (q[edge] - p[edge])
        inside = np.ones(len(at), dtype=np.bool_)
        for one, two in ((a, b), (b, c), (c, a)):
            side = two[face] - one[face]
            away = np.einsum("ic,ic->i", np.cross(side, at - one[face]), normal[face])
            inside &= away > slack * np.linalg.norm(side, axis=1)
        if inside.any():
            return at[int(np.argmax(inside))]
    return None
