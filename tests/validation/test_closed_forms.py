"""Closed forms: single blocks, stacks, corbels, leaves, walls out of plane (elementary statics)."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import linprog

from churchpipe.generators import wall
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.loads import LoadCase
from churchpipe.model.results import LimitState
from churchpipe.rigid_blocks.limit import limit_analysis
from churchpipe.stones.blocks import derive_blocks
from churchpipe.stones.contacts import find_contacts
from solids import box, moved, on_ground


def collapse(
    stones: Assemblage, friction: float, direction: tuple[float, float, float] = (1, 0, 0), **options: object
) -> LimitState:
    return limit_analysis(stones, find_contacts(stones), LoadCase(direction), friction=friction, **options)


def assert_optimal(state: LimitState, load_factor: float) -> None:
    assert state.status == "optimal"
    assert state.load_factor == pytest.approx(load_factor, rel=1e-6)
    assert state.lower_bound <= state.upper_bound * (1 + 1e-9)
    assert state.upper_bound - state.lower_bound <= 1e-6 * state.upper_bound
    assert state.equilibrium_residual < 1e-8
    assert state.cone_violation < 1e-8


@pytest.mark.parametrize(("b", "h", "mu"), [(1, 2, 0.7), (1, 2, 0.3), (1, 1, 0.7), (1, 10, 0.7)])
def test_single_block_slides_or_overturns(b: float, h: float, mu: float) -> None:
    assert_optimal(collapse(on_ground(box((0, b), (0, 1), (0, h))), mu), min(mu, b / h))


@pytest.mark.parametrize(("upper", "mu", "expected"), [(1, 0.7, 0.5), (3, 0.7, 0.25), (1, 0.4, 0.4)])
def test_stack_of_two(upper: float, mu: float, expected: float) -> None:
    stones = on_ground(box((0, 1), (0, 1), (0, 1)), box((0, 1), (0, 1), (1, 1 + upper)))
    assert_optimal(collapse(stones, mu), expected)


def test_block_pushed_askew() -> None:
    # Overturns about the long edge: only the load's component across it counts, (1/4) / cos 30.
    stones = on_ground(box((0, 1), (0, 2), (0, 4)))
    assert_optimal(collapse(stones, 0.7, (np.cos(np.pi / 6), 0.5, 0)), 0.25 / np.cos(np.pi / 6))


def test_square_block_pushed_along_the_diagonal() -> None:
    assert_optimal(collapse(on_ground(box((0, 1), (0, 1), (0, 3))), 0.7, (1, 1, 0)), np.sqrt(2) / 3)


@pytest.mark.parametrize(("sign", "expected"), [(1, 0.375), (-1, 0.625)])
def test_shifted_cube_on_a_cube(sign: int, expected: float) -> None:
    stones = on_ground(box((0, 1), (0, 1), (0, 1)), box((0.25, 1.25), (0, 1), (1, 2)))
    assert_optimal(collapse(stones, 0.7, (sign, 0, 0)), expected)


def test_pure_torque_on_four_points() -> None:
    # Four points at the corners: mu W b sqrt(2) / 2; uniform pressure would give 0.267819 (known limit of point contact).
    stones = on_ground(box((0, 1), (0, 1), (0, 1)), unit_weight=1.0)
    torque = np.zeros((2, 6))
    torque[1, 5] = 1.0
    push = np.zeros((2, 6))
    push[1, 0] = -1.0
    load = LoadCase((1, 0, 0), live=torque + push)
    state = limit_analysis(stones, find_contacts(stones), load, friction=0.7)
    assert_optimal(state, 0.7 * np.sqrt(2) / 2)


@pytest.mark.parametrize("courses", [5, 10, 21])
def test_free_running_bond_wall_out_of_plane(courses: int) -> None:
    bricks = []
    for c in range(courses):
        joints = [0, 0.08, 0.16, 0.24, 0.32] if c % 2 == 0 else [0, 0.04, 0.12, 0.20, 0.28, 0.32]
        bricks += [box((p, q), (0, 0.04), (0.03 * c, 0.03 * (c + 1))) for p, q in itertools.pairwise(joints)]
    assert_optimal(collapse(on_ground(*bricks), 0.7, (0, 1, 0)), 0.04 / (0.03 * courses))


@pytest.mark.parametrize("sign", [1, -1])
def test_corbelled_stack_beyond_its_limit_is_unstable(sign: int) -> None:
    stack = [box((0.26 * i, 0.26 * i + 1), (0, 1), (0.5 * i, 0.5 * i + 0.5)) for i in range(4)]
    state = collapse(on_ground(*stack), 0.7, (sign, 0, 0))
    assert state.status == "unstable"
    assert np.isnan(state.load_factor)
    work = state.velocities[1:, 2] @ np.full(4, -0.25)
    assert work == pytest.approx(1.0, rel=1e-6), "the mechanism is scaled to f_D . u = 1 per total weight"


@pytest.mark.parametrize(("shift", "stands"), [(0.249, True), (0.251, False)])
def test_corbel_stands_up_to_a_shift_of_b_over_n(shift: float, stands: bool) -> None:
    stack = [box((shift * i, shift * i + 1), (0, 1), (0.5 * i, 0.5 * i + 0.5)) for i in range(4)]
    assert (collapse(on_ground(*stack), 0.7, (-1, 0, 0)).status == "optimal") is stands


def leaves(*thickness: tuple[float, float]) -> Assemblage:
    return on_ground(*(box((0, 1), span, (0, 3.9)) for span in thickness))


@pytest.mark.parametrize(
    ("walls", "expected"),
    [
        (((0.0, 0.25), (0.26, 0.51)), 0.25 / 3.9),
        (((0.0, 0.5),), 0.5 / 3.9),
    ],
)
def test_two_leaves_apart_or_bonded(walls: tuple[tuple[float, float], ...], expected: float) -> None:
    assert_optimal(collapse(leaves(*walls), 0.6, (0, 1, 0)), expected)


def test_two_leaves_abutting_with_friction() -> None:
    # Computed independently for this project: .0834, four digits, for leaves that do not come apart at bed joints
    # (of ten courses each they do, at .0764).
    state = collapse(leaves((0.0, 0.25), (0.25, 0.5)), 0.6, (0, 1, 0))
    assert state.status == "optimal"
    assert state.load_factor == pytest.approx(0.0834, abs=5e-5)


def thick_wall(courses: int, headers: str, first: int) -> Assemblage:
    """Return a wall 1.5 x 3.9 m of two leaves of .25 m; first: whether course 0 runs through (0, stretchers) or not (headers)."""
    brick = (0.5, 0.25, 3.9 / courses)
    building = wall(length=1.5, brick=brick, courses=courses, pattern="header-stretcher", headers=headers, joints="bay")
    return derive_blocks(replace(building, panels=(replace(building.panels[0], runs_through=first),)))


@pytest.mark.parametrize(("headers", "expected"), [("none", 0.07640), ("english", 0.12253), ("flemish", 0.12537)])
def test_two_leaves_with_stretchers_at_the_foot(headers: str, expected: float) -> None:
    # Ten courses, as docs/validation.md has them for an independent layout.
    state = collapse(thick_wall(10, headers, 0), 0.6, (0, 1, 0))
    assert state.status == "optimal"
    assert state.load_factor == pytest.approx(expected, abs=2e-5)


@pytest.mark.parametrize("headers", ["english", "flemish"])
def test_headers_at_the_foot_make_two_leaves_one(headers: str) -> None:
    assert_optimal(collapse(thick_wall(13, headers, 1), 0.6, (0, 1, 0)), 0.5 / 3.9)


def test_stretchers_at_the_foot_leave_the_inner_leaf_behind() -> None:
    # The whole wall turns about its outer edge but for the inner stretchers of course 0, which it drags along.
    expected = foot_of_two_leaves(thickness=0.5, height=3.9, course=0.3, friction=0.6)
    assert expected == pytest.approx(0.123475, abs=1e-6)
    assert_optimal(collapse(thick_wall(13, "english", 0), 0.6, (0, 1, 0)), expected)


def foot_of_two_leaves(thickness: float, height: float, course: float, friction: float) -> float:
    """Return the load factor of a section of two bodies, an inner stretcher at the foot and all the rest, by linear programming.

    Unknown are the velocities (u, v, r) of both at their centroids; all joints between them and with the ground dilate.
    """
    stone = 0.5 * course / height
    foot = np.array([0.25 * thickness, 0.5 * course])
    rest = (np.array([0.5 * thickness, 0.5 * height]) - stone * foot) / (1 - stone)
    half = thickness / 2

    def velocity(body: int, point: tuple[float, float]) -> np.ndarray:
        x, z = point - (rest, foot)[body]
        rows = np.zeros((2, 6))
        rows[:, 3 * body : 3 * body + 3] = [[1, 0, -z], [0, 1, x]]
        return rows

    joints = [(velocity(0, p), 1) for p in ((half, 0), (thickness, 0))] + [(velocity(1, p), 1) for p in ((0, 0), (half, 0))]
    joints += [(velocity(0, p) - velocity(1, p), 0) for p in ((half, 0), (half, course))]
    joints += [(velocity(0, p) - velocity(1, p), 1) for p in ((0, course), (half, course))]
    closing = [side * friction * jump[1 - axis] - jump[axis] for jump, axis in joints for side in (-1, 1)]
    work, load = np.array([0, 1 - stone, 0, 0, stone, 0]), np.array([1 - stone, 0, 0, stone, 0, 0])
    found = linprog(work, np.array(closing), np.zeros(len(closing)), load[None], [1.0], bounds=(None, None))
    return float(found.fun)


def test_wedged_block_has_no_lateral_collapse() -> None:
    sides = [box((-1, 0), (0, 1), (0, 2)), box((1, 2), (0, 1), (0, 2))]
    plate = box((-5, 5), (-5, 5), (-1, 0))
    stones = Assemblage.from_polyhedra([plate, *sides, box((0, 1), (0, 1), (0, 1))], 18e3, fixed=[0, 1, 2])
    state = collapse(stones, 0.7)
    assert state.status == "unbounded"
    assert state.load_factor == np.inf


def test_load_factor_is_invariant_under_rotation_shift_scale_and_order() -> None:
    stones = on_ground(
        box((0, 1), (0, 1), (0, 1)),
        box((0.25, 1.25), (0, 1), (1, 2)),
        box((1.4, 2), (0, 1), (0, 2)),
        box((1.25, 2), (0, 1), (2, 3)),
    )
    expected = collapse(stones, 0.5).load_factor
    turn = np.array([[np.cos(0.4), -np.sin(0.4), 0], [np.sin(0.4), np.cos(0.4), 0], [0, 0, 1.0]])
    turned = moved(stones, turn, np.array([300.0, -200.0, 7.0]))
    assert collapse(turned, 0.5, tuple(turn[:, 0])).load_factor == pytest.approx(expected, rel=1e-6)
    # Four decades of scale: the solver's units follow the stones.
    for scale in (1e-2, 1e2):
        assert collapse(moved(stones, np.eye(3), np.zeros(3), scale), 0.5).load_factor == pytest.approx(expected, rel=1e-6)
    backwards = Assemblage.from_polyhedra(
        [(stones.points[8 * i : 8 * i + 8], box((0, 1), (0, 1), (0, 1))[1]) for i in reversed(range(stones.count))],
        18e3,
        fixed=[4],
    )
    assert collapse(backwards, 0.5).load_factor == pytest.approx(expected, rel=1e-6)


def test_whole_model_tilted_with_its_dead_load_gives_the_tilting_angle() -> None:
    # A block on a plane tilted by theta slides or overturns at tan(theta) = load factor: here gravity is applied as a
    # wrench in the tilted frame, so that the model carries what its own frame calls an oblique dead load.
    stones = on_ground(box((0, 1), (0, 1), (0, 2)))
    theta = np.arctan(0.3)
    weight = stones.weight[1]
    dead = np.zeros((2, 6))
    dead[1, :3] = weight * np.array([np.sin(theta), 0, 1 - np.cos(theta)])
    state = limit_analysis(stones, find_contacts(stones), LoadCase((1, 0, 0), dead=dead), friction=0.7)
    assert_optimal(state, 0.5 * np.cos(theta) - np.sin(theta))


def test_cohesion_holds_a_block_that_friction_alone_would_let_slide() -> None:
    # mu W + c A with no tension: sliding at mu + c A / W until overturning at b / h governs.
    stones = on_ground(box((0, 1), (0, 1), (0, 1)), unit_weight=20e3)
    assert_optimal(collapse(stones, 0.3, cohesion=4e3), 0.3 + 4e3 / 20e3)


@pytest.mark.parametrize("flow", ["associative", "non-associative"])
def test_without_friction_nothing_resists_sliding(flow: str) -> None:
    state = collapse(on_ground(box((0, 1), (0, 1), (0, 1))), 0.0, flow=flow)
    assert state.status == ("optimal" if flow == "associative" else "converged")
    assert state.load_factor == pytest.approx(0.0, abs=1e-9)
