"""The motion of an assemblage step by step: programs in the displaced geometry, and where each takes the stones."""

from dataclasses import dataclass, replace

import numpy as np

from churchpipe.conic.solve import solver_for
from churchpipe.large_displacements.falling import SPARED, falling_stones
from churchpipe.large_displacements.joints import Joints
from churchpipe.large_displacements.poses import Poses, displaced
from churchpipe.large_displacements.renewal import PairFriction, renewed
from churchpipe.large_displacements.step import StepAnswer, StepProgram, solve_step
from churchpipe.large_displacements.travelling import TravellingLoads
from churchpipe.mechanism import reference_speed, stone_speed
from churchpipe.model.arrays import BoolArray, FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.rigid_blocks.equilibrium import contact_matrix

# Programs as drawn that lead from sliding with dilatancy to sliding without; fewer where the load factor has settled.
_FIRST, _SETTLED = 8, 1e-7
# Largest rotation in a step, rad.
_TURN = 0.02
# A length of step that is right within this factor is kept.
_NEAR = 1.6
# Points that bear less than this share of the largest force do not press.
_PRESSING = 1e-7


@dataclass(frozen=True, slots=True)
class MovingModel:
    """What stays the same on the way: stones as drawn, loads, friction of pairs; `step`, m, the largest displacement of a step.

    force N and length m are the units of the programs; held (nb,): stones that cannot move.
    """

    stones: Assemblage
    dead: TravellingLoads
    live: TravellingLoads
    friction: PairFriction
    held: BoolArray
    force: float
    length: float
    step: float
    solver: str


@dataclass(frozen=True, slots=True)
class PathState:
    """Where a path has got to: poses, joints, which stones have fallen (nb,), length of the step (m per unit of work) and the
    fastest speed of the last one."""

    poses: Poses
    joints: Joints
    fallen: BoolArray
    length: float
    fastest: float = np.inf


@dataclass(frozen=True, slots=True)
class PathStep:
    """A program solved at a state: its answer, velocities (nb, 6) and speeds (nb,), and the twist (nb, 6) m, rad to the next state.

    state: that at which it was solved, allowances and length of step as they became. friction_work: over the weight, m.
    """

    state: PathState
    answer: StepAnswer
    speed: FloatArray
    twist: FloatArray
    friction_work: float
    lost: BoolArray


def first_state(model: MovingModel, joints: Joints, poses: Poses) -> tuple[PathState, StepAnswer]:
    """Return the state as drawn, from which a path starts without the lift that sliding costs once, and its last answer.

    Each program charges the sliding of the one before, so that it need not dilate.
    """
    state = PathState(poses, joints, np.zeros(model.stones.count, dtype=bool), 1.0)
    stones, program, free, gap = _program(model, state)
    solve = solver_for(program.matrix, model.solver)
    charge, answer, before = np.zeros(len(gap)), None, np.inf
    for _ in range(_FIRST):
        answer = solve_step(program, charge, solve)
        if answer.outcome != "solved" or abs(answer.load_factor - before) < _SETTLED * abs(before):
            break
        before, charge = answer.load_factor, program.slip(answer.y)
    assert answer is not None
    if answer.outcome != "solved":
        return state, answer
    length = _length(model, stones, _velocities(model, free, answer.y))
    return replace(state, joints=replace(joints, allowance=length * charge), length=length), answer


def solve_state(model: MovingModel, state: PathState) -> PathStep:
    """Return the step that a state takes.

    The gap of each point over the length of the step is what it may close; the length follows from the speed that comes out, so
    that both are sought together. It may fall by half at the most: what a joint has opened to let the last step slide would
    count as open otherwise. The stones may go any smaller part of the way.
    """
    stones, program, free, gap = _program(model, state)
    solve = solver_for(program.matrix, model.solver)
    length, allowance = state.length, state.joints.allowance
    for attempt in range(3):
        answer = solve_step(program, np.maximum(gap + allowance, 0.0) / length, solve)
        velocity = _velocities(model, free, answer.y)
        if answer.outcome != "solved":
            break
        wanted = _length(model, stones, velocity)
        better = max(wanted, 0.5 * state.length)
        if attempt == 2 or max(better / length, length / better) < _NEAR:
            break
        pressing = answer.forces[:, 0] > _PRESSING * answer.forces[:, 0].max(initial=0.0)
        allowance = np.where(pressing, np.maximum(allowance + program.slip(answer.y) * (better - length), 0.0), allowance)
        length = better
    speed = stone_speed(stones, velocity)
    way = min(length, wanted) if answer.outcome == "solved" else 0.0
    rate = program.rates(answer.y)
    return PathStep(
        state=replace(state, joints=replace(state.joints, allowance=allowance), length=length),
        answer=answer,
        speed=speed,
        twist=way * velocity,
        friction_work=-way * float((answer.forces * rate).sum()),
        lost=falling_stones(answer, speed, state.fastest),
    )


def next_state(model: MovingModel, step: PathStep) -> PathState:
    """Return the state after a step, its contacts found anew."""
    state = step.state
    poses = state.poses.moved(step.twist)
    fastest = float(step.speed.max(initial=0.0))
    return _renewed(model, replace(state, poses=poses, fastest=fastest))


def without(model: MovingModel, step: PathStep) -> PathState:
    """Return the state of a step without the stones that fall."""
    return _renewed(model, replace(step.state, fallen=step.state.fallen | step.lost))


def may_go_on(model: MovingModel, step: PathStep, moving: FloatArray) -> bool:
    """True when the stones that have fallen may be spared; moving (nb,): the weight of those that moved at the start, N."""
    gone = step.state.fallen | step.lost
    return float(model.stones.weight[gone].sum()) < SPARED * float(moving.sum())


def _renewed(model: MovingModel, state: PathState) -> PathState:
    stones = _standing(model, state)
    return replace(state, joints=renewed(state.joints, stones, state.poses, state.fallen, 2.0 * model.step))


def _free(model: MovingModel, state: PathState) -> BoolArray:
    return ~(model.stones.fixed | model.held | state.fallen)


def _standing(model: MovingModel, state: PathState) -> Assemblage:
    return replace(displaced(model.stones, state.poses), fixed=~_free(model, state))


def _program(model: MovingModel, state: PathState) -> tuple[Assemblage, StepProgram, np.ndarray, FloatArray]:
    stones = _standing(model, state)
    contacts, gap = state.joints.at(state.poses)
    free = np.flatnonzero(~stones.fixed)
    rotation = state.poses.rotation
    program = StepProgram(
        matrix=contact_matrix(stones, contacts, free, model.length),
        dead=model.dead.rows(rotation, free, model.force, model.length),
        live=model.live.rows(rotation, free, model.force, model.length),
        friction=model.friction.of(contacts.blocks, stones.count)[contacts.interface_of_point],
    )
    return stones, program, free, gap


def _velocities(model: MovingModel, free: np.ndarray, y: FloatArray) -> FloatArray:
    out = np.zeros((model.stones.count, 6))
    out[free] = y.reshape(-1, 6)
    out[:, 3:] /= model.length
    return out


def _length(model: MovingModel, stones: Assemblage, velocity: FloatArray) -> float:
    """Return the length of the step, m per unit of work, in which no stone goes or turns further than it may."""
    reference = reference_speed(stone_speed(stones, velocity))
    turn = float(np.linalg.norm(velocity[:, 3:], axis=1).max(initial=0.0))
    return min(model.step / max(reference, 1e-300), _TURN / max(turn, 1e-300))
