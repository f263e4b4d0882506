"""The stones that a path follows: those that move, and a halo of still ones around them that grows when its rim moves."""

from dataclasses import replace

import numpy as np
import scipy.sparse as sp

from churchpipe.large_displacements.joints import joined
from churchpipe.large_displacements.moving_model import MovingModel, bearing
from churchpipe.large_displacements.path import PathState, PathStep
from churchpipe.large_displacements.settings import PATH
from churchpipe.mechanism import reference_speed
from churchpipe.model.arrays import BoolArray, IntArray
from churchpipe.model.assemblage import Assemblage


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
    # Where neither stone could move before, nothing has moved since the drawing.
    still = model.held | model.stones.fixed
    freed = ~bearing(still, model.drawn.blocks) & bearing(held | model.stones.fixed, model.drawn.blocks)
    state = replace(step.state, joints=joined(step.state.joints, model.drawn.selected(freed)))
    return replace(model, held=held), state
