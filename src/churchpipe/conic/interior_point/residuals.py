"""Residuals of the homogeneous embedding, and what they say about convergence."""

from dataclasses import dataclass

from churchpipe.conic.interior_point.iterate import Iterate, inner
from churchpipe.conic.interior_point.problem import CoupledProblem, largest
from churchpipe.model.arrays import FloatArray

# Residuals of the constraints below this share of the slacks are rounding, which the scaling would blow up.
_ROUNDING = 1e-12


@dataclass(frozen=True, slots=True)
class Residuals:
    """Residuals of the five groups of equations at an iterate, not divided by theta.

    x: Q x + linear theta + B^T y + G^T z;   y: B x + constant theta + growth load;
    load: growth . y + z_cap - reward theta;
    z: G x + s - right theta, None when it is rounding;
    theta: kappa + linear . x - reward load - constant . y + right . z + x Q x / theta.
    """

    x: FloatArray
    y: FloatArray
    load: float
    z: FloatArray | None
    theta: float
    curvature: FloatArray
    primal: float
    dual: float


def residuals(problem: CoupledProblem, at: Iterate) -> Residuals:
    """Return the residuals; `curvature` is Q x, primal and dual the two objectives (of the maximisation, per theta)."""
    curvature = problem.quadratic(at.x)
    square = inner(at.x, curvature)
    cost = inner(problem.linear, at.x) - problem.reward * at.load
    price = inner(problem.right, at.z) - inner(problem.constant, at.y)
    slack = problem.constrain(at.x, at.load) + at.s - problem.right * at.theta
    size = largest(at.s)
    cap = float(at.z[-1]) if problem.capped else 0.0
    return Residuals(
        x=curvature + problem.linear * at.theta + problem.spread(at.y) + problem.transpose(at.z),
        y=problem.couple(at.x) + problem.constant * at.theta + problem.growth * at.load,
        load=inner(problem.growth, at.y) + cap - problem.reward * at.theta,
        z=slack if largest(slack) > _ROUNDING * size else None,
        theta=at.kappa + cost + price + square / at.theta,
        curvature=curvature,
        primal=-(cost / at.theta + 0.5 * square / at.theta**2),
        dual=price / at.theta + 0.5 * square / at.theta**2,
    )
