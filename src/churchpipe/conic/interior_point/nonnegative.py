"""The nonnegative cone: products, eigenvalues, steps and Nesterov-Todd scaling."""

from dataclasses import dataclass

import numpy as np

from churchpipe.model.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class NonnegativeScaling:
    """Scaling s = W lam, z = W^-1 lam at one point: `factor` = sqrt(s / z), `point` = lam = sqrt(s z), both (rows, count)."""

    factor: FloatArray
    point: FloatArray

    def apply(self, v: FloatArray) -> FloatArray:
        """Return W v."""
        return self.factor * v

    def solve(self, v: FloatArray) -> FloatArray:
        """Return W^-1 v."""
        return v / self.factor

    def soften(self, v: FloatArray) -> FloatArray:
        """Return W^-2 v."""
        return v / self.factor / self.factor

    def divide(self, v: FloatArray) -> FloatArray:
        """Return u with lam o u = v."""
        return v / self.point


@dataclass(frozen=True, slots=True)
class Nonnegative:
    """`rows` nonnegative numbers of each of `count` local problems; vectors are (rows, count)."""

    rows: int
    count: int

    @property
    def degree(self) -> int:
        """Parameter of the barrier."""
        return self.rows * self.count

    def identity(self) -> FloatArray:
        """Return e."""
        return np.ones((self.rows, self.count))

    def inverse(self, s: FloatArray) -> FloatArray:
        """Return u with s o u = e."""
        return 1.0 / s

    def product(self, u: FloatArray, v: FloatArray) -> FloatArray:
        """Return u o v."""
        return u * v

    def margin(self, s: FloatArray) -> float:
        """Return the smallest eigenvalue."""
        return float(s.min(initial=np.inf))

    def rates(self, s: FloatArray, step: FloatArray, more: FloatArray, weights: FloatArray) -> FloatArray:
        """Return 1 / t for the largest t with s + t (step + weight more) >= 0, (weights, cones): at most 0 without one."""
        first, second = (step / -s).ravel(), (more / -s).ravel()
        return first + weights[:, None] * second

    def entries(self, values: FloatArray) -> FloatArray:
        """Return a value of each cone (cones,) at each of its entries, flat."""
        return values

    def scaling(self, s: FloatArray, z: FloatArray) -> NonnegativeScaling:
        """Return the Nesterov-Todd scaling of interior s and z."""
        return NonnegativeScaling(np.sqrt(s / z), np.sqrt(s * z))

    def recentre(self, product: FloatArray, low: float, high: float) -> FloatArray:
        """Return the correction that brings the eigenvalues of a complementarity product into [low, high]."""
        return np.maximum(np.clip(product, low, high) - product, -high)
