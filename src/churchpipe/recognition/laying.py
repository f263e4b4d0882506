"""Stones laid in walls and rings that are given whole: from closed volumes and a bond to a building."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from churchpipe.bond.junction import crossings
from churchpipe.bond.walls import wall_region
from churchpipe.errors import InputError
from churchpipe.model.arguments import check_kind, one_of, positive
from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import BondRegion, Building, Opening, Panel, UnitCell
from churchpipe.model.doubts import doubt_argument
from churchpipe.model.materials import UnitWeight
from churchpipe.model.sizes import LaidSize
from churchpipe.recognition.insets import openings_of, outline_and_holes, with_insets
from churchpipe.recognition.lintels import is_lintel, with_lintels
from churchpipe.recognition.ring_outlines import ring_outlines
from churchpipe.recognition.squaring import squared
from churchpipe.recognition.supports import support_of
from churchpipe.recognition.volumes import WallVolume, wall_volume

LaidPattern = Literal["running", "stack", "voussoir"]
PATTERNS = ("running", "stack", "voussoir")


@dataclass(frozen=True, slots=True)
class LaidBond:
    """How stones are laid in a volume: pattern "running" or "stack", with the course height and the length of a stone, m, or
    "voussoir" for rings alone.

    A ring gets voussoirs whatever the pattern, about as wide at half their depth as a course is high. Stones of a wall are about
    as long as asked: each clear bay between its ends or crossing walls is divided evenly. lintel_bearing: how far lintels bear on
    either side of openings, m; without it only those that are drawn are laid.
    """

    pattern: LaidPattern
    course: LaidSize
    stone: LaidSize | None = None
    lintel_bearing: float | None = None

    def __post_init__(self) -> None:
        one_of("bond", self.pattern, *PATTERNS)
        positive("course", self.course)
        if self.lintel_bearing is not None:
            positive("lintel_bearing", self.lintel_bearing)
        if self.stone is not None:
            positive("stone", self.stone)
        elif self.pattern != "voussoir":
            remedy = "Only rings of voussoirs go without it."
            raise InputError("stone", "missing", expected="the length of a stone", remedy=remedy)


@dataclass(frozen=True, slots=True)
class Volume:
    """A closed body to lay stones in: its name, material, points (n, 3) m, and faces, counter-clockwise from outside."""

    name: str
    material: str
    points: FloatArray
    faces: list[tuple[int, ...]]


def lay_stones(
    volumes: Assemblage,
    *,
    bond: LaidPattern = "running",
    course: float,
    stone: float | None = None,
    lintel_bearing: float | None = None,
    name: str = "walls",
) -> Building:
    """Return the building that stands in the given volumes: each free body is a wall, or a ring, and gets stones.

    `derive_blocks` and `derive_shell` make the two models of it. Openings that go through a body stay. Walls that reach into one
    another at right angles are toothed; where one ends at the face of another they butt. Walls that are nearly at right angles,
    and ends that nearly lie on the face of another wall, are taken as if they were, to half a per cent of the thickness. A body
    whose name begins with "lintel" is one stone, in the wall that it lies in. Fixed bodies are supports.

    Parameters
    ----------
    volumes
        Closed bodies, a wall, a ring or a lintel each; their block_id names the walls.
    bond
        "running" or "stack"; "voussoir" where all are rings.
    course
        Height of a course, m; in a ring about the width of a voussoir.
    stone
        About the length of a stone, m; not needed where all are rings.
    lintel_bearing
        How far a lintel bears on either side of an opening, m. Each opening with a flat head gets one that has none, up to the
        next bed joint; it bears less where the wall ends, another crosses it, or a narrow pier bears two.
    name
        Of the building.

    Raises
    ------
    InputError
        A body that is no wall, and where it is none; walls that cannot be laid.
    """
    check_kind("lay_stones: volumes", volumes, Assemblage)
    doubt_argument("lay_stones: course", course, LaidBond, "course")
    if stone is not None:
        doubt_argument("lay_stones: stone", stone, LaidBond, "stone")
    laid = LaidBond(bond, course, stone, lintel_bearing)
    bodies: list[Volume] = []
    for block in np.flatnonzero(~volumes.fixed):
        body = support_of(volumes, int(block))
        bodies.append(Volume(str(volumes.block_id[block]), str(volumes.material[block]), body.points, list(body.faces)))
    base = lowest(bodies) if bodies else 0.0
    panels = joined(squared([laid_panel(body, base, laid) for body in bodies])[0])
    panels = with_lintels(panels, lintel_bearing)[0] if lintel_bearing else panels
    free = ~volumes.fixed
    weights = {str(m): float(w) for m, w in zip(volumes.material[free], volumes.unit_weight[free], strict=True)}
    materials = tuple(UnitWeight(material, weight) for material, weight in weights.items())
    supports = tuple(support_of(volumes, int(block)) for block in np.flatnonzero(volumes.fixed))
    return Building(name, tuple(panels), materials, ground=None, supports=supports)


def lowest(bodies: Sequence[Volume]) -> float:
    """Return the level from which courses are counted: the lowest point of all bodies, m."""
    return min(float(body.points[:, 2].min()) for body in bodies)


def laid_panel(body: Volume, base: float, bond: LaidBond) -> Panel:
    """Return a body as a wall or a ring with its bond. base: level from which courses are counted, m."""
    try:
        return _panel(body, wall_volume(body.points, body.faces, base), bond)
    except InputError as error:
        raise error.at(body.name) from error


def joined(panels: Sequence[Panel]) -> list[Panel]:
    """Return the walls as one building: rings and lintels that lie in a wall are part of it, and walls that cross are toothed,
    one on even courses, the other on odd ones.

    Raises
    ------
    InputError: walls of one plane that lie in each other, or that cross at a slant.
    """
    panels = with_insets(panels)
    solids = [wall_region(panel) for panel in panels]
    parity: dict[int, Literal[0, 1]] = {}
    links = [crossing.walls for crossing in crossings(panels, solids)]
    for start in range(len(panels)):
        waiting = [] if start in parity else [start]
        parity.setdefault(start, 0)
        while waiting:
            wall = waiting.pop()
            for other in [b if a == wall else a for a, b in links if wall in (a, b)]:
                if other not in parity:
                    parity[other] = 1 if parity[wall] == 0 else 0
                    waiting.append(other)
    return [replace(panel, runs_through=parity[number]) for number, panel in enumerate(panels)]


def _panel(body: Volume, wall: WallVolume, bond: LaidBond) -> Panel:
    outer, inner = outline_and_holes(wall.region)
    if is_lintel(body.name):
        single = BondRegion("lintel", outer, "single", UnitCell(a=bond.course, b=bond.stone or bond.course), yields=False)
        return Panel(body.name, wall.chart, outer, wall.thickness, (single,), body.material)
    arcs = ring_outlines(wall.region)
    if arcs:
        regions = tuple(
            BondRegion(
                "ring" if len(arcs) == 1 else f"ring-{number}",
                arc.outline,
                "voussoir",
                UnitCell(a=arc.length / _count(arc.length, bond.course), b=arc.depth),
                centre=arc.centre,
                pieces=_count(arc.length, bond.course),
            )
            for number, arc in enumerate(arcs, 1)
        )
        names = tuple(region.name for region in regions)
        holes = tuple(Opening("opening-1", hole, "arched", names) for hole in inner)
        return Panel(body.name, wall.chart, outer, wall.thickness, regions, body.material, holes)
    if bond.pattern == "voussoir" or bond.stone is None:
        raise InputError(
            body.name,
            "it is no ring",
            found=f"an outline with {len(outer)} corners and {len(inner)} openings",
            expected="two arcs about one centre, and two straight ends",
            remedy="Lay walls in running bond: --bond running --stone 0.5m. Give each arc of a pointed arch as its own body.",
        )
    region = BondRegion("bond", outer, bond.pattern, UnitCell(a=bond.course, b=bond.stone), joints="bay")
    return Panel(body.name, wall.chart, outer, wall.thickness, (region,), body.material, openings_of(inner))


def _count(length: float, course: float) -> int:
    """Return how many voussoirs a ring takes; a keystone alone is none."""
    return max(2, round(length / course))
