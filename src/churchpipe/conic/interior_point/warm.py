"""Starts near a solution that is known roughly: that of a program whose loads, gaps or limits were a little different.

Forces and multipliers near a solution lie on the boundary of their cones, where a step of the interior-point loop is blocked at
once. They are therefore moved into the cones, together, to where all complementarity products are equal (the central path): of
slack s and multiplier z the difference s - z / r is kept, and s o z = mu e gives the pair (Chen and Harker 1993, with the Jordan
product of the cone). r weighs the two. A start keeps forces rather than multipliers: a force that changes upsets the balance of
whole stones, a multiplier only the motion of one point.
"""

import numba
import numpy as np

from churchpipe.conic.interior_point.coulomb import CoulombPoints
from churchpipe.conic.interior_point.iterate import Iterate
from churchpipe.conic.interior_point.problem import CoupledProblem
from churchpipe.model.arrays import BoolArray, FloatArray

# How much rather forces are kept than multipliers, both measured by their own size.
_FORCES = 10.0
# A point that may close presses by this share of the mean at the least: one that hardly pressed may well press now.
_LEAST = 0.03
# Halvings of the interval in which the shear of a point lies.
_HALVINGS = 50
_TINY = 1e-12


def warm_start(
    problem: CoupledProblem, points: CoulombPoints, x: FloatArray, load: float, y: FloatArray, error: float
) -> Iterate:
    """Return an interior iterate near forces x (3, c), a load and multipliers y (m,), in the units of the problem.

    error: the complementarity of all points that it gets, a share of the reward of the load.
    """
    product = error * abs(problem.reward) * max(abs(load), 1e-3) / max(problem.cone.degree, 1)
    pull = problem.local_view(problem.spread(y) + problem.linear + problem.quadratic(x.ravel()))
    x = centred(points, x, pull, product)
    s = problem.right - problem.constrain(x.ravel(), load)
    return Iterate(x.ravel(), load, y, s, product * problem.cone.inverse(s), 1.0, product)


def centred(points: CoulombPoints, x: FloatArray, pull: FloatArray, product: float) -> FloatArray:
    """Return forces (3, c) inside the cones, near x (3, c), where the products of slacks and multipliers are equal.

    pull (3, c): what the multipliers of the cones must balance there, B^T y and the cost of the force.
    """
    out = np.where(points.active, x, 0.0)
    cones = points.active[:2].all(axis=0) & ~points.guarded
    slack = points.limit[cones] + points.slope[cones] * out[0, cones]
    multiplier = np.abs(pull[0, cones]) / points.slope[cones]
    weight = float(multiplier.sum()) / max(float(slack.sum()), _TINY) or 1.0
    if (guarded := points.guarded).any():
        pressing = np.maximum(out[0, guarded], 0.0)
        out[0, guarded] = np.maximum(pressing, _LEAST * float(pressing.mean()))
    _centre(points.limit, points.slope, points.guarded, points.active, pull, product, weight, out)
    return out


@numba.njit(cache=True)
def _centre(
    limit: FloatArray,
    slope: FloatArray,
    guarded: BoolArray,
    active: BoolArray,
    pull: FloatArray,
    mu: float,
    weight: float,
    x: FloatArray,
) -> None:
    for k in range(x.shape[1]):
        if active[0, k] and active[1, k] and not guarded[k]:
            _centre_cone(limit[k], slope[k], pull, mu, weight, x, k)
            continue
        slip = 0.0
        n = max(x[0, k], _TINY)
        if active[1, k]:
            slip = np.hypot(pull[1, k], pull[2, k])
        if active[0, k]:
            opening = pull[0, k] - slope[k] * slip
            own = _FORCES * max(abs(opening), mu / n) / n
            x[0, k] = _central(n - opening / own, mu / own)
        if active[1, k]:
            _centre_shear(limit[k] + slope[k] * x[0, k], slip, pull, mu, x, k)


@numba.njit(cache=True)
def _central(difference: float, product: float) -> float:
    """Return s > 0 with s - product / s = difference."""
    root = np.sqrt(difference * difference + 4.0 * product)
    return 0.5 * (difference + root) if difference > 0 else 2.0 * product / (root - difference)


@numba.njit(cache=True)
def _centre_cone(limit: float, slope: float, pull: FloatArray, mu: float, weight: float, x: FloatArray, k: int) -> None:
    """Centre a point whose shear alone bounds its normal force: slack (limit + slope n, t)."""
    s0, s1, s2 = limit + slope * x[0, k], x[1, k], x[2, k]
    z0, z1, z2 = pull[0, k] / slope, pull[1, k], pull[2, k]
    d0, d1, d2 = s0 - z0 / weight, s1 - z1 / weight, s2 - z2 / weight
    length = np.hypot(d1, d2)
    high, low = _central(d0 + length, mu / weight), _central(d0 - length, mu / weight)
    x[0, k] = (0.5 * (high + low) - limit) / slope
    share = 0.5 * (high - low) / length if length > 0 else 0.0
    x[1, k], x[2, k] = share * d1, share * d2


@numba.njit(cache=True)
def _centre_shear(reach: float, slip: float, pull: FloatArray, mu: float, x: FloatArray, k: int) -> None:
    """Centre the shear of a point that may grow to `reach`: t with t + (mu / weight) t / (reach^2 - t^2) as wanted."""
    weight = _FORCES * max(slip, mu / reach) / reach
    d1, d2 = x[1, k] - pull[1, k] / weight, x[2, k] - pull[2, k] / weight
    wanted = np.hypot(d1, d2)
    low, high = 0.0, reach * (1.0 - _TINY)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if middle + mu / weight * middle / (reach * reach - middle * middle) < wanted:
            low = middle
        else:
            high = middle
    share = low / wanted if wanted > 0 else 0.0
    x[1, k], x[2, k] = share * d1, share * d2
