"""Coupling of forces on rigid bodies. Products use axes and arms, which are a fifth of the numbers in the matrix itself."""

from typing import NamedTuple

import numba
import numpy as np

from churchpipe.conic.interior_point.coupling import Coupling
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray

# Entries that fit axes and arms to this share of the largest are equal to them but for rounding.
_ROUNDING = 1e-13


class Wrenches(NamedTuple):
    """Forces along three axes of each point, and their moments about each body that it touches.

    Point k touches blocks[pointer[k] : pointer[k + 1]]; at touch s, values[s, i] = sign_s (axis_i, arm_s x axis_i).
    frames_fij: axis i of frame f, frame[k] that of point k, one where neighbours share it.
    """

    pointer: IntArray
    blocks: IntArray
    frames: FloatArray
    frame: IntArray
    arms: FloatArray
    signs: FloatArray


class WrenchCoupling(Coupling):
    """A coupling whose blocks are wrenches."""

    wrenches: Wrenches

    def couple(self, x: FloatArray) -> FloatArray:
        """Return B x."""
        out = np.zeros(self.rows)
        _couple(self.wrenches, x, out)
        return out

    def spread(self, y: FloatArray) -> FloatArray:
        """Return B^T y."""
        out = np.empty(self.dimension * self.count)
        _spread(self.wrenches, y, out)
        return out

    def masked(self, active: BoolArray) -> Coupling:
        """Return the coupling without the columns that are not active (dimension, count)."""
        if active.all():
            return self
        plain = object.__new__(Coupling)
        plain.__dict__.update(self.__dict__)
        return Coupling.masked(plain, active)


def as_wrenches(coupling: Coupling) -> Coupling:
    """Return the coupling as wrenches where all its blocks are such, with three axes of unit length; else as it is."""
    if (coupling.dimension, coupling.block) != (3, 6) or not len(coupling.blocks):
        return coupling
    frames, frame = np.empty((coupling.count, 3, 3)), np.empty(coupling.count, dtype=np.int64)
    arms, signs = np.empty((len(coupling.blocks), 3)), np.empty(len(coupling.blocks))
    count, error = _fit(coupling.pointer, coupling.values, frames, frame, arms, signs)
    if error > _ROUNDING * max(1.0, float(np.abs(arms).max())):
        return coupling
    out = object.__new__(WrenchCoupling)
    out.__dict__.update(coupling.__dict__)
    out.wrenches = Wrenches(out.pointer, out.blocks, frames[:count].copy(), frame, arms, signs)
    return out


@numba.njit(cache=True)
def _fit(
    pointer: IntArray, values: FloatArray, frames: FloatArray, frame: IntArray, arms: FloatArray, signs: FloatArray
) -> tuple[int, float]:
    """Write frames, arms and signs; return the number of frames and the largest difference between an entry and its fit."""
    count, error = 0, 0.0
    frames[0] = 0.0
    for k in range(len(pointer) - 1):
        start = pointer[k]
        if start < pointer[k + 1]:
            fits = count > 0
            for i in range(3):
                for j in range(3):
                    fits = fits and frames[count - 1, i, j] == values[start, i, j]
            if not fits:
                frames[count] = values[start, :, :3]
                count += 1
        frame[k] = max(count - 1, 0)
        axes = frames[frame[k]]
        for touch in range(start, pointer[k + 1]):
            along = 0.0
            for i in range(3):
                for j in range(3):
                    along += axes[i, j] * values[touch, i, j]
            sign = 1.0 if along > 0 else -1.0
            signs[touch] = sign
            # For an orthonormal frame, sum_i axis_i x (arm x axis_i) = 2 arm.
            arms[touch] = 0.0
            for i in range(3):
                for j in range(3):
                    m, n = (j + 1) % 3, (j + 2) % 3
                    arms[touch, j] += 0.5 * sign * (axes[i, m] * values[touch, i, 3 + n] - axes[i, n] * values[touch, i, 3 + m])
            for i in range(3):
                for j in range(3):
                    m, n = (j + 1) % 3, (j + 2) % 3
                    moment = arms[touch, m] * axes[i, n] - arms[touch, n] * axes[i, m]
                    error = max(error, abs(values[touch, i, j] - sign * axes[i, j]))
                    error = max(error, abs(values[touch, i, 3 + j] - sign * moment))
    return count, error


@numba.njit(cache=True, fastmath={"reassoc", "contract"})
def _couple(wrenches: Wrenches, x: FloatArray, out: FloatArray) -> None:
    pointer, blocks, frames, frame, arms, signs = wrenches
    count = len(pointer) - 1
    for k in range(count):
        axes = frames[frame[k]]
        n, u, v = x[k], x[count + k], x[2 * count + k]
        f0 = axes[0, 0] * n + axes[1, 0] * u + axes[2, 0] * v
        f1 = axes[0, 1] * n + axes[1, 1] * u + axes[2, 1] * v
        f2 = axes[0, 2] * n + axes[1, 2] * u + axes[2, 2] * v
        for touch in range(pointer[k], pointer[k + 1]):
            first, sign = 6 * blocks[touch], signs[touch]
            a0, a1, a2 = sign * arms[touch, 0], sign * arms[touch, 1], sign * arms[touch, 2]
            out[first] += sign * f0
            out[first + 1] += sign * f1
            out[first + 2] += sign * f2
            out[first + 3] += a1 * f2 - a2 * f1
            out[first + 4] += a2 * f0 - a0 * f2
            out[first + 5] += a0 * f1 - a1 * f0


@numba.njit(cache=True, fastmath={"reassoc", "contract"})
def _spread(wrenches: Wrenches, y: FloatArray, out: FloatArray) -> None:
    pointer, blocks, frames, frame, arms, signs = wrenches
    count = len(pointer) - 1
    for k in range(count):
        v0 = v1 = v2 = 0.0
        for touch in range(pointer[k], pointer[k + 1]):
            first, sign = 6 * blocks[touch], signs[touch]
            a0, a1, a2 = sign * arms[touch, 0], sign * arms[touch, 1], sign * arms[touch, 2]
            r0, r1, r2 = y[first + 3], y[first + 4], y[first + 5]
            v0 += sign * y[first] + r1 * a2 - r2 * a1
            v1 += sign * y[first + 1] + r2 * a0 - r0 * a2
            v2 += sign * y[first + 2] + r0 * a1 - r1 * a0
        axes = frames[frame[k]]
        for i in range(3):
            out[i * count + k] = axes[i, 0] * v0 + axes[i, 1] * v1 + axes[i, 2] * v2
