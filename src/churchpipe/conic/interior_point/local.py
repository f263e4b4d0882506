"""The interface of the local problems of the interior-point loop, which are coupled only by the coupling rows."""

from collections.abc import Callable, Sequence
from typing import Protocol

from churchpipe.conic.interior_point.cones import Cone, Scaling
from churchpipe.model.arrays import FloatArray


class Compliance(Protocol):
    """S_k = (Q_k + G_k^T W_k^-2 G_k)^-1 of every local problem."""

    @property
    def matrix(self) -> FloatArray:
        """S_ijk, (dimension, dimension, count)."""
        ...

    def apply(self, force: FloatArray) -> FloatArray:
        """Return S force, (dimension, count), with errors along the soft directions of each cone only."""
        ...


class LocalProblems(Protocol):
    """`count` problems in `dimension` variables: min 1/2 x Q x + linear x,  G x + s = right,  s in `cones`.

    x, linear are component first, (dimension, count); s, z, right are flat, in the order of the cones.
    """

    @property
    def dimension(self) -> int:
        """Variables of one local problem."""
        ...

    @property
    def count(self) -> int:
        """Number of local problems."""
        ...

    @property
    def cones(self) -> tuple[Cone, ...]:
        """Cones of all local problems, side by side."""
        ...

    @property
    def linear(self) -> FloatArray:
        """Linear cost, (dimension, count)."""
        ...

    @property
    def right(self) -> FloatArray:
        """Right side of the constraints, flat."""
        ...

    @property
    def curved(self) -> bool:
        """False where every Q is zero."""
        ...

    def quadratic(self, x: FloatArray) -> FloatArray:
        """Return Q x."""
        ...

    def apply(self, x: FloatArray) -> FloatArray:
        """Return G x, flat."""
        ...

    def transpose(self, z: FloatArray) -> FloatArray:
        """Return G^T z, (dimension, count)."""
        ...

    def compliance(self, scalings: Sequence[Scaling]) -> Compliance:
        """Return the compliances at a scaling."""
        ...

    def balanced(self, force: FloatArray, rough: Callable[[], FloatArray], /) -> FloatArray:
        """Return multipliers near `rough`, called where needed, with G^T z = force to rounding, as far as G allows it."""
        ...

    def interior(self, size: FloatArray, /) -> FloatArray:
        """Return some x with right - G x inside the cones, of about this size (count,) if that is free."""
        ...
