"""A free-standing tower, rectangular or round."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal

import numpy as np

from churchpipe.errors import InputError
from churchpipe.generators.arched import WallOpening
from churchpipe.generators.checks import whole_courses
from churchpipe.generators.curved import curved_panel
from churchpipe.generators.fields import as_dataclass, coerce_fields, materials_of
from churchpipe.generators.laying import Bonds, Course, FirstCourse, Joints, Openings, StoneLength
from churchpipe.generators.layout import WallLayout, wall_panels
from churchpipe.generators.masonry import DEFAULT_MATERIAL
from churchpipe.generators.openings import rectangle
from churchpipe.generators.wall_bonds import Bonding, bonding_of, check_walls
from churchpipe.model.building import Building, CylinderChart, Panel
from churchpipe.model.materials import UnitWeight
from churchpipe.model.quantities import Length


@dataclass(frozen=True, slots=True)
class TowerParameters:
    """A tower about the origin. A rectangular one has the walls front and back (along x), left and right (along y), a round
    one the wall round.
    """

    course: Course
    stone_length: StoneLength
    width: Annotated[Length, "Along x, over all; of a round tower its diameter."]
    height: Annotated[Length, "Height."]
    thickness: Annotated[Length, "Thickness of the walls."]
    depth: Annotated[Length | None, "Along y, over all; by default the width."] = None
    plan: Annotated[Literal["rectangular", "round"], "Plan; the stones of a round tower are cut to a wedge."] = "rectangular"
    openings: Openings = ()
    bonds: Bonds = ()
    joints: Joints = "bay"
    first_course: FirstCourse = "x"

    def __post_init__(self) -> None:
        coerce_fields(self, "tower.")
        whole_courses("tower.height", self.height, self.course)
        if self.plan == "round" and self.length != self.width:
            raise InputError("tower.plan", "a round tower has no depth of its own", expected='plan = "rectangular"')
        for key, size in (("width", self.width), ("depth", self.length)):
            room = size - 2 * self.thickness
            if room < self.stone_length:
                raise InputError(
                    f"tower.{key}", "no room inside", found=f"{room:.4g} m clear", expected=f">= {self.stone_length:g} m"
                )

    @property
    def length(self) -> float:
        """Depth along y, m."""
        return self.width if self.depth is None else self.depth


def tower(*, name: str = "tower", materials: tuple[UnitWeight, ...] = (DEFAULT_MATERIAL,), **parameters: Any) -> Building:
    """Return a tower; keywords: its keys in docs/reference_case.md, without unit, SI."""
    p = as_dataclass(TowerParameters, "tower", parameters)
    materials = materials_of("tower", materials)
    bonding = bonding_of("tower", p, materials[0].name)
    check_walls(bonding, ["round"] if p.plan == "round" else ["front", "back", "left", "right"], "tower")
    if p.plan == "round":
        return Building(name, (_round(p, bonding),), materials)
    across, along = (0, 1) if p.first_course == "x" else (1, 0)
    x, y = p.width / 2, p.length / 2
    walls = [
        WallLayout(wall, "x", sign * (y - p.thickness / 2), p.thickness, ((-x, p.height), (x, p.height)), across)
        for wall, sign in (("front", -1), ("back", 1))
    ]
    walls += [
        WallLayout(wall, "y", sign * (x - p.thickness / 2), p.thickness, ((-y, p.height), (y, p.height)), along)
        for wall, sign in (("left", -1), ("right", 1))
    ]
    return Building(name, tuple(wall_panels(walls, bonding)), materials)


def _round(p: TowerParameters, bonding: Bonding) -> Panel:
    radius = (p.width - p.thickness) / 2
    girth = 2 * math.pi * radius
    seam = _seam(bonding.openings, radius)
    outline = rectangle(0.0, 0.0, girth, p.height)
    return curved_panel(
        "round",
        CylinderChart(np.zeros(3), radius, start=seam / radius),
        outline,
        p.thickness,
        bonding,
        bond=replace(bonding.region("round", outline), joints="bay"),
        middle=-seam,
    )


def _seam(openings: Sequence[WallOpening], radius: float) -> float:
    """Return where the wall of a round tower begins: in the middle of the widest gap between openings, m along it from +x."""
    if not openings:
        return 0.0
    girth = 2 * math.pi * radius
    middle = np.unique(np.mod([centre for opening in openings for centre in opening.centres], girth))
    gap = np.diff(middle, append=middle[0] + girth)
    widest = int(np.argmax(gap))
    return float(middle[widest] + gap[widest] / 2) - girth
