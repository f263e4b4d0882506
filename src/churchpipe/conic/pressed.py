"""Forces on a parallelogram whose material crushes, as second-order cones: Meyerhof's part of it, and a better one.

Pressure of at most f on a part of the joint of area A has the resultant N at some point. Meyerhof's part is the parallelogram
that is centred on that point: with the forces n_0 .. n_3 at the corners in order, F = f A, and as little as

    u = min(n_0 + n_3, n_1 + n_2),   v = min(n_0 + n_1, n_2 + n_3)

on either side, its share of the area is (2 u / N) (2 v / N), so that N^3 <= 4 F u v. For bending about one side this is the exact
strength; for bending about both it is below it, because the best part is then cut off by a slanting line.

Three cones say the same: w^2 <= u v, p^2 <= S N and N^2 <= 2 p q, with q = rho w and rho^2 = F / S. S is any unit of force; in
this form only rho knows the strength. Two more hold u and v: |n_0 + n_3 - n_1 - n_2| <= N - 2 u, and so with v.

All of these are cones |(t_1, t_2)| <= n like those of friction of 1. So a joint gets five more points, and nine rows that tie
them to its corners.
"""

from typing import NamedTuple

import numpy as np
import scipy.sparse as sp

from churchpipe.conic.wrenches import Balance, as_matrix
from churchpipe.model.arrays import FloatArray, IntArray

CORNERS = 4
# Further points of a joint, and its rows.
POINTS, ROWS = 5, 9
# The row whose sum is S, the others have none, and the further point in it.
UNIT_ROW, UNIT_POINT = 3, 2
# The rows of w = q / rho, N, p, S, N, u (amount and difference of the sides), v: the point, its component and the value. A point
# has (n, t_1, t_2); the product of cone 4 is n + t_2 and n - t_2, u and v, with t_1 = w; 5: 2 p and q, N; 6: S and N, p.
# Normal forces are summed in _SUMS; in _SIDES the corners count with the sign of their side.
_SUMS = (1, 4, 5, 7)
_SIDES = ((6, (1.0, -1.0, -1.0, 1.0)), (8, (1.0, 1.0, -1.0, -1.0)))
_ENTRIES = (
    (0, 4, 1, 1.0),
    (1, 5, 1, -1.0),
    (2, 6, 1, 1.0),
    (2, 5, 0, -0.5),
    (2, 5, 2, -0.5),
    (3, 6, 0, 1.0),
    (3, 6, 2, 1.0),
    (4, 6, 0, -1.0),
    (4, 6, 2, 1.0),
    (5, 7, 0, -1.0),
    (5, 4, 0, -2.0),
    (5, 4, 2, -2.0),
    (6, 7, 1, -1.0),
    (7, 8, 0, -1.0),
    (7, 4, 0, -2.0),
    (7, 4, 2, 2.0),
    (8, 8, 1, -1.0),
    *((row, corner, 0, 1.0) for row in _SUMS for corner in range(CORNERS)),
    *((row, corner, 0, sign) for row, signs in _SIDES for corner, sign in enumerate(signs)),
)
# The same of q in the row of w, times 1 / rho.
_OF_STRENGTH = ((0, 5, 0, -1.0), (0, 5, 2, 1.0))


def pressed_rows(rho: FloatArray) -> FloatArray:
    """Return the rows (nj, 9 points, 3, 9 rows) of joints with these rho (nj,): corners first, then the further points.

    The sum of a row over all forces (n, t1, t2) is zero, but that of `UNIT_ROW`, which is S.
    """
    out = np.zeros((len(rho), CORNERS + POINTS, 3, ROWS))
    for row, point, component, value in _ENTRIES:
        out[:, point, component, row] = value
    for row, point, component, value in _OF_STRENGTH:
        out[:, point, component, row] = value / rho
    return out


def pressed_closing(closing: FloatArray, rho: FloatArray) -> FloatArray:
    """Return coefficients (corners + 5 nj, 3, sums + 9 nj) of the sums of a cell (corners, 3, sums) whose joints (nj,) crush.

    The corners of each joint stand one after the other. Its further points follow all corners, and its rows all sums, joint by
    joint.
    """
    corners, _, width = closing.shape
    count = len(rho)
    out = np.zeros((corners + POINTS * count, 3, width + ROWS * count))
    out[:corners, :, :width] = closing
    for joint, rows in enumerate(pressed_rows(rho)):
        columns = slice(width + ROWS * joint, width + ROWS * (joint + 1))
        out[CORNERS * joint : CORNERS * (joint + 1), :, columns] = rows[:CORNERS]
        out[corners + POINTS * joint : corners + POINTS * (joint + 1), :, columns] = rows[CORNERS:]
    return out


# Cones and rows of `PressedJoints`, as _ENTRIES: points 4 to 8 and rows 0 to 8 are those of Meyerhof's part. Cones 9 and 11 are r
# and (N, sqrt(3) Y or X), 10 and 12: 2 u or 2 v and S, r / rho.
_SMOOTH_POINTS, _HEIGHT = 9, 24
_SMOOTH_UNITS = (UNIT_ROW, 13, 18)
_SMOOTH_ENTRIES = tuple(
    entry
    for line, sign, row in ((9, 1.0, 9), (11, -1.0, 14))
    for entry in (
        (row, line, 1, -1.0),
        (row + 1, line, 2, -1.0),
        (row + 2, line + 1, 0, 1.0),
        (row + 2, line + 1, 2, 1.0),
        (row + 2, 4, 0, -2.0),
        (row + 2, 4, 2, -2.0 * sign),
        (row + 3, line + 1, 1, 1.0),
        (row + 4, line + 1, 0, 1.0),
        (row + 4, line + 1, 2, -1.0),
    )
)
# The same times 1 / rho.
_SMOOTH_STRENGTH = ((12, 9, 0, -1.0), (17, 11, 0, -1.0))
# A pressed triangle bears 9 / 8 of Meyerhof's part of it.
_TRIANGLE = 9 / 8


