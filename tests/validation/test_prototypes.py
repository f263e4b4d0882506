"""Tilting tests S22 and S5: Malena, Portioli et al. (2019), section 4 (load factors of Figs. 4 and 5), and independent
calculations made for this project (six digits). Load directions, the place of the opening and the lintel are not in the
paper: they were inferred from its load factors, so agreement here is calibration of the layout, not proof of it.
"""

from typing import Any

import pytest

from churchpipe.rigid_blocks.limit import limit_analysis
from models import TILTING_LOADS as LOADS
from models import tilting_test as model

MORE = pytest.mark.slow("docs/validation.md: S22, friction and brick length")


def load_factor(test: str, friction: float = 0.7, **options: Any) -> float:
    stones, contacts = model(test, **options)
    state = limit_analysis(stones, contacts, LOADS[test], friction=friction)
    assert state.status == "optimal"
    assert state.upper_bound - state.lower_bound <= 1e-6 * state.load_factor
    assert state.equilibrium_residual < 1e-8
    assert state.cone_violation < 1e-8
    return state.load_factor


@pytest.mark.parametrize(
    ("test", "first_course", "stones", "points", "weight_kN"),
    [("S5", "main", 326, 3684, 0.8649), ("S5", "partitions", 325, 3676, 0.8649), ("S22", "main", 869, 9660, 2.290)],
)
def test_counts_and_weight(test: str, first_course: str, stones: int, points: int, weight_kN: float) -> None:
    assemblage, contacts = model(test, first_course=first_course)
    assert int((~assemblage.fixed).sum()) == stones
    assert len(contacts.point) == points
    assert assemblage.weight.sum() / 1e3 == pytest.approx(weight_kN, abs=5e-4)


@pytest.mark.parametrize(
    ("test", "first_course", "computed", "paper"),
    [("S5", "main", 0.444294, 0.448), ("S5", "partitions", 0.448772, 0.448), ("S22", "main", 0.206539, 0.208)],
)
def test_associative_load_factor(test: str, first_course: str, computed: float, paper: float) -> None:
    value = load_factor(test, first_course=first_course)
    assert value == pytest.approx(computed, abs=1e-6)
    assert value == pytest.approx(paper, rel=1e-2)


@pytest.mark.parametrize(
    ("test", "friction", "computed"),
    [
        ("S5", 0.4, 0.329198),
        ("S5", 0.5, 0.378902),
        ("S5", 0.6, 0.412232),
        pytest.param("S22", 0.4, 0.167470, marks=MORE),
        pytest.param("S22", 0.5, 0.180401, marks=MORE),
        ("S22", 0.6, 0.192707),
    ],
)
def test_friction(test: str, friction: float, computed: float) -> None:
    assert load_factor(test, friction) == pytest.approx(computed, abs=1e-6)


@pytest.mark.parametrize(
    ("test", "brick_length", "options", "computed"),
    [
        # A brick no longer than the wall is thick: joints of the through courses shifted by half a brick keep the bond
        # at the corner (the default); without the shift the corner comes apart.
        ("S5", 0.04, {}, 0.311347),
        pytest.param("S22", 0.04, {}, 0.165422, marks=MORE),
        ("S5", 0.04, {"through_offset": 0.0}, 0.1275),
        pytest.param("S22", 0.04, {"through_offset": 0.0}, 0.0723, marks=MORE),
        # Rule "grid" with joints of the cut courses at b/2 + b k.
        ("S5", 0.06, {}, 0.2460),
        pytest.param("S22", 0.06, {}, 0.1695, marks=MORE),
    ],
)
def test_brick_length_and_the_bond_at_the_corner(
    test: str, brick_length: float, options: dict[str, Any], computed: float
) -> None:
    assert load_factor(test, brick_length=brick_length, **options) == pytest.approx(computed, abs=1e-4)


@pytest.mark.slow("docs/validation.md: the iteration of the paper")
@pytest.mark.parametrize(("test", "paper"), [("S5", 0.380), ("S22", 0.186)])
def test_iteration_of_the_paper(test: str, paper: float) -> None:
    stones, contacts = model(test)
    state = limit_analysis(stones, contacts, LOADS[test], friction=0.7, flow="non-associative", method="paper")
    assert state.load_factor == pytest.approx(paper, rel=3e-2)
    assert state.load_factor < load_factor(test)
    # Never called converged without a certificate: forces within friction, and a gap that allows it.
    if state.status == "converged":
        assert state.gap <= 1e-5 * state.load_factor
        assert state.cone_violation < 1e-8
    else:
        assert state.friction_violation > 1e-4
        assert state.message
