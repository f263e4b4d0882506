"""Ties as an engineer describes them: a bar of steel, its plates, and where it is anchored."""

from dataclasses import dataclass
from typing import Annotated, Any

import numpy.typing as npt

from churchpipe.errors import InputError
from churchpipe.model.arguments import describe, finite, text
from churchpipe.model.arrays import floats, store
from churchpipe.model.carried import FROM_ITS_END, Metres, Point
from churchpipe.model.doubts import doubt_fields
from churchpipe.model.quantities import Quantity, Usual, in_range

STEEL_MODULUS = 210e9
_BREAKS = Usual(0.002, 0.5, "steel breaks at some 0.05 to 0.25")
_Plate = Annotated[float, Quantity("_mm", 0.0, above=True, usual=Usual(20, 3000, "washers to cast anchors and beams"))]
_BEARING = Usual(0.05, 50, "rubble bears some 1, brickwork 2 to 4, ashlar 6 and more")
_PUNCHING = Usual(0.005, 5, "mortars of lime have some 0.05, of cement up to 0.5")
# Punching counts as near an edge where the pyramid lacks more than this share of its perimeter.
_ALL_ROUND = 1e-6
_STIFF = Usual(20, 300, "fibres to steel")


@dataclass(frozen=True, slots=True)
class AnchorPlace:
    """Where a bar is anchored: a place on a wall, or a point.

    Parameters
    ----------
    wall
        Name of the wall.
    along
        m along it, from its end with the smaller x (of a wall along y, the smaller y).
    height
        m above z = 0.
    at
        In place of a wall: the point (3,) m.

    Raises
    ------
    InputError
        Neither or both of them, or half of one.
    """

    wall: Annotated[str | None, "The wall."] = None
    along: Annotated[Metres | None, f"Along it, {FROM_ITS_END}."] = None
    height: Annotated[Metres | None, "Above z = 0."] = None
    at: Annotated[Point | None, Quantity("_m"), "In place of a wall: the point."] = None

    def __post_init__(self) -> None:
        if self.at is not None:
            if any(value is not None for value in (self.wall, self.along, self.height)):
                raise InputError("place", "two places", found="a wall and a point", expected="one of them")
            store(self, at=tuple(floats("place: at", self.at, (3,)).tolist()))
            return
        if self.wall is None or self.along is None or self.height is None:
            raise InputError("place", "no place", expected="wall, along and height; or at, a point")
        text("place: wall", self.wall)
        for key in ("along", "height"):
            store(self, **{key: finite(f"place on {self.wall}: {key}", getattr(self, key))})