class PressedJoints(NamedTuple):
    """Rows of joints for a cone program whose material crushes in a part that a straight line cuts off, the further points last.

    With N, X and Y the sums of the normal forces, and of their moments about the middle lines over half the sides, a joint bears

        N^2 + 3 Y^2 <= F (N - |X|),   N^2 + 3 X^2 <= F (N - |Y|),   N^3 <= 9/8 F (N - |X|) (N - |Y|)

    The first two are exact where the line crosses two opposite sides, the third where it cuts off a triangle; where it leaves a
    triangle out, a joint bears up to .7 % less. Meyerhof's part is too small under an eccentricity in two directions, and has an
    edge at zero eccentricity, at which a joint that turns about one side might tilt about the other as well.

    matrix (24 nj, 3 (points + 9 nj)): of every joint some rows are empty, so that its rows fill blocks of six; constant
    (24 nj,); point (np,): which points bear on these joints, joint (np,) on which, place (np, 2) where, from -1 to 1 along
    either side; rho (nj,), rho^2 = F / S; unit: S.
    """

    matrix: sp.csc_matrix[np.float64]
    constant: FloatArray
    point: IntArray
    joint: IntArray
    place: FloatArray
    rho: FloatArray
    unit: float

    def further(self, normal: FloatArray) -> FloatArray:
        """Return forces (9 nj, 3) of the further points that fit normal forces of the points, if any do."""
        force, count = normal[self.point], len(self.rho)
        whole = np.bincount(self.joint, force, minlength=count)
        x, y = (np.bincount(self.joint, force * side, minlength=count) for side in self.place.T)
        u, v = 0.5 * (whole - np.abs(x)), 0.5 * (whole - np.abs(y))
        w, p = np.sqrt(np.maximum(u * v, 0.0)), np.sqrt(self.unit * np.maximum(whole, 0.0))
        q, zero = np.sqrt(_TRIANGLE) * self.rho * w, np.zeros_like(w)
        across, along = np.sqrt(3.0) * y, np.sqrt(3.0) * x
        points = (
            (u + v, 2 * w, u - v),
            (p + q, 2 * whole, p - q),
            (self.unit + whole, 2 * p, self.unit - whole),
            (2 * (whole - 2 * u), 2 * x, zero),
            (2 * (whole - 2 * v), 2 * y, zero),
            (2 * np.hypot(whole, across), 2 * whole, 2 * across),
            (2 * u + self.unit, 2 * np.hypot(whole, across) / self.rho, 2 * u - self.unit),
            (2 * np.hypot(whole, along), 2 * whole, 2 * along),
            (2 * v + self.unit, 2 * np.hypot(whole, along) / self.rho, 2 * v - self.unit),
        )
        return np.asarray(0.5 * np.stack([np.stack(point, axis=1) for point in points], axis=1).reshape(-1, 3), dtype=np.float64)

    def below(self, balance: Balance) -> sp.csc_matrix[np.float64]:
        """Return a balance of the points with the rows of these joints below it, and their further points beside it."""
        rows, columns = balance.shape
        nothing = sp.csc_matrix((rows, self.matrix.shape[1] - columns))
        return sp.csc_matrix(sp.vstack([sp.hstack([as_matrix(balance), nothing]), self.matrix]))


def pressed_joints(
    point: IntArray, joint: IntArray, place: FloatArray, capacity: FloatArray, unit: float, points: int
) -> PressedJoints:
    """Return joints (nj,) that crush, with these F (nj,), and the points (np,), numbers below `points`, that bear on them."""
    number, rho = np.arange(len(capacity)), np.sqrt(capacity / unit)
    same = np.ones_like(rho)
    of_triangle = 1.0 / (np.sqrt(_TRIANGLE) * rho)
    entries = [
        *((entry, same) for entry in (*_ENTRIES, *_SMOOTH_ENTRIES) if entry[1] >= CORNERS),
        *((entry, of_triangle) for entry in _OF_STRENGTH),
        *((entry, 1.0 / rho) for entry in _SMOOTH_STRENGTH),
    ]
    x, y = place.T
    every = np.ones_like(x)
    sums = [*((row, every) for row in (*_SUMS, 9, 14)), (6, x), (8, y), (10, np.sqrt(3.0) * y), (15, np.sqrt(3.0) * x)]
    further = points - CORNERS + _SMOOTH_POINTS * number
    row = [_HEIGHT * number + entry[0] for entry, _ in entries] + [_HEIGHT * joint + row for row, _ in sums]
    column = [3 * (further + entry[1]) + entry[2] for entry, _ in entries] + [3 * point for _ in sums]
    value = [entry[3] * size for entry, size in entries] + [share for _, share in sums]
    size = len(capacity)
    matrix = sp.csc_matrix(
        (np.concatenate(value), (np.concatenate(row), np.concatenate(column))),
        shape=(_HEIGHT * size, 3 * (points + _SMOOTH_POINTS * size)),
    )
    constant = np.zeros((size, _HEIGHT))
    constant[:, _SMOOTH_UNITS] = -unit
    return PressedJoints(matrix, constant.ravel(), point, joint, place, rho, unit)
