"""Loads that travel with their stones."""

from dataclasses import dataclass

import numpy as np

from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.loads import LoadCase, nearest_virial
from churchpipe.rigid_blocks.equilibrium import lateral_weight


@dataclass(frozen=True, slots=True)
class TravellingLoads:
    """Forces that keep their direction, at points of the stones.

    force (nb, 3) N: their sums; virial (nb, i, j) Nm: their sums of r_i F_j, r from the centroid in the axes of the drawing
    (i, j: axes); moment (nb, 3) Nm: moments beside theirs, which do not turn.
    """

    force: FloatArray
    virial: FloatArray
    moment: FloatArray

    def rows(self, rotation: FloatArray, free: IntArray, force: float, length: float) -> FloatArray:
        """Return the loads (6 nf,) of the free stones, turned by these rotations (nb, 3, 3), in units of force and length."""
        moment = self.moment + _moment(rotation @ self.virial)
        return np.concatenate([self.force / force, moment / (force * length)], axis=1)[free].ravel()

    def on(self, stones: IntArray | BoolArray) -> bool:
        """Whether anything acts on some of these stones."""
        return any(part[stones].any() for part in (self.force, self.virial, self.moment))


def dead_loads(stones: Assemblage, load: LoadCase) -> TravellingLoads:
    """Return the weight of the stones and what else always acts."""
    own = np.zeros((stones.count, 3))
    own[:, 2] = -stones.weight
    return _travelling(own, load.dead, load.dead_virial)


def live_loads(stones: Assemblage, load: LoadCase) -> TravellingLoads:
    """Return what grows with the load factor, as it is on the stones as drawn."""
    return _travelling(lateral_weight(stones, load)[:, None] * load.direction, load.live, load.live_virial)


def _travelling(at_centroid: FloatArray, wrench: FloatArray | None, virial: FloatArray | None) -> TravellingLoads:
    """Return forces at the centroids (nb, 3) and those of wrenches (nb, 6) about them."""
    if wrench is None:
        return TravellingLoads(at_centroid, np.zeros((len(at_centroid), 3, 3)), np.zeros_like(at_centroid))
    found = nearest_virial(wrench) if virial is None else virial
    return TravellingLoads(at_centroid + wrench[:, :3], found, wrench[:, 3:] - _moment(found))


def _moment(virial: FloatArray) -> FloatArray:
    """Return the moments (nb, 3), Nm, of r_i F_j (nb, i, j)."""
    turned = virial - virial.transpose(0, 2, 1)
    return np.stack([turned[:, 1, 2], turned[:, 2, 0], turned[:, 0, 1]], axis=1)
