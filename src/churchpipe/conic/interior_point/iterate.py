"""Where the loop stands: the variables of the homogeneous embedding, and a step of them."""

from dataclasses import dataclass

import numpy as np

from churchpipe.conic.interior_point.problem import CoupledProblem
from churchpipe.model.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Iterate:
    """Variables x (nx,), load, y (m,), slacks s and multipliers z (rows,), and the homogenising pair theta, kappa.

    x / theta, load / theta ... solve the problem when theta > 0 at the end; with theta = 0 they are a certificate.
    """

    x: FloatArray
    load: float
    y: FloatArray
    s: FloatArray
    z: FloatArray
    theta: float
    kappa: float

    def moved(self, step: "Iterate", length: float) -> "Iterate":
        """Return self + length step."""
        return Iterate(
            self.x + length * step.x,
            self.load + length * step.load,
            self.y + length * step.y,
            self.s + length * step.s,
            self.z + length * step.z,
            self.theta + length * step.theta,
            self.kappa + length * step.kappa,
        )

    def longest_step(self, problem: CoupledProblem, step: "Iterate") -> float:
        """Return the largest length (at most 1e3) along step that keeps s, z, theta and kappa in their cones."""
        return float(self.longest_steps(problem, step, step, np.zeros(1))[0])

    def longest_steps(self, problem: CoupledProblem, step: "Iterate", more: "Iterate", weights: FloatArray) -> FloatArray:
        """Return the same along step + weight more, for every weight."""
        cone = problem.cone
        slacks = cone.longest_steps(self.s, step.s, more.s, weights)
        multipliers = cone.longest_steps(self.z, step.z, more.z, weights)
        rates = (-(step.theta + weights * more.theta) / self.theta, -(step.kappa + weights * more.kappa) / self.kappa)
        return np.minimum.reduce([slacks, multipliers, *(1.0 / np.maximum(rate, 1e-3) for rate in rates)])

    def mean_product(self, problem: CoupledProblem) -> float:
        """Return mu, the mean complementarity product."""
        return (inner(self.s, self.z) + self.theta * self.kappa) / (problem.cone.degree + 1)

    def finite(self) -> bool:
        """True when nothing has overflowed."""
        parts = (self.x, self.y, self.s, self.z)
        return all(bool(np.isfinite(part).all()) for part in parts) and bool(
            np.isfinite([self.load, self.theta, self.kappa]).all()
        )


def inner(a: FloatArray, b: FloatArray) -> float:
    """Return a . b without BLAS, whose threads cost more than they save on vectors of this length."""
    return float(np.einsum("i,i->", a, b))
