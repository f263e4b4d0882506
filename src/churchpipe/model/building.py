"""The one source description from which both models are derived."""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arrays import FloatArray, floats, store
from churchpipe.model.materials import Material

# Patterns whose strength is derived for the homogenised shell.
SHELL_PATTERNS = ("running", "voussoir", "single")


@dataclass(frozen=True, slots=True)
class PlaneChart:
    """A flat mid-surface: x = origin + s s_axis + t t_axis; thickness along s_axis x t_axis. origin in m, unit axes."""

    origin: FloatArray
    s_axis: FloatArray
    t_axis: FloatArray = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))

    def __post_init__(self) -> None:
        s_axis, t_axis = floats("PlaneChart.s_axis", self.s_axis, (3,)), floats("PlaneChart.t_axis", self.t_axis, (3,))
        gram = np.array([s_axis @ s_axis - 1, t_axis @ t_axis - 1, s_axis @ t_axis])
        if np.abs(gram).max() > 1e-9:
            raise InputError("PlaneChart", "axes are not orthonormal", found=f"{s_axis.tolist()}, {t_axis.tolist()}")
        store(self, origin=floats("PlaneChart.origin", self.origin, (3,)), s_axis=s_axis, t_axis=t_axis)


@dataclass(frozen=True, slots=True)
class CylinderChart:
    """A vertical cylinder of mid-radius `radius`: s is arc length from the angle `start` (rad, counter-clockwise), t height.

    The arc turns by `sweep` (rad); beyond it, s < 0 or s > radius sweep, the wall runs on straight along the tangents: the
    legs of an apse.
    """

    centre: FloatArray
    radius: float
    start: float = 0.0
    sweep: float = 2 * np.pi

    def __post_init__(self) -> None:
        if not self.radius > 0:
            raise InputError("CylinderChart.radius", "out of range", found=self.radius, expected="> 0 m")
        if not 0 < self.sweep <= 2 * np.pi:
            raise InputError("CylinderChart.sweep", "out of range", found=self.sweep, expected="0 < sweep <= 2 pi rad")
        store(self, centre=floats("CylinderChart.centre", self.centre, (3,)))


Chart = PlaneChart | CylinderChart


@dataclass(frozen=True, slots=True)
class UnitCell:
    """The running-bond cell of eq. (7): course height a and stone length b, m."""

    a: float
    b: float

    def __post_init__(self) -> None:
        for key, value in (("a", self.a), ("b", self.b)):
            if not (value > 0 and np.isfinite(value)):
                raise InputError(f"UnitCell.{key}", "out of range", found=value, expected="> 0 m")


@dataclass(frozen=True, slots=True)
class BondRegion:
    """Part of a panel that is laid in one bond.

    outline (n, 2) m in chart coordinates, counter-clockwise. pattern: "running", "stack", "header-stretcher", "voussoir" (a ring
    about `centre`, radial joints) or "single" (one stone: a lintel). Joints of through courses lie at through_offset + k b, of
    cut courses at cut_offset + k b (rule "grid", measured along s), or each clear bay is divided evenly (rule "bay").
    `headers` tie the two leaves of header-stretcher bond: whole courses of them in turn with courses of stretchers ("english"),
    header and stretcher in turn in each course ("flemish"), or "none". `pieces`: number of voussoirs of a ring. yields: False
    for parts the shell keeps elastic. material: of this region; empty for that of its panel.
    """

    name: str
    outline: FloatArray
    pattern: Literal["running", "stack", "header-stretcher", "voussoir", "single"]
    cell: UnitCell
    joints: Literal["grid", "bay"] = "grid"
    through_offset: float = 0.0
    cut_offset: float | None = None
    centre: tuple[float, float] | None = None
    pieces: int = 0
    yields: bool = True
    material: str = ""
    headers: Literal["english", "flemish", "none"] = "english"

    def __post_init__(self) -> None:
        store(self, outline=floats(f"BondRegion {self.name}.outline", self.outline, (None, 2)))
        if self.cut_offset is None:
            # A header lies over the middle of a stretcher.
            lap = 1 / 4 if self.pattern == "header-stretcher" and self.headers != "none" else 1 / 2
            store(self, cut_offset=self.through_offset + lap * self.cell.b)


@dataclass(frozen=True, slots=True)
class Opening:
    """A hole in a panel: outline (n, 2) m in chart coordinates, counter-clockwise."""

    name: str
    outline: FloatArray

    def __post_init__(self) -> None:
        store(self, outline=floats(f"Opening {self.name}.outline", self.outline, (None, 2)))


@dataclass(frozen=True, slots=True)
class Part:
    """A macro-element that takes up part of a panel: its name and outline (n, 2) m in chart coordinates."""

    name: str
    outline: FloatArray

    def __post_init__(self) -> None:
        store(self, outline=floats(f"Part {self.name}.outline", self.outline, (None, 2)))


@dataclass(frozen=True, slots=True)
class Panel:
    """A wall: chart, outline (n, 2) m counter-clockwise, thickness m, openings, material name, bond regions.

    The outline reaches over the whole footprint, junctions included: who owns a junction is derived from the footprints.
    `runs_through`: on courses of this parity (0 even, 1 odd) the panel runs through the junctions it shares with panels
    of the other parity (toothed); None: it always runs through and others butt against it; panels of the same
    parity butt, the one listed first runs through. Regions listed later lie on top of earlier ones (a lintel in a wall).
    Stones and facets carry the panel's name, those within one of the `parts` that part's: macro-elements, for reports and loads.
    """

    name: str
    chart: Chart
    outline: FloatArray
    thickness: float
    regions: tuple[BondRegion, ...]
    material: str = "default"
    openings: tuple[Opening, ...] = ()
    runs_through: Literal[0, 1] | None = 0
    parts: tuple[Part, ...] = ()

    def __post_init__(self) -> None:
        store(self, outline=floats(f"Panel {self.name}.outline", self.outline, (None, 2)))
        if not self.thickness > 0:
            raise InputError(f"Panel {self.name}.thickness", "out of range", found=self.thickness, expected="> 0 m")
        if not self.regions:
            raise InputError(f"Panel {self.name}.regions", "no bond", expected="at least one bond region")


@dataclass(frozen=True, slots=True)
class Support:
    """A fixed body that is not the ground plane, such as the skewback of an arch: points (n, 3) m, faces outward."""

    name: str
    points: FloatArray
    faces: tuple[tuple[int, ...], ...]

    def __post_init__(self) -> None:
        store(self, points=floats(f"Support {self.name}.points", self.points, (None, 3)))


@dataclass(frozen=True, slots=True)
class Building:
    """Panels, materials, the height of the ground plane in m (None: no ground plane) and further fixed bodies."""

    name: str
    panels: tuple[Panel, ...]
    materials: tuple[Material, ...]
    ground: float | None = 0.0
    supports: tuple[Support, ...] = ()

    def __post_init__(self) -> None:
        seen = [p.name for p in self.panels]
        if len(set(seen)) != len(seen):
            raise InputError(f"Building {self.name}", "panel names are not unique", found=seen)
        known = {m.name for m in self.materials}
        for panel in self.panels:
            for name in {panel.material, *(region.material for region in panel.regions)} - known - {""}:
                raise InputError(
                    f"Panel {panel.name}.material", "unknown material", found=name, expected=", ".join(sorted(known))
                )
