"""The interior-point core against Clarabel, from the arrays that it returns."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from churchpipe.conic.clarabel import solve_clarabel
from churchpipe.conic.interior_point import (
    Info,
    InteriorPointSolver,
    Settings,
    solve_interior_point,
)
from churchpipe.conic.program import ConeProgram, ConeSolution
from churchpipe.conic.wrenches import apply
from churchpipe.errors import InputError
from churchpipe.model.assemblage import Assemblage, Polyhedron
from churchpipe.model.loads import LoadCase
from churchpipe.rigid_blocks.limit import limit_analysis
from churchpipe.stones.contacts import find_contacts
from churchpipe.stones.soundness import floating_stones
from cone_programs import KINDS_OF_POINTS, stated, three_stones
from solids import box, on_ground


def wall(columns: int, courses: int) -> Assemblage:
    stones: list[Polyhedron] = []
    for course in range(courses):
        shift = 0.5 * (course % 2)
        z = 0.4 * course
        stones += [box((i + shift, i + 1 + shift), (0, 0.5), (z, z + 0.4)) for i in range(columns)]
    return on_ground(*stones)


def check_forces(program: ConeProgram, answer: ConeSolution) -> None:
    residual = program.residual(answer.x, answer.tau)
    assert np.abs(residual).max() <= 1e-9
    shear = np.hypot(answer.x[:, 1], answer.x[:, 2])
    assert (answer.x[:, 0] >= 0).all()
    assert (answer.x[:, 0] <= program.bound).all()
    assert (shear <= np.maximum(program.limit + program.slope * answer.x[:, 0], 0) + 1e-15).all()


def dual_value(program: ConeProgram, x: np.ndarray, y: np.ndarray) -> float:
    """Work of the velocities of an uncapped program: an upper bound of tau, up to excess rates times n."""
    rate = program.rates(y)
    slip = np.hypot(rate[:, 1], rate[:, 2])
    excess = np.maximum(0.0, program.slope * slip - rate[:, 0] - program.linear - program.quadratic * x[:, 0])
    price = np.where(np.isfinite(program.bound), program.bound, x[:, 0])
    return float(-program.constant @ y + program.limit @ slip + price @ excess)


@pytest.mark.parametrize("options", KINDS_OF_POINTS)
def test_every_kind_of_point_agrees_with_clarabel(options: dict[str, float]) -> None:
    program = stated(three_stones(), **options)
    ours, reference = solve_interior_point(program, Settings(duality_gap=1e-7)), solve_clarabel(program)
    assert ours.outcome == reference.outcome == "solved"

    def value(answer: ConeSolution) -> float:
        n = answer.x[:, 0]
        return float(answer.tau - program.linear @ n - 0.5 * program.quadratic @ n**2)

    assert value(ours) == pytest.approx(value(reference), abs=1e-7)
    check_forces(program, ours)
    if program.cap == np.inf:
        assert program.growth @ ours.y == pytest.approx(1.0, abs=1e-8)


@pytest.mark.parametrize("bound", [np.inf, 1.0, 0.04, 0.03])
def test_wall_has_matching_bounds(bound: float) -> None:
    program = stated(wall(12, 12), slope=0.6, bound=bound)
    answer = solve_interior_point(program)
    assert answer.outcome == "solved"
    check_forces(program, answer)
    if bound < 1:
        assert answer.x[:, 0].max() == pytest.approx(bound, rel=1e-5)
        assert answer.tau == pytest.approx(solve_clarabel(program).tau, rel=1e-6)
    assert dual_value(program, answer.x, answer.y) == pytest.approx(answer.tau, rel=1e-6)


@st.composite
def assemblages(draw: st.DrawFn) -> tuple[Assemblage, float, tuple[float, float, float]]:
    """Stacks of boxes whose sizes differ by up to a factor of 400, and small walls with stones missing."""
    numbers = np.random.default_rng(draw(st.integers(0, 10**6)))
    stones: list[Polyhedron] = []
    if draw(st.booleans()):
        spread, reach, x, z = draw(st.sampled_from([0.1, 0.4])), draw(st.sampled_from([0.3, 3.0])), 0.0, 0.0
        width = 1.0
        for _ in range(draw(st.integers(1, 5))):
            x += spread * width * numbers.uniform(-1, 1)
            width, depth, height = np.exp(numbers.uniform(-reach, reach, 3)).tolist()
            stones.append(box((x - width / 2, x + width / 2), (-depth / 2, depth / 2), (z, z + height)))
            z += height
    else:
        for course in range(draw(st.integers(1, 5))):
            for column in range(draw(st.integers(1, 4))):
                if course == 0 or numbers.random() < 0.9:
                    left = column + 0.5 * (course % 2)
                    stones.append(box((left, left + 1), (0, 0.5), (0.4 * course, 0.4 * course + 0.4)))
    friction = draw(st.sampled_from([0.1, 0.3, 0.6, 0.9]))
    direction = numbers.normal(size=3) * [1, 1, 0.2]
    return on_ground(*stones), friction, (float(direction[0]), float(direction[1]), float(direction[2]))


Drawn = tuple[Assemblage, float, tuple[float, float, float]]


@settings(max_examples=40, deadline=None, derandomize=True)
@given(assemblages())
def test_random_assemblages_agree_with_clarabel(case: Drawn) -> None:
    assert_agreement(case)


@pytest.mark.slow
@settings(max_examples=150, deadline=None, derandomize=True)
@given(assemblages())
def test_more_random_assemblages_agree_with_clarabel(case: Drawn) -> None:
    assert_agreement(case)


@pytest.mark.slow
@settings(max_examples=2000, deadline=None)
@given(assemblages())
def test_many_random_assemblages_agree_with_clarabel(case: Drawn) -> None:
    assert_agreement(case)


def assert_agreement(case: Drawn) -> None:
    """Certified where Clarabel is, with the same load factor, and never wrong or without an answer."""
    stones, friction, direction = case
    contacts, load = find_contacts(stones), LoadCase(direction)
    assume(not len(floating_stones(stones, contacts)))
    ours = limit_analysis(stones, contacts, load, friction, solver="interior-point")
    reference = limit_analysis(stones, contacts, load, friction, solver="clarabel")
    assume(not abs(ours.load_factor) < 1e-4)
    # Clarabel now and then misses the tolerance of a certificate; what our own arrays prove stands by itself.
    assert reference.status in (ours.status, "failed")
    assert ours.status in ("optimal", "unstable", "unbounded")
    if reference.status == "optimal":
        assert ours.load_factor == pytest.approx(reference.load_factor, rel=1e-6)


@pytest.mark.parametrize("size", [0.3, 0.03, 0.003, 0.0003])
def test_a_chip_counts_like_a_block(size: float) -> None:
    """A free-standing 1 : 4 chip falls at .25, whatever stands beside it: weights here differ by up to 5e11."""
    chip, block = box((5, 5 + size), (0, size), (0, 4 * size)), box((0, 2), (0, 2), (0, 2))
    stones = on_ground(block, chip)
    state = limit_analysis(stones, find_contacts(stones), LoadCase((1, 0, 0)), 0.4, solver="interior-point")
    assert (state.status, state.load_factor) == ("optimal", pytest.approx(0.25, rel=1e-6))
    tilted = on_ground(block, chip, box((5 + 0.9 * size, 5 + 1.9 * size), (0, size), (4 * size, 5 * size)))
    state = limit_analysis(tilted, find_contacts(tilted), LoadCase((1, 0, 0)), 0.4, solver="interior-point")
    assert state.status == "unstable"
    feet = [box((x, x + size), (y, y + size), (0, size)) for x in (0, 2 - size) for y in (0, 2 - size)]
    table = on_ground(*feet, box((0, 2), (0, 2), (size, 2 + size)))
    state = limit_analysis(table, find_contacts(table), LoadCase((1, 0, 0)), 0.4, solver="interior-point")
    assert (state.status, state.load_factor) == ("optimal", pytest.approx(0.4, rel=1e-6))


def test_overhang_is_infeasible_with_its_mechanism() -> None:
    program = stated(on_ground(box((0, 1), (0, 1), (0, 1)), box((0.8, 2.8), (0, 1), (1, 2))), direction=(0, 1, 0))
    answer = solve_interior_point(program)
    assert answer.outcome == "infeasible"
    work = float(program.constant @ answer.y)
    assert work > 0
    rate = program.rates(answer.y) / work
    assert (rate[:, 0] - program.slope * np.hypot(rate[:, 1], rate[:, 2])).min() > -1e-6
    assert abs(program.growth @ answer.y) / work < 1e-6


def test_stone_without_contact_is_infeasible() -> None:
    program = stated(on_ground(box((0, 1), (0, 1), (0, 1)), box((3, 4), (0, 1), (2, 3))))
    answer = solve_interior_point(program)
    assert answer.outcome == "infeasible"
    assert program.constant @ answer.y > 0
    assert np.abs(program.rates(answer.y)).max() == 0


def test_push_into_the_ground_is_unbounded_with_its_ray() -> None:
    program = stated(on_ground(box((0, 1), (0, 1), (0, 1))), direction=(0, 0, -1))
    answer = solve_interior_point(program)
    assert answer.outcome == "unbounded"
    assert np.abs(apply(program.balance, answer.x) + program.growth).max() < 1e-6
    assert (program.slope * answer.x[:, 0] >= np.hypot(answer.x[:, 1], answer.x[:, 2]) - 1e-9).all()


def test_one_solver_serves_programs_with_one_balance() -> None:
    stones = wall(6, 6)
    first = stated(stones, slope=0.6)
    solver = InteriorPointSolver(first.balance)
    for program in (first, stated(stones, limit=0.01, slope=-0.001), stated(stones, slope=0.0, limit=0.02, quadratic=0.1)):
        assert solver.solve(program).tau == pytest.approx(solve_clarabel(program).tau, rel=1e-6)
    with pytest.raises(InputError, match="another balance"):
        solver.solve(stated(wall(6, 5)))


def test_progress_ends_at_the_tolerance() -> None:
    seen: list[Info] = []
    answer = solve_interior_point(stated(wall(5, 5), slope=0.6), Settings(duality_gap=1e-6), seen.append)
    assert [info.iteration for info in seen] == list(range(answer.iterations + 1))
    assert seen[-1].error <= 1e-6 < 1 < seen[0].error


def test_an_analysis_tells_what_is_solved_and_which_share_of_it() -> None:
    told: list[tuple[str, float]] = []
    stones = wall(5, 5)
    limit_analysis(stones, find_contacts(stones), LoadCase((1, 0, 0)), progress=lambda what, share: told.append((what, share)))
    assert list(dict.fromkeys(what for what, _ in told)) == ["dead load", "associative"]
    for stage in ("dead load", "associative"):
        shares = [share for what, share in told if what == stage]
        assert shares[0] == 0.0
        assert shares[-1] == pytest.approx(1.0)
        assert shares == sorted(shares)
        assert len({*shares}) > 5


def test_too_few_iterations_fail_honestly() -> None:
    answer = solve_interior_point(stated(wall(5, 5), slope=0.6), Settings(iterations=4))
    assert answer.outcome == "failed"
    assert "iteration limit" in answer.message


@pytest.mark.parametrize("name", ["duality_gap", "fraction", "iterations", "regularisation"])
def test_settings_out_of_range_are_refused(name: str) -> None:
    bad = {"duality_gap": 0.0, "fraction": 1.0, "iterations": 0, "regularisation": 1.0}
    with pytest.raises(InputError, match=f"Settings.{name}"):
        Settings(**{name: bad[name]})  # pyright: ignore
