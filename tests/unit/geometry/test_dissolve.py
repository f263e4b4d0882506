"""Triangulated solids get the faces of the clean ones."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from churchpipe.geometry.dissolve import dissolve
from churchpipe.model.arrays import FloatArray, IntArray
from solids import box, prism

L_PRISM = prism([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)], 3.0)


def flat(*solids: tuple[FloatArray, list[list[int]]]) -> tuple[FloatArray, IntArray, IntArray]:
    offsets = np.cumsum([0, *(len(points) for points, _ in solids)])
    faces = [[node + offset for node in face] for (_, around), offset in zip(solids, offsets, strict=False) for face in around]
    pointer = np.concatenate(([0], np.cumsum([len(face) for face in faces])))
    return np.concatenate([points for points, _ in solids]), np.concatenate(faces), pointer


def fan(faces: list[list[int]]) -> list[list[int]]:
    return [[face[0], face[i], face[i + 1]] for face in faces for i in range(1, len(face) - 1)]


def merged(*solids: tuple[FloatArray, list[list[int]]]) -> list[list[int]]:
    nodes, pointer, _ = dissolve(*flat(*solids))
    return [nodes[a:b].tolist() for a, b in pairwise(pointer)]


def rotated(face: list[int]) -> list[int]:
    first = face.index(min(face))
    return face[first:] + face[:first]


@pytest.mark.parametrize("first", range(6))
@pytest.mark.parametrize("solid", [box((0, 1), (0, 2), (0, 3)), L_PRISM], ids=["box", "L"])
def test_a_triangulated_solid_gets_its_faces_back(solid: tuple[FloatArray, list[list[int]]], first: int) -> None:
    # From most of its corners a fan of the L has triangles that look inwards and lie over others, as careless programs write it.
    points, faces = solid
    turned = [face[first % len(face) :] + face[: first % len(face)] for face in faces]
    assert sorted(map(rotated, merged((points, fan(turned))))) == sorted(map(rotated, faces))


def test_many_solids_at_once_keep_their_order() -> None:
    solids = [(p + 5 * k, fan(f)) for k, (p, f) in enumerate([box((0, 1), (0, 1), (0, 1))] * 3)]
    faces = merged(*solids)
    assert [len(face) for face in faces] == [4] * 18
    assert [min(face) // 8 for face in faces] == [0] * 6 + [1] * 6 + [2] * 6


def test_corners_inside_a_face_and_on_an_edge_are_left_out() -> None:
    points, faces = box((0, 1), (0, 1), (0, 1))
    # The face x = 1 in four quarters, its middles in the neighbours.
    more = np.array([[1, 0.5, 0], [1, 1, 0.5], [1, 0.5, 1], [1, 0, 0.5], [1, 0.5, 0.5]])
    nodes = {"bottom": 8, "right": 9, "top": 10, "left": 11, "middle": 12}
    b, r, t, left, m = nodes.values()
    quarters = [[4, b, m, left], [b, 6, r, m], [m, r, 7, t], [left, m, t, 5]]
    others = [[0, 1, 3, 2], [0, 4, left, 5, 1], [2, 3, 7, r, 6], [0, 2, 6, b, 4], [1, 5, t, 7, 3]]
    found = merged((np.vstack([points, more]), quarters + others))
    assert sorted(map(rotated, found)) == sorted(map(rotated, faces))


def test_a_face_with_a_hole_stays_in_parts() -> None:
    # A plate with a square hole through it: the triangles of its two rings cannot be one polygon each.
    outer, inner = [(0, 0), (3, 0), (3, 3), (0, 3)], [(1, 1), (2, 1), (2, 2), (1, 2)]
    points = np.array([[x, y, z] for z in (0.0, 1.0) for ring in (outer, inner) for x, y in ring])
    faces = []
    for i in range(4):
        j = (i + 1) % 4
        faces += [[8 + i, 8 + j, 12 + j], [8 + i, 12 + j, 12 + i], [i, 4 + i, 4 + j], [i, 4 + j, j]]
        faces += [[i, j, 8 + j, 8 + i], [4 + j, 4 + i, 12 + i, 12 + j]]
    found = merged((points, faces))
    assert sorted(len(face) for face in found) == [3] * 16 + [4] * 8


@pytest.mark.parametrize("thickness", [0.0, 1e-7])
def test_a_film_of_which_all_faces_lie_in_one_plane_keeps_them(thickness: float) -> None:
    points, faces = box((0, 1), (0, thickness), (0, 1))
    found = merged((points, faces), box((3, 4), (3, 4), (3, 4)))
    assert sorted(map(rotated, found[:6])) == sorted(map(rotated, faces))
    assert len(found) == 12


@pytest.mark.parametrize("seed", range(5))
def test_random_hulls_keep_their_facets(seed: int) -> None:
    points = np.random.default_rng(seed).normal(size=(30, 3))
    hull = ConvexHull(points)
    faces = [face if np.linalg.det(points[face] - points.mean(axis=0)) > 0 else face[::-1] for face in hull.simplices.tolist()]
    assert sorted(map(rotated, merged((points, faces)))) == sorted(map(rotated, faces))


def test_a_face_without_area_joins_what_lies_along_its_longest_edge() -> None:
    points, faces = box((0, 1), (0, 1), (0, 1))
    points = np.vstack([points, [0.5, 0, 0]])
    # The corner 8 on the edge 0-4 is known to one face and to a face without area alone.
    found = merged((points, [*faces[:2], [0, 8, 4, 5, 1], *faces[3:], [0, 4, 8]]))
    assert sorted(map(rotated, found)) == sorted(map(rotated, faces))
