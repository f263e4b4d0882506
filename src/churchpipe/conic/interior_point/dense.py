"""Local problems given by dense matrices: the general case, as in a homogenised shell condensed to its stresses."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from churchpipe.conic.interior_point.cones import Cone, Scaling
from churchpipe.conic.interior_point.local import Compliance
from churchpipe.conic.interior_point.nonnegative import NonnegativeScaling
from churchpipe.conic.interior_point.second_order import SecondOrderScaling
from churchpipe.model.arrays import FloatArray

# Local problems treated together, so that they stay in the cache.
_CHUNK = 2048


@dataclass(frozen=True, slots=True)
class DenseCompliance:
    """Compliances as full matrices S_ijk (d, d, count)."""

    matrix: FloatArray

    def apply(self, force: FloatArray) -> FloatArray:
        """Return S force."""
        return np.einsum("ijk,jk->ik", self.matrix, force)


class DenseProblems:
    """quadratic_ijk (d, d, count) positive semidefinite; linear (d, count); matrix_rik (rows, d, count); right (rows, count).

    The cones take the rows in order (second-order cones: component first); inner (d, count) is an interior point.
    proximal (count,) or (d, count), if given, is added to the diagonal of Q in the steps alone. With it Q + G^T D G must be
    positive definite for every positive diagonal D.
    """

    def __init__(
        self,
        quadratic: FloatArray,
        linear: FloatArray,
        matrix: FloatArray,
        right: FloatArray,
        cones: tuple[Cone, ...],
        inner: FloatArray,
        proximal: FloatArray | None = None,
    ) -> None:
        self.quadratic_matrix, self._matrix, self._inner = quadratic, matrix, inner
        self.linear, self.right, self.cones = linear, right.ravel(), cones
        self.dimension, self.count = linear.shape
        self.curved = bool(quadratic.any())
        self._root = _root(quadratic if proximal is None else quadratic + np.eye(self.dimension)[:, :, None] * proximal)

    def quadratic(self, x: FloatArray) -> FloatArray:
        """Return Q x."""
        return np.einsum("ijk,jk->ik", self.quadratic_matrix, x) if self.curved else np.zeros_like(x)

    def apply(self, x: FloatArray) -> FloatArray:
        """Return G x."""
        return np.einsum("rik,ik->rk", self._matrix, x).ravel()

    def transpose(self, z: FloatArray) -> FloatArray:
        """Return G^T z."""
        return np.einsum("rik,rk->ik", self._matrix, z.reshape(-1, self.count))

    def compliance(self, scalings: Sequence[Scaling]) -> Compliance:
        """Return (Q + G^T W^-2 G)^-1, each small matrix brought to a unit diagonal first."""
        # Rows of a matrix whose square is the stiffness: its small eigenvalues, far below the largest, keep their digits.
        parts = [self._root]
        start = 0
        for cone, scaling in zip(self.cones, scalings, strict=True):
            parts.append(_unscaled(self._matrix[start : start + cone.rows], scaling))
            start += cone.rows
        out = np.empty((self.dimension, self.dimension, self.count))
        for first in range(0, self.count, _CHUNK):
            piece = np.concatenate([part[:, :, first : first + _CHUNK] for part in parts])
            out[:, :, first : first + _CHUNK] = _inverse_square(piece)
        return DenseCompliance(out)

    def balanced(self, _force: FloatArray, rough: Callable[[], FloatArray]) -> FloatArray:
        """Return z as it is: there are more rows than variables, and the next residual takes the rounding."""
        return rough()

    def interior(self, _size: FloatArray) -> FloatArray:
        """Return the given interior point, whatever the size."""
        return self._inner


def _unscaled(block: FloatArray, scaling: Scaling) -> FloatArray:
    """Return W^-1 G for the rows (rows, d, count) of one kind of cone."""
    if isinstance(scaling, NonnegativeScaling):
        return block / scaling.factor[:, None, :]
    dimension, copies, count = scaling.w.shape
    # v_rcik: row r of cone copy c, variable i, problem k.
    v = block.reshape(dimension, copies, -1, count)
    eta = np.ascontiguousarray(np.broadcast_to(scaling.eta[:, None, :], v.shape[1:]))
    w = np.ascontiguousarray(np.broadcast_to(scaling.w[:, :, None, :], v.shape))
    return SecondOrderScaling(eta, w, w).solve(np.ascontiguousarray(v)).reshape(block.shape)


def _root(quadratic: FloatArray) -> FloatArray:
    """Return R_rik (rows, d, count) with R^T R = Q, without the rows that vanish in all problems."""
    values, vectors = np.linalg.eigh(np.moveaxis(quadratic, 2, 0))
    root = np.moveaxis(np.sqrt(np.maximum(values, 0.0))[:, :, None] * np.swapaxes(vectors, 1, 2), 0, 2)
    return np.ascontiguousarray(root[np.abs(root).max(axis=(1, 2)) > 0])


def _inverse_square(rows: FloatArray) -> FloatArray:
    """Return (A^T A)^-1 (d, d, count) of A_rik (r, d, count), r >= d, by Householder's triangle; A is overwritten.

    Large rows first, as rows of very different size call for.
    """
    order = np.argsort(-(rows**2).sum(axis=1), axis=0)
    a = np.take_along_axis(rows, order[:, None, :], axis=0)
    d = a.shape[1]
    for j in range(d):
        v = a[j:, j].copy()
        length = -np.copysign(np.sqrt((v**2).sum(axis=0)), v[0])
        v[0] -= length
        rest = a[j:, j + 1 :]
        rest -= v[:, None] * (2.0 / (v**2).sum(axis=0) * (v[:, None] * rest).sum(axis=0))
        a[j, j] = length
    # Inverse of the triangle, from the last row up.
    inverse = np.zeros((d, d, a.shape[2]))
    for i in range(d - 1, -1, -1):
        inverse[i, i] = 1.0 / a[i, i]
        if i + 1 < d:
            inverse[i, i + 1 :] = -inverse[i, i] * (a[i, i + 1 : d, None] * inverse[i + 1 :, i + 1 :]).sum(axis=0)
    return np.einsum("ijk,ljk->ilk", inverse, inverse)
