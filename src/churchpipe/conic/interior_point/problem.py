"""The problem that the interior-point loop solves: local problems, coupled by rows and one multiplier of a load."""

import numpy as np
import scipy.sparse as sp

from churchpipe.conic.interior_point.cones import ProductCone
from churchpipe.conic.interior_point.local import LocalProblems
from churchpipe.conic.interior_point.nonnegative import Nonnegative
from churchpipe.model.arrays import FloatArray


class CoupledProblem:
    """minimise    sum_k (1/2 x_k Q_k x_k + linear_k x_k) - reward load
    subject to  coupling x + constant + load growth = 0,   G_k x_k + s_k = right_k,  s_k in cones,   load <= cap

    x is flat, component first: x[i * count + k]; coupling (m, dimension * count) has its columns in that order. The cap, when
    finite, is the last row of s and z.
    """

    def __init__(
        self,
        local: LocalProblems,
        coupling: sp.csr_matrix[np.float64],
        constant: FloatArray,
        growth: FloatArray,
        *,
        reward: float = 1.0,
        cap: float = np.inf,
    ) -> None:
        self.local = local
        self.coupling = coupling
        self.constant, self.growth, self.reward, self.cap = constant, growth, reward, cap
        self.capped = bool(np.isfinite(cap))
        # Both directions by rows: products that scatter cost three times as much.
        self._transposed = sp.csr_matrix(coupling.T)
        self.linear = local.linear.ravel()
        self.cone = ProductCone([*local.cones, Nonnegative(1, 1)] if self.capped else local.cones)
        self.right = np.append(local.right, cap) if self.capped else local.right

    @property
    def rows(self) -> int:
        """Number of coupling rows."""
        return len(self.constant)

    def couple(self, x: FloatArray) -> FloatArray:
        """Return coupling x."""
        return np.asarray(self.coupling @ x)

    def spread(self, y: FloatArray) -> FloatArray:
        """Return coupling^T y."""
        return np.asarray(self._transposed @ y)

    def local_view(self, x: FloatArray) -> FloatArray:
        """Return x as (dimension, count)."""
        return x.reshape(self.local.dimension, self.local.count)

    def quadratic(self, x: FloatArray) -> FloatArray:
        """Return Q x."""
        return self.local.quadratic(self.local_view(x)).ravel()

    def constrain(self, x: FloatArray, load: float) -> FloatArray:
        """Return G x, and the load in the row of its cap."""
        rows = self.local.apply(self.local_view(x))
        return np.append(rows, load) if self.capped else rows

    def transpose(self, z: FloatArray) -> FloatArray:
        """Return G^T z, without the cap."""
        return self.local.transpose(z[: len(self.local.right)]).ravel()

    def interior(self, size: float) -> FloatArray:
        """Return x inside all local cones, of about this size."""
        return self.local.interior(size).ravel()
