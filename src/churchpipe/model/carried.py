"""What a building carries besides its own stones: roofs, floors, point loads, soil and water. SI; by the names of walls."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy.typing as npt

from churchpipe.errors import InputError
from churchpipe.model.arguments import check_order, finite, listed, text
from churchpipe.model.arrays import FloatArray, ReadOnly, floats, store
from churchpipe.model.doubts import doubt_fields
from churchpipe.model.load_places import Toward, called, level, named, on_wall_or_at, points, store_numbers
from churchpipe.model.quantities import Quantity, Usual, in_range

Metres = Annotated[float, Quantity("_m")]
Point = tuple[Metres, Metres, Metres]
FROM_ITS_END = "from its end with the smaller x (of a wall along y, the smaller y)"
_ALONG = f"Along the wall, {FROM_ITS_END}; of a vault along its longer side in plan"
_TOWARD = "A level vector: where the thrust points, and to which side of the wall the eccentricity counts."
_MASS = "Weight that the load factor multiplies; by default the dead load."
_FROM = f"Of two walls: along the first, {FROM_ITS_END}. By default that end itself, over a cross wall there, too."
_ON_A_LINE = Usual(0, 500, "roofs bring some 5, vaults and several floors up to 100")
_LEVEL_ON_A_LINE = Usual(-200, 200, "rafters push with some 2, vaults with up to 100")
_AT_A_POINT = Usual(0, 5000, "beams bring 10 to 100, columns of upper storeys some hundreds")
_LEVEL_AT_A_POINT = Usual(-2000, 2000, "ropes, props and arches push and pull with some 10 to 500")
_EARTH = Usual(0, 15, "active earth pressure has 0.2 to 0.5, water 1, passive up to 10")
SURFACE = Usual(-50, 50, "ground and water beside buildings")
_ON_SOIL = Usual(0, 200, "traffic brings some 10, buildings beside the wall up to 100")
_RISE = Quantity("_m", 0.0, usual=Usual(0, 15, "chimneys and pinnacles have .5 to 3"), key="centroid_above_m")
_ON_AN_AREA = Usual(0, 50, "roofs have 1 to 3, floors with what stands on them up to 15")


@dataclass(frozen=True, slots=True)
class LineLoad(ReadOnly):
    """A load along a wall: on its top, or at a height.

    Parameters
    ----------
    wall
        Its name, as the stones have it.
    between
        In place of a wall: two points (2, 3) m at one height on the stones that bear it.
    begin, end
        m along the wall from the end with the smaller x (of a wall along y, the smaller y); None: the wall's own ends.
    height
        m above z = 0; None: the top of the wall.
    dead
        Downwards, N/m.
    thrust
        Level, N/m, in the direction `toward`.
    toward
        "+x", "-x", "+y", "-y" or a level vector (3,): where the thrust points, and to which side of the wall an eccentricity
        counts.
    eccentricity
        m from the middle of the wall.
    mass
        Weight, N/m, that the lateral load multiplies; None: that of `dead`.
    rise
        m from where it bears up to the centroid of what stands there: weight and mass act there, a thrust below.
    name
        What messages and results call it; by default the name of the wall.

    Raises
    ------
    InputError
        No load, dead loads or masses below zero, a thrust or an eccentricity that points nowhere.
    """

    name: Annotated[str, "For messages and tables; by default that of the wall."] = ""
    wall: Annotated[str | None, "The wall that bears it."] = None
    between: Annotated[tuple[Point, Point] | None, Quantity("_m"), "In place of a wall: two points at one height."] = None
    begin: Annotated[Metres | None, Quantity("_m", key="from_m"), f"{_ALONG}; by default its own end."] = None
    end: Annotated[Metres | None, Quantity("_m", key="to_m"), "Likewise its other end."] = None
    height: Annotated[Metres | None, "Above z = 0; by default the top of the wall."] = None
    dead: Annotated[float, Quantity("_kN_m", 0.0, usual=_ON_A_LINE), "Downwards."] = 0.0
    thrust: Annotated[float, Quantity("_kN_m", usual=_LEVEL_ON_A_LINE), "Level, in the direction `toward`."] = 0.0
    toward: Annotated[FloatArray | None, _TOWARD] = None
    eccentricity: Annotated[Metres, "From the middle of the wall."] = 0.0
    mass: Annotated[float | None, Quantity("_kN_m", 0.0, usual=_ON_A_LINE, key="seismic_mass_kN_m"), _MASS] = None
    rise: Annotated[float, _RISE, "Height of its centroid above where it stands, as of a chimney or a parapet."] = 0.0

    def __init__(
        self,
        wall: str | None = None,
        *,
        between: npt.ArrayLike | None = None,
        begin: float | None = None,
        end: float | None = None,
        height: float | None = None,
        dead: float = 0.0,
        thrust: float = 0.0,
        toward: Toward | None = None,
        eccentricity: float = 0.0,
        mass: float | None = None,
        rise: float = 0.0,
        name: str = "",
    ) -> None:
        where = named(self, "line load", name, wall)
        aside = finite(f"{where}: eccentricity", eccentricity) or None
        on_wall_or_at(where, "between", wall, between, begin=begin, end=end, height=height, eccentricity=aside)
        check_order(where, begin, end)
        store(self, wall=wall, between=None if between is None else points(floats(f"{where}: between", between, (2, 3))))
        store_numbers(self, where, begin=begin, end=end, height=height)
        _store_load(self, where, dead, thrust, toward, eccentricity, mass)
        store(self, rise=in_range(self.__class__, "rise", f"{where}: rise", rise))
        doubt_fields(self)

    @property
    def called(self) -> str:
        """What messages call it."""
        return called("line load", self.name, self.wall)

    @property
    def pushed(self) -> float:
        """What the load factor multiplies, as `mass`."""
        return self.dead if self.mass is None else self.mass


@dataclass(frozen=True, slots=True)
class PointLoad(ReadOnly):
    """A load at a point of a wall: on its top, or at a height.

    Parameters
    ----------
    wall
        Its name, as the stones have it.
    along
        m along the wall, as in `LineLoad`; of a vault along its longer side in plan, of a square one along x.
    at
        In place of a wall: the point (3,) m.
    height
        m above z = 0; None: the top of the wall.
    dead
        Downwards, N.
    thrust
        Level, N, in the direction `toward`.
    toward
        "+x", "-x", "+y", "-y" or a level vector (3,): where the thrust points, and to which side of the wall an eccentricity
        counts.
    eccentricity
        m from the middle of the wall.
    mass
        Weight, N, that the lateral load multiplies; None: that of `dead`.
    rise
        m, as in `LineLoad`.
    name
        What messages and results call it; by default the name of the wall.

    Raises
    ------
    InputError
        As `LineLoad`; a wall without a place on it.
    """

    name: Annotated[str, "For messages and tables; by default that of the wall."] = ""
    wall: Annotated[str | None, "The wall that bears it."] = None
    at: Annotated[Point | None, Quantity("_m"), "In place of a wall: the point."] = None
    along: Annotated[Metres | None, f"{_ALONG}; needed with `wall`."] = None
    height: Annotated[Metres | None, "Above z = 0; by default the top of the wall."] = None
    dead: Annotated[float, Quantity("_kN", 0.0, usual=_AT_A_POINT), "Downwards."] = 0.0
    thrust: Annotated[float, Quantity("_kN", usual=_LEVEL_AT_A_POINT), "Level, in the direction `toward`."] = 0.0
    toward: Annotated[FloatArray | None, _TOWARD] = None
    eccentricity: Annotated[Metres, "From the middle of the wall."] = 0.0
    mass: Annotated[float | None, Quantity("_kN", 0.0, key="seismic_mass_kN"), _MASS] = None
    rise: Annotated[float, _RISE, "Height of its centroid above where it stands, as of a chimney or a parapet."] = 0.0

    def __init__(
        self,
        wall: str | None = None,
        along: float | None = None,
        *,
        at: npt.ArrayLike | None = None,
        height: float | None = None,
        dead: float = 0.0,
        thrust: float = 0.0,
        toward: Toward | None = None,
        eccentricity: float = 0.0,
        mass: float | None = None,
        rise: float = 0.0,
        name: str = "",
    ) -> None:
        where = named(self, "point load", name, wall)
        aside = finite(f"{where}: eccentricity", eccentricity) or None
        on_wall_or_at(where, "at", wall, at, along=along, height=height, eccentricity=aside)
        if wall is not None and along is None:
            raise InputError(where, "no place on the wall", expected="along")
        store(self, wall=wall, at=None if at is None else tuple(floats(f"{where}: at", at, (3,)).tolist()))
        store_numbers(self, where, along=along, height=height)
        _store_load(self, where, dead, thrust, toward, eccentricity, mass)
        store(self, rise=in_range(self.__class__, "rise", f"{where}: rise", rise))
        doubt_fields(self)

    @property
    def called(self) -> str:
        """What messages call it."""
        return called("point load", self.name, self.wall)

    @property
    def pushed(self) -> float:
        """What the load factor multiplies, as `mass`."""
        return self.dead if self.mass is None else self.mass


@dataclass(frozen=True, slots=True)
class AreaLoad:
    """A floor or roof that spans between walls.

    Parameters
    ----------
    walls
        Two parallel ones that it spans between, each bearing half of it; or four around a rectangle, each bearing what is nearest
        to it (lines at 45 degrees from the corners).
    dead
        Downwards, N/m2, on the area between their faces; of two walls from begin to end, over walls across, too.
    begin, end
        Of two walls, m along the first one; None: the length that they have in common.
    height
        m above z = 0 where it bears; None: the tops of the walls.
    bearing
        m from the middle of each wall towards the floor.
    mass
        Weight, N/m2, that the lateral load multiplies; None: that of `dead`.
    name
        What messages and results call it; by default the names of the walls.

    Raises
    ------
    InputError
        Neither two walls nor four, no load, a negative one.
    """

    walls: Annotated[tuple[str, ...], "Two parallel ones that it spans, over cross walls too, or four around a rectangle."]
    name: Annotated[str, "For messages and tables; by default those of the walls."] = ""
    begin: Annotated[Metres | None, Quantity("_m", key="from_m"), _FROM] = None
    end: Annotated[Metres | None, Quantity("_m", key="to_m"), "Likewise its other end."] = None
    height: Annotated[Metres | None, "Where it bears, above z = 0; by default the tops of the walls."] = None
    dead: Annotated[float, Quantity("_kN_m2", 0.0, usual=_ON_AN_AREA), "Downwards, between the faces of the walls."] = 0.0
    bearing: Annotated[float, Quantity("_m", 0.0), "Where it bears: from the middle of each wall towards the floor."] = 0.0
    mass: Annotated[float | None, Quantity("_kN_m2", 0.0, usual=_ON_AN_AREA, key="seismic_mass_kN_m2"), _MASS] = None
    kind: ClassVar[str] = "area load"

    def __init__(
        self,
        walls: Sequence[str],
        *,
        dead: float = 0.0,
        begin: float | None = None,
        end: float | None = None,
        height: float | None = None,
        bearing: float = 0.0,
        mass: float | None = None,
        name: str = "",
    ) -> None:
        over = tuple(listed(f"{self.kind}: walls", walls, str))
        where = named(self, self.kind, name, " ".join(over))
        if len(over) not in (2, 4) or len(set(over)) < len(over):
            raise InputError(f"{where}: walls", "not two walls or four", found=", ".join(over), expected="each over once")
        in_range(AreaLoad, "bearing", f"{where}: bearing", bearing)
        if len(over) == 4 and not (begin is None and end is None):
            raise InputError(where, "a part of a floor between four walls", expected="two walls beside begin and end, or neither")
        check_order(where, begin, end)
        store(self, walls=over, bearing=float(bearing))
        store_numbers(self, where, begin=begin, end=end, height=height)
        _store_load(self, where, dead, 0.0, None, 0.0, mass)
        doubt_fields(self, AreaLoad)

    @property
    def called(self) -> str:
        """What messages call it."""
        return called(self.kind, self.name, " ".join(self.walls))

    @property
    def pushed(self) -> float:
        """What the load factor multiplies, as `mass`."""
        return self.dead if self.mass is None else self.mass


@dataclass(frozen=True, slots=True)
class Pressure(ReadOnly):
    """Soil or water against a wall: coefficient (unit_weight (top - z) + surcharge) on one of its faces below z = top.

    It is a dead load: its mass does not push. What stands in it, as a buttress does, hides a part of that face, and has the same
    pressure on its far end; on the two sides of it, it is in balance, and left out.

    Parameters
    ----------
    wall
        Its name, as the stones have it.
    toward
        Where it pushes, as in `LineLoad`: it acts on the face that looks the other way.
    unit_weight
        N/m3.
    top
        z of its surface, m.
    coefficient
        1 for water; of soil that of active, at-rest or passive pressure.
    surcharge
        Pa, on its surface.
    ends
        Names of walls that stand in it, at whose far ends it presses as well. By default the buttresses among them, which have
        names as `with_buttresses` gives them: "wall buttress 1".
    name
        What messages and results call it; by default the name of the wall.

    Raises
    ------
    InputError
        No pressure, a negative one.
    """

    wall: Annotated[str, "The wall that it presses on."]
    toward: Annotated[FloatArray, "Where it pushes, a level vector: it acts on the face that looks the other way."]
    unit_weight: Annotated[
        float, Quantity("_kN_m3", 0.0, usual=Usual(0, 30, "water has 10, soil 15 to 22")), "Of the soil or water."
    ]
    top: Annotated[float, Quantity("_m", usual=SURFACE), "z of its surface."]
    coefficient: Annotated[
        float, Quantity("", 0.0, usual=_EARTH), "1 for water; of soil that of its pressure, active or at rest."
    ] = 1.0
    surcharge: Annotated[float, Quantity("_kPa", 0.0, usual=_ON_SOIL), "On its surface."] = 0.0
    ends: Annotated[
        tuple[str, ...] | None, "Walls that stand in it, at whose far ends it presses too; left out: the buttresses among them."
    ] = None
    name: Annotated[str, "For messages and tables; by default that of the wall."] = ""

    def __init__(
        self,
        wall: str,
        *,
        toward: Toward,
        unit_weight: float,
        top: float,
        coefficient: float = 1.0,
        surcharge: float = 0.0,
        ends: Iterable[str] | None = None,
        name: str = "",
    ) -> None:
        where = named(self, "pressure", name, text("pressure: wall", wall))
        for key, value in (("unit_weight", unit_weight), ("coefficient", coefficient), ("surcharge", surcharge)):
            in_range(Pressure, key, f"{where}: {key}", value)
        if not coefficient * (unit_weight + surcharge) > 0:
            raise InputError(where, "no pressure", expected="a unit weight or a surcharge, and a coefficient, > 0")
        store(self, wall=wall, toward=level(where, toward), unit_weight=float(unit_weight))
        store(self, coefficient=float(coefficient), surcharge=float(surcharge), top=finite(f"{where}: top", top))
        store(self, ends=None if ends is None else tuple(listed(f"{where}: ends", ends, str)))
        doubt_fields(self)

    @property
    def called(self) -> str:
        """What messages call it."""
        return called("pressure", self.name, self.wall)


Carried = LineLoad | PointLoad | AreaLoad | Pressure


def _store_load(
    load: object, where: str, dead: float, thrust: float, toward: Toward | None, eccentricity: float, mass: float | None
) -> None:
    for key, value in (("dead", dead), ("mass", 0.0 if mass is None else mass)):
        in_range(load.__class__, key, f"{where}: {key}", value)
    finite(f"{where}: thrust", thrust)
    finite(f"{where}: eccentricity", eccentricity)
    if not (dead or thrust or mass):
        kinds = "dead" if isinstance(load, AreaLoad) else "dead, thrust"
        raise InputError(where, "no load", expected=f"{kinds} or mass other than zero")
    if (thrust or eccentricity) and toward is None:
        what = "a thrust" if thrust else "an eccentricity"
        raise InputError(where, f"{what} without a direction", expected="toward, a level vector such as [1, 0, 0]")
    store(load, dead=float(dead), mass=None if mass is None else float(mass))
    if not isinstance(load, AreaLoad):
        side = None if toward is None else level(where, toward)
        store(load, thrust=float(thrust), toward=side, eccentricity=float(eccentricity))
