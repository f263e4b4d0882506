"""Which named parts move in a mechanism, and how much of each."""

import numpy as np
import pytest

from churchpipe.compare import stone_parts
from churchpipe.mechanism import parts
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.loads import LoadCase
from churchpipe.model.quantities import as_written
from churchpipe.rigid_blocks.limit import limit_analysis
from churchpipe.stones.contacts import find_contacts
from solids import box

X = np.array([1.0, 0, 0])


def test_parts_by_hand() -> None:
    # facade: 10 kN stand, 30 kN move by 1; tower: 20 kN move by 2; apse stands; the ground weighs nothing.
    panel = np.array(["facade", "facade", "tower", "apse", "ground"])
    weight = np.array([10e3, 30e3, 20e3, 5e3, 0.0])
    velocity = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 0, 0], [9, 0, 0]], dtype=float)
    found = parts(panel, weight, velocity, velocity[:, 0] > 0, X)
    assert [part.name for part in found] == ["tower", "facade", "apse"]
    tower, facade, apse = found
    assert (tower.weight, tower.moving, tower.displacement) == (20e3, 1.0, 1.0)
    assert tower.motion == pytest.approx(40 / 70)
    assert (facade.weight, facade.moving) == (40e3, 0.75)
    assert facade.displacement == pytest.approx((30 * 1 / 40) / 2)
    assert facade.motion == pytest.approx(30 / 70)
    assert (apse.moving, apse.displacement, apse.motion) == (0.0, 0.0, 0.0)
    assert as_written(facade) == {
        "name": "facade",
        "weight_kN": 40.0,
        "moving": 0.75,
        "displacement": facade.displacement,
        "motion": facade.motion,
    }


def test_stones_of_no_wall_are_called_so() -> None:
    found = parts(np.array(["", "tower"]), np.ones(2), np.array([[1.0, 0, 0], [2.0, 0, 0]]), np.ones(2, dtype=bool), X)
    assert [part.name for part in found] == ["tower", "unnamed"]


def test_motion_against_the_load_counts_with_its_sign() -> None:
    velocity = np.array([[1.0, 0, 0], [-2.0, 0, 0]])
    found = parts(np.array(["a", "b"]), np.ones(2), velocity, np.ones(2, dtype=bool), X)
    assert [(part.name, part.displacement) for part in found] == [("b", -1.0), ("a", 0.5)]


def pair(panels: tuple[str, str]) -> Assemblage:
    """A slender and a stout cube-wide column on one ground plate, apart from each other."""
    slender = [box((0, 1), (0, 1), (i, i + 1)) for i in range(4)]
    stout = [box((5, 9), (0, 1), (i, i + 1)) for i in range(4)]
    names = ["ground", *[panels[0]] * 4, *[panels[1]] * 4]
    return Assemblage.from_polyhedra([box((-9, 99), (-9, 9), (-1, 0)), *slender, *stout], 20e3, fixed=[0], panel=names)


def test_the_slender_column_falls_and_the_stout_one_stands() -> None:
    stones, load = pair(("slender", "stout")), LoadCase((1, 0, 0))
    state = limit_analysis(stones, find_contacts(stones), load, 0.7)
    assert state.load_factor == pytest.approx(0.25, rel=1e-6)
    slender, stout = stone_parts(stones, state, load)["parts"]
    assert (slender.name, slender.weight, slender.moving) == ("slender", pytest.approx(80e3), 1.0)
    assert (slender.displacement, slender.motion) == (1.0, 1.0)
    assert (stout.name, stout.moving, stout.displacement, stout.motion) == ("stout", 0.0, 0.0, 0.0)


def test_one_part_needs_no_table() -> None:
    stones, load = pair(("wall", "wall")), LoadCase((1, 0, 0))
    assert stone_parts(stones, limit_analysis(stones, find_contacts(stones), load, 0.7), load) == {}
