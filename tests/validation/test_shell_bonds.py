"""The shell of walls in any bond against their rigid blocks: docs/shell_results.md, "Walls and boxes of several bonds"."""

from typing import Literal

import pytest

from churchpipe.generators import box, wall
from churchpipe.homogenised_shell.limit import shell_limit_analysis
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import Material
from churchpipe.shell_mesh.shell import derive_shell

BOX = pytest.mark.slow("docs/shell_results.md: Walls and boxes of several bonds")
STONE = (Material("default", 18e3, 0.6),)
OUT, ALONG = (0, 1, 0), (1, 0, 0)
# The wall of docs/validation.md: 1.5 x 3.9 m, .5 m thick, ten courses. The rigid blocks carry .07640 without headers, .12253 in
# English and .12537 in Flemish bond, a loose leaf h / 2H = .0641 and a whole wall h / H = .1282. A mesh of .15 m is 4.5 % too
# strong out of the plane, in every bond alike; it converges from above.
HEIGHT, THICKNESS, MESH = 3.9, 0.5, 1.045


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
    assert load_factor(OUT, pattern="header-stretcher", headers="none") == pytest.approx(
        0.5 * THICKNESS / HEIGHT * MESH, rel=0.01
    )


def test_running_bond_is_as_strong_as_the_whole_wall() -> None:
    assert load_factor(OUT) == pytest.approx(THICKNESS / HEIGHT * MESH, rel=0.01)


@pytest.mark.slow("docs/shell_results.md: Walls and boxes of several bonds")
@pytest.mark.parametrize(
    ("headers", "out", "along"), [("english", 0.13380, 0.26193), ("flemish", 0.13418, 0.27955), ("none", 0.06724, 0.26193)]
)
def test_leaves_with_and_without_headers(headers: str, out: float, along: float) -> None:
    assert load_factor(OUT, pattern="header-stretcher", headers=headers) == pytest.approx(out, abs=2e-5)
    assert load_factor(ALONG, pattern="header-stretcher", headers=headers) == pytest.approx(along, abs=2e-5)


@BOX
@pytest.mark.parametrize(("headers", "expected"), [("english", 0.33869), ("flemish", 0.38443), ("none", 0.26442)])
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
