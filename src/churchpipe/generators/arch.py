"""A free-standing arch between two skewbacks."""

import math
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from churchpipe.bond.count import MOST_VOUSSOIRS
from churchpipe.bond.tiles import tiles_of
from churchpipe.bond.voussoir import ring_outline
from churchpipe.errors import InputError
from churchpipe.generators.fields import as_dataclass, coerce_fields, materials_of
from churchpipe.generators.masonry import DEFAULT_MATERIAL
from churchpipe.geometry.planar import polygon
from churchpipe.model.arguments import whole
from churchpipe.model.arrays import FloatArray
from churchpipe.model.building import BondRegion, Building, Panel, PlaneChart, Support, UnitCell
from churchpipe.model.materials import UnitWeight
from churchpipe.model.quantities import Angle, Count, Length
from churchpipe.stones.prisms import thicken


@dataclass(frozen=True, slots=True)
class ArchParameters:
    """A circular arch in the x-z plane about the origin, y from 0 to its width. It is called arch."""

    mean_radius: Annotated[Length, "Radius half way between intrados and extrados."]
    thickness: Annotated[Length, "Depth of the voussoirs, in the plane of the arch."]
    width: Annotated[Length, "Width, along y."]
    voussoirs: Annotated[Count, "Number of voussoirs, straight-sided."]
    half_angle: Annotated[Angle, "From the crown to each springing; 90 is the semicircle."] = math.pi / 2

    def __post_init__(self) -> None:
        coerce_fields(self, "arch.")
        whole("arch.voussoirs", self.voussoirs, least=2, most=MOST_VOUSSOIRS)
        if self.thickness >= 2 * self.mean_radius:
            raise InputError(
                "arch.thickness", "no opening is left", found=self.thickness, expected=f"< {2 * self.mean_radius:g} m"
            )
        if self.half_angle > 0.75 * math.pi:
            raise InputError("arch.half_angle", "out of range", found=self.half_angle, expected="0 < half angle <= 3/4 pi rad")


def arch(*, name: str = "arch", materials: tuple[UnitWeight, ...] = (DEFAULT_MATERIAL,), **parameters: Any) -> Building:
    """Return an arch on two fixed skewbacks; keywords: its keys in docs/reference_case.md, without unit, SI."""
    p = as_dataclass(ArchParameters, "arch", parameters)
    materials = materials_of("arch", materials)
    start, stop = math.pi / 2 - p.half_angle, math.pi / 2 + p.half_angle
    inner, outer = p.mean_radius - p.thickness / 2, p.mean_radius + p.thickness / 2
    outline = ring_outline((0.0, 0.0), inner, outer, start, stop, p.voussoirs)
    cell = UnitCell(a=2 * p.half_angle * p.mean_radius / p.voussoirs, b=p.thickness)
    ring = BondRegion("ring", outline, "voussoir", cell, centre=(0.0, 0.0), pieces=p.voussoirs)
    chart = PlaneChart(origin=np.array([0.0, p.width / 2, 0.0]), s_axis=np.array([1.0, 0.0, 0.0]))
    panel = Panel("arch", chart, outline, p.width, (ring,), material=materials[0].name)
    springings = (
        ("skewback-right", outline[0], outline[-1], np.array([math.sin(start), -math.cos(start)])),
        ("skewback-left", outline[p.voussoirs], outline[p.voussoirs + 1], np.array([-math.sin(stop), math.cos(stop)])),
    )
    skewbacks = tuple(
        _skewback(name, panel, extrados, intrados, away * p.thickness) for name, extrados, intrados, away in springings
    )
    return Building(name, (panel,), materials, ground=None, supports=skewbacks)


def _skewback(name: str, panel: Panel, extrados: FloatArray, intrados: FloatArray, away: FloatArray) -> Support:
    """Return a fixed block behind a springing joint, as wide as the arch; `away` (2,) m points out of the arch."""
    outline = polygon([extrados, intrados, intrados + away, extrados + away])
    tile = tiles_of(np.array([outline], dtype=np.object_), np.zeros(1, dtype=np.int64), name)
    body = thicken(panel.chart, panel.thickness, tile)
    faces = tuple(tuple(face.tolist()) for face in np.split(body.face_nodes, body.face_ptr[1:-1]))
    return Support(name, body.points, faces)
