"""From the stones of a drawing to the panels that the shell is made of."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import shapely
from scipy.spatial import cKDTree

from churchpipe.bond.planar import Polygons, Region
from churchpipe.bond.polygons import corners
from churchpipe.derive.rings import voussoir_rings
from churchpipe.derive.wall_planes import WallPlane, wall_planes
from churchpipe.errors import InputError
from churchpipe.model.arrays import FloatArray, IntArray, NameArray, ragged_indices
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import BondRegion, Building, Opening, Panel, PlaneChart, Support, UnitCell
from churchpipe.model.materials import Material
from churchpipe.model.polyhedra import face_normals

# A lone stone over an opening is a lintel if it is longer than this many stones of the wall.
LINTEL = 1.25
GRID = 1e-6


@dataclass(frozen=True, slots=True)
class FittedBuilding:
    """Panels fitted to stones, and the ids of the free stones that fit no panel: they are missing from the shell.

    panel (nb,): the panel each stone went to, "" for none; what the gate compares the shell with.
    """

    building: Building
    unfit: NameArray
    panel: NameArray


def fit_panels(
    stones: Assemblage, materials: tuple[Material, ...], *, gap: float = 1e-3, name: str = "drawing"
) -> FittedBuilding:
    """Return the building whose mid-surfaces are those of the given stones; all walls plane and upright.

    Outline and openings are the union of the stones cut at the mid-plane, closed over joints, junctions with crossing walls
    included. Unit cell: the height and length that most stones (by volume) have. Lintels (long stones over an opening) are
    regions of one stone; voussoirs, known by their turning beds, are rings. Fixed stones are the supports. The courses of a
    crossing decide which wall runs through. The places of the head joints are not fitted: the stones remain the drawing's.

    Parameters
    ----------
    stones: as drawn. materials: theirs. gap: widest joint that is closed, m.

    Raises
    ------
    InputError: no wall can be fitted.
    """
    walls, unfit = wall_planes(stones)
    if not walls:
        raise InputError(
            "stones",
            "no wall can be fitted to them",
            expected="stones with two upright parallel faces",
            remedy="Tag the stones of each wall with PANEL, or run the rigid blocks alone.",
        )
    base = float(stones.points[np.repeat(~stones.fixed, np.diff(stones.block_point_ptr))][:, 2].min())
    panels = tuple(_panel(stones, wall, walls, base, gap) for wall in walls)
    fixed = np.flatnonzero(stones.fixed)
    building = Building(name, panels, materials, ground=None, supports=tuple(_support(stones, int(block)) for block in fixed))
    panel = np.full(stones.count, "", dtype=np.object_)
    for wall in walls:
        panel[wall.stones] = wall.name
    return FittedBuilding(building, stones.block_id[unfit], panel.astype(str))


def _support(stones: Assemblage, block: int) -> Support:
    start, stop = stones.block_point_ptr[block : block + 2]
    faces = np.arange(*stones.block_face_ptr[block : block + 2])
    nodes = [stones.face_nodes[stones.face_ptr[f] : stones.face_ptr[f + 1]] - start for f in faces]
    return Support(str(stones.block_id[block]), stones.points[start:stop].copy(), tuple(tuple(map(int, n)) for n in nodes))


def _chart(stones: Assemblage, wall: WallPlane, base: float) -> PlaneChart:
    along = np.cross([0.0, 0.0, 1.0], wall.normal)
    own = ragged_indices(stones.block_point_ptr[wall.stones], np.diff(stones.block_point_ptr)[wall.stones])
    start = float((stones.points[own] @ along).min())
    return PlaneChart(wall.offset * wall.normal + start * along + np.array([0.0, 0.0, base]), along)


def _panel(stones: Assemblage, wall: WallPlane, walls: Sequence[WallPlane], base: float, gap: float) -> Panel:
    chart = _chart(stones, wall, base)
    own = _fronts(stones, wall, chart)
    others = _sections(stones, np.setdiff1d(np.flatnonzero(~stones.fixed), wall.stones), wall, chart)
    beside = shapely.intersection(others, shapely.box(*shapely.total_bounds(own)))
    region = _closed(np.concatenate([own, beside[shapely.area(beside) > 0]]), own, gap)
    whole, openings = _openings(region)
    rings, voussoirs = voussoir_rings(own, gap)
    laid = np.setdiff1d(np.arange(len(own)), voussoirs)
    cell = _cell(own[laid], stones.volume[wall.stones[laid]]) if len(laid) else rings[0].cell
    marks = shapely.get_coordinates(own)
    outline = _outline(whole, marks)
    lintels = _lintels(own[laid], openings, cell)
    regions = (*((BondRegion("bond", outline, _pattern(own[laid], cell), cell),) if len(laid) else ()), *lintels, *rings)
    materials, count = np.unique(stones.material[wall.stones], return_counts=True)
    return Panel(
        wall.name,
        chart,
        outline,
        wall.thickness,
        regions,
        material=str(materials[np.argmax(count)]),
        openings=tuple(Opening(f"opening-{k}", _outline(hole, marks)) for k, hole in enumerate(openings, start=1)),
        runs_through=_parity(own, wall, walls, chart, cell),
    )


def _flat(chart: PlaneChart, points: FloatArray) -> FloatArray:
    return np.stack([(points - chart.origin) @ chart.s_axis, points[:, 2] - chart.origin[2]], axis=1)


def _fronts(stones: Assemblage, wall: WallPlane, chart: PlaneChart) -> Polygons:
    """Return the front of each stone of the wall, in chart coordinates."""
    _, normal, _ = face_normals(stones.points, stones.face_nodes, stones.face_ptr)
    fronts: list[shapely.Geometry] = []
    for block in wall.stones:
        faces = np.arange(*stones.block_face_ptr[block : block + 2])
        faces = faces[normal[faces] @ wall.normal > 1 - 1e-6]
        rings = [_flat(chart, stones.points[stones.face_nodes[stones.face_ptr[f] : stones.face_ptr[f + 1]]]) for f in faces]
        fronts.append(shapely.union_all([shapely.Polygon(ring) for ring in rings]))
    return np.array(fronts, dtype=np.object_)


def _sections(stones: Assemblage, blocks: IntArray, wall: WallPlane, chart: PlaneChart) -> Polygons:
    """Return the (convex hulls of the) sections of stones with the mid-plane of the wall, in chart coordinates."""
    first = stones.block_face_ptr[:-1][blocks]
    face = ragged_indices(first, np.diff(stones.block_face_ptr)[blocks])
    count = np.diff(stones.face_ptr)[face]
    block = np.repeat(np.repeat(blocks, np.diff(stones.block_face_ptr)[blocks]), count)
    place = ragged_indices(stones.face_ptr[:-1][face], count)
    last = np.cumsum(count) - 1
    after = np.append(place[1:], 0)
    after[last] = stones.face_ptr[:-1][face]
    start, stop = stones.points[stones.face_nodes[place]], stones.points[stones.face_nodes[after]]
    height, top = start @ wall.normal - wall.offset, stop @ wall.normal - wall.offset
    cut = height * top < 0
    share = (height[cut] / (height[cut] - top[cut]))[:, None]
    points = _flat(chart, start[cut] + share * (stop[cut] - start[cut]))
    _, owner = np.unique(block[cut], return_inverse=True)
    order = np.argsort(owner, kind="stable")
    hulls = np.asarray(shapely.convex_hull(shapely.multipoints(points[order], indices=owner.ravel()[order])), dtype=np.object_)
    return hulls[shapely.area(hulls) > 0]


def _closed(polygons: Polygons, own: Polygons, gap: float) -> shapely.Polygon:
    """Return the union closed over joints: the part of it that holds most of the wall's own stones."""
    grown = shapely.buffer(shapely.union_all(polygons, grid_size=GRID), gap, join_style="mitre", mitre_limit=10.0)
    closed = shapely.set_precision(shapely.buffer(grown, -gap, join_style="mitre", mitre_limit=10.0), GRID)
    parts = [part for part in shapely.get_parts(shapely.simplify(closed, 2 * GRID)) if isinstance(part, shapely.Polygon)]
    return max(parts, key=lambda part: float(shapely.area(shapely.intersection(own, part)).sum()))


