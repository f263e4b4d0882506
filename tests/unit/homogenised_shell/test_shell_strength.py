"""The planes of the paper against the strength of the cell that is computed from its stones."""

import numpy as np
import pytest

from churchpipe.errors import InputError
from churchpipe.homogenised_shell.strength import paper_planes, violation
from hand_cell import running_limit

# a, b, h in m, friction: Table 1, the church, a stone as long as the wall is thick, long flat stones, tall thin ones.
CELLS = [(0.03, 0.08, 0.04, 0.7), (0.275, 0.57, 0.9, 0.6), (0.03, 0.04, 0.04, 0.4), (0.1, 0.5, 0.2, 1.0), (0.4, 0.3, 0.1, 0.9)]
MEMBRANE, BENDING, WITHOUT_M12, TWIST, ALL = [
    np.array(mask, dtype=float)
    for mask in ([1, 1, 1, 0, 0, 0], [0, 0, 0, 1, 1, 0], [1, 1, 1, 1, 1, 0], [0, 0, 0, 0, 0, 1], [1] * 6)
]


def ratios(cell: tuple[float, float, float, float], mask: np.ndarray, count: int = 40) -> np.ndarray:
    """Limit by the planes over exact limit in random directions, from equal compression; directions without a limit left out."""
    a, b, h, friction = cell
    planes = paper_planes(*cell, torsion=bool(mask[5]))
    unit = np.array([1, 1, 1, h, h, h])
    base = np.array([-1.0, -1.0, 0, 0, 0, 0])
    out = []
    for direction in np.random.default_rng(5).normal(size=(count, 6)) * mask * unit:
        exact = running_limit(a, b, h, friction, direction, base=base)
        if exact.outcome == "unbounded":
            continue
        assert exact.outcome == "solved"
        pull = planes.normal @ direction
        reach = planes.limit - planes.normal @ base
        out.append((reach[pull > 0] / pull[pull > 0]).min(initial=np.inf) / exact.factor)
    assert len(out) > 0.6 * count
    return np.array(out)


@pytest.mark.parametrize("cell", CELLS)
@pytest.mark.parametrize("mask", [MEMBRANE, BENDING, TWIST], ids=["membrane", "bending", "twist"])
def test_planes_are_exact_for_membrane_forces_bending_and_twist(
    cell: tuple[float, float, float, float], mask: np.ndarray
) -> None:
    a, b, _, friction = cell
    if mask is MEMBRANE and friction * 2 * a / b > 1:
        assert ratios(cell, mask).max() > 1.01
    else:
        np.testing.assert_allclose(ratios(cell, mask), 1.0, rtol=2e-6)


def test_stones_rock_in_the_plane_when_friction_times_slenderness_exceeds_one() -> None:
    # 2 a / b = 1.5: the threshold is at friction .6667.
    np.testing.assert_allclose(ratios((0.03, 0.04, 0.04, 0.66), MEMBRANE), 1.0, rtol=2e-6)
    assert 1.001 < ratios((0.03, 0.04, 0.04, 0.68), MEMBRANE, 150).max() < 1.01


@pytest.mark.parametrize("cell", CELLS)
def test_planes_hold_the_exact_domain_inside(cell: tuple[float, float, float, float]) -> None:
    # Each exact limit is proved to 1e-6 on either side.
    mixed = ratios(cell, WITHOUT_M12, 60)
    assert mixed.min() > 1 - 2e-6
    assert mixed.max() > 1.01
    assert ratios(cell, ALL, 60).min() > 1 - 2e-6


def test_planes_are_close_for_mixed_forces_and_moments() -> None:
    mixed = ratios(CELLS[0], WITHOUT_M12, 200)
    assert np.median(mixed) == pytest.approx(1.0, abs=5e-3)
    assert np.quantile(mixed, 0.9) < 1.31


@pytest.mark.parametrize("cell", CELLS)
def test_every_plane_touches_the_exact_domain(cell: tuple[float, float, float, float]) -> None:
    # From a base on the plane's hydrostatic axis, some direction in the plane's normal meets the exact limit.
    a, b, h, friction = cell
    planes = paper_planes(*cell, torsion=True)
    base = np.array([-1.0, -1.0, 0, 0, 0, 0])
    for normal in planes.normal:
        pure = np.where(np.arange(6) < 2, 0.0, normal)
        direction = pure / np.abs(pure).max() * h
        exact = running_limit(a, b, h, friction, direction, base=base).factor
        others = planes.normal @ direction
        reach = -planes.normal @ base
        assert (reach[others > 0] / others[others > 0]).min() == pytest.approx(exact, rel=1e-6)


def test_beyond_friction_one_the_planes_are_refused_and_would_be_wrong() -> None:
    with pytest.raises(InputError, match=r"valid for tan\(phi\) <= 1 only; found 1.3"):
        paper_planes(0.03, 0.08, 0.04, 1.3)
    mu_b, tg, base = 0.75, 1.3, -np.array([1.0, 0.01, 0, 0, 0, 0])
    f1 = np.array([mu_b, tg, 1 + tg * mu_b, 0, 0, 0])
    direction = np.array([0, -1.0, 1.0, 0, 0, 0])
    exact = running_limit(0.03, 0.08, 0.04, tg, direction, base=base).factor
    assert (f1 @ -base) / (f1 @ direction) < exact * (1 - 1e-3)


def test_cohesion_shifts_the_planes() -> None:
    a, b, h, tg, c = 0.03, 0.08, 0.04, 0.7, 5e4
    planes = paper_planes(a, b, h, tg, c)
    mu_b = 2 * a / b
    p, q = tg * b / (4 * h * mu_b), tg / mu_b * np.sqrt(1 + (b / (4 * h)) ** 2)
    expected = [h * (c + c * mu_b / tg)] * 2 + [h * c / tg] * 4 + [(1 + p + q) * h * c / tg] * 2
    np.testing.assert_allclose(planes.limit, expected, rtol=1e-12)
    direction = np.array([0.2, 0.1, 1.0, 0, 0, 0])
    exact = running_limit(a, b, h, tg, direction, cohesion=c).factor
    assert violation(planes, exact * direction[None]) == pytest.approx([0.0], abs=1e-2)
    assert violation(planes, 0.99 * exact * direction[None])[0] < 0


def test_facets_broadcast() -> None:
    a, b, h, friction, cohesion = np.array([(*CELLS[0], 0.0), (*CELLS[1], 1e4)]).T
    planes = paper_planes(a, b, h, friction, cohesion)
    assert planes.normal.shape == (2, 8, 6)
    np.testing.assert_array_equal(planes.normal[1], paper_planes(*CELLS[1], 1e4).normal)
