"""A free-standing arch on two piers, with its spandrels or a backfill."""

from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal

import numpy as np

from churchpipe.errors import InputError
from churchpipe.generators.arched import ArchedOpening
from churchpipe.generators.checks import whole_courses
from churchpipe.generators.fields import as_dataclass, coerce_fields, materials_of
from churchpipe.generators.laying import Course, StoneLength
from churchpipe.generators.layout import WallLayout, wall_panels
from churchpipe.generators.masonry import DEFAULT_MATERIAL
from churchpipe.generators.openings import rectangle
from churchpipe.generators.wall_bonds import Bonding
from churchpipe.model.building import BondRegion, Building, UnitCell
from churchpipe.model.materials import UnitWeight
from churchpipe.model.quantities import Count, Length


@dataclass(frozen=True, slots=True)
class ArchPiersParameters:
    """An arch along x about the origin on two piers, with its spandrels or a backfill; y is 0 in its middle. All of it is one
    wall, called arch."""

    course: Course
    stone_length: StoneLength
    span: Annotated[Length, "Clear span."]
    springing: Annotated[Length, "Height of the piers."]
    pier_width: Annotated[Length, "Width of each pier."]
    thickness: Annotated[Length, "Thickness, along y."]
    height: Annotated[Length, "Height of the level top."]
    voussoirs: Annotated[Count, "Number of voussoirs."]
    depth: Annotated[Length, "Depth of the voussoirs."]
    shape: Annotated[Literal["round", "segmental", "pointed"], "Shape of the arch."] = "round"
    rise: Annotated[Length | None, "Rise over the springing, of a segmental or pointed arch."] = None
    backfill: Annotated[
        str | None,
        "Material that fills the space above the arch, laid dry; by default masonry as in the piers.",
    ] = None

    def __post_init__(self) -> None:
        coerce_fields(self, "arch_piers.")
        for key in ("height", "springing"):
            whole_courses(f"arch_piers.{key}", getattr(self, key), self.course)
        beside = self.pier_width - self.depth
        if beside < self.stone_length / 2:
            raise InputError(
                "arch_piers.pier_width",
                "the arch does not fit on its piers",
                found=f"{self.pier_width:g} m for voussoirs {self.depth:g} m deep",
                expected=f">= {self.depth + self.stone_length / 2:.4g} m: the voussoirs and half a stone",
            )


def arch_piers(
    *, name: str = "arch_piers", materials: tuple[UnitWeight, ...] = (DEFAULT_MATERIAL,), **parameters: Any
) -> Building:
    """Return an arch on piers; keywords: its keys in docs/reference_case.md, without unit, SI."""
    p = as_dataclass(ArchPiersParameters, "arch_piers", parameters)
    materials = materials_of("arch_piers", materials)
    half = p.span / 2 + p.pier_width
    opening = ArchedOpening("arch", "arch", 0.0, p.span, p.springing, p.voussoirs, p.depth, shape=p.shape, rise=p.rise)
    # The backfill is the first material if no other is: piers and arch take the first that is not.
    masonry = next((m.name for m in materials if m.name != p.backfill), materials[0].name)
    bonding = Bonding(UnitCell(a=p.course, b=p.stone_length), "bay", masonry, (opening,))
    wall = WallLayout("arch", "x", 0.0, p.thickness, ((-half, p.height), (half, p.height)), 0)
    (panel,) = wall_panels([wall], bonding)
    if p.backfill is None:
        return Building(name, (panel,), materials)
    bond, *rings = panel.regions
    foot = rings[0].outline[0]
    bottom = np.ceil(foot[1] / p.course - 1e-9) * p.course
    fill = BondRegion(
        "backfill",
        rectangle(-foot[0], float(bottom), foot[0], p.height),
        "running",
        bonding.cell,
        joints="bay",
        material=p.backfill,
    )
    return Building(name, (replace(panel, regions=(bond, fill, *rings)),), materials)
