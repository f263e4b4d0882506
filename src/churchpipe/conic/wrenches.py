"""The balance of rigid bodies as a linear map: forces at points to wrenches on bodies, by axes and arms instead of a matrix."""

from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

import numba
import numpy as np
import scipy.sparse as sp

from churchpipe.model.arrays import BoolArray, FloatArray, IntArray, indices, pointer_of, pointers, store, store_arrays

# Rows of the balance of one rigid body: a force and a moment.
BODY = 6
_Arrays: TypeAlias = tuple[IntArray, IntArray, FloatArray, FloatArray, FloatArray, IntArray, FloatArray]


@dataclass(frozen=True, eq=False)
class Wrenches:
    """The map A (6 count, 3 c) of forces x_k = (n, t1, t2) at c points on the wrenches (force, moment) of `count` rigid bodies.

    Point k acts on bodies[pointer[k] : pointer[k + 1]], in ascending order: each of these is a touch. At a touch with a body the
    force x_k, in the axes frames[frame[k]] (rows n, t1, t2, orthonormal and right-handed), times the sign of the touch acts at
    the arm from the centre of the body. Shear may act beside the point: by `shift` (c, 2) along t1 and t2.

    pointer (c + 1,); bodies (touches,); signs (touches,), 1 or -1, or a share of it where a force is spread over several bodies;
    arms (touches, 3); frames (f, 3, 3), one for all points of a joint; frame (c,). As a matrix it has five times as many numbers.
    """

    count: int
    pointer: IntArray
    bodies: IntArray
    arms: FloatArray
    signs: FloatArray
    frames: FloatArray
    frame: IntArray
    shift: FloatArray

    def __post_init__(self) -> None:
        points, touches = len(self.frame), len(self.bodies)
        store_arrays(self, arms=(touches, 3), signs=(touches,), frames=(None, 3, 3), shift=(points, 2))
        store(
            self,
            pointer=pointers("Wrenches.pointer", self.pointer, points, touches),
            frame=indices("Wrenches.frame", self.frame, (points,), below=len(self.frames)),
            bodies=indices("Wrenches.bodies", self.bodies, (touches,), below=self.count),
        )

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of the matrix."""
        return BODY * self.count, 3 * len(self.frame)

    @property
    def arrays(self) -> _Arrays:
        """The arrays in the order in which the compiled products take them."""
        return self.pointer, self.bodies, self.arms, self.signs, self.frames, self.frame, self.shift

    def apply(self, x: FloatArray) -> FloatArray:
        """Return A x (6 count,) of forces x (c, 3)."""
        out = np.zeros(self.shape[0])
        couple(self.arrays, np.ascontiguousarray(x.T).ravel(), out)
        return out

    def transpose(self, y: FloatArray) -> FloatArray:
        """Return A^T y (c, 3): the rates of opening and sliding at the points, of velocities y (6 count,)."""
        out = np.empty(self.shape[1])
        spread(self.arrays, y, out)
        return np.ascontiguousarray(out.reshape(3, -1).T)

    def sizes(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the largest entry of each row (6 count,), and the sum of its entries times x (c, 3), all without their signs."""
        largest, passing = np.zeros(self.shape[0]), np.zeros(self.shape[0])
        _size(self.arrays, np.abs(x), largest, passing)
        return largest, passing

    def blocks(self) -> FloatArray:
        """Return the entries of the matrix, values_sij (touches, 3, 6): component i of the force on row j of the body."""
        out = np.empty((len(self.bodies), 3, BODY))
        _fill(self.arrays, out)
        return out

    def tocsc(self) -> sp.csc_matrix[np.float64]:
        """Return the matrix."""
        return self._matrix

    @cached_property
    def _matrix(self) -> sp.csc_matrix[np.float64]:
        width = np.diff(self.pointer)
        # Each touch has its six rows in the three columns of its point.
        rank = np.arange(len(self.bodies)) - np.repeat(self.pointer[:-1], width)
        first = 3 * BODY * np.repeat(self.pointer[:-1], width) + BODY * rank
        own = BODY * np.repeat(width, width)
        place = (first[:, None] + own[:, None] * np.arange(3))[:, :, None] + np.arange(BODY)
        data, rows = np.empty(place.size), np.empty(place.size, dtype=np.int32)
        data[place] = self.blocks()
        rows[place] = (BODY * self.bodies)[:, None, None] + np.arange(BODY)
        starts = pointer_of(np.repeat(BODY * width, 3)).astype(np.int32)
        return sp.csc_matrix((data, rows, starts), shape=self.shape)

    def joined(self, other: "Wrenches") -> "Wrenches":
        """Return the map with the points of another one, on the same bodies, after its own."""
        return Wrenches(
            self.count,
            np.concatenate([self.pointer, self.pointer[-1] + other.pointer[1:]]),
            np.concatenate([self.bodies, other.bodies]),
            np.concatenate([self.arms, other.arms]),
            np.concatenate([self.signs, other.signs]),
            np.concatenate([self.frames, other.frames]),
            np.concatenate([self.frame, len(self.frames) + other.frame]),
            np.concatenate([self.shift, other.shift]),
        )

    def first(self, points: int) -> "Wrenches":
        """Return the map of its first points alone."""
        touches = int(self.pointer[points])
        return Wrenches(
            self.count,
            self.pointer[: points + 1],
            self.bodies[:touches],
            self.arms[:touches],
            self.signs[:touches],
            self.frames,
            self.frame[:points],
            self.shift[:points],
        )


