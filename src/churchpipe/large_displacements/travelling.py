"""Loads that travel with their stones."""

from dataclasses import dataclass

import numpy as np

from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.loads import LoadCase
from churchpipe.rigid_blocks.equilibrium import lateral_weight


@dataclass(frozen=True, slots=True)
class TravellingLoads:
    """Forces (nb, 3) N that keep their direction, at points of their stones, and moments (nb, 3) Nm that keep theirs.

    arm (nb, 3) m: the point from the centroid in the axes of the drawing.
    """

    force: FloatArray
    moment: FloatArray
    arm: FloatArray

    def rows(self, rotation: FloatArray, free: IntArray, force: float, length: float) -> FloatArray:
        """Return the loads (6 nf,) of the free stones, turned by these rotations (nb, 3, 3), in units of force and length."""
        arm = np.einsum("kij,kj->ki", rotation, self.arm)
        moment = self.moment + np.cross(arm, self.force)
        return np.concatenate([self.force / force, moment / (force * length)], axis=1)[free].ravel()


def dead_loads(stones: Assemblage, load: LoadCase) -> TravellingLoads:
    """Return the weight of the stones and what else always acts."""
    own = np.zeros((stones.count, 6))
    own[:, 2] = -stones.weight
    return _travelling(own + (0.0 if load.dead is None else load.dead))


def live_loads(stones: Assemblage, load: LoadCase) -> TravellingLoads:
    """Return what grows with the load factor, as it is on the stones as drawn."""
    pushed = np.zeros((stones.count, 6))
    pushed[:, :3] = lateral_weight(stones, load)[:, None] * load.direction
    return _travelling(pushed + (0.0 if load.live is None else load.live))


def _travelling(wrench: FloatArray) -> TravellingLoads:
    """Return wrenches about the centroids as forces at the point of their lines nearest to the centroid."""
    force, moment = wrench[:, :3], wrench[:, 3:]
    square = (force**2).sum(axis=1, keepdims=True)
    arm = np.cross(force, moment) / np.where(square > 0, square, 1.0)
    return TravellingLoads(force, moment - np.cross(arm, force), arm)