def _openings(region: shapely.Polygon) -> tuple[shapely.Polygon, list[shapely.Polygon]]:
    """Return the wall without openings, and the openings: holes, and doors, which are notches in the base only."""
    whole = shapely.Polygon(region.exterior)
    hull = shapely.convex_hull(whole)
    base = float(shapely.bounds(whole)[1])
    doors: list[shapely.Polygon] = []
    for part in shapely.get_parts(shapely.difference(hull, whole)):
        on_hull = shapely.intersection(shapely.boundary(hull), shapely.boundary(part))
        if isinstance(part, shapely.Polygon) and on_hull.length > GRID and float(shapely.bounds(on_hull)[3]) < base + GRID:
            doors.append(part)
    filled = shapely.union_all([whole, *doors], grid_size=GRID)
    holes = [shapely.Polygon(ring) for ring in region.interiors]
    return (filled if isinstance(filled, shapely.Polygon) else whole), [*doors, *holes]


def _outline(region: shapely.Polygon, marks: FloatArray) -> FloatArray:
    """Return the corners of a region, counter-clockwise, those that the grid has moved put back onto the stones' corners."""
    outline = corners(np.array([region], dtype=np.object_))[0]
    apart, nearest = cKDTree(marks).query(outline)
    return np.where(np.asarray(apart)[:, None] < 2 * GRID, marks[nearest], outline)


