"""Stack bond: head joints in one line from bottom to top."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from churchpipe.bond.courses import lay_courses
from churchpipe.bond.field import Field
from churchpipe.bond.joints import bay_joints, grid_joints
from churchpipe.bond.tiles import TileSet
from churchpipe.model.arrays import FloatArray
from churchpipe.model.building import UnitCell


@dataclass(frozen=True, slots=True)
class StackBond:
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

    def bed_direction(self, points: FloatArray) -> FloatArray:
        """Return the horizontal direction (1, 0) at points (n, 2)."""
        return np.tile([1.0, 0.0], (len(points), 1))
