"""The parts of a church, described as an engineer would list them."""

from dataclasses import dataclass
from typing import Any, Literal

from churchpipe.generators.fields import as_dataclass, coerce_fields
from churchpipe.model.quantities import Coordinate, Length


@dataclass(frozen=True, slots=True)
class Nave:
    """Two side walls: width between their centrelines, length from the facade's centreline (y = 0) to that of the next cross
    wall, height of the eaves, thickness, m."""

    width: Length
    length: Length
    height: Length
    thickness: Length


@dataclass(frozen=True, slots=True)
class CrossWall:
    """A wall across the nave: thickness, m, and the height of the ridge of its gable, m (None: level with the eaves). Gables
    slope from the outer faces of the side walls."""

    thickness: Length
    ridge: Length | None = None


@dataclass(frozen=True, slots=True)
class Transept:
    """Two arms behind the triumphal wall: width over all, depth between the centrelines of the walls before and behind them,
    thickness of the outer walls, height of the arms' eaves (None: that of the nave), m."""

    width: Length
    depth: Length
    thickness: Length
    height: Length | None = None


@dataclass(frozen=True, slots=True)
class Choir:
    """What lies behind the transept of a Latin cross: length from the wall before it to the end wall, centrelines, m."""

    length: Length


@dataclass(frozen=True, slots=True)
class Tower:
    """A bell tower that rises out of one arm of the transept, whose walls are made higher: height, width over all, m (None: the
    whole arm, up to the inner face of the nave's side wall)."""

    height: Length
    side: Literal["left", "right"] = "left"
    width: Length | None = None


@dataclass(frozen=True, slots=True)
class Chapel:
    """One arm of the transept with a height of its own, m."""

    height: Length
    side: Literal["left", "right"] = "right"


@dataclass(frozen=True, slots=True)
class Apse:
    """A half round of masonry behind the end wall: inner radius, thickness, height, x of its middle, m."""

    inner_radius: Length
    thickness: Length
    height: Length
    centre: Coordinate = 0.0


def part_of(kind: type[Any], where: str, value: Any) -> Any:
    """Return a part that is given as such or as a mapping of its fields, its fields checked; None for None."""
    if value is None:
        return None
    value = as_dataclass(kind, where, value)
    coerce_fields(value, f"{where}.")
    return value
