"""Local problems given by dense matrices: the general case, as in a homogenised shell condensed to its stresses."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from churchpipe.conic.interior_point.cones import Cone, Scaling
from churchpipe.conic.interior_point.nonnegative import NonnegativeScaling
from churchpipe.conic.interior_point.second_order import SecondOrderScaling
from churchpipe.model.arrays import FloatArray


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
    Q + G^T D G must be positive definite for every positive diagonal D.
    """

    def __init__(
        self,
        quadratic: FloatArray,
        linear: FloatArray,
        matrix: FloatArray,
        right: FloatArray,
        cones: tuple[Cone, ...],
        inner: FloatArray,
    ) -> None:
        self.quadratic_matrix, self._matrix, self._inner = quadratic, matrix, inner
        self.linear, self.right, self.cones = linear, right.ravel(), cones
        self.dimension, self.count = linear.shape

    def quadratic(self, x: FloatArray) -> FloatArray:
        """Return Q x."""
        return np.einsum("ijk,jk->ik", self.quadratic_matrix, x)

    def apply(self, x: FloatArray) -> FloatArray:
        """Return G x."""
        return np.einsum("rik,ik->rk", self._matrix, x).ravel()

    def transpose(self, z: FloatArray) -> FloatArray:
        """Return G^T z."""
        return np.einsum("rik,rk->ik", self._matrix, z.reshape(-1, self.count))

    def compliance(self, scalings: Sequence[Scaling]) -> DenseCompliance:
        """Return (Q + G^T W^-2 G)^-1, each small matrix brought to a unit diagonal first."""
        # stiffness_kij
        stiffness = np.moveaxis(self.quadratic_matrix, 2, 0).copy()
        start = 0
        for cone, scaling in zip(self.cones, scalings, strict=True):
            block = self._matrix[start : start + cone.rows]
            start += cone.rows
            rows = np.moveaxis(_unscaled(block, scaling), 2, 0)
            stiffness += rows.transpose(0, 2, 1) @ rows
        scale = 1.0 / np.sqrt(np.einsum("kii->ki", stiffness))
        inverse = np.asarray(np.linalg.inv(stiffness * scale[:, :, None] * scale[:, None, :]), dtype=np.float64)
        symmetric = 0.5 * (inverse + np.swapaxes(inverse, 1, 2)) * scale[:, :, None] * scale[:, None, :]
        return DenseCompliance(np.ascontiguousarray(np.moveaxis(symmetric, 0, 2)))

    def balanced(self, _force: FloatArray, z: FloatArray) -> FloatArray:
        """Return z as it is: there are more rows than variables, and the next residual takes the rounding."""
        return z

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
