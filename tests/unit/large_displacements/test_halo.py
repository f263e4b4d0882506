"""The halo of still stones around those that move: the same curve as of the full model, and it grows where its rim moves."""

from dataclasses import replace

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.large_displacements import following, pushover
from churchpipe.large_displacements.following import Ending
from churchpipe.large_displacements.halo import grown, held_around, held_at_first, shrunk
from churchpipe.large_displacements.moving_model import MovingModel, moving_model
from churchpipe.large_displacements.path import PathStep, next_state, solve_state
from churchpipe.large_displacements.path_state import PathState, first_state, renewed_state
from churchpipe.large_displacements.travelling import live_loads
from churchpipe.model.arrays import BoolArray
from churchpipe.model.contacts import Contacts
from churchpipe.rigid_blocks.certificate import Strength
from churchpipe.rigid_blocks.equilibrium import Equilibrium, equilibrium
from churchpipe.rigid_blocks.limit import limit_program
from solids import box, on_ground

PUSH = cp.LoadCase((1, 0, 0), panels=["column"])


def row(count: int, courses: int) -> tuple[cp.Assemblage, Contacts]:
    """A row of blocks side by side, with a column on the third that alone is pushed, and may lean on nothing."""
    base = [box((i, i + 1), (0, 1), (0, 1)) for i in range(count)]
    column = [box((2.3, 2.7), (0, 1), (1 + 0.5 * i, 1.5 + 0.5 * i)) for i in range(courses)]
    plate = box((-9, count + 9), (-5, 5), (-1, 0))
    panel = ["ground", *["base"] * count, *["column"] * courses]
    stones = cp.Assemblage.from_polyhedra([plate, *base, *column], 18e3, fixed=[0], panel=panel)
    return stones, cp.find_contacts(stones)


def test_stones_far_from_what_moves_are_held() -> None:
    stones, contacts = row(20, 4)
    moving = stones.panel == "column"
    held = held_around(stones, contacts.blocks, moving, 2)
    # One contact to the third block, and one more to those beside it.
    assert np.flatnonzero(~held[1:21]).tolist() == [1, 2, 3]
    assert not held[moving].any()
    assert not held[0]
    # A halo that leaves out next to nothing, or nothing that moves: no stone is held.
    assert not held_around(stones, contacts.blocks, moving, 18).any()
    assert not held_around(stones, contacts.blocks, np.zeros(stones.count, dtype=bool), 2).any()


@pytest.mark.parametrize("halo", [1, pytest.param(3, marks=pytest.mark.slow("docs/capacity_curve.md: halos"))])
def test_the_curve_is_that_of_the_full_model(halo: int) -> None:
    stones, contacts = row(20, 4)
    part = cp.block_pushover(stones, contacts, PUSH, 0.6, step=0.02, halo=halo)
    full = cp.block_pushover(stones, contacts, PUSH, 0.6, step=0.02, halo=0)
    assert part.load_factor == pytest.approx(full.load_factor, abs=1e-6)
    assert part.d0 == pytest.approx(full.d0, rel=1e-6)
    assert part.proved


@pytest.mark.parametrize(("halo", "shorter"), [(1, 4), (0, 1)])
def test_a_large_model_goes_less_far_where_the_next_step_would_not_be_proved(
    monkeypatch: pytest.MonkeyPatch, halo: int, shorter: int
) -> None:
    """Each step is halved until the one after it is proved; in a small model, it is kept as it is."""
    stones, contacts = row(20, 4)
    taken = cp.block_pushover(stones, contacts, PUSH, 0.6, step=0.02, steps=3, halo=halo)

    def doubtful(model: MovingModel, state: PathState) -> PathStep:
        step = solve_state(model, state)
        return replace(step, across=0.02) if state.way > 0.3 * step.way else step

    monkeypatch.setattr(following, "solve_state", doubtful)
    halved = cp.block_pushover(stones, contacts, PUSH, 0.6, step=0.02, steps=3, halo=halo)
    assert halved.displacement == pytest.approx(taken.displacement / shorter, rel=1e-3)
    assert halved.proved == (shorter > 1)


