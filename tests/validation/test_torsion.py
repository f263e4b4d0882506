"""Torsion of joints under uniform pressure: rectangles in closed form, other polygons by integration, buildings that twist."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.errors import InputError
from churchpipe.geometry.polygons import polygon_areas, symmetric_parts
from churchpipe.model.names import ContactModel
from churchpipe.rigid_blocks.torsion import friction_points, mean_distance
from models import TILTING_LOADS, tilting_test
from solids import box, on_ground

MU = 0.7
TABLE = pytest.mark.slow("docs/contact_models.md: eccentric torque, of stones that crush")


def twisted(stones: cp.Assemblage, contact_model: ContactModel, **options: Any) -> cp.LimitState:
    """A torque of as many newton metres as the stones weigh newtons, about the vertical axis of the last one."""
    live = np.zeros((stones.count, 6))
    live[-1, 5] = stones.weight.sum()
    contacts = cp.find_contacts(stones)
    return cp.limit_analysis(stones, contacts, cp.LoadCase(live=live), MU, contact_model=contact_model, **options)


@pytest.mark.parametrize("solver", ["auto", "clarabel"])
@pytest.mark.parametrize(("b", "h", "printed"), [(1, 1, 0.267819), (2, 1, 0.415263), (4, 1, 0.742546)])
def test_pure_torque_on_a_rectangle(b: float, h: float, printed: float, solver: str) -> None:
    diagonal = np.hypot(b, h)
    arm = diagonal / 6 + b**2 / (12 * h) * np.arcsinh(h / b) + h**2 / (12 * b) * np.arcsinh(b / h)
    state = twisted(on_ground(box((0, b), (0, h), (0, 1))), "torsion", solver=solver)
    assert state.status == "optimal"
    assert state.load_factor == pytest.approx(MU * arm, rel=1e-6)
    assert state.load_factor == pytest.approx(printed, abs=1e-6)
    assert state.upper_bound - state.lower_bound <= 1e-6 * state.load_factor


def test_corners_overrate_a_square() -> None:
    state = twisted(on_ground(box((0, 1), (0, 1), (0, 1))), "corners")
    assert state.load_factor == pytest.approx(MU * np.sqrt(0.5), rel=1e-6)


def test_pure_torque_without_dilatancy() -> None:
    state = twisted(on_ground(box((0, 2), (0, 1), (0, 1))), "torsion", flow="non-associative")
    assert state.status == "converged"
    assert state.load_factor == pytest.approx(0.415263, rel=1e-4)


@pytest.mark.parametrize("b", [0.2, 0.5])
def test_overturning_and_sliding_are_untouched(b: float) -> None:
    stones = on_ground(box((0, b), (0, 1), (0, 0.5)))
    contacts = cp.find_contacts(stones)
    state = cp.limit_analysis(stones, contacts, cp.LoadCase((1, 0, 0)), MU, contact_model="torsion")
    assert state.load_factor == pytest.approx(min(MU, b / 0.5), rel=1e-6)


POLYGONS = {
    "triangle": [(0, 0), (3, 0), (1, 2)],
    "kite": [(0, -1), (2, 0), (0, 1), (-1, 0)],
    "notched": [(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)],
    "clockwise": [(1, 2), (3, 0), (0, 0)],
}


def contains(corners: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Which points lie in a polygon: a ray to the right crosses its edges an odd number of times."""
    inside = np.zeros(len(points), dtype=bool)
    for (x1, y1), (x2, y2) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        if y1 != y2:
            spans = (points[:, 1] >= min(y1, y2)) & (points[:, 1] < max(y1, y2))
            inside ^= spans & (x1 + (points[:, 1] - y1) * (x2 - x1) / (y2 - y1) > points[:, 0])
    return inside


@pytest.mark.parametrize("name", POLYGONS)
@pytest.mark.parametrize("centre", [(0.9, 0.4), (0.0, 0.0), (-2.0, 5.0)])
def test_mean_distance_of_a_polygon(name: str, centre: tuple[float, float]) -> None:
    corners = np.array(POLYGONS[name], dtype=float)
    low, size, cells = corners.min(axis=0), np.ptp(corners, axis=0), 1200
    middle = (np.arange(cells) + 0.5) / cells
    grid = low + size * np.stack(np.meshgrid(middle, middle), axis=-1).reshape(-1, 2)
    inside = grid[contains(corners, grid)]
    after = np.roll(np.arange(len(corners)), -1)
    exact = mean_distance(corners - centre, after, np.array([0]))
    assert exact == pytest.approx([np.hypot(*(inside - centre).T).mean()], rel=2e-4)


def eccentric(e: tuple[float, float], b: float, h: float) -> tuple[cp.Assemblage, cp.LoadCase]:
    """A flat block on which the pressure's centre lies e beside the middle, twisted about the vertical through that centre."""
    stones = on_ground(box((-b / 2, b / 2), (-h / 2, h / 2), (0, 0.1)))
    weight = stones.weight.sum()
    dead, live = np.zeros((2, stones.count, 6))
    # A load of nine weights, so far out that the resultant of all is at e.
    dead[-1] = [0, 0, -9 * weight, -10 * weight * e[1], 10 * weight * e[0], 0]
    live[-1, 5] = weight
    return stones, cp.LoadCase(dead=dead, live=live)


