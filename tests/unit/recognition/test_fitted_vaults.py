"""Barrels and domes recognised in drawn stones: the shell of the drawing is that of the generator."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.errors import InputError
from churchpipe.generators import arch_piers, dome, vault
from churchpipe.model.building import Building
from churchpipe.recognition.panels import FittedPanels, fit_panels
from mesh_files import WRITERS, write_dxf_drawing

MATERIAL = (cp.Material("default", 18e3, 0.7),)
BARREL: dict[str, Any] = {"span": 1.85, "thickness": 0.15, "courses": 15, "stone_length": 0.5, "length": 2.0}
WALLS: dict[str, Any] = {"wall_height": 1.0, "wall_thickness": 0.15, "wall_course": 0.25}
DOME: dict[str, Any] = {"span": 1.9, "thickness": 0.1, "rings": 8, "sides": 16}
DRUM: dict[str, Any] = {"drum_height": 0.6, "drum_thickness": 0.1, "drum_course": 0.15}
LANTERN: dict[str, Any] = {"oculus": 0.5, "lantern_height": 0.4, "lantern_course": 0.1, "lantern_thickness": 0.08}

TABLE = pytest.mark.slow("docs/vaults.md: vaults in drawings")
CASES: list[Any] = [
    (vault, BARREL),
    (vault, BARREL | WALLS),
    (vault, BARREL | {"shape": "segmental", "rise": 0.4}),
    (dome, DOME),
    pytest.param(dome, DOME | DRUM, marks=TABLE),
    (dome, DOME | LANTERN),
    pytest.param(dome, DOME | {"laid": "lunes"}, marks=TABLE),
    (dome, DOME | {"plan": "half"}),
    pytest.param(dome, DOME | {"rings": 16, "sides": 64, "shortest_stone": 0.1}, marks=TABLE),
]
# Of a pointed key, laid in two halves, the drawing shows one stone, and of the stones around an oculus not where their upper
# joint would be: the mid-surface is slightly another one.
OTHERS: list[tuple[Callable[..., Building], dict[str, Any]]] = [
    (vault, BARREL | {"shape": "pointed", "rise": 1.4}),
    (dome, DOME | {"oculus": 0.4}),
]


def turned(stones: cp.Assemblage, angle: float = 0.3) -> cp.Assemblage:
    """Return the stones turned about the upright axis and moved, as a drawing has them, without names of walls."""
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    shift = np.array([3.0, -5.0, 1.0])
    names = np.full(stones.count, "")
    return replace(stones, points=stones.points @ turn.T + shift, centroid=stones.centroid @ turn.T + shift, panel=names)


def check_match(stones: cp.Assemblage, fitted: FittedPanels, shell: cp.ShellModel) -> None:
    match = cp.match_models(replace(stones, panel=fitted.panel), cp.find_contacts(stones), shell)
    assert match.passed, [figure for figure in match.figures if not figure.passed]


@pytest.mark.parametrize(("build", "sizes"), CASES)
def test_the_shell_of_drawn_stones_is_that_of_the_generator(build: Callable[..., Building], sizes: dict[str, Any]) -> None:
    building = build(**sizes, materials=MATERIAL)
    stones = turned(cp.derive_blocks(building))
    fitted = fit_panels(stones)
    assert not fitted.panels
    assert not len(fitted.unfit)
    assert sum(vault.stone_count for vault in fitted.vaults) == (~stones.fixed).sum()
    made, drawn = cp.derive_shell(building, 0.3), cp.derive_shell(fitted.building(MATERIAL), 0.3)
    assert len(drawn.points) == len(made.points)
    assert np.sort(drawn.area) == pytest.approx(np.sort(made.area), rel=1e-6)
    assert np.sort(drawn.weight) == pytest.approx(np.sort(made.weight), rel=1e-6)
    check_match(stones, fitted, drawn)


@pytest.mark.parametrize(("build", "sizes"), OTHERS)
def test_keys_and_oculi_have_a_shell_that_matches(build: Callable[..., Building], sizes: dict[str, Any]) -> None:
    stones = turned(cp.derive_blocks(build(**sizes, materials=MATERIAL)))
    fitted = fit_panels(stones)
    assert fitted.vaults
    check_match(stones, fitted, cp.derive_shell(fitted.building(MATERIAL), 0.3))


@pytest.mark.parametrize("build", ["barrel", pytest.param("dome", marks=TABLE)])
def test_load_factors_are_those_of_the_generator(build: str) -> None:
    # Turned by 0.3 rad, both the stones and the push.
    building = vault(**BARREL, materials=MATERIAL) if build == "barrel" else dome(**DOME | {"laid": "lunes"}, materials=MATERIAL)
    stones = turned(cp.derive_blocks(building))
    drawn = cp.derive_shell(fit_panels(stones).building(MATERIAL), 0.3)
    push = cp.LoadCase((float(np.cos(0.3)), float(np.sin(0.3)), 0.0))
    expected = cp.shell_limit_analysis(cp.derive_shell(building, 0.3), cp.LoadCase((1, 0, 0)), MATERIAL).load_factor
    assert cp.shell_limit_analysis(drawn, push, MATERIAL).load_factor == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize(
    ("build", "kind"),
    [
        ("barrel", "obj-triangles"),
        ("dome", "dxf"),
        *(
            pytest.param(*case, marks=TABLE)
            for case in (("barrel", "dxf"), ("barrel", "obj"), ("dome", "obj"), ("dome", "obj-triangles"))
        ),
    ],
)
def test_a_file_of_stones_has_the_shell_of_a_vault(build: str, kind: str, tmp_path: Path) -> None:
    building = vault(**BARREL | WALLS, materials=MATERIAL) if build == "barrel" else dome(**DOME | DRUM, materials=MATERIAL)
    stones = cp.derive_blocks(building)
    path = write_dxf_drawing(stones, tmp_path) if kind == "dxf" else WRITERS[kind](stones, tmp_path)
    read, _ = cp.read_stones(path, units="m", support="base")
    materials = tuple(cp.UnitWeight(name, 18e3) for name in np.unique(read.material[~read.fixed]))
    drawn = cp.derive_shell(fit_panels(read).building(materials), 0.3)
    made = cp.derive_shell(building, 0.3)
    assert len(drawn.points) == len(made.points)
    assert drawn.area.sum() == pytest.approx(made.area.sum(), rel=1e-6)


def test_an_arch_on_piers_is_no_vault() -> None:
    sizes: dict[str, Any] = {"course": 0.25, "stone_length": 0.5, "span": 2.0, "springing": 1.5, "pier_width": 1.0}
    stones = cp.derive_blocks(arch_piers(**sizes, thickness=0.5, height=3.25, voussoirs=11, depth=0.4, materials=MATERIAL))
    assert not fit_panels(stones).vaults


def test_a_groin_vault_is_not_taken_for_walls() -> None:
    stones = cp.derive_blocks(vault(span=1.85, thickness=0.15, courses=9, kind="groin", stone_length=0.5, materials=MATERIAL))
    with pytest.raises(InputError):
        fit_panels(turned(stones))
