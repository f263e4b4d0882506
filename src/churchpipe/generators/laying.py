"""Keys that several generators share: how the walls of a building are laid."""

from collections.abc import Sequence
from typing import Annotated, Literal

from churchpipe.errors import InputError
from churchpipe.generators.arched import ArchedOpening, Given
from churchpipe.generators.fields import as_dataclass
from churchpipe.generators.wall_bonds import OwnWall, WallBond
from churchpipe.model.building import Junction
from churchpipe.model.sizes import LaidSize

Course = Annotated[LaidSize, "Height of the courses."]
StoneLength = Annotated[LaidSize, "Length of the stones, about: each clear stretch of wall is divided evenly."]
Joints = Annotated[
    Literal["grid", "bay"], 'Head joints at multiples of the stone ("grid"), or each clear stretch divided evenly ("bay").'
]
FirstCourse = Annotated[Literal["x", "y"], "Walls that run through the junctions on course 0: those along x or along y."]
Openings = Annotated[Sequence[ArchedOpening | Given], "Arched openings."]
Bonds = Annotated[Sequence[WallBond | Given], "Bonds of walls that are not laid in running bond."]
Walls = Annotated[Sequence[OwnWall | Given], "Walls unlike the others."]
Junctions = Annotated[Sequence[Junction | Given], "Junctions of walls that are not toothed."]


def junctions_of(where: str, values: Sequence[Junction | Given]) -> tuple[Junction, ...]:
    """Return the junctions that a building is given. where: its generator, for messages."""
    return tuple(_junction(f"{where}.junctions.{number}", value) for number, value in enumerate(values))


def _junction(where: str, value: Junction | Given) -> Junction:
    try:
        return as_dataclass(Junction, where, value)
    except InputError as error:
        raise (error if error.where.startswith(where) else error.at(f"{where}.{error.where.rpartition(': ')[2]}")) from error
