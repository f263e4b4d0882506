"""The product of all local cones, as one flat vector."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from churchpipe.conic.interior_point.nonnegative import Nonnegative, NonnegativeScaling
from churchpipe.conic.interior_point.second_order import SecondOrder, SecondOrderScaling
from churchpipe.model.arrays import FloatArray

Cone: TypeAlias = Nonnegative | SecondOrder
Scaling: TypeAlias = NonnegativeScaling | SecondOrderScaling


def cone_shape(cone: Cone) -> tuple[int, ...]:
    """Return the shape in which a cone sees its part of the flat vector."""
    if isinstance(cone, Nonnegative):
        return (cone.rows, cone.count)
    return (cone.dimension, cone.copies, cone.count)


@dataclass(frozen=True, slots=True)
class ProductScaling:
    """Nesterov-Todd scalings of all parts."""

    product: "ProductCone"
    parts: tuple[Scaling, ...]

    def apply(self, v: FloatArray) -> FloatArray:
        """Return W v."""
        return self.product.join([part.apply(view) for part, view in zip(self.parts, self.product.split(v), strict=True)])

    def solve(self, v: FloatArray) -> FloatArray:
        """Return W^-1 v."""
        return self.product.join([part.solve(view) for part, view in zip(self.parts, self.product.split(v), strict=True)])

    def soften(self, v: FloatArray) -> FloatArray:
        """Return W^-2 v."""
        return self.product.join([part.soften(view) for part, view in zip(self.parts, self.product.split(v), strict=True)])

    def divide(self, v: FloatArray) -> FloatArray:
        """Return u with lam o u = v."""
        return self.product.join([part.divide(view) for part, view in zip(self.parts, self.product.split(v), strict=True)])

    def point(self) -> FloatArray:
        """Return lam = W z = W^-1 s."""
        return self.product.join([part.point for part in self.parts])


class ProductCone:
    """Cones side by side; a flat vector holds their parts one after another."""

    def __init__(self, cones: Sequence[Cone]) -> None:
        self.cones = tuple(cones)
        sizes = [cone.rows * cone.count for cone in self.cones]
        self._ends = np.cumsum([0, *sizes]).tolist()
        self.size = int(self._ends[-1])
        self.degree = sum(cone.degree for cone in self.cones)

    def split(self, v: FloatArray) -> list[FloatArray]:
        """Return views of the parts of a flat vector."""
        return [
            v[start:stop].reshape(cone_shape(cone))
            for cone, start, stop in zip(self.cones, self._ends[:-1], self._ends[1:], strict=True)
        ]

    def join(self, parts: Sequence[FloatArray]) -> FloatArray:
        """Return the flat vector of the parts."""
        if len(parts) == 1:
            return parts[0].reshape(-1)
        return np.concatenate([part.ravel() for part in parts]) if parts else np.zeros(0)

    def identity(self) -> FloatArray:
        """Return e."""
        return self.join([cone.identity() for cone in self.cones])

    def inverse(self, s: FloatArray) -> FloatArray:
        """Return u with s o u = e."""
        return self.join([cone.inverse(part) for cone, part in zip(self.cones, self.split(s), strict=True)])

    def product(self, u: FloatArray, v: FloatArray) -> FloatArray:
        """Return u o v."""
        return self.join([cone.product(a, b) for cone, a, b in zip(self.cones, self.split(u), self.split(v), strict=True)])

    def margin(self, s: FloatArray) -> float:
        """Return the smallest eigenvalue."""
        return min((cone.margin(part) for cone, part in zip(self.cones, self.split(s), strict=True)), default=np.inf)

    def rates(self, s: FloatArray, step: FloatArray, more: FloatArray, weights: FloatArray) -> FloatArray:
        """Return 1 / t for the largest t with s + t (step + weight more) in each cone, (weights, cones)."""
        parts = zip(self.cones, self.split(s), self.split(step), self.split(more), strict=True)
        rates = [cone.rates(a, b, c, weights) for cone, a, b, c in parts]
        if len(rates) == 1:
            return rates[0]
        return np.concatenate(rates, axis=1) if rates else np.zeros((len(weights), 0))

    def entries(self, values: FloatArray) -> FloatArray:
        """Return a value of each cone (cones,) at each entry of the flat vector."""
        ends = np.cumsum([cone.degree for cone in self.cones])[:-1]
        return self.join([cone.entries(part) for cone, part in zip(self.cones, np.split(values, ends), strict=True)])

    def scaling(self, s: FloatArray, z: FloatArray) -> ProductScaling:
        """Return the Nesterov-Todd scaling of interior s and z."""
        parts = zip(self.cones, self.split(s), self.split(z), strict=True)
        return ProductScaling(self, tuple(cone.scaling(a, b) for cone, a, b in parts))

    def recentre(self, product: FloatArray, low: float, high: float) -> FloatArray:
        """Return the correction that brings the eigenvalues of a complementarity product into [low, high]."""
        return self.join([cone.recentre(v, low, high) for cone, v in zip(self.cones, self.split(product), strict=True)])
