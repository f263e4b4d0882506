"""Laying a field in horizontal courses."""

from collections.abc import Callable

import numpy as np

from churchpipe.bond.field import Field
from churchpipe.bond.slivers import LEAST_HEIGHT, LEAST_WIDTH, merge_slivers
from churchpipe.bond.tiles import TileSet, tiles_of
from churchpipe.errors import InputError
from churchpipe.geometry.charts import ALONG
from churchpipe.geometry.planar import (
    Polygons,
    Region,
    all_coordinates,
    area,
    areas,
    bounds,
    boxes,
    clip,
    common,
    covered,
    distances,
    distances_to,
    extent,
    has_hole,
    inner_points,
    moved,
    polygon,
    shared_edges,
    united,
    vertices,
)
from churchpipe.geometry.polygons import TOLERANCE, snap, snap_onto, snap_polygons
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.building import UnitCell


def lay_courses(field: Field, cell: UnitCell, joints: Callable[[int], FloatArray]) -> TileSet:
    """Return the stones of a field laid in courses of height `cell.a`, counted from t = 0.

    A course and the interval between two head joints bound one cell. The outline of the field cuts the cells, and pieces that
    are too small (slivers) are merged into a neighbour. Stones beside the arched openings of a curved wall are returned as whole
    cells; `stones.pierced` cuts them as solids.

    Parameters
    ----------
    field: what is to be filled. cell: course height and stone length. joints: function from a course to s of its head joints, m.
    """
    _, low, _, high = extent(field.solid)
    first, last = int(np.floor(low / cell.a + TOLERANCE)), int(np.ceil(high / cell.a - TOLERANCE))
    if first < 0:
        raise InputError(field.name, "masonry below the first course", found=f"t = {low:g} m", expected="t >= 0")
    marks = vertices(field.solid)
    lines = snap_onto(cell.a * np.arange(first, last + 1, dtype=np.float64), marks[:, 1])
    rows: list[FloatArray] = []
    for course in range(first, last):
        bottom, top = lines[course - first : course - first + 2]
        own = clear_of_voids(field, cell, (bottom, top), joints(course)) if field.voids else joints(course)
        s = snap_onto(snap(np.unique(np.concatenate((field.span, own)))), marks[:, 0])
        s = np.unique(s[(s >= field.span[0]) & (s <= field.span[1])])
        height = np.ones(len(s) - 1)
        rows.append(np.stack([s[:-1], bottom * height, s[1:], top * height, course * height], axis=1))
    if not rows:
        raise InputError(field.name, "lower than rounding", found=f"{high - low:g} m", expected=f"courses of {cell.a:g} m")
    cells = np.concatenate(rows)
    whole, course = boxes(cells[:, :4]), cells[:, 4].astype(np.int64)
    if field.voids:
        # Junctions and the end of the wall cut the cells here. Arched openings cut the stones later, as solids.
        whole, course = cut(whole, course, united([field.solid, *(void.filling for void in field.voids)]), field.name)
    polygons, course = cut(whole, course, field.solid, field.name)
    pieces = polygons
    if field.closed:
        polygons, course = _joined_at_seam(polygons, course, field, joints)
    polygons, course = merge_slivers(polygons, course, cell, field.name)
    if field.voids:
        if field.closed:
            # A stone that crosses the seam is given at the start of the wall, with s below its first value.
            pieces, whole = (np.concatenate([p, _shifted(p, field.span[0] - field.span[1])]) for p in (pieces, whole))
        polygons = _uncut(polygons, pieces, whole)
    return tiles_of(polygons, course, field.name)


