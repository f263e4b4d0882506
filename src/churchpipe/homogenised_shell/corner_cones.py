"""Forces x at the corners of cells and their multipliers z in an interior-point step: what each corner answers to a motion.

All arrays are (3, corners). The slacks s = F x, F = diag(slope, 1, 1), and z lie in the second-order cone; W is their
Nesterov-Todd scaling, and L = W^-1 s = W z. Where a motion opens the corners by V, a Newton step changes

    z by dz = F^-1 V   and   s by ds = aim - s - W^2 dz,

with aim = 0 for products of zero, or mu z^-1 and corrections. Each loop passes over the corners once and finds the scaling anew,
because reading it from memory would take longer. Their counters have no sign: one that might be negative keeps the compiler from
vector instructions.
"""

from collections.abc import Callable
from typing import Any, TypeAlias

import numba
import numpy as np

from churchpipe.conic.interior_point.coulomb import CoulombCompliance
from churchpipe.conic.threads import bounds_of, in_shares
from churchpipe.model.arrays import FloatArray

_Vector: TypeAlias = tuple[float, float, float]
_Scaling: TypeAlias = tuple[float, float, float, float]
loop: Callable[[Any], Any] = numba.njit(cache=True, error_model="numpy", nogil=True, fastmath={"reassoc", "contract"})
_inline: Callable[[Any], Any] = numba.njit(cache=True, error_model="numpy", inline="always")


class CornerCones:
    """Forces and multipliers of all corners, both inside their cones, and the last direction that they answered.

    slope (corners,): friction. tried: ds and dz of the last answer. An aim is good until the next but one.
    """

    def __init__(self, x: FloatArray, z: FloatArray, slope: FloatArray) -> None:
        self.x, self.z, self.slope = x, z, slope
        self._ds, self._dz, self.tried = np.empty_like(x), np.empty_like(x), (np.empty_like(x), np.empty_like(x))
        self._aims = np.empty_like(x), np.empty_like(x)
        self._products = np.empty(x.shape[1])

    def compliance(self) -> CoulombCompliance:
        """Return F^-1 W^2 F^-1."""
        parts, direction = np.empty((4, self.x.shape[1])), np.empty((2, self.x.shape[1]))
        in_shares(_comply, self.x.shape[1], self.x, self.z, self.slope, parts, direction)
        return CoulombCompliance(parts[0], parts[1], parts[2], parts[3], direction)

    def keep(self) -> None:
        """Keep the last answer."""
        (self._ds, self._dz), self.tried = self.tried, (self._ds, self._dz)

    def second_order(self, target: float) -> FloatArray:
        """Return the aim for products of `target`, less the product of the answer kept, which a linear step neglects."""
        out = self._aims[0]
        in_shares(_second_order, self.x.shape[1], self.x, self.z, self.slope, self._ds, self._dz, target, out)
        return out

    def recentred(self, aim: FloatArray, length: float, target: float) -> FloatArray:
        """Return an aim that brings the products at `length` along the answer kept into [.1, 10] target (Gondzio 1996)."""
        out = self._aims[1] if aim is self._aims[0] else self._aims[0]
        in_shares(
            _recentred,
            self.x.shape[1],
            self.x,
            self.z,
            self.slope,
            self._ds,
            self._dz,
            length,
            0.1 * target,
            10.0 * target,
            aim,
            out,
        )
        return out

    def move(self, length: float) -> float:
        """Go so far along the answer kept, and return the sum of the products s z."""
        in_shares(_moved, self.x.shape[1], self.x, self.z, self.slope, self._ds, self._dz, length, self._products)
        return float(self._products.sum())


def central_pair(x: FloatArray, z: FloatArray, slope: FloatArray, margin: float, product: float) -> tuple[FloatArray, FloatArray]:
    """Return forces and multipliers near x and z, inside their cones and all with one product.

    Of all pairs with s o z = product these keep s - w z (Chen and Mangasarian 1996), with w such that a slack and a multiplier
    that both vanish become `margin` and product / margin.
    """
    s, near = np.empty_like(x), np.empty_like(x)
    in_shares(_central, x.shape[1], x, z, slope, margin**2 / product, product, s, near)
    return s, near


