"""Laying a field in horizontal courses."""

from collections.abc import Callable

import numpy as np

from churchpipe.bond.field import Field
from churchpipe.bond.planar import (
    Polygons,
    all_coordinates,
    areas,
    bounds,
    boxes,
    clip,
    covered,
    extent,
    has_hole,
    moved,
    shared_edges,
    united,
    vertices,
)
from churchpipe.bond.polygons import TOLERANCE, snap, snap_onto, snap_polygons
from churchpipe.bond.slivers import merge_slivers
from churchpipe.bond.tiles import TileSet, tiles_of
from churchpipe.errors import InputError
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.building import UnitCell


def lay_courses(field: Field, cell: UnitCell, joints: Callable[[int], FloatArray]) -> TileSet:
    """Return the stones of a field laid in courses of height `cell.a`, counted from t = 0.

    Cells (course x joint interval) are cut by the field's outline; slivers are merged into a neighbour.

    Parameters
    ----------
    field: what is to be filled. cell: course height and stone length. joints: course -> s of its head joints, m.
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
        s = snap_onto(snap(np.unique(np.concatenate((field.span, joints(course))))), marks[:, 0])
        s = np.unique(s[(s >= field.span[0]) & (s <= field.span[1])])
        height = np.ones(len(s) - 1)
        rows.append(np.stack([s[:-1], bottom * height, s[1:], top * height, course * height], axis=1))
    cells = np.concatenate(rows)
    polygons, course = cut(boxes(cells[:, :4]), cells[:, 4].astype(np.int64), field)
    if field.closed:
        polygons, course = _joined_at_seam(polygons, course, field, joints)
    polygons, course = merge_slivers(polygons, course, cell, field.name)
    return tiles_of(polygons, course, field.name)


def _joined_at_seam(
    polygons: Polygons, course: IntArray, field: Field, joints: Callable[[int], FloatArray]
) -> tuple[Polygons, IntArray]:
    """Return the tiles of a closed wall, the first and last one of a course joined where it has no joint at the seam."""
    start, stop = field.span
    low, _, high, _ = bounds(polygons).T
    kept = np.ones(len(polygons), dtype=np.bool_)
    for last in np.flatnonzero(high > stop - TOLERANCE):
        if (np.abs(joints(int(course[last])) - start) < TOLERANCE).any():
            continue
        beyond = moved(polygons[[last]], all_coordinates(polygons[[last]]) - [stop - start, 0.0])
        firsts = np.flatnonzero((low < start + TOLERANCE) & (course == course[last]) & kept)
        shared = shared_edges(polygons[firsts], beyond[0])
        if len(firsts) and shared.max() > TOLERANCE:
            first = firsts[shared.argmax()]
            whole = united(np.concatenate([polygons[[first]], beyond]))
            polygons[first] = snap_polygons(np.array([whole], dtype=np.object_))[0]
            kept[last] = False
    return polygons[kept], course[kept]


def cut(cells: Polygons, course: IntArray, field: Field) -> tuple[Polygons, IntArray]:
    """Return the parts of the cells inside the field, with their courses; whole cells keep their exact corners."""
    whole = covered(cells, field.solid)
    pieces, owner = clip(cells[~whole], field.solid)
    keep = areas(pieces) > TOLERANCE * areas(cells[~whole])[owner]
    polygons = snap_polygons(np.concatenate([cells[whole], pieces[keep]]))
    courses = np.concatenate([course[whole], course[~whole][owner[keep]]])
    holed = has_hole(polygons)
    if holed.any():
        s, t, _, _ = bounds(polygons[holed])[0]
        raise InputError(
            field.name,
            "an opening lies inside one stone",
            found=f"near s = {s:g}, t = {t:g} m",
            remedy="Make the opening larger, the stones shorter, or leave it out.",
        )
    return polygons, courses