def clear_of_voids(field: Field, cell: UnitCell, course: tuple[float, float], joints: FloatArray) -> FloatArray:
    """Return the head joints of one course of a curved wall that leave room beside arched openings, s in m.

    Head joints of a curved wall are radial, the sides of an opening are parallel. A joint that runs into such a side, or ends
    nearer to it than a quarter of a stone, would leave a wedge whose thickness tapers to nothing, so it is left out. It stays
    where the masonry above or below the opening is high enough there. Where the opening takes up all of the course, or nearly
    so, the masonry to its left and to its right is divided by a joint in the middle plane of the opening.

    Parameters
    ----------
    cell: course height and stone length. course: its bottom and top, t in m. joints: those of the bond.
    """
    bottom, top = course
    most = (1 - LEAST_HEIGHT) * (top - bottom)
    added: list[float] = []
    for void in field.voids:
        blocked = common(polygon(void.outer), boxes(np.array([[-np.inf, bottom, np.inf, top]]).clip(-1e3, 1e3))[0])
        if area(blocked) == 0:
            continue
        x0, _, x1, _ = extent(blocked)
        span = np.array([void.x_at(s, field.radius) for s in joints]).reshape(-1, 2) + LEAST_WIDTH * cell.b * np.array(
            [-1.0, 1.0]
        )
        beside = (span[:, 1] < x0) | (span[:, 0] > x1) | ~void.faces(joints, field.radius)
        over = (span[:, 0] > x0) & (span[:, 1] < x1)
        over &= [_height(blocked, low, high) < most for low, high in span]
        joints = joints[beside | over]
        if _height(blocked, -TOLERANCE, TOLERANCE) > most:
            added.append(void.middle)
    return np.concatenate((joints, added))


def _height(region: Region, low: float, high: float) -> float:
    """Return how high a region is between x = low and x = high, m."""
    _, t0, _, t1 = extent(region)
    part = common(region, boxes(np.array([[low, t0 - 1.0, high, t1 + 1.0]]))[0])
    return 0.0 if area(part) == 0 else float(np.ptp(extent(part)[[1, 3]]))


def _shifted(polygons: Polygons, by: float) -> Polygons:
    return moved(polygons, all_coordinates(polygons) + np.array([by, 0.0]))


def _uncut(polygons: Polygons, pieces: Polygons, cells: Polygons) -> Polygons:
    """Return the tiles. Those with a piece cut by an opening are made of the whole cells that their pieces come from."""
    inner = inner_points(pieces)
    owner = np.array([distances_to(cells, point).argmin() for point in inner])
    was_cut = areas(pieces) < (1 - TOLERANCE) * areas(cells[owner])
    out = polygons.copy()
    for number, tile in enumerate(polygons):
        own = distances(tile, inner) == 0
        if (own & was_cut).any():
            out[number] = united(np.concatenate([pieces[own & ~was_cut], cells[owner[own & was_cut]]]))
    return out


def _joined_at_seam(
    polygons: Polygons, course: IntArray, field: Field, joints: Callable[[int], FloatArray]
) -> tuple[Polygons, IntArray]:
    """Return the tiles of a closed wall. In courses without a joint at the seam the first and the last tile are joined."""
    start, stop = field.span
    low, _, high, _ = bounds(polygons).T
    polygons, kept = polygons.copy(), np.ones(len(polygons), dtype=np.bool_)
    for last in np.flatnonzero(high > stop - TOLERANCE):
        if (np.abs(joints(int(course[last])) - start) < TOLERANCE).any():
            continue
        beyond = _shifted(polygons[[last]], start - stop)
        firsts = np.flatnonzero((low < start + TOLERANCE) & (course == course[last]) & kept)
        shared = shared_edges(polygons[firsts], beyond[0])
        if len(firsts) and shared.max() > TOLERANCE:
            first = firsts[shared.argmax()]
            whole = united(np.concatenate([polygons[[first]], beyond]))
            polygons[first] = snap_polygons(np.array([whole], dtype=np.object_))[0][0]
            kept[last] = False
    return polygons[kept], course[kept]


def cut(cells: Polygons, course: IntArray, solid: Region, where: str) -> tuple[Polygons, IntArray]:
    """Return the parts of the cells inside a solid region, with their courses; whole cells keep their exact corners."""
    whole = covered(cells, solid)
    pieces, owner = clip(cells[~whole], solid)
    keep = areas(pieces) > TOLERANCE * areas(cells[~whole])[owner]
    polygons, piece = snap_polygons(np.concatenate([cells[whole], pieces[keep]]))
    courses = np.concatenate([course[whole], course[~whole][owner[keep]]])[piece]
    holed = has_hole(polygons)
    if holed.any():
        s, t, _, _ = bounds(polygons[holed])[0]
        raise InputError(
            where,
            "an opening lies inside one stone",
            found=f"near {s:.4g} {ALONG} and {t:.4g} m up",
            remedy="Make the opening larger, the stones shorter, or leave it out.",
        )
    return polygons, courses
