"""The motion of an assemblage step by step: programs in the displaced geometry, and where each takes the stones."""

from dataclasses import dataclass, replace
from operator import attrgetter

import numpy as np

from churchpipe.conic.solve import Solve, solver_for
from churchpipe.conic.wrenches import apply
from churchpipe.large_displacements.falling import usual_speed
from churchpipe.large_displacements.joints import Joints
from churchpipe.large_displacements.motions import Motions, expendable, light
from churchpipe.large_displacements.moving_model import MovingModel
from churchpipe.large_displacements.path_state import PathState, renewed_state, standing
from churchpipe.large_displacements.search import Attempt, StepSearch
from churchpipe.large_displacements.seeking import sought
from churchpipe.large_displacements.settings import PATH
from churchpipe.large_displacements.state_program import pressure_levers, state_program
from churchpipe.large_displacements.step import StepAnswer, StepProgram, fitting_forces, solve_step, step_answer
from churchpipe.large_displacements.travelling import TravellingLoads
from churchpipe.mechanism import reference_speed, stone_speed
from churchpipe.model.arrays import BoolArray, FloatArray
from churchpipe.rigid_blocks.coulomb import CoulombState, bipotential_gap
from churchpipe.rigid_blocks.interval import no_higher


@dataclass(frozen=True, slots=True)
class PathStep:
    """A program solved at a state: its answer, velocities (nb, 6), speeds (nb,) and rates (nc, 3) n, t1, t2 of the points.

    state: that at which it was solved, sliding and length of step as they became. way: to the next state, m per unit of work.
    across: `StepSearch.across`. friction_power: work of friction over the weight per unit of work. falling (nb,): stones
    that fall, held (nb,): those held.
    """

    state: PathState
    answer: StepAnswer
    speed: FloatArray
    velocity: FloatArray
    rate: FloatArray
    way: float
    across: float
    friction_power: float
    falling: BoolArray
    held: BoolArray

    @property
    def misfit(self) -> float:
        """What the step lacks of one without dilatancy whose forces act across closed gaps alone, over the load factor."""
        return self.answer.misfit + self.across


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
    n = np.maximum(step.answer.forces[: len(joints.lever), 0], 0.0)
    lever = pressure_levers(step.state, n)
    moved = float(n @ np.linalg.norm(lever - joints.lever, axis=1)) / max(float(n.sum()), 1e-300)
    return lever, moved / model.length


def _solved(model: MovingModel, state: PathState, programs: int, pairs: int) -> PathStep:
    """Return the step that a state takes with friction acting where its joints say."""
    stones, program, free, gap = state_program(model, state)
    solve, motions = solver_for(program.balance, model.solver), Motions(model, state, stones, free)
    demands = model.demands if state.before is not None else replace(model.demands, fitting=model.demands.begins)
    search = StepSearch(program, gap, solve, motions.longest, motions.falls, state.length, model.step, demands)
    attempt = sought(motions, search, program, gap, programs, pairs)
    attempt = search.closing(attempt, pairs)
    across = 0.0
    answer, way, length, joints = attempt.answer, 0.0, attempt.length, state.joints
    if answer.outcome == "solved":
        at = search.within(attempt.length)
        sliding = at.slip(answer.y)
        way, length = search.way(attempt), search.next_length(attempt)
        across = search.across(attempt)
        joints = replace(_pressed(model, state, attempt), sliding=sliding[: len(joints.sliding)])
        answer = _with_present_tensions(model, state, attempt, at, sliding, solve)
        state = replace(state, load_factor=answer.load_factor)
    velocity, rate = motions.velocities(answer.y), program.motion(answer.y)
    # Where the load does hardly any work, as in a fall, rates are measured by the mean speed of the weight.
    answer = replace(answer, gap=answer.gap / max(1.0, motions.mean_speed(answer.y)))
    return PathStep(
        state=replace(state, joints=joints, length=length),
        answer=answer,
        speed=stone_speed(stones, velocity),
        velocity=velocity,
        rate=rate,
        way=way,
        across=across,
        friction_power=-_work(model, answer, rate),
        falling=motions.falling(answer, rests=attempt.falls),
        held=model.held,
    )


def _pressed(model: MovingModel, state: PathState, attempt: Attempt) -> Joints:
    """Return the joints of a state with the forces that the next step begins with: none where it does so by programs alone."""
    joints, points = state.joints, len(state.joints.pressing)
    if not attempt.paired and attempt.fits(model.demands.fitting):
        return replace(joints, pressing=np.zeros(points), shear=np.zeros((points, 3)))
    if attempt.answer.misfit >= PATH.credible:
        return joints
    forces = attempt.answer.forces[:points]
    shear = np.einsum("kac,ka->kc", state.tangents, forces[:, 1:])
    return replace(joints, pressing=np.maximum(forces[:, 0], 0.0), shear=shear)


