"""The part of the ground that a movement takes along."""

import dataclasses

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.stones.footing import Rectangle, footing
from solids import box, moved, on_ground

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


@pytest.mark.parametrize("place", [((0.5, -0.5), (1.0, 1.0)), ((0.5, 0.1), (1.0, 0.3))])
def test_a_rectangle_below_the_middle_of_a_stone(place: Rectangle) -> None:
    # None of its corners lies there; it stands on the ground on both sides.
    found = footing(WALLS, cp.find_contacts(WALLS), place)
    assert found.stones.block_id[found.support].tolist() == ["moving support"]
    state = cp.settlement_analysis(found.stones, cp.find_contacts(found.stones), found.support)
    assert (state.status, state.reaction) == ("optimal", pytest.approx(0.0, abs=1e-3))


@pytest.mark.parametrize(
    ("place", "said"),
    [
        ("nave", "no wall or stone of this name on the ground; found nave; expected long, short, ground"),
        (((3.0, 3.0), (4.0, 4.0)), "nothing stands on the ground there"),
        # Along the side of a wall, which it does not support.
        (((-1.0, -1.0), (0.0, 3.0)), "nothing stands on the ground there"),
        (((0.0, 0.0), (0.0, 0.3)), "a rectangle without width; found from .0.0, 0.0. to .0.0, 0.3. m"),
    ],
)
def test_supports_that_are_not_there(place: object, said: str) -> None:
    with pytest.raises(cp.InputError, match=said):
        footing(WALLS, cp.find_contacts(WALLS), place)  # pyright: ignore


def test_ground_that_is_no_box_is_not_cut() -> None:
    corners, faces = box((-5, 5), (-5, 5), (-1, 0))
    slanted = np.asarray(corners) + np.where(np.asarray(corners)[:, 2:] < 0, [1.0, 0.0, 0.0], [0.0, 0.0, 0.0])
    stones = cp.Assemblage.from_polyhedra([(slanted, faces), box((0, 1), (0, 1), (0, 1)), box((2, 3), (0, 1), (0, 1))], 1e3, [0])
    with pytest.raises(cp.InputError, match="ground that cannot be cut; found B0, which is no upright prism of a convex plan"):
        footing(stones, cp.find_contacts(stones), ((-0.5, -0.5), (1.5, 1.5)))


@pytest.mark.parametrize(("angle", "shift"), [(17.0, (0.0, 0.0, 0.0)), (-62.0, (5e5, 4e6, 300.0)), (135.0, (30.0, -7.0, 2.0))])
def test_turned_ground_is_cut_along_its_own_sides(angle: float, shift: tuple[float, float, float]) -> None:
    # A building in the axes of a map: its ground was refused, which only the run found out.
    turn = np.radians(angle)
    rotation = np.array([[np.cos(turn), -np.sin(turn), 0.0], [np.sin(turn), np.cos(turn), 0.0], [0.0, 0.0, 1.0]])
    turned = dataclasses.replace(moved(WALLS, rotation, np.array(shift)), panel=WALLS.panel, block_id=WALLS.block_id)
    reactions: list[float] = []
    for stones, direction in ((WALLS, np.array([0.3, 0.2, -1.0])), (turned, rotation @ [0.3, 0.2, -1.0])):
        found = footing(stones, cp.find_contacts(stones), "long")
        again = cp.find_contacts(found.stones)
        cp.check_soundness(found.stones, again)
        assert len(found.stones.points) - len(stones.points) == 4 * 8
        assert found.stones.volume[found.support] == pytest.approx(2.0 * 0.5 * 1.0, rel=1e-6)
        assert found.stones.volume[found.stones.fixed].sum() == pytest.approx(100.0, rel=1e-6)
        state = cp.settlement_analysis(found.stones, again, found.support, direction, friction=0.5)
        reactions.append(state.reaction)
    assert reactions[0] > 0
    assert reactions[1] == pytest.approx(reactions[0], rel=1e-5)


def test_a_rectangle_cuts_ground_of_any_convex_plan() -> None:
    plan = [(-3.0, -3.0), (4.0, -2.0), (5.0, 4.0), (-2.0, 3.0)]
    corners = np.array([(x, y, z) for z in (-1.0, 0.0) for x, y in plan])
    faces = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
    stones = cp.Assemblage.from_polyhedra([(corners, faces), box((0, 1), (0, 1), (0, 1)), box((2, 3), (0, 1), (0, 1))], 1e3, [0])
    found = footing(stones, cp.find_contacts(stones), ((-9.0, -0.5), (1.5, 9.0)))
    again = cp.find_contacts(found.stones)
    cp.check_soundness(found.stones, again)
    assert found.stones.volume[found.stones.fixed].sum() == pytest.approx(stones.volume[0], rel=1e-9)
    (support,) = found.support
    touching = again.blocks[(again.blocks == support).any(axis=1) & ~found.stones.fixed[again.blocks].all(axis=1)]
    assert len(touching) == 1
    assert found.stones.centroid[np.setdiff1d(touching, support), 0] == pytest.approx(0.5)
