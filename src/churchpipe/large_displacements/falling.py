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
    fastest = float(speed.max(initial=0.0))
    if answer.outcome == "infeasible":
        return speed > PATH.falling * fastest
    ahead = speed > PATH.ahead * fastest
    if answer.outcome == "solved" and fastest > PATH.faster * before and float(weight[ahead].sum()) < spared:
        return ahead
    return np.zeros(len(speed), dtype=bool)
