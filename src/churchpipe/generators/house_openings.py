"""Doors and windows of a house: under a lintel, or under a ring of voussoirs; in one or several storeys and walls."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Literal, get_args

from churchpipe.bond.slivers import LEAST_WIDTH
from churchpipe.errors import InputError
from churchpipe.generators.arched import ArchedOpening, Hole, InWalls, Shape, WallOpening
from churchpipe.generators.checks import whole_courses
from churchpipe.generators.fields import coerce_fields
from churchpipe.generators.layout import CLOSE
from churchpipe.generators.openings import rectangle
from churchpipe.model.arguments import text
from churchpipe.model.building import BondRegion, Opening, UnitCell
from churchpipe.model.quantities import Coordinate, Count, Distance, Length

# Of each wall, where a lintel may end: s, and from which z to which one, m.
Stops = Mapping[str, Sequence[tuple[float, float, float]]]
_OF_LINTELS = ("lintel_bearing", "lintel_height", "lintel_material")
_OF_RINGS = ("voussoirs", "depth")
_BEARING = "Of the lintel on either side; by default about half a stone, up to a wall beside it if that is as near."


@dataclass(frozen=True, slots=True)
class HouseOpening(InWalls):
    """A door or window, once or several times: under a lintel, or under a ring of voussoirs."""

    name: Annotated[str, "For messages, reports and the names of its parts."]
    wall: Annotated[str | Sequence[str], "Name of the wall, or a list of them."]
    centre: Annotated[
        Coordinate | Sequence[Coordinate],
        "x in walls along x, y in walls along y, not from the end of the wall as `along_m`; one or several.",
    ]
    width: Annotated[Length, "Clear width."]
    height: Annotated[Length | None, "From the sill to the lintel, or to the crown of the arch; of a circle left out."] = None
    sill: Annotated[Distance | Sequence[Distance], "Height of the sill over z = 0; one or several, such as one a storey."] = (
        0.0,
    )
    shape: Annotated[Literal["flat", Shape], "Flat under a lintel, or the shape of the arch."] = "flat"
    lintel_bearing: Annotated[Length | None, _BEARING] = None
    lintel_height: Annotated[Length | None, "A whole number of courses; by default one."] = None
    lintel_material: Annotated[str | None, "Name of its material; by default that of the wall."] = None
    rise: Annotated[Length | None, "Rise of a segmental or pointed arch, within the height."] = None
    voussoirs: Annotated[Count | None, "Number of voussoirs in the whole ring of an arch."] = None
    depth: Annotated[Length | None, "Depth of the voussoirs."] = None

    def __post_init__(self) -> None:
        where = f"opening {text('opening: name', self.name)}"
        coerce_fields(self, f"{where}: ")
        for key, places in (("wall", self.walls), ("centre", self.centres), ("sill", self.sills)):
            if not places:
                raise InputError(f"{where}: {key}", "the opening is nowhere", expected="at least one")
        flat = self.shape == "flat"
        shapes = ", ".join(f'"{shape}"' for shape in get_args(Shape)) if flat else '"flat"'
        for key in (*_OF_RINGS, "rise") if flat else _OF_LINTELS:
            if getattr(self, key) is not None:
                problem = "a flat head has a lintel and no voussoirs" if flat else "an arch has voussoirs and no lintel"
                raise InputError(f"{where}: {key}", problem, expected=f"shape = {shapes}, or no {key}")
        for key in () if flat else _OF_RINGS:
            if getattr(self, key) is None:
                raise InputError(f"{where}: {key}", "missing", found=f'shape = "{self.shape}"', expected="a ring of voussoirs")
        if (self.height is None) != (self.shape == "circle"):
            expected = "a height of all shapes but a circle, whose height is its width"
            raise InputError(f"{where}: height", "given or left out wrongly", found=self.height, expected=expected)
        if (self.rise is not None) != (self.shape in ("segmental", "pointed")):
            expected = "a rise of segmental and pointed arches"
            raise InputError(f"{where}: rise", "given or left out wrongly", found=self.rise, expected=expected)
        if not flat and self.height is not None and not self.height > self.arch_rise:
            expected = f"> {self.arch_rise:g} m, the rise of its arch"
            raise InputError(f"{where}: height", "no higher than its arch", found=f"{self.height:g} m", expected=expected)

    @property
    def sills(self) -> tuple[float, ...]:
        """The heights of its sill, m."""
        return tuple(self.sill) if isinstance(self.sill, Sequence) else (float(self.sill),)

    @property
    def arch_rise(self) -> float:
        """Height of the crown over the springing, m; of a circle over its centre."""
        return self.width / 2 if self.rise is None else self.rise

    def laid(self, cell: UnitCell) -> Iterator[WallOpening]:
        """Yield the openings of each storey, in the order of their sills. cell: of the walls around them.

        Raises
        ------
        InputError: a sill, head or lintel that is no whole number of courses high.
        """
        for number, sill in enumerate(self.sills, start=1):
            name = f"{self.name}-{number}" if len(self.sills) > 1 else self.name
            yield self._flat(name, sill, cell) if self.shape == "flat" else self._arched(name, sill)

    def _flat(self, name: str, sill: float, cell: UnitCell) -> "FlatOpening":
        where, head = f"opening {self.name}", sill + (self.height or 0.0)
        lintel = cell.a if self.lintel_height is None else self.lintel_height
        for key, level in (("sill", sill), ("sill + height", head), ("lintel_height", lintel)):
            whole_courses(f"{where}: {key}", level, cell.a)
        # Products of whole numbers, as the levels of the courses are.
        low, high, top = (round(level / cell.a) * cell.a for level in (sill, head, head + lintel))
        return FlatOpening(
            name,
            self.walls,
            self.centres,
            self.width,
            (low, high, top),
            self.lintel_bearing,
            self.lintel_material or "",
            cell,
        )

    def _arched(self, name: str, sill: float) -> ArchedOpening:
        rise, shape = self.arch_rise, self.shape
        # Checked as it was made.
        assert shape != "flat"
        assert self.voussoirs is not None
        assert self.depth is not None
        return ArchedOpening(
            name=name,
            wall=self.walls,
            centre=self.centres,
            width=self.width,
            springing=sill + (rise if self.height is None else self.height - rise),
            voussoirs=self.voussoirs,
            depth=self.depth,
            sill=0.0 if shape == "circle" else sill,
            shape=shape,
            rise=self.rise,
        )


@dataclass(frozen=True, slots=True)
class FlatOpening:
    """A rectangular opening under a lintel of one stone, once or several times along some walls, m.

    levels: z of the sill, of the head, and of the top of the lintel. bearing: of the lintel on either side; None: half a stone,
    or up to the nearest stop. material: its name, empty for that of the wall. cell: of the walls around it. stops: of each wall.
    """

    name: str
    walls: tuple[str, ...]
    centres: tuple[float, ...]
    width: float
    levels: tuple[float, float, float]
    bearing: float | None
    material: str
    cell: UnitCell
    stops: Stops = field(default_factory=dict[str, Sequence[tuple[float, float, float]]])

    def hole(self, wall: str, centre: float, name: str, /) -> Hole:
        """Return it as it is at one of its places, m, in one of its walls."""
        (low, head, top), start, stop = self.levels, centre - self.width / 2, centre + self.width / 2
        stops = [place for place, foot, crown in self.stops.get(wall, ()) if foot < top - CLOSE and crown > head + CLOSE]
        left = self._bearing([start - place for place in stops])
        right = self._bearing([place - stop for place in stops])
        outer = (start - left, head, stop + right, top)
        # One stone has no joints in it along which the shell could yield.
        lintel = BondRegion(f"{name}-lintel", rectangle(*outer), "single", self.cell, yields=False, material=self.material)
        opening = Opening(name, rectangle(start, low, stop, head))
        return Hole(opening, (lintel,), (outer[0], low, outer[2], top))

    def _bearing(self, room: Sequence[float]) -> float:
        """Return the bearing on one side, m, with so much room up to each stop; no sliver is left between lintel and stop."""
        if self.bearing is not None:
            return self.bearing
        half, least = self.cell.b / 2, LEAST_WIDTH * self.cell.b
        return next((one for one in room if least - CLOSE <= one < half + least - CLOSE), half)
