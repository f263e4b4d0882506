"""Joints with cohesion c bear tension up to c / mu in the shell, and none between stones: a limit of docs/limits.md."""

import pytest

import churchpipe as cp
from churchpipe.generators import wall

OVER, UP = cp.LoadCase((0, 1, 0)), cp.LoadCase((0, 0, 1))
WEIGHT, AREA, FRICTION = 40e3, 1.0, 0.6


def factors(cohesion: float, load: cp.LoadCase) -> tuple[float, float]:
    """Return the load factors of a wall of 2 x .5 x 2 m as stones and as a shell."""
    masonry = cp.Material("default", 20e3, FRICTION, cohesion)
    building = wall(length=2.0, brick=(0.5, 0.5, 0.25), courses=8, materials=(masonry,))
    stones = cp.derive_blocks(building)
    contacts = cp.find_contacts(stones)
    blocks = cp.limit_analysis(stones, contacts, load, *cp.joint_strength(stones, contacts, [masonry]))
    return blocks.load_factor, cp.shell_limit_analysis(cp.derive_shell(building, 0.5), load, [masonry]).load_factor


@pytest.mark.parametrize(("cohesion", "of_shell"), [(0.0, 0.25), (5e3, 0.302), (50e3, 0.771)])
def test_cohesion_holds_a_wall_that_is_pushed_over_as_a_shell_alone(cohesion: float, of_shell: float) -> None:
    of_stones, found = factors(cohesion, OVER)
    assert of_stones == pytest.approx(0.25, abs=1e-6)
    assert found == pytest.approx(of_shell, abs=5e-4)
    # By hand: its weight and the tension that the base bears, both in its middle, about the edge.
    assert found == pytest.approx((WEIGHT + cohesion / FRICTION * AREA) * 0.25 / WEIGHT, rel=1e-6)


def test_a_wall_that_is_lifted_hangs_on_its_cohesion_as_a_shell_alone() -> None:
    of_stones, of_shell = factors(50e3, UP)
    assert of_stones == pytest.approx(1.0, abs=1e-6)
    assert of_shell == pytest.approx(3.083, abs=5e-4)
    assert of_shell == pytest.approx(1 + 50e3 / FRICTION * AREA / WEIGHT, rel=1e-6)
