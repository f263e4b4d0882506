"""Stones that nothing holds: known by their work, though a solver did not quite prove it, or as they run ahead of all others."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import churchpipe as cp
from churchpipe.conic.solve import solver_for
from churchpipe.large_displacements import following
from churchpipe.large_displacements import search as search_module
from churchpipe.large_displacements import step as step_module
from churchpipe.large_displacements.falling import stones_ahead, usual_speed
from churchpipe.large_displacements.motions import Motions
from churchpipe.large_displacements.moving_model import MovingModel, moving_model
from churchpipe.large_displacements.path import PathStep, may_go_on, solve_state, without
from churchpipe.large_displacements.path_state import PathState, first_state
from churchpipe.large_displacements.search import Attempt, StepSearch
from churchpipe.large_displacements.settings import EXACTING, PATH, THRIFTY, Demands
from churchpipe.large_displacements.settlement import settlement_model
from churchpipe.large_displacements.state_program import state_program, step_program
from churchpipe.large_displacements.step import StepAnswer, StepProgram, fallen_alone, falls, solve_step, without_dilatancy
from churchpipe.large_displacements.travelling import live_loads
from churchpipe.mechanism import reference_speed
from churchpipe.model.arrays import FloatArray
from churchpipe.rigid_blocks.coulomb import CoulombState
from churchpipe.rigid_blocks.equilibrium import equilibrium
from churchpipe.rigid_blocks.iterations import SlidingRun, SolveCount, sliding_run
from solids import box, moved, on_ground


def overhanging(out: float) -> StepProgram:
    """A block of 1 m, pushed sideways, whose centroid lies beyond the edge below where it stands out by more than half."""
    stones = on_ground(box((0, 1), (0, 1), (0, 1)), box((0, 1), (out, out + 1), (1, 1.5)))
    contacts, load = cp.find_contacts(stones), cp.LoadCase((1, 0, 0))
    balance, moving = equilibrium(stones, contacts, load), np.array([False, True, True])
    model = moving_model(stones, contacts, load, live_loads(stones, load), 0.6, balance, moving, None, "auto")
    return step_program(model, first_state(model))


def test_a_block_beyond_the_edge_falls() -> None:
    program = overhanging(0.6)
    answer = solve_step(program, np.zeros(len(program.closing)), solver_for(program.balance), EXACTING.duality_gap)
    assert answer.outcome == "infeasible"
    y = answer.y / float(program.dead @ answer.y)
    assert falls(program, y)
    # Nearly proved is enough, the other way round or roughly is not.
    noise = np.random.default_rng(0).normal(size=len(y)) * np.abs(y).max()
    assert falls(program, y + 1e-5 * noise)
    assert not falls(program, y + 0.1 * noise)
    assert not falls(program, -y)
    assert not falls(program, 0.0 * y)


def test_what_falls_under_the_dead_load_is_found_where_the_load_factor_has_no_program() -> None:
    program = overhanging(0.6)
    answer = fallen_alone(program, solver_for(program.balance, "interior-point"))
    assert answer.outcome == "infeasible"
    # The upper block tips over the edge. The lower one, the first of the free ones, may move a little: any motion falls on which
    # the dead load does work.
    below, above = np.abs(answer.y.reshape(2, 6)).max(axis=1)
    assert below < 0.05 * above
    assert program.dead @ answer.y > 0
    program = overhanging(0.3)
    assert fallen_alone(program, solver_for(program.balance, "interior-point")).outcome == "failed"


@pytest.mark.parametrize("seed", range(5))
def test_no_motion_of_a_block_that_stands_is_a_fall(seed: int) -> None:
    program = overhanging(0.3)
    assert not falls(program, np.random.default_rng(seed).normal(size=len(program.dead)))


def pebble(at: float = 0.2, rough: float = 0.05) -> tuple[MovingModel, PathState]:
    """A block of .5 x 1 m that tips at .5, with a pebble of some thousandth of its weight on top that slides at `rough`."""
    stones = on_ground(box((0, 0.5), (0, 1), (0, 1)), box((at, at + 0.1), (0.45, 0.55), (1, 1.1)))
    contacts, load = cp.find_contacts(stones), cp.LoadCase((1, 0, 0))
    friction = np.where(contacts.blocks.max(axis=1) == 2, rough, 0.6)
    balance, moving = equilibrium(stones, contacts, load), np.array([False, True, True])
    model = moving_model(stones, contacts, load, live_loads(stones, load), friction, balance, moving, 0.02, "auto")
    # As after a step of the whole: the block tipped, its fastest vertex at some 2.8 times the speed of its centroid.
    return model, replace(first_state(model), length=0.01, fastest=2.8)


def test_a_stone_that_runs_ahead_falls_and_the_others_go_on_as_they_did() -> None:
    model, state = pebble()
    step = solve_state(model, state)
    assert np.flatnonzero(step.falling).tolist() == [2]
    assert may_go_on(model, step)
    left = without(model, state, step)
    assert np.flatnonzero(left.fallen).tolist() == [2]
    # The pebble is some hundred times faster: a length that suited it would be far too short for the block.
    assert left.length == state.length
    assert left.fastest == state.fastest
    again = solve_state(model, left)
    assert again.answer.load_factor == pytest.approx(0.5, abs=1e-6)
    assert not again.falling.any()


def test_a_stone_that_gets_faster_from_step_to_step_is_measured_by_the_motion_of_the_whole() -> None:
    weight, spared = np.array([1000.0, 1000.0, 1.0]), 50.0
    whole = usual_speed(np.array([1.0, 2.0, 2.5]), np.inf, weight, spared, of_many=False)
    assert whole == 2.5
    # Eight times faster than the step before, twice.
    for fast, away in ((20.0, False), (160.0, True)):
        speed = np.array([0.2, 0.1, fast])
        assert stones_ahead(speed, whole, weight, spared, PATH.faster).tolist() == [False, False, away]
        whole = usual_speed(speed, whole, weight, spared, of_many=False)
    assert whole == 2.5
    # Another motion of the whole is a measure again, and so is that of a few stones with which a path begins.
    assert usual_speed(np.array([8.0, 0.0, 8.0]), whole, weight, spared, of_many=False) == 8.0
    assert usual_speed(np.array([0.0, 0.0, 8.0]), np.inf, weight, spared, of_many=False) == 8.0


def test_among_many_stones_one_that_runs_ahead_by_and_by_is_measured_by_most_of_them() -> None:
    # A voussoir slips through its opening arch: each step twice or three times as fast as in the one before.
    weight, spared, usual = np.ones(200), 10.0, np.inf
    for fast, away in ((1.0, False), (2.1, False), (6.5, True)):
        speed = np.append(np.linspace(0.2, 1.0, 199), fast)
        found = stones_ahead(speed, usual, weight, spared, THRIFTY.faster)
        assert np.flatnonzero(found).tolist() == [199] * away
        usual = usual_speed(speed, usual, weight, spared, of_many=True)
    # Measured by the fastest one it would never have been known.
    assert not stones_ahead(speed, 2.1, weight, spared, THRIFTY.faster).any()


def test_very_few_stones_are_known_to_fall_by_less_where_a_motion_does_not_fit() -> None:
    """Six times faster than usual is a fall of very few stones alone, in a motion that has come to rest without fitting."""
    model, state = pebble()
    model = replace(model, held=np.array([True, False, False]))
    stones, weight = model.stones, model.stones.weight
    y = np.zeros(12)
    y[6] = 6.0 * state.fastest
    for share, rests, away in ((2.0, True, True), (2.0, False, False), (0.5, True, False)):
        # A tenth of what may fall out weighs so many times as much as the pebble.
        moving = weight[2] * share / (PATH.few * PATH.expendable)
        motions = Motions(replace(model, moving=moving), state, stones, np.array([1, 2]))
        assert motions.falls(y, 0.02, rests) is away
        assert motions.falling(StepAnswer("solved", np.zeros((0, 3)), 1.0, y), rests=rests).tolist() == [False, False, away]


@pytest.mark.parametrize(
    ("others", "large", "share", "away"),
    [
        (1.0, False, 1.0, True),
        (3.0, False, 1.0, False),
        (3.0, True, 1.0, True),
        (3.0, False, 2.0 * PATH.shortest, False),
        (3.0, False, 0.5 * PATH.shortest, True),
    ],
)
def test_stones_fall_while_all_others_go_on_as_they_did(others: float, large: bool, share: float, away: bool) -> None:
    """Where the block is three times faster as well, the structure jumps. In a large model that says nothing of a stone, nor
    does it where steps have become so short, a share of the longest, that the structure goes nowhere while the stone falls."""
    model, state = pebble()
    model, state = replace(model, held=np.array([large, False, False])), replace(state, length=share * model.step)
    assert model.large is large
    y = np.zeros(12)
    y[0], y[6] = others * state.fastest, 100.0 * state.fastest
    motions = Motions(model, state, model.stones, np.array([1, 2]))
    assert motions.falls(y, 0.0, False) is away
    assert motions.falling(StepAnswer("solved", np.zeros((0, 3)), 1.0, y)).tolist() == [False, False, away]


@pytest.mark.parametrize(("gap", "away"), [(4e-3, False), (6e-3, True)])
def test_a_stone_does_not_hang_on_a_joint_that_has_opened(gap: float, away: bool) -> None:
    """A joint holds nothing from a quarter of a step of 20 mm on, though it would close within the step."""
    model, state = pebble(rough=0.6)
    model = replace(model, held=np.array([True, False, False]))
    on_top = state.joints.pair.max(axis=1) == 2
    joints = replace(state.joints, rest=state.joints.rest - gap * on_top, pressing=np.where(on_top, 0.0, 0.25))
    step = solve_state(model, replace(state, joints=joints))
    assert step.falling.tolist() == [False, False, away]
    # A stone that cannot be spared is not taken out before the search.
    step = solve_state(replace(model, moving=model.stones.weight[2]), replace(state, joints=joints))
    assert step.answer.outcome == "solved"


def test_a_few_stones_that_would_hold_all_others_back_give_way() -> None:
    """With the pebble, which slides at .05, the structure stands no more than that: associative analysis tells as much."""
    model, state = pebble()
    program = step_program(model, state)
    solve, gap = SolveCount(solver_for(program.balance)), np.zeros(len(program.closing))

    def search(falls: bool) -> StepSearch:
        return StepSearch(program, gap, solve, lambda _: 0.01, lambda *_: falls, 0.01, 0.02, THRIFTY)

    found = search(falls=True).giving_way(0.06, None)
    assert found is not None
    assert found.falls
    assert found.answer.load_factor == pytest.approx(0.05, rel=1e-4)
    assert solve.solves == 1
    assert search(falls=True).giving_way(0.04, None) is None
    assert search(falls=False).giving_way(0.06, None) is None


@pytest.mark.parametrize(
    ("falls", "astray", "far", "programs"),
    [(True, np.inf, np.inf, 2), (False, 1e-9, np.inf, 2), (False, np.inf, 2.0, 4), (False, np.inf, np.inf, 12)],
)
def test_no_more_is_asked_of_a_fall_than_which_stones_fall(falls: bool, astray: float, far: float, programs: int) -> None:
    """Stones that slide are sought in pairs of programs until they fit. A fall ends the search with the first pair, and so do
    forces that miss every motion by more than is worth going on with; the second pair, where six will not be enough."""
    model, state = pebble()
    program = step_program(model, state)
    solve = SolveCount(solver_for(program.balance))
    gap = np.zeros(len(program.closing))
    unending = replace(EXACTING, fitting=1e-300, enough=1e-300, far=far)
    search = StepSearch(program, gap, solve, lambda _: 0.01, lambda *_: falls, 0.01, 0.02, unending)
    forces = np.zeros((len(gap), 3))
    forces[:, 0] = 0.25 * np.where(np.arange(len(gap)) < 4, 1.0, 1e-3)
    attempt = search.by_pairs(Attempt(StepAnswer("failed", forces, np.nan, np.zeros(0)), 0.01), 6, astray=astray)
    assert attempt.falls is falls
    assert attempt.will_do(0.0) is falls
    assert solve.solves == programs


def test_a_motion_that_fits_well_enough_is_kept_although_it_goes_ten_times_less_far() -> None:
    model, state = pebble()
    program = step_program(model, state)
    solve = SolveCount(solver_for(program.balance))
    forces = np.zeros((len(program.closing), 3))
    forces[:, 0] = 0.25 * np.where(np.arange(len(forces)) < 4, 1.0, 1e-3)
    gap = np.full(len(forces), 1e-9)
    for demands, kept in ((replace(EXACTING, enough=10.0, shorter=25.0), True), (EXACTING, False)):
        search = StepSearch(program, gap, solve, lambda _: 0.001, lambda *_: False, 0.01, 0.02, replace(demands, fitting=1e-300))
        attempt = search.by_pairs(Attempt(StepAnswer("failed", forces, np.nan, np.zeros(0)), 0.01), 1)
        assert (attempt.length == 0.01) is kept
        assert search.way(attempt) == pytest.approx(0.001)


def test_a_stone_that_nothing_carries_falls_without_a_search_from_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    # More than half of the pebble hangs over the edge.
    model, state = pebble(0.46)
    pressing = np.full_like(state.joints.pressing, 0.125)
    state = replace(state, joints=replace(state.joints, pressing=pressing))
    asked: list[str] = []
    by_programs = StepSearch.by_programs

    def programs(*given: Any) -> Attempt:
        asked.append("programs")
        return by_programs(*given)

    monkeypatch.setattr(StepSearch, "by_programs", programs)
    for held in (True, False):
        step = solve_state(replace(model, held=np.array([held, False, False])), state)
        assert step.answer.outcome == "infeasible"
        assert np.flatnonzero(step.falling).tolist() == [2]
        assert not asked


@pytest.mark.parametrize(
    ("demands", "gaps", "rests", "kept"),
    [
        # Small enough, and it hardly falls any more.
        (THRIFTY, (0.04, 0.009, 0.0085, 0.004), [False, False, True], 0.0085),
        (EXACTING, (0.04, 0.009, 0.0085, 0.004), [False, False, True, False], 0.004),
        # Not small enough: twice in a row ends it, with the best.
        (THRIFTY, (0.04, 0.0118, 0.0117, 0.0155, 0.008), [False, False, True, True], 0.0117),
        (THRIFTY, (0.04, 0.0118, 0.0117, 0.009, 0.004), [False, False, True, False, False], 0.004),
        # Far away, and at this rate six pairs will not be enough.
        (THRIFTY, (0.04, 0.031, 0.004), [False, False], 0.031),
        (EXACTING, (0.04, 0.0118, 0.0117, 0.0155, 0.008), [False, False, True, True, False], 0.008),
    ],
)
def test_pairs_end_where_they_hardly_gain(
    monkeypatch: pytest.MonkeyPatch, demands: Demands, gaps: tuple[float, ...], rests: list[bool], kept: float
) -> None:
    model, state = pebble()
    program = step_program(model, state)
    y = program.live / float(program.live @ program.live)
    none = np.zeros((len(program.closing), 3))
    told: list[bool] = []

    def closed(*_: object, enough: Callable[[CoulombState], bool], **__: object) -> SlidingRun:
        found = [CoulombState(np.full_like(none, gap), 1.0, y, gap) for gap in gaps]
        return sliding_run(next((each for each in found if enough(each)), found[-1]), [], 0, 0)

    def fall(_: FloatArray, __: float, rests: bool) -> bool:
        told.append(rests)
        return False

    monkeypatch.setattr(step_module, "closed_gap", closed)
    given = StepAnswer("failed", none, np.nan, np.zeros(0))
    answer = without_dilatancy(program, given, solver_for(program.balance), demands, 6, fall)
    assert told == rests
    assert answer.forces == pytest.approx(kept)


def test_a_motion_that_does_not_fit_and_may_go_further_is_sought_with_that_length(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    model, state = pebble()
    program = step_program(model, state)
    y, none = np.ones(len(program.dead)), np.zeros((len(program.closing), 3))
    lengths: list[float] = []

    def answered(*given: Any) -> StepAnswer:
        lengths.append(attempts[-1])
        settled = given[-1]
        # Six times further: at once where it does not fit, and not with the last length that is tried.
        assert settled(y, 0.05, False) is (len(lengths) < PATH.lengths)
        assert not settled(y, 0.005, False)
        return StepAnswer("solved", none, 1.0, y, gap=0.05)

    attempts = [1.0]

    def longest(_: FloatArray) -> float:
        return 6.0 * attempts[-1]

    class Followed(StepSearch):
        def within(self, length: float) -> StepProgram:
            attempts.append(length)
            return super().within(length)

    monkeypatch.setattr(search_module, "without_dilatancy", answered)
    gap = np.full(len(none), 1e-9)
    search = Followed(program, gap, solver_for(program.balance), longest, lambda *_: False, 1.0, 1.0, THRIFTY)
    search.by_pairs(Attempt(StepAnswer("failed", none, np.nan, np.zeros(0)), 1.0), 6)
    assert lengths == [1.0, 6.0, 36.0]


def test_a_motion_that_fits_is_not_given_up_for_one_of_another_length_that_does_not(monkeypatch: pytest.MonkeyPatch) -> None:
    model, state = pebble()
    program = step_program(model, state)
    y = np.ones(len(program.dead))
    none = np.zeros((len(program.closing), 3))
    misfits = iter([0.005, 0.0002, 0.06])

    def answered(*_: object) -> StepAnswer:
        return StepAnswer("solved", none, 1.0, y, gap=next(misfits))

    monkeypatch.setattr(search_module, "without_dilatancy", answered)
    demands = replace(EXACTING, enough=0.01)
    gap, solve = np.full(len(none), 1e-9), solver_for(program.balance)
    search = StepSearch(program, gap, solve, lambda _: next(ways), lambda *_: False, 1.0, 1.0, demands)
    ways = iter([0.1, 0.01, 0.001, 0.001, 0.001])
    attempt = search.by_pairs(Attempt(StepAnswer("failed", none, np.nan, np.zeros(0)), 1.0), 6)
    assert (attempt.answer.misfit, attempt.length) == (0.0002, 0.1)
    # Where none fits, the one that misses least is what is known.
    misfits, ways = iter([0.07, 0.02, 0.5]), iter([0.1, 0.01, 0.001, 0.001, 0.001])
    attempt = search.by_pairs(Attempt(StepAnswer("failed", none, np.nan, np.zeros(0)), 1.0), 6)
    assert (attempt.answer.misfit, attempt.length) == (0.02, 0.1)
    # A motion that may go further than it was thought to goes on in the next step.
    misfits, ways = iter([0.005]), iter([10.0])
    assert search.by_pairs(Attempt(StepAnswer("failed", none, np.nan, np.zeros(0)), 1.0), 6).length == 1.0


def test_what_rounding_opens_is_no_gap_and_as_drawn_a_step_may_have_any_length() -> None:
    stack = on_ground(*(box((0, 0.3), (0, 1), (0.1 * i, 0.1 * (i + 1))) for i in range(7)))
    stones = moved(stack, Rotation.from_euler("z", 0.7).as_matrix(), np.array([1.0, 1.0, 1.0]) / 3)
    contacts, load = cp.find_contacts(stones), cp.LoadCase((1, 0, 0))
    balance = equilibrium(stones, contacts, load)
    model = moving_model(stones, contacts, load, live_loads(stones, load), 0.6, balance, ~stones.fixed, 0.02, "auto")
    state = first_state(model)
    assert np.abs(state.joints.at(state.poses)[1]).max() > 0.0
    assert not step_program(model, state).closing.any()
    # A length far from that of the motion costs no further programs, and the next step begins with the right one.
    long, short = (solve_state(model, replace(state, length=length)) for length in (1.0, 1e-5))
    assert long.answer.load_factor == short.answer.load_factor
    assert long.way == short.way == long.state.length == short.state.length


@pytest.mark.parametrize("large", [False, True])
def test_after_a_fall_a_large_model_goes_on_from_the_forces_found_in_it(large: bool) -> None:
    model, state = pebble()
    model = replace(model, held=np.array([large, False, False]))
    step = solve_state(model, state)
    joints = step.state.joints
    found = replace(step, state=replace(step.state, joints=replace(joints, pressing=np.full_like(joints.pressing, 0.125))))
    left = without(model, replace(state, joints=replace(state.joints, pressing=np.zeros_like(joints.pressing))), found)
    assert np.all(left.joints.pressing == (0.125 if large else 0.0))
    assert len(left.joints.pressing) == 4


def test_a_motion_that_misses_its_forces_by_far_ends_the_curve(monkeypatch: pytest.MonkeyPatch) -> None:
    stones = on_ground(box((0, 0.5), (0, 1), (0, 2)))
    contacts = cp.find_contacts(stones)
    steps: list[int] = []

    def astray(model: MovingModel, state: PathState) -> PathStep:
        steps.append(0)
        step = solve_state(model, state)
        gap = 0.2 * step.answer.load_factor if len(steps) == 4 else step.answer.gap
        return replace(step, answer=replace(step.answer, gap=gap))

    monkeypatch.setattr(following, "solve_state", astray)
    curve = cp.block_pushover(stones, contacts, cp.LoadCase((1, 0, 0)), 0.6, step=0.02)
    assert curve.status == "not-converged"
    assert "miss each other by 20%" in curve.message
    assert len(curve.load_factor) == 3
    assert curve.misfit.max() < 1e-6


@pytest.mark.parametrize("way", [0.5 * PATH.shortest, 2.0 * PATH.shortest])
def test_a_curve_that_gets_nowhere_in_a_jump_ends(monkeypatch: pytest.MonkeyPatch, way: float) -> None:
    """From the fourth step on no forces across closed joints are in balance, and a step is so long, over the longest."""
    stones = on_ground(box((0, 0.5), (0, 1), (0, 2)))
    contacts = cp.find_contacts(stones)
    steps: list[int] = []

    def jumps(model: MovingModel, state: PathState) -> PathStep:
        steps.append(0)
        step = solve_state(model, state)
        return step if len(steps) < 4 else replace(step, across=1.0, way=way * model.step / reference_speed(step.speed))

    monkeypatch.setattr(following, "solve_state", jumps)
    most = 3 + PATH.stalled + 5
    curve = cp.block_pushover(stones, contacts, cp.LoadCase((1, 0, 0)), 0.6, step=0.02, steps=most)
    nowhere = way < PATH.shortest
    assert len(curve.load_factor) == (3 + PATH.stalled if nowhere else most)
    assert curve.status == ("not-converged" if nowhere else "unfinished")
    assert ("25 tiny steps found no way on" in curve.message) is nowhere


def test_a_curve_whose_stones_hold_no_push_any_more_ends_there(monkeypatch: pytest.MonkeyPatch) -> None:
    stones = on_ground(box((0, 0.5), (0, 1), (0, 2)))
    contacts = cp.find_contacts(stones)

    def astray(model: MovingModel, state: PathState) -> PathStep:
        step = solve_state(model, state)
        fits = step.answer.load_factor > 0
        return step if fits else replace(step, answer=replace(step.answer, gap=1.0))

    monkeypatch.setattr(following, "solve_state", astray)
    curve = cp.block_pushover(stones, contacts, cp.LoadCase((1, 0, 0)), 0.6, step=0.02)
    assert curve.status == "collapsed"
    assert "hold no push any more" in curve.message
    # Past a quarter of a metre the centroid is beyond the toe; the last step before it is the careful end.
    assert curve.d0 == curve.displacement[-1]
    assert 0.25 - 0.02 < curve.d0 < 0.25


def test_a_support_that_moves_is_no_stone_that_falls() -> None:
    stones = on_ground(box((0, 1), (0, 1), (0, 1)))
    model, state, *_ = settlement_model(
        stones, cp.find_contacts(stones), ([0], (0, 0, -1), None), 0.6, None, None, "auto", "corners", None
    )
    placed, _, free, _ = state_program(model, state)
    down = np.array([0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0])
    falls = StepAnswer("infeasible", np.zeros((0, 3)), np.nan, down)
    assert Motions(model, state, placed, free).falling(falls).tolist() == [False, True]
