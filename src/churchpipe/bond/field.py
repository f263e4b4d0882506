"""The part of a wall that a bond fills, and what a bond must provide."""

from dataclasses import dataclass
from dataclasses import field as dataclass_field
from typing import Literal, Protocol

import numpy as np

from churchpipe.bond.tiles import TileSet
from churchpipe.bond.voids import Void
from churchpipe.geometry.planar import Region
from churchpipe.model.arrays import FloatArray, floats, store
from churchpipe.model.building import UnitCell


@dataclass(frozen=True, slots=True)
class Field:
    """The part of a wall that one bond fills, in chart coordinates (s along the wall, t upwards, m).

    name: for messages. solid: the region to fill. span: s of the two ends of the wall. through: the courses, even (0) or odd
    (1), on which the wall runs through its junctions. zones (nz, 2): s of the faces of its junctions, disjoint and sorted. ceded
    (nl, 4): rectangles s0, t0, s1, t1 of the junctions whose stones belong to other walls. closed: whether the wall ends where
    it starts, as the wall of a round tower does. voids: arched openings of a curved wall. radius: of its mid-surface, m.
    """

    name: str
    solid: Region
    span: tuple[float, float]
    through: Literal[0, 1] = 0
    zones: FloatArray = dataclass_field(default_factory=lambda: np.empty((0, 2)))
    ceded: FloatArray = dataclass_field(default_factory=lambda: np.empty((0, 4)))
    closed: bool = False
    voids: tuple[Void, ...] = ()
    radius: float = np.inf

    def __post_init__(self) -> None:
        store(
            self,
            zones=floats("Field.zones", self.zones, (None, 2)),
            ceded=floats("Field.ceded", self.ceded, (None, 4)),
        )


class Bond(Protocol):
    """A pattern of stones. It gives the stones their joints, and the shell its bed direction and unit cell."""

    @property
    def cell(self) -> UnitCell:
        """Course height a and stone length b, m: the unit cell of Malena et al. (2019), eq. (7)."""
        ...

    def tiles(self, field: Field) -> TileSet:
        """Return the stones: polygons that cover `field.solid` exactly once."""
        ...

    def bed_direction(self, points: FloatArray) -> FloatArray:
        """Return unit vectors (n, 2) along the bed joint at points (n, 2), chart coordinates."""
        ...


class HorizontalBeds:
    """Part of a bond whose beds are level: all but a ring of voussoirs."""

    __slots__ = ()

    def bed_direction(self, points: FloatArray) -> FloatArray:
        """Return the horizontal direction (1, 0) at points (n, 2)."""
        return np.tile([1.0, 0.0], (len(points), 1))
