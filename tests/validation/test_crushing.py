"""Joints that crush: closed forms of rigid-plastic statics, of joints in parts from below as these grow smaller."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.optimize import linprog

import churchpipe as cp
from churchpipe.errors import InputError
from churchpipe.rigid_blocks.crushing import joint_parts
from solids import box, on_ground, prism

UNIT_WEIGHT = 18e3
MPA = 1e6


def crushed(stones: cp.Assemblage, strength: Any, direction: tuple[float, float, float] = (1, 0, 0), **options: Any) -> Any:
    options = {"friction": 0.7} | options
    return cp.limit_analysis(stones, cp.find_contacts(stones), cp.LoadCase(direction), compressive_strength=strength, **options)


def assert_certified(state: cp.LimitState) -> None:
    assert state.status == "optimal"
    assert abs(state.upper_bound - state.lower_bound) <= 1e-6 * state.load_factor
    assert state.equilibrium_residual < 1e-8
    assert state.cone_violation < 1e-8


def wall(b: float = 0.9, h: float = 12.0, d: float = 1.0) -> cp.Assemblage:
    return on_ground(box((0, b), (0, d), (0, h)))


@pytest.mark.parametrize("solver", ["auto", "clarabel"])
@pytest.mark.parametrize(("strength", "printed"), [(1.0, 0.0588), (0.5, 0.0426), (None, 0.075)])
def test_wall_that_turns_about_crushed_stone(strength: float | None, printed: float, solver: str) -> None:
    # The pressed strip is a = W / (f d) wide, the resultant in its middle: alpha = (b - a) / h (theory-2.md, section 13).
    exact = (0.9 - (0.9 * 12 * UNIT_WEIGHT / (strength * MPA) if strength else 0.0)) / 12
    assert exact == pytest.approx(printed, abs=1e-4)
    state = crushed(wall(), None if strength is None else strength * MPA, solver=solver)
    assert_certified(state)
    assert state.load_factor == pytest.approx(exact, rel=1e-6)


def test_wall_of_nine_stones_on_joints_that_crush() -> None:
    # Pressed strips above the lowest are narrower; the lowest joint governs.
    courses = [box((0, 0.9), (0, 1), (z, z + 1.5)) for z in np.arange(8) * 1.5]
    state = crushed(on_ground(*courses), MPA)
    assert_certified(state)
    assert state.load_factor == pytest.approx((0.9 - 0.9 * 12 * UNIT_WEIGHT / MPA) / 12, rel=1e-6)


def pillar(plan: list[tuple[float, float]], height: float) -> cp.Assemblage:
    """A pillar with this plan (x, y) on the ground."""
    points, faces = prism([(x, -y) for x, y in plan], height)
    return on_ground((points @ np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]), faces))


def test_joint_on_the_slant_is_as_strong_as_a_rectangle() -> None:
    # A parallelogram sheared along the edges that it turns about: the pressed strip is as wide along the push as before.
    state = crushed(pillar([(0, 0), (0.9, 0), (0.9 + 0.3, 1.0), (0.3, 1.0)], 12.0), MPA)
    assert_certified(state)
    assert state.load_factor == pytest.approx((0.9 - 0.9 * 12 * UNIT_WEIGHT / MPA) / 12, rel=1e-6)


@pytest.mark.parametrize("strength", [0.5, 1.0, 5.0])
def test_parts_of_a_triangle_converge_from_below(strength: float) -> None:
    # It turns about its edge x = 0, where the width is d: the strip 0 < x < a has the area d (a - a^2 / 2 b) = W / f.
    b, d, h = 0.9, 1.0, 10.0
    strip = b - np.sqrt(b**2 - 2 * b * (b * d / 2 * h * UNIT_WEIGHT) / (strength * MPA * d))
    centre = (strip**2 / 2 - strip**3 / (3 * b)) / (strip - strip**2 / (2 * b))
    exact = (b / 3 - centre) / (h / 2)
    errors = []
    for parts in (4, 8, 16, 32):
        stone = pillar([(0, 0), (b, d / 2), (0, d)], h)
        state = crushed(stone, strength * MPA, (-1, 0, 0), crushing_parts=parts)
        assert_certified(state)
        errors.append(1 - state.load_factor / exact)
    assert min(errors) > -1e-6
    # Twice as many parts leave about a quarter of the error.
    assert errors[-1] < 0.012
    assert errors[-1] < 0.15 * errors[0] + 1e-6


def best_pressure(plan: np.ndarray, height: float, strength: float, push: np.ndarray) -> float:
    """Load factor of a pillar on squares of its base (n, 3), x, y, area, under at most the strength, by linear programming."""
    x, y, area = plan.T
    arm = np.stack([x, y], axis=1) - area @ plan[:, :2] / area.sum()
    share = strength * area / (area.sum() * height * UNIT_WEIGHT)
    along, across = arm @ push, arm @ [-push[1], push[0]]
    found = linprog(-along, A_eq=[np.ones(len(x)), across], b_eq=[1 / share[0], 0], bounds=(0, 1), method="highs")
    assert found.status == 0
    return -found.fun * share[0] / (height / 2)


L_SHAPE = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.3), (0.3, 0.3), (0.3, 1.0), (0.0, 1.0)]


@pytest.mark.parametrize("push", [(1, 0, 0), (-1, 0, 0), (1, 1, 0), (-1, -1, 0)])
def test_a_joint_that_is_not_convex_is_not_overrated(push: tuple[float, float, float]) -> None:
    # Its hull has half as much area again; what lies between the legs bears nothing.
    cells = 60
    x, y = np.meshgrid(*[(np.arange(cells) + 0.5) / cells] * 2)
    inside = (x < 0.3) | (y < 0.3)
    plan = np.stack([x[inside], y[inside], np.full(inside.sum(), 1.0 / cells**2)], axis=1)
    exact = best_pressure(plan, 8.0, MPA, np.array(push[:2]) / np.linalg.norm(push))
    found = []
    for parts in (8, 16):
        state = crushed(pillar(L_SHAPE, 8.0), MPA, push, crushing_parts=parts)
        assert_certified(state)
        found.append(state.load_factor / exact)
    assert 0.95 < found[0] < found[1] < 1.002
    assert found[1] > 0.98


def test_a_joint_whose_material_is_not_found_is_refused() -> None:
    stones = pillar(L_SHAPE, 8.0)
    contacts = cp.find_contacts(stones)
    smaller = replace(contacts, area=0.9 * contacts.area)
    with pytest.raises(InputError, match=r"it is not convex, and where its material lies.*found 0.51 m2"):
        cp.limit_analysis(stones, smaller, cp.LoadCase((1, 0, 0)), 0.7, compressive_strength=MPA)


def test_a_rectangle_beside_a_linear_program() -> None:
    cells = 100
    x, y = (grid.ravel() for grid in np.meshgrid(*[(np.arange(cells) + 0.5) / cells] * 2))
    plan = np.stack([0.9 * x, y, np.full(cells**2, 0.9 / cells**2)], axis=1)
    exact = best_pressure(plan, 12.0, MPA, np.array([1.0, 0.0]))
    assert crushed(wall(), MPA).load_factor == pytest.approx(exact, rel=1e-3)


@pytest.mark.parametrize("strength", [0.4, 1.0])
def test_pillar_pushed_along_its_diagonal(strength: float) -> None:
    # The pressed part is a triangle with legs l, f l^2 / 2 = W, and centroid sqrt(2) l / 3 from the corner. Meyerhof's square in
    # the corner, with the sides s, f s^2 = W, would be 4 % below it where a fifth of the base is crushed.
    b, h = 1.0, 10.0
    side = np.sqrt(b * b * h * UNIT_WEIGHT / (strength * MPA))
    leg = np.sqrt(2) * side
    assert leg < b
    best, square = ((b / np.sqrt(2) - arm) / (h / 2) for arm in (np.sqrt(2) * leg / 3, side / np.sqrt(2)))
    state = crushed(wall(b, h, b), strength * MPA, (1, 1, 0))
    assert_certified(state)
    assert state.load_factor == pytest.approx(best, rel=1e-6)
    assert best * (0.95 if strength == 1.0 else 0.89) < square < best


def test_stone_that_its_own_weight_crushes() -> None:
    state = crushed(wall(0.9, 12), 0.2 * MPA)
    assert state.status == "unstable"
    assert crushed(wall(0.9, 12), 0.22 * MPA).load_factor < 0.002


@pytest.mark.parametrize("contact_model", ["corners", "torsion"])
def test_wall_without_dilatancy(contact_model: str) -> None:
    # It turns and does not slide: both flows agree.
    associative, sliding = (
        crushed(wall(), MPA, flow=flow, contact_model=contact_model) for flow in ("associative", "non-associative")
    )
    assert sliding.status == "converged"
    assert sliding.gap <= 1e-5 * sliding.load_factor
    assert sliding.load_factor == pytest.approx(associative.load_factor, rel=1e-4)


def stack() -> cp.Assemblage:
    """Six courses of two stones that slide and turn."""
    return on_ground(
        *(
            box((i + s, i + 1 + s), (0, 0.5), (z, z + 0.5))
            for z in np.arange(6) / 2
            for s in (0.3 * ((2 * z) % 2),)
            for i in range(2)
        )
    )


@pytest.mark.slow
def test_stones_that_slide_and_crush_without_dilatancy() -> None:
    pressure = 6 * 0.5 * UNIT_WEIGHT
    factors = []
    for strength in (None, 20 * pressure, 6 * pressure, 3 * pressure):
        associative = crushed(stack(), strength, friction=0.6)
        state = crushed(stack(), strength, friction=0.6, flow="non-associative")
        assert_certified(associative)
        assert state.status == "converged"
        assert state.load_factor <= associative.load_factor * (1 + 1e-4)
        assert state.interval[0] <= state.load_factor <= state.interval[1]
        factors.append((associative.load_factor, state.load_factor))
    assert (np.diff(factors, axis=0) < 0).all()


def test_each_joint_has_its_own_strength() -> None:
    # Two walls side by side, far from each other: the weaker one governs.
    stones = on_ground(box((0, 0.9), (0, 1), (0, 12)), box((5, 5.9), (0, 1), (0, 12)))
    state = crushed(stones, [5 * MPA, 0.5 * MPA])
    assert state.load_factor == pytest.approx(crushed(wall(), 0.5 * MPA).load_factor, rel=1e-5)
    assert crushed(stones, [np.inf, 0.5 * MPA]).load_factor == pytest.approx(state.load_factor, rel=1e-5)


def test_cohesion_and_ties_beside_crushing() -> None:
    # Cohesion is no tension: it changes nothing here. A tie of strength T at z adds 2 T z / (W h).
    plain = crushed(wall(), MPA).load_factor
    assert crushed(wall(), MPA, cohesion=5e4).load_factor == pytest.approx(plain, rel=1e-6)
    stones = cp.Assemblage.from_polyhedra(
        [box((-9, 9), (-9, 9), (-1, 0)), box((0, 0.9), (0, 1), (0, 12)), box((-3, -2), (0, 1), (0, 12))],
        UNIT_WEIGHT,
        fixed=[0, 2],
    )
    weight = 0.9 * 12 * UNIT_WEIGHT
    tie = cp.Tie("rod", (-2, 0.5, 10), (0, 0.5, 10), strength=0.01 * weight)
    state = crushed(stones, MPA, ties=[tie])
    assert_certified(state)
    assert state.load_factor == pytest.approx(plain + 2 * 0.01 * 10 / 12, rel=1e-5)


POLYGONS = [
    [(0, 0), (2, 0), (2, 1), (0, 1)],
    [(0, 0), (3, 0), (1, 2)],
    [(0, 0), (2, -0.5), (3, 1), (1.5, 2.5), (-0.5, 1)],
]


@pytest.mark.parametrize("polygon", POLYGONS)
def test_parts_share_area_and_moments(polygon: list[tuple[float, float]]) -> None:
    stones = on_ground(prism([(x, z) for x, z in polygon], 1.0))
    contacts = cp.find_contacts(on_ground(box((0, 1), (0, 1), (0, 1))))
    corners = np.array([(x, y, 0.0) for x, y in polygon])
    x, y = corners[:, 0], corners[:, 1]
    cross = x * np.roll(y, -1) - np.roll(x, -1) * y
    area = cross.sum() / 2
    centroid = [((values + np.roll(values, -1)) * cross).sum() / (6 * area) for values in (x, y)]
    contacts = cp.Contacts(contacts.blocks, contacts.frame, [area], corners, [0, len(corners)], contacts.kind)
    assert stones.count == 2
    for count in (2, 4, 10):
        parts = joint_parts(contacts, count)
        assert len(parts.area) == len(corners) * (count // 2) ** 2
        assert parts.area.min() > 0
        assert parts.area.sum() == pytest.approx(area, rel=1e-12)
        assert parts.area @ parts.contacts.point[:, :2] == pytest.approx(area * np.array(centroid), rel=1e-9)
        assert parts.shares.min() >= 0
        assert np.asarray(parts.shares.sum(axis=1)).ravel() == pytest.approx(np.ones(len(parts.area)))
        assert parts.shares @ corners == pytest.approx(parts.contacts.point, abs=1e-12)


def test_forces_are_told_at_the_corners() -> None:
    stones = wall()
    contacts = cp.find_contacts(stones)
    state = crushed(stones, MPA)
    assert state.forces.shape == contacts.point.shape
    weight = 0.9 * 12 * UNIT_WEIGHT
    assert state.forces[:, 0].sum() == pytest.approx(weight, rel=1e-8)
    moment = state.forces[:, 0] @ (contacts.point[:, 0] - 0.45)
    assert abs(moment) == pytest.approx(state.load_factor * weight * 6, rel=1e-6)


@pytest.mark.parametrize(
    ("strength", "said"),
    [
        (0.0, "compressive_strength: out of range; found 0.0"),
        (-1.0, "compressive_strength: out of range"),
        (float("nan"), "compressive_strength: out of range"),
        ([1e6, 1e6], "compressive_strength: wrong shape"),
        ("1 MPa", "compressive_strength: not numbers"),
    ],
)
def test_bad_strengths(strength: Any, said: str) -> None:
    with pytest.raises(InputError, match=said):
        crushed(wall(), strength)


@pytest.mark.parametrize("parts", [0, 3, -2, 1.5])
def test_bad_parts(parts: Any) -> None:
    with pytest.raises(InputError, match="limit_analysis: crushing_parts"):
        crushed(wall(), MPA, crushing_parts=parts)
