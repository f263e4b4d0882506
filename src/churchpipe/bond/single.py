"""One stone that fills its region: a lintel."""

from dataclasses import dataclass

import numpy as np

from churchpipe.bond.field import Field, HorizontalBeds
from churchpipe.bond.tiles import TileSet, tiles_of
from churchpipe.errors import InputError
from churchpipe.geometry.planar import area, polygon
from churchpipe.geometry.polygons import TOLERANCE
from churchpipe.model.arrays import FloatArray, floats, store
from churchpipe.model.building import UnitCell


@dataclass(frozen=True, slots=True)
class SingleStone(HorizontalBeds):
    """A single stone with the given outline (n, 2) m; `cell.a` is the height of the courses around it."""

    cell: UnitCell
    outline: FloatArray

    def __post_init__(self) -> None:
        store(self, outline=floats("SingleStone.outline", self.outline, (None, 2)))

    def tiles(self, field: Field) -> TileSet:
        """Return the one stone; its course is that of its bottom edge.

        Raises
        ------
        InputError: an opening, a junction or the wall's end cuts the stone.
        """
        whole = polygon(self.outline)
        missing = 1 - area(field.solid) / area(whole)
        if missing > TOLERANCE:
            raise InputError(
                field.name,
                "an opening, a junction or the end of the wall cuts this stone",
                found=f"{100 * missing:.3g} % of it cut away",
                expected="a stone that lies in its own wall",
                remedy="Shorten its bearings, or move the opening.",
            )
        course = int(np.floor(self.outline[:, 1].min() / self.cell.a + TOLERANCE))
        return tiles_of(np.array([whole], dtype=np.object_), np.array([course], dtype=np.int64), field.name)
