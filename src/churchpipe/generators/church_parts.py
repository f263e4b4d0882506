"""The parts of a church, described as an engineer would list them."""

from dataclasses import dataclass
from typing import Annotated, Any, Literal

from churchpipe.generators.fields import as_dataclass, coerce_fields
from churchpipe.model.quantities import Coordinate, Length


@dataclass(frozen=True, slots=True)
class Nave:
    """Two side walls."""

    width: Annotated[Length, "Between the centrelines."]
    length: Annotated[Length, "From the centreline of the facade to that of the next wall across."]
    height: Annotated[Length, "Height of the eaves."]
    thickness: Annotated[Length, "Thickness."]


@dataclass(frozen=True, slots=True)
class CrossWall:
    """A wall across the nave. Gables slope from the outer faces of the side walls."""

    thickness: Annotated[Length, "Thickness."]
    ridge: Annotated[Length | None, "Height of the ridge of its gable; by default level with the eaves."] = None


@dataclass(frozen=True, slots=True)
class Transept:
    """Two arms behind the triumphal arch."""

    width: Annotated[Length, "Along x, over all."]
    depth: Annotated[Length, "Between the centrelines of the walls before and behind."]
    thickness: Annotated[Length, "Thickness of the outer walls."]
    height: Annotated[Length | None, "Height of the eaves; by default that of the nave."] = None


@dataclass(frozen=True, slots=True)
class Choir:
    """What lies behind the transept of a Latin cross."""

    length: Annotated[Length, "From the wall before it to the end wall, centrelines."]


@dataclass(frozen=True, slots=True)
class Tower:
    """A bell tower that rises out of one arm of the transept, whose walls are made higher."""

    height: Annotated[Length, "Height."]
    side: Annotated[Literal["left", "right"], "Which arm."] = "left"
    width: Annotated[Length | None, "Along x, over all; by default the whole arm, up to the side wall of the nave."] = None


@dataclass(frozen=True, slots=True)
class Chapel:
    """One arm of the transept with a height of its own."""

    height: Annotated[Length, "Height."]
    side: Annotated[Literal["left", "right"], "Which arm."] = "right"


@dataclass(frozen=True, slots=True)
class Apse:
    """A half round of masonry behind the end wall."""

    inner_radius: Annotated[Length, "Inner radius."]
    thickness: Annotated[Length, "Thickness."]
    height: Annotated[Length, "Height."]
    centre: Annotated[Coordinate, "x of its middle, not from the end of the wall as `along_m` is."] = 0.0


def part_of(kind: type[Any], where: str, value: Any) -> Any:
    """Return a part that is given as such or as a mapping of its fields, its fields checked; None for None."""
    if value is None:
        return None
    value = as_dataclass(kind, where, value)
    coerce_fields(value, f"{where}.")
    return value
