"""Assemblage.from_polyhedra: exact volumes and centroids, and refusals that say what is wrong."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from churchpipe.errors import InputError
from churchpipe.model.assemblage import Assemblage
from solids import BOX_FACES, box, prism

lengths = st.floats(0.01, 100)


@given(lengths, lengths, lengths, st.floats(-1e3, 1e3))
def test_box_volume_and_centroid(a: float, b: float, c: float, shift: float) -> None:
    stones = Assemblage.from_polyhedra([box((shift, shift + a), (0, b), (-c, 0))], 1.0)
    assert stones.volume[0] == pytest.approx(a * b * c, rel=1e-9)
    assert stones.centroid[0] == pytest.approx([shift + a / 2, b / 2, -c / 2], rel=1e-9, abs=1e-9)


def test_non_convex_solid_by_hand() -> None:
    # An L of 2 x 2 less 1 x 1, width 3: volume 9, centroid 5/6 in both directions.
    stones = Assemblage.from_polyhedra([prism([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)], 3.0)], 1.0)
    assert stones.volume[0] == pytest.approx(9.0, rel=1e-12)
    assert stones.centroid[0] == pytest.approx([5 / 6, 1.5, 5 / 6], rel=1e-12)


def test_inward_faces_are_turned() -> None:
    points, faces = box((0, 1), (0, 1), (0, 1))
    inside_out = Assemblage.from_polyhedra([(points, [face[::-1] for face in faces])], 1.0)
    assert inside_out.volume[0] == pytest.approx(1.0)


def test_ground_weighs_nothing() -> None:
    stones = Assemblage.from_polyhedra([box((0, 1), (0, 1), (0, 1)), box((0, 1), (0, 1), (1, 3))], 18e3, fixed=[0])
    assert stones.weight.tolist() == pytest.approx([0.0, 36e3])


def test_arrays_are_read_only_and_the_callers_own_stay_writable() -> None:
    points, faces = box((0, 1), (0, 1), (0, 1))
    stones = Assemblage.from_polyhedra([(points, faces)], 1.0)
    with pytest.raises(ValueError, match="read-only"):
        stones.points[0, 0] = 5.0
    points[0, 0] = 5.0


CUBE = box((0, 1), (0, 1), (0, 1))[0]
WARPED = CUBE.copy()
WARPED[7, 0] = 1.2


@pytest.mark.parametrize(
    ("polyhedra", "message"),
    [
        ([], "no stones"),
        ([(CUBE, BOX_FACES[:-1])], "B0: its faces do not close a solid; found an open edge at"),
        ([(CUBE, [*BOX_FACES[:-1], BOX_FACES[-1][::-1]])], "B0: its faces run in mixed directions"),
        ([(CUBE, BOX_FACES * 2)], "B0: a face lies on another"),
        (
            [(np.concatenate([CUBE, CUBE]), [*BOX_FACES, *([i + 8 for i in face] for face in BOX_FACES)])],
            "B0: a face lies on another",
        ),
        ([(CUBE, [*BOX_FACES, [0, 1, 2], [0, 2, 4], [0, 4, 1], [1, 4, 2]])], "B0: more than two faces meet at an edge"),
        ([(CUBE, [*BOX_FACES[:-1], [1, 5, 9, 3]])], "bad face"),
        ([(CUBE * [1, 1, 0], BOX_FACES)], "no volume"),
        ([(WARPED, BOX_FACES)], "is not planar"),
        ([(np.where(CUBE == 1, np.nan, CUBE), BOX_FACES)], "not a finite number"),
        ([(CUBE[:, :2], BOX_FACES)], "wrong shape"),
    ],
)
def test_bad_solids_are_refused(polyhedra: list, message: str) -> None:
    with pytest.raises(InputError, match=message):
        Assemblage.from_polyhedra(polyhedra, 1.0)


@pytest.mark.parametrize(
    "kind", [tuple, list, np.array, lambda face: list(np.array(face)), lambda face: np.array(face, np.uint8)]
)
def test_faces_may_be_any_sequences_of_whole_numbers(kind: Callable[[list[int]], Any]) -> None:
    stones = Assemblage.from_polyhedra([(CUBE, list(map(kind, BOX_FACES)))], 1.0)
    assert stones.face_nodes.tolist() == [node for face in BOX_FACES for node in face]


@pytest.mark.parametrize("face", [(-1, 2, 3), (1, 2, 8), (1, 2), (), (1, 2, 3.0), ((1, 2), (3, 4)), [1, 2, 10**30]])
@pytest.mark.parametrize("kind", [lambda face: face, lambda face: list(face)])
def test_bad_faces_are_refused(face: Any, kind: Callable[[Any], Any]) -> None:
    with pytest.raises(InputError, match="bad face"):
        Assemblage.from_polyhedra([(CUBE, [*BOX_FACES, kind(face)])], 1.0)


def test_bad_arguments_are_refused() -> None:
    cube = (CUBE, BOX_FACES)
    with pytest.raises(InputError, match="index out of range"):
        Assemblage.from_polyhedra([cube], 1.0, fixed=[3])
    with pytest.raises(InputError, match="weighs nothing"):
        Assemblage.from_polyhedra([cube], 0.0)
    with pytest.raises(InputError, match="not unique"):
        Assemblage.from_polyhedra([cube, (CUBE + 3, BOX_FACES)], 1.0, block_id=["a", "a"])


def test_corners_given_once_a_face_are_welded() -> None:
    # As facets of an STL have them: every face with vertices of its own.
    apart = np.concatenate([CUBE[face] for face in BOX_FACES])
    stones = Assemblage.from_polyhedra([(apart, [list(range(4 * k, 4 * k + 4)) for k in range(6)])], 1.0)
    assert len(stones.points) == 8
    assert stones.volume[0] == pytest.approx(1.0)


def test_a_solid_that_touches_itself_is_left_as_it_is() -> None:
    # Two cubes in one body, one corner in common and given twice: closed as it stands.
    body = (np.concatenate([CUBE, CUBE + 1]), [*BOX_FACES, *([i + 8 for i in face] for face in BOX_FACES)])
    assert len(Assemblage.from_polyhedra([body], 1.0).points) == 16


def test_fixed_takes_indices_or_a_flag_for_each_stone() -> None:
    cubes = [(CUBE, BOX_FACES), (CUBE + 3, BOX_FACES)]
    assert Assemblage.from_polyhedra(cubes, 1.0, fixed=[False, True]).fixed.tolist() == [False, True]
    assert Assemblage.from_polyhedra(cubes, 1.0, fixed=[1]).fixed.tolist() == [False, True]
    with pytest.raises(InputError, match="wrong shape"):
        Assemblage.from_polyhedra(cubes, 1.0, fixed=[True])
    with pytest.raises(InputError, match="not whole numbers"):
        Assemblage.from_polyhedra(cubes, 1.0, fixed=[0.5])
