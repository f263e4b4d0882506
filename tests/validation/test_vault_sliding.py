"""Vaults without dilatancy: mean radius 1 m, friction .7, 18 kN/m3, pushed along +x if not said.

"Own": value and interval computed for this project by separate code, which followed the forces from step to step, before this
code existed. A load factor without dilatancy is one of many (docs/theory.md): two searches agree where their intervals meet, or
where a start comes near a state in theirs (gap 1e-4), and another one is certified lower. Where they do not, `most` is how far
the value may be from theirs, as a share of it; docs/vault_validation.md names these cases.
"""

from collections.abc import Callable
from typing import Any

import pytest

from churchpipe.generators import dome, vault
from churchpipe.model.building import Building
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import UnitWeight
from churchpipe.rigid_blocks.limit import limit_analysis
from churchpipe.stones.blocks import derive_blocks
from churchpipe.stones.contacts import find_contacts

MATERIAL = (UnitWeight("default", 18e3),)
BARREL: dict[str, Any] = {"courses": 27, "stone_length": 0.5}
GROIN: dict[str, Any] = {"courses": 19, "stone_length": 0.3, "kind": "groin"}
PAVILION: dict[str, Any] = GROIN | {"kind": "pavilion"}
DOME: dict[str, Any] = {"rings": 16, "sides": 64}
HALF: dict[str, Any] = {"rings": 16, "sides": 32, "plan": "half"}
ARCHES: dict[str, Any] = {"arches": 3, "arch_width": 0.5, "arch_depth": 0.2}
RIBS: dict[str, Any] = {"rib_width": 0.12, "rib_depth": 0.1}
Own = tuple[float, float, float]
Case = tuple[Callable[..., Building], float, dict[str, Any], Own]


def slide(build: Callable[..., Building], thickness: float, sizes: dict[str, Any], own: Own, most: float = 0.0) -> None:
    """Hold the value without dilatancy, below the associative one, to the value and the interval (low, high) given."""
    stones = derive_blocks(build(span=2 - thickness, thickness=thickness, materials=MATERIAL, **sizes))
    contacts = find_contacts(stones)
    load = LoadCase((1, 0, 0))
    state = limit_analysis(stones, contacts, load, friction=0.7, flow="non-associative")
    value, low, high = own
    assert state.gap < 1e-3
    assert state.interval[0] <= state.load_factor <= state.interval[1]
    if most:
        assert state.load_factor == pytest.approx(value, rel=most)
    else:
        # Theirs ends with the fourth digit.
        assert state.interval[0] - 5e-5 <= high
        near = [run.load_factor for run in state.starts if run.gap <= 1e-4 * run.load_factor]
        assert state.interval[1] + 5e-5 >= low or any(low - 5e-5 <= value <= high + 5e-5 for value in near)
    assert state.load_factor <= limit_analysis(stones, contacts, load, friction=0.7).load_factor + 1e-6


CROSSED = pytest.mark.slow("docs/vault_validation.md: vaults without dilatancy")


@pytest.mark.parametrize(
    "case",
    [
        pytest.param((vault, 0.15, GROIN, (0.2370, 0.2361, 0.2855)), marks=CROSSED),
        (vault, 0.12, GROIN, (0.1016, 0.0972, 0.1517)),
        pytest.param((vault, 0.10, PAVILION | {"corner": "mitre"}, (0.3544, 0.3525, 0.3602)), marks=CROSSED),
    ],
)
def test_crossed_vaults_slide(case: Case) -> None:
    slide(*case)


def test_a_barrel_with_courses_along_it_loses_nothing() -> None:
    # It overturns: no joint slides.
    slide(vault, 0.15, BARREL | {"length": 1.0}, (0.145338, 0.145338, 0.145338), most=1e-5)


