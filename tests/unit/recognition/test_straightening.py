"""Walls that meet, turned in plan and with rounded coordinates, have the shell of the same walls along x and y."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.config.case import read_case
from churchpipe.config.shell_table import shell_table
from churchpipe.dxf.reader import read_drawing
from churchpipe.dxf.writer import write_dxf
from churchpipe.generators import apse, box, house, prototype, tower, wall
from churchpipe.match import Match, match_models
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import Building
from churchpipe.model.shell import ShellModel
from churchpipe.recognition.panels import fit_panels
from churchpipe.recognition.stone_walls import stone_walls
from churchpipe.recognition.straightening import straightened
from churchpipe.resources import pipeline_folder
from churchpipe.stones.blocks import derive_blocks
from solids import moved, on_ground

TUFF = cp.Material("default", 18e3, 0.6)
BRICK = (0.5, 0.25, 0.25)
# No length of a wall is a multiple of it, so that rounding does not decide how many elements there are.
SIZE = 0.45
ROUND: dict[str, Any] = {"shape": "round", "voussoirs": 9, "depth": 0.25}
# How far corners may be moved in files with so many digits of a metre: by twice what they are rounded to, where two lines lie as
# near to one another as that.
ROUNDED = {5: 2e-5, 4: 2e-4, 3: 2e-3}
TURNED = pytest.mark.slow("docs/limits.md: walls that meet, turned in plan")


def opening(start: float, width: float, sill: int, height: int) -> dict[str, float]:
    return {"start": start, "width": width, "sill_courses": sill, "height_courses": height, "lintel_bearing": 0.25}


def crossed(width: float) -> Building:
    """Four walls and a cross wall with doors and windows."""
    walls: list[dict[str, Any]] = [
        {"name": "south", "start": (0, 0), "end": (6, 0), "toward": "+y"},
        {"name": "north", "start": (0, width), "end": (6, width), "toward": "-y"},
        {"name": "west", "start": (0, 0), "end": (0, width), "toward": "+x"},
        {"name": "east", "start": (6, 0), "end": (6, width), "toward": "-x"},
        {"name": "inner", "start": (3.4, 0), "end": (3.4, width)},
    ]
    openings = [
        {"name": "w", "wall": ["south", "north"], "centre": [1.6, 4.8], "width": 0.8, "height": 1.0, "sill": 0.8},
        {"name": "d", "wall": ["inner", "west"], "centre": 2.0, "width": 0.8, "height": 1.8},
    ]
    laid: dict[str, Any] = {"course": 0.2, "stone_length": 0.4, "height": 2.4, "thickness": 0.2}
    return house(**laid, walls=walls, openings=openings, materials=(TUFF,))


PLANS: dict[str, Callable[[], Building]] = {
    "L": lambda: prototype(
        brick=BRICK, partitions_x=[0.0], partition_length=3.0, courses=10, main_wall_length=4.0, materials=(TUFF,)
    ),
    "T": lambda: prototype(
        brick=BRICK,
        partitions_x=[2.0],
        partition_length=3.0,
        courses=10,
        main_wall_length=4.0,
        opening=opening(1.25, 0.75, 0, 7),
        materials=(TUFF,),
    ),
    "box": lambda: box(
        length=4.0,
        width=3.0,
        courses=10,
        brick=BRICK,
        openings_x=[opening(1.0, 0.75, 3, 4), opening(2.5, 0.5, 0, 7)],
        openings_y=[opening(1.25, 0.5, 3, 4)],
        materials=(TUFF,),
    ),
    "box with a cross wall": lambda: crossed(4.0),
    "gable with arches": lambda: house(
        course=0.25,
        stone_length=0.5,
        height=3.5,
        thickness=0.4,
        walls=[
            {"name": "south", "start": (0, 0), "end": (6, 0), "toward": "+y", "ridge": 5.0},
            {"name": "west", "start": (0, 0), "end": (0, 4), "toward": "+x"},
            {"name": "east", "start": (6, 0), "end": (6, 4), "toward": "-x", "thickness": 0.5},
        ],
        openings=[{"name": "w", "wall": "south", "centre": [1.7, 4.3], "width": 0.8, "height": 1.4, "sill": 1.0} | ROUND],
        materials=(TUFF,),
    ),
    "wall with an apse": lambda: apse(
        course=0.25,
        stone_length=0.5,
        inner_radius=1.25,
        thickness=0.75,
        height=2.0,
        wall_length=5.5,
        wall_thickness=0.5,
        wall_height=3.0,
        materials=(TUFF,),
    ),
    "wall as wide as its apse": lambda: apse(
        course=0.25,
        stone_length=0.5,
        inner_radius=1.3,
        thickness=0.5,
        height=2.0,
        wall_length=3.6,
        wall_thickness=0.6,
        wall_height=2.5,
        materials=(TUFF,),
    ),
}
# Their rounding shows along the axes as well, where that of plane walls does not.
ROUND_PLANS = [name for name in PLANS if "apse" in name]


@cache
def laid(plan: str) -> Assemblage:
    return derive_blocks(PLANS[plan]())


def turned(stones: Assemblage, degrees: float, digits: int | None, at: Sequence[float] = (43.21, -17.6)) -> Assemblage:
    """Stones turned in plan, away from the origin, as a file with so many digits has them."""
    turn = np.radians(degrees)
    rotation = np.array([[np.cos(turn), -np.sin(turn), 0.0], [np.sin(turn), np.cos(turn), 0.0], [0.0, 0.0, 1.0]])
    found = moved(stones, rotation, np.array([*at, 0.0]))
    if digits is not None:
        bodies = [(np.round(points, digits), faces) for points, faces in map(found.solid, range(found.count))]
        # As files are read: a face that rounding has bent is split.
        bodies, _ = cp.repair_polyhedra(bodies)
        found = Assemblage.from_polyhedra(bodies, found.unit_weight, np.flatnonzero(found.fixed).tolist())
    return replace(found, panel=stones.panel)


def fitted_shell(stones: Assemblage) -> tuple[ShellModel, Match, dict[str, float]]:
    fitted = fit_panels(stones)
    assert not len(fitted.unfit)
    shell = cp.derive_shell(fitted.building(), SIZE)
    return shell, match_models(fitted.stones, cp.find_contacts(fitted.stones), shell), dict(fitted.moved)


def limit_load(shell: ShellModel, degrees: float) -> float:
    """Return the load factor of a push askew to the walls."""
    turn = np.radians(degrees) + 0.9
    return cp.shell_limit_analysis(shell, cp.LoadCase((np.cos(turn), np.sin(turn), 0.0)), [TUFF]).load_factor


@cache
def exact(plan: str) -> ShellModel:
    return fitted_shell(laid(plan))[0]


@pytest.mark.parametrize(
    ("plan", "degrees", "digits"),
    [
        pytest.param(plan, degrees, digits, marks=() if (degrees, digits) == (33.0, 4) else TURNED)
        for plan in PLANS
        for degrees in (17.0, 33.0)
        for digits in (5, 4)
    ],
)
def test_turned_rounded_walls_have_the_shell_of_those_along_the_axes(plan, degrees, digits) -> None:
    check_turned(plan, degrees, digits)


@pytest.mark.parametrize(
    ("plan", "degrees"),
    [
        ("L", 61.0),
        ("T", 33.0),
        ("wall as wide as its apse", 17.0),
        *(pytest.param(plan, degrees, marks=TURNED) for plan in PLANS for degrees in (17.0, 33.0, 61.0)),
    ],
)
def test_walls_rounded_to_a_millimetre_have_the_shell_of_those_along_the_axes(plan, degrees) -> None:
    check_turned(plan, degrees, 3)


@pytest.mark.parametrize(("courses", "number", "degrees", "digits"), [(12.0, 17, 0.0, 4), (14.0, 22, 17.0, 3), (3.7, 8, 17.0, 3)])
def test_courses_line_up_whose_height_has_more_digits_than_the_file(courses, number, degrees, digits) -> None:
    """So many courses a metre, one wall three courses lower than the other."""
    walls: list[dict[str, Any]] = [
        {"name": "south", "start": (0, 0), "end": (3, 0), "toward": "+y"},
        {"name": "west", "start": (0, 0), "end": (0, 2.5), "toward": "+x", "height": (number - 3) / courses},
    ]
    sizes = {"course": 1 / courses, "stone_length": 0.3, "height": number / courses, "thickness": 0.25}
    stones = derive_blocks(house(walls=walls, materials=(TUFF,), **sizes))
    shell, match, _ = fitted_shell(turned(stones, degrees, digits))
    assert match.passed, [figure for figure in match.figures if not figure.passed]
    (course,) = np.unique(shell.unit_cells[:, 0])
    # The top is rounded as well, by half a digit.
    assert course == pytest.approx(1 / courses, abs=10.0**-digits / (number - 3))


def check_turned(plan: str, degrees: float, digits: int) -> None:
    expected = exact(plan)
    shell, match, by = fitted_shell(turned(laid(plan), degrees, digits))
    assert match.passed, [figure for figure in match.figures if not figure.passed]
    # Thickness and length of a wall are known as well as its faces are on average.
    near = max(1e-4, 0.5 * 10.0**-digits)
    assert shell.weight.sum() == pytest.approx(expected.weight.sum(), rel=near)
    assert shell.area.sum() == pytest.approx(expected.area.sum(), rel=near)
    assert set(by) == set(laid(plan).panel[~laid(plan).fixed])
    assert 0.1 * ROUNDED[digits] < max(by.values()) < ROUNDED[digits]


@pytest.mark.parametrize("at", [(0.0, 0.0), (43.21, -17.6)])
@pytest.mark.parametrize("digits", [5, 4, 3])
@pytest.mark.parametrize("plan", ROUND_PLANS)
def test_rounded_walls_that_meet_a_round_one_along_the_axes_have_their_shell(plan, digits, at) -> None:
    expected = exact(plan)
    shell, match, by = fitted_shell(turned(laid(plan), 0.0, digits, at))
    assert match.passed, [figure for figure in match.figures if not figure.passed]
    near = max(1e-4, 0.5 * 10.0**-digits)
    assert shell.weight.sum() == pytest.approx(expected.weight.sum(), rel=near)
    assert shell.area.sum() == pytest.approx(expected.area.sum(), rel=near)
    assert set(by) <= {"wall", "apse"}
    assert 0.1 * ROUNDED[digits] < by["apse"] < ROUNDED[digits]


@pytest.mark.slow
@pytest.mark.parametrize(("degrees", "digits"), [(61.0, 5), (128.7, 4)])
def test_walls_of_several_lengths_have_their_shell_at_other_angles(degrees, digits) -> None:
    walls: list[dict[str, Any]] = [
        {"name": "front", "start": (0, 0), "end": (7.3, 0), "toward": "+y"},
        {"name": "back", "start": (2.1, 3.7), "end": (7.3, 3.7), "toward": "-y"},
        {"name": "a", "start": (0, 0), "end": (0, 2.9), "toward": "+x"},
        {"name": "b", "start": (2.1, 0), "end": (2.1, 3.7), "toward": "+x"},
        {"name": "c", "start": (7.3, 0), "end": (7.3, 3.7), "toward": "-x"},
    ]
    openings = [
        {"name": "w", "wall": ["front", "back"], "centre": 4.7, "width": 0.9, "height": 1.1, "sill": 0.88},
        {"name": "d", "wall": "b", "centre": 2.0, "width": 0.9, "height": 1.98},
    ]
    laid: dict[str, Any] = {"course": 0.22, "stone_length": 0.45, "height": 2.64, "thickness": 0.3, "joints": "grid"}
    stones = derive_blocks(house(**laid, walls=walls, openings=openings, materials=(TUFF,)))
    shell, match, _ = fitted_shell(turned(stones, degrees, digits))
    assert match.passed, [figure for figure in match.figures if not figure.passed]
    assert shell.weight.sum() == pytest.approx(stones.weight.sum(), rel=1e-4)


@TURNED
@pytest.mark.parametrize(
    ("plan", "degrees", "digits"),
    [
        ("T", 17.0, 4),
        ("T", 33.0, 3),
        ("box", 17.0, 3),
        ("wall with an apse", 61.0, 3),
        ("L", 17.0, 5),
        ("box", 33.0, 4),
        ("box with a cross wall", 33.0, 4),
        ("wall with an apse", 17.0, 4),
        ("wall with an apse", 0.0, 5),
        ("wall as wide as its apse", 33.0, 4),
    ],
)
def test_their_limit_load_is_that_of_those_along_the_axes(plan, degrees, digits) -> None:
    shell, _, _ = fitted_shell(turned(laid(plan), degrees, digits))
    assert limit_load(shell, degrees) == pytest.approx(limit_load(exact(plan), 0.0), rel=0.01)


@TURNED
@pytest.mark.parametrize(("degrees", "digits"), [(17, 4), (33, 4), (61, 4), (17, 3), (33, 3), (61, 3)])
def test_the_church_has_its_shell_turned_and_rounded(degrees: float, digits: int) -> None:
    exact_stones = derive_blocks(read_case(pipeline_folder() / "cases" / "church.toml").building())
    fitted = fit_panels(turned(exact_stones, degrees, digits))
    assert not len(fitted.unfit)
    assert 10.0**-digits < max(fitted.moved.values()) < 4 * 10.0**-digits
    # Slopes of gables that rounding bends are straight: a corner for each stone led to a facet without an area.
    corners, known = ([len(panel.outline) for panel in found.panels] for found in (fitted, fit_panels(exact_stones)))
    assert corners == known
    openings, drawn = (sum(len(panel.openings) for panel in found.panels) for found in (fitted, fit_panels(exact_stones)))
    assert openings == drawn
    match = match_models(fitted.stones, cp.find_contacts(fitted.stones), cp.derive_shell(fitted.building(), 0.6))
    assert match.passed


@TURNED
def test_the_church_has_its_shell_along_the_axes_rounded_to_a_millimetre() -> None:
    """The sides of stones of its apse are ragged, which are few of all."""
    exact_stones = derive_blocks(read_case(pipeline_folder() / "cases" / "church.toml").building())
    fitted = fit_panels(turned(exact_stones, 0.0, 3))
    assert not len(fitted.unfit)
    assert 0.1 * ROUNDED[3] < fitted.moved["apse"] < ROUNDED[3]
    assert max(fitted.moved.values()) < ROUNDED[3]
    match = match_models(fitted.stones, cp.find_contacts(fitted.stones), cp.derive_shell(fitted.building(), 0.6))
    assert match.passed


@pytest.mark.parametrize("plan", ["box", "wall with an apse"])
@pytest.mark.parametrize("degrees", [0.0, 33.0])
def test_exact_coordinates_stay(plan, degrees) -> None:
    stones = turned(laid(plan), degrees, None)
    walls, unfit = stone_walls(stones, 1e-3)
    same, by = straightened(stones, walls, unfit)
    assert same is stones
    assert not by.any()
    assert fitted_shell(stones)[2] == {}


def test_a_drawing_in_millimetres_with_one_decimal_says_what_was_moved(tmp_path: Path) -> None:
    write_dxf(turned(laid("box"), 17.0, 4, at=(0.0, 0.0)), tmp_path / "box.dxf", units="mm")
    stones = read_drawing(tmp_path / "box.dxf").stones
    table = shell_table(stones, {"default": False})
    assert table.fitted
    most = max(table.fitted.moved.values())
    assert f"stones were moved into line and walls to meet squarely, by {1e3 * most:.2g} mm at most" in table.note
    # The stones of the match gate are those of the drawing.
    np.testing.assert_array_equal(table.fitted.stones.points, stones.points)


@pytest.mark.parametrize("degrees", [17.0, 33.0])
def test_walls_rounded_to_a_centimetre_are_refused_and_told_why(degrees: float) -> None:
    with pytest.raises(cp.InputError, match="too ragged") as error:
        fit_panels(turned(laid("L"), degrees, 2))
    assert str(error.value.expected).startswith("corners less than 2")
    assert error.value.remedy.startswith("Export the drawing with more digits, or with its walls along x and y")


def test_walls_askew_to_one_another_are_straightened_each_along_itself() -> None:
    one = derive_blocks(wall(length=3.0, brick=BRICK, courses=6, materials=(TUFF,)))
    both = [turned(one, degrees, 4, at) for degrees, at in ((17.0, (0.0, 0.0)), (50.0, (6.0, 0.0)))]
    solids = [stones.solid(k) for stones in both for k in np.flatnonzero(~stones.fixed)]
    stones = on_ground(*solids)
    walls, unfit = stone_walls(stones, 1e-3)
    straight, by = straightened(stones, walls, unfit)
    assert 0 < by.max() < ROUNDED[4]
    for found in stone_walls(straight, 1e-3)[0]:
        count = len(np.unique(np.round(np.concatenate([np.asarray(p.exterior.coords)[:, 0] for p in found.elevations]), 7)))
        # Places of the head joints of both courses and the two ends.
        assert count == 13


def test_a_stone_that_would_lose_a_face_stays() -> None:
    """A stone with a step of an eighth of a millimetre, which on the line of the others would be none."""
    one = derive_blocks(wall(length=3.0, brick=BRICK, courses=6, materials=(TUFF,)))
    step = 1.2e-4
    outline = [(3.0, 0.0), (3.5, 0.0), (3.5, 0.2), (3.5 + step, 0.2), (3.5 + step, 0.25), (3.0, 0.25)]
    points = np.array([[x, y, z] for y in (0.0, 0.25) for x, z in outline])
    faces = [[*range(6)], [*range(11, 5, -1)], *([i, i + 6, (i + 1) % 6 + 6, (i + 1) % 6] for i in range(6))]
    solids = [one.solid(k) for k in np.flatnonzero(~one.fixed)]
    stones = turned(on_ground(*solids, (points, faces)), 17.0, 4, at=(0.0, 0.0))
    walls, unfit = stone_walls(stones, 1e-3)
    _, by = straightened(stones, walls, unfit)
    assert by[-1] == 0
    assert by[1:-1].max() > 0


@pytest.mark.slow
@pytest.mark.parametrize("degrees", [0.0, 17.0])
@pytest.mark.parametrize("digits", [5, 4])
def test_a_round_wall_has_its_shell_in_rounded_coordinates(degrees, digits) -> None:
    """The last stone lies on both sides of the seam of its chart, where it is two pieces."""
    laid = derive_blocks(
        tower(course=0.25, stone_length=0.5, width=4.0, height=3.0, thickness=0.5, plan="round", materials=(TUFF,))
    )
    shell, match, by = fitted_shell(turned(laid, degrees, digits, at=(0.0, 0.0)))
    assert match.passed
    assert shell.weight.sum() == pytest.approx(laid.weight.sum(), rel=1e-4)
    assert 0 < max(by.values()) < ROUNDED[digits]


def test_grounds_are_not_moved() -> None:
    stones = turned(laid("L"), 17.0, 4)
    walls, unfit = stone_walls(stones, 1e-3)
    _, by = straightened(stones, walls, unfit)
    assert stones.fixed.any()
    assert not by[stones.fixed].any()
