"""The motion of an assemblage step by step: programs in the displaced geometry, and where each takes the stones."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import scipy.sparse as sp

from churchpipe.conic.pressed import pressed_joints
from churchpipe.conic.solve import Solve, solver_for
from churchpipe.conic.wrenches import Balance, apply
from churchpipe.large_displacements.falling import falling_stones
from churchpipe.large_displacements.joints import Joints
from churchpipe.large_displacements.moving_model import MovingModel, bearing
from churchpipe.large_displacements.poses import Poses, displaced, start_poses
from churchpipe.large_displacements.renewal import renewed
from churchpipe.large_displacements.search import Attempt, StepSearch
from churchpipe.large_displacements.settings import PATH
from churchpipe.large_displacements.step import StepAnswer, StepProgram, solve_step
from churchpipe.large_displacements.travelling import TravellingLoads
from churchpipe.large_displacements.twisted import friction_shift
from churchpipe.mechanism import reference_speed, stone_speed
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.stone_path import FallenStones
from churchpipe.rigid_blocks.certificate import Strength
from churchpipe.rigid_blocks.equilibrium import contact_wrenches
from churchpipe.rigid_blocks.iterations import approached_forces
from churchpipe.rigid_blocks.pressed import with_further
from churchpipe.rigid_blocks.settings import SchemeSettings


@dataclass(frozen=True, slots=True)
class PathState:
    """Where a path has got to: poses, joints, which stones have fallen (nb,), length of the step, m per unit of work.

    fastest: speed of the fastest stone in the last step whose motion was credible. before (nb, 6): velocities of the last step
    at the origin, way (m per unit of work) how far it went; None as drawn. rest (nt,) m: what ties have been pulled to.
    """

    poses: Poses
    joints: Joints
    fallen: BoolArray
    length: float
    fastest: float = np.inf
    before: FloatArray | None = None
    way: float = 0.0
    rest: FloatArray = field(default_factory=lambda: np.zeros(0))


@dataclass(frozen=True, slots=True)
class PathStep:
    """A program solved at a state: its answer, velocities (nb, 6), speeds (nb,) and rates (nc, 3) n, t1, t2 of the points.

    state: that at which it was solved, sliding and length of step as they became. way: to the next state, m per unit of work.
    friction_power: work of friction over the weight per unit of work. falling (nb,): stones that fall.
    """

    state: PathState
    answer: StepAnswer
    speed: FloatArray
    velocity: FloatArray
    rate: FloatArray
    way: float
    friction_power: float
    falling: BoolArray


def first_state(model: MovingModel) -> PathState:
    """Return the state as drawn."""
    still = model.stones.fixed | model.held
    joints = model.drawn.selected(bearing(still, model.drawn.blocks))
    none = np.zeros(len(still), dtype=bool)
    return PathState(start_poses(model.stones), joints, none, model.step, rest=model.ties.first_rest)


def state_at(model: MovingModel, every: Sequence[Poses], fallen: Sequence[FallenStones]) -> PathState:
    """Return the state at the last of all poses of a path so far, without the stones that have fallen: to go on from there.

    What the joints slid by and how fast the stones were is not known any more: the next program finds it again.
    """
    gone = np.zeros(model.stones.count, dtype=bool)
    for part in fallen:
        gone[part.stones] = True
    first = first_state(model)
    rest = first.rest
    for poses in every:
        rest = model.ties.yielded(rest, poses)
    return _renewed(model, replace(first, poses=every[-1], fallen=gone, rest=rest))


def as_in(model: MovingModel, state: PathState, normal: FloatArray, velocities: FloatArray) -> PathState:
    """Return a state whose points press and slide as in an analysis without dilatancy: its normal forces (nc,) N and velocities
    (nb, 6)."""
    _, program, free, _ = _program(model, state)
    y = velocities[free]
    y = np.concatenate([y[:, :3], model.length * y[:, 3:]], axis=1).ravel()
    power = float(program.live @ y)
    slip = program.slip(y / power)[: len(normal)] if power > 0 else state.joints.sliding
    pressing, shear = np.maximum(normal, 0.0) / model.force, np.zeros_like(state.joints.shear)
    return replace(state, joints=replace(state.joints, sliding=slip, pressing=pressing, shear=shear))


def approached(model: MovingModel, state: PathState) -> PathState:
    """Return a state whose points press as in forces that hardly exceed friction, sought from those that it has."""
    program, points = step_program(model, state), len(state.joints.pressing)
    forces = np.zeros(len(program.closing))
    forces[:points] = state.joints.pressing
    solve = solver_for(program.balance, model.solver)
    forces, _ = approached_forces(program, program.strength, forces, solve, SchemeSettings(), rough=True)
    return replace(state, joints=replace(state.joints, pressing=forces[:points]))


def step_program(model: MovingModel, state: PathState) -> StepProgram:
    """Return the program of a step from a state, of the length of the last one."""
    _, program, _, gap = _program(model, state)
    return program.within(gap, program.softness, state.length)


def solve_state(
    model: MovingModel, state: PathState, programs: int = PATH.programs, pairs: int = PATH.pairs, rounds: int = PATH.rounds
) -> PathStep:
    """Return the step that a state takes.

    A point may close at the rate of its gap over the length of the step, and slides at the price of the normal force times what
    sliding opened, mu |v|, in the program before: so it need not dilate. Length and slip come out of the program, which is
    solved again until they agree, so many times at the most. That need not happen: where many joints slide the programs go round
    in circles. Forces and motion that fit each other are then sought from the last one, in so many pairs of programs.

    Where friction acts about the centres of pressure, the step is solved again until these are those of its own forces, in so
    many rounds at the most.
    """
    step = _solved(model, state, programs, pairs)
    for count in range(rounds if model.contact_model == "torsion" else 0):
        lever, change = _levers(model, step)
        joints = step.state.joints
        if step.answer.outcome != "solved" or change < PATH.at_rest:
            break
        share = 1.0 if count < PATH.whole_way else 0.5
        joints = replace(joints, lever=joints.lever + share * (lever - joints.lever))
        step = _solved(model, replace(step.state, joints=joints), programs, pairs)
    return step


def _levers(model: MovingModel, step: PathStep) -> tuple[FloatArray, float]:
    """Return where friction acts beside the points (nc, 3) m under the forces of a step, and by how much of a stone that is
    another place than the one taken there, in the mean over these forces."""
    joints = step.state.joints
    contacts, _ = joints.at(step.state.poses)
    tangents = contacts.frame[contacts.interface_of_point, 1:]
    n = np.maximum(step.answer.forces[: len(joints.lever), 0], 0.0)
    shift = friction_shift(contacts, n, np.einsum("kac,kc->ka", tangents, joints.lever))
    lever = np.einsum("kac,ka->kc", tangents, shift)
    moved = float(n @ np.linalg.norm(lever - joints.lever, axis=1)) / max(float(n.sum()), 1e-300)
    return lever, moved / model.length


def _solved(model: MovingModel, state: PathState, programs: int, pairs: int) -> PathStep:
    """Return the step that a state takes with friction acting where its joints say."""
    stones, program, free, gap = _program(model, state)
    solve, points = solver_for(program.balance, model.solver), len(state.joints.sliding)
    tangents = state.joints.at(state.poses)[0].frame[state.joints.interface, 1:]
    sliding, forces = np.zeros(len(gap)), np.zeros((len(gap), 3))
    sliding[:points], forces[:points, 0] = state.joints.sliding, state.joints.pressing
    # Whole forces let the programs begin near them: quicker, and a little less exact, which only a large model is worth.
    if model.large:
        forces[:points, 1:] = np.einsum("kac,kc->ka", tangents, state.joints.shear)

    def longest(y: FloatArray) -> float:
        return _length(model, stones, _velocities(model, state, free, y))

    search = StepSearch(program, gap, solve, longest, state.length, model.step, model.fitting)
    # Where forces and motion fitted each other in pairs of programs only, the forces of the last step are the best to begin with:
    # they keep the path on its way where others branch off.
    attempt = begin = Attempt(StepAnswer("failed", forces, np.nan, np.zeros(0)), state.length)
    if pairs and forces.any() and not program.softness.any():
        # A large program that has no solution need not be shown twice to have none: the search below shows it once more.
        own = solver_for(program.balance, "interior-point") if model.large and model.solver == "auto" else solve
        last = _last_velocities(model, state, free, program)
        attempt = search.by_pairs(begin._replace(answer=replace(begin.answer, y=last)), pairs, own)
        if len(last) and not attempt.fits(model.enough):
            # Where the motion turns into another, the last one leads astray.
            attempt = _better(attempt, search.by_pairs(begin, pairs, own))
    if not attempt.fits(model.enough):
        attempt = _better(attempt, search.by_programs(sliding, programs, pairs))
    answer, way, joints = attempt.answer, 0.0, state.joints
    if answer.outcome == "solved":
        at = search.within(attempt.length)
        sliding = at.slip(answer.y)
        way = min(attempt.length, search.way(attempt))
        if attempt.paired or not attempt.fits(model.fitting):
            if answer.misfit < PATH.credible:
                shear = np.einsum("kac,ka->kc", tangents, answer.forces[:points, 1:])
                joints = replace(joints, pressing=np.maximum(answer.forces[:points, 0], 0.0), shear=shear)
        else:
            joints = replace(joints, pressing=np.zeros(points), shear=np.zeros((points, 3)))
        joints = replace(joints, sliding=sliding[:points])
        answer = _with_present_tensions(model, state, at, answer, sliding, solve)
    velocity = _velocities(model, state, free, answer.y)
    # Where the load does hardly any work, as in a fall, rates are measured by the mean speed of the weight.
    answer = replace(answer, gap=answer.gap / max(1.0, _mean_speed(model, velocity)))
    speed = stone_speed(stones, velocity)
    rate = program.motion(answer.y)
    return PathStep(
        state=replace(state, joints=joints, length=attempt.length),
        answer=answer,
        speed=speed,
        velocity=velocity,
        rate=rate,
        way=way,
        friction_power=-_work(model, answer, rate),
        falling=falling_stones(answer, speed, state.fastest, model.stones.weight, _expendable(model, state)),
    )


def _better(one: Attempt, other: Attempt) -> Attempt:
    """Return the attempt of which more is known: the other one, but where the first has a motion that is at least credible."""
    if one.answer.outcome != "solved" or other.answer.outcome == "unbounded":
        return other
    if other.answer.outcome == "solved":
        return one if one.answer.misfit < other.answer.misfit else other
    return one if one.answer.misfit < PATH.credible else other


def _with_present_tensions(
    model: MovingModel, state: PathState, program: StepProgram, answer: StepAnswer, sliding: FloatArray, solve: Solve
) -> StepAnswer:
    """Return the answer with load factor and forces under the tensions that elastic ties have at this state.

    Its motion is that under the tensions which they reach within the step, or stones that a stiff tie holds would run away.
    """
    count = len(model.ties.name)
    tension = model.ties.tension(state.rest, state.poses, model.ties.broken(state.rest, state.fallen)) / model.force
    known = np.zeros(len(sliding), dtype=bool)
    known[program.points - count : program.points] = np.isfinite(tension)
    if not (count and np.isfinite(model.ties.stiffness).any()):
        return answer
    pull = np.zeros((len(sliding), 3))
    pull[known, 0] = tension[np.isfinite(tension)]
    strength = replace(program.strength, bound=np.where(known, 0.0, program.strength.bound))
    dead = program.dead + apply(program.balance, pull)
    held = replace(program, dead=dead, strength=strength, softness=np.zeros_like(program.softness))
    found = solve_step(held, sliding, solve)
    if found.outcome != "solved":
        return answer
    forces = found.forces + pull
    return replace(answer, forces=forces, load_factor=found.load_factor, residual=found.residual, violation=found.violation)


def _work(model: MovingModel, answer: StepAnswer, rate: FloatArray) -> float:
    """Return the work per unit of work of friction, of ties on their ends, and of pressure on joints that crush: negative."""
    work = answer.forces[: len(rate)] * rate
    if model.strength is None:
        work[: len(rate) - len(model.ties.name), 0] = 0.0
    return float(work.sum())


def next_state(model: MovingModel, step: PathStep, furthest: float = np.inf) -> PathState:
    """Return the state after a step, its contacts found anew; furthest: m per unit of work, the longest way that it may go.

    While the motion changes little it goes on as it did since the last step (Adams and Bashforth, second order): a linkage
    keeps its hinges. The velocities are those at the origin, which do not change where a stone turns about an axis at rest.
    """
    state, way = step.state, min(step.way, furthest)
    centre = state.poses.centroid
    there = step.velocity.copy()
    there[:, :3] -= np.cross(there[:, 3:], centre)
    motion = there
    if state.before is not None:
        change = there - state.before
        at_stone = change.copy()
        at_stone[:, :3] += np.cross(change[:, 3:], centre)
        if float(stone_speed(_standing(model, state), at_stone).max()) < PATH.steady * float(step.speed.max(initial=0.0)):
            motion = there + 0.5 * way / state.way * change
    twist = motion.copy()
    twist[:, :3] += np.cross(motion[:, 3:], centre)
    # A stone that settles into a gap turns as far however short the step is: a step that it made short is made longer again.
    short = 4 * state.length * reference_speed(step.speed) < model.step
    return _renewed(
        model,
        replace(
            state,
            poses=state.poses.moved(way * twist),
            length=2 * state.length if short else state.length,
            fastest=float(step.speed.max(initial=0.0)) if step.answer.misfit < PATH.credible else state.fastest,
            before=there,
            way=way,
        ),
    )


def without(model: MovingModel, step: PathStep) -> PathState:
    """Return the state of a step without the stones that fall."""
    return _renewed(model, replace(step.state, fallen=step.state.fallen | step.falling))


def may_go_on(model: MovingModel, step: PathStep) -> bool:
    """True when the stones that fall may be spared: they are light, and something is left to push."""
    left = ~(step.state.fallen | step.falling)
    if isinstance(model.driven, TravellingLoads) and not model.driven.on(left):
        return False
    return float(model.stones.weight[step.falling].sum()) <= _expendable(model, step.state)


def _expendable(model: MovingModel, state: PathState) -> float:
    """Return the weight, N, that may still fall out without ending the curve."""
    return PATH.expendable * model.moving - float(model.stones.weight[state.fallen].sum())


def _renewed(model: MovingModel, state: PathState) -> PathState:
    stones = _standing(model, state)
    crushing = model.strength is not None
    joints = renewed(state.joints, stones, state.poses, state.fallen, model.reach, crushing=crushing)
    return replace(state, joints=joints, rest=model.ties.yielded(state.rest, state.poses))


def _free(model: MovingModel, state: PathState) -> BoolArray:
    return ~(model.stones.fixed | model.held | state.fallen)


def _standing(model: MovingModel, state: PathState) -> Assemblage:
    return displaced(model.stones, state.poses, ~_free(model, state))


def _program(model: MovingModel, state: PathState) -> tuple[Assemblage, StepProgram, IntArray, FloatArray]:
    """Return the stones, the program of a state, the free stones, and the gaps of its points; slack of its ties."""
    stones = _standing(model, state)
    contacts, gap = state.joints.at(state.poses)
    free = np.flatnonzero(~stones.fixed)
    rotation = state.poses.rotation
    dead = model.dead.rows(rotation, free, model.force, model.length)
    friction = model.friction.of(contacts.blocks, stones.count)[contacts.interface_of_point]
    bound, softness = np.full(len(gap), np.inf), np.zeros(len(gap))
    at = contacts.point + state.joints.lever if model.contact_model == "torsion" else None
    if isinstance(model.driven, TravellingLoads):
        balance: Balance = contact_wrenches(stones, contacts, free, model.length, at)
        live = model.driven.rows(rotation, free, model.force, model.length)
        if model.ties.name:
            balance = balance.joined(model.ties.wrenches(state.poses, free, model.length))
            broken = model.ties.broken(state.rest, state.fallen)
            bound = np.append(bound, np.where(broken, 0.0, model.ties.strength / model.force))
            gap = np.append(gap, np.where(broken, 0.0, state.rest - model.ties.lengths(state.poses)))
            softness = np.append(softness, np.where(broken, 0.0, model.force / model.ties.stiffness))
            friction = np.append(friction, np.zeros(len(broken)))
    else:
        twist = model.driven.twist(state.poses)
        twist[:, 3:] *= model.length
        wrenches = contact_wrenches(stones, contacts, np.append(free, model.driven.stones), model.length, at)
        # Of the balance of the support only that along its movement is left.
        along = sp.block_diag([sp.identity(6 * len(free)), twist.reshape(1, -1)], format="csr")
        balance = sp.csc_matrix(along @ wrenches.tocsc())
        dead, live = np.append(dead, 0.0), np.append(np.zeros_like(dead), 1.0)
    strength, points, rows = Strength(friction, np.zeros_like(bound), bound), len(bound), len(dead)
    if model.strength is not None:
        joints = state.joints
        capacity = model.strength.of(joints.blocks, stones.count) * joints.rectangle / model.force
        crush = np.isfinite(capacity)
        bear = np.flatnonzero(crush[joints.interface])
        number = (np.cumsum(crush) - 1)[joints.interface[bear]]
        if len(bear):
            pressed = pressed_joints(bear, number, joints.place[bear], capacity[crush], 1.0 / int(crush.sum()), points)
            balance, strength = pressed.below(balance), with_further(strength, pressed)
            dead, live = np.append(dead, pressed.constant), np.append(live, np.zeros_like(pressed.constant))
            gap, softness = (np.append(each, np.zeros(len(strength.bound) - points)) for each in (gap, softness))
    return stones, StepProgram(balance, dead, live, strength, np.zeros_like(gap), points, rows, softness), free, gap


def _velocities(model: MovingModel, state: PathState, free: IntArray, y: FloatArray) -> FloatArray:
    out = np.zeros((model.stones.count, 6))
    out[free] = y[: 6 * len(free)].reshape(-1, 6)
    out[:, 3:] /= model.length
    if not isinstance(model.driven, TravellingLoads):
        out[model.driven.stones] = y[6 * len(free)] * model.driven.twist(state.poses)
    return out


def _last_velocities(model: MovingModel, state: PathState, free: IntArray, program: StepProgram) -> FloatArray:
    """Return the multipliers of the last motion where the stones are now, for a large model with the rows of its stones alone."""
    stones_alone = isinstance(model.driven, TravellingLoads) and len(program.dead) == 6 * len(free)
    if state.before is None or not model.large or not stones_alone:
        return np.zeros(0)
    velocity = state.before[free]
    there = velocity[:, :3] + np.cross(velocity[:, 3:], state.poses.centroid[free])
    y = np.concatenate([there, model.length * velocity[:, 3:]], axis=1).ravel()
    power = float(program.live @ y)
    return y / power if power > 0 else np.zeros(0)


def _mean_speed(model: MovingModel, velocity: FloatArray) -> float:
    return float(np.linalg.norm(velocity[:, :3], axis=1) @ model.stones.weight) / model.force


def _length(model: MovingModel, stones: Assemblage, velocity: FloatArray) -> float:
    """Return the length of the step, m per unit of work, in which no stone goes or turns further than it may."""
    reference = reference_speed(stone_speed(stones, velocity))
    turn = float(np.linalg.norm(velocity[:, 3:], axis=1).max(initial=0.0))
    return min(model.step / max(reference, 1e-300), PATH.turn / max(turn, 1e-300))
