"""Apses: half rounds of masonry, free-standing or behind a wall."""

import math
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np

from churchpipe.generators.checks import whole_courses
from churchpipe.generators.curved import curved_panel
from churchpipe.generators.fields import as_dataclass, coerce_fields, materials_of
from churchpipe.generators.laying import Bonds, Course, FirstCourse, Joints, Openings, StoneLength
from churchpipe.generators.layout import WallLayout, check_clear, wall_panels
from churchpipe.generators.masonry import DEFAULT_MATERIAL
from churchpipe.generators.openings import rectangle
from churchpipe.generators.wall_bonds import Bonding, bonding_of, check_walls
from churchpipe.model.building import Building, CylinderChart, Panel
from churchpipe.model.materials import UnitWeight
from churchpipe.model.quantities import Length


@dataclass(frozen=True, slots=True)
class ApseParameters:
    """An apse behind a wall along x with its middle at x = 0. The walls are called wall and apse."""

    course: Course
    stone_length: StoneLength
    inner_radius: Annotated[Length, "Inner radius of the apse."]
    thickness: Annotated[Length, "Thickness of the apse."]
    height: Annotated[Length, "Height of the apse."]
    wall_length: Annotated[Length, "Length of the wall."]
    wall_thickness: Annotated[Length, "Thickness of the wall."]
    wall_height: Annotated[Length, "Height of the wall."]
    openings: Openings = ()
    bonds: Bonds = ()
    joints: Joints = "bay"
    first_course: FirstCourse = "x"

    def __post_init__(self) -> None:
        coerce_fields(self, "apse.")
        for key in ("height", "wall_height"):
            whole_courses(f"apse.{key}", getattr(self, key), self.course)


def apse(*, name: str = "apse", materials: tuple[UnitWeight, ...] = (DEFAULT_MATERIAL,), **parameters: Any) -> Building:
    """Return an apse behind a wall; keywords: its keys in docs/reference_case.md, without unit, SI."""
    p = as_dataclass(ApseParameters, "apse", parameters)
    materials = materials_of("apse", materials)
    bonding = bonding_of("apse", p, materials[0].name)
    check_walls(bonding, ["wall", "apse"], "apse")
    across, along = (0, 1) if p.first_course == "x" else (1, 0)
    half = p.wall_length / 2
    wall = WallLayout(
        "wall", "x", -p.wall_thickness / 2, p.wall_thickness, ((-half, p.wall_height), (half, p.wall_height)), across
    )
    legs = apse_legs("apse", (0.0, 0.0), p.inner_radius, p.thickness, p.height, p.wall_thickness)
    for leg in legs:
        check_clear(leg, wall, (), "apse")
    round_wall = apse_panel(
        "apse", bonding, (0.0, 0.0), p.inner_radius, p.thickness, p.height, legs=p.wall_thickness, runs_through=along
    )
    return Building(name, (*wall_panels([wall], bonding, legs), round_wall), materials)


def apse_panel(
    name: str,
    bonding: Bonding,
    centre: tuple[float, float],
    inner_radius: float,
    thickness: float,
    height: float,
    *,
    legs: float,
    runs_through: Literal[0, 1],
) -> Panel:
    """Return a half round that bulges towards +y. Its ends continue straight, as legs, into the wall in front of it.

    Parameters
    ----------
    centre: of the half circle, x and y in m. legs: their length, the thickness of the wall that they pass through, m. The rest as
    in `Panel`.
    """
    radius = inner_radius + thickness / 2
    outline = rectangle(-legs, 0.0, math.pi * radius + legs, height)
    chart = CylinderChart(np.array([*centre, 0.0]), radius, sweep=math.pi)
    return curved_panel(
        name,
        chart,
        outline,
        thickness,
        bonding,
        bond=bonding.region(name, outline),
        middle=math.pi * radius / 2,
        runs_through=runs_through,
    )


def apse_legs(
    name: str, centre: tuple[float, float], inner_radius: float, thickness: float, height: float, legs: float
) -> list[WallLayout]:
    """Return the places of the legs of an apse as walls that no opening may reach into. Parameters as for `apse_panel`."""
    top = ((centre[1] - legs, height), (centre[1], height))
    offset = inner_radius + thickness / 2
    return [WallLayout(name, "y", centre[0] + side * offset, thickness, top, 0) for side in (-1.0, 1.0)]