@_inline
def _scaling(s0: float, s1: float, s2: float, z0: float, z1: float, z2: float) -> _Scaling:
    """Return eta and w of W = eta (w_0, w_1^T; w_1, I + w_1 w_1^T / (1 + w_0))."""
    length_s, length_z = np.sqrt(s1 * s1 + s2 * s2), np.sqrt(z1 * z1 + z2 * z2)
    root_s = np.sqrt((s0 - length_s) * (s0 + length_s))
    root_z = np.sqrt((z0 - length_z) * (z0 + length_z))
    over_s, over_z = 1.0 / root_s, 1.0 / root_z
    both = (s0 * z0 + s1 * z1 + s2 * z2) * over_s * over_z
    twice = 1.0 / np.sqrt(2.0 * (1.0 + both))
    w1, w2 = (s1 * over_s - z1 * over_z) * twice, (s2 * over_s - z2 * over_z) * twice
    return np.sqrt(root_s * over_z), np.sqrt(1.0 + w1 * w1 + w2 * w2), w1, w2


@_inline
def _scaled(eta: float, w0: float, w1: float, w2: float, v0: float, v1: float, v2: float) -> _Vector:
    """Return W v; W^-1 v for 1 / eta and w_1 reversed."""
    along = w1 * v1 + w2 * v2
    share = v0 + along / (1.0 + w0)
    return eta * (w0 * v0 + along), eta * (v1 + share * w1), eta * (v2 + share * w2)


@_inline
def _stretched(eta: float, w0: float, w1: float, w2: float, v0: float, v1: float, v2: float) -> _Vector:
    """Return W^2 v with errors along the surface of the cone only: v_0 and the part of (v_1, v_2) along w_1 by a triangle."""
    square = w1 * w1 + w2 * w2
    length = np.sqrt(square)
    stretch = 1.0 + 2.0 * square
    over = 1.0 / max(length, 1e-300)
    u, v = w1 * over, w2 * over
    if length == 0.0:
        u = 1.0
    lean = 2.0 * w0 * length / stretch
    push = v1 * u + v2 * v
    side = eta * eta * (v2 * u - v1 * v)
    first = eta * eta * stretch * (v0 + lean * push)
    slide = eta * eta / stretch * push + lean * first
    return first, slide * u - side * v, slide * v + side * u


@_inline
def _rate(s0: float, s1: float, s2: float, d0: float, d1: float, d2: float) -> float:
    """Return 1 / t for the largest t with s + t d in the cone, at most 0 without one."""
    length = np.sqrt(s1 * s1 + s2 * s2)
    root = np.sqrt((s0 - length) * (s0 + length))
    over = 1.0 / root
    rho = (s0 * d0 - s1 * d1 - s2 * d2) * over
    share = (d0 + rho) / (root + s0)
    a, b = d1 - share * s1, d2 - share * s2
    return (np.sqrt(a * a + b * b) - rho) * over


@_inline
def _divided(l0: float, l1: float, l2: float, p0: float, p1: float, p2: float) -> _Vector:
    """Return u with L o u = p."""
    length = np.sqrt(l1 * l1 + l2 * l2)
    first = (l0 * p0 - l1 * p1 - l2 * p2) / ((l0 - length) * (l0 + length))
    return first, (p1 - first * l1) / l0, (p2 - first * l2) / l0


@_inline
def _eigenvalue(v: float, square: float) -> float:
    """Return the positive s with s - square / s = v."""
    root = np.sqrt(v * v + 4.0 * square)
    return 0.5 * (v + root) if v > 0.0 else 2.0 * square / (root - v)


@loop
def _comply(
    share: int, shares: int, x: FloatArray, z: FloatArray, slope: FloatArray, parts: FloatArray, direction: FloatArray
) -> None:
    begin, end = bounds_of(x.shape[1], share, shares)
    for k in range(np.uint64(begin), np.uint64(end)):
        eta, w0, w1, w2 = _scaling(slope[k] * x[0, k], x[1, k], x[2, k], z[0, k], z[1, k], z[2, k])
        square = w1 * w1 + w2 * w2
        length = np.sqrt(square)
        stretch = 1.0 + 2.0 * square
        over = 1.0 / max(length, 1e-300)
        direction[0, k] = w1 * over if length > 0.0 else 1.0
        direction[1, k] = w2 * over
        eta *= eta
        parts[0, k] = eta * stretch / (slope[k] * slope[k])
        parts[1, k] = 2.0 * slope[k] * w0 * length / stretch
        parts[2, k] = eta / stretch
        parts[3, k] = eta


