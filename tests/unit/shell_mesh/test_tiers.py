"""Shells of walls that stand on thicker ones: tiers with mid-planes of their own, each foot on the tops below."""

from typing import Any

import numpy as np
import pytest

import churchpipe as cp
from churchpipe import generators
from churchpipe.errors import InputError
from churchpipe.recognition.panels import fit_panels
from churchpipe.shell_mesh.tiers import tier_levels, tiers
from shell_meshes import check_follows_rigid_motions

MATERIALS = (cp.Material("default", 18e3, 0.6),)
THIN: dict[str, Any] = {"storeys": [{"above": 3.0, "thickness": 0.45}]}
LATER: dict[str, Any] = {"storeys": [{"above": 3.6, "thickness": 0.4}]}
WINDOW = {"name": "w", "wall": ["south", "north"], "centre": [2.5, 7.0], "width": 0.9, "sill": [0.9, 3.9], "height": 1.2}
STAIR = {"name": "stair", "wall": "inner", "centre": 2.0, "width": 0.9, "sill": 1.5, "height": 3.0}


def house(*, flush: bool = True, openings: Any = (WINDOW, STAIR), **given: Any) -> cp.Building:
    walls: list[dict[str, Any]] = [
        {"name": "south", "start": (0, 0), "end": (9, 0), "toward": "+y"} | THIN,
        {"name": "north", "start": (0, 7), "end": (9, 7), "toward": "-y"} | THIN,
        {"name": "west", "start": (0, 0), "end": (0, 7), "toward": "+x", "ridge": 8.1} | THIN,
        {"name": "east", "start": (9, 0), "end": (9, 7), "toward": "-x", "ridge": 8.1} | LATER,
        {"name": "inner", "start": (5, 0), "end": (5, 7), "thickness": 0.3},
    ]
    walls = [wall if flush else {key: value for key, value in wall.items() if key != "toward"} for wall in walls]
    laid = {"course": 0.3, "stone_length": 0.75, "height": 6.0, "thickness": 0.6, "materials": MATERIALS}
    return generators.house(**laid | given, walls=walls, openings=openings)


def check_match(building: cp.Building, stones: cp.Assemblage) -> cp.ShellModel:
    shell = cp.derive_shell(building, 1.0)
    match = cp.match_models(stones, cp.find_contacts(stones), shell)
    assert match.passed, [figure for figure in match.figures if not figure.passed]
    return shell


@pytest.mark.parametrize("flush", [True, False])
def test_a_house_with_thinner_storeys_passes_the_gate(flush: bool) -> None:
    building = house(flush=flush)
    stones = cp.derive_blocks(building)
    shell = check_match(building, stones)
    assert shell.weight.sum() == pytest.approx(stones.weight[~stones.fixed].sum(), rel=1e-6)
    for name, thickness in (("south", 0.6), ("south storey 2", 0.45), ("inner", 0.3)):
        np.testing.assert_allclose(shell.thickness[shell.panel == name], thickness)
    # The mid-plane of the facade moves where its outer face is flush.
    for name, y in (("south", 0.3 if flush else 0.0), ("south storey 2", 0.225 if flush else 0.0)):
        np.testing.assert_allclose(shell.points[shell.triangles[shell.panel == name], 1], y, atol=1e-9)


@pytest.mark.parametrize("flush", [True, False])
def test_feet_follow_every_rigid_motion_of_what_they_stand_on(flush: bool) -> None:
    check_follows_rigid_motions(cp.derive_shell(house(flush=flush), 1.0), seed=1)


def test_all_of_a_foot_stands_on_the_wall_below() -> None:
    # But over the opening of the inner wall, which is no thinner and has it through the heights at which the others are.
    shell = cp.derive_shell(house(), 1.0)
    foot = shell.points[shell.ledges[:, 0]]
    length = np.linalg.norm(foot[:, 1] - foot[:, 0], axis=1)
    # Between mid-planes, the east wall 0.6 m thick at 3 m and 0.4 m at 3.6 m.
    for level, east in ((3.0, 0.3), (3.6, 0.2)):
        expected = 2 * (9 - 0.225 - east) + 3 * (7 - 0.45) - STAIR["width"]
        assert length[np.abs(foot[:, 0, 2] - level) < 1e-9].sum() == pytest.approx(expected, abs=1e-6)


def test_tiers_hold_what_is_between_their_heights() -> None:
    building = house(junctions=[{"walls": ["south", "inner"]}])
    levels = tier_levels(building.panels)
    assert levels == pytest.approx([3.0, 3.6])
    below, between, above = tiers(building, levels)
    assert [panel.name for panel in below.panels] == ["south", "north", "west", "east", "inner"]
    thinner = ["south storey 2", "north storey 2", "west storey 2"]
    assert [panel.name for panel in between.panels] == [*thinner, "east", "inner"]
    assert [panel.name for panel in above.panels] == [*thinner, "east storey 2", "inner"]
    assert [junction.walls[0] for tier in (below, between, above) for junction in tier.junctions] == [
        "south",
        "south storey 2",
        "south storey 2",
    ]
    heights = [np.ptp(panel.outline[:, 1]) for panel in between.panels]
    np.testing.assert_allclose(heights, 0.6)
    check_match(building, cp.derive_blocks(building))


def test_other_walls_have_no_tiers() -> None:
    assert tier_levels(cp.read_case("pipeline/cases/tower.toml").laid().panels) == []
    assert tier_levels(house().panels[:1]) == []


def test_an_arch_across_the_height_of_a_storey_has_no_shell() -> None:
    arch = {"name": "arch", "wall": "inner", "centre": 3.5, "width": 1.2, "sill": 1.5, "height": 1.5}
    arch |= {"shape": "segmental", "rise": 0.2, "voussoirs": 7, "depth": 0.3}
    building = house(openings=[arch])
    cp.derive_blocks(building)
    with pytest.raises(InputError, match=r"shell of inner: an arch at the height where a wall .*; found arch-ring from"):
        cp.derive_shell(building, 1.0)


@pytest.mark.slow
@pytest.mark.parametrize("flush", [True, pytest.param(False, marks=pytest.mark.slow("docs/house.md: storeys in a drawing"))])
def test_stones_of_a_drawing_have_the_same_walls(flush: bool) -> None:
    building = house(flush=flush, openings=[WINDOW])
    fitted = fit_panels(cp.derive_blocks(building))
    assert not len(fitted.unfit)
    found = {panel.name: panel.thickness for panel in fitted.panels}
    assert found == pytest.approx({panel.name: panel.thickness for panel in building.panels})
    check_match(fitted.building(MATERIALS), fitted.stones)