def _with_present_tensions(
    model: MovingModel, state: PathState, attempt: Attempt, program: StepProgram, sliding: FloatArray, solve: Solve
) -> StepAnswer:
    """Return the answer of an attempt with load factor and forces under the tensions that elastic ties have at this state.

    Its motion is that under the tensions which they reach within the step, or stones that a stiff tie holds would run away. The
    forces that fit it, from the least to the greatest load factor, are an interval, so those with the load factor of the answer
    are taken, or with the nearest to it. Where none fit, as where a stone slides towards the tie that pulls it, the answer stays
    as it is.
    """
    answer, count = attempt.answer, len(model.ties.name)
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
    found = [solve_step(held, sliding, solve, model.demands.duality_gap)]
    if attempt.paired:
        own = replace(answer, forces=np.where(known[:, None], 0.0, answer.forces))
        found += [
            step_answer(held, sliding, each.forces, each.load_factor, answer.y)
            for each in (own, fitting_forces(held, own, solve))
        ]
    fitting: list[CoulombState] = []
    for each in found:
        if each.outcome == "solved" and each.residual <= PATH.balance:
            gap = bipotential_gap(held, strength, each.forces, answer.y)
            if gap <= max(answer.misfit, PATH.fits) * max(abs(each.load_factor), answer.least):
                fitting.append(CoulombState(each.forces, each.load_factor, answer.y, gap))
    if not fitting:
        return answer
    fits = no_higher(held, strength, min(fitting, key=attrgetter("load_factor")), answer.load_factor)
    now = step_answer(held, sliding, fits.x, fits.load_factor, answer.y)
    return replace(now, forces=fits.x + pull, bound_gap=answer.bound_gap, gap=max(now.gap, answer.gap), message=answer.message)


def _work(model: MovingModel, answer: StepAnswer, rate: FloatArray) -> float:
    """Return the work per unit of work of friction, of ties on their ends, and of pressure on joints that crush: negative."""
    work = answer.forces[: len(rate)] * rate
    if model.strength is None:
        work[: len(rate) - len(model.ties.name), 0] = 0.0
    return float(work.sum())


def next_state(model: MovingModel, step: PathStep, furthest: float = np.inf) -> PathState:
    """Return the state after a step, its contacts found anew; furthest: m per unit of work, the longest way that it may go."""
    return onward(model, step.state, step.velocity, step.way, step.misfit, furthest)


def onward(
    model: MovingModel, state: PathState, velocity: FloatArray, way: float, misfit: float, furthest: float = np.inf
) -> PathState:
    """Return the state to which a motion of a state leads; see `next_state` and `PathStep`.

    While the motion changes little it goes on as it did since the last step (Adams and Bashforth, second order): a linkage
    keeps its hinges. By the end of a step that is longer than the last, too, it has changed by little. The velocities are those
    at the origin, which do not change where a stone turns about an axis at rest.
    """
    way = min(way, furthest)
    stones, centre = standing(model, state), state.poses.centroid
    speed = stone_speed(stones, velocity)
    there = velocity.copy()
    there[:, :3] -= np.cross(there[:, 3:], centre)
    motion = there
    if state.before is not None:
        change = there - state.before
        at_stone = change.copy()
        at_stone[:, :3] += np.cross(change[:, 3:], centre)
        changed, most = float(stone_speed(stones, at_stone).max()), PATH.steady * float(speed.max(initial=0.0))
        if changed < most:
            # After a short step a small change would be a large one by the end of a long step, which nothing says that it is.
            longer = min(way / state.way, most / max(changed, 1e-300))
            # Stones that have just fallen do not go on: they stay where they are.
            motion = there + 0.5 * longer * np.where(state.fallen[:, None], 0.0, change)
    twist = motion.copy()
    twist[:, :3] += np.cross(motion[:, 3:], centre)
    # A stone that settles into a gap turns as far however short the step is: a step that it made short is made longer again.
    short = 4 * state.length * reference_speed(speed) < model.step
    fastest = state.fastest
    if misfit < PATH.credible:
        fastest = usual_speed(speed, fastest, model.stones.weight, expendable(model, state), of_many=model.large)
    return renewed_state(
        model,
        replace(
            state,
            poses=state.poses.moved(way * twist),
            length=2 * state.length if short else state.length,
            fastest=fastest,
            before=there,
            way=way,
            first=state.first or abs(state.load_factor),
        ),
    )


def without(model: MovingModel, state: PathState, step: PathStep) -> PathState:
    """Return the state that a step began at without the stones that fall in it.

    Its length is that of the step before: the motion of a few stones tells nothing of the others. Its forces, in a large model,
    are those of the fall, where there are any: these are in balance where the stones are now.
    """
    joints = step.state.joints
    if step.answer.outcome == "solved" and model.large:
        state = replace(state, joints=replace(state.joints, pressing=joints.pressing, shear=joints.shear))
    return renewed_state(model, replace(state, fallen=state.fallen | step.falling))


def may_go_on(model: MovingModel, step: PathStep) -> bool:
    """True when the stones that fall may be spared: they are light, and something is left to push."""
    left = ~(step.state.fallen | step.falling)
    if isinstance(model.driven, TravellingLoads) and not model.driven.on(left):
        return False
    return light(model, step.state, step.falling)


def withstands_nothing(model: MovingModel, state: PathState) -> bool:
    """True when the stones of a state hold no push, however their joints slide: by associative friction, an upper bound.

    Gaps may close by what they do in a tenth of a step (`PATH.located`), which a path is known to where it ends. False where a
    support moves: nothing is pushed there.
    """
    if not isinstance(model.driven, TravellingLoads):
        return False
    _, program, _, gap = state_program(model, state)
    short = program.within(gap, program.softness, PATH.located * state.length)
    bound = solve_step(short, np.zeros_like(gap), solver_for(program.balance, model.solver), model.demands.duality_gap)
    return bound.outcome == "solved" and bound.load_factor <= 0.0