@loop
def pushed(
    x: FloatArray,
    z: FloatArray,
    slope: FloatArray,
    aim: FloatArray,
    lack: FloatArray,
    left: float,
    begin: int,
    size: int,
    out: FloatArray,
    to: int,
) -> None:
    """Write x + dx of `size` corners from `begin` on, which open by left lack and no more, into `out` from `to` on."""
    for k in range(np.uint64(begin), np.uint64(begin + size)):
        at = k + np.uint64(to) - np.uint64(begin)
        eta, w0, w1, w2 = _scaling(slope[k] * x[0, k], x[1, k], x[2, k], z[0, k], z[1, k], z[2, k])
        a, b, c = _stretched(eta, w0, w1, w2, left * lack[0, k] / slope[k], left * lack[1, k], left * lack[2, k])
        out[0, at] = (aim[0, k] - a) / slope[k]
        out[1, at] = aim[1, k] - b
        out[2, at] = aim[2, k] - c


@loop
def answered(
    x: FloatArray,
    z: FloatArray,
    slope: FloatArray,
    aim: FloatArray,
    opening: FloatArray,
    at: int,
    begin: int,
    size: int,
    ds: FloatArray,
    dz: FloatArray,
    rates: FloatArray,
) -> None:
    """Write ds, dz and the rate at which the nearer cone is left, of `size` corners from `begin` on.

    Their `opening` stands there from `at` on. With one array more the compiler would need so many proofs that none overlap
    that it gives up vector instructions.
    """
    for k in range(np.uint64(begin), np.uint64(begin + size)):
        near = k - np.uint64(begin)
        s0, s1, s2, z0, z1, z2 = slope[k] * x[0, k], x[1, k], x[2, k], z[0, k], z[1, k], z[2, k]
        eta, w0, w1, w2 = _scaling(s0, s1, s2, z0, z1, z2)
        e0 = opening[0, near + np.uint64(at)] / slope[k]
        e1, e2 = opening[1, near + np.uint64(at)], opening[2, near + np.uint64(at)]
        a, b, c = _stretched(eta, w0, w1, w2, e0, e1, e2)
        d0, d1, d2 = aim[0, k] - s0 - a, aim[1, k] - s1 - b, aim[2, k] - s2 - c
        rates[near] = max(_rate(s0, s1, s2, d0, d1, d2), _rate(z0, z1, z2, e0, e1, e2))
        ds[0, k], ds[1, k], ds[2, k] = d0, d1, d2
        dz[0, k], dz[1, k], dz[2, k] = e0, e1, e2


@loop
def _second_order(
    share: int,
    shares: int,
    x: FloatArray,
    z: FloatArray,
    slope: FloatArray,
    ds: FloatArray,
    dz: FloatArray,
    target: float,
    out: FloatArray,
) -> None:
    begin, end = bounds_of(x.shape[1], share, shares)
    for k in range(np.uint64(begin), np.uint64(end)):
        s0, s1, s2, z0, z1, z2 = slope[k] * x[0, k], x[1, k], x[2, k], z[0, k], z[1, k], z[2, k]
        eta, w0, w1, w2 = _scaling(s0, s1, s2, z0, z1, z2)
        l0, l1, l2 = _scaled(eta, w0, w1, w2, z0, z1, z2)
        a0, a1, a2 = _scaled(1.0 / eta, w0, -w1, -w2, ds[0, k], ds[1, k], ds[2, k])
        b0, b1, b2 = _scaled(eta, w0, w1, w2, dz[0, k], dz[1, k], dz[2, k])
        p0, p1, p2 = target - (a0 * b0 + a1 * b1 + a2 * b2), -(a0 * b1 + b0 * a1), -(a0 * b2 + b0 * a2)
        u0, u1, u2 = _divided(l0, l1, l2, p0, p1, p2)
        out[0, k], out[1, k], out[2, k] = _scaled(eta, w0, w1, w2, u0, u1, u2)


