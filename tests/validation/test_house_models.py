"""Houses against the same walls from other generators, whose load factors are validated, and against a closed form.

Sources: the tilting test S22 (Malena et al. 2019, section 4.1) with our .2065; the toothed facade of docs/walls.md; the sample
box of docs/validation.md; a wall that turns about the edge of its foot at thickness / height, by moments.
"""

from typing import Any

import numpy as np
import pytest

import churchpipe as cp
from churchpipe import generators
from facades import EAVES, FRICTION, RIDGE, THICKNESS, WIDTH, facade_building
from manual_pages import ROOT
from models import DRY_STONE, S22

MATERIALS = (cp.Material("default", 18e3, FRICTION),)


def load_factor(building: cp.Building, load: cp.LoadCase, friction: float = FRICTION) -> float:
    stones = cp.derive_blocks(building)
    state = cp.limit_analysis(stones, cp.find_contacts(stones), load, friction)
    assert state.status == "optimal"
    assert state.upper_bound - state.lower_bound < 1e-6
    return state.load_factor


def check_the_same(one: cp.Building, other: cp.Building) -> None:
    """Compare the stones of two buildings: their places, walls and materials, in the same order."""
    found, expected = cp.derive_blocks(one), cp.derive_blocks(other)
    np.testing.assert_allclose(found.points, expected.points, rtol=0, atol=1e-9)
    assert found.panel.tolist() == expected.panel.tolist()
    np.testing.assert_array_equal(found.course, expected.course)


def test_the_tilting_test_s22_as_a_house() -> None:
    # Three partitions behind a main wall, each with a door: T-junctions and corners in bricks of 80 x 40 x 30 mm.
    walls = [{"name": "main", "start": (0, 0), "end": (1.12, 0), "toward": "+y"}]
    walls += [
        {"name": f"partition-{number}", "start": (left, 0), "end": (left, 0.84), "toward": "+x"}
        for number, left in enumerate(S22["partitions_x"], start=1)
    ]
    doors = {
        "name": "door",
        "wall": [wall["name"] for wall in walls[1:]],
        "centre": 0.2,
        "width": 0.16,
        "height": 15 * 0.03,
        "lintel_bearing": 0.04,
    }
    laid: dict[str, Any] = {"course": 0.03, "stone_length": 0.08, "height": 21 * 0.03, "thickness": 0.04, "joints": "grid"}
    house = generators.house(**laid, walls=walls, openings=[doors], materials=DRY_STONE)
    check_the_same(house, generators.prototype(**S22, materials=DRY_STONE))
    assert load_factor(house, cp.LoadCase((0, -1, 0)), 0.7) == pytest.approx(0.2065, abs=5e-5)


def test_the_facade_of_the_table_as_a_house() -> None:
    side = WIDTH / 2 - THICKNESS / 2
    walls: list[dict[str, Any]] = [
        {"name": "facade", "start": (-side, 0), "end": (side, 0), "ridge": RIDGE},
        {"name": "nave_left", "start": (-side, 0), "end": (-side, 3.0)},
        {"name": "nave_right", "start": (side, 0), "end": (side, 3.0)},
    ]
    house = generators.house(course=0.5, stone_length=1.0, height=EAVES, thickness=THICKNESS, walls=walls)
    check_the_same(house, facade_building())
    assert load_factor(house, cp.LoadCase((0, -1, 0), panels=("facade",))) == pytest.approx(0.486, abs=5e-4)


def test_the_sample_box_as_a_house() -> None:
    walls = [
        {"name": "south", "start": (0, 0), "end": (4, 0), "toward": "+y"},
        {"name": "north", "start": (0, 3), "end": (4, 3), "toward": "-y"},
        {"name": "west", "start": (0, 0), "end": (0, 3), "toward": "+x"},
        {"name": "east", "start": (4, 0), "end": (4, 3), "toward": "-x"},
    ]
    door = {"name": "door", "wall": ["south", "north"], "centre": 2.0, "width": 1.0, "height": 2.0}
    laid: dict[str, Any] = {"course": 0.25, "stone_length": 0.5, "height": 3.0, "thickness": 0.3, "joints": "grid"}
    house = generators.house(**laid, walls=walls, openings=[door], materials=MATERIALS)
    assert load_factor(house, cp.LoadCase((1, 0, 0))) == pytest.approx(0.30353, abs=5e-6)


@pytest.mark.slow("docs/house.md: load factors of the ready house")
def test_the_ready_house_of_the_manual() -> None:
    case = cp.read_case(ROOT / "pipeline" / "cases" / "house.toml")
    stones = cp.derive_blocks(case.building())
    contacts = cp.find_contacts(stones)
    assert int((~stones.fixed).sum()) == 943
    found = {
        load.name: cp.limit_analysis(stones, contacts, cp.loaded(load, stones, case.carries.area_loads), FRICTION).load_factor
        for load in case.loads
    }
    assert min(found, key=found.__getitem__) == "-x"
    assert found["-x"] == pytest.approx(0.217, abs=5e-4)
    assert found["-y"] == pytest.approx(0.389, abs=5e-4)


@pytest.mark.parametrize("bearing", [None, 0.5])
def test_a_wall_with_windows_turns_about_the_edge_of_its_foot(bearing: float | None) -> None:
    # Two storeys of two windows: the height of the centroid by moments of the whole less theirs.
    windows = {"name": "w", "wall": "a", "centre": [2.0, 5.0], "width": 1.0, "sill": [1.0, 4.0], "height": 1.0}
    wall = {"name": "a", "start": (0, 0), "end": (7, 0)}
    given = {"course": 0.25, "stone_length": 0.5, "height": 6.0, "thickness": 0.4}
    house = generators.house(**given, walls=[wall], openings=[windows | {"lintel_bearing": bearing}], materials=MATERIALS)
    area, moment = 7 * 6.0 - 4 * 1.0, 7 * 6.0 * 3.0 - 2 * (1.5 + 4.5)
    height = moment / area
    assert load_factor(house, cp.LoadCase((0, 1, 0))) == pytest.approx(0.2 / height, abs=1e-6)
