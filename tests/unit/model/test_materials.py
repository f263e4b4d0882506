"""Unit weight and strength apart: what takes one of them asks for no number of the other."""

import re
from pathlib import Path

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.generators import wall

WALL = {"length": 1.0, "courses": 2, "brick": (0.5, 0.2, 0.2)}


def test_a_material_is_both() -> None:
    elastic = cp.Elastic(3e9, 0.2, 3e8, 0.2, 0.01)
    material = cp.Material("tuff", 18e3, 0.6, 2e3, elastic)
    assert isinstance(material, cp.UnitWeight)
    assert isinstance(material, cp.JointStrength)
    assert (material.name, material.unit_weight, material.friction, material.cohesion) == ("tuff", 18e3, 0.6, 2e3)
    assert material.elastic is elastic
    assert material == cp.Material(name="tuff", unit_weight=18e3, friction=0.6, cohesion=2e3, elastic=elastic)


def test_stones_ask_for_a_weight_and_joints_for_a_strength() -> None:
    stones = cp.derive_blocks(wall(**WALL, materials=[cp.UnitWeight("tuff", 18e3)]))
    assert stones.weight.sum() == pytest.approx(18e3 * 1.0 * 0.2 * 0.4)
    contacts = cp.find_contacts(stones)
    strength = cp.JointStrength("tuff", 0.6, 2e3)
    for found, expected in zip(cp.joint_strength(stones, contacts, [strength]), (0.6, 2e3), strict=True):
        np.testing.assert_array_equal(found, expected)
    with pytest.raises(cp.InputError, match="wrong kind; found UnitWeight; expected a JointStrength"):
        cp.joint_strength(stones, contacts, [cp.UnitWeight("tuff", 18e3)])  # pyright: ignore
    with pytest.raises(cp.InputError, match="wrong kind; found JointStrength; expected an UnitWeight"):
        wall(**WALL, materials=[strength])  # pyright: ignore


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: cp.UnitWeight("a", -1.0), "material a: unit_weight: out of range; found -1.0; expected 0, or 1e-06 to 1e\\+09"),
        (lambda: cp.JointStrength("a", 2e3), "material a: friction: out of range"),
        (lambda: cp.JointStrength("a", 0.6, -1.0), "material a: cohesion: out of range"),
        (lambda: cp.JointStrength("", 0.6), "material: name: no name"),
    ],
)
def test_each_checks_its_numbers(make, message: str) -> None:
    with pytest.raises(cp.InputError, match=message):
        make()


def test_nothing_makes_a_material_of_invented_numbers() -> None:
    """Cases and drawings make one of its keys; by name only the default of the generators is made, which is documented."""
    package = Path(cp.__file__).parent
    sources = {path.relative_to(package).as_posix(): path.read_text(encoding="utf-8") for path in package.rglob("*.py")}
    makers = {name for name, text in sources.items() if re.search(r"\bMaterial\(", text)}
    assert makers == {"generators/masonry.py", "model/materials.py"}
