"""Lines on stones that are no boxes: which of them bears, and where."""

import numpy as np
import pytest

import churchpipe as cp

MASONRY = 20e3


def stones_of(*outlines: list[tuple[float, float]]) -> cp.Assemblage:
    """Return stones 0.4 m thick of these elevations (x, z), on a fixed one below z = 0."""
    upright = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    ground = [(-1.0, -0.5), (3.0, -0.5), (3.0, 0.0), (-1.0, 0.0)]
    solids = []
    for outline in (ground, *outlines):
        front = np.array(outline) @ upright
        count = len(front)
        sides = [[k, (k + 1) % count, count + (k + 1) % count, count + k] for k in range(count)]
        faces = [list(range(count))[::-1], list(range(count, 2 * count)), *sides]
        solids.append((np.concatenate([front, front + np.array([0.0, 0.4, 0.0])]), faces))
    return cp.Assemblage.from_polyhedra(solids, unit_weight=MASONRY, fixed=[0], panel="wall")


def test_a_stone_over_an_arch_bears_what_lies_on_it() -> None:
    """Its toe lies below the haunch of the arch, so that one of its faces looks up there; the haunch below it bears nothing."""
    toothed = [(0.0, 0.0), (0.4, 0.0), (0.3, 0.3), (1.0, 0.3), (1.0, 0.6), (0.0, 0.6)]
    haunch = [(0.4, 0.0), (1.0, 0.0), (1.0, 0.3), (0.3, 0.3)]
    stones = stones_of(toothed, haunch)

    placed = cp.place_loads(stones, [cp.LineLoad(between=[(0.1, 0.2, 0.6), (0.9, 0.2, 0.6)], dead=5e3)])

    assert set(placed.stone.tolist()) == {1}
    assert placed.dead[:, 2].sum() == pytest.approx(-4e3)
    np.testing.assert_allclose(placed.point[:, 2], 0.6)


def test_a_line_over_a_ridge_lies_on_both_slopes() -> None:
    """The stone of a ridge has the mass of a roof on its slopes, and not on the line between their feet."""
    stones = stones_of([(0.0, 0.0), (1.0, 0.0), (1.0, 0.4), (0.5, 0.8), (0.0, 0.4)])

    placed = cp.place_loads(stones, [cp.LineLoad(between=[(0.2, 0.2, 0.8), (1.0, 0.2, 0.8)], dead=5e3)])

    surface = 0.8 - 0.8 * np.abs(placed.point[:, 0] - 0.5)
    np.testing.assert_allclose(placed.point[:, 2], surface, atol=2e-5)
    middle = (0.3 * (0.56 + 0.8) / 2 + 0.5 * (0.4 + 0.8) / 2) / 0.8
    assert placed.mass @ placed.point[:, 2] / placed.mass.sum() == pytest.approx(middle, abs=2e-5)


def test_a_line_at_a_height_bears_on_the_stones_that_it_passes() -> None:
    """Each takes as much of it as lies in the stone, and not over the length of its plan; one around an arch takes two parts."""
    around = [(0.0, 0.0), (0.4, 0.0), (0.3, 0.3), (0.9, 0.3), (0.8, 0.0), (1.2, 0.0), (1.2, 0.6), (0.0, 0.6)]
    wedge = [(0.4, 0.0), (0.8, 0.0), (0.9, 0.3), (0.3, 0.3)]
    stones = stones_of(around, wedge)

    placed = cp.place_loads(stones, [cp.LineLoad("wall", height=0.15, dead=5e3)])

    borne = {stone: -float(placed.dead[placed.stone == stone, 2].sum()) for stone in (1, 2)}
    assert borne == pytest.approx({1: 0.7 * 5e3, 2: 0.5 * 5e3}, abs=1.0)
    from_joint = np.abs(placed.point[:, 0] - 0.6) - 0.25
    clear = np.abs(from_joint) > 1e-3
    assert np.all((from_joint < 0)[clear] == (placed.stone == 2)[clear])


def test_a_line_along_a_joint_at_a_height_bears_on_both_sides() -> None:
    box = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.5), (0.0, 0.5)]
    (first, faces), (ground, _) = stones_of(box).solid(1), stones_of(box).solid(0)
    leaves = [(ground, faces), (first, faces), (first + np.array([0.0, 0.4, 0.0]), faces)]
    stones = cp.Assemblage.from_polyhedra(leaves, unit_weight=MASONRY, fixed=[0], panel="wall")

    for load in (
        cp.LineLoad("wall", height=0.3, dead=5e3),
        cp.PointLoad("wall", along=0.5, height=0.3, dead=5e3),
        cp.PointLoad("wall", along=0.5, height=0.5, dead=5e3),
    ):
        placed = cp.place_loads(stones, [load])
        assert [-placed.dead[placed.stone == stone, 2].sum() for stone in (1, 2)] == pytest.approx([2.5e3, 2.5e3], rel=1e-6)