def _common(values: FloatArray, weights: FloatArray) -> float:
    """Return the value that has most weight, to the micrometre; values that differ by less than two per cent are taken as one."""
    order = np.argsort(values)
    group = np.concatenate([[0], np.cumsum(np.diff(values[order]) > 0.02 * values[order][:-1])])
    best = group == np.argmax(np.bincount(group, weights[order]))
    return round(float(np.average(values[order][best], weights=weights[order][best])), 6)


def _cell(fronts: Polygons, volume: FloatArray) -> UnitCell:
    low_s, low_t, high_s, high_t = shapely.bounds(fronts).T
    return UnitCell(a=_common(high_t - low_t, volume), b=_common(high_s - low_s, volume))


def _lintels(fronts: Polygons, openings: Sequence[Region], cell: UnitCell) -> list[BondRegion]:
    bounds = np.asarray(shapely.bounds(fronts))
    found: list[BondRegion] = []
    for hole in openings:
        left, _, right, top = shapely.bounds(hole)
        over = (np.abs(bounds[:, 1] - top) < 0.1 * cell.a) & (bounds[:, 0] < left + GRID) & (bounds[:, 2] > right - GRID)
        for front in fronts[over & (bounds[:, 2] - bounds[:, 0] > LINTEL * cell.b)]:
            found.append(BondRegion(f"lintel-{len(found) + 1}", corners(np.array([front]))[0], "single", cell, yields=False))
    return found


def _pattern(fronts: Polygons, cell: UnitCell) -> Literal["running", "stack"]:
    """Return "stack" where most head joints go on in the next course, else "running"."""
    bounds = np.asarray(shapely.bounds(fronts))
    course = np.round(bounds[:, 1] / cell.a).astype(np.int64)
    inner = bounds[:, 0] > bounds[:, 0].min() + 0.1 * cell.b
    joint, course = bounds[inner, 0], course[inner]
    goes_on = [bool((np.abs(joint[course == k + 1] - s) < 0.05 * cell.b).any()) for s, k in zip(joint, course, strict=True)]
    below_top = course < course.max(initial=0)
    return "stack" if below_top.any() and np.mean(np.array(goes_on)[below_top]) > 0.7 else "running"


def _parity(
    fronts: Polygons, wall: WallPlane, walls: Sequence[WallPlane], chart: PlaneChart, cell: UnitCell
) -> Literal[0, 1] | None:
    """Return on which courses, even or odd, the wall's own stones fill its junctions; None: on both."""
    low_s, low_t, high_s, high_t = shapely.total_bounds(fronts)
    middle = shapely.bounds(fronts)[:, [1, 3]].mean(axis=1)
    odd = np.floor(middle / cell.a).astype(np.int64) % 2 == 1
    filled = np.zeros(2)
    for other in walls:
        slope = float(other.normal @ chart.s_axis)
        if other is wall or abs(slope) < 0.5:
            continue
        centre = float(other.offset - other.normal @ chart.origin) / slope
        start, stop = centre - 0.5 * other.thickness, centre + 0.5 * other.thickness
        if stop > low_s + GRID and start < high_s - GRID:
            area = shapely.area(shapely.intersection(fronts, shapely.box(start, low_t, stop, high_t)))
            filled += [area[~odd].sum(), area[odd].sum()]
    if filled.min() > 0.8 * filled.max() > 0:
        return None
    return 1 if filled[1] > filled[0] else 0
