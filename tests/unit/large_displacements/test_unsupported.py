"""Stones that their neighbours cannot carry, found one by one."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import churchpipe as cp
from churchpipe.conic.solve import solver_for
from churchpipe.conic.wrenches import pair_wrenches
from churchpipe.large_displacements.motions import Motions
from churchpipe.large_displacements.moving_model import MovingModel, moving_model
from churchpipe.large_displacements.path import solve_state
from churchpipe.large_displacements.path_state import first_state
from churchpipe.large_displacements.search import Attempt, StepSearch
from churchpipe.large_displacements.seeking import unsupported_fall
from churchpipe.large_displacements.settings import PATH, THRIFTY
from churchpipe.large_displacements.state_program import state_program, step_program
from churchpipe.large_displacements.step import StepAnswer, StepProgram, fallen_alone
from churchpipe.large_displacements.travelling import live_loads
from churchpipe.large_displacements.unsupported import unsupported
from churchpipe.model.assemblage import Assemblage
from churchpipe.rigid_blocks.certificate import Strength
from churchpipe.rigid_blocks.coulomb import bipotential_gap
from churchpipe.rigid_blocks.equilibrium import equilibrium
from solids import box, moved, on_ground


def model_of(stones: Assemblage, friction: float = 0.6) -> MovingModel:
    contacts, load = cp.find_contacts(stones), cp.LoadCase((1, 0, 0))
    balance = equilibrium(stones, contacts, load)
    return moving_model(stones, contacts, load, live_loads(stones, load), friction, balance, ~stones.fixed, None, "auto")


def program_of(stones: Assemblage, friction: float = 0.6) -> StepProgram:
    model = model_of(stones, friction)
    return step_program(model, first_state(model))


@pytest.mark.parametrize("turn", [0.0, 0.4, 2.0])
@pytest.mark.parametrize(("out", "falls"), [(0.3, False), (0.499, False), (0.501, True), (0.8, True)])
def test_a_block_falls_when_its_centroid_lies_beyond_the_edge(out: float, falls: bool, turn: float) -> None:
    stones = on_ground(box((0, 1), (0, 1), (0, 1)), box((0, 1), (out, out + 1), (1, 1.5)))
    stones = moved(stones, Rotation.from_euler("z", turn).as_matrix(), np.zeros(3))
    assert unsupported(program_of(stones), 0.0).tolist() == [False, falls]


def test_a_stone_falls_after_the_one_that_it_rests_on() -> None:
    # The third rests on the second, which lies more than half beyond the edge, the fourth on the first.
    stones = on_ground(
        box((0, 1), (0, 1), (0, 1)),
        box((0, 1), (0.6, 1.6), (1, 1.5)),
        box((0, 1), (1.2, 1.6), (1.5, 2)),
        box((0, 1), (0, 0.4), (1, 1.5)),
    )
    assert unsupported(program_of(stones, 0.3), 0.0).tolist() == [False, True, True, False]
    # A third stone that stood fast would hold the second by friction: they fall together, which is not seen stone by stone.
    assert not unsupported(program_of(stones, 0.6), 0.0).any()


@pytest.mark.parametrize(("friction", "falls"), [(0.5, False), (0.0, True)])
def test_a_stone_between_two_others_is_held_by_friction_alone(friction: float, falls: bool) -> None:
    beside = box((0, 1), (0, 1), (0, 2)), box((0, 1), (1.5, 2.5), (0, 2))
    stones = on_ground(*beside, box((0, 1), (1, 1.5), (1, 2)))
    assert unsupported(program_of(stones, friction), 0.0).tolist() == [False, False, falls]


@pytest.mark.parametrize(("share", "falls"), [(0.5 * PATH.drift, False), (2.0 * PATH.drift, True)])
def test_a_stone_hangs_on_joints_that_are_hardly_open_only_where_a_motion_fits(share: float, falls: bool) -> None:
    beside = box((0, 4), (0, 4), (0, 4)), box((0, 4), (4.5, 8.5), (0, 4))
    stones = on_ground(*beside, box((0, 1), (4, 4.5), (1, 2)))
    model = model_of(stones)
    state = first_state(model)
    _, program, free, gap = state_program(model, state)
    gap[(state.joints.pair == np.flatnonzero(~stones.fixed)[2]).any(axis=1)] = share * model.step
    motions, program = Motions(model, state, stones, free), program.within(gap, program.softness, state.length)
    assert unsupported_fall(motions, program, gap, PATH.open) is None
    fall = unsupported_fall(motions, program, gap, PATH.drift)
    assert (fall is not None) == falls
    assert fall is None or motions.falling(fall).nonzero()[0].tolist() == [free[2]]
    # It weighs less than a hundredth of what moves, and more than a thousandth.
    assert (unsupported_fall(motions, program, gap, PATH.drift, 0.2) is not None) == falls
    assert unsupported_fall(motions, program, gap, PATH.drift, 0.02) is None


@pytest.mark.parametrize(
    ("size", "share", "falls"),
    [
        # Very few by weight, a thousandth of what moves, fall even from joints that have hardly opened.
        (0.5, 0.5 * PATH.drift, False),
        (0.5, 2.0 * PATH.drift, True),
        # Others fall from joints that are open by a quarter of the step.
        (2.0, 2.0 * PATH.drift, False),
        (2.0, 2.0 * PATH.open, True),
    ],
)
def test_in_a_small_model_stones_that_hang_fall_where_no_motion_fits(
    monkeypatch: pytest.MonkeyPatch, size: float, share: float, falls: bool
) -> None:
    beside = box((0, 4), (0, 4), (0, 4)), box((0, 4), (4.5, 8.5), (0, 4))
    stones = on_ground(*beside, box((0, size), (4, 4.5), (1, 1 + size)))
    model, small = model_of(stones), int(np.flatnonzero(~stones.fixed)[2])
    state = first_state(model)
    joints = replace(state.joints, rest=state.joints.rest - share * model.step * (state.joints.pair == small).any(axis=1))
    state = replace(state, joints=replace(joints, pressing=np.ones_like(joints.pressing)))
    monkeypatch.setattr(StepSearch, "by_pairs", lambda _, attempt, *__: attempt)

    def searched(*_: object) -> Attempt:
        raise RuntimeError("a motion is sought from nothing")

    monkeypatch.setattr(StepSearch, "by_programs", searched)
    assert not model.large
    if not falls:
        with pytest.raises(RuntimeError, match="from nothing"):
            solve_state(model, state)
        return
    assert solve_state(model, state).falling.nonzero()[0].tolist() == [small]


@pytest.mark.parametrize(("foot", "falls"), [(1.0, True), (0.0, False)])
def test_a_stone_lets_go_of_joints_that_its_motion_leaves_open(foot: float, falls: bool) -> None:
    """Friction holds it between two others across a joint that stays open: it falls, unless it stands on the ground as well."""
    beside = box((0, 1), (0, 1), (0, 2)), box((0, 1), (1.5, 2.5), (0, 2))
    stones = on_ground(*beside, box((0, 1), (1, 1.5), (foot, foot + 1)))
    model = model_of(stones)
    state = first_state(model)
    _, program, free, gap = state_program(model, state)
    open_ = (np.sort(state.joints.pair) == free[1:]).all(axis=1)
    gap[open_] = 1e-3
    forces = np.zeros((len(gap), 3))
    forces[open_, 0] = 0.5
    y = np.zeros(18)
    y[::6] = 1.0 / program.live[::6].sum()
    search = StepSearch(program, gap, solver_for(program.balance), lambda _: 0.01, lambda *_: False, 0.01, 0.02, THRIFTY)
    at = search.within(0.01)
    answer = StepAnswer("solved", forces, 0.3, y, gap=bipotential_gap(at, at.strength, forces, y))
    attempt = Attempt(answer, 0.01)
    assert attempt.answer.misfit > PATH.credible
    found = search.letting_go(attempt, PATH.pairs, None)
    assert (found is not None) == falls
    if found:
        speed = np.linalg.norm(found.answer.y.reshape(-1, 6)[:, :3], axis=1)
        assert np.flatnonzero(speed > PATH.foremost * speed.max()).tolist() == [2]


@pytest.mark.parametrize(("width", "friction", "limit"), [(0.6, 0.6, 0.3), (2.0, 0.4, 0.4)])
def test_a_stone_falls_that_cannot_stand_the_push(width: float, friction: float, limit: float) -> None:
    """A block 2 m high tips at width / 2, and slides at its friction, or at 2 % more since cones are widened to pyramids."""
    program = program_of(on_ground(box((0, width), (0, 1), (0, 2))), friction)
    assert not unsupported(program, 0.99 * limit).any()
    assert unsupported(program, 1.03 * limit).all()


def random_body(random: np.random.Generator, friction: float) -> StepProgram:
    """A body of a weight on two to six points of a support, their normals up to 60 degrees from the vertical."""
    count = int(random.integers(2, 7))
    tilt = random.uniform(0, np.pi / 3, count)
    turns = np.stack([random.uniform(0, 2 * np.pi, count), tilt, random.uniform(0, 2 * np.pi, count)], axis=1)
    # Rows n, t1, t2: the vertical turned away from itself.
    frames = Rotation.from_euler("ZYZ", turns).as_matrix().transpose(0, 2, 1)[:, [2, 0, 1]]
    arms = random.uniform(-1, 1, (count, 1, 3)) * np.array([1.0, 1.0, 0.5]) - np.array([0, 0, 0.7])
    balance = pair_wrenches(1, np.tile([-1, 0], (count, 1)), np.repeat(arms, 2, axis=1), frames, np.arange(count))
    dead, live = np.array([0, 0, -1.0, 0, 0, 0]), np.array([1.0, 0, 0, 0, 0, 0])
    zero = np.zeros(count)
    strength = Strength(np.full(count, friction), zero, np.full(count, np.inf))
    return StepProgram(balance, dead, live, strength, zero, count, 6, zero)


def test_what_falls_is_what_a_program_of_the_dead_load_brings_down() -> None:
    random = np.random.default_rng(3)
    seen = {True: 0, False: 0}

    def alone(program: StepProgram) -> bool:
        return fallen_alone(program, solver_for(program.balance, "clarabel")).outcome == "infeasible"

    for _ in range(60):
        program = random_body(random, 0.5)
        found = bool(unsupported(program, 0.0)[0])
        seen[found] += 1
        if found:
            assert alone(program)
        else:
            # The pyramid holds what a cone of as many per cent more would.
            wider = replace(program, strength=replace(program.strength, friction=program.strength.friction / np.cos(np.pi / 16)))
            assert not alone(wider)
    assert min(seen.values()) > 10
