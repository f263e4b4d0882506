"""A free-standing arch on two piers, with its spandrels or a backfill."""

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from churchpipe.errors import InputError
from churchpipe.generators.arched import ArchedOpening
from churchpipe.generators.checks import whole_courses
from churchpipe.generators.fields import as_dataclass, coerce_fields, materials_of
from churchpipe.generators.layout import WallLayout, wall_panels
from churchpipe.generators.masonry import DEFAULT_MATERIAL
from churchpipe.generators.openings import rectangle
from churchpipe.generators.wall_bonds import Bonding
from churchpipe.model.building import BondRegion, Building, UnitCell
from churchpipe.model.materials import UnitWeight
from churchpipe.model.quantities import Count, Length


@dataclass(frozen=True, slots=True)
class ArchPiersParameters:
    """An arch along x about the origin: clear span, springing (the height of the piers), width of each pier, thickness along y,
    height of the level top, m.

    depth: of the voussoirs, m; voussoirs: their number. shape, rise: as in `ArchedOpening`. course, stone_length: of the piers
    and of what lies on the arch, m. backfill: name of the material that fills the space between the piers above the arch, laid
    dry in the same courses; None: masonry as in the piers.
    """

    course: Length
    stone_length: Length
    span: Length
    springing: Length
    pier_width: Length
    thickness: Length
    height: Length
    voussoirs: Count
    depth: Length
    shape: Literal["round", "segmental", "pointed"] = "round"
    rise: Length | None = None
    backfill: str | None = None

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
    """Return an arch on piers; keywords as in `ArchPiersParameters`, SI."""
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
