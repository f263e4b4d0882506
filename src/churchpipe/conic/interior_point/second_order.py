"""The second-order cone u_0 >= |u_1|: products, eigenvalues, steps and Nesterov-Todd scaling."""

from dataclasses import dataclass

import numpy as np

from churchpipe.model.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class SecondOrderScaling:
    """Scaling s = W lam, z = W^-1 lam at one point of every cone.

    W = eta (w_0, w_1^T; w_1, I + w_1 w_1^T / (1 + w_0)) with w_0^2 - |w_1|^2 = 1, and W^2 = eta^2 (2 w w^T - J).
    `eta` (copies, count); `w`, `point` = lam (dimension, copies, count).
    """

    eta: FloatArray
    w: FloatArray
    point: FloatArray

    def apply(self, v: FloatArray) -> FloatArray:
        """Return W v."""
        w0, w1 = self.w[0], self.w[1:]
        along = (w1 * v[1:]).sum(axis=0)
        out = np.empty_like(v)
        out[0] = self.eta * (w0 * v[0] + along)
        out[1:] = self.eta * (v[1:] + (v[0] + along / (1.0 + w0)) * w1)
        return out

    def solve(self, v: FloatArray) -> FloatArray:
        """Return W^-1 v."""
        w0, w1 = self.w[0], self.w[1:]
        along = (w1 * v[1:]).sum(axis=0)
        out = np.empty_like(v)
        out[0] = (w0 * v[0] - along) / self.eta
        out[1:] = (v[1:] + (along / (1.0 + w0) - v[0]) * w1) / self.eta
        return out

    def divide(self, v: FloatArray) -> FloatArray:
        """Return u with lam o u = v."""
        p0, p1 = self.point[0], self.point[1:]
        out = np.empty_like(v)
        out[0] = (p0 * v[0] - (p1 * v[1:]).sum(axis=0)) / _determinant(self.point)
        out[1:] = (v[1:] - out[0] * p1) / p0
        return out


@dataclass(frozen=True, slots=True)
class SecondOrder:
    """`copies` cones of one dimension in each of `count` local problems; vectors are (dimension, copies, count)."""

    dimension: int
    copies: int
    count: int

    @property
    def rows(self) -> int:
        """Rows of the local constraints that these cones take."""
        return self.dimension * self.copies

    @property
    def degree(self) -> int:
        """Parameter of the barrier, counted as one a cone (e has unit length in the scaled product)."""
        return self.copies * self.count

    def identity(self) -> FloatArray:
        """Return e."""
        out = np.zeros((self.dimension, self.copies, self.count))
        out[0] = 1.0
        return out

    def product(self, u: FloatArray, v: FloatArray) -> FloatArray:
        """Return u o v."""
        out = np.empty_like(u)
        out[0] = (u * v).sum(axis=0)
        out[1:] = u[0] * v[1:] + v[0] * u[1:]
        return out

    def margin(self, s: FloatArray) -> float:
        """Return the smallest eigenvalue."""
        return float((s[0] - _length(s)).min(initial=np.inf))

    def longest_step(self, s: FloatArray, step: FloatArray) -> float:
        """Return the largest t with s + t step in the cone, from the roots of its determinant in t."""
        root = np.sqrt(_determinant(s))
        # In the frame that takes s to e: step becomes (rho_0, rho_1), and s + t step leaves at 1 / (|rho_1| - rho_0).
        unit = s / root
        rho0 = unit[0] * step[0] - (unit[1:] * step[1:]).sum(axis=0)
        rho1 = step[1:] - ((step[0] + rho0) / (1.0 + unit[0])) * unit[1:]
        steepest = (np.sqrt((rho1**2).sum(axis=0)) - rho0) / root
        return 1.0 / max(float(steepest.max(initial=0.0)), 1e-300)

    def scaling(self, s: FloatArray, z: FloatArray) -> SecondOrderScaling:
        """Return the Nesterov-Todd scaling of interior s and z."""
        root_s, root_z = np.sqrt(_determinant(s)), np.sqrt(_determinant(z))
        unit_s, unit_z = s / root_s, z / root_z
        gamma = np.sqrt(0.5 * (1.0 + (unit_s * unit_z).sum(axis=0)))
        w = np.empty_like(s)
        w[0] = (unit_s[0] + unit_z[0]) / (2.0 * gamma)
        w[1:] = (unit_s[1:] - unit_z[1:]) / (2.0 * gamma)
        w[0] = np.sqrt(1.0 + (w[1:] ** 2).sum(axis=0))
        scaling = SecondOrderScaling(np.sqrt(root_s / root_z), w, s)
        point = scaling.apply(z)
        return SecondOrderScaling(scaling.eta, w, point)

    def recentre(self, product: FloatArray, low: float, high: float) -> FloatArray:
        """Return the correction that brings the eigenvalues of a complementarity product into [low, high]."""
        length = _length(product)
        direction = product[1:] / np.maximum(length, 1e-300)
        small, large = product[0] - length, product[0] + length
        fix_small = np.maximum(np.clip(small, low, high) - small, -high)
        fix_large = np.maximum(np.clip(large, low, high) - large, -high)
        out = np.empty_like(product)
        out[0] = 0.5 * (fix_large + fix_small)
        out[1:] = 0.5 * (fix_large - fix_small) * direction
        return out


def _length(s: FloatArray) -> FloatArray:
    return np.sqrt((s[1:] ** 2).sum(axis=0))


def _determinant(s: FloatArray) -> FloatArray:
    length = _length(s)
    return (s[0] - length) * (s[0] + length)
