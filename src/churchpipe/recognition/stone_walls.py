"""The walls that stones belong to, plane and curved, with their charts. Stones of several names in one plane are one wall."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations, permutations

import numpy as np

from churchpipe.geometry.charts import lift, normals
from churchpipe.geometry.clusters import components
from churchpipe.geometry.planar import Polygons, area, common, total_extent, united, within
from churchpipe.model.arrays import FloatArray, IntArray, NameArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import Chart, CylinderChart, Panel, PlaneChart
from churchpipe.recognition.curved_walls import curved_walls, points_of, within_arc
from churchpipe.recognition.elevations import elevations
from churchpipe.recognition.wall_planes import (
    LEAST_LEAF,
    PLANE_TOLERANCE,
    WallPlane,
    behind_one_another,
    wall_planes,
)
from churchpipe.stones.raggedness import STRAIGHT, TURN, Raggedness

# Walls further from the origin than this, m, are sought beside it: rounded coordinates turn their planes about the origin.
_FAR = 10.0
NONE: IntArray = np.empty(0, dtype=np.int64)


@dataclass(frozen=True, slots=True)
class StoneWall:
    """A wall: its name, its stones (n,), their names (n,), their elevations (n,) in its chart, its chart, its thickness m.

    Stones that bear another name than the wall are parts of it.
    """

    name: str
    stones: IntArray
    tag: NameArray
    elevations: Polygons
    chart: Chart
    thickness: float


@dataclass(frozen=True, slots=True)
class Stretch:
    """A plane stretch of a wall: a chart in which s is that of the wall, and the reach low to high of the stretch, m."""

    chart: PlaneChart
    low: float
    high: float


def stone_walls(
    stones: Assemblage, contact_gap: float, ragged: Raggedness = STRAIGHT, cut: IntArray = NONE
) -> tuple[list[StoneWall], IntArray]:
    """Return the walls of an assemblage, and the free stones that fit none.

    contact_gap: how far apart stones of one may be, m. ragged: how far corners lie off their walls. cut: stones that are known to
    be cut out of a round wall (see `cut_stones`), and stand in no plane one.

    Raises
    ------
    InputError: stones of one name, or without one, in two leaves.
    """
    far = np.append(np.rint(stones.points[:, :2].mean(axis=0)), 0.0)
    if np.abs(far).max() > _FAR:
        near = replace(stones, points=stones.points - far, centroid=stones.centroid - far)
        walls, unfit = stone_walls(near, contact_gap, ragged, cut)
        return [replace(wall, chart=_shifted(wall.chart, far)) for wall in walls], unfit
    base = float(stones.points[np.repeat(~stones.fixed, np.diff(stones.block_point_ptr))][:, 2].min())
    curved, seen = curved_walls(stones, base, ragged)
    free = ~stones.fixed
    free[cut] = free[seen] = False
    for wall in curved:
        free[wall.stones] = False
    planes = wall_planes(stones, free, ragged)
    _check_leaves(stones, [plane for plane in planes if not stones.panel[plane.stones[0]]], base, contact_gap, ragged)
    walls = [_plane_wall(stones, group, base, ragged) for group in _joined(stones, planes, base, contact_gap, ragged)]
    for number, wall in enumerate(curved, start=1):
        name = wall.name or f"curved-wall-{number}"
        shown = elevations(stones, wall.stones, wall.chart, wall.thickness, ragged)
        walls.append(StoneWall(name, wall.stones, np.full(len(wall.stones), name), shown, wall.chart, wall.thickness))
    walls.sort(key=lambda wall: wall.name)
    fitted = np.concatenate([wall.stones for wall in walls]) if walls else np.empty(0, dtype=np.int64)
    return walls, np.setdiff1d(np.flatnonzero(~stones.fixed), fitted)


def cut_stones(stones: Assemblage, walls: Sequence[StoneWall] | Sequence[Panel], unfit: IntArray) -> IntArray:
    """Return those of the stones that fit no wall which lie within a round one, as the voussoirs of its openings do."""
    within = np.zeros(len(unfit), dtype=np.bool_)
    for wall in walls:
        if isinstance(wall.chart, CylinderChart):
            within |= within_arc(stones, unfit, wall.chart, wall.thickness)
    return unfit[within]


def _shifted(chart: Chart, by: FloatArray) -> Chart:
    if isinstance(chart, PlaneChart):
        return replace(chart, origin=chart.origin + by)
    return replace(chart, centre=chart.centre + by)


def stretches(wall: StoneWall) -> list[Stretch]:
    """Return the plane stretches of a wall: the whole of a plane one, the legs of a curved one."""
    low, _, high, _ = map(float, total_extent(wall.elevations))
    chart = wall.chart
    if isinstance(chart, PlaneChart):
        return [Stretch(chart, low, high)]
    end = chart.radius * chart.sweep
    found: list[Stretch] = []
    for s, first, last in ((0.0, low, 0.0), (end, end, high)):
        if last - first > PLANE_TOLERANCE:
            place = np.array([[s, 0.0]])
            tangent = np.cross([0.0, 0.0, 1.0], normals(chart, place)[0])
            found.append(Stretch(PlaneChart(lift(chart, place)[0] - s * tangent, tangent), first, last))
    return found


def _check_leaves(stones: Assemblage, planes: Sequence[WallPlane], base: float, contact_gap: float, ragged: Raggedness) -> None:
    """Raise InputError for two walls of stones without a name that lie against one another: leaves of one wall."""
    for one, other in permutations(planes, 2):
        apart = abs(one.offset - other.offset) - 0.5 * (one.thickness + other.thickness)
        if np.abs(one.normal - other.normal).max() > PLANE_TOLERANCE or abs(apart) > contact_gap:
            continue
        chart = _chart(stones, one, base)
        first, second = (united(elevations(stones, wall.stones, chart, wall.thickness, ragged)) for wall in (one, other))
        if area(common(first, second)) > LEAST_LEAF * area(first):
            raise behind_one_another("stones without a panel name", len(one.stones), len(other.stones), ragged)


def _joined(
    stones: Assemblage, planes: Sequence[WallPlane], base: float, contact_gap: float, ragged: Raggedness
) -> list[list[WallPlane]]:
    """Return plane walls that lie in one plane, are as thick and touch as one, that first which most others touch."""
    links = np.zeros((len(planes), len(planes)), dtype=np.bool_)
    for i, j in combinations(range(len(planes)), 2):
        if _one_plane(stones, planes[i], planes[j], ragged):
            chart = _chart(stones, planes[i], base)
            first, second = (united(elevations(stones, planes[k].stones, chart, planes[i].thickness, ragged)) for k in (i, j))
            links[i, j] = links[j, i] = within(first, second, contact_gap)
    label = components(len(planes), np.argwhere(links))
    volume = [float(stones.volume[p.stones].sum()) for p in planes]
    rank = np.lexsort((-np.array(volume), -links.sum(axis=1)))
    return [[planes[int(k)] for k in rank if label[k] == number] for number in np.unique(label)]


def _one_plane(stones: Assemblage, one: WallPlane, other: WallPlane, ragged: Raggedness) -> bool:
    """Return whether the middles of the stones of either wall lie in the plane of the other, which is as thick."""
    if np.abs(one.normal - other.normal).max() > TURN or abs(one.thickness - other.thickness) > max(
        PLANE_TOLERANCE, ragged.counted
    ):
        return False
    # Their own planes are known where they stand.
    apart = [
        np.average(stones.centroid[wall.stones], axis=0, weights=stones.volume[wall.stones]) @ plane.normal - plane.offset
        for wall, plane in ((one, other), (other, one))
    ]
    return float(np.abs(apart).max()) < ragged.flat


def _plane_wall(stones: Assemblage, group: Sequence[WallPlane], base: float, ragged: Raggedness) -> StoneWall:
    main = group[0]
    own = np.concatenate([part.stones for part in group])
    tag = np.repeat([part.name for part in group], [len(part.stones) for part in group])
    order = np.argsort(own)
    own, tag = own[order], tag[order]
    whole = WallPlane(main.name, own, main.normal, main.offset, main.thickness)
    chart = _chart(stones, whole, base)
    return StoneWall(main.name, own, tag, elevations(stones, own, chart, main.thickness, ragged), chart, main.thickness)


def _chart(stones: Assemblage, wall: WallPlane, base: float) -> PlaneChart:
    along = np.cross([0.0, 0.0, 1.0], wall.normal)
    own = points_of(stones, wall.stones)
    start = float((stones.points[own] @ along).min())
    return PlaneChart(wall.offset * wall.normal + start * along + np.array([0.0, 0.0, base]), along)