@pytest.mark.parametrize("crushing", [None, pytest.param(1e9, marks=TABLE)])
@pytest.mark.parametrize("e", [(0.0, 0.0), (0.2, 0.0), (0.15, 0.1), (0.45, 0.0), (-0.3, 0.2)])
def test_eccentric_torque_without_dilatancy(e: tuple[float, float], crushing: float | None) -> None:
    b, h = 1.2, 0.7
    stones, load = eccentric(e, b, h)
    options: dict[str, Any] = {"contact_model": "torsion", "flow": "non-associative", "compressive_strength": crushing}
    state = cp.limit_analysis(stones, cp.find_contacts(stones), load, MU, **options)
    # Uniform pressure on the rectangle about its centre, integrated at the middles of small squares.
    wide, deep, cells = b - 2 * abs(e[0]), h - 2 * abs(e[1]), 600
    x, y = (size * ((np.arange(cells) + 0.5) / cells - 0.5) for size in (wide, deep))
    arm = np.hypot(*np.meshgrid(x, y)).mean()
    assert state.status == "converged"
    assert state.load_factor == pytest.approx(10 * MU * arm, rel=2e-3)
    assert "centres of pressure" in state.message


@pytest.mark.parametrize("e", [(0.0, 0.0), (0.2, 0.1), (-1.1, 0.4)])
def test_area_that_is_symmetric_about_the_pressure(e: tuple[float, float]) -> None:
    triangle = np.array([(0, 0), (3, 0), (1, 2)], dtype=float)
    rectangle = np.array([(-2, -1), (2, -1), (2, 1), (-2, 1)], dtype=float)
    corner, pointer = symmetric_parts(np.vstack([triangle, rectangle]), np.array([0, 3, 7]), np.array([[1.2, 0.6], e]))
    area = polygon_areas(corner, pointer)
    assert abs(area[1]) == pytest.approx((4 - 2 * abs(e[0])) * (2 - 2 * abs(e[1])), rel=1e-9)
    mine = corner[: pointer[1]]
    assert contains(triangle, mine + 1e-9 * ([1.2, 0.6] - mine)).all()
    reflected = 2 * np.array([1.2, 0.6]) - mine
    assert np.abs(reflected[:, None] - mine).max(axis=2).min(axis=1) == pytest.approx(np.zeros(len(mine)), abs=1e-9)


def test_friction_of_a_square_acts_at_54_hundredths() -> None:
    contacts = cp.find_contacts(on_ground(box((1, 2), (3, 4), (0, 1))))
    arm = friction_points(contacts) - [1.5, 3.5, 0]
    assert np.linalg.norm(arm, axis=1) == pytest.approx(np.full(4, 0.267819 / MU), abs=1e-6)
    assert arm[:, 2] == pytest.approx(np.zeros(4), abs=1e-12)


@pytest.mark.parametrize(("test", "expected"), [("S5", 0.4185), ("S22", 0.206539)])
def test_tilting_tests(test: str, expected: float) -> None:
    stones, contacts = tilting_test(test)
    state = cp.limit_analysis(stones, contacts, TILTING_LOADS[test], MU, contact_model="torsion")
    assert state.status == "optimal"
    assert state.solver == "interior-point"
    assert state.upper_bound - state.lower_bound <= 1e-6 * state.load_factor
    assert state.load_factor == pytest.approx(expected, abs=6e-5 if test == "S5" else 1e-6)


@pytest.mark.slow("docs/contact_models.md: S5 without dilatancy")
@pytest.mark.parametrize(("test", "low", "high"), [("S5", 0.3782, 0.3813), ("S22", 0.1880, 0.1886)])
def test_tilting_tests_about_the_pressure(test: str, low: float, high: float) -> None:
    stones, contacts = tilting_test(test)
    state = cp.limit_analysis(stones, contacts, TILTING_LOADS[test], MU, contact_model="torsion", flow="non-associative")
    assert state.status == "converged"
    assert state.gap <= 1e-5 * state.load_factor
    assert [run.start for run in state.starts] == ["centre"]
    assert state.interval[0] <= state.load_factor <= state.interval[1]
    # S5 has 1.2 % of the load factor, S22 .4 % (docs/contact_models.md).
    assert state.interval[1] - state.interval[0] < 0.015 * state.load_factor
    # The interval of one processor: frictions that differ by a hundred-millionth lead to .3792 to .3808, and .18822 to .18835.
    assert low <= state.load_factor <= high


def test_bad_arguments() -> None:
    stones = on_ground(box((0, 1), (0, 1), (0, 1)))
    contacts, load = cp.find_contacts(stones), cp.LoadCase((1, 0, 0))
    unknown: Any = "twist"
    with pytest.raises(InputError, match="limit_analysis: contact_model: unknown value; found twist"):
        cp.limit_analysis(stones, contacts, load, MU, contact_model=unknown)
    crossed = replace(contacts, point=contacts.point[[0, 2, 1, 3]])
    line = replace(contacts, point=contacts.point[:2], point_ptr=np.array([0, 2]))
    for wrong, found in ((crossed, "they enclose 0 m2; expected 1 m2"), (line, "2 points; expected 3 or more")):
        with pytest.raises(InputError, match=f"contacts: interface 0: its points are not its corners in order; found {found}"):
            cp.limit_analysis(stones, wrong, load, MU, contact_model="torsion")