def test_a_large_model_goes_as_far_as_before_where_no_step_is_proved_any_more(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where proof is lost is known to a quarter of a step; then steps are as long as others, and the curve comes to d0."""
    stones, contacts = row(20, 4)

    def doubtful(model: MovingModel, state: PathState) -> PathStep:
        step = solve_state(model, state)
        gone = np.abs(state.poses.centroid - stones.centroid).max()
        return replace(step, across=0.02) if gone > 0.1 else step

    taken = cp.block_pushover(stones, contacts, PUSH, 0.6, step=0.03, halo=1)
    monkeypatch.setattr(following, "solve_state", doubtful)
    doubted = cp.block_pushover(stones, contacts, PUSH, 0.6, step=0.03, halo=1)
    assert doubted.status == taken.status == "vanished"
    assert doubted.d0 == pytest.approx(taken.d0, rel=1e-6)
    # A quarter of a step is reached in two halvings.
    assert len(doubted.misfit) <= len(taken.misfit) + 2
    assert 0 < doubted.largest[doubted.misfit > 0.01][0] - 0.1 < 0.25 * 0.03


def test_a_load_that_grows_with_the_height_is_that_of_all_stones() -> None:
    """What is held weighs as much in the profile of the load as what moves."""
    stones, contacts = row(20, 4)
    load = cp.LoadCase((1, 0, 0), profile="linear")
    friction = np.where(contacts.blocks.min(axis=1) == 0, 0.9, 0.2)
    state = cp.limit_analysis(stones, contacts, load, friction)
    balance = equilibrium(stones, contacts, load)
    moving = stones.panel == "column"
    model = moving_model(stones, contacts, load, live_loads(stones, load), friction, balance, moving, None, "auto")

    def program(still: BoolArray) -> tuple[Equilibrium, Strength]:
        bears = ~still[contacts.blocks].all(axis=1)
        return limit_program(replace(stones, fixed=still), contacts.selected(bears), load, friction[bears])[:2]

    held = held_at_first(model, contacts.blocks, program, state, 2)
    # The top of the column slides off; two stones below it are near.
    assert np.flatnonzero(~held).tolist() == [0, 22, 23, 24]


def sliding_top() -> tuple[MovingModel, Contacts]:
    """A stack of eight blocks that slides on the third bed, all but the top one held."""
    stones = on_ground(*[box((0, 1), (0, 1), (0.2 * i, 0.2 * i + 0.2)) for i in range(8)])
    contacts = cp.find_contacts(stones)
    lowest = contacts.blocks.min(axis=1)
    friction = np.where(lowest == 2, 0.2, 0.6)
    load = cp.LoadCase((1, 0, 0))
    moving = np.arange(stones.count) > 2
    balance = equilibrium(stones, contacts, load)
    model = moving_model(stones, contacts, load, live_loads(stones, load), friction, balance, moving, None, "auto")
    return replace(model, held=np.isin(np.arange(9), range(1, 8))), contacts


def test_the_halo_grows_until_its_rim_stands_still() -> None:
    model, _ = sliding_top()
    step = solve_state(model, first_state(model))
    # Held at the next bed below, the top block slides where friction is .6.
    assert step.answer.load_factor == pytest.approx(0.6, abs=1e-6)
    times = 0
    while (wider := grown(model, step, 2)) is not None:
        model, state = wider
        step = solve_state(model, state)
        times += 1
    assert times > 1
    assert step.answer.load_factor == pytest.approx(0.2, abs=1e-6)
    assert np.flatnonzero(model.held).tolist() in ([], [1])
    # The joints that were left out are those of the drawing.
    assert len(next_state(model, step).joints.blocks) >= 7


def moving_with(model: MovingModel, stones: list[int]) -> PathState:
    """The state of a model as drawn after a step in which these stones went along the x axis, and all others stood still."""
    before = np.zeros((model.stones.count, 6))
    before[stones, 0] = 1.0
    return replace(first_state(model), before=before, way=0.01)


def test_stones_that_stand_still_by_now_are_held() -> None:
    stones, contacts = row(20, 4)
    balance, pushed = equilibrium(stones, contacts, PUSH), stones.panel == "column"
    column = np.flatnonzero(pushed).tolist()
    model = moving_model(stones, contacts, PUSH, live_loads(stones, PUSH), 0.6, balance, pushed, None, "auto")
    followed = replace(model, held=np.arange(stones.count) == 20)
    state = moving_with(followed, column)
    less, left = shrunk(followed, state, 2)
    assert np.flatnonzero(~less.held[1:21]).tolist() == [1, 2, 3]
    assert not less.held[column].any()
    kept = left.joints.blocks
    assert not (less.held | stones.fixed)[kept].all(axis=1).any()
    assert len(kept) < len(state.joints.blocks)
    step, full = solve_state(less, left), solve_state(followed, state)
    assert step.answer.load_factor == pytest.approx(full.answer.load_factor, abs=1e-6)
    # Nothing is held in a small model, without a halo, before the first step, where a few light stones move alone, or for the
    # sake of few stones.
    assert shrunk(model, state, 2)[0] is model
    assert shrunk(followed, state, 0)[0] is followed
    assert shrunk(followed, first_state(followed), 2)[0] is followed
    heavy = replace(followed, moving=100 * model.moving)
    assert shrunk(heavy, state, 2)[0] is heavy
    assert shrunk(followed, moving_with(followed, [*column, *range(5, 20)]), 2)[0] is followed


def test_stones_that_moved_before_they_were_held_are_let_go_where_they_stand() -> None:
    model, _ = sliding_top()
    free = replace(model, held=np.isin(np.arange(9), [1]))
    state = moving_with(free, list(range(3, 9)))
    shift = np.zeros((9, 6))
    shift[3:, 0] = 0.05
    there = renewed_state(free, replace(state, poses=state.poses.moved(shift)))
    less, left = shrunk(free, replace(there, before=moving_with(free, [8]).before), 1)
    assert np.flatnonzero(less.held).tolist() == [1, 2, 3, 4, 5, 6]
    step = solve_state(less, left)
    while (wider := grown(less, step, 2)) is not None:
        less, left = wider
        step = solve_state(less, left)
    assert step.answer.load_factor == pytest.approx(0.2, abs=1e-6)
    # The third bed is that of two stones that have slid by .05 m.
    joints = step.state.joints
    bed = joints.at(step.state.poses)[0].point[(joints.pair == [2, 3]).all(axis=1), 0]
    assert (bed.min(), bed.max()) == pytest.approx((0.05, 1.0))


def test_loose_stones_are_told_by_the_motion_of_the_limit_analysis(monkeypatch: pytest.MonkeyPatch) -> None:
    """A large model begins with its fastest speed, a small one with none."""
    stones, contacts = row(20, 4)
    state = cp.limit_analysis(stones, contacts, PUSH, 0.6)
    begun: list[float] = []

    def followed(_: MovingModel, start: PathState, *__: object) -> Ending:
        begun.append(start.fastest)
        return Ending("unfinished")

    monkeypatch.setattr(pushover, "follow", followed)
    for halo in (1, 0):
        cp.block_pushover(stones, contacts, PUSH, 0.6, halo=halo, state=state)
    # The column of .4 x 2 m tips about its foot; per unit of its work on the weight of all stones.
    weight = stones.weight / stones.weight.sum()
    turn = 1.0 / float(weight[21:] @ (stones.centroid[21:, 2] - 1.0))
    assert begun[0] == pytest.approx(turn * np.hypot(0.4, 2.0), rel=1e-6)
    assert begun[1] == np.inf
