"""Bodies as files have them: each fault is mended, counted, and changes the volume as it should."""

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.errors import InputError
from churchpipe.geometry import mending
from churchpipe.geometry.mending import mend
from churchpipe.model.arrays import FloatArray
from solids import BOX_FACES, box, prism

CUBE = box((0, 1), (0, 1), (0, 1))[0]
Faces = list[list[int]]


def triangulated(faces: Faces) -> Faces:
    return [[face[0], face[i], face[i + 1]] for face in faces for i in range(1, len(face) - 1)]


def faults() -> dict[str, tuple[FloatArray, Faces, dict[str, int]]]:
    flipped = [face[::-1] if number in (1, 4) else face for number, face in enumerate(BOX_FACES)]
    soup = (np.concatenate([CUBE[face] for face in BOX_FACES]), [list(range(4 * k, 4 * k + 4)) for k in range(6)])
    near = soup[0] + 2e-7 * np.random.default_rng(1).normal(size=soup[0].shape)
    # A corner of a neighbour on the middle of the edge from 0 to 4.
    middle = (np.vstack([CUBE, [0.5, 0, 0]]), [*BOX_FACES[:2], [0, 8, 4, 5, 1], *BOX_FACES[3:]])
    shells = (np.concatenate([CUBE, CUBE]), [*BOX_FACES, *([i + 8 for i in face] for face in BOX_FACES)])
    return {
        "sound": (CUBE, BOX_FACES, {}),
        "inside out": (CUBE, [face[::-1] for face in BOX_FACES], {mending.OUTWARD: 1}),
        "mixed": (CUBE, flipped, {mending.TURNED: 2}),
        "soup": (*soup, {mending.WELDED: 16}),
        "every face twice": (CUBE, BOX_FACES * 2, {mending.DROPPED: 6}),
        "both sides": (CUBE, [*BOX_FACES, *(face[::-1] for face in BOX_FACES)], {mending.DROPPED: 6}),
        "two shells in one place": (*shells, {mending.WELDED: 8, mending.DROPPED: 6}),
        "a corner twice in a row": (*prism([(0, 0), (0, 0), (1, 0), (1, 1), (0, 1)], 1.0), {mending.WELDED: 2}),
        "nearly meeting": (near, soup[1], {mending.CLOSE: 16}),
        "corner on an edge": (*middle, {mending.JOINED: 1}),
        "hole": (CUBE, BOX_FACES[:-1], {mending.FILLED: 1}),
        "hole and mixed": (CUBE, flipped[:-1], {mending.TURNED: 2, mending.FILLED: 1}),
        "two holes": (CUBE, BOX_FACES[2:], {mending.FILLED: 2}),
    }


@pytest.mark.parametrize("name", faults())
def test_each_fault_is_mended_and_counted(name: str) -> None:
    points, faces, expected = faults()[name]
    mended = mend(points, faces, repair=True)
    assert mended.fault is None
    assert mended.changes == expected
    assert mended.volume == pytest.approx(1.0, rel=1e-5)
    stones = cp.Assemblage.from_polyhedra([(mended.points, mended.faces)], 1.0)
    assert stones.volume[0] == pytest.approx(mended.volume, rel=1e-12)


@pytest.mark.parametrize("name", ["sound", "inside out", "mixed", "soup", "a corner twice in a row"])
def test_what_leaves_the_shape_alone_is_done_without_asking(name: str) -> None:
    points, faces, expected = faults()[name]
    mended = mend(points, faces, repair=False)
    assert (mended.fault, mended.changes) == (None, expected)


@pytest.mark.parametrize("name", ["every face twice", "two shells in one place", "nearly meeting", "corner on an edge", "hole"])
def test_what_changes_a_body_is_done_only_when_asked_for(name: str) -> None:
    points, faces, _ = faults()[name]
    mended = mend(points, faces, repair=False)
    assert mended.fault is not None
    assert mended.mendable


def test_a_body_that_stays_open_is_no_solid_and_nobody_promises_to_mend_it() -> None:
    # Three faces around a corner leave a hole that is not flat.
    mended = mend(CUBE, [BOX_FACES[0], BOX_FACES[2], BOX_FACES[4]], repair=False)
    assert mended.fault is not None
    assert not mended.mendable
    with pytest.raises(InputError, match=r"polyhedra\[1\]: its faces do not close a solid; found an open edge at"):
        cp.repair_polyhedra([(CUBE, BOX_FACES), (CUBE, [BOX_FACES[0], BOX_FACES[2], BOX_FACES[4]])])


def test_a_wall_inside_a_closed_body_is_dropped_whole() -> None:
    points, faces = prism([(0, 0), (1, 0), (2, 0), (2, 1), (1, 1), (0, 1)], 1.0)
    inside = [1, 4, 10, 7]
    mended = mend(points, [*faces, inside, inside[::-1]], repair=True)
    assert mended.fault is None
    assert mended.changes == {mending.INSIDE: 2}
    assert mended.volume == pytest.approx(2.0)


def test_warped_faces_are_split_alike_by_both_stones_that_share_one() -> None:
    low, high = CUBE.copy(), CUBE + np.array([0, 0, 1])
    for points, corner in ((low, 7), (high, 6)):
        points[corner] += [0, 0, 0.05]
    (first, second), changes = cp.repair_polyhedra([(low, BOX_FACES), (high, [face[::-1] for face in BOX_FACES[::-1]])])
    assert [change.what for change in changes].count(mending.SPLIT) == 2

    def shared(polyhedron: tuple[FloatArray, Faces]) -> set[frozenset[tuple[float, ...]]]:
        corners = [frozenset(map(tuple, polyhedron[0][list(face)].round(9).tolist())) for face in polyhedron[1]]
        return {face for face in corners if all(abs(z - 1) < 0.1 for _, _, z in face)}

    assert len(shared(first)) == 2
    assert shared(first) == shared(second)


def test_volumes_before_and_after_are_told() -> None:
    _, changes = cp.repair_polyhedra([(CUBE, BOX_FACES * 2)])
    assert [str(change) for change in changes] == ["polyhedra[0]: faces given more than once were dropped (6); volume 2 -> 1 m3"]


def test_a_wall_of_bodies_given_twice_has_the_contacts_of_the_clean_one() -> None:
    stones = [box((x, x + 1), (0, 1), (z, z + 1)) for x in range(3) for z in range(3)]
    doubled = [(np.concatenate([p, p]), [*f, *([i + 8 for i in face] for face in f)]) for p, f in stones]
    with pytest.raises(InputError, match=r"repair_polyhedra"):
        cp.Assemblage.from_polyhedra(doubled, 1.0)
    mended, _ = cp.repair_polyhedra(doubled)
    found = cp.find_contacts(cp.Assemblage.from_polyhedra(mended, 1.0))
    assert len(found.blocks) == len(cp.find_contacts(cp.Assemblage.from_polyhedra(stones, 1.0)).blocks) == 12
