"""What a bond is asked to fill, and what a bond is."""

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
    """The part of a wall that one bond fills, in chart coordinates.

    name: for messages. solid: what is to be filled, m2. span: the ends of the wall, s in m. through: parity of the courses
    on which the wall runs through its junctions. zones (nz, 2) m: its junctions, disjoint and sorted along s. lost (nl, 4) m:
    rectangles s0, t0, s1, t1 of the zones that belong to other walls. closed: whether the wall's end is its start, as of a
    round tower. voids: arched openings of a curved wall, radius: of its mid-surface, m.
    """

    name: str
    solid: Region
    span: tuple[float, float]
    through: Literal[0, 1] = 0
    zones: FloatArray = dataclass_field(default_factory=lambda: np.empty((0, 2)))
    lost: FloatArray = dataclass_field(default_factory=lambda: np.empty((0, 4)))
    closed: bool = False
    voids: tuple[Void, ...] = ()
    radius: float = np.inf

    def __post_init__(self) -> None:
        store(
            self,
            zones=floats("Field.zones", self.zones, (None, 2)),
            lost=floats("Field.lost", self.lost, (None, 4)),
        )


class Bond(Protocol):
    """A way of laying stones: it gives the stones their joints and the shell its bed direction and unit cell."""

    @property
    def cell(self) -> UnitCell:
        """Course height and stone length of eq. (7)."""
        ...

    def tiles(self, field: Field) -> TileSet:
        """Return the stones: polygons that cover `field.solid` exactly once."""
        ...

    def bed_direction(self, points: FloatArray) -> FloatArray:
        """Return unit vectors (n, 2) along the bed joint at points (n, 2), chart coordinates."""
        ...
