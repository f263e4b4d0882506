"""The second-order cone u_0 >= |u_1|: products, eigenvalues, steps and Nesterov-Todd scaling."""

from dataclasses import dataclass

import numba
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
        out = np.empty_like(v)
        _scale(_flat(v), _flat(self.w), self.eta.ravel(), 1.0, _flat(out))
        return out

    def solve(self, v: FloatArray) -> FloatArray:
        """Return W^-1 v."""
        out = np.empty_like(v)
        _scale(_flat(v), _flat(self.w), 1.0 / self.eta.ravel(), -1.0, _flat(out))
        return out

    def soften(self, v: FloatArray) -> FloatArray:
        """Return W^-2 v."""
        out = np.empty_like(v)
        _soften(_flat(v), _flat(self.w), self.eta.ravel(), _flat(out))
        return out

    def divide(self, v: FloatArray) -> FloatArray:
        """Return u with lam o u = v."""
        out = np.empty_like(v)
        _divide(_flat(self.point), _flat(v), _flat(out))
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
        _divide(_flat(s), _flat(self.identity()), _flat(out))
        return out

    def product(self, u: FloatArray, v: FloatArray) -> FloatArray:
        """Return u o v."""
        out = np.empty_like(u)
        _multiply(_flat(u), _flat(v), _flat(out))
        return out

    def margin(self, s: FloatArray) -> float:
        """Return the smallest eigenvalue."""
        return float((s[0] - _length(s)).min(initial=np.inf))

    def longest_steps(self, s: FloatArray, step: FloatArray, more: FloatArray, weights: FloatArray) -> FloatArray:
        """Return the largest t with s + t (step + weight more) in the cone, from the roots of its determinant in t."""
        return 1.0 / np.maximum(_steepest(_flat(s), _flat(step), _flat(more), weights), 1e-300)

    def scaling(self, s: FloatArray, z: FloatArray) -> SecondOrderScaling:
        """Return the Nesterov-Todd scaling of interior s and z."""
        eta, w, point = np.empty(s.shape[1:]), np.empty_like(s), np.empty_like(s)
        _nesterov_todd(_flat(s), _flat(z), eta.reshape(-1), _flat(w))
        _scale(_flat(z), _flat(w), eta.ravel(), 1.0, _flat(point))
        return SecondOrderScaling(eta, w, point)

    def recentre(self, product: FloatArray, low: float, high: float) -> FloatArray:
        """Return the correction that brings the eigenvalues of a complementarity product into [low, high]."""
        out = np.empty_like(product)
        _recentre(_flat(product), low, high, _flat(out))
        return out


def _length(s: FloatArray) -> FloatArray:
    return np.sqrt((s[1:] ** 2).sum(axis=0))


def _flat(v: FloatArray) -> FloatArray:
    """Return a view (dimension, copies * count)."""
    return v.reshape(v.shape[0], -1)


@numba.njit(cache=True, inline="always", error_model="numpy")
def _determinant(s: FloatArray, k: int) -> float:
    square = 0.0
    for i in range(1, s.shape[0]):
        square += s[i, k] * s[i, k]
    length = np.sqrt(square)
    return (s[0, k] - length) * (s[0, k] + length)


@numba.njit(cache=True, error_model="numpy")
def _scale(v: FloatArray, w: FloatArray, eta: FloatArray, sign: float, out: FloatArray) -> None:
    """W v with sign 1; W^-1 v with sign -1 and the inverse of eta."""
    for k in range(v.shape[1]):
        along = 0.0
        for i in range(1, v.shape[0]):
            along += w[i, k] * v[i, k]
        out[0, k] = eta[k] * (w[0, k] * v[0, k] + sign * along)
        share = sign * v[0, k] + along / (1.0 + w[0, k])
        for i in range(1, v.shape[0]):
            out[i, k] = eta[k] * (v[i, k] + share * w[i, k])


