"""Newton directions of the homogeneous embedding at one iterate."""

import numpy as np

from churchpipe.conic.interior_point.iterate import Iterate, inner
from churchpipe.conic.interior_point.kkt import Direction, KktSystem, Right
from churchpipe.conic.interior_point.problem import CoupledProblem
from churchpipe.conic.interior_point.residuals import Residuals, largest
from churchpipe.conic.interior_point.settings import Settings
from churchpipe.model.arrays import FloatArray


class NewtonSystem:
    """The embedding linearised at an iterate: two solves give the part of theta, each direction costs one more.

    The step of theta follows from its own row (Goulart and Chen, Clarabel, 2024, eqs. 16-18, for quadratic objectives).
    """

    def __init__(self, problem: CoupledProblem, kkt: KktSystem, at: Iterate, found: Residuals, settings: Settings) -> None:
        self._problem, self._kkt, self._at, self._found, self._settings = problem, kkt, at, found, settings
        self.scaling = problem.cone.scaling(at.s, at.z)
        # A vanishing scale announces a certificate: the matrix may be singular then, and its null space is wanted.
        singular = at.theta <= 1e-4 * at.kappa
        kkt.update(self.scaling, settings.regularisation * (1e4 if singular else 1.0))
        # Coupling rows solved to a thousandth of what is left in them need no refinement.
        self._allowed = 1e-3 * largest(found.y) + 1e-15
        self.point = self.scaling.point()
        affine = Right(-found.x, -found.load, -found.y, _opposite(found.z, 1.0), at.z)
        slack = Right(np.zeros_like(at.x), 0.0, np.zeros_like(at.y), None, at.z)
        first, second = kkt.solve([affine, slack], settings.refinements, self._allowed)
        self._slope = problem.linear + (2.0 / at.theta) * found.curvature
        # The solution for the data alone is the iterate itself plus a part as small as the residuals. Solving for that part
        # keeps digits that theta's own row, a difference of nearly equal works, would lose.
        rest = first.plus(second)
        here = Direction(at.x, at.load, at.y, at.z)
        self._data = here.plus(rest).times(1.0 / at.theta)
        self._stiffness = (found.theta - 2.0 * at.kappa + self._price(rest)) / at.theta
        self.predictor = self._complete(first, 1.0, at.theta * at.kappa)

    def direction(self, share: float, product: FloatArray, pair: float) -> Iterate:
        """Return the step that removes `share` of the residuals, `product` of lam o lam and `pair` of theta kappa."""
        found = self._found
        pull = self.scaling.solve(self.scaling.divide(product))
        right = Right(-share * found.x, -share * found.load, -share * found.y, _opposite(found.z, share), pull)
        (step,) = self._kkt.solve([right], self._settings.refinements, self._allowed)
        return self._complete(step, share, pair)

    def second_order(self, step: Iterate) -> FloatArray:
        """Return W^-1 ds o W dz, the product that a linear step neglects."""
        return self._problem.cone.product(self.scaling.solve(step.s), self.scaling.apply(step.z))

    def _price(self, step: Direction) -> float:
        problem = self._problem
        slope = self._slope
        return inner(slope, step.x) - problem.reward * step.load - inner(problem.constant, step.y) + inner(problem.right, step.z)

    def _complete(self, step: Direction, share: float, pair: float) -> Iterate:
        at, problem = self._at, self._problem
        theta = (pair / at.theta - share * self._found.theta - self._price(step)) / self._stiffness
        full = step.plus(self._data, theta)
        # s from the constraints, not from the complementarity rows: those keep rounding errors, these stay exact.
        s = theta * problem.right - problem.constrain(full.x, full.load)
        if self._found.z is not None:
            s -= share * self._found.z
        return Iterate(full.x, full.load, full.y, s, full.z, theta, -(pair + at.kappa * theta) / at.theta)


def centrality_target(
    problem: CoupledProblem, system: NewtonSystem, at: Iterate, step: Iterate, length: float, target: float
) -> tuple[FloatArray, float]:
    """Return corrections that bring the complementarity products at `length` into [0.1, 10] target (Gondzio 1996)."""
    low, high = 0.1 * target, 10.0 * target
    s = system.point + length * system.scaling.solve(step.s)
    z = system.point + length * system.scaling.apply(step.z)
    fix = problem.cone.recentre(problem.cone.product(s, z), low, high)
    pair = (at.theta + length * step.theta) * (at.kappa + length * step.kappa)
    return fix, float(max(np.clip(pair, low, high) - pair, -high))


def _opposite(residual: FloatArray | None, share: float) -> FloatArray | None:
    return None if residual is None else -share * residual
