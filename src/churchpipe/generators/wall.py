"""A free-standing straight wall."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any

from churchpipe.errors import InputError
from churchpipe.generators.checks import Brick, check_brick
from churchpipe.generators.fields import as_dataclass, coerce_fields, materials_of
from churchpipe.generators.laying import Joints
from churchpipe.generators.masonry import DEFAULT_MATERIAL, Masonry, Pattern, check_bond, straight_wall, thickness_of
from churchpipe.generators.openings import OpeningLike
from churchpipe.model.arguments import whole
from churchpipe.model.building import Building, Headers, UnitCell
from churchpipe.model.materials import UnitWeight
from churchpipe.model.quantities import Coordinate, Count, Length


@dataclass(frozen=True, slots=True)
class WallParameters:
    """A wall along x from 0 to its length, y from 0 to its thickness. It is called wall."""

    length: Annotated[Length, "Length."]
    brick: Annotated[Brick, "Length, thickness and height of a stone."]
    courses: Annotated[Count | None, "Number of courses; or give the height."] = None
    height: Annotated[Length | None, "Height, a whole number of courses; or give their number."] = None
    thickness: Annotated[Length | None, "By default that of the brick, in header-stretcher bond that of two."] = None
    pattern: Annotated[Pattern, "Bond."] = "running"
    headers: Annotated[Headers, "How headers tie the two leaves of header-stretcher bond."] = "english"
    joints: Joints = "grid"
    through_offset: Annotated[Coordinate, 'Place of the joints of even courses, with "grid".'] = 0.0
    cut_offset: Annotated[Coordinate | None, 'Place of the joints of odd courses, with "grid"; by default half a stone on.'] = (
        None
    )
    openings: Annotated[Sequence[OpeningLike], "Doors and windows."] = ()

    def __post_init__(self) -> None:
        coerce_fields(self, "wall.")
        check_brick("wall.brick", self.brick)
        check_bond("wall", self.pattern, self.headers)
        whole("wall.courses", self.course_count, least=1)

    @property
    def wall_thickness(self) -> float:
        """Thickness of the wall, m."""
        return thickness_of("wall", self.pattern, self.brick, self.thickness)

    @property
    def course_count(self) -> int:
        """Number of courses."""
        if (self.courses is None) == (self.height is None):
            raise InputError("wall", "its height is given twice or not at all", expected='either "courses" or "height"')
        if self.height is None:
            return self.courses or 0
        ratio = self.height / self.brick[2]
        count = max(1, round(ratio))
        if abs(ratio - count) > 1e-6:
            raise InputError(
                "wall.height",
                "not a whole number of courses",
                found=f"{ratio:.4g} courses of {self.brick[2]:g} m",
                expected=f"{count * self.brick[2]:g} m",
                remedy='Round it, or give "courses".',
            )
        return count


def wall(*, name: str = "wall", materials: tuple[UnitWeight, ...] = (DEFAULT_MATERIAL,), **parameters: Any) -> Building:
    """Return a free-standing wall; keywords: its keys in docs/reference_case.md, without unit, SI."""
    p = as_dataclass(WallParameters, "wall", parameters)
    materials = materials_of("wall", materials)
    masonry = Masonry(
        cell=UnitCell(a=p.brick[2], b=p.brick[0]),
        courses=p.course_count,
        thickness=p.wall_thickness,
        material=materials[0].name,
        pattern=p.pattern,
        headers=p.headers,
        joints=p.joints,
        through_offset=p.through_offset,
        cut_offset=p.cut_offset,
    )
    panel = straight_wall("wall", masonry, (0.0, 0.0), "x", p.length, openings=p.openings, where="wall.openings.{}")
    return Building(name, (panel,), materials)
