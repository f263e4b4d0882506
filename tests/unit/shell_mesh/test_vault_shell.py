"""The shell of vaults: facets that fit, weights of the stones, the match gate.

Load factors along +x, friction .7, mean radius 1 m, by the exact cell. Those of shells clamped at their feet were computed for
this project by separate code from the same facets before this code existed. All others are of shells that stand on joints.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.errors import InputError
from churchpipe.generators import chapel, dome, vault
from churchpipe.homogenised_shell.bounds import proved_bounds
from churchpipe.homogenised_shell.condensed import CondensedShell
from churchpipe.homogenised_shell.element import shell_elements
from churchpipe.model.building import Building
from churchpipe.shell_mesh import vault_facets

MATERIAL = (cp.Material("default", 18e3, 0.7),)
BARREL: dict[str, Any] = {"courses": 27, "stone_length": 0.5, "length": 1.0}
RINGS: dict[str, Any] = {"laid": "rings"}
LUNES: dict[str, Any] = {"laid": "lunes", "stone_sides": 1}
CROSSED: dict[str, Any] = {"courses": 19, "stone_length": 0.3}
WALLS: dict[str, Any] = {"wall_height": 1.0, "wall_thickness": 0.5, "wall_course": 0.25}
THIN: dict[str, Any] = {"wall_height": 1.0, "wall_course": 0.25}
DRUM: dict[str, Any] = {"drum_height": 0.6, "drum_thickness": 0.1, "drum_course": 0.15}
HALF: dict[str, Any] = {"span": 1.79, "thickness": 0.21, "rings": 12, "sides": 16, "plan": "half"}
ROOM: dict[str, Any] = {"width": 5.0, "length": 5.0, "height": 1.0, "thickness": 0.9, "course": 0.25, "stone_length": 0.5}
# Figures of the manual that take half a minute.
LUNES_AND_RINGS = pytest.mark.slow("docs/vault_validation.md: lunes, and rings pushed along a barrel")
FACETS = pytest.mark.slow("docs/vault_validation.md: shells of vaults and domes")
LANTERN: dict[str, Any] = {"oculus": 0.5, "lantern_height": 0.4, "lantern_course": 0.1, "lantern_thickness": 0.08}


def both(build: Callable[..., Building], thickness: float, size: float, **sizes: Any) -> tuple[cp.Assemblage, cp.ShellModel, Any]:
    building = build(span=2 - thickness, thickness=thickness, materials=MATERIAL, **sizes)
    stones, shell = cp.derive_blocks(building), cp.derive_shell(building, size)
    return stones, shell, cp.match_models(stones, cp.find_contacts(stones), shell)


@pytest.mark.parametrize(
    ("build", "thickness", "sizes"),
    [
        (vault, 0.15, BARREL),
        # Beds at the springing are inclined to their facet by 13 degrees, and wider than it is thick by 2.5 %.
        (vault, 0.15, BARREL | {"courses": 7}),
        (vault, 0.15, BARREL | THIN | {"wall_thickness": 0.15}),
        (vault, 0.15, BARREL | WALLS),
        pytest.param(vault, 0.15, CROSSED | {"kind": "groin"} | WALLS, marks=FACETS),
        pytest.param(vault, 0.15, CROSSED | {"kind": "pavilion"} | WALLS, marks=FACETS),
        pytest.param(vault, 0.15, BARREL | {"shape": "pointed", "rise": 1.4}, marks=FACETS),
        (vault, 0.15, BARREL | WALLS | RINGS),
        (vault, 0.15, BARREL | {"shape": "pointed", "rise": 1.4} | RINGS),
        (vault, 0.15, CROSSED | {"kind": "groin"}),
        (vault, 0.15, CROSSED | {"kind": "groin", "corner": "mitre", "second_span": 1.5} | THIN | {"wall_thickness": 0.15}),
        (vault, 0.10, CROSSED | {"kind": "pavilion"}),
        (vault, 0.10, CROSSED | {"kind": "octagonal", "corner": "alternate"} | THIN | {"wall_thickness": 0.1}),
        pytest.param(dome, 0.10, {"rings": 12, "sides": 32} | DRUM, marks=FACETS),
        (dome, 0.10, {"rings": 12, "sides": 32} | DRUM | {"drum_thickness": 0.2}),
        (dome, 0.10, {"rings": 9, "sides": 32} | LANTERN),
        pytest.param(dome, 0.10, {"rings": 9, "sides": 32} | LANTERN | DRUM | LUNES, marks=FACETS),
        (dome, 0.15, {"rings": 12, "sides": 16, "plan": "half"}),
        pytest.param(dome, 0.10, {"rings": 12, "sides": 32, "shortest_stone": 0.2} | DRUM, marks=FACETS),
    ],
)  # fmt: skip
def test_stones_and_shell_are_one_building(build: Callable[..., Building], thickness: float, sizes: dict[str, Any]) -> None:
    stones, shell, match = both(build, thickness, 0.25, **sizes)
    assert match.passed, [figure for figure in match.figures if not figure.passed]
    assert shell.weight.sum() == pytest.approx(stones.weight.sum(), rel=1e-9)
    for part in np.unique(stones.panel[~stones.fixed]):
        assert shell.weight[shell.panel == part].sum() == pytest.approx(stones.weight[stones.panel == part].sum(), rel=1e-9)


@pytest.mark.parametrize(
    ("build", "thickness", "size", "sizes", "clamped", "expected"),
    [
        # Facets as large as a course; stones of the barrel: .1453.
        (vault, 0.15, 0.2, BARREL, 0.2051, 0.1501),
        pytest.param(vault, 0.15, 0.36, CROSSED | {"kind": "groin"}, 0.3155, 0.1825, marks=FACETS),
        pytest.param(vault, 0.10, 0.36, CROSSED | {"kind": "pavilion"}, 0.5664, 0.5309, marks=FACETS),
        pytest.param(dome, 0.10, 0.2, {"rings": 12, "sides": 32}, 0.6381, 0.6000, marks=FACETS),
    ],
)  # fmt: skip
def test_load_factors(
    build: Callable[..., Building],
    thickness: float,
    size: float,
    sizes: dict[str, Any],
    clamped: float,
    expected: float,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # expected: on joints, with the rows of a springing.
    push = cp.LoadCase((1, 0, 0))
    _, shell, _ = both(build, thickness, size, **sizes)
    state = cp.shell_limit_analysis(shell, push, MATERIAL, planes="cell")
    assert state.status == "optimal"
    assert state.load_factor == pytest.approx(expected, abs=6e-5)
    # clamped: without joints, and with facets of one size, as the separate code had it.
    monkeypatch.setattr(vault_facets, "FOOT", np.empty(0))
    _, shell, _ = both(build, thickness, size, **sizes)
    condensed = CondensedShell(shell_elements(shell), push, MATERIAL, "cell")
    dead, live = condensed.loads.dead, condensed.loads.live
    bounds = proved_bounds(condensed, condensed.solve(dead, live), dead, live)
    assert bounds.lower == pytest.approx(clamped, abs=6e-5)


@pytest.mark.parametrize(
    ("build", "thickness", "sizes", "size", "bonds", "expected"),
    [
        # A ring alone as stones: .1452; ten that are staggered .2318, of which .1474 is left without dilatancy.
        (vault, 0.15, BARREL | RINGS | {"length": 0.5}, 0.2, {"running"}, 0.1459),
        pytest.param(
            vault,
            0.15,
            BARREL | RINGS | {"length": 2.5, "stone_length": 0.25},
            0.3,
            {"running", "stack"},
            0.1459,
            marks=LUNES_AND_RINGS,
        ),
        # As stones .4447, without dilatancy .3426.
        pytest.param(dome, 0.10, {"rings": 16, "sides": 32} | LUNES, 0.2, {"stack"}, 0.2980, marks=LUNES_AND_RINGS),
    ],
)  # fmt: skip
def test_rings_and_lunes_do_not_interlock(
    build: Callable[..., Building], thickness: float, sizes: dict[str, Any], size: float, bonds: set[str], expected: float
) -> None:
    _, shell, match = both(build, thickness, size, **sizes)
    assert match.passed
    # Between rings lies a strip in stack bond; a ring alone has none.
    assert set(shell.bonds) == bonds
    state = cp.shell_limit_analysis(shell, cp.LoadCase((1, 0, 0)), MATERIAL, planes="cell")
    assert state.status == "optimal"
    assert state.load_factor == pytest.approx(expected, abs=6e-5)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sizes", "blocks", "expected"),
    [
        # A ring turns over about the outer edges of its feet, at half its width over the height of its centroid, .6376 m.
        ({"length": 0.5}, 0.25 / 0.6376335, 0.3180),
        # The outer one alone would, but for the other, from which it has to move apart as it turns. Without dilatancy: .3983.
        pytest.param({"length": 1.0}, 0.470949, 0.4336, marks=LUNES_AND_RINGS),
        pytest.param({"length": 1.0, "stone_length": 0.25}, 0.286592, 0.2420, marks=LUNES_AND_RINGS),
    ],
)
def test_rings_pushed_along_the_barrel_are_as_wide_as_they_are(sizes: dict[str, Any], blocks: float, expected: float) -> None:
    stones, shell, match = both(vault, 0.15, 0.25, **BARREL | RINGS | sizes)
    assert match.passed
    along = cp.LoadCase((0, 1, 0))
    state = cp.limit_analysis(stones, cp.find_contacts(stones), along, 0.7)
    assert state.load_factor == pytest.approx(blocks, abs=2e-6)
    state = cp.shell_limit_analysis(shell, along, MATERIAL)
    assert state.status == "optimal"
    assert state.load_factor == pytest.approx(expected, abs=6e-5)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sizes", "expected"),
    [
        # Stones: .5213; 17920 facets: .4284.
        ({"rings": 9, "sides": 32} | LANTERN, 0.4192),
        # On skewbacks. Stones: .565.
        pytest.param({"rings": 8, "sides": 32, "rise": 0.5}, 0.5529, marks=FACETS),
    ],
)
def test_a_dome_stands_where_the_thrust_turns_at_a_level_fold(sizes: dict[str, Any], expected: float) -> None:
    # Held by nothing but the membranes on both sides, the middles of the edges under a lantern would give way to any load.
    _, shell, _ = both(dome, 0.1, 0.2, **sizes)
    state = cp.shell_limit_analysis(shell, cp.LoadCase((1, 0, 0)), MATERIAL)
    assert state.status == "optimal"
    assert state.load_factor == pytest.approx(expected, abs=1e-4)


@pytest.mark.parametrize(
    ("build", "sizes", "in_shell", "in_stones"),
    [
        # All of it slides off the ground, with the dilatancy that the facets of its foot share.
        (dome, {"rings": 6, "sides": 8, "oculus": 1.0}, 0.6, 0.5901),
        (vault, {"kind": "groin", "courses": 13, "stone_length": 0.4, "shape": "segmental", "rise": 1.2}, None, None),
    ],
)
def test_a_thick_shell_slides_at_its_feet(
    build: Callable[..., Building], sizes: dict[str, Any], in_shell: float | None, in_stones: float | None
) -> None:
    # None: under their own weight both slide off their skewbacks.
    building = build(span=4.0, thickness=0.4, materials=(cp.Material("default", 18e3, 0.6),), **sizes)
    stones, load = cp.derive_blocks(building), cp.LoadCase((1, 0, 0))
    blocks = cp.limit_analysis(stones, cp.find_contacts(stones), load, 0.6)
    shell = cp.shell_limit_analysis(cp.derive_shell(building, 4.0 / 6), load, (cp.Material("default", 18e3, 0.6),))
    for state, expected in ((blocks, in_stones), (shell, in_shell)):
        assert state.status == ("optimal" if expected else "unstable")
        assert state.load_factor == pytest.approx(expected or np.nan, abs=6e-5, nan_ok=True)
    assert "more than the friction" not in shell.message


def test_a_shell_on_nothing_falls() -> None:
    own = cp.Material("default", 18e3, 0.6)
    shell = cp.derive_shell(dome(span=4.0, rings=6, sides=8, oculus=1.0, thickness=0.4, materials=(own,)), 4.0 / 6)
    hung = replace(shell, supported=np.zeros_like(shell.supported))
    assert cp.shell_limit_analysis(hung, cp.LoadCase((1, 0, 0)), (own,)).status == "unstable"


@pytest.mark.parametrize(
    ("sizes", "message"),
    [
        (BARREL | WALLS | {"backing": 0.5}, "vault backing: has no mid-surface of its own; found backing_right, backing_left"),
        (
            CROSSED | {"kind": "groin", "rib_width": 0.1, "rib_depth": 0.1},
            "vault arches: has no mid-surface of its own; found rib",
        ),
    ],
)
def test_what_the_shell_does_not_take_is_named(sizes: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        cp.derive_shell(vault(span=1.85, thickness=0.15, **sizes), 0.25)


@pytest.mark.parametrize(
    ("sides", "size", "in_shell", "in_stones"),
    [
        (8, 0.8, 0.341, 0.516),
        pytest.param(8, 0.4, 0.0, 0.516, marks=pytest.mark.slow("docs/limits.md: domes in few lunes")),
        pytest.param(16, 0.4, 0.371, 0.510, marks=pytest.mark.slow("docs/limits.md: domes in few lunes")),
    ],
)
def test_a_dome_in_few_lunes_has_less_in_the_shell(sides: int, size: float, in_shell: float, in_stones: float) -> None:
    """Our own figures of docs/limits.md. Facets of a lune fold in its middle, and stones do not."""
    material = cp.Material("default", 18e3, 0.6)
    lunes = {"span": 2.85, "thickness": 0.25, "rings": 6, "sides": sides, "laid": "lunes", "stone_sides": 1}
    building = dome(**lunes, materials=(material,))
    stones, load = cp.derive_blocks(building), cp.LoadCase((1, 0, 0))
    shell = cp.shell_limit_analysis(cp.derive_shell(building, size), load, (material,))
    assert shell.load_factor == pytest.approx(in_shell, abs=1e-3)
    assert cp.limit_analysis(stones, cp.find_contacts(stones), load, 0.6).load_factor == pytest.approx(in_stones, abs=1e-3)


@pytest.mark.slow("docs/vault_validation.md: a barrel that slides off its skewbacks")
@pytest.mark.parametrize(("friction", "in_shell", "in_stones"), [(0.7, 0.2954, 0.2987), (1.5, 0.6167, 0.6129)])
def test_a_segmental_barrel_slides_off_its_skewbacks(friction: float, in_shell: float, in_stones: float) -> None:
    material, load = (cp.Material("default", 18e3, friction),), cp.LoadCase((1, 0, 0))
    sizes = BARREL | {"span": 1.8, "thickness": 0.2, "shape": "segmental", "rise": 0.6}
    building = vault(**sizes, materials=material)
    stones = cp.derive_blocks(building)
    of_stones = cp.limit_analysis(stones, cp.find_contacts(stones), load, friction)
    assert of_stones.load_factor == pytest.approx(in_stones, abs=6e-5)
    of_shell = cp.shell_limit_analysis(cp.derive_shell(building, 0.2), load, material)
    assert of_shell.load_factor == pytest.approx(in_shell, abs=6e-5)


@pytest.mark.slow("docs/limits.md: domes that slide on the upper joints of skewbacks, groin vaults")
@pytest.mark.parametrize(
    ("build", "sizes", "friction", "in_shell", "in_stones"),
    [
        (dome, {"span": 3.21, "rise": 0.5, "thickness": 0.46, "rings": 8, "sides": 24}, 0.54, 0.3845, 0.2552),
        (vault, {"kind": "groin", "span": 3.6, "thickness": 0.3, "courses": 13, "stone_length": 0.5}, 0.6, np.nan, 0.1853),
    ],
)
def test_where_joints_at_the_feet_are_not_those_that_slide(
    build: Callable[..., Building], sizes: dict[str, Any], friction: float, in_shell: float, in_stones: float
) -> None:
    """Our own figures of docs/limits.md."""
    material, load = (cp.Material("default", 18e3, friction),), cp.LoadCase((1, 0, 0))
    building = build(**sizes, materials=material)
    stones = cp.derive_blocks(building)
    of_stones = cp.limit_analysis(stones, cp.find_contacts(stones), load, friction)
    assert of_stones.load_factor == pytest.approx(in_stones, abs=6e-5)
    of_shell = cp.shell_limit_analysis(cp.derive_shell(building, 0.5), load, material)
    assert of_shell.load_factor == pytest.approx(in_shell, abs=6e-5, nan_ok=True)
    assert of_shell.status == ("unstable" if np.isnan(in_shell) else "optimal")


@pytest.mark.slow
def test_a_dome_slides_off_the_slabs_below_it() -> None:
    material, load = (cp.Material("default", 18e3, 0.4),), cp.LoadCase((1, 0, 0))
    over = {"over": "nave", "kind": "dome", "thickness": 0.3, "courses": 8}
    building = chapel(**ROOM, vaults=(over,), materials=material)
    stones = cp.derive_blocks(building)
    of_stones = cp.limit_analysis(stones, cp.find_contacts(stones), load, 0.4).load_factor
    assert of_stones == pytest.approx(0.3626, abs=6e-5)
    of_shell = cp.shell_limit_analysis(cp.derive_shell(building, 0.5), load, material).load_factor
    assert of_shell == pytest.approx(of_stones, rel=0.015)


@pytest.mark.slow("docs/limits.md: aligned heads, half domes")
@pytest.mark.parametrize(
    ("build", "sizes", "friction", "direction", "in_shell", "in_stones"),
    [
        (vault, BARREL | {"span": 1.85, "thickness": 0.15, "heads": "aligned"}, 0.7, (0, 1, 0), 0.5880, 0.4709),
        (dome, HALF, 0.6, (1, 0, 0), np.nan, 0.4958),
        (dome, HALF, 0.6, (0, 1, 0), np.nan, 0.6),
        (dome, HALF, 0.6, (0, -1, 0), np.nan, 0.3819),
    ],
)
def test_where_the_shell_is_no_model_of_a_vault(
    build: Callable[..., Building],
    sizes: dict[str, Any],
    friction: float,
    direction: tuple[float, float, float],
    in_shell: float,
    in_stones: float,
) -> None:
    """Our own figures of docs/limits.md."""
    material = (cp.Material("default", 18e3, friction),)
    building, load = build(**sizes, materials=material), cp.LoadCase(direction)
    stones = cp.derive_blocks(building)
    of_stones = cp.limit_analysis(stones, cp.find_contacts(stones), load, friction)
    assert of_stones.load_factor == pytest.approx(in_stones, abs=1e-3)
    of_shell = cp.shell_limit_analysis(cp.derive_shell(building, 0.2), load, material)
    assert of_shell.load_factor == pytest.approx(in_shell, abs=1e-3, nan_ok=True)
    assert of_shell.status == ("unstable" if np.isnan(in_shell) else "optimal")
