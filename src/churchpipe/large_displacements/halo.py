"""The stones that a path follows: those that move, and a halo of still ones around them that grows when its rim moves."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import scipy.sparse as sp

from churchpipe.conic.solve import solver_for
from churchpipe.large_displacements.falling import of_few
from churchpipe.large_displacements.joints import joined
from churchpipe.large_displacements.motions import expendable
from churchpipe.large_displacements.moving_model import MovingModel, bearing
from churchpipe.large_displacements.path import PathStep
from churchpipe.large_displacements.path_state import PathState, last_motion, renewed_state, standing
from churchpipe.large_displacements.poses import start_poses
from churchpipe.large_displacements.settings import PATH
from churchpipe.large_displacements.travelling import TravellingLoads
from churchpipe.mechanism import reference_speed, stone_speed
from churchpipe.model.arrays import BoolArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.results import LimitState
from churchpipe.rigid_blocks.associative import associative_program
from churchpipe.rigid_blocks.certificate import Strength
from churchpipe.rigid_blocks.equilibrium import Equilibrium

# Error of the load factor that a halo keeps, over what it may change.
HALO_GAP = 0.1


def held_around(stones: Assemblage, blocks: IntArray, moving: BoolArray, rings: int) -> BoolArray:
    """Return the free stones (nb,) that a path may hold: those further than so many contacts from moving ones (nb,).

    blocks (ni, 2): the stones of each contact. Contacts through the ground do not count.
    """
    free = ~stones.fixed
    first, second = blocks.T
    inner = blocks[free[first] & free[second]]
    count = stones.count
    graph = sp.csr_matrix((np.ones(len(inner)), (inner[:, 0], inner[:, 1])), shape=(count, count))
    reached = (moving & free).astype(np.float64)
    for _ in range(rings):
        reached = np.minimum(reached + graph @ reached + graph.T @ reached, 1.0)
    held = free & (reached == 0)
    return held if moving.any() and held.sum() > PATH.worth * free.sum() else np.zeros(count, dtype=bool)


def held_at_first(
    model: MovingModel,
    blocks: IntArray,
    held_program: Callable[[BoolArray], tuple[Equilibrium, Strength]],
    state: LimitState,
    rings: int,
) -> BoolArray:
    """Return the stones to hold still (nb,): without them the first load factor, that of `state`, is kept to `PATH.kept`.

    Where it is not, stones further away are let go as well. blocks (ni, 2): the stones of each contact. held_program: that of the
    limit analysis in which these stones (nb,), fixed ones among them, stand still.
    """
    stones = model.stones
    speed = stone_speed(stones, state.velocities)
    moving = speed > PATH.still * reference_speed(speed)
    moving[model.ties.stone] = True
    while True:
        held = held_around(stones, blocks, moving, rings)
        if not held.any():
            return held
        balance, strength = held_program(stones.fixed | held)
        if isinstance(model.driven, TravellingLoads):
            # A profile over the height shares out the weight of all stones, those that are held among them.
            live = model.driven.rows(start_poses(stones).rotation, balance.free, balance.force, balance.length)
            balance = replace(balance, live=np.append(live, balance.live[len(live) :]))
        # What carries its dead load does so with stones held.
        program, solve = associative_program(balance, strength), solver_for(balance.balance, model.solver)
        followed = solve(program, duality_gap=HALO_GAP * PATH.kept)
        if followed.outcome == "solved" and followed.tau <= (1 + PATH.kept) * state.load_factor:
            return held
        rings *= 2


def shrunk(model: MovingModel, state: PathState, rings: int) -> tuple[MovingModel, PathState]:
    """Return the model and the state with those stones held that stand still by now, in a large model.

    They are slower than `PATH.still` of the mechanism of the last step, and so many contacts (`rings`) from faster ones. Where
    that is a motion of a few light stones, or hardly any would be held, all are followed as before.
    """
    if not (rings and model.large and state.before is not None and isinstance(model.driven, TravellingLoads)):
        return model, state
    speed = stone_speed(standing(model, state), last_motion(state))
    if of_few(speed, model.stones.weight, expendable(model, state)):
        return model, state
    moving = speed > PATH.still * reference_speed(speed)
    moving[model.ties.stone] = True
    still = held_around(model.stones, np.concatenate([model.drawn.blocks, state.joints.blocks]), moving, rings)
    free = ~(model.stones.fixed | model.held | state.fallen)
    if (still & free).sum() <= PATH.worth * free.sum():
        return model, state
    model = replace(model, held=model.held | (still & free))
    bears = bearing(model.stones.fixed | model.held, state.joints.blocks)
    return model, replace(state, joints=state.joints.selected(bears))


def grown(model: MovingModel, step: PathStep, rings: int) -> tuple[MovingModel, PathState] | None:
    """Return the model with a wider halo, and the state at which to solve the step again; None where its rim stands still."""
    if not model.held.any() or step.answer.outcome != "solved":
        return None
    blocks = np.concatenate([model.drawn.blocks, step.state.joints.blocks])
    first, second = blocks.T
    rim = np.zeros(len(model.held), dtype=bool)
    rim[blocks[model.held[first] | model.held[second]]] = True
    rim &= ~model.held & ~model.stones.fixed
    reference = reference_speed(step.speed)
    if not (step.speed[rim] > PATH.rim * reference).any():
        return None
    held = model.held & held_around(model.stones, blocks, step.speed > PATH.still * reference, rings)
    # Where neither stone could move before, they stand to each other as drawn, unless they moved before they were held.
    still = model.held | model.stones.fixed
    freed = ~bearing(still, model.drawn.blocks) & bearing(held | model.stones.fixed, model.drawn.blocks)
    state = replace(step.state, joints=joined(step.state.joints, model.drawn.selected(freed)))
    away = (step.state.poses.centroid != model.stones.centroid).any(axis=1)
    wider = replace(model, held=held)
    return wider, renewed_state(wider, state) if (away & model.held & ~held).any() else state
