"""A church on a Latin cross or a T: facade, nave, triumphal arch, transept, choir, apses, chapel and bell tower."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any

from churchpipe.errors import InputError
from churchpipe.generators.apse import apse_legs, apse_panel
from churchpipe.generators.arched import Given, holes
from churchpipe.generators.checks import whole_courses
from churchpipe.generators.church_parts import Apse, Chapel, Choir, CrossWall, Nave, Tower, Transept, part_of
from churchpipe.generators.church_plan import Plan, church_walls, cross_walls
from churchpipe.generators.fields import as_dataclass, coerce_fields, materials_of
from churchpipe.generators.laying import Bonds, Course, FirstCourse, Joints, Junctions, Openings, StoneLength, Walls, junctions_of
from churchpipe.generators.layout import WallLayout, check_clear, wall_panels
from churchpipe.generators.masonry import DEFAULT_MATERIAL
from churchpipe.generators.room_vaults import room_vaults
from churchpipe.generators.rooms import RoomVault
from churchpipe.generators.wall_bonds import Bonding, OwnWall, bonding_of, check_walls, own
from churchpipe.model.building import Building, Panel
from churchpipe.model.materials import UnitWeight


@dataclass(frozen=True, slots=True)
class ChurchParameters:
    """A church from its parts; x across the nave, y along it from the middle of the facade. Only the nave is needed. Its
    walls are facade, nave_left, nave_right, triumphal_arch, transept_left, transept_right, choir_arch, east and tower_inner,
    as far as these stand.
    """

    course: Course
    stone_length: StoneLength
    nave: Annotated[Nave | Given, "The two side walls."]
    facade: Annotated[CrossWall | Given | None, "Wall at the front."] = None
    triumphal_arch: Annotated[CrossWall | Given | None, "Wall between nave and transept."] = None
    transept: Annotated[Transept | Given | None, "Two arms behind the triumphal arch."] = None
    choir_arch: Annotated[CrossWall | Given | None, "Wall between transept and choir."] = None
    choir: Annotated[Choir | Given | None, "What lies behind the transept of a Latin cross."] = None
    east: Annotated[CrossWall | Given | None, "The end wall."] = None
    tower: Annotated[Tower | Given | None, "Bell tower over one arm of the transept."] = None
    chapel: Annotated[Chapel | Given | None, "An arm of the transept with a height of its own."] = None
    apses: Annotated[Sequence[Apse | Given], "Apses behind the end wall."] = ()
    openings: Openings = ()
    bonds: Bonds = ()
    walls: Walls = ()
    junctions: Junctions = ()
    vaults: Annotated[Sequence[RoomVault | Given], "Vaults over rooms and apses."] = ()
    joints: Joints = "bay"
    first_course: FirstCourse = "x"

    def __post_init__(self) -> None:
        coerce_fields(self, "church.")

    @property
    def plan(self) -> Plan:
        """The parts, checked."""
        walls = tuple(as_dataclass(OwnWall, f"church.walls.{k}", wall) for k, wall in enumerate(self.walls))
        plan = Plan(
            stone_length=self.stone_length,
            nave=part_of(Nave, "church.nave", self.nave),
            facade=_cross_wall("facade", self.facade, walls),
            triumphal_arch=_cross_wall("triumphal_arch", self.triumphal_arch, walls),
            transept=part_of(Transept, "church.transept", self.transept),
            choir_arch=_cross_wall("choir_arch", self.choir_arch, walls),
            choir=part_of(Choir, "church.choir", self.choir),
            east=_cross_wall("east", self.east, walls),
            tower=part_of(Tower, "church.tower", self.tower),
            chapel=part_of(Chapel, "church.chapel", self.chapel),
            apses=tuple(part_of(Apse, f"church.apses.{k}", apse) for k, apse in enumerate(self.apses)),
            x_first=self.first_course == "x",
            walls=walls,
        )
        for name in ("nave", "transept", "tower", "chapel"):
            height = getattr(getattr(plan, name), "height", None)
            if height is not None:
                whole_courses(f"church.{name}.height", height, self.course)
        for number, wall in enumerate(walls):
            if wall.height is not None:
                whole_courses(f"church.walls.{number}.height", wall.height, self.course)
                for name in sorted(set(wall.walls) - {"nave_left", "nave_right"}):
                    expected = "nave_left or nave_right; of walls across the nave, `ridge`; of others, that of their part"
                    raise InputError(
                        f"church.walls.{number}.height", "no wall with eaves of its own", found=name, expected=expected
                    )
        return plan


def _cross_wall(name: str, value: Any, walls: Sequence[OwnWall]) -> Any:
    """Return a wall across the nave, with the thickness that it has of its own."""
    part = part_of(CrossWall, f"church.{name}", value)
    return part and replace(part, thickness=own(walls, name, "thickness", part.thickness))


def church(*, name: str = "church", materials: tuple[UnitWeight, ...] = (DEFAULT_MATERIAL,), **parameters: Any) -> Building:
    """Return a church; keywords: its keys in docs/reference_case.md, without unit, SI.

    Raises
    ------
    InputError: parts that clash, with the numbers: an opening wider than its wall, a tower wider than its arm.
    """
    p = as_dataclass(ChurchParameters, "church", parameters)
    materials = materials_of("church", materials)
    plan = p.plan
    bonding = replace(bonding_of("church", p, materials[0].name), walls=plan.walls)
    walls = church_walls(plan)
    check_walls(bonding, [*(wall.name for wall in walls), *plan.apse_names], "church")
    apses, legs = _apses(plan, bonding, walls, p.course)
    over = [as_dataclass(RoomVault, f"church.vaults.{number}", vault) for number, vault in enumerate(p.vaults)]
    openings = {wall.name: holes(bonding.openings, wall.name) for wall in walls}
    vaults = room_vaults(plan, walls, over, p.stone_length, materials[0].name, openings)
    panels = (*wall_panels(walls, bonding, legs), *apses)
    return Building(name, panels, materials, vaults=tuple(vaults), junctions=junctions_of("church", p.junctions))


def _apses(plan: Plan, bonding: Bonding, walls: Sequence[WallLayout], course: float) -> tuple[list[Panel], list[WallLayout]]:
    """Return the apses, and what their legs take up of the end wall."""
    panels: list[Panel] = []
    legs: list[WallLayout] = []
    if not plan.apses or plan.east is None:
        return panels, legs
    end = next(wall for wall in walls if wall.name == "east")
    face, thickness = cross_walls(plan)[-1][2] + plan.east.thickness / 2, plan.east.thickness
    for name, apse in zip(plan.apse_names, plan.apses, strict=True):
        whole_courses(f"church.{name}.height", apse.height, course)
        own = apse_legs(name, (apse.centre, face), apse.inner_radius, apse.thickness, apse.height, thickness)
        for leg in own:
            check_clear(leg, end, [*(wall for wall in walls if wall.along == "y"), *legs], f"church.{name}")
        legs += own
        panels.append(
            apse_panel(
                name,
                bonding,
                (apse.centre, face),
                apse.inner_radius,
                apse.thickness,
                apse.height,
                legs=thickness,
                runs_through=1 if plan.x_first else 0,
            )
        )
    return panels, legs
