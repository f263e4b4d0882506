"""Stones that nothing holds any more."""

import numpy as np

from churchpipe.large_displacements.step import StepAnswer
from churchpipe.model.arrays import BoolArray, FloatArray

# Stones that weigh less than this share of what moved at the start may fall out without ending the curve.
SPARED = 0.05
# Of a fall, or of a motion gone local, stones faster than these shares of the fastest take part.
_FALLING, _LOCAL = 0.02, 0.1
# A motion so many times faster than that of the last step is one of a few stones.
_FASTER = 20.0


def falling_stones(answer: StepAnswer, speed: FloatArray, before: float) -> BoolArray:
    """Return which stones (nb,) fall: those of an infeasible program, or those that have left all others behind.

    speed (nb,): of the fastest vertex of each stone; before: the fastest of the last step, infinite at the first.
    """
    fastest = float(speed.max(initial=0.0))
    if answer.outcome == "infeasible":
        return speed > _FALLING * fastest
    if answer.outcome == "solved" and fastest > _FASTER * before:
        return speed > _LOCAL * fastest
    return np.zeros(len(speed), dtype=bool)
