"""The part of the ground that a movement takes along."""

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.stones.footing import footing
from solids import box, on_ground

WALLS = cp.Assemblage.from_polyhedra(
    [box((-5, 5), (-5, 5), (-1, 0)), box((0, 2), (0, 0.5), (0, 1)), box((2, 2.5), (0, 2), (0, 1)), box((0, 2), (0, 0.5), (1, 2))],
    18e3,
    fixed=[0],
    panel=["ground", "long", "short", "long"],
    block_id=["ground", "a", "b", "c"],
)


def test_the_foot_of_a_wall_is_cut_out_of_the_ground() -> None:
    contacts = cp.find_contacts(WALLS)
    found = footing(WALLS, contacts, "long")
    assert found.cut
    (support,) = found.support
    points = found.stones.points[found.stones.block_point_ptr[support] :]
    assert [points.min(axis=0).tolist(), points.max(axis=0).tolist()] == [[0, 0, -1], [2, 0.5, 0]]
    assert found.stones.block_id.tolist() == ["a", "b", "c", "ground-1", "ground-2", "ground-3", "ground-4", "moving support"]
    # As much ground as before, and the same joints.
    volume = found.stones.volume
    assert volume[found.stones.fixed].sum() == pytest.approx(WALLS.volume[0])
    again = cp.find_contacts(found.stones)
    bears = ~found.stones.fixed[again.blocks].all(axis=1)
    assert again.area[bears].sum() == pytest.approx(contacts.area.sum())
    cp.check_soundness(found.stones, again)


def test_a_rectangle_and_a_stone_of_its_own() -> None:
    contacts = cp.find_contacts(WALLS)
    found = footing(WALLS, contacts, ((0.5, 1.0), (-1.0, -1.0)))
    points = found.stones.points[found.stones.block_point_ptr[found.support[0]] :]
    assert [points.min(axis=0).tolist(), points.max(axis=0).tolist()] == [[-1, -1, -1], [0.5, 1, 0]]
    whole = footing(WALLS, contacts, "ground")
    assert (whole.cut, whole.support.tolist()) == (False, [0])
    # A wall that stands alone on its ground takes it along.
    alone = on_ground(box((0, 1), (0, 1), (0, 1)))
    alone = cp.Assemblage.from_polyhedra([box((-1, 2), (-1, 2), (-1, 0)), box((0, 1), (0, 1), (0, 1))], 1e3, [0], panel=["", "w"])
    assert footing(alone, cp.find_contacts(alone), "w").cut is False


@pytest.mark.parametrize(
    ("place", "said"),
    [
        ("nave", "no wall or stone of this name on the ground; found nave; expected long, short, ground"),
        (((3.0, 3.0), (4.0, 4.0)), "nothing stands on the ground there"),
    ],
)
def test_supports_that_are_not_there(place: object, said: str) -> None:
    with pytest.raises(cp.InputError, match=said):
        footing(WALLS, cp.find_contacts(WALLS), place)  # pyright: ignore


def test_ground_that_is_no_box_is_not_cut() -> None:
    corners, faces = box((-5, 5), (-5, 5), (-1, 0))
    slanted = np.asarray(corners) + np.where(np.asarray(corners)[:, 2:] < 0, [1.0, 0.0, 0.0], [0.0, 0.0, 0.0])
    stones = cp.Assemblage.from_polyhedra([(slanted, faces), box((0, 1), (0, 1), (0, 1)), box((2, 3), (0, 1), (0, 1))], 1e3, [0])
    with pytest.raises(cp.InputError, match="ground that cannot be cut; found B0, which is no upright box"):
        footing(stones, cp.find_contacts(stones), ((-0.5, -0.5), (1.5, 1.5)))
