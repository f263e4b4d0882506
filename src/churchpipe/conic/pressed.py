"""Forces at the corners of a parallelogram whose material crushes, as second-order cones.

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

from churchpipe.model.arrays import FloatArray, IntArray

CORNERS = 4
# Further points of a joint, and its rows.
POINTS, ROWS = 5, 9
# The row whose sum is S, the others have none, and the further point in it.
UNIT_ROW, UNIT_POINT = 3, 2
# The rows of w = q / rho, N, p, S, N, u (amount and difference of the sides), v: the point, its component and the value. A point
# has (n, t_1, t_2); the product of cone 4 is n + t_2 and n - t_2, u and v, with t_1 = w; 5: 2 p and q, N; 6: S and N, p.
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
    *((row, corner, 0, 1.0) for row in (1, 4, 5, 7) for corner in range(CORNERS)),
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


class PressedJoints(NamedTuple):
    """Rows of joints for a cone program, corners (nj, 4) among its points and the further points after all of these.

    matrix (12 nj, 3 (points + 5 nj)): of every joint three rows are empty, so that its rows fill blocks of six; constant
    (12 nj,); rho (nj,); unit: S.
    """

    matrix: sp.csc_matrix[np.float64]
    constant: FloatArray
    corners: IntArray
    rho: FloatArray
    unit: float

    def further(self, normal: FloatArray) -> FloatArray:
        """Return forces (5 nj, 3) of the further points that fit normal forces of the points, if any do."""
        corner = normal[self.corners]
        whole = corner.sum(axis=1)
        first, second = corner[:, 0] + corner[:, 3], corner[:, 0] + corner[:, 1]
        u, v = np.minimum(first, whole - first), np.minimum(second, whole - second)
        w, p = np.sqrt(np.maximum(u * v, 0.0)), np.sqrt(self.unit * np.maximum(whole, 0.0))
        q, zero = self.rho * w, np.zeros_like(w)
        points = (
            ((u + v) / 2, w, (u - v) / 2),
            (p + q / 2, whole, p - q / 2),
            ((self.unit + whole) / 2, p, (self.unit - whole) / 2),
            (whole - 2 * u, 2 * first - whole, zero),
            (whole - 2 * v, 2 * second - whole, zero),
        )
        return np.stack([np.stack(point, axis=1) for point in points], axis=1).reshape(-1, 3)


def pressed_joints(corners: IntArray, capacity: FloatArray, unit: float, points: int) -> PressedJoints:
    """Return joints with these corners (nj, 4) in order, among `points` points, and these F (nj,); unit: S."""
    count, height = len(corners), ROWS + 3
    joint, rho = np.arange(count), np.sqrt(capacity / unit)
    column = np.concatenate([corners, points + POINTS * joint[:, None] + np.arange(POINTS)], axis=1)
    values = pressed_rows(rho)
    j, point, component, row = np.nonzero(values)
    matrix = sp.csc_matrix(
        (values[j, point, component, row], (height * j + row, 3 * column[j, point] + component)),
        shape=(height * count, 3 * (points + POINTS * count)),
    )
    constant = np.zeros(height * count)
    constant[height * joint + UNIT_ROW] = -unit
    return PressedJoints(matrix, constant, corners, rho, unit)
