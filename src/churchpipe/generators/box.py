"""Four walls around a rectangle."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any

from churchpipe.errors import InputError
from churchpipe.generators.checks import Brick, check_brick
from churchpipe.generators.fields import as_dataclass, coerce_fields, materials_of
from churchpipe.generators.laying import Joints
from churchpipe.generators.masonry import (
    DEFAULT_MATERIAL,
    Masonry,
    Pattern,
    bonded_offset,
    check_bond,
    straight_wall,
    thickness_of,
)
from churchpipe.generators.openings import OpeningLike
from churchpipe.model.building import Building, Headers, UnitCell
from churchpipe.model.materials import UnitWeight
from churchpipe.model.quantities import Coordinate, Count, Length


@dataclass(frozen=True, slots=True)
class BoxParameters:
    """A box of four walls, toothed at the corners, x and y from 0: south and north run along x, south at y = 0; west and east
    along y, west at x = 0."""

    length: Annotated[Length, "Along x, over all."]
    width: Annotated[Length, "Along y, over all."]
    courses: Annotated[Count, "Number of courses."]
    brick: Annotated[Brick, "Length, thickness and height of a stone."]
    thickness: Annotated[Length | None, "By default that of the brick, in header-stretcher bond that of two."] = None
    pattern: Annotated[Pattern, "Bond."] = "running"
    headers: Annotated[Headers, "How headers tie the two leaves of header-stretcher bond."] = "english"
    joints: Joints = "grid"
    through_offset: Annotated[Coordinate | None, 'Place of the joints of courses that run through, with "grid".'] = None
    cut_offset: Annotated[Coordinate | None, 'Place of the joints of courses that are cut, with "grid".'] = None
    openings_x: Annotated[Sequence[OpeningLike], "Openings in both walls along x, measured from the outer corner."] = ()
    openings_y: Annotated[Sequence[OpeningLike], "Openings in both walls along y, measured from the outer corner."] = ()

    def __post_init__(self) -> None:
        coerce_fields(self, "box.")
        check_brick("box.brick", self.brick)
        check_bond("box", self.pattern, self.headers)
        for key in ("length", "width"):
            if not getattr(self, key) > 2 * self.wall_thickness:
                raise InputError(
                    f"box.{key}", "no room inside", found=getattr(self, key), expected=f"> {2 * self.wall_thickness:g} m"
                )

    @property
    def wall_thickness(self) -> float:
        """Thickness of the walls, m."""
        return thickness_of("box", self.pattern, self.brick, self.thickness)


def box(*, name: str = "box", materials: tuple[UnitWeight, ...] = (DEFAULT_MATERIAL,), **parameters: Any) -> Building:
    """Return a box of four walls; keywords: its keys in docs/reference_case.md, without unit, SI.

    Walls along x run through on even courses.
    """
    p = as_dataclass(BoxParameters, "box", parameters)
    materials = materials_of("box", materials)
    thickness = p.wall_thickness
    masonry = Masonry(
        cell=UnitCell(a=p.brick[2], b=p.brick[0]),
        courses=p.courses,
        thickness=thickness,
        material=materials[0].name,
        pattern=p.pattern,
        headers=p.headers,
        joints=p.joints,
        through_offset=bonded_offset(p.brick, thickness) if p.through_offset is None else p.through_offset,
        cut_offset=p.cut_offset,
    )
    walls = [
        straight_wall(side, masonry, (0.0, y), "x", p.length, runs_through=0, openings=p.openings_x, where="box.openings_x.{}")
        for side, y in (("south", 0.0), ("north", p.width - thickness))
    ]
    walls += [
        straight_wall(side, masonry, (x, 0.0), "y", p.width, runs_through=1, openings=p.openings_y, where="box.openings_y.{}")
        for side, x in (("west", 0.0), ("east", p.length - thickness))
    ]
    return Building(name, tuple(walls), materials)
