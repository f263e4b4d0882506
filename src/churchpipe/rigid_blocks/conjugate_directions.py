"""Directions that conjugate gradients have tried, kept for other right sides of the same matrix."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from churchpipe.model.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Directions:
    """Conjugate directions y (k, n) of a matrix H = F + C^T A^-1 C, with H y, A^-1 C y (both k, n) and y . H y (k,) of each."""

    y: FloatArray
    bent: FloatArray
    crossed: FloatArray
    work: FloatArray

    @classmethod
    def none(cls, size: int) -> Self:
        """Return no directions of vectors of this size."""
        empty = np.empty((0, size))
        return cls(empty, empty, empty, np.empty(0))

    def shares(self, left: FloatArray) -> FloatArray:
        """Return how far to go along each (k,) to lower what is left of a right side (n,) the most."""
        return self.y @ left / self.work

    def conjugate(self, change: FloatArray) -> FloatArray:
        """Return a direction (n,) without its part along these."""
        return change - (self.bent @ change / self.work) @ self.y

    def with_more(self, tried: Sequence[tuple[FloatArray, FloatArray, FloatArray]]) -> Self:
        """Return these and others: y, H y and A^-1 C y of each."""
        if not tried:
            return self
        y, bent, crossed = (np.array(vectors) for vectors in zip(*tried, strict=True))
        work = np.einsum("kn,kn->k", y, bent)
        parts = (self.y, y), (self.bent, bent), (self.crossed, crossed), (self.work, work)
        return type(self)(*(np.concatenate(pair) for pair in parts))
