"""The second-order cone u_0 >= |u_1|: products, eigenvalues, steps and Nesterov-Todd scaling."""

from dataclasses import dataclass

import numpy as np

from churchpipe.conic.interior_point.second_order_kernels import kernels
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
        out = np.empty_like(v)
        kernels(len(v)).scale(_flat(v), _flat(self.w), self.eta.ravel(), 1.0, _flat(out))
        return out

    def solve(self, v: FloatArray) -> FloatArray:
        """Return W^-1 v."""
        out = np.empty_like(v)
        kernels(len(v)).scale(_flat(v), _flat(self.w), 1.0 / self.eta.ravel(), -1.0, _flat(out))
        return out

    def soften(self, v: FloatArray) -> FloatArray:
        """Return W^-2 v."""
        out = np.empty_like(v)
        kernels(len(v)).soften(_flat(v), _flat(self.w), self.eta.ravel(), _flat(out))
        return out

    def divide(self, v: FloatArray) -> FloatArray:
        """Return u with lam o u = v."""
        out = np.empty_like(v)
        kernels(len(v)).divide(_flat(self.point), _flat(v), _flat(out))
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

    def inverse(self, s: FloatArray) -> FloatArray:
        """Return u with s o u = e."""
        out = np.empty_like(s)
        kernels(self.dimension).divide(_flat(s), _flat(self.identity()), _flat(out))
        return out

    def product(self, u: FloatArray, v: FloatArray) -> FloatArray:
        """Return u o v."""
        out = np.empty_like(u)
        kernels(self.dimension).multiply(_flat(u), _flat(v), _flat(out))
        return out

    def margin(self, s: FloatArray) -> float:
        """Return the smallest eigenvalue."""
        return float((s[0] - _length(s)).min(initial=np.inf))

    def rates(self, s: FloatArray, step: FloatArray, more: FloatArray, weights: FloatArray) -> FloatArray:
        """Return 1 / t for the largest t with s + t (step + weight more) in a cone, (weights, cones): at most 0 without one."""
        out = np.empty((len(weights), self.degree))
        kernels(self.dimension).rates(_flat(s), _flat(step), _flat(more), weights, out)
        return out

    def entries(self, values: FloatArray) -> FloatArray:
        """Return a value of each cone (cones,) at each of its entries, flat."""
        return np.tile(values, self.dimension)

    def scaling(self, s: FloatArray, z: FloatArray) -> SecondOrderScaling:
        """Return the Nesterov-Todd scaling of interior s and z."""
        eta, w, point = np.empty(s.shape[1:]), np.empty_like(s), np.empty_like(s)
        kernels(self.dimension).nesterov_todd(_flat(s), _flat(z), eta.reshape(-1), _flat(w))
        kernels(self.dimension).scale(_flat(z), _flat(w), eta.ravel(), 1.0, _flat(point))
        return SecondOrderScaling(eta, w, point)

    def recentre(self, product: FloatArray, low: float, high: float) -> FloatArray:
        """Return the correction that brings the eigenvalues of a complementarity product into [low, high]."""
        out = np.empty_like(product)
        kernels(self.dimension).recentre(_flat(product), low, high, _flat(out))
        return out


def _length(s: FloatArray) -> FloatArray:
    return np.sqrt((s[1:] ** 2).sum(axis=0))


def _flat(v: FloatArray) -> FloatArray:
    """Return a view (dimension, copies * count)."""
    return v.reshape(v.shape[0], -1)
