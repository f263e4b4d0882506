"""Polyhedra with polygonal faces to manifold3d and back. Boolean operations on solids are done through this module alone."""

from collections.abc import Sequence

import manifold3d
import numpy as np

from churchpipe.geometry.clusters import components
from churchpipe.model.arrays import FloatArray, IntArray


def manifold(points: FloatArray, faces: Sequence[Sequence[int] | IntArray], first: int = 0) -> manifold3d.Manifold:
    """Return a polyhedron as a manifold, its faces triangulated and numbered from `first`.

    points (n, 3) m; faces: corners of each, counter-clockwise from outside.
    """
    triangles: list[IntArray] = []
    for nodes in map(np.asarray, faces):
        corner = points[nodes]
        area = np.cross(corner, np.roll(corner, -1, axis=0)).sum(axis=0)
        drop = int(np.argmax(np.abs(area)))
        plane = np.delete(corner, drop, axis=1)
        # Deleting the middle axis mirrors the plane; a negative component does so too.
        turned = (area[drop] > 0) == (drop == 1)
        order = np.arange(len(nodes))[::-1] if turned else np.arange(len(nodes))
        found = order[np.asarray(manifold3d.triangulate([plane[order]]))]
        triangles.append(nodes[found[:, ::-1] if turned else found])
    face = np.repeat(first + np.arange(len(faces)), [len(found) for found in triangles])
    mesh = manifold3d.Mesh64(
        vert_properties=points.astype(np.float64),
        tri_verts=np.concatenate(triangles).astype(np.uint64),
        face_id=face.astype(np.uint64),
    )
    return manifold3d.Manifold(mesh)


def polyhedron(solid: manifold3d.Manifold) -> tuple[FloatArray, list[IntArray]]:
    """Return the points (n, 3) m and the faces of a manifold, triangles of one numbered face as polygons again."""
    mesh = solid.to_mesh64()
    triangles = np.asarray(mesh.tri_verts, dtype=np.int64)
    same = np.arange(len(mesh.vert_properties))
    same[np.asarray(mesh.merge_from_vert, dtype=np.int64)] = np.asarray(mesh.merge_to_vert, dtype=np.int64)
    triangles = same[triangles]
    number = np.asarray(mesh.face_id, dtype=np.int64)
    faces: list[IntArray] = []
    for face in np.unique(number):
        faces += _polygons(triangles[number == face])
    used, inverse = np.unique(np.concatenate(faces), return_inverse=True)
    split = np.cumsum([len(face) for face in faces])[:-1]
    return np.asarray(mesh.vert_properties)[used, :3], np.split(inverse.ravel(), split)


def trimmed(
    points: FloatArray, faces: Sequence[tuple[int, ...]], cuts: Sequence[tuple[FloatArray, float]]
) -> tuple[FloatArray, list[tuple[int, ...]]]:
    """Return the part of a polyhedron below planes, each given by its unit normal (3,) and its level along it, m."""
    rings = [np.array(face) for face in faces]
    for normal, level in cuts:
        x, y, z = (-normal).tolist()
        # The cut has a small number of its own.
        points, rings = polyhedron(manifold(points, rings, first=100_000).trim_by_plane((x, y, z), -level))
    return points, [tuple(ring.tolist()) for ring in rings]


def _polygons(triangles: IntArray) -> list[IntArray]:
    """Return the outlines of coplanar triangles (n, 3); the triangles of a part with a hole, or one that touches itself."""
    nodes, local = np.unique(triangles, return_inverse=True)
    local = local.reshape(-1, 3)
    part = components(len(nodes), np.concatenate([local[:, [0, 1]], local[:, [1, 2]]]))[local[:, 0]]
    return [ring for number in np.unique(part) for ring in _rings(triangles[part == number])]


def _rings(triangles: IntArray) -> list[IntArray]:
    edges = [(int(start), int(stop)) for pair in ([0, 1], [1, 2], [2, 0]) for start, stop in triangles[:, pair]]
    inner = {(stop, start) for start, stop in edges}
    after = dict(edge for edge in edges if edge not in inner)
    ring = [next(iter(after))]
    while (following := after[ring[-1]]) != ring[0] and len(ring) < len(after):
        ring.append(following)
    # A disc has two corners more than triangles, and all of them on its border, when none lies inside.
    simple = len(ring) == len(after) == len(np.unique(triangles)) == len(triangles) + 2
    return [np.array(ring)] if simple else list(triangles)
