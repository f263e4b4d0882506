"""Shells whose masonry crushes: the wall of test_crushing.py, by limit analysis and by its capacity curve."""

import pytest

import churchpipe as cp
from churchpipe.generators import wall

MPA = 1e6
B, HEIGHT, WEIGHT = 0.9, 12.0, 18e3
ELASTIC = cp.Elastic(3e9, 0.2, 0.3e9, 0.2, 0.01)
PUSH = cp.LoadCase((0, 1, 0))


def masonry(strength: float | None) -> list[cp.Material]:
    return [cp.Material("default", WEIGHT, 0.7, elastic=ELASTIC, compressive_strength=strength)]


def mesh(size: float, height: float = HEIGHT, **bond: str) -> cp.ShellModel:
    stone = B / 2 if bond else B
    brick, courses = (0.5, stone, 0.3), round(height / 0.3)
    building = wall(brick=brick, length=1.0, courses=courses, thickness=B, joints="bay", materials=masonry(None), **bond)
    return cp.derive_shell(building, element_size=size)


def overturning(strength: float) -> float:
    """The pressed strip is W / (f d) wide."""
    return (B - B * HEIGHT * WEIGHT / strength) / HEIGHT


@pytest.mark.parametrize("size", [1.0, pytest.param(0.3, marks=pytest.mark.slow("docs/contact_models.md: crushing"))])
@pytest.mark.parametrize("strength", [MPA, 0.5 * MPA])
def test_wall_that_turns_about_crushed_masonry(strength: float, size: float) -> None:
    """The joint at its foot crushes as that of stones does, whatever the mesh."""
    state = cp.shell_limit_analysis(mesh(size), PUSH, masonry(strength))
    assert state.status == "optimal"
    assert abs(state.upper_bound - state.lower_bound) <= 1e-6 * state.load_factor
    assert state.load_factor == pytest.approx(overturning(strength), rel=1e-6)


@pytest.mark.slow
def test_capacity_curve_ends_at_the_limit_load() -> None:
    shell = mesh(1.0)
    state, curve = cp.shell_limit_analysis(shell, PUSH, masonry(MPA)), cp.pushover(shell, PUSH, masonry(MPA))
    assert curve.status == "converged"
    assert curve.load_factor[-1] == pytest.approx(state.load_factor, rel=1e-3)
    assert max(step.violation for step in curve.steps) < 1e-6


@pytest.mark.slow
def test_weaker_masonry_carries_less_and_strong_masonry_as_if_it_never_crushed() -> None:
    shell = mesh(1.0)
    factors = [cp.shell_limit_analysis(shell, PUSH, masonry(f)).load_factor for f in (0.25 * MPA, MPA, 1e4 * MPA, None)]
    assert factors == sorted(factors)
    assert factors[2] == pytest.approx(factors[3], rel=1e-4)
    # Its own weight, .216 MPa, crushes it.
    assert cp.shell_limit_analysis(shell, PUSH, masonry(0.15 * MPA)).status == "unstable"


@pytest.mark.parametrize("headers", ["flemish", "none"])
def test_other_bonds_crush_as_well(headers: str) -> None:
    state = cp.shell_limit_analysis(mesh(0.6, 3.0, pattern="header-stretcher", headers=headers), PUSH, masonry(0.3 * MPA))
    assert state.status == "optimal"
    # A strip of 3 m x 18 kN/m3 / .3 MPa, .18 of the thickness, is pressed at the base, of each leaf where there are two.
    width = B / 2 if headers == "none" else B
    assert state.load_factor == pytest.approx(width / 3.0 * (1 - 0.18), rel=1e-6)
