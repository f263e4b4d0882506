"""Loops over second-order cones, compiled for one dimension: loops of known length inside become vector instructions."""

from collections.abc import Callable
from functools import lru_cache
from typing import Any, NamedTuple, TypeAlias

import numba
import numpy as np

from churchpipe.model.arrays import FloatArray

_Loop: TypeAlias = Callable[..., None]


class Kernels(NamedTuple):
    """Loops that write their last argument(s); vectors are (dimension, cones)."""

    scale: _Loop
    soften: _Loop
    divide: _Loop
    multiply: _Loop
    rates: _Loop
    nesterov_todd: _Loop
    recentre: _Loop


# At the level of the module, not inside `kernels`: a loop that encloses another compiled one is compiled anew in each process.
@numba.njit(cache=True, error_model="numpy")
def _determinant(s: FloatArray, k: int, dimension: int) -> float:
    square = 0.0
    for i in range(1, dimension):
        square += s[i, k] * s[i, k]
    length = np.sqrt(square)
    return (s[0, k] - length) * (s[0, k] + length)


@lru_cache
def kernels(dimension: int) -> Kernels:
    """Return the loops for cones of one dimension."""
    compiled: Callable[[Any], Any] = numba.njit(cache=True, error_model="numpy")

    @compiled
    def scale(v: FloatArray, w: FloatArray, eta: FloatArray, sign: float, out: FloatArray) -> None:
        """W v with sign 1; W^-1 v with sign -1 and the inverse of eta."""
        for k in range(v.shape[1]):
            along = 0.0
            for i in range(1, dimension):
                along += w[i, k] * v[i, k]
            share = sign * v[0, k] + along / (1.0 + w[0, k])
            out[0, k] = eta[k] * (w[0, k] * v[0, k] + sign * along)
            for i in range(1, dimension):
                out[i, k] = eta[k] * (v[i, k] + share * w[i, k])

    @compiled
    def soften(v: FloatArray, w: FloatArray, eta: FloatArray, out: FloatArray) -> None:
        """W^-2 v as W^-1 twice: the closed form 2 w w^T - J would cancel."""
        for k in range(v.shape[1]):
            along, square = 0.0, 0.0
            for i in range(1, dimension):
                along += w[i, k] * v[i, k]
                square += w[i, k] * w[i, k]
            first = w[0, k] * v[0, k] - along
            share = along / (1.0 + w[0, k]) - v[0, k]
            along += share * square
            out[0, k] = (w[0, k] * first - along) / eta[k] ** 2
            share += along / (1.0 + w[0, k]) - first
            for i in range(1, dimension):
                out[i, k] = (v[i, k] + share * w[i, k]) / eta[k] ** 2

    @compiled
    def divide(p: FloatArray, v: FloatArray, out: FloatArray) -> None:
        """Return u with p o u = v."""
        for k in range(v.shape[1]):
            along = 0.0
            for i in range(1, dimension):
                along += p[i, k] * v[i, k]
            first = (p[0, k] * v[0, k] - along) / _determinant(p, k, dimension)
            out[0, k] = first
            for i in range(1, dimension):
                out[i, k] = (v[i, k] - first * p[i, k]) / p[0, k]

    @compiled
    def multiply(u: FloatArray, v: FloatArray, out: FloatArray) -> None:
        """u o v."""
        for k in range(v.shape[1]):
            total = u[0, k] * v[0, k]
            for i in range(1, dimension):
                total += u[i, k] * v[i, k]
                out[i, k] = u[0, k] * v[i, k] + v[0, k] * u[i, k]
            out[0, k] = total

    @compiled
    def rates(s: FloatArray, step: FloatArray, more: FloatArray, weights: FloatArray, out: FloatArray) -> None:
        """Rates at which cones are left along step + weight more, (weights, cones).

        In the frame that takes s to e, where the step becomes (rho_0, rho_1).
        """
        roots = np.empty(s.shape[1])
        for k in range(s.shape[1]):
            roots[k] = np.sqrt(_determinant(s, k, dimension))
        for j in range(len(weights)):
            weight = weights[j]
            for k in range(s.shape[1]):
                root = roots[k]
                first = step[0, k] + weight * more[0, k]
                rho = s[0, k] * first
                for i in range(1, dimension):
                    rho -= s[i, k] * (step[i, k] + weight * more[i, k])
                rho /= root
                share = (first + rho) / (root + s[0, k])
                square = 0.0
                for i in range(1, dimension):
                    side = step[i, k] + weight * more[i, k] - share * s[i, k]
                    square += side * side
                out[j, k] = (np.sqrt(square) - rho) / root

    @compiled
    def nesterov_todd(s: FloatArray, z: FloatArray, eta: FloatArray, w: FloatArray) -> None:
        for k in range(s.shape[1]):
            root_s, root_z = np.sqrt(_determinant(s, k, dimension)), np.sqrt(_determinant(z, k, dimension))
            both = 0.0
            for i in range(dimension):
                both += (s[i, k] / root_s) * (z[i, k] / root_z)
            twice = 2.0 * np.sqrt(0.5 * (1.0 + both))
            square = 1.0
            for i in range(1, dimension):
                side = (s[i, k] / root_s - z[i, k] / root_z) / twice
                w[i, k] = side
                square += side * side
            w[0, k] = np.sqrt(square)
            eta[k] = np.sqrt(root_s / root_z)

    @compiled
    def recentre(product: FloatArray, low: float, high: float, out: FloatArray) -> None:
        """Corrections that bring the eigenvalues of a product into [low, high], each of `high` at most downward."""
        for k in range(product.shape[1]):
            square = 0.0
            for i in range(1, dimension):
                square += product[i, k] * product[i, k]
            length = np.sqrt(square)
            small, large = product[0, k] - length, product[0, k] + length
            fix_small = max(min(max(small, low), high) - small, -high)
            fix_large = max(min(max(large, low), high) - large, -high)
            share = 0.5 * (fix_large - fix_small) / max(length, 1e-300)
            out[0, k] = 0.5 * (fix_large + fix_small)
            for i in range(1, dimension):
                out[i, k] = share * product[i, k]

    return Kernels(scale, soften, divide, multiply, rates, nesterov_todd, recentre)
