"""The shell of walls in any bond against their rigid blocks: docs/shell_results.md, "Walls and boxes of several bonds"."""

from typing import Literal

import pytest

from churchpipe.generators import box, wall
from churchpipe.generators.house import house
from churchpipe.homogenised_shell.limit import shell_limit_analysis
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import Material
from churchpipe.rigid_blocks.limit import limit_analysis
from churchpipe.shell_mesh.shell import derive_shell
from churchpipe.stones.blocks import derive_blocks
from churchpipe.stones.contacts import find_contacts

BOX = pytest.mark.slow("docs/shell_results.md: Walls and boxes of several bonds")
STONE = (Material("default", 18e3, 0.6),)
OUT, ALONG = (0, 1, 0), (1, 0, 0)
# The wall of docs/validation.md: 1.5 x 3.9 m, .5 m thick, ten courses. The rigid blocks carry .07640 without headers, .12253 in
# English and .12537 in Flemish bond, a loose leaf h / 2H = .0641 and a whole wall h / H = .1282.
HEIGHT, THICKNESS = 3.9, 0.5


def load_factor(direction: tuple[int, int, int], **bond: str) -> float:
    thickness = THICKNESS / 2 if bond.get("pattern") == "header-stretcher" else THICKNESS
    building = wall(
        brick=(0.5, thickness, HEIGHT / 10), length=1.5, courses=10, thickness=THICKNESS, joints="bay", materials=STONE, **bond
    )
    state = shell_limit_analysis(derive_shell(building, element_size=0.15), LoadCase(direction), STONE)
    assert state.status == "optimal"
    return state.load_factor


@pytest.mark.slow
def test_leaves_that_nothing_ties_stand_each_for_itself() -> None:
    assert load_factor(OUT, pattern="header-stretcher", headers="none") == pytest.approx(0.5 * THICKNESS / HEIGHT, rel=1e-6)


def test_running_bond_is_as_strong_as_the_whole_wall() -> None:
    assert load_factor(OUT) == pytest.approx(THICKNESS / HEIGHT, rel=1e-6)


@pytest.mark.slow("docs/shell_results.md: Walls and boxes of several bonds")
@pytest.mark.parametrize(
    ("headers", "out", "along"), [("english", 0.12821, 0.26193), ("flemish", 0.12821, 0.27955), ("none", 0.06410, 0.26193)]
)
def test_leaves_with_and_without_headers(headers: str, out: float, along: float) -> None:
    assert load_factor(OUT, pattern="header-stretcher", headers=headers) == pytest.approx(out, abs=2e-5)
    assert load_factor(ALONG, pattern="header-stretcher", headers=headers) == pytest.approx(along, abs=2e-5)


@BOX
@pytest.mark.parametrize(("headers", "expected"), [("english", 0.33758), ("flemish", 0.38385), ("none", 0.26442)])
def test_a_box_of_two_leaves(headers: Literal["english", "flemish", "none"], expected: float) -> None:
    building = box(
        brick=(0.5, 0.25, 0.25),
        length=4.0,
        width=3.0,
        courses=12,
        thickness=THICKNESS,
        pattern="header-stretcher",
        headers=headers,
        joints="bay",
        materials=STONE,
    )
    state = shell_limit_analysis(derive_shell(building, element_size=0.6), LoadCase(ALONG), STONE)
    assert state.status == "optimal"
    assert state.load_factor == pytest.approx(expected, abs=2e-5)


def test_columns_of_a_stack_between_cross_walls_fall_each_for_itself() -> None:
    """Our own figures of docs/limits.md: a front of 4 x 3 m, .25 m thick, on cross walls of 2 m.

    Without dilatancy columns of stones step out beside each other, each at b / h. A shell bends there, but has no steps.
    """
    cross = [{"name": name, "start": (x, 0.0), "end": (x, 2.0)} for name, x in (("left", 0.125), ("right", 3.875))]
    building = house(
        course=0.25,
        stone_length=0.5,
        height=3.0,
        thickness=0.25,
        walls=[{"name": "front", "start": (0.0, 0.0), "end": (4.0, 0.0)}, *cross],
        bonds=[{"wall": "front", "pattern": "stack"}],
        materials=STONE,
    )
    stones, push = derive_blocks(building), LoadCase((0, -1, 0))
    contacts = find_contacts(stones)
    sliding = limit_analysis(stones, contacts, push, 0.6, flow="non-associative")
    assert sliding.load_factor == pytest.approx(0.25 / 3, rel=1e-4)
    associative = limit_analysis(stones, contacts, push, 0.6)
    shell = shell_limit_analysis(derive_shell(building, element_size=0.5), push, STONE)
    assert (associative.load_factor, shell.load_factor) == (pytest.approx(0.157, abs=5e-4), pytest.approx(0.212, abs=5e-4))