# What a cone program balances: the wrenches of rigid bodies, or any matrix with three columns a point.
Balance: TypeAlias = Wrenches | sp.csc_matrix[np.float64]


def apply(balance: Balance, x: FloatArray) -> FloatArray:
    """Return the rows (m,) of forces x (c, 3)."""
    return balance.apply(x) if isinstance(balance, Wrenches) else np.asarray(balance @ x.ravel())


def transpose(balance: Balance, y: FloatArray) -> FloatArray:
    """Return the rates (c, 3) of multipliers y (m,)."""
    return balance.transpose(y) if isinstance(balance, Wrenches) else np.asarray(balance.T @ y).reshape(-1, 3)


def as_matrix(balance: Balance) -> sp.csc_matrix[np.float64]:
    """Return the matrix (m, 3 c), its columns point by point."""
    return balance.tocsc() if isinstance(balance, Wrenches) else balance


def pair_wrenches(
    count: int,
    bodies: IntArray,
    arms: FloatArray,
    frames: FloatArray,
    frame: IntArray,
    shift: FloatArray | None = None,
) -> Wrenches:
    """Return the map of points between pairs of bodies: forces act on the second body, and against it on the first.

    bodies (c, 2): numbers below `count`, or -1 for one that does not move; arms (c, 2, 3): from the centre of each to the point;
    the rest as in `Wrenches`, no shift if None.
    """
    swapped = bodies[:, 0] > bodies[:, 1]
    sides = np.where(swapped[:, None], [1, 0], [0, 1])
    ordered = np.take_along_axis(bodies, sides, axis=1)
    moving: BoolArray = ordered >= 0
    pointer = pointer_of(moving.sum(axis=1))
    return Wrenches(
        count,
        pointer,
        ordered[moving],
        np.take_along_axis(arms, sides[:, :, None], axis=1)[moving],
        np.where(sides == 1, 1.0, -1.0)[moving],
        frames,
        frame,
        np.zeros((len(bodies), 2)) if shift is None else shift,
    )


@numba.njit(cache=True)
def _block(arrays: _Arrays, k: int, touch: int, out: FloatArray) -> None:
    """Write the entries (3, 6) of one touch."""
    _, _, arms, signs, frames, frame, shift = arrays
    axes, arm, sign = frames[frame[k]], arms[touch], signs[touch]
    for i in range(3):
        # The moment of shear beside the point is that at the point and a torque about the normal.
        torque = 0.0 if i == 0 else (-shift[k, 1] if i == 1 else shift[k, 0])
        for j in range(3):
            m, n = (j + 1) % 3, (j + 2) % 3
            out[i, j] = sign * axes[i, j]
            out[i, 3 + j] = sign * (arm[m] * axes[i, n] - arm[n] * axes[i, m] + torque * axes[0, j])


