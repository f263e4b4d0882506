"""Loads at their places: forces and masses at points of stones, the form that both models take."""

from dataclasses import dataclass

import numpy as np

from churchpipe.model.arrays import FloatArray, IntArray, NameArray, floats, indices, names, rows_of, store


@dataclass(frozen=True, slots=True)
class PlacedLoads:
    """n small parts of loads.

    point (n, 3) m; stone (n,): the one that bears it; wall (n,): the panel of that stone; load (n,): name of the load that it is
    a part of; dead (n, 3) N: its force; mass (n,): weight, N, that a lateral load multiplies there.
    """

    point: FloatArray
    stone: IntArray
    wall: NameArray
    load: NameArray
    dead: FloatArray
    mass: FloatArray

    def __post_init__(self) -> None:
        n = rows_of("PlacedLoads.stone", self.stone)
        store(
            self,
            point=floats("PlacedLoads.point", self.point, (n, 3)),
            stone=indices("PlacedLoads.stone", self.stone, (n,)),
            wall=names("PlacedLoads.wall", self.wall, (n,)),
            load=names("PlacedLoads.load", self.load, (n,)),
            dead=floats("PlacedLoads.dead", self.dead, (n, 3)),
            mass=floats("PlacedLoads.mass", self.mass, (n,)),
        )

    @property
    def weight(self) -> FloatArray:
        """What presses downwards (n,), N."""
        return np.asarray(-self.dead[:, 2])
