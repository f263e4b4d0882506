"""Stones that nothing holds any more."""

import numpy as np

from churchpipe.large_displacements.settings import PATH
from churchpipe.mechanism import reference_speed
from churchpipe.model.arrays import BoolArray, FloatArray


def stones_ahead(speed: FloatArray, before: float, weight: FloatArray, spared: float, faster: float) -> BoolArray:
    """Return which stones (nb,) leave all others behind: none where they are no few light ones.

    speed (nb,): of the fastest vertex of each stone; before: the `usual_speed` of the last step, infinite at the first.
    weight (nb,) N; spared N: the weight of a few light stones. faster: they are ahead where the fastest is so many times faster
    than `before`, and than all others; ten times faster than all others (`PATH.ahead`) is always enough.
    """
    ahead, light = _fast(speed, weight, spared, max(PATH.ahead, 1.0 / faster))
    return ahead & (light and float(speed.max(initial=0.0)) > faster * before)


def usual_speed(speed: FloatArray, before: float, weight: FloatArray, spared: float, *, of_many: bool) -> float:
    """Return the speed that falls are measured by: of the fastest stone, while its motion is not that of a few light stones.

    A stone that loses its hold gets faster from step to step, and each step is as much shorter. It would not be known to fall
    if it were measured by the step before. of_many: whether there are so many stones that those which are faster than most of
    the others do not count.
    """
    light = of_few(speed, weight, spared)
    if light and np.isfinite(before):
        return before
    return reference_speed(speed) if of_many else float(speed.max(initial=0.0))


def of_few(speed: FloatArray, weight: FloatArray, spared: float) -> bool:
    """Return whether a motion is that of a few light stones; see `stones_ahead`."""
    return _fast(speed, weight, spared, PATH.ahead)[1]


def _fast(speed: FloatArray, weight: FloatArray, spared: float, share: float) -> tuple[BoolArray, bool]:
    """Return the stones (nb,) with more than this share of the fastest speed, and whether they are a few light ones."""
    ahead = speed > share * float(speed.max(initial=0.0))
    return ahead, float(weight[ahead].sum()) < spared
