"""Points of a shell whose strength is bounded by planes, as local problems of the interior-point solver.

The compliance of a point is kept as a triangular factor, so that no digits are lost near the solution.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numba
import numpy as np

from churchpipe.conic.interior_point.cones import Scaling
from churchpipe.conic.interior_point.nonnegative import Nonnegative, NonnegativeScaling
from churchpipe.homogenised_shell.energy import Energy
from churchpipe.homogenised_shell.points import PlaneStrength
from churchpipe.homogenised_shell.settings import SOLVER
from churchpipe.model.arrays import FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class PlaneCompliance:
    """Compliances S = (A^T A)^-1 of the points. A has the rows of the root of Q and of W^-1 G.

    Q is the elastic energy, G the planes and W their scaling. The factorisation A P = O R has columns in the order P,
    orthonormal columns O and a triangle R. triangle_kij: R (count, d, d). column (count, d): the order P. rows_kri: W^-1 times
    the part of O that belongs to the planes (count, planes, d).

    Why a factor: along planes that flow S is up to 1e20 times larger than across them. In S as a matrix the rounding errors of
    the large entries would spoil the small ones; with R they stay in the direction where they arise.
    """

    triangle: FloatArray
    column: IntArray
    rows: FloatArray

    @property
    def matrix(self) -> FloatArray:
        """S_ijk, (d, d, count)."""
        count, d = self.column.shape
        out = np.empty((d, d, count))
        _square(self.triangle, self.column, out)
        return out

    def apply(self, force: FloatArray) -> FloatArray:
        """Return S force."""
        out = np.empty_like(force)
        _comply(self.triangle, self.column, force, out)
        return out


class PlanePoints:
    """Local problems whose rows are all planes: `LocalProblems` of the interior-point solver.

    quadratic_ijk (d, d, count): Q, positive semidefinite; linear (d, count); matrix_rik (rows, d, count): G; right (rows, count).
    inner (d, count) is an interior point. proximal (count,) is added to the diagonal of Q in the steps alone. With it
    Q + G^T D G must be positive definite for every positive diagonal D.
    """

    def __init__(
        self,
        quadratic: FloatArray,
        linear: FloatArray,
        matrix: FloatArray,
        right: FloatArray,
        inner: FloatArray,
        proximal: FloatArray,
    ) -> None:
        self.quadratic_matrix, self._matrix, self._inner = quadratic, matrix, inner
        self.linear, self.right, self.cones = linear, right.ravel(), (Nonnegative(len(right), linear.shape[1]),)
        self.dimension, self.count = linear.shape
        self.curved = bool(quadratic.any())
        self._root = _root(quadratic + np.eye(self.dimension)[:, :, None] * proximal)
        self._last: PlaneCompliance | None = None

    def quadratic(self, x: FloatArray) -> FloatArray:
        """Return Q x."""
        return np.einsum("ijk,jk->ik", self.quadratic_matrix, x) if self.curved else np.zeros_like(x)

    def apply(self, x: FloatArray) -> FloatArray:
        """Return G x."""
        return np.einsum("rik,ik->rk", self._matrix, x).ravel()

    def transpose(self, z: FloatArray) -> FloatArray:
        """Return G^T z."""
        return np.einsum("rik,rk->ik", self._matrix, z.reshape(-1, self.count))

    def interior(self, _size: FloatArray) -> FloatArray:
        """Return the given interior point, whatever the size."""
        return self._inner

    def compliance(self, scalings: Sequence[Scaling]) -> PlaneCompliance:
        """Return (Q + proximal + G^T W^-2 G)^-1."""
        (scaling,) = scalings
        assert isinstance(scaling, NonnegativeScaling)
        d, count = self.dimension, self.count
        out = PlaneCompliance(
            np.zeros((count, d, d)), np.empty((count, d), dtype=np.int64), np.empty((count, len(self._matrix), d))
        )
        _factor(self._root, self._matrix, scaling.factor, out.triangle, out.column, out.rows)
        self._last = out
        return out

    def balanced(self, force: FloatArray, rough: Callable[[], FloatArray]) -> FloatArray:
        """Return `rough`, corrected so that G^T z = force; the correction is the smallest in the metric of the last scaling."""
        z = rough()
        if self._last is None:
            return z
        lack = force - self.transpose(z)
        more = np.empty((len(self._matrix), self.count))
        _push(self._last.triangle, self._last.column, self._last.rows, lack, more)
        return z + more.ravel()


def plane_points(law: PlaneStrength, energy: Energy | None, proximal: FloatArray, start: FloatArray | None) -> PlanePoints:
    """Return the local problems of points whose strength is bounded by planes, with their elastic energy in a step.

    start (6 nq,): stresses near which the solver begins.
    """
    nq = law.matrix.shape[2]
    inner = np.zeros((6, nq)) if start is None else start.reshape(6, nq).copy()
    inner[:2] -= 1.0 if start is None else SOLVER.start_margin
    quadratic, linear = (np.zeros((6, 6, nq)), np.zeros((6, nq))) if energy is None else (energy.compliance, energy.linear)
    return PlanePoints(quadratic, linear, law.matrix, law.right, inner, proximal)


def _root(quadratic: FloatArray) -> FloatArray:
    """Return R_rik (rows, d, count) with R^T R = Q, without the rows that vanish in all problems."""
    values, vectors = np.linalg.eigh(np.moveaxis(quadratic, 2, 0))
    root = np.moveaxis(np.sqrt(np.maximum(values, 0.0))[:, :, None] * np.swapaxes(vectors, 1, 2), 0, 2)
    return np.ascontiguousarray(root[np.abs(root).max(axis=(1, 2)) > 0])


@numba.njit(cache=True, error_model="numpy")
def _factor(
    root: FloatArray, matrix: FloatArray, factor: FloatArray, triangle: FloatArray, column: IntArray, rows: FloatArray
) -> None:
    """Factorise by Householder reflections. The largest rows and columns come first, so that small rows keep their digits."""
    elastic, planes, d = root.shape[0], matrix.shape[0], matrix.shape[1]
    total = elastic + planes
    a, size, order = np.empty((total, d)), np.empty(total), np.empty(total, dtype=np.int64)
    scale = np.empty(d)
    wide = np.empty((total, d))
    for k in range(matrix.shape[2]):
        for r in range(total):
            square = 0.0
            for i in range(d):
                value = root[r, i, k] if r < elastic else matrix[r - elastic, i, k] / factor[r - elastic, k]
                wide[r, i] = value
                square = max(square, abs(value))
            place = r
            while place > 0 and size[place - 1] < square:
                size[place], order[place] = size[place - 1], order[place - 1]
                place -= 1
            size[place], order[place] = square, r
        for r in range(total):
            for i in range(d):
                a[r, i] = wide[order[r], i]
        for i in range(d):
            column[k, i] = i
        for j in range(d):
            best, longest = j, -1.0
            for i in range(j, d):
                square = 0.0
                for r in range(j, total):
                    square += a[r, i] * a[r, i]
                if square > longest:
                    best, longest = i, square
            if best != j:
                column[k, j], column[k, best] = column[k, best], column[k, j]
                for r in range(total):
                    a[r, j], a[r, best] = a[r, best], a[r, j]
            length = -np.sqrt(longest) if a[j, j] > 0 else np.sqrt(longest)
            a[j, j] -= length
            square = 0.0
            for r in range(j, total):
                square += a[r, j] * a[r, j]
            scale[j] = 2.0 / square if square > 0 else 0.0
            for i in range(j + 1, d):
                along = 0.0
                for r in range(j, total):
                    along += a[r, j] * a[r, i]
                along *= scale[j]
                for r in range(j, total):
                    a[r, i] -= along * a[r, j]
            triangle[k, j, j] = length
            for i in range(j):
                triangle[k, i, j] = a[i, j]
        # The orthonormal columns: reflections of the unit vectors, the last first.
        for j in range(d):
            for r in range(total):
                wide[r, j] = 1.0 if r == j else 0.0
            for i in range(j, -1, -1):
                along = 0.0
                for r in range(i, total):
                    along += a[r, i] * wide[r, j]
                along *= scale[i]
                for r in range(i, total):
                    wide[r, j] -= along * a[r, i]
        for r in range(total):
            row = order[r] - elastic
            if row >= 0:
                for j in range(d):
                    rows[k, row, j] = wide[r, j] / factor[row, k]


@numba.njit(cache=True, error_model="numpy")
def _square(triangle: FloatArray, column: IntArray, out: FloatArray) -> None:
    d = column.shape[1]
    inverse = np.zeros((d, d))
    for k in range(len(column)):
        for i in range(d - 1, -1, -1):
            inverse[i, i] = 1.0 / triangle[k, i, i]
            for j in range(i + 1, d):
                value = 0.0
                for m in range(i + 1, j + 1):
                    value += triangle[k, i, m] * inverse[m, j]
                inverse[i, j] = -value * inverse[i, i]
        for i in range(d):
            for j in range(i + 1):
                value = 0.0
                for m in range(i, d):
                    value += inverse[i, m] * inverse[j, m]
                out[column[k, i], column[k, j], k] = value
                out[column[k, j], column[k, i], k] = value


@numba.njit(cache=True, error_model="numpy", inline="always")
def _forward(triangle: FloatArray, column: IntArray, force: FloatArray, k: int, u: FloatArray) -> None:
    """Solve R^T u = P^T force."""
    for i in range(len(u)):
        value = force[column[k, i], k]
        for m in range(i):
            value -= triangle[k, m, i] * u[m]
        u[i] = value / triangle[k, i, i]


@numba.njit(cache=True, error_model="numpy")
def _comply(triangle: FloatArray, column: IntArray, force: FloatArray, out: FloatArray) -> None:
    d = column.shape[1]
    u = np.empty(d)
    for k in range(len(column)):
        _forward(triangle, column, force, k, u)
        for i in range(d - 1, -1, -1):
            value = u[i]
            for m in range(i + 1, d):
                value -= triangle[k, i, m] * u[m]
            u[i] = value / triangle[k, i, i]
            out[column[k, i], k] = u[i]


@numba.njit(cache=True, error_model="numpy")
def _push(triangle: FloatArray, column: IntArray, rows: FloatArray, force: FloatArray, out: FloatArray) -> None:
    u = np.empty(column.shape[1])
    for k in range(len(column)):
        _forward(triangle, column, force, k, u)
        for r in range(rows.shape[1]):
            value = 0.0
            for i in range(len(u)):
                value += rows[k, r, i] * u[i]
            out[r, k] = value
