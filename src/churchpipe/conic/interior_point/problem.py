"""The problem that the interior-point loop solves: local problems, coupled by rows and one multiplier of a load."""

import numpy as np

from churchpipe.conic.interior_point.cones import ProductCone
from churchpipe.conic.interior_point.coupling import Coupling
from churchpipe.conic.interior_point.local import LocalProblems
from churchpipe.conic.interior_point.nonnegative import Nonnegative
from churchpipe.model.arrays import FloatArray

# The unit of a row is at least this share of the forces in it. Smaller residuals are rounding.
_PASSING = 1e-6


class CoupledProblem:
    """minimise    sum_k (1/2 x_k Q_k x_k + linear_k x_k) - reward load
    subject to  coupling x + constant + load growth = 0,   G_k x_k + s_k = right_k,  s_k in cones,   load <= cap

    A local problem k is one contact point of the stones or one facet of a shell. x_k are its forces, Q_k and linear_k what these
    cost, G_k and right_k its strength, s_k what is left of that. The coupling rows balance the bodies: `constant` is the dead
    load, `growth` the live load and `load` its factor. Multipliers are y of the coupling rows and z of the strength.

    x is flat, component first: x[i * count + k]. The cap, when finite, is the last row of s and z.
    """

    def __init__(
        self,
        local: LocalProblems,
        coupling: Coupling,
        constant: FloatArray,
        growth: FloatArray,
        *,
        reward: float = 1.0,
        cap: float = np.inf,
        row_unit: FloatArray | None = None,
    ) -> None:
        """row_unit (m,): what a residual of each coupling row is measured by, 1 if not given."""
        self.local = local
        self.coupling = coupling
        self.constant, self.growth, self.reward, self.cap = constant, growth, reward, cap
        self._row_unit = np.ones(len(constant)) if row_unit is None else row_unit
        self._light, self._heavy = coupling.touched_units(self._row_unit)
        self.capped = bool(np.isfinite(cap))
        self.linear = local.linear.ravel()
        self.cone = ProductCone([*local.cones, Nonnegative(1, 1)] if self.capped else local.cones)
        self.right = np.append(local.right, cap) if self.capped else local.right

    @property
    def rows(self) -> int:
        """Number of coupling rows."""
        return len(self.constant)

    def imbalance(self, rows: FloatArray) -> float:
        """Return the largest of these residuals of the coupling rows, each in its own unit."""
        return largest(rows / self._row_unit)

    def rounded_imbalance(self, rows: FloatArray, x: FloatArray) -> float:
        """Return the same, in units of at least a millionth of the forces x that act on each body.

        A very light body under a heavy one cannot be balanced more exactly than that.
        """
        return largest(rows / np.maximum(self._row_unit, _PASSING * self.coupling.passing(x)))

    def couple(self, x: FloatArray) -> FloatArray:
        """Return coupling x."""
        return self.coupling.couple(x)

    def spread(self, y: FloatArray) -> FloatArray:
        """Return coupling^T y."""
        return self.coupling.spread(y)

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

    def interior(self, size: float, *, heavy: bool = False) -> FloatArray:
        """Return x inside all local cones, of about this size in the least unit that each touches, or `heavy`, the largest."""
        return self.local.interior(size * (self._heavy if heavy else self._light)).ravel()


def largest(v: FloatArray) -> float:
    """Return max |v|, 0 for nothing."""
    return float(np.abs(v).max(initial=0.0))
