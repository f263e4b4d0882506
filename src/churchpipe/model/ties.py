"""Ties: bars that pull two stones together."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from churchpipe.errors import InputError
from churchpipe.model.arguments import finite, text
from churchpipe.model.arrays import FloatArray, floats, indices, store


@dataclass(frozen=True, slots=True)
class Tie:
    """A bar without weight between two anchors: it pulls with 0 <= T <= strength, and never pushes.

    The bar is ductile.

    Parameters
    ----------
    name
        What messages and results call it.
    start, end
        The anchors, points (3,) m.
    stones
        Indices (i, j) of the stones that they pull on; None: those that contain or touch the anchors.
    strength
        N, the least of yield, punching of the wall and bearing under the plates.

    Raises
    ------
    InputError
        No name, no length, a strength that is no number >= 0, both ends on one stone.
    """

    name: str
    start: FloatArray
    end: FloatArray
    stones: tuple[int, int] | None
    strength: float

    def __init__(
        self,
        name: str,
        start: npt.ArrayLike,
        end: npt.ArrayLike,
        stones: tuple[int, int] | None = None,
        *,
        strength: float,
    ) -> None:
        text("Tie.name", name)
        where = f"tie {name}"
        first, second = floats(f"{where}: start", start, (3,)), floats(f"{where}: end", end, (3,))
        if not np.linalg.norm(second - first) > 0:
            raise InputError(where, "no length", found=f"both ends at {first.tolist()} m", expected="two anchors apart")
        if finite(f"{where}: strength", strength) < 0:
            raise InputError(f"{where}: strength", "out of range", found=strength, expected=">= 0 N")
        pair = None
        if stones is not None:
            i, j = indices(f"{where}: stones", stones, (2,)).tolist()
            pair = i, j
            if i == j:
                raise InputError(where, "both ends on one stone", found=f"stones {i} and {j}", expected="two stones")
        store(self, name=name, start=first, end=second, stones=pair, strength=float(strength))

    @property
    def axis(self) -> FloatArray:
        """Unit vector (3,) from start to end."""
        span = self.end - self.start
        return np.asarray(span / np.linalg.norm(span))