@loop
def _recentred(
    share: int,
    shares: int,
    x: FloatArray,
    z: FloatArray,
    slope: FloatArray,
    ds: FloatArray,
    dz: FloatArray,
    length: float,
    low: float,
    high: float,
    aim: FloatArray,
    out: FloatArray,
) -> None:
    begin, end = bounds_of(x.shape[1], share, shares)
    for k in range(np.uint64(begin), np.uint64(end)):
        s0, s1, s2, z0, z1, z2 = slope[k] * x[0, k], x[1, k], x[2, k], z[0, k], z[1, k], z[2, k]
        eta, w0, w1, w2 = _scaling(s0, s1, s2, z0, z1, z2)
        l0, l1, l2 = _scaled(eta, w0, w1, w2, z0, z1, z2)
        a0, a1, a2 = _scaled(1.0 / eta, w0, -w1, -w2, ds[0, k], ds[1, k], ds[2, k])
        b0, b1, b2 = _scaled(eta, w0, w1, w2, dz[0, k], dz[1, k], dz[2, k])
        a0, a1, a2 = l0 + length * a0, l1 + length * a1, l2 + length * a2
        b0, b1, b2 = l0 + length * b0, l1 + length * b1, l2 + length * b2
        p0, p1, p2 = a0 * b0 + a1 * b1 + a2 * b2, a0 * b1 + b0 * a1, a0 * b2 + b0 * a2
        size = np.sqrt(p1 * p1 + p2 * p2)
        small, large = p0 - size, p0 + size
        fix_small = max(min(max(small, low), high) - small, -high)
        fix_large = max(min(max(large, low), high) - large, -high)
        lean = 0.5 * (fix_large - fix_small) / max(size, 1e-300)
        u0, u1, u2 = _divided(l0, l1, l2, 0.5 * (fix_large + fix_small), lean * p1, lean * p2)
        u0, u1, u2 = _scaled(eta, w0, w1, w2, u0, u1, u2)
        out[0, k], out[1, k], out[2, k] = aim[0, k] + u0, aim[1, k] + u1, aim[2, k] + u2


@loop
def _moved(
    share: int,
    shares: int,
    x: FloatArray,
    z: FloatArray,
    slope: FloatArray,
    ds: FloatArray,
    dz: FloatArray,
    length: float,
    products: FloatArray,
) -> None:
    begin, end = bounds_of(x.shape[1], share, shares)
    for k in range(np.uint64(begin), np.uint64(end)):
        x[0, k] += length * ds[0, k] / slope[k]
        z[0, k] += length * dz[0, k]
        total = slope[k] * x[0, k] * z[0, k]
        for i in range(1, 3):
            x[i, k] += length * ds[i, k]
            z[i, k] += length * dz[i, k]
            total += x[i, k] * z[i, k]
        products[k] = total


@loop
def _central(
    share: int,
    shares: int,
    x: FloatArray,
    z: FloatArray,
    slope: FloatArray,
    weight: float,
    product: float,
    out: FloatArray,
    near: FloatArray,
) -> None:
    begin, end = bounds_of(x.shape[1], share, shares)
    for k in range(np.uint64(begin), np.uint64(end)):
        v0, v1, v2 = slope[k] * x[0, k] - weight * z[0, k], x[1, k] - weight * z[1, k], x[2, k] - weight * z[2, k]
        length = np.sqrt(v1 * v1 + v2 * v2)
        large, small = _eigenvalue(v0 + length, weight * product), _eigenvalue(v0 - length, weight * product)
        axis, lean = 0.5 * (large + small), 0.5 * (large - small) / max(length, 1e-300)
        inverse = product / (large * small)
        out[0, k], out[1, k], out[2, k] = axis / slope[k], lean * v1, lean * v2
        near[0, k], near[1, k], near[2, k] = inverse * axis, -inverse * lean * v1, -inverse * lean * v2
