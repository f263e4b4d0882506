"""From the stones of a drawing to the panels that the shell is made of."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from scipy.spatial import cKDTree

from churchpipe.errors import InputError
from churchpipe.geometry.noding import notches
from churchpipe.geometry.planar import (
    Polygon,
    Polygons,
    Region,
    all_coordinates,
    area,
    bounds,
    boxes,
    centroids,
    common_areas,
    contains,
    extent,
    pieces,
    polygon,
    rings,
    simplified,
    total_extent,
    united,
    within,
)
from churchpipe.geometry.polygons import corners
from churchpipe.model.arguments import check_kind
from churchpipe.model.arrays import FloatArray, IntArray, NameArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import BondRegion, Building, Opening, Panel, Part, Support, UnitCell
from churchpipe.model.materials import UnitWeight
from churchpipe.model.vault import Vault
from churchpipe.recognition.courses import courses_of, unit_cells
from churchpipe.recognition.rings import voussoir_rings
from churchpipe.recognition.separate_walls import GRID, closed, filled, separate_walls
from churchpipe.recognition.squaring import squared
from churchpipe.recognition.stone_walls import StoneWall, cut_stones, stone_walls
from churchpipe.recognition.straightening import straightened
from churchpipe.recognition.supports import support_of
from churchpipe.recognition.toothing import SeldomBonded, seldom_bonded, toothed
from churchpipe.recognition.vaults import VAULT, fit_vaults
from churchpipe.recognition.wall_parts import junction_spans, wall_parts
from churchpipe.stones.mortar import with_mortar
from churchpipe.stones.raggedness import raggedness
from churchpipe.stones.ring_beams import ring_beams

# Arches of a wall, and which of its stones are their voussoirs.
Ring = tuple[list[BondRegion], IntArray]
# A single stone over an opening is a lintel if it is longer than this many stones of the wall.
LINTEL = 1.25
# Stones of one wall may be so far apart, m.
_APART = 1e-3
# A hole smaller than this part of a stone is a gap between corners, such as mortar where three stones meet, and no opening.
LEAST_OPENING = 0.02


@dataclass(frozen=True, slots=True)
class FittedPanels:
    """Panels or vaults fitted to stones, their supports, which are the fixed stones, and the ids of the free stones that fit no
    panel; these are missing from the shell.

    stones: those that they were fitted to, with which the match gate compares the shell: half of the mortar of its joints is part
    of each stone, and its panel is the one fitted, or the part of it. If none of the stones of a name could be fitted they keep
    that name, so that the gate reports what is missing. Other stones without a panel have "". moved: by the names of the walls,
    how far their stones were moved at most to lie in line (see `straightened`), and they themselves to meet at right angles (see
    `squared`), m; for the panels alone, not in `stones`. seldom: pairs of walls that stones bond too seldom for a shell.
    """

    panels: tuple[Panel, ...]
    supports: tuple[Support, ...]
    unfit: NameArray
    stones: Assemblage
    vaults: tuple[Vault, ...] = ()
    moved: Mapping[str, float] = field(default_factory=dict[str, float])
    seldom: tuple[SeldomBonded, ...] = ()

    @property
    def panel(self) -> NameArray:
        """The panel of each stone (nb,)."""
        return self.stones.panel

    @property
    def moved_words(self) -> str:
        """What to say of the stones that were moved, "" where none was."""
        if not self.moved:
            return ""
        most = max(self.moved, key=lambda name: self.moved[name])
        by = 1e3 * self.moved[most]
        return f"For the shell alone, stones were moved into line and walls to meet squarely, by {by:.2g} mm at most ({most})."

    def building(self, materials: tuple[UnitWeight, ...] = (), name: str = "drawing") -> Building:
        """Return the building of these panels and vaults; materials: as the stones weigh in the mean, unless given.

        Raises
        ------
        InputError: a panel of another material; walls that stones bond more rarely than the shell would.
        """
        for pair in self.seldom:
            raise pair.error()
        materials = materials or tuple(UnitWeight(*item) for item in self.stones.mean_unit_weights.items())
        return Building(name, self.panels, materials, ground=None, supports=self.supports, vaults=self.vaults)


def fit_panels(stones: Assemblage, *, joint: float | None = None) -> FittedPanels:
    """Return the panels whose mid-surfaces are those of the given stones. All walls are upright, plane or on a circle in plan.

    Stones that are a barrel or a dome, alone or on walls or a drum laid with it, are vaults instead (see `fit_vaults`).

    Outline and openings: the union of the sections of the stones with the mid-plane, across joints, with the junctions of
    crossing walls included. Unit cell: the height and length of most stones, by volume. A long single stone over an opening is a
    lintel, and voussoirs, recognised by beds that turn from stone to stone, form rings. Which
    wall runs through a junction follows from the courses there. Stones of several names that touch in one plane are one wall,
    and the names are its parts.

    The places of the head joints are not fitted: the rigid blocks are the stones of the drawing in any case.

    Parameters
    ----------
    stones: as drawn. joint: nominal width, m, of mortar joints that the stones leave open; the walls have their mortar.

    Raises
    ------
    InputError: no wall can be fitted; stones that butt, or ring beams, which panels do not have.
    """
    check_kind("fit_panels: stones", stones, Assemblage)
    for what, found in (("butt joints, as of the stones of", stones.butts), ("ring beams, such as", ring_beams(stones))):
        if found.any():
            problem = f"the shell fitted to stones has no {what} {stones.panel[found][0]}"
            raise InputError("stones", problem, remedy="Use the rigid blocks, which take them as they are.")
    stones = stones if joint is None else with_mortar(stones, joint)
    supports = tuple(support_of(stones, int(block)) for block in np.flatnonzero(stones.fixed))
    vaults = fit_vaults(stones)
    if vaults:
        named = np.where(stones.fixed | (stones.panel != ""), stones.panel, VAULT)
        return FittedPanels((), supports, np.empty(0, dtype=np.str_), replace(stones, panel=named), vaults)
    ragged = raggedness(stones)
    planes, unfit = stone_walls(stones, _APART, ragged)
    straight, shift = straightened(stones, planes, unfit, ragged)
    if shift.any():
        planes, unfit = stone_walls(straight, _APART, cut=cut_stones(stones, planes, unfit))
    walls, loose = separate_walls(straight, planes, _APART)
    unfit = np.union1d(unfit, loose)
    if not walls:
        raise InputError(
            "stones",
            "no wall can be fitted to them",
            expected="stones with two upright parallel faces",
            remedy="Tag the stones of each wall with PANEL, or run the rigid blocks alone. To name parts that bear loads, "
            "give each a layer, a group of an OBJ, or a file of its own in a folder.",
        )
    rings = [voussoir_rings(wall.elevations, _APART) for wall in walls]
    cells, bent = _cells(straight, walls, rings), 2 * float(shift.max())
    laid = [_panel(straight, wall, walls, bent, ring, cell) for wall, ring, cell in zip(walls, rings, cells, strict=True)]
    panels, squaring = squared(laid)
    panels = toothed(panels, walls)
    moved = {wall.name: float(shift[wall.stones].max()) + squaring.get(wall.name, 0.0) for wall in walls}
    moved = {name: by for name, by in moved.items() if by > 0}
    known = [name for wall in walls for name in np.unique(wall.tag)]
    panel = np.where(stones.fixed | np.isin(stones.panel, known), "", stones.panel).astype(np.object_)
    for wall in walls:
        panel[wall.stones] = wall.tag
    named, seldom = replace(stones, panel=panel.astype(str)), seldom_bonded(panels, walls)
    return FittedPanels(tuple(panels), supports, stones.block_id[unfit], named, moved=moved, seldom=seldom)


def wall_names(stones: Assemblage, joint: float | None) -> NameArray:
    """Return the panel of each stone (nb,): its own, or that of the wall fitted to it where the stones name none at all.

    joint: as `fit_panels` takes it.
    """
    if (stones.panel != "").any():
        return stones.panel
    try:
        return fit_panels(stones, joint=joint).panel
    except InputError:
        return stones.panel


def _cells(stones: Assemblage, walls: Sequence[StoneWall], rings: Sequence[Ring]) -> list[UnitCell]:
    """Return the unit cell of each wall; that of its arch where it has no other stones."""
    laid = [np.setdiff1d(np.arange(len(wall.elevations)), ring[1]) for wall, ring in zip(walls, rings, strict=True)]
    known = [k for k, own in enumerate(laid) if len(own)]
    found = unit_cells([courses_of(walls[k].elevations[laid[k]], stones.volume[walls[k].stones[laid[k]]]) for k in known])
    cells = dict(zip(known, found, strict=True))
    return [cells[k] if k in cells else ring[0][0].cell for k, ring in enumerate(rings)]


def _panel(
    stones: Assemblage,
    wall: StoneWall,
    walls: Sequence[StoneWall],
    bent: float,
    ring: Ring,
    cell: UnitCell,
) -> Panel:
    """Return the panel of a wall with its arches and their stones; bent: how far rounded coordinates may bend a slope of its
    outline, m, 0 where none are."""
    own = wall.elevations
    sections = filled(stones, wall, walls, _APART)
    region = max(closed(sections, _APART), key=lambda part: float(common_areas(own, part).sum()))
    whole, openings = _openings(region)
    if bent:
        whole = simplified(whole, bent)
    arches, voussoirs = ring
    laid = np.setdiff1d(np.arange(len(own)), voussoirs)
    openings = [hole for hole in openings if area(hole) > LEAST_OPENING * cell.a * cell.b]
    marks = all_coordinates(sections)
    outline = _outline(whole, marks)
    lintels = _lintels(own[laid], openings, cell)
    ringed = _ring_parts(wall, own, voussoirs, arches)
    regions = (*((BondRegion("bond", outline, _pattern(own[laid], cell), cell),) if len(laid) else ()), *lintels, *arches)
    materials, count = np.unique(stones.material[wall.stones], return_counts=True)
    return Panel(
        wall.name,
        wall.chart,
        outline,
        wall.thickness,
        regions,
        material=str(materials[np.argmax(count)]),
        openings=tuple(_opening(f"opening-{k}", hole, marks, arches) for k, hole in enumerate(openings, start=1)),
        runs_through=_parity(wall, walls, cell),
        parts=(*ringed, *wall_parts(wall, walls, outline, 0.5 * cell.b, [part.name for part in ringed])),
    )


def _ring_parts(wall: StoneWall, own: Polygons, voussoirs: IntArray, arches: Sequence[BondRegion]) -> list[Part]:
    """Return the rings of voussoirs that have a name of their own in their wall, as of a layer, each as a part of the wall.

    A name that is also that of other stones is none: its part is a box, of `wall_parts`.
    """
    found: list[Part] = []
    for name in dict.fromkeys(wall.tag[voussoirs].tolist()):
        stones = np.flatnonzero(wall.tag == name)
        if name == wall.name or not np.isin(stones, voussoirs).all():
            continue
        middles = centroids(own[stones])
        found += [Part(name, arch.outline) for arch in arches if contains(polygon(arch.outline), middles).any()]
    return found


def _openings(region: Polygon) -> tuple[Region, list[Polygon]]:
    """Return the wall without its openings, and the openings: holes, and notches in the base, which are doors."""
    outer, *inner = rings(region)
    whole = polygon(outer)
    base = float(outer[:, 1].min())
    doors = [notch for notch, mouth in notches(whole, GRID) if mouth[3] < base + GRID]
    filled = pieces(united([whole, *doors], GRID))
    return (filled[0] if len(filled) == 1 else whole), [*doors, *map(polygon, inner)]


def _opening(name: str, hole: Polygon, marks: FloatArray, rings: Sequence[BondRegion]) -> Opening:
    outline = _outline(hole, marks)
    around = tuple(ring.name for ring in rings if within(hole, polygon(ring.outline), _APART))
    edge = np.abs(np.roll(outline, -1, axis=0) - outline)
    return Opening(name, outline, "arched" if around or edge.min(axis=1).max() > GRID else "rectangular", around)


def _outline(region: Region, marks: FloatArray) -> FloatArray:
    """Return the corners of a region, counter-clockwise. Corners that rounding to the grid has moved are put back onto the
    stones' own.
    """
    outline = corners(np.array([region], dtype=np.object_))[0]
    apart, nearest = cKDTree(marks).query(outline)
    return np.where(np.asarray(apart)[:, None] < 2 * GRID, marks[nearest], outline)


def _lintels(elevations: Polygons, openings: Sequence[Region], cell: UnitCell) -> list[BondRegion]:
    extents = bounds(elevations)
    found: list[BondRegion] = []
    for hole in openings:
        left, _, right, top = extent(hole)
        over = (np.abs(extents[:, 1] - top) < 0.1 * cell.a) & (extents[:, 0] < left + GRID) & (extents[:, 2] > right - GRID)
        for front in elevations[over & (extents[:, 2] - extents[:, 0] > LINTEL * cell.b)]:
            # Where the ends of a full circle meet, a stone has a piece at each, and spans nothing.
            if len(pieces(front)) > 1:
                continue
            found.append(BondRegion(f"lintel-{len(found) + 1}", corners(np.array([front]))[0], "single", cell, yields=False))
    return found


def _pattern(elevations: Polygons, cell: UnitCell) -> Literal["running", "stack"]:
    """Return "stack" where most head joints go on in the stones above, else "running"; courses may differ in height."""
    start, bottom, end, top = bounds(elevations).T
    near = 0.05 * cell.b
    above = top + 0.1 * (top - bottom)
    goes_on: list[bool] = []
    for s, middle, over in zip(start, 0.5 * (bottom + top), above, strict=True):
        beside, higher = ((bottom < level) & (top > level) for level in (middle, over))
        parted = bool((higher & (np.abs(start - s) < near)).any())
        bridged = bool((higher & (start < s - near) & (end > s + near)).any())
        if (beside & (np.abs(end - s) < near)).any() and (parted or bridged):
            goes_on.append(parted)
    return "stack" if goes_on and np.mean(goes_on) > 0.7 else "running"


def _parity(wall: StoneWall, walls: Sequence[StoneWall], cell: UnitCell) -> Literal[0, 1] | None:
    """Return on which courses, even or odd, the wall's own stones fill its junctions; None: on both."""
    _, low, _, high = total_extent(wall.elevations)
    middle = bounds(wall.elevations)[:, [1, 3]].mean(axis=1)
    odd = np.floor(middle / cell.a).astype(np.int64) % 2 == 1
    share = np.zeros(2)
    for start, stop in junction_spans(wall, walls):
        area = common_areas(wall.elevations, boxes(np.array([[start, low, stop, high]]))[0])
        share += [area[~odd].sum(), area[odd].sum()]
    if share.min() > 0.8 * share.max() > 0:
        return None
    return 1 if share[1] > share[0] else 0
