"""Junctions of walls: where footprints cross, and which wall each course of the crossing belongs to."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from churchpipe.bond.zones import merged
from churchpipe.errors import InputError
from churchpipe.geometry.charts import along, base_level, footprint, footprint_of
from churchpipe.geometry.planar import Region, area, areas, boxes, common, common_areas, pieces, vertices
from churchpipe.geometry.polygons import TOLERANCE, snap_onto
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.building import Junction, Panel, PlaneChart

# Cosine of the angle of two walls above which they are no longer at right angles.
SQUARE = 1e-4
# Share of a wall's thickness by which corners miss each other as those of rounded coordinates do.
_ROUNDED = 0.02


@dataclass(frozen=True, slots=True)
class WallJunctions:
    """The junctions of one wall: crossed (nc, 4), s0, t0, s1, t1 of each wall that crosses it, from face to face and where both
    are; ceded (nl, 4), the rectangles of them that belong to other walls; dry (nd, 4), those of these that the wall butts against
    without mortar. All in m, chart coordinates."""

    crossed: FloatArray
    ceded: FloatArray
    dry: FloatArray

    @property
    def zones(self) -> FloatArray:
        """The zones of the whole height (nz, 2), s from face to face in m, disjoint and sorted."""
        return merged(self.crossed[:, [0, 2]])


@dataclass(frozen=True, slots=True)
class Crossing:
    """Where two walls cross: the junction zone is the intersection of their footprints in plan.

    walls: their numbers, first and second. spans (2, 2) m: s of the zone's faces along each. levels (n + 1,) m: z that bound
    bands; owner (n,): 0 or 1, the wall that owns the zone in each band, -1 where only one of them exists; dry (n,): where the
    other wall butts against it without mortar.
    """

    walls: tuple[int, int]
    spans: FloatArray
    levels: FloatArray
    owner: IntArray
    dry: BoolArray


def crossings(panels: Sequence[Panel], solids: Sequence[Region], junctions: Sequence[Junction] = ()) -> list[Crossing]:
    """Return the crossings of walls in pairs, found from their footprints: corners, T-junctions, X-junctions, legs of an apse.

    Where both walls exist at a height, the stones of the junction belong to one of them, its owner: the wall whose `filled` has
    them, where either wall has any there; a wall with `runs_through` None, else the wall whose parity is that of the course, else
    the one listed first. Where only one wall fills the whole junction, it is the owner.

    Parameters
    ----------
    panels: the walls, upright. solids: outline less openings of each, chart coordinates. junctions: of pairs of walls whose
    owner is not found by this rule.

    Raises
    ------
    InputError: walls that cross at a slant or only in part, toothed walls whose courses do not line up, a junction that
        neither wall fills, one that is declared of walls that do not meet.
    """
    plans = [footprint_of(p) for p in panels]
    found: list[Crossing] = []
    zones = ((i, j, zone) for i, j in combinations(range(len(panels)), 2) for zone in pieces(common(plans[i], plans[j])))
    for i, j, zone in zones:
        if area(zone) <= TOLERANCE * min(panels[i].thickness, panels[j].thickness) ** 2:
            continue
        marks = [vertices(solids[k])[:, 1] + base_level(panels[k].chart) for k in (i, j)]
        if min(m.max() for m in marks) - max(m.min() for m in marks) <= TOLERANCE:
            continue
        spans = np.stack([_zone_span(panels, k, zone, (i, j)) for k in (i, j)])
        levels, course = _bands(panels[i], panels[j], spans, marks)
        cover = [_cover(panels[k], solids[k], span, levels) for k, span in zip((i, j), spans, strict=True)]
        both = (cover[0] > TOLERANCE) & (cover[1] > TOLERANCE)
        if not both.any():
            continue
        whole = [share > 1 - TOLERANCE for share in cover]
        if (both & ~whole[0] & ~whole[1]).any():
            level = levels[:-1][both & ~whole[0] & ~whole[1]][0]
            raise InputError(
                f"junction of {panels[i].name} and {panels[j].name}",
                "neither wall fills it",
                found=f"openings or slopes in both at z = {level:g} m",
                remedy="Keep openings and slopes of one of the walls out of the junction.",
            )
        declared = next((one for one in junctions if set(one.walls) == {panels[i].name, panels[j].name}), None)
        by_rule = _first_fills(panels[i], panels[j], spans, levels)
        if by_rule is None:
            by_rule = _first_owns(panels[i], panels[j], declared, course)
        owner = np.where(both, np.where(np.where(whole[0] == whole[1], by_rule, whole[0]), 0, 1), -1)
        dry = np.zeros(len(course), dtype=np.bool_)
        if declared is not None:
            butting = (i, j).index(next(k for k in (i, j) if panels[k].name == declared.walls[1]))
            dry = (owner == 1 - butting) & ((declared.every != 2) | _cracked(declared, panels[(i, j)[butting]], course))
        found.append(Crossing((i, j), spans, levels, owner, dry))
    meeting = [{panels[wall].name for wall in crossing.walls} for crossing in found]
    for junction in junctions:
        if set(junction.walls) not in meeting:
            raise InputError(
                f"junction of {' and '.join(junction.walls)}", "the walls do not meet", expected="two walls that cross"
            )
    return found


def wall_junctions(panels: Sequence[Panel], solids: Sequence[Region], junctions: Sequence[Junction] = ()) -> list[WallJunctions]:
    """Return the junctions of each wall: their extent, and which parts belong to other walls. Arguments as for `crossings`."""
    none = np.empty((0, 4))
    crossed: list[list[FloatArray]] = [[none] for _ in panels]
    ceded: list[list[FloatArray]] = [[] for _ in panels]
    dry: list[list[FloatArray]] = [[] for _ in panels]
    for crossing in crossings(panels, solids, junctions):
        for place, (wall, span) in enumerate(zip(crossing.walls, crossing.spans, strict=True)):
            loses = crossing.owner == 1 - place
            base = base_level(panels[wall].chart)
            low, high = crossing.levels[:-1][loses] - base, crossing.levels[1:][loses] - base
            rectangles = np.stack([np.full(len(low), span[0]), low, np.full(len(low), span[1]), high], axis=1)
            bottom, top = crossing.levels[[0, -1]] - base
            crossed[wall].append(np.array([[span[0], bottom, span[1], top]]))
            ceded[wall].append(rectangles)
            dry[wall].append(rectangles[crossing.dry[loses]])
    return [
        WallJunctions(np.concatenate(all_crossed), np.concatenate([none, *all_ceded]), np.concatenate([none, *all_dry]))
        for all_crossed, all_ceded, all_dry in zip(crossed, ceded, dry, strict=True)
    ]


def _zone_span(panels: Sequence[Panel], index: int, zone: Region, pair: tuple[int, int]) -> FloatArray:
    """Return s of the two faces of the zone along one of its walls."""
    panel = panels[index]
    s = along(panel.chart, vertices(zone))
    span = snap_onto(np.array([s.min(), s.max()]), panel.outline[:, 0])
    plan = footprint(panel.chart, panel.thickness, span[0], span[1])
    if abs(area(plan) - area(zone)) > 1e-6 * area(zone):
        found, remedy = "", "Extend the outline to the far face of the other wall, or stop it at the near face."
        charts = [panels[k].chart for k in pair]
        if isinstance(charts[0], PlaneChart) and isinstance(charts[1], PlaneChart):
            cosine = min(abs(float(charts[0].s_axis @ charts[1].s_axis)), 1.0)
            if cosine > 1 - SQUARE:
                raise _side_by_side(panels[pair[0]].name, panels[pair[1]].name, area(zone))
            if cosine > SQUARE:
                found = f"walls at {math.degrees(math.acos(cosine)):.4g} degrees, with "
                remedy = "Draw them at right angles, end one before the other, or draw the stones where they meet."
        off = float(np.linalg.norm(vertices(plan)[:, None] - vertices(zone), axis=2).min(axis=1).max())
        missed = ""
        if off < _ROUNDED * panel.thickness:
            missed = f" whose corners miss faces by {1e3 * off:.2g} mm, as those of rounded coordinates do"
            remedy = f"Export the drawing with more digits, or with its walls along x and y. If nothing was rounded: {remedy}"
        raise InputError(
            f"junction of {panels[pair[0]].name} and {panels[pair[1]].name}",
            "the walls do not cross squarely, face to face",
            found=f"{found}an overlap of {area(zone):.4g} m2 in plan{missed}",
            expected="footprints that cross at right angles, each through the whole thickness of the other or up to its face",
            remedy=remedy,
        )
    return span


def _side_by_side(first: str, second: str, shared: float) -> InputError:
    """Return the error of two parallel walls, one of which lies in part in the other; shared: area in plan, m2."""
    return InputError(
        f"walls {first} and {second}",
        "they are parallel, and one lies in part within the other, as where stones that project beyond their wall (corbels, "
        "cornices) or are thinner than it (tracery) were taken for a wall of their own",
        found=f"an overlap of {shared:.4g} m2 in plan",
        expected="walls that stand clear of each other, or end to end",
        remedy="Run the rigid blocks, which take such stones as they are. For a shell, give these stones the name (layer or "
        "PANEL) of the wall that they are in if they weigh little, leave them out, or draw the walls apart.",
    )


def _bands(first: Panel, second: Panel, spans: FloatArray, marks: Sequence[FloatArray]) -> tuple[FloatArray, IntArray]:
    """Return levels z (n + 1,) m that bound bands in which nothing changes, and the course (n,) of each band.

    spans (2, 2): s of the junction in either wall. marks: z of the corners of either wall.
    """
    low, high = max(m.min() for m in marks), min(m.max() for m in marks)
    a = first.regions[0].cell.a
    base = base_level(first.chart)
    toothed = None not in (first.runs_through, second.runs_through) and first.runs_through != second.runs_through
    drawn = [
        _filled_here(panel, span, low, high)[:, [1, 3]].ravel() + base_level(panel.chart)
        for panel, span in zip((first, second), spans, strict=True)
    ]
    toothed = toothed and not any(map(len, drawn))
    if toothed and (abs(a - second.regions[0].cell.a) > TOLERANCE or abs(base - base_level(second.chart)) > TOLERANCE):
        raise InputError(
            f"junction of {first.name} and {second.name}",
            "the courses of toothed walls do not line up",
            found=f"courses of {a:g} and {second.regions[0].cell.a:g} m from z = {base:g} and {base_level(second.chart):g} m",
            expected="equal courses from one level",
            remedy="Use one course height, or butt the walls (runs_through = None on one of them).",
        )
    lines = base + a * np.arange(int(np.floor((low - base) / a)), int(np.ceil((high - base) / a)) + 1, dtype=np.float64)
    marked = np.concatenate([*marks, *drawn])
    levels = np.unique(np.concatenate((marked, snap_onto(lines, marked))))
    levels = levels[(levels >= low) & (levels <= high)]
    levels = levels[np.append(True, np.diff(levels) > TOLERANCE)]
    middle = 0.5 * (levels[1:] + levels[:-1])
    return levels, np.floor((middle - base) / a).astype(np.int64)


def _cover(panel: Panel, solid: Region, span: FloatArray, levels: FloatArray) -> FloatArray:
    """Return the share of each band of the zone that the wall fills."""
    t = levels - base_level(panel.chart)
    level = np.ones(len(t) - 1)
    bands = boxes(np.stack([span[0] * level, t[:-1], span[1] * level, t[1:]], axis=1))
    return common_areas(bands, solid) / areas(bands)


def _first_fills(first: Panel, second: Panel, spans: FloatArray, levels: FloatArray) -> BoolArray | None:
    """Return in which bands (n,) the first of two walls fills their junction, as drawn; None where neither wall says it."""
    for panel, span, own in ((first, spans[0], True), (second, spans[1], False)):
        here = _filled_here(panel, span, levels[0], levels[-1])
        if len(here):
            t = 0.5 * (levels[1:] + levels[:-1])[:, None] - base_level(panel.chart)
            return ((here[:, 1] < t) & (t < here[:, 3])).any(axis=1) == own
    return None


def _filled_here(panel: Panel, span: FloatArray, low: float, high: float) -> FloatArray:
    """Return what a wall fills (n, 4) of one of its junctions: span (2,), s, and from z low to high, m."""
    s0, t0, s1, t1 = panel.filled.T
    base = base_level(panel.chart)
    return panel.filled[(s0 < span.mean()) & (span.mean() < s1) & (t0 + base < high - TOLERANCE) & (t1 + base > low + TOLERANCE)]


def _first_owns(first: Panel, second: Panel, declared: Junction | None, course: IntArray) -> BoolArray:
    """Return on which courses (n,) the first of two walls that both fill their junction owns it."""
    if declared is None:
        return _first_comes_first(first, second, course)
    butting = first if first.name == declared.walls[1] else second
    owns = np.zeros(len(course), dtype=np.bool_)
    if declared.every:
        # Of its own parity, on which a wall has a stone across the face of the junction.
        owns = course % declared.every == (butting.runs_through or 0)
    owns &= ~_cracked(declared, butting, course)
    return owns if butting is first else ~owns


def _cracked(junction: Junction, wall: Panel, course: IntArray) -> BoolArray:
    """Return which courses (n,) of a wall the crack of its junction touches."""
    if junction.cracked is None:
        return np.zeros(len(course), dtype=np.bool_)
    a, base = wall.regions[0].cell.a, base_level(wall.chart)
    low, high = junction.cracked
    return (base + a * (course + 1) > low + TOLERANCE) & (base + a * course < high - TOLERANCE)


def _first_comes_first(first: Panel, second: Panel, course: IntArray) -> BoolArray:
    def rank(panel: Panel) -> IntArray:
        if panel.runs_through is None:
            return np.zeros(len(course), dtype=np.int64)
        return np.where(course % 2 == panel.runs_through, 1, 2)

    return rank(first) <= rank(second)
