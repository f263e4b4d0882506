"""A house: straight outer and inner walls along x and y, each with its own doors and windows."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any

from churchpipe.errors import InputError
from churchpipe.generators.arched import Given
from churchpipe.generators.checks import whole_courses
from churchpipe.generators.fields import as_dataclass, coerce_fields, materials_of
from churchpipe.generators.house_openings import HouseOpening
from churchpipe.generators.house_plan import HouseWall, house_walls
from churchpipe.generators.house_stops import between_stops
from churchpipe.generators.house_storeys import Storey, bonds_of_storeys, junctions_of_storeys, openings_in_storeys
from churchpipe.generators.laying import Bonds, Course, FirstCourse, Joints, Junctions, StoneLength, junctions_of
from churchpipe.generators.layout import WallLayout, wall_panels
from churchpipe.generators.masonry import DEFAULT_MATERIAL
from churchpipe.generators.wall_bonds import Bonding, OwnWall, WallBond, check_walls
from churchpipe.model.building import Building, UnitCell
from churchpipe.model.materials import UnitWeight
from churchpipe.model.quantities import Length


@dataclass(frozen=True, slots=True)
class HouseParameters:
    """A house of straight walls along x and y, called as its table of walls calls them. All stand on z = 0 and are toothed where
    they meet."""

    course: Course
    stone_length: StoneLength
    height: Annotated[Length, "Height of the walls."]
    thickness: Annotated[Length, "Thickness of the walls."]
    walls: Annotated[Sequence[HouseWall | Given], "Its walls, outer and inner."]
    openings: Annotated[Sequence[HouseOpening | Given], "Doors and windows."] = ()
    bonds: Bonds = ()
    junctions: Junctions = ()
    joints: Joints = "bay"
    first_course: FirstCourse = "x"

    def __post_init__(self) -> None:
        coerce_fields(self, "house.")
        whole_courses("house.height", self.height, self.course)

    @property
    def own_walls(self) -> tuple[HouseWall, ...]:
        """Its walls, checked each by itself."""
        walls = tuple(as_dataclass(HouseWall, f"house.walls.{k}", wall) for k, wall in enumerate(self.walls))
        if not walls:
            raise InputError("house.walls", "no walls", expected="at least one")
        names: list[str] = []
        for number, wall in enumerate(walls):
            if {*wall.names} & {*names}:
                raise InputError(f"house.walls.{number}.name", "two walls of one name", found=wall.name, expected="one each")
            names += wall.names
            if wall.height is not None:
                whole_courses(f"wall {wall.name}: height", wall.height, self.course)
        return tuple(self._in_courses(wall) for wall in walls)

    def _in_courses(self, wall: HouseWall) -> HouseWall:
        """Return a wall whose storeys begin where a course does."""
        storeys: list[Storey] = []
        for number, storey in enumerate(wall.own_storeys):
            whole_courses(f"wall {wall.name}: storeys.{number}.above", storey.above, self.course)
            # Products of whole numbers, as the levels of the courses are.
            storeys.append(replace(storey, above=round(storey.above / self.course) * self.course))
        return replace(wall, storeys=storeys)

    @property
    def layouts(self) -> list[WallLayout]:
        """The storeys of its walls as they meet."""
        return house_walls(self.own_walls, self.thickness, self.height, self.stone_length, x_first=self.first_course == "x")

    @property
    def storeys_above(self) -> dict[str, tuple[str, float]]:
        """Of each wall that another storey stands on the name of that, and the height at which it begins, m."""
        return {
            below: (upper, storey.above)
            for wall in self.own_walls
            for below, upper, storey in zip(wall.names[:-1], wall.names[1:], wall.own_storeys, strict=True)
        }

    def bonding(self, material: str) -> Bonding:
        """Return how its walls are laid, without what they have of their own. material: its name."""
        cell = UnitCell(a=self.course, b=self.stone_length)
        given = [as_dataclass(HouseOpening, f"house.openings.{k}", value) for k, value in enumerate(self.openings)]
        for k, opening in enumerate(given):
            if any(opening.name == other.name and set(opening.walls) & set(other.walls) for other in given[:k]):
                expected = "one each; several places of one opening are a list in centre or sill"
                raise InputError(
                    f"house.openings.{k}.name", "two openings of one name in a wall", found=opening.name, expected=expected
                )
        bonds = tuple(as_dataclass(WallBond, f"house.bonds.{k}", value) for k, value in enumerate(self.bonds))
        return Bonding(cell, self.joints, material, tuple(one for opening in given for one in opening.laid(cell)), bonds)


def house(*, name: str = "house", materials: tuple[UnitWeight, ...] = (DEFAULT_MATERIAL,), **parameters: Any) -> Building:
    """Return a house; keywords: its keys in docs/reference_case.md, without unit, SI.

    Raises
    ------
    InputError: walls that do not fit together; an opening that does not fit into its wall; heights of sills, heads and lintels
        that are no whole number of courses.
    """
    p = as_dataclass(HouseParameters, "house", parameters)
    materials = materials_of("house", materials)
    walls, layouts = p.own_walls, iter(p.layouts)
    storeys = {wall.name: [next(layouts) for _ in wall.names] for wall in walls}
    own = [OwnWall(wall.names, material=wall.material) for wall in walls]
    thinner = [OwnWall(wall.names[1 + k], material=one.material) for wall in walls for k, one in enumerate(wall.own_storeys)]
    bonding = replace(p.bonding(materials[0].name), walls=(*thinner, *own))
    check_walls(bonding, [name for wall in walls for name in wall.names], "house")
    layouts = [layout for wall in storeys.values() for layout in wall]
    openings = between_stops(openings_in_storeys(bonding.openings, storeys), layouts, bonding.cell)
    bonding = replace(bonding, openings=openings, bonds=bonds_of_storeys(bonding.bonds, storeys))
    panels = tuple(wall_panels(layouts, bonding))
    junctions = junctions_of_storeys(junctions_of("house", p.junctions), storeys)
    return Building(name, panels, materials, junctions=junctions)
