"""Walls that slide across their thickness, by hand at the friction of a level: a shell does so at its feet, and nowhere else."""

from typing import Any

import pytest

import churchpipe as cp
from churchpipe.generators.house import house

PUSH = cp.LoadCase((0, 1, 0))


def wall_of(
    height: float, friction: float, *, above: float | None = None, weak: float = 0.6, upper: float = 0.9, **given: Any
) -> cp.Building:
    """A wall of 3 m along x, .9 m thick, of another thickness and friction above a height."""
    storeys = [{"above": above, "thickness": upper, "material": "weak"}] if above else []
    walls = [{"name": "a", "start": (0.0, 0.0), "end": (3.0, 0.0), "storeys": storeys}, *given.pop("walls", [])]
    return house(
        course=0.25,
        stone_length=0.5,
        height=height,
        thickness=0.9,
        walls=walls,
        materials=[cp.Material("sound", 18e3, friction), cp.Material("weak", 18e3, weak)],
        **given,
    )


def both(building: cp.Building, groups: list[cp.JointGroup] | None = None) -> tuple[cp.LimitState, cp.ShellLimitState]:
    stones = cp.derive_blocks(building)
    contacts = cp.find_contacts(stones)
    friction, _ = cp.joint_strength(stones, contacts, building.materials, groups or ())
    shell, materials = cp.shell_joint_groups(cp.derive_shell(building, element_size=0.5), building.materials, groups or ())
    return cp.limit_analysis(stones, contacts, PUSH, friction), cp.shell_limit_analysis(shell, PUSH, materials)


def test_a_low_wall_slides_off_the_ground() -> None:
    # It would turn over at b / h = .9.
    for found in both(wall_of(1.0, 0.6)):
        assert found.load_factor == pytest.approx(0.6, rel=1e-6)
        assert found.message == ""


@pytest.mark.parametrize("thickness", [0.9, 0.6])
def test_a_storey_slides_off_the_one_below(thickness: float) -> None:
    for found in both(wall_of(2.0, 0.6, above=1.0, weak=0.1, upper=thickness)):
        assert found.load_factor == pytest.approx(0.1, rel=1e-6)
        assert found.message == ""


def test_a_wall_slides_on_its_damp_course() -> None:
    """Our own figure of docs/limits.md: the shell turns over, at b / h."""
    course = cp.JointGroup("damp course", walls=("a",), above=0.9, below=1.1, friction=0.1)
    stones, shell = both(wall_of(2.0, 0.6), [course])
    assert stones.load_factor == pytest.approx(0.1, rel=1e-6)
    assert shell.load_factor == pytest.approx(0.45, rel=1e-6)
    assert "more than the friction of the joints, 0.1: stones slide off that level before" in shell.message


def test_nothing_is_said_where_the_walls_beside_hold_the_level() -> None:
    beside = [{"name": name, "start": (x, 0.0), "end": (x, 3.0)} for name, x in (("b", 0.45), ("c", 2.55))]
    _, shell = both(wall_of(2.0, 0.6, above=1.0, weak=0.1, walls=beside))
    assert shell.load_factor > 0.1
    assert shell.message == ""