@dataclass(frozen=True, slots=True)
class TieBar:
    """A steel bar between two anchors.

    Parameters
    ----------
    name
        What messages and results call it.
    start, end
        `AnchorPlace`, or in short a point (3,) m or (wall, along, height). A bar that crosses the wall of a place goes through
        it, to an anchor on its far face.
    area
        Of the steel, m2.
    steel_strength
        Its yield strength, Pa.
    plate
        Width and height of the anchor plates, m; None: without plates, anchored in the stones at its ends.
    bearing_strength
        Of the masonry under the plates, Pa; None: bearing is not checked.
    punching_strength
        Shear strength of the masonry around a plate that is pulled through, Pa; None: punching is not checked.
    pretension
        N; it changes no load factor.
    modulus
        Of the steel, Pa.
    ultimate_strain
        Elongation over length at which it breaks; None: never.

    Raises
    ------
    InputError
        Numbers out of range, masonry strengths without a plate, no place.
    """

    name: Annotated[str, "For messages and tables."]
    start: Annotated[AnchorPlace, "Where it is anchored; through a wall that it crosses, to the far face."]
    end: Annotated[AnchorPlace, "Likewise its other end."]
    area: Annotated[float, Quantity("_mm2", 0.0, above=True, usual=Usual(20, 20000, "bars of 5 to 160 mm")), "Of the steel."]
    steel_strength: Annotated[
        float,
        Quantity("_MPa", 0.0, above=True, usual=Usual(50, 2500, "wrought iron to prestressing strands")),
        "Yield strength of the steel.",
    ]
    plate: Annotated[tuple[_Plate, _Plate] | None, "Width and height of its plates; left out: anchored in the stones."] = None
    bearing_strength: Annotated[
        float | None, Quantity("_MPa", 0.0, above=True, usual=_BEARING), "Of the masonry under the plates; left out: not checked."
    ] = None
    punching_strength: Annotated[
        float | None,
        Quantity("_MPa", 0.0, above=True, usual=_PUNCHING),
        "Shear strength of the masonry around a plate; left out: not checked.",
    ] = None
    pretension: Annotated[float, Quantity("_kN", 0.0), "It changes no load factor."] = 0.0
    modulus: Annotated[float, Quantity("_GPa", 0.0, above=True, usual=_STIFF), "Of the steel."] = STEEL_MODULUS
    ultimate_strain: Annotated[
        float | None, Quantity("", 0.0, above=True, usual=_BREAKS), "Strain at which it breaks; left out: never."
    ] = None

    def __init__(
        self,
        name: str,
        start: "AnchorPlace | tuple[str, float, float] | npt.ArrayLike",
        end: "AnchorPlace | tuple[str, float, float] | npt.ArrayLike",
        *,
        area: float,
        steel_strength: float,
        plate: tuple[float, float] | None = None,
        bearing_strength: float | None = None,
        punching_strength: float | None = None,
        pretension: float = 0.0,
        modulus: float = STEEL_MODULUS,
        ultimate_strain: float | None = None,
    ) -> None:
        where = f"tie {text('TieBar.name', name)}"
        store(self, name=name, start=_place(f"{where}: start", start), end=_place(f"{where}: end", end))
        numbers = {"area": area, "steel_strength": steel_strength, "modulus": modulus, "pretension": pretension}
        numbers |= {
            key: value
            for key, value in (
                ("bearing_strength", bearing_strength),
                ("punching_strength", punching_strength),
                ("ultimate_strain", ultimate_strain),
            )
            if value is not None
        }
        for key, value in numbers.items():
            in_range(TieBar, key, f"{where}: {key}", value)
        sides = None
        if plate is not None:
            width, height = floats(f"{where}: plate", plate, (2,)).tolist()
            for side in (width, height):
                in_range(TieBar, "plate", f"{where}: plate", side)
            sides = width, height
        elif bearing_strength is not None or punching_strength is not None:
            raise InputError(
                where, "no plate", found="a strength of the masonry under it", expected="plate, its width and height"
            )
        store(self, area=float(area), steel_strength=float(steel_strength), plate=sides, pretension=float(pretension))
        store(self, bearing_strength=bearing_strength, punching_strength=punching_strength)
        store(self, modulus=float(modulus), ultimate_strain=ultimate_strain)
        doubt_fields(self)

    def capacity(
        self,
        thickness: tuple[float | None, float | None] = (None, None),
        edge: tuple[float | None, float | None] = (None, None),
    ) -> tuple[float, str]:
        """Return the largest tension, N, and what governs it.

        The least of the yield of the steel A f_y; of what the masonry bears under a plate of b x h, f_c b h; and of what holds a
        truncated pyramid at 45 degrees in a wall of thickness t, punched out by the plate: its edge half way through times t f_v.

        Parameters
        ----------
        thickness
            Of the walls at start and end, m; None where a wall is not punched.
        edge
            How much of the pyramid's perimeter there lies within masonry, m (`geometry.punching`); None: all of it,
            2 (b + h + 2 t).
        """
        found = [(self.area * self.steel_strength, "yield of the steel")]
        if self.plate:
            width, height = self.plate
            if self.bearing_strength:
                found.append((self.bearing_strength * width * height, "bearing under the plates"))
            for end, t, within in zip(("start", "end"), thickness, edge, strict=True):
                if self.punching_strength and t is not None:
                    around = 2 * (width + height + 2 * t)
                    near = within is not None and within < around * (1 - _ALL_ROUND)
                    sheared = within if near and within is not None else around
                    place = " near its edge" if near else ""
                    found.append((self.punching_strength * sheared * t, f"punching of the wall at its {end}{place}"))
        return min(found, key=lambda item: item[0])


def _place(where: str, value: Any) -> AnchorPlace:
    if isinstance(value, AnchorPlace):
        return value
    expected = "x, y, z m, or (wall, m along it, m above z = 0), or an AnchorPlace"
    if isinstance(value, dict):
        raise InputError(where, "no place", found="dict", expected=expected)
    try:
        wall, along, height = value
    except (TypeError, ValueError) as error:
        raise InputError(where, "no place", found=describe(value), expected=expected) from error
    try:
        return AnchorPlace(wall, along, height) if isinstance(wall, str) else AnchorPlace(at=(wall, along, height))
    except InputError as error:
        raise error.at(where) from error
