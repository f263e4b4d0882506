"""Stones that nothing holds any more."""

import numpy as np

from churchpipe.large_displacements.settings import PATH
from churchpipe.large_displacements.step import StepAnswer
from churchpipe.model.arrays import BoolArray, FloatArray


def falling_stones(answer: StepAnswer, speed: FloatArray, before: float, weight: FloatArray, spared: float) -> BoolArray:
    """Return which stones (nb,) fall: those of an infeasible program, or a few light ones that leave all others behind.

    speed (nb,): of the fastest vertex of each stone; before: the fastest of the last step, infinite at the first.
    weight (nb,) N; spared N: what may fall out without ending the curve.
    """
    if answer.outcome == "infeasible":
        return speed > PATH.falling * float(speed.max(initial=0.0))
    if answer.outcome == "solved":
        return stones_ahead(speed, before, weight, spared)
    return np.zeros(len(speed), dtype=bool)


def stones_ahead(speed: FloatArray, before: float, weight: FloatArray, spared: float) -> BoolArray:
    """Return which stones (nb,) leave all others behind: none where they are no few light ones; see `falling_stones`."""
    fastest = float(speed.max(initial=0.0))
    ahead = speed > PATH.ahead * fastest
    return ahead & (fastest > PATH.faster * before and float(weight[ahead].sum()) < spared)