@pytest.mark.slow("docs/vault_validation.md: vaults without dilatancy")
@pytest.mark.parametrize(
    "case",
    [
        # The gain of staggered rings is dilatancy: associative .2318.
        (vault, 0.15, BARREL | {"length": 2.5, "laid": "rings", "stone_length": 0.25}, (0.147424, 0.1463, 0.1738)),
        (vault, 0.15, GROIN | {"heads": "aligned"}, (0.2324, 0.2235, 0.2400)),
        (vault, 0.15, GROIN | {"corner": "mitre"}, (0.2408, 0.2402, 0.2427)),
        (vault, 0.15, GROIN | {"corner": "mitre", "heads": "aligned"}, (0.2098, 0.2098, 0.2108)),
        (vault, 0.12, GROIN | {"arches": 4, "arch_width": 0.3, "arch_depth": 0.15}, (0.2523, 0.1955, 0.3770)),
        # By this code alone; without ribs .2370 and .1016.
        (vault, 0.15, GROIN | RIBS, (0.2830, 0.2822, 0.2840)),
        (vault, 0.12, GROIN | RIBS, (0.2489, 0.2483, 0.2494)),
        (vault, 0.10, PAVILION | {"corner": "mitre", "heads": "aligned"}, (0.3562, 0.3525, 0.3602)),
        (dome, 0.15, HALF, (0.4399, 0.4137, 0.4914)),
    ],
)
def test_other_vaults_slide(case: Case) -> None:
    slide(*case)


@pytest.mark.slow("docs/vault_validation.md: vaults whose search without dilatancy ends elsewhere than the other one")
@pytest.mark.parametrize(
    ("case", "most"),
    [
        ((vault, 0.12, BARREL | {"length": 4.0} | ARCHES, (0.3590, 0.3578, 0.3603)), 0.02),
        ((dome, 0.10, DOME | {"sides": 32, "stone_sides": 1, "laid": "lunes"}, (0.3290, 0.3273, 0.3310)), 0.045),
        # Theirs lies in .5284 to .5342, ours in an interval that ends at .5283.
        ((vault, 0.10, PAVILION, (0.5311, 0.5284, 0.5342)), 0.015),
    ],
)
def test_vaults_whose_value_is_not_unique(case: Case, most: float) -> None:
    slide(*case, most=most)


@pytest.mark.slow("docs/vault_validation.md: a dome of lunes of which no state is quite certified")
def test_what_is_told_of_a_dome_of_lunes_reaches_down_to_the_value_of_the_other_search() -> None:
    stones = derive_blocks(dome(span=1.9, thickness=0.10, materials=MATERIAL, **DOME, laid="lunes"))
    contacts, load = find_contacts(stones), LoadCase((1, 0, 0))
    state = limit_analysis(stones, contacts, load, friction=0.7, flow="non-associative")
    assert state.gap < 1e-4 * state.load_factor
    assert state.load_factor < limit_analysis(stones, contacts, load, friction=0.7).load_factor
    told = [
        state.load_factor,
        *(run.load_factor for run in state.starts if f"the state at {run.load_factor:.4f}" in state.message),
    ]
    # Own: .3162, of .3145 to .3180. Rounding alone moves a search by 1.5 %.
    assert min(told) < 1.015 * 0.3180
    assert max(told) > 0.3145 / 1.015


@pytest.mark.slow("docs/vault_validation.md: a half dome pushed outwards, whose search without dilatancy settles nowhere")
def test_a_half_dome_pushed_outwards_is_not_settled() -> None:
    # Own: .0888, left at a gap of 1e-4. Here no start comes to that gap, and they end on both sides of it.
    stones = derive_blocks(dome(span=1.85, thickness=0.15, materials=MATERIAL, **HALF))
    contacts = find_contacts(stones)
    load = LoadCase((0, -1, 0))
    state = limit_analysis(stones, contacts, load, friction=0.7, flow="non-associative", bipotential_gap=1e-4)
    ends = [start.load_factor for start in state.starts]
    assert state.status == "not-converged"
    assert len(ends) >= 5
    assert min(ends) < 0.0888 < max(ends) < 0.2389
