"""The state of the interior-point loop: the variables of the homogeneous embedding, and steps between such states."""

from dataclasses import dataclass, replace

import numba
import numpy as np

from churchpipe.conic.interior_point.problem import CoupledProblem
from churchpipe.model.arrays import FloatArray

# A multiplier that would leave its cone before the others goes this share of its own way.
_SHORT = 0.8
# The one that sets the length reaches its share of the way to this, and does not count as one that would leave before it.
_ROUNDING = 1e-12


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
            plus(self.x, step.x, length),
            self.load + length * step.load,
            plus(self.y, step.y, length),
            plus(self.s, step.s, length),
            plus(self.z, step.z, length),
            self.theta + length * step.theta,
            self.kappa + length * step.kappa,
        )

    def longest_step(self, problem: CoupledProblem, step: "Iterate", ignored: int = 0) -> float:
        """Return the largest length (at most 1e3) along step that keeps s, z, theta and kappa in their cones.

        ignored: so many of the slacks, and of the multipliers, are left out of account: those that would leave first.
        """
        return float(self.longest_steps(problem, step, step, np.zeros(1), ignored)[0])

    def longest_steps(
        self, problem: CoupledProblem, step: "Iterate", more: "Iterate", weights: FloatArray, ignored: int = 0
    ) -> FloatArray:
        """Return the same along step + weight more, for every weight."""
        cone = problem.cone
        slacks = _steepest(cone.rates(self.s, step.s, more.s, weights), ignored)
        multipliers = _steepest(cone.rates(self.z, step.z, more.z, weights), ignored)
        theta = -(step.theta + weights * more.theta) / self.theta
        kappa = -(step.kappa + weights * more.kappa) / self.kappa
        return 1.0 / np.maximum.reduce([slacks, multipliers, theta, kappa, np.full(len(weights), 1e-3)])

    def stepped(
        self, problem: CoupledProblem, step: "Iterate", fraction: float, ignored: int, *, slack: bool = False
    ) -> tuple["Iterate", float]:
        """Return the iterate a `fraction` of the way to where step leaves the cones, at most the whole step, and the length.

        Each of the `ignored` multipliers, which would leave first, stops short of its own boundary. That leaves a residual in its
        local rows alone, the motion of one point. slack: as many slacks stop short likewise, while their forces go on. Such
        forces are outside their cones until later steps have removed that residual. Where they must also balance this takes many.
        """
        cone, once = problem.cone, np.zeros(1)
        slacks = cone.rates(self.s, step.s, step.s, once)
        multipliers = cone.rates(self.z, step.z, step.z, once)
        steepest = max(-step.theta / self.theta, -step.kappa / self.kappa, float(_steepest(multipliers, ignored)[0]))
        steepest = max(steepest, float(_steepest(slacks, ignored if slack else 0)[0]))
        length = min(1.0, fraction / max(steepest, 1e-300))
        out = self.moved(step, length)
        for part, rates in (("s", slacks[0]), ("z", multipliers[0])):
            early = rates * length > fraction * (1.0 + _ROUNDING)
            if early.any():
                own = cone.entries(np.where(early, _SHORT / np.maximum(rates, 1e-300), length))
                out = replace(out, **{part: getattr(self, part) + own * getattr(step, part)})
        return out, length

    def mean_product(self, problem: CoupledProblem) -> float:
        """Return mu, the mean complementarity product."""
        return (inner(self.s, self.z) + self.theta * self.kappa) / (problem.cone.degree + 1)

    def finite(self) -> bool:
        """True when nothing has overflowed."""
        parts = (self.x, self.y, self.s, self.z)
        return all(bool(np.isfinite(part).all()) for part in parts) and bool(
            np.isfinite([self.load, self.theta, self.kappa]).all()
        )


def _steepest(rates: FloatArray, ignored: int) -> FloatArray:
    """Return for each row of rates the largest, not counting the `ignored` largest ones."""
    if not rates.shape[1]:
        return np.zeros(len(rates))
    return rates.max(axis=1) if not ignored else np.array([_next_largest(row, ignored) for row in rates])


@numba.njit(cache=True)
def _next_largest(values: FloatArray, ignored: int) -> float:
    """Return the largest of values, not counting the `ignored` largest ones, in one pass.

    The largest ones so far are kept as a heap, the least of them first: few of many, so that hardly any value enters it. Sorting
    parts of such values, of which many are alike, took a third of a large solve.
    """
    heap = np.full(ignored + 1, -np.inf)
    for value in values:
        if not value > heap[0]:
            continue
        place = 0
        while True:
            child = 2 * place + 1
            if child > ignored:
                break
            if child < ignored and heap[child + 1] < heap[child]:
                child += 1
            if heap[child] >= value:
                break
            heap[place] = heap[child]
            place = child
        heap[place] = value
    return heap[0]


def inner(a: FloatArray, b: FloatArray) -> float:
    """Return a . b without BLAS, whose threads cost more than they save on vectors of this length."""
    return float(np.einsum("i,i->", a, b))


@numba.njit(cache=True)
def plus(a: FloatArray, b: FloatArray, factor: float) -> FloatArray:
    """Return a + factor b in one pass over vectors too long for the cache."""
    out = np.empty_like(a)
    for k in range(len(a)):
        out[k] = a[k] + factor * b[k]
    return out
