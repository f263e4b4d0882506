"""Stack bond: head joints in one line from bottom to top."""

from dataclasses import dataclass
from typing import Literal

from churchpipe.bond.courses import lay_courses
from churchpipe.bond.field import Field, HorizontalBeds
from churchpipe.bond.joints import bay_joints, grid_joints, laid_length
from churchpipe.bond.tiles import TileSet
from churchpipe.model.arrays import FloatArray
from churchpipe.model.building import UnitCell


@dataclass(frozen=True, slots=True)
class StackBond(HorizontalBeds):
    """Courses of height a, stones of length b; offset of the joints, m (rule "grid")."""

    cell: UnitCell
    rule: Literal["grid", "bay"]
    offset: float

    def tiles(self, field: Field) -> TileSet:
        """Return the stones of the field."""

        def joints(course: int) -> FloatArray:
            if self.rule == "bay":
                return bay_joints(field, self.cell.b, False, (course + 0.5) * self.cell.a)
            return grid_joints(field, self.cell.b, self.offset)

        return lay_courses(field, self.cell, joints)

    def stone_length(self, bay: float) -> float:
        """Return how long the stones of a clear bay are, m."""
        return laid_length(bay, self.cell.b) if self.rule == "bay" else self.cell.b