@numba.njit(cache=True, error_model="numpy")
def _soften(v: FloatArray, w: FloatArray, eta: FloatArray, out: FloatArray) -> None:
    """W^-2 v as W^-1 twice: the closed form 2 w w^T - J would cancel."""
    for k in range(v.shape[1]):
        along, square = 0.0, 0.0
        for i in range(1, v.shape[0]):
            along += w[i, k] * v[i, k]
            square += w[i, k] * w[i, k]
        first = w[0, k] * v[0, k] - along
        share = along / (1.0 + w[0, k]) - v[0, k]
        along += share * square
        out[0, k] = (w[0, k] * first - along) / eta[k] ** 2
        share += along / (1.0 + w[0, k]) - first
        for i in range(1, v.shape[0]):
            out[i, k] = (v[i, k] + share * w[i, k]) / eta[k] ** 2


@numba.njit(cache=True, error_model="numpy")
def _divide(p: FloatArray, v: FloatArray, out: FloatArray) -> None:
    for k in range(v.shape[1]):
        along = 0.0
        for i in range(1, v.shape[0]):
            along += p[i, k] * v[i, k]
        out[0, k] = (p[0, k] * v[0, k] - along) / _determinant(p, k)
        for i in range(1, v.shape[0]):
            out[i, k] = (v[i, k] - out[0, k] * p[i, k]) / p[0, k]


@numba.njit(cache=True, error_model="numpy")
def _multiply(u: FloatArray, v: FloatArray, out: FloatArray) -> None:
    for k in range(v.shape[1]):
        total = u[0, k] * v[0, k]
        for i in range(1, v.shape[0]):
            total += u[i, k] * v[i, k]
            out[i, k] = u[0, k] * v[i, k] + v[0, k] * u[i, k]
        out[0, k] = total


@numba.njit(cache=True, error_model="numpy")
def _steepest(s: FloatArray, step: FloatArray, more: FloatArray, weights: FloatArray) -> FloatArray:
    """Return the largest rates at which a cone is left: in the frame that takes s to e, where the step becomes (rho_0, rho_1)."""
    steepest = np.zeros(len(weights))
    for k in range(s.shape[1]):
        root = np.sqrt(_determinant(s, k))
        for j in range(len(weights)):
            first = step[0, k] + weights[j] * more[0, k]
            rho0 = s[0, k] * first
            for i in range(1, s.shape[0]):
                rho0 -= s[i, k] * (step[i, k] + weights[j] * more[i, k])
            rho0 /= root
            share = (first + rho0) / (root + s[0, k])
            square = 0.0
            for i in range(1, s.shape[0]):
                square += (step[i, k] + weights[j] * more[i, k] - share * s[i, k]) ** 2
            steepest[j] = max(steepest[j], (np.sqrt(square) - rho0) / root)
    return steepest


@numba.njit(cache=True, error_model="numpy")
def _nesterov_todd(s: FloatArray, z: FloatArray, eta: FloatArray, w: FloatArray) -> None:
    for k in range(s.shape[1]):
        root_s, root_z = np.sqrt(_determinant(s, k)), np.sqrt(_determinant(z, k))
        both = 0.0
        for i in range(s.shape[0]):
            both += (s[i, k] / root_s) * (z[i, k] / root_z)
        twice = 2.0 * np.sqrt(0.5 * (1.0 + both))
        square = 1.0
        for i in range(1, s.shape[0]):
            w[i, k] = (s[i, k] / root_s - z[i, k] / root_z) / twice
            square += w[i, k] * w[i, k]
        w[0, k] = np.sqrt(square)
        eta[k] = np.sqrt(root_s / root_z)


@numba.njit(cache=True, error_model="numpy")
def _recentre(product: FloatArray, low: float, high: float, out: FloatArray) -> None:
    for k in range(product.shape[1]):
        square = 0.0
        for i in range(1, product.shape[0]):
            square += product[i, k] ** 2
        length = np.sqrt(square)
        small, large = product[0, k] - length, product[0, k] + length
        fix_small = max(min(max(small, low), high) - small, -high)
        fix_large = max(min(max(large, low), high) - large, -high)
        out[0, k] = 0.5 * (fix_large + fix_small)
        for i in range(1, product.shape[0]):
            out[i, k] = 0.5 * (fix_large - fix_small) * product[i, k] / max(length, 1e-300)
