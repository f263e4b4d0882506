"""Supports that move."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from churchpipe.errors import InputError
from churchpipe.large_displacements.poses import Poses
from churchpipe.model.arrays import FloatArray, IntArray, array_of, floats, indices, unit_vector
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts


@dataclass(frozen=True, slots=True)
class SupportMovement:
    """Fixed stones (k,) that move as one body: along a unit vector direction (3,), or about a unit axis through a point.

    about (3,) m: a point of the axis, None for a translation.
    """

    stones: IntArray
    direction: FloatArray
    about: FloatArray | None = None

    def twist(self, poses: Poses) -> FloatArray:
        """Return the velocities (k, 6) at the centroids for a unit rate, m or rad."""
        out = np.zeros((len(self.stones), 6))
        if self.about is None:
            out[:, :3] = self.direction
        else:
            out[:, 3:] = self.direction
            out[:, :3] = np.cross(self.direction, poses.centroid[self.stones] - self.about)
        return out


def support_movement(
    stones: Assemblage, contacts: Contacts, support: npt.ArrayLike, direction: npt.ArrayLike, about: npt.ArrayLike | None
) -> SupportMovement:
    """Return the movement of a support, checked.

    Raises
    ------
    InputError: stones that are not there, not fixed or bear nothing, no direction.
    """
    where = "settlement_analysis: support"
    chosen = np.unique(
        indices(where, np.atleast_1d(array_of(where, support, "iu", "indices of stones")), (None,), below=stones.count)
    )
    if not len(chosen):
        raise InputError(where, "no stones", found=0, expected="indices of fixed stones")
    free = chosen[~stones.fixed[chosen]]
    if len(free):
        raise InputError(
            where,
            "a stone that is free",
            found=f"{stones.block_id[free[0]]} (stone {free[0]})",
            expected=f"fixed stones: {', '.join(map(str, np.flatnonzero(stones.fixed)[:8])) or 'there are none'}",
            remedy="A settlement moves what the structure stands on.",
        )
    touches = np.isin(contacts.blocks, chosen).any(axis=1) & ~stones.fixed[contacts.blocks].all(axis=1)
    if not touches.any():
        raise InputError(where, "nothing stands on it", found=", ".join(stones.block_id[chosen]), expected="a support in contact")
    along = unit_vector("settlement_analysis: direction", direction)
    point = None if about is None else floats("settlement_analysis: about", about, (3,))
    return SupportMovement(chosen, along, point)
