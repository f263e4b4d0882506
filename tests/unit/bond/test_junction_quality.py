"""Junctions that are not toothed on every other course: butt, bonded on every n-th course, cracked over a height."""

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.bond.junction import wall_junctions
from churchpipe.bond.walls import wall_region
from churchpipe.errors import InputError
from churchpipe.io.building_json import read_building, write_building
from churchpipe.model.building import Building, Junction
from churchpipe.shell_mesh.shell import derive_shell
from crossing_walls import along_x, along_y, owned
from sound import laid

ZONE = (0.0, 0.5)


def second_owns(junction: Junction | None, parity: int = 1, height: float = 3.0) -> list[int]:
    """Courses on which the wall along y owns its corner with the wall along x."""
    panels = along_x(height=height, parity=1 - parity), along_y(height=height, parity=parity)
    found = wall_junctions(panels, [wall_region(panel) for panel in panels], [junction] if junction else [])
    return [round(level / 0.25) for level in owned(found[0], ZONE)]


@pytest.mark.parametrize("parity", [0, 1])
def test_the_second_wall_bonds_on_its_courses(parity: int) -> None:
    assert second_owns(Junction(("x", "y"), every=2), parity) == second_owns(None, parity) == list(range(parity, 12, 2))
    assert second_owns(Junction(("x", "y"), every=4), parity) == list(range(parity, 12, 4))
    assert second_owns(Junction(("x", "y")), parity) == []
    assert second_owns(Junction(("y", "x")), parity) == list(range(12))
    # Named the other way round, the wall along x bonds on every fourth course, of its own parity.
    assert set(range(12)) - set(second_owns(Junction(("y", "x"), every=4), parity)) == set(range(1 - parity, 12, 4))


def test_a_crack_takes_the_bonding_stones_away() -> None:
    # Courses of 0.25 m: the crack from 1 m to 2 m touches courses 4 to 7.
    assert second_owns(Junction(("x", "y"), every=2, cracked=(1.0, 2.0))) == [1, 3, 9, 11]
    assert second_owns(Junction(("x", "y"), every=2, cracked=(1.1, 1.3))) == [1, 3, 7, 9, 11]


@pytest.mark.parametrize("junction", [Junction(("x", "y")), Junction(("x", "y"), every=4), Junction(("x", "y"), 2, (0.5, 1.5))])
def test_the_stones_fill_the_walls_whatever_bonds_them(junction: Junction, tmp_path) -> None:
    building = Building("b", (along_x(height=2.0), along_y(height=2.0)), (cp.UnitWeight("default", 18e3),), junctions=(junction,))
    stones, _ = laid(building)
    assert stones.volume[~stones.fixed].sum() == pytest.approx(2.0 * (5.0 * 0.5 + 3.5 * 0.5), rel=1e-9)
    write_building(tmp_path / "b.json", building)
    assert read_building(tmp_path / "b.json").junctions == (junction,)
    if junction.every == 4:
        with pytest.raises(
            InputError, match=r"junction of x and y: the shell has toothed, butt and cracked .* found every 4 courses"
        ):
            derive_shell(building, 0.5)
        return
    shell = derive_shell(building, 0.5)
    assert shell.weight.sum() == pytest.approx(stones.weight.sum(), rel=1e-9)
    # The joint stands for the half of the first wall that the second one ends in: all of its height, or the courses cracked.
    joint = shell.bonds[shell.cell] == "butt"
    assert set(shell.panel[joint].tolist()) == {"y"}
    assert shell.area[joint].sum() == pytest.approx(0.25 * (2.0 if junction.every == 0 else 1.0), rel=1e-9)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((("x", "x"),), "junction of x and x: walls: not two walls"),
        ((("x", "y"), 3), "junction of x and y: every: an odd number of courses; found 3"),
        ((("x", "y"), -2), "every: out of range"),
        ((("x", "y"), 2, (2.0, 1.0)), "cracked: no stretch of height"),
    ],
)
def test_what_is_no_junction(arguments, said: str) -> None:
    with pytest.raises(InputError, match=said):
        Junction(*arguments)


def test_junctions_of_walls_that_do_not_stand_or_meet() -> None:
    weights = (cp.UnitWeight("default", 18e3),)
    with pytest.raises(InputError, match="junction of x and z: no such wall; found z; expected x, y"):
        Building("b", (along_x(), along_y()), weights, junctions=(Junction(("x", "z")),))
    away = along_y(left=2.0, start=3.0)
    with pytest.raises(InputError, match="junction of x and y: the walls do not meet"):
        cp.derive_blocks(Building("b", (along_x(), away), weights, junctions=(Junction(("x", "y")),)))
    assert np.isfinite(cp.derive_blocks(Building("b", (along_x(), away), weights)).volume).all()
