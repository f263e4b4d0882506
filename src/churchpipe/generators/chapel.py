"""A small church of one room: facade, two side walls, end wall and apse."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any

from churchpipe.errors import InputError
from churchpipe.generators.arched import Given
from churchpipe.generators.church import church
from churchpipe.generators.church_parts import Apse
from churchpipe.generators.church_plan import LEAST_ROOM
from churchpipe.generators.fields import as_dataclass, coerce_fields
from churchpipe.generators.laying import Bonds, Course, FirstCourse, Joints, Junctions, Openings, StoneLength, Walls
from churchpipe.generators.masonry import DEFAULT_MATERIAL
from churchpipe.generators.rooms import RoomVault
from churchpipe.generators.wall_bonds import OwnWall, own
from churchpipe.model.building import Building
from churchpipe.model.materials import UnitWeight
from churchpipe.model.quantities import Length


@dataclass(frozen=True, slots=True)
class ChapelParameters:
    """A chapel of the walls facade, nave_left, nave_right and east. x is 0 in the middle, y in the middle of the facade."""

    course: Course
    stone_length: StoneLength
    width: Annotated[Length, "Along x, over all."]
    length: Annotated[Length, "Along y, over all, without the apse."]
    height: Annotated[Length, "Height of the eaves."]
    thickness: Annotated[Length, "Thickness of the walls."]
    ridge: Annotated[Length | None, "Height of the ridge of both gables; by default there are none."] = None
    apse: Annotated[Apse | Given | None, "Apse behind the end wall."] = None
    openings: Openings = ()
    bonds: Bonds = ()
    walls: Walls = ()
    junctions: Junctions = ()
    vaults: Annotated[Sequence[RoomVault | Given], "Vaults over rooms and apses."] = ()
    joints: Joints = "bay"
    first_course: FirstCourse = "x"

    def __post_init__(self) -> None:
        coerce_fields(self, "chapel.")
        thick = self.thicknesses
        for key, walls in (("width", ("nave_left", "nave_right")), ("length", ("facade", "east"))):
            room = getattr(self, key) - sum(thick[wall] for wall in walls)
            if room < LEAST_ROOM * self.stone_length:
                found, expected = f"{room:.4g} m clear", f">= {self.stone_length:g} m"
                raise InputError(f"chapel.{key}", "no room inside", found=found, expected=expected)

    @property
    def thicknesses(self) -> dict[str, float]:
        """Thickness of each of its straight walls, m."""
        walls = [as_dataclass(OwnWall, f"chapel.walls.{k}", wall) for k, wall in enumerate(self.walls)]
        return {name: own(walls, name, "thickness", self.thickness) for name in ("facade", "nave_left", "nave_right", "east")}


# Prefixes of the parameters of a church in messages, and those of the same parameters of a chapel.
_PLACES = (
    *((f"church.{wall}.", "chapel.") for wall in ("nave", "facade", "east")),
    ("church.apses.0.", "chapel.apse."),
    ("church.", "chapel."),
    ("church: ", "chapel: "),
)


def chapel(*, name: str = "chapel", materials: tuple[UnitWeight, ...] = (DEFAULT_MATERIAL,), **parameters: Any) -> Building:
    """Return a chapel; keywords: its keys in docs/reference_case.md, without unit, SI."""
    p = as_dataclass(ChapelParameters, "chapel", parameters)
    end = {"thickness": p.thickness, "ridge": p.ridge}
    try:
        return _church(p, end, name, materials)
    except InputError as error:
        theirs, ours = next((pair for pair in _PLACES if error.where.startswith(pair[0])), ("", ""))
        raise error.at(ours + error.where.removeprefix(theirs)) from error


def _church(p: ChapelParameters, end: dict[str, Any], name: str, materials: tuple[UnitWeight, ...]) -> Building:
    thick = p.thicknesses
    return church(
        name=name,
        materials=materials,
        course=p.course,
        stone_length=p.stone_length,
        nave={
            "width": p.width - (thick["nave_left"] + thick["nave_right"]) / 2,
            "length": p.length - (thick["facade"] + thick["east"]) / 2,
            "height": p.height,
            "thickness": p.thickness,
        },
        facade=end,
        east=end,
        apses=() if p.apse is None else (p.apse,),
        openings=p.openings,
        bonds=p.bonds,
        walls=p.walls,
        junctions=p.junctions,
        vaults=p.vaults,
        joints=p.joints,
        first_course=p.first_course,
    )
