"""Walls that slide off a level across their thickness: by hand at the friction of that level, as stones do; a shell does not."""

from typing import Any

import pytest

import churchpipe as cp
from churchpipe.generators.house import house

PUSH = cp.LoadCase((0, 1, 0))


def wall_of(height: float, friction: float, *, above: float | None = None, weak: float = 0.6, **given: Any) -> cp.Building:
    """A wall of 3 m along x, .9 m thick, of another friction above a height."""
    storeys = [{"above": above, "thickness": 0.9, "material": "weak"}] if above else []
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
    """Our own figure of docs/limits.md: b / h = .9, and a friction of .6."""
    stones, shell = both(wall_of(1.0, 0.6))
    assert stones.load_factor == pytest.approx(0.6, rel=1e-6)
    assert shell.load_factor == pytest.approx(1.098, abs=1e-3)
    assert shell.message.startswith(
        "the push is 1.098 of the weight, more than the friction of the joints, 0.6: stones slide off"
    )
    assert "off the ground before" in shell.message


def test_a_storey_slides_off_the_one_below() -> None:
    """Our own figure of docs/limits.md: the upper metre of two has a friction of .1."""
    stones, shell = both(wall_of(2.0, 0.6, above=1.0, weak=0.1))
    assert stones.load_factor == pytest.approx(0.1, rel=1e-6)
    assert shell.load_factor == pytest.approx(0.523, abs=1e-3)
    assert shell.message == (
        "the push is 0.5229 of the weight above z = 1 m, more than the friction of the joints, 0.1: stones slide off that level "
        "before, which the shell does not, so use their load factor"
    )


def test_a_wall_slides_on_its_damp_course() -> None:
    course = cp.JointGroup("damp course", walls=("a",), above=0.9, below=1.1, friction=0.1)
    stones, shell = both(wall_of(2.0, 0.6), [course])
    assert stones.load_factor == pytest.approx(0.1, rel=1e-6)
    assert shell.load_factor > 0.3
    assert "more than the friction of the joints, 0.1: stones slide off that level before" in shell.message


def test_nothing_is_said_where_the_walls_beside_hold_the_level() -> None:
    beside = [{"name": name, "start": (x, 0.0), "end": (x, 3.0)} for name, x in (("b", 0.45), ("c", 2.55))]
    _, shell = both(wall_of(2.0, 0.6, above=1.0, weak=0.1, walls=beside))
    assert shell.load_factor > 0.1
    assert shell.message == ""
