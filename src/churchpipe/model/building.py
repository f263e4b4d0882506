"""The one source description from which both models are derived."""

from dataclasses import dataclass, field
from typing import Annotated, Any, Literal, cast, get_args

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arguments import check_kind, describe, finite, listed, one_of, positive, text, text_or_empty, whole
from churchpipe.model.arrays import FloatArray, ReadOnly, flags, floats, indices, store
from churchpipe.model.materials import UnitWeight
from churchpipe.model.quantities import MOST_COUNTED, Distance, Quantity
from churchpipe.model.ring_beam import RingBeam
from churchpipe.model.vault import Vault

Pattern = Literal["running", "stack", "header-stretcher", "voussoir", "single"]
Headers = Literal["english", "flemish", "none"]
# Laying so many and finding their joints takes about half a minute.
MOST_STONES = 100_000


@dataclass(frozen=True, slots=True)
class PlaneChart(ReadOnly):
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
class CylinderChart(ReadOnly):
    """A vertical cylinder of mid-radius `radius`: s is arc length from the angle `start` (rad, counter-clockwise), t height.

    The arc turns by `sweep` (rad); beyond it, s < 0 or s > radius sweep, the wall runs on straight along the tangents: the
    legs of an apse.
    """

    centre: FloatArray
    radius: float
    start: float = 0.0
    sweep: float = 2 * np.pi

    def __post_init__(self) -> None:
        positive("CylinderChart.radius", self.radius)
        finite("CylinderChart.start", self.start)
        if not 0 < finite("CylinderChart.sweep", self.sweep) <= 2 * np.pi:
            raise InputError("CylinderChart.sweep", "out of range", found=self.sweep, expected="0 < sweep <= 2 pi rad")
        store(self, centre=floats("CylinderChart.centre", self.centre, (3,)))


Chart = PlaneChart | CylinderChart


@dataclass(frozen=True, slots=True)
class UnitCell:
    """The running-bond cell of eq. (7): course height a and stone length b, m."""

    a: float
    b: float

    def __post_init__(self) -> None:
        positive("UnitCell.a", self.a)
        positive("UnitCell.b", self.b)


@dataclass(frozen=True, slots=True)
class BondRegion(ReadOnly):
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
    pattern: Pattern
    cell: UnitCell
    joints: Literal["grid", "bay"] = "grid"
    through_offset: float = 0.0
    cut_offset: float | None = None
    centre: tuple[float, float] | None = None
    pieces: int = 0
    yields: bool = True
    material: str = ""
    headers: Headers = "english"

    def __post_init__(self) -> None:
        where = f"BondRegion {text('BondRegion.name', self.name)}"
        one_of(f"{where}.pattern", self.pattern, *get_args(Pattern))
        check_kind(f"{where}.cell", self.cell, UnitCell)
        one_of(f"{where}.joints", self.joints, "grid", "bay")
        one_of(f"{where}.headers", self.headers, *get_args(Headers))
        finite(f"{where}.through_offset", self.through_offset)
        whole(f"{where}.pieces", self.pieces, least=0)
        text_or_empty(f"{where}.material", self.material)
        if self.centre is not None:
            floats(f"{where}.centre", self.centre, (2,))
        store(
            self,
            outline=_outline(where, self.outline),
            yields=bool(flags(f"{where}.yields", self.yields, ())),
        )
        if self.cut_offset is None:
            # A header lies over the middle of a stretcher.
            lap = 1 / 4 if self.pattern == "header-stretcher" and self.headers != "none" else 1 / 2
            store(self, cut_offset=self.through_offset + lap * self.cell.b)
        finite(f"{where}.cut_offset", self.cut_offset)


@dataclass(frozen=True, slots=True)
class Opening(ReadOnly):
    """A hole in a panel: outline (n, 2) m in chart coordinates, counter-clockwise.

    kind: "rectangular", with upright and level edges, or "arched", with others. Through a curved wall the former is cut radially,
    the latter as a prism along the normal in its middle. rings: names of the bond regions whose voussoirs surround it.
    """

    name: str
    outline: FloatArray
    kind: Literal["rectangular", "arched"] = "rectangular"
    rings: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        where = f"Opening {text('Opening.name', self.name)}"
        one_of(f"{where}.kind", self.kind, "rectangular", "arched")
        store(self, outline=_outline(where, self.outline), rings=tuple(listed(f"{where}.rings", self.rings, str)))


@dataclass(frozen=True, slots=True)
class Part(ReadOnly):
    """A macro-element that takes up part of a panel: its name and outline (n, 2) m in chart coordinates."""

    name: str
    outline: FloatArray

    def __post_init__(self) -> None:
        store(self, outline=_outline(f"Part {text('Part.name', self.name)}", self.outline))


