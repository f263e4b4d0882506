"""Running bond: courses of stones, each shifted against the one below."""

from dataclasses import dataclass
from typing import Literal

from churchpipe.bond.courses import lay_courses
from churchpipe.bond.field import Field, HorizontalBeds
from churchpipe.bond.joints import bay_joints, grid_joints, laid_length
from churchpipe.bond.tiles import TileSet
from churchpipe.model.arrays import FloatArray
from churchpipe.model.building import UnitCell


@dataclass(frozen=True, slots=True)
class RunningBond(HorizontalBeds):
    """Courses of height a, stones of length b; offsets of the joints on through and on cut courses, m (rule "grid")."""

    cell: UnitCell
    rule: Literal["grid", "bay"]
    through_offset: float
    cut_offset: float

    def tiles(self, field: Field) -> TileSet:
        """Return the stones of the field."""

        def joints(course: int) -> FloatArray:
            through = course % 2 == field.through
            if self.rule == "bay":
                return bay_joints(field, self.cell.b, through, (course + 0.5) * self.cell.a)
            return grid_joints(field, self.cell.b, self.through_offset if through else self.cut_offset)

        return lay_courses(field, self.cell, joints)

    def stone_length(self, bay: float) -> float:
        """Return how long the stones of a clear bay are, m."""
        return laid_length(bay, self.cell.b) if self.rule == "bay" else self.cell.b
