"""Hand-made stones for tests."""

import math
from collections.abc import Sequence

import numpy as np
import shapely

from churchpipe.geometry.prism import prism_of
from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage, Polyhedron

Solid = tuple[FloatArray, list[list[int]]]

BOX_FACES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


def box(x: tuple[float, float], y: tuple[float, float], z: tuple[float, float]) -> Solid:
    """A box between the given coordinates, m."""
    return np.array([[a, b, c] for a in x for b in y for c in z], dtype=float), BOX_FACES


def prism(outline: Sequence[tuple[float, float]], width: float) -> Solid:
    """A prism: a polygon in the x-z plane, any orientation, from y = 0 to y = width, m."""
    n = len(outline)
    points = np.array([[x, y, z] for y in (0.0, width) for x, z in outline])
    faces = [list(range(n)), list(range(2 * n - 1, n - 1, -1))]
    faces += [[i, i + n, (i + 1) % n + n, (i + 1) % n] for i in range(n)]
    return points, faces


def standing(region: shapely.Polygon, thickness: float, turn: float = 0.0) -> Polyhedron:
    """A wall over an outline in its plane, its back on y = 0, then turned about the upright axis (rad)."""
    flat, faces = prism_of(region)
    points = np.stack([flat[:, 0], thickness * (1.0 - flat[:, 2]), flat[:, 1]], axis=1)
    c, s = math.cos(turn), math.sin(turn)
    return points @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]).T, [list(face) for face in faces]


def on_ground(*free: Polyhedron, unit_weight: float = 18e3, reach: float = 50.0) -> Assemblage:
    """Free stones on a fixed plate with its top at z = 0."""
    plate = box((-reach, reach), (-reach, reach), (-1.0, 0.0))
    return Assemblage.from_polyhedra([plate, *free], unit_weight, fixed=[0])


def moved(
    stones: Assemblage, rotation: FloatArray, shift: FloatArray, scale: float = 1.0, order: Sequence[int] | None = None
) -> Assemblage:
    """The same stones rotated, shifted and scaled, in the same order or another."""
    polyhedra = []
    chosen = np.arange(stones.count) if order is None else np.asarray(order)
    for i in chosen:
        start, stop = stones.block_point_ptr[i : i + 2]
        faces = [
            (stones.face_nodes[stones.face_ptr[f] : stones.face_ptr[f + 1]] - start).tolist()
            for f in range(*stones.block_face_ptr[i : i + 2])
        ]
        polyhedra.append((scale * stones.points[start:stop] @ rotation.T + shift, faces))
    return Assemblage.from_polyhedra(polyhedra, stones.unit_weight[chosen], np.flatnonzero(stones.fixed[chosen]).tolist())
