"""Vaults and domes of stones against known values.

Slices of barrels of 27 voussoirs: load factors .145338 and .284337 (test_arches, independent calculations). All others that are
marked "own" were computed for this project by separate code from the same geometry before this code existed, with one plane joint
for each pair of stone faces. Mean radius 1 m, friction .7, 18 kN/m3.
"""

from collections.abc import Callable
from typing import Any

import pytest

from churchpipe.generators import dome, vault
from churchpipe.model.building import Building
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import UnitWeight
from churchpipe.model.results import LimitState
from churchpipe.rigid_blocks.limit import limit_analysis
from churchpipe.stones.blocks import derive_blocks
from churchpipe.stones.contacts import find_contacts
from churchpipe.stones.soundness import check_soundness

MATERIAL = (UnitWeight("default", 18e3),)
BARREL: dict[str, Any] = {"courses": 27, "stone_length": 0.5}
CROSSED: dict[str, Any] = {"courses": 19, "stone_length": 0.3}
GROIN: dict[str, Any] = CROSSED | {"kind": "groin"}
PAVILION: dict[str, Any] = CROSSED | {"kind": "pavilion"}
TABLE = pytest.mark.slow("docs/vault_validation.md: load factors of vaults")
DOMES = pytest.mark.slow("docs/vault_validation.md: domes of 64 sides, and half of one")
HALF: dict[str, Any] = {"rings": 16, "sides": 32, "plan": "half", "thickness": 0.15}


def push(
    build: Callable[..., Building], thickness: float, direction: tuple[float, ...] = (1, 0, 0), **sizes: Any
) -> tuple[LimitState, float, int]:
    """The state of a vault of mean radius 1 m, its weight in kN and its stones."""
    stones = derive_blocks(build(span=2 - thickness, thickness=thickness, materials=MATERIAL, **sizes))
    contacts = find_contacts(stones)
    check_soundness(stones, contacts)
    state = limit_analysis(stones, contacts, LoadCase(direction), friction=0.7)
    return state, float(stones.weight.sum()) / 1e3, stones.count - 1


@pytest.mark.parametrize("heads", ["staggered", "aligned"])
@pytest.mark.parametrize(("thickness", "expected"), [(0.15, 0.145338), (0.2, 0.284337)])
def test_a_barrel_with_courses_along_it_is_its_slice(thickness: float, expected: float, heads: str) -> None:
    state, _, _ = push(vault, thickness, length=1.5, heads=heads, **BARREL)
    assert state.load_factor == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize(
    ("build", "thickness", "sizes", "count", "weight", "expected"),
    [
        (vault, 0.15, BARREL | {"length": 2.5, "laid": "rings", "stone_length": 0.25}, 275, 21.194, 0.231756),
        (vault, 0.15, BARREL | {"length": 2.5, "laid": "rings", "stone_length": 0.25, "heads": "aligned"}, 270, 21.194, 0.145162),
        (vault, 0.12, BARREL | {"length": 4.0}, 229, 27.082, 0.048431),
        (vault, 0.12, BARREL | {"length": 4.0, "arches": 3, "arch_width": 0.5, "arch_depth": 0.2}, 310, 41.300, 0.399100),
        (vault, 0.15, GROIN, 97, 14.815, 0.333668),
        pytest.param(vault, 0.15, GROIN | {"heads": "aligned"}, 77, 14.815, 0.338839, marks=TABLE),
        (vault, 0.15, GROIN | {"corner": "alternate"}, 113, 14.815, 0.318023),
        (vault, 0.15, GROIN | {"corner": "mitre"}, 133, 14.815, 0.286312),
        pytest.param(vault, 0.15, GROIN | {"corner": "mitre", "heads": "aligned"}, 113, 14.815, 0.304681, marks=TABLE),
        pytest.param(vault, 0.12, GROIN, 97, 11.458, 0.218135, marks=TABLE),
        (vault, 0.12, GROIN | {"arches": 4, "arch_width": 0.3, "arch_depth": 0.15}, 173, 28.329, 0.378233),
        (vault, 0.10, PAVILION, 107, 14.314, 0.656033),
        (vault, 0.10, PAVILION | {"corner": "mitre"}, 141, 14.314, 0.457730),
        pytest.param(vault, 0.10, PAVILION | {"corner": "mitre", "heads": "aligned"}, 149, 14.314, 0.444502, marks=TABLE),
        (dome, 0.10, {"rings": 16, "sides": 32, "stone_sides": 1, "laid": "lunes"}, 481, 11.219, 0.444670),
        (dome, 0.10, {"rings": 12, "sides": 8, "stone_sides": 1, "laid": "lunes"}, 89, 10.146, 0.494958),
    ],
)  # fmt: skip
def test_load_factors(
    build: Callable[..., Building], thickness: float, sizes: dict[str, Any], count: int, weight: float, expected: float
) -> None:
    # Own, associative, along +x.
    state, weighs, stones = push(build, thickness, **sizes)
    assert (stones, round(weighs, 3)) == (count, weight)
    assert state.load_factor == pytest.approx(expected, abs=1.01e-6)
    assert state.upper_bound - state.lower_bound <= 1e-6 * state.load_factor


