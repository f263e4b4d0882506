"""Coupling of forces on rigid bodies. Products use axes and arms, which are a fifth of the numbers in the matrix itself."""

import numpy as np

from churchpipe.conic.interior_point.coupling import Coupling, Touches
from churchpipe.conic.wrenches import Wrenches, couple, spread
from churchpipe.model.arrays import BoolArray, FloatArray


class WrenchCoupling(Coupling):
    """A coupling whose local problems are points and whose blocks of rows are rigid bodies."""

    def __init__(self, wrenches: Wrenches) -> None:
        super().__init__(Touches(wrenches.shape[0], wrenches.pointer, wrenches.bodies, wrenches.blocks()))
        self._arrays = wrenches.arrays

    def couple(self, x: FloatArray) -> FloatArray:
        """Return B x."""
        out = np.zeros(self.rows)
        couple(self._arrays, x, out)
        return out

    def spread(self, y: FloatArray) -> FloatArray:
        """Return B^T y."""
        out = np.empty(self.dimension * self.count)
        spread(self._arrays, y, out)
        return out

    def masked(self, active: BoolArray) -> Coupling:
        """Return the coupling without the columns that are not active (dimension, count)."""
        return self if active.all() else _MaskedWrenches(self, active)


class _MaskedWrenches(Coupling):
    """Wrenches of which some columns are not there: their forces are zero."""

    def __init__(self, whole: WrenchCoupling, active: BoolArray) -> None:
        part = Coupling.masked(whole, active)
        super().__init__(Touches(part.rows, part.pointer, part.blocks, part.values))
        self._whole, self._active = whole, active.ravel()

    def couple(self, x: FloatArray) -> FloatArray:
        """Return B x."""
        return self._whole.couple(x * self._active)

    def spread(self, y: FloatArray) -> FloatArray:
        """Return B^T y."""
        return self._whole.spread(y) * self._active
