"""Rectangular doors and windows with lintels."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from churchpipe.errors import InputError
from churchpipe.generators.fields import as_dataclass, coerce_fields
from churchpipe.model.arrays import FloatArray
from churchpipe.model.building import BondRegion, Opening, UnitCell
from churchpipe.model.quantities import Count, Distance, Length, Whole


@dataclass(frozen=True, slots=True)
class RectangularOpening:
    """A door or window in whole courses."""

    start: Annotated[
        Distance, "Where it begins, along the wall from its outer end with the smaller x (of a wall along y, the smaller y)."
    ]
    width: Annotated[Length, "Clear width."]
    height_courses: Annotated[Count, "Height in courses."]
    lintel_bearing: Annotated[Distance, "Bearing of a lintel of one course on either side; 0: no lintel."] = 0.0
    sill_courses: Annotated[Whole, "Courses below the sill."] = 0

    def __post_init__(self) -> None:
        coerce_fields(self, "opening.")


OpeningLike = RectangularOpening | Mapping[str, Any]


def opening_from(where: str, value: OpeningLike) -> RectangularOpening:
    """Return an opening that is given as such or as a mapping of its fields."""
    return as_dataclass(RectangularOpening, where, value)


def rectangle(s0: float, t0: float, s1: float, t1: float) -> FloatArray:
    """Return the outline (4, 2) m of a rectangle, counter-clockwise."""
    return np.array([[s0, t0], [s1, t0], [s1, t1], [s0, t1]])


def holes_and_lintels(
    where: str, openings: Iterable[OpeningLike], length: float, courses: int, cell: UnitCell
) -> tuple[tuple[Opening, ...], tuple[BondRegion, ...]]:
    """Return the openings of a wall (`length` m, `courses` high) and the lintels over them.

    where: their place in messages, with {} for the number of one of several.

    Raises
    ------
    InputError: an opening or lintel that reaches beyond the wall.
    """
    holes: list[Opening] = []
    lintels: list[BondRegion] = []
    placed: list[RectangularOpening] = []
    for number, given in enumerate(openings, start=1):
        at = where.format(number - 1)
        opening = opening_from(at, given)
        start, stop, bearing = opening.start, opening.start + opening.width, opening.lintel_bearing
        sill, head = opening.sill_courses, opening.sill_courses + opening.height_courses
        if start - bearing < -1e-9 or stop + bearing > length + 1e-9:
            raise InputError(
                at,
                "an opening with its lintel reaches beyond the wall",
                found=f"{start - bearing:g} to {stop + bearing:g} m",
                expected=f"within 0 to {length:g} m",
            )
        if head + (bearing > 0) > courses:
            raise InputError(
                at,
                "an opening with its lintel is higher than the wall",
                found=f"{head + (bearing > 0)} courses",
                expected=f"at most {courses}",
            )
        other = next((o for o in placed if _overlap(o, opening)), None)
        if other is not None:
            raise InputError(
                at,
                "openings overlap",
                found=f"one from {other.start:g} to {other.start + other.width:g} m, one from {start:g} to {stop:g} m",
                expected="openings clear of each other",
            )
        placed.append(opening)
        holes.append(Opening(f"opening-{number}", rectangle(start, sill * cell.a, stop, head * cell.a)))
        if bearing > 0:
            outline = rectangle(start - bearing, head * cell.a, stop + bearing, (head + 1) * cell.a)
            lintels.append(BondRegion(f"lintel-{number}", outline, "single", cell, yields=False))
    return tuple(holes), tuple(lintels)


def _overlap(one: RectangularOpening, other: RectangularOpening) -> bool:
    """Whether two openings, each with its lintel above, share any area."""
    left, right = (o.start - o.lintel_bearing for o in (one, other)), (o.start + o.width + o.lintel_bearing for o in (one, other))
    lows, highs = (o.sill_courses for o in (one, other)), (o.sill_courses + o.height_courses for o in (one, other))
    return max(left) < min(right) - 1e-9 and max(lows) < min(highs)