@numba.njit(cache=True)
def _fill(arrays: _Arrays, out: FloatArray) -> None:
    pointer = arrays[0]
    for k in range(len(pointer) - 1):
        for touch in range(pointer[k], pointer[k + 1]):
            _block(arrays, k, touch, out[touch])


@numba.njit(cache=True)
def _size(arrays: _Arrays, x: FloatArray, largest: FloatArray, passing: FloatArray) -> None:
    pointer, bodies = arrays[:2]
    block = np.empty((3, 6))
    for k in range(len(pointer) - 1):
        for touch in range(pointer[k], pointer[k + 1]):
            _block(arrays, k, touch, block)
            first = 6 * bodies[touch]
            for i in range(3):
                for j in range(6):
                    entry = abs(block[i, j])
                    largest[first + j] = max(largest[first + j], entry)
                    passing[first + j] += entry * x[k, i]


@numba.njit(cache=True, fastmath={"reassoc", "contract"})
def couple(arrays: _Arrays, x: FloatArray, out: FloatArray) -> None:
    """Add A x to out (6 count,); x (3 c,), component first."""
    pointer, bodies, arms, signs, frames, frame, shift = arrays
    count = len(pointer) - 1
    for k in range(count):
        axes = frames[frame[k]]
        n, u, v = x[k], x[count + k], x[2 * count + k]
        f0 = axes[0, 0] * n + axes[1, 0] * u + axes[2, 0] * v
        f1 = axes[0, 1] * n + axes[1, 1] * u + axes[2, 1] * v
        f2 = axes[0, 2] * n + axes[1, 2] * u + axes[2, 2] * v
        torque = shift[k, 0] * v - shift[k, 1] * u
        for touch in range(pointer[k], pointer[k + 1]):
            first, sign = 6 * bodies[touch], signs[touch]
            a0, a1, a2, turn = sign * arms[touch, 0], sign * arms[touch, 1], sign * arms[touch, 2], sign * torque
            out[first] += sign * f0
            out[first + 1] += sign * f1
            out[first + 2] += sign * f2
            out[first + 3] += a1 * f2 - a2 * f1 + turn * axes[0, 0]
            out[first + 4] += a2 * f0 - a0 * f2 + turn * axes[0, 1]
            out[first + 5] += a0 * f1 - a1 * f0 + turn * axes[0, 2]


@numba.njit(cache=True, fastmath={"reassoc", "contract"})
def spread(arrays: _Arrays, y: FloatArray, out: FloatArray) -> None:
    """Write A^T y to out (3 c,), component first."""
    pointer, bodies, arms, signs, frames, frame, shift = arrays
    count = len(pointer) - 1
    for k in range(count):
        v0 = v1 = v2 = w0 = w1 = w2 = 0.0
        for touch in range(pointer[k], pointer[k + 1]):
            first, sign = 6 * bodies[touch], signs[touch]
            a0, a1, a2 = arms[touch, 0], arms[touch, 1], arms[touch, 2]
            r0, r1, r2 = sign * y[first + 3], sign * y[first + 4], sign * y[first + 5]
            v0 += sign * y[first] + r1 * a2 - r2 * a1
            v1 += sign * y[first + 1] + r2 * a0 - r0 * a2
            v2 += sign * y[first + 2] + r0 * a1 - r1 * a0
            w0 += r0
            w1 += r1
            w2 += r2
        axes = frames[frame[k]]
        turn = axes[0, 0] * w0 + axes[0, 1] * w1 + axes[0, 2] * w2
        out[k] = axes[0, 0] * v0 + axes[0, 1] * v1 + axes[0, 2] * v2
        out[count + k] = axes[1, 0] * v0 + axes[1, 1] * v1 + axes[1, 2] * v2 - shift[k, 1] * turn
        out[2 * count + k] = axes[2, 0] * v0 + axes[2, 1] * v1 + axes[2, 2] * v2 + shift[k, 0] * turn
