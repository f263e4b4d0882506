"""Newton directions of the homogeneous embedding at one iterate."""

from dataclasses import dataclass, replace

import numpy as np

from churchpipe.conic.interior_point.iterate import Iterate, inner, plus
from churchpipe.conic.interior_point.kkt import Direction, KktSystem, Right
from churchpipe.conic.interior_point.problem import CoupledProblem
from churchpipe.conic.interior_point.residuals import Residuals
from churchpipe.conic.interior_point.settings import Settings
from churchpipe.model.arrays import FloatArray

# Coupling rows solved to this share of what is left in them need no refinement.
_REFINED = 0.1
_ROUNDING = 1e-12


@dataclass(frozen=True, slots=True)
class Step:
    """A direction of the embedding, with what it answers: `share` of the residuals, `right`, `pair` of theta kappa."""

    share: float
    right: Right
    pair: float
    direction: Direction
    move: Iterate

    def corrected(self, corrector: "Step", weight: float) -> "Step":
        """Return self + weight corrector; a corrector removes no residuals."""
        return Step(
            self.share,
            replace(self.right, pull=plus(self.right.pull, corrector.right.pull, weight)),
            self.pair + weight * corrector.pair,
            self.direction.plus(corrector.direction, weight),
            self.move.moved(corrector.move, weight),
        )


class NewtonSystem:
    """The embedding linearised at an iterate: two solves give the part of theta, each direction costs one more.

    The step of theta follows from its own row (Goulart and Chen, Clarabel, 2024, eqs. 16-18, for quadratic objectives).
    """

    def __init__(self, problem: CoupledProblem, kkt: KktSystem, at: Iterate, found: Residuals, settings: Settings) -> None:
        self._problem, self._kkt, self._at, self._found, self._settings = problem, kkt, at, found, settings
        self.scaling = problem.cone.scaling(at.s, at.z)
        # A vanishing scale is the sign of a certificate. The matrix may be singular then, and the certificate lies in its null
        # space.
        singular = at.theta <= 1e-4 * at.kappa
        kkt.update(self.scaling, settings.regularisation * (1e4 if singular else 1.0))
        self._allowed = _REFINED * problem.imbalance(found.y) + _ROUNDING
        self.point = self.scaling.point()
        affine = self._right(1.0, at.z)
        slack = self._right(0.0, at.z)
        first, second = kkt.solve([affine, slack])
        self._slope = problem.linear + (2.0 / at.theta) * found.curvature
        # The solution for the data alone is the iterate itself plus a part as small as the residuals. Solving for that part
        # keeps digits that theta's own row, a difference of nearly equal works, would lose.
        both = Right(affine.x, affine.load, affine.y, affine.z, 2.0 * at.z)
        rest = kkt.refine(both, first.plus(second), settings.refinements, self._allowed)
        self._stiffness = (found.theta - 2.0 * at.kappa + self._price(rest)) / at.theta
        x, load = at.x + rest.x, at.load + rest.load
        s = problem.right * at.theta - problem.constrain(x, load)
        self._data = Iterate(x, load, at.y + rest.y, s, at.z + rest.z, at.theta, -at.kappa)
        self.predictor = self._step(1.0, affine, at.theta * at.kappa, first)

    def direction(self, share: float, product: FloatArray, pair: float) -> Step:
        """Return the step that removes `share` of the residuals, `product` of lam o lam and `pair` of theta kappa."""
        right = self._right(share, self.scaling.solve(self.scaling.divide(product)))
        (found,) = self._kkt.solve([right])
        return self._step(share, right, pair, found)

    def corrector(self, product: FloatArray, pair: float) -> Step:
        """Return the step for these products alone."""
        return self.direction(0.0, product, pair)

    def refined(self, step: Step) -> Iterate:
        """Return the move of a step, its coupling rows made exact."""
        found = self._kkt.refine(step.right, step.direction, self._settings.refinements, self._allowed)
        return step.move if found is step.direction else self._step(step.share, step.right, step.pair, found).move

    def second_order(self, step: Iterate) -> FloatArray:
        """Return W^-1 ds o W dz, the product that a linear step neglects."""
        return self._problem.cone.product(self.scaling.solve(step.s), self.scaling.apply(step.z))

    def _right(self, share: float, pull: FloatArray) -> Right:
        found = self._found
        if share == 0.0:
            return Right(None, 0.0, None, None, pull)
        return Right(-share * found.x, -share * found.load, -share * found.y, None if found.z is None else -share * found.z, pull)

    def _price(self, step: Direction) -> float:
        problem = self._problem
        slope = self._slope
        return inner(slope, step.x) - problem.reward * step.load - inner(problem.constant, step.y) + inner(problem.right, step.z)

    def _step(self, share: float, right: Right, pair: float, found: Direction) -> Step:
        at, problem = self._at, self._problem
        theta = (pair / at.theta - share * self._found.theta - self._price(found)) / self._stiffness
        # s from the constraints, not from the complementarity rows: those keep rounding errors, these stay exact.
        s = -problem.constrain(found.x, found.load)
        if right.z is not None:
            s += right.z
        move = Iterate(found.x, found.load, found.y, s, found.z, 0.0, -pair / at.theta)
        return Step(share, right, pair, found, move.moved(self._data, theta / at.theta))


def centrality_target(
    problem: CoupledProblem, system: NewtonSystem, at: Iterate, step: Iterate, length: float, target: float
) -> tuple[FloatArray, float]:
    """Return corrections that bring the complementarity products at `length` into [0.1, 10] target (Gondzio 1996)."""
    low, high = 0.1 * target, 10.0 * target
    s = plus(system.point, system.scaling.solve(step.s), length)
    z = plus(system.point, system.scaling.apply(step.z), length)
    fix = problem.cone.recentre(problem.cone.product(s, z), low, high)
    pair = (at.theta + length * step.theta) * (at.kappa + length * step.kappa)
    return fix, float(max(np.clip(pair, low, high) - pair, -high))