def test_a_groin_vault_pushed_along_its_diagonal() -> None:
    state, _, _ = push(vault, 0.15, (1, 1, 0), **GROIN)
    assert state.load_factor == pytest.approx(0.303521, abs=1.01e-6)


@pytest.mark.parametrize(("thickness", "alone", "expected"), [(0.15, 0.333668, 0.364575), (0.12, 0.218135, 0.317394)])
def test_ribs_below_a_groin_vault(thickness: float, alone: float, expected: float) -> None:
    # What docs/vault_validation.md says; of ribs there is no value by other code.
    state, _, stones = push(vault, thickness, **GROIN, rib_width=0.12, rib_depth=0.1)
    assert stones == 97 + 37
    assert state.load_factor == pytest.approx(expected, abs=1.01e-6)
    assert state.load_factor > alone
    assert state.upper_bound - state.lower_bound <= 1e-6 * state.load_factor


@pytest.mark.parametrize(
    ("sizes", "count", "expected"),
    [
        # 8 stones instead of 16 from the ninth ring on; 16 instead of 32 from the fifteenth, 8 from the twenty-first.
        ({"rings": 12, "sides": 32, "shortest_stone": 0.2}, 153, 0.648135),
        pytest.param({"rings": 24, "sides": 64, "shortest_stone": 0.105}, 569, 0.631767, marks=DOMES),
    ],
)
def test_a_dome_with_fewer_stones_towards_the_crown(sizes: dict[str, Any], count: int, expected: float) -> None:
    # What docs/vault_validation.md says, our own figures. Another code has .647978 and .631879, of stones .02 % lighter: not the
    # same ones.
    state, _, stones = push(dome, 0.1, **sizes)
    assert stones == count
    assert state.load_factor == pytest.approx(expected, abs=1.01e-6)


def test_a_pointed_barrel() -> None:
    # Own: soffit of radius 1.2 m, centres .4 m from the middle.
    sizes = BARREL | {"length": 5.0, "shape": "pointed", "rise": 1.28**0.5}
    stones = derive_blocks(vault(span=1.6, thickness=0.15, materials=MATERIAL, **sizes))
    assert stones.weight.sum() == pytest.approx(43.017e3, abs=0.6)
    state = limit_analysis(stones, find_contacts(stones), LoadCase((1, 0, 0)), friction=0.7)
    assert state.load_factor == pytest.approx(0.192238, abs=1.01e-6)


@pytest.mark.parametrize(
    ("sizes", "direction", "joints", "expected"),
    [
        pytest.param({"rings": 16, "sides": 64}, (1, 0, 0), 1504, 0.605882, marks=DOMES),
        pytest.param({"rings": 16, "sides": 64, "laid": "lunes"}, (1, 0, 0), 1504, 0.455177, marks=DOMES),
        pytest.param(HALF, (1, 0, 0), 744, 0.5100, marks=DOMES),
        pytest.param(HALF, (0, 1, 0), 744, 0.7000, marks=DOMES),
        (HALF, (0, -1, 0), 744, 0.2389),
    ],
)
def test_domes_of_stones_two_sides_wide(
    sizes: dict[str, Any], direction: tuple[float, ...], joints: int, expected: float
) -> None:
    # Own; half domes with four digits. Each side of a bed is a joint of its own.
    sizes = {"thickness": 0.1} | sizes
    state, _, _ = push(dome, direction=direction, **sizes)
    assert len(state.forces) == 4 * joints
    assert state.load_factor == pytest.approx(expected, abs=5e-5 if "plan" in sizes else 1.01e-6)