@dataclass(frozen=True, slots=True)
class Panel(ReadOnly):
    """A wall: chart, outline (n, 2) m counter-clockwise, thickness m, openings, material name, bond regions.

    The outline reaches over the whole footprint, junctions included: who owns a junction is derived from the footprints.
    `runs_through`: on courses of this parity (0 even, 1 odd) the panel runs through the junctions it shares with panels
    of the other parity (toothed); None: it always runs through and others butt against it; panels of the same
    parity butt, the one listed first runs through. `filled` (n, 4): s0, t0, s1, t1 of the parts of its junctions that the wall's
    own stones fill, m, where courses cannot tell, as in a drawing with courses of unlike height. Regions listed later lie on top
    of earlier ones (a lintel in a wall). Stones and facets carry the panel's name, those within one of the `parts` that part's:
    macro-elements, for reports and loads.
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
    filled: FloatArray = field(default_factory=lambda: np.empty((0, 4)))

    def __post_init__(self) -> None:
        where = f"wall {text('Panel.name', self.name)}"
        _check_chart(f"{where}.chart", self.chart)
        positive(f"{where}.thickness", self.thickness)
        text(f"{where}.material", self.material)
        if self.runs_through is not None and finite(f"{where}.runs_through", self.runs_through) not in (0, 1):
            raise InputError(f"{where}.runs_through", "unknown value", found=self.runs_through, expected="0, 1 or None")
        store(
            self,
            outline=_outline(where, self.outline),
            regions=tuple(listed(f"{where}.regions", self.regions, BondRegion)),
            openings=tuple(listed(f"{where}.openings", self.openings, Opening)),
            parts=tuple(listed(f"{where}.parts", self.parts, Part)),
            filled=floats(f"{where}.filled", self.filled, (None, 4)),
        )
        if not self.regions:
            raise InputError(f"{where}.regions", "no bond", expected="at least one bond region")
        names = [region.name for region in self.regions]
        if len(set(names)) != len(names):
            raise InputError(f"{where}.regions", "names are not unique", found=", ".join(names))
        around = {region.name for region in self.regions if region.pattern == "voussoir"}
        for opening in self.openings:
            for ring in set(opening.rings) - around:
                raise InputError(
                    f"{where}: opening {opening.name}.rings", "no such ring", found=ring, expected=", ".join(sorted(around))
                )
        for item in (*self.openings, *self.parts):
            low, high = item.outline.min(axis=0), item.outline.max(axis=0)
            if (low >= self.outline.max(axis=0)).any() or (high <= self.outline.min(axis=0)).any():
                raise InputError(
                    f"{where}: {type(item).__name__.lower()} {item.name}",
                    "lies beside the wall",
                    found=f"{low.tolist()} to {high.tolist()} m",
                    expected=f"within {self.outline.min(axis=0).tolist()} to {self.outline.max(axis=0).tolist()} m",
                )
        if isinstance(self.chart, CylinderChart) and self.chart.radius <= self.thickness / 2:
            raise InputError(
                f"{where}.chart",
                "no room inside",
                found=f"radius {self.chart.radius:g} m",
                expected=f"> {self.thickness / 2:g} m",
            )


_Courses = Annotated[int, Quantity("", 0, high=MOST_COUNTED)]


@dataclass(frozen=True, slots=True)
class Junction:
    """How two walls hold together where they meet, if they are not toothed into each other on every other course.

    On all courses the first wall runs through, and the second one butts against it, but for its bonding courses.
    """

    walls: Annotated[tuple[str, str], "Names of the two walls: the one that runs through, and the one that butts against it."]
    every: Annotated[_Courses, "A stone of the second wall bonds them on every so many courses, an even number; 0: on none."] = 0
    cracked: Annotated[tuple[Distance, Distance] | None, "From which height to which one no stone bonds them."] = None

    def __post_init__(self) -> None:
        names = tuple(listed("Junction.walls", self.walls, str))
        where = f"junction of {' and '.join(names)}"
        if len(names) != 2 or names[0] == names[1]:
            raise InputError(f"{where}: walls", "not two walls", found=", ".join(names), expected="the names of two walls")
        whole(f"{where}: every", self.every, least=0, most=MOST_COUNTED)
        if self.every % 2:
            remedy = "A wall has a joint over each stone: on odd courses its stones end at the face of the other wall."
            raise InputError(
                f"{where}: every", "an odd number of courses", found=self.every, expected="0, 2, 4 and so on", remedy=remedy
            )
        cracked = None
        if self.cracked is not None:
            low, high = cracked = tuple(floats(f"{where}: cracked", self.cracked, (2,)).tolist())
            if not 0 <= low < high:
                raise InputError(f"{where}: cracked", "no stretch of height", found=list(cracked), expected="0 <= from < to")
        store(self, walls=names, every=int(self.every), cracked=cracked)


@dataclass(frozen=True, slots=True)
class Support(ReadOnly):
    """A fixed body that is not the ground plane, such as the skewback of an arch: points (n, 3) m, faces outward."""

    name: str
    points: FloatArray
    faces: tuple[tuple[int, ...], ...]

    def __post_init__(self) -> None:
        where = f"Support {text('Support.name', self.name)}"
        store(self, points=floats(f"{where}.points", self.points, (None, 3)))
        _check_faces(f"{where}.faces", self.faces, len(self.points))


@dataclass(frozen=True, slots=True)
class Building:
    """Panels and vaults, the unit weights of their materials (a `Material` has one), the height of the ground plane in m (None:
    no ground plane), further fixed bodies, the junctions that are not toothed as those of the panels are by themselves, and ring
    beams. most_stones: with more it is refused before any is laid.
    """

    name: str
    panels: tuple[Panel, ...]
    materials: tuple[UnitWeight, ...]
    ground: float | None = 0.0
    supports: tuple[Support, ...] = ()
    vaults: tuple[Vault, ...] = ()
    junctions: tuple[Junction, ...] = ()
    ring_beams: tuple[RingBeam, ...] = ()
    most_stones: int = MOST_STONES

    def __post_init__(self) -> None:
        where = f"Building {text('Building.name', self.name)}"
        store(
            self,
            panels=tuple(listed(f"{where}.panels", self.panels, Panel)),
            materials=tuple(listed(f"{where}.materials", self.materials, UnitWeight)),
            supports=tuple(listed(f"{where}.supports", self.supports, Support)),
            vaults=tuple(listed(f"{where}.vaults", self.vaults, Vault)),
            junctions=tuple(listed(f"{where}.junctions", self.junctions, Junction)),
            ring_beams=tuple(listed(f"{where}.ring_beams", self.ring_beams, RingBeam)),
        )
        if self.ground is not None:
            finite(f"{where}.ground", self.ground)
        whole(f"{where}.most_stones", self.most_stones, least=1)
        names = [p.name for p in self.panels] + [part for vault in self.vaults for part in vault.parts]
        if len(set(names)) != len(names):
            raise InputError(where, "names of panels and parts of vaults are not unique", found=names)
        panels = [p.name for p in self.panels]
        for junction in self.junctions:
            for name in set(junction.walls) - set(panels):
                raise InputError(
                    f"junction of {' and '.join(junction.walls)}", "no such wall", found=name, expected=", ".join(panels)
                )
        known = {m.name for m in self.materials}
        used = [(f"wall {p.name}", {p.material}) for p in self.panels]
        used += [(f"wall {p.name}: {region.name}", {region.material}) for p in self.panels for region in p.regions]
        used += [(f"Vault {vault.name}", {vault.material}) for vault in self.vaults]
        for owner, materials in used + [(f"ring beam {' '.join(beam.walls)}", {beam.material}) for beam in self.ring_beams]:
            for name in materials - known - {""}:
                expected, remedy = ", ".join(sorted(known)), f"Name one of these, or add the material {name}."
                raise InputError(f"{owner}.material", "unknown material", found=name, expected=expected, remedy=remedy)

    @property
    def macro_elements(self) -> tuple[str, ...]:
        """Names of its panels, of their parts, of the parts of its vaults, and of its ring beams."""
        walls = [name for panel in self.panels for name in (panel.name, *(part.name for part in panel.parts))]
        vaults = (part for vault in self.vaults for part in vault.parts)
        return (*walls, *vaults, *(body for beam in self.ring_beams for body in beam.bodies))


def _outline(where: str, outline: FloatArray) -> FloatArray:
    corners = floats(f"{where}.outline", outline, (None, 2))
    if len(corners) < 3:
        raise InputError(f"{where}.outline", "no polygon", found=f"{len(corners)} corners", expected="3 or more")
    return corners


def _check_chart(where: str, chart: object) -> None:
    if not isinstance(chart, Chart):
        raise InputError(where, "wrong kind", found=describe(chart), expected="a PlaneChart or a CylinderChart")


def _check_faces(where: str, faces: object, below: int) -> None:
    if not isinstance(faces, tuple) or not faces:
        raise InputError(where, "wrong kind", found=describe(cast("object", faces)), expected="a tuple of faces")
    for number, face in enumerate(cast("tuple[Any, ...]", faces)):
        indices(f"{where}[{number}]", face, (None,), below=below)
