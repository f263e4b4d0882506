"""In which order the forces and the motion of a step are sought, until they fit each other."""

from dataclasses import replace

import numpy as np

from churchpipe.conic.solve import solver_for
from churchpipe.large_displacements.motions import Motions, light
from churchpipe.large_displacements.moving_model import MovingModel
from churchpipe.large_displacements.path_state import PathState
from churchpipe.large_displacements.search import Attempt, StepSearch
from churchpipe.large_displacements.settings import PATH
from churchpipe.large_displacements.state_program import last_velocities
from churchpipe.large_displacements.step import StepAnswer, StepProgram
from churchpipe.large_displacements.unsupported import unsupported
from churchpipe.mechanism import stone_speed
from churchpipe.model.arrays import BoolArray, FloatArray


def sought(motions: Motions, search: StepSearch, program: StepProgram, gap: FloatArray, programs: int, pairs: int) -> Attempt:
    """Return the best attempt at a step: from the forces of the last one, or from what its joints slid by.

    Where forces and motion fitted each other in pairs of programs only, the forces of the last step are the best to begin with:
    they keep the path on its way where others branch off.
    """
    model, state = motions.model, motions.state
    forces = _last_forces(model, state, gap)
    sliding = np.zeros(len(gap))
    sliding[: len(state.joints.sliding)] = state.joints.sliding
    if not (pairs and forces.any()):
        return search.by_programs(sliding, programs, pairs)
    begun = StepAnswer("failed", forces, np.nan, last_velocities(model, state, motions.free, program), least=program.least)
    last = Attempt(begun, state.length)
    attempt = _of_large(motions, search, program, last, gap, sliding, pairs) if model.large else search.by_pairs(last, pairs)
    # From other forces a large model finds the same motion, with the same misfit.
    if attempt.will_do(PATH.credible if model.large else model.demands.enough):
        return attempt
    if attempt.answer.outcome == "infeasible" and light(model, state, motions.falling(attempt.answer)):
        return attempt
    if not model.large:
        # Very few stones are not taken to hang on joints that are open, if only a little. Many may yet come to rest on them.
        for wide, share in ((PATH.open, 1.0), (PATH.drift, PATH.few)):
            if (fall := unsupported_fall(motions, program, gap, wide, share)) is not None:
                return Attempt(fall, last.length)
    return _better(attempt, search.by_programs(sliding, programs, pairs))


def _of_large(
    motions: Motions,
    search: StepSearch,
    program: StepProgram,
    last: Attempt,
    gap: FloatArray,
    sliding: FloatArray,
    pairs: int,
) -> Attempt:
    """Return the attempt at a step of a large model.

    In this order until one will do: stones that their neighbours cannot carry, the last forces, forces that fit the last motion,
    stones that the dead load brings down, those that give way before all others, the forces of one associative program near the
    last motion, and stones that only forces across gaps, or in joints which open, would hold.
    """
    model = motions.model
    if (fall := unsupported_fall(motions, program, gap, PATH.open)) is not None:
        return Attempt(fall, last.length)
    # A program that has no solution need not be shown twice to have none: the search from nothing shows it once more.
    own = solver_for(program.balance, "interior-point") if model.solver == "auto" else None
    attempt = search.by_pairs(last, pairs, own, model.demands.astray)
    if not attempt.will_do(PATH.credible) and len(last.answer.y):
        # Where the last forces lead to a motion that nearly fits, these lead to the same one.
        attempt = _better(attempt, search.fitted(last, pairs, own))
    if attempt.answer.outcome == "failed":
        # Mostly because stones fall. The search from nothing would show it too, but at many times the price.
        attempt = search.under_dead_load()
    if attempt.will_do(PATH.credible) or attempt.answer.outcome == "infeasible":
        return attempt
    if (fall := search.giving_way(PATH.withstood * motions.state.load_factor, own)) is not None:
        return fall
    attempt = _better(attempt, search.onward(sliding, last.answer.y, pairs, own))
    if attempt.will_do(PATH.credible):
        return attempt
    # Where nothing fits, stones that hang on joints which are open, if only a little, or which open, are not taken to stand.
    if (fall := unsupported_fall(motions, program, gap, PATH.drift)) is not None:
        return Attempt(fall, last.length)
    if (hanging := search.letting_go(attempt, pairs, own)) is not None:
        # Others move with those that hang, as they may: whether they fall is asked again without these.
        speed = stone_speed(motions.stones, motions.velocities(hanging.answer.y))
        foremost = speed > PATH.foremost * float(speed.max())
        if light(model, motions.state, foremost):
            return Attempt(_fall_of(foremost[motions.free], program), last.length)
    return attempt


def unsupported_fall(
    motions: Motions, program: StepProgram, gap: FloatArray, wide: float, share: float = 1.0
) -> StepAnswer | None:
    """Return the fall of a few light stones that their neighbours cannot carry, None where there are none such.

    Joints that have opened carry nothing, by more than the share `wide` of the step. The programs of the step would let a stone
    hang on them, at the price of their gaps. share: of the weight that may fall out, which those that fall do not exceed.
    """
    strength, fallen = program.strength, np.zeros(len(motions.stones.weight), dtype=bool)
    for bound in (np.where(_open(motions.model, gap, wide), 0.0, strength.bound), strength.bound):
        bearing = replace(program, strength=replace(strength, bound=bound))
        falling = unsupported(bearing, PATH.withstood * motions.state.load_factor)
        fallen[motions.free] = falling
        if not falling.any():
            return None
        if float(motions.model.stones.weight[fallen].sum()) <= share * motions.spared:
            return _fall_of(falling, program)
    return None


def _fall_of(falling: BoolArray, program: StepProgram) -> StepAnswer:
    """Return the answer in which these stones of a program (nf,) go where their dead load takes them."""
    dead = program.dead[: 6 * len(falling)].reshape(-1, 6)
    y = np.zeros_like(program.dead)
    y[: dead.size].reshape(-1, 6)[falling] = dead[falling] / np.linalg.norm(dead[falling], axis=1)[:, None]
    return StepAnswer("infeasible", np.zeros((len(program.closing), 3)), np.nan, y)


def _last_forces(model: MovingModel, state: PathState, gap: FloatArray) -> FloatArray:
    """Return the forces (nc, 3) of the last step, where they may help to find those of this one; gap (nc,) m.

    Whole forces let the programs begin near them: quicker, and a little less exact, which only a large model is worth.
    """
    points, forces = len(state.joints.pressing), np.zeros((len(gap), 3))
    forces[:points, 0] = state.joints.pressing
    if model.large:
        forces[:points, 1:] = np.einsum("kac,kc->ka", state.tangents, state.joints.shear)
        # Where a stone has lost its hold, friction in the joint that opened would keep it up.
        forces[_open(model, gap)] = 0.0
    return forces


def _open(model: MovingModel, gap: FloatArray, wide: float = PATH.open) -> BoolArray:
    """Return which points (nc,) are open by more than this share of the step, so that they hold nothing; gap (nc,) m."""
    return gap > wide * model.step


def _better(one: Attempt, other: Attempt) -> Attempt:
    """Return the attempt of which more is known: the other one, but where the first has a motion that is at least credible."""
    if one.answer.outcome != "solved" or other.answer.outcome == "unbounded":
        return other
    if other.answer.outcome == "solved":
        return one if one.answer.misfit < other.answer.misfit else other
    return one if one.answer.misfit < PATH.credible else other
