"""Stones that a load has lifted off all that bears them."""

import numpy as np

from churchpipe.large_displacements.following import Ending
from churchpipe.large_displacements.path import PathStep
from churchpipe.mechanism import moving_stones
from churchpipe.model.arrays import BoolArray

# A contact that presses by less than this share of the weight does not press.
_NOTHING = 1e-7
_FLOATING = (
    "the load has an upward part, and has lifted the stones that move: nothing presses on them any more, and they would float on "
    "under the same load factor"
)


def floating(step: PathStep, fixed: BoolArray) -> Ending | None:
    """Return how a curve ends where nothing touches or holds the stones that move in a step, as the load balances their weight;
    None where something does.

    fixed (nb,): stones that never move.
    """
    if step.answer.outcome != "solved":
        return None
    moving = moving_stones(step.speed) & ~fixed & ~step.state.fallen & ~step.held
    joints = len(step.state.joints.pair)
    touching = moving[step.state.joints.pair].any(axis=1)
    pressing = np.abs(step.answer.forces[: len(step.rate), 0])
    # Ties may hold what no joint touches.
    lifted = moving.any() and not (pressing[:joints][touching] > _NOTHING).any() and not (pressing[joints:] > _NOTHING).any()
    return Ending("unfinished", _FLOATING) if lifted else None
