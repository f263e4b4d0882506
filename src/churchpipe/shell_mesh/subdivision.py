"""Mid-surfaces cut into the faces that are meshed, with every border a mesh edge and every shared corner in place."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from churchpipe.errors import InputError
from churchpipe.geometry.charts import ALONG, base_level, counted_from
from churchpipe.geometry.clusters import NODE_TOLERANCE, clusters
from churchpipe.geometry.noding import faces_between
from churchpipe.geometry.planar import (
    Polygon,
    all_coordinates,
    contains,
    edges,
    extent,
    inner_points,
    moved,
    polygon,
    rings,
    vertices,
)
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.shell_mesh.midplanes import MidSurface, line_plan

# Grid to which coordinates are rounded while lines are cut, m, so that lines that nearly meet do meet.
GRID = 1e-6
# Borders of macro-elements carry names alone, so their corners give way to the wall's outline within this share of an element:
# corners fitted to stones end a few millimetres before a gable, and the strip between them would be meshed with slivers.
WELD = 0.1


@dataclass(frozen=True, slots=True)
class Subdivision:
    """The faces of one mid-surface, in chart coordinates, m.

    corners (n, 2); edges (ne, 2) corner numbers, each once; size (ne,) m, the largest element along it; loops: per face its
    outer ring and its holes as lists of corner numbers; bond (nf,) the bond region of each face.
    """

    corners: FloatArray
    edges: IntArray
    size: FloatArray
    loops: tuple[tuple[IntArray, ...], ...]
    bond: IntArray


def subdivide(surfaces: Sequence[MidSurface], sizes: Sequence[float]) -> list[Subdivision]:
    """Return the faces of all mid-surfaces.

    They are cut along the borders of bond regions and parts and along the mid-planes of crossing walls. Walls that meet on an
    upright line have the same corners on it.

    Parameters
    ----------
    surfaces: the mid-surfaces. sizes: element size of each, m; walls that meet take the smaller one on the shared line.
    """
    faces = [_faces(surface, size) for surface, size in zip(surfaces, sizes, strict=True)]
    stations = [np.unique(np.concatenate([surface.lines, extent(surface.region)[[0, 2]]])) for surface in surfaces]
    owner = np.repeat(np.arange(len(surfaces)), [len(s) for s in stations])
    station = np.concatenate(stations)
    plan = np.concatenate([line_plan(surface, s) for surface, s in zip(surfaces, stations, strict=True)])
    label = clusters(plan)
    base = np.array([base_level(surface.panel.chart) for surface in surfaces])
    marks = [_levels_on(faces[wall], s) + base[wall] for wall, s in zip(owner, station, strict=True)]
    finest = np.full(label.max() + 1, np.inf)
    np.minimum.at(finest, label, np.asarray(sizes)[owner])
    found: list[Subdivision] = []
    for wall, surface in enumerate(surfaces):
        own = np.flatnonzero(owner == wall)
        shared = [np.concatenate([marks[other] for other in np.flatnonzero(label == label[line])]) - base[wall] for line in own]
        polygons, bond = faces[wall], _bond_of(surface, faces[wall])
        for line, levels in zip(own, shared, strict=True):
            polygons = [_with_levels(face, station[line], _distinct(levels)) for face in polygons]
        found.append(_numbered(polygons, bond, station[own], finest[label[own]], sizes[wall]))
    return found


def _faces(surface: MidSurface, size: float) -> list[Polygon]:
    low, bottom, high, top = extent(surface.region)
    # Junction lines run over the whole height: a line that ended inside the wall would divide nothing.
    lines = [np.array([(s, bottom), (s, top)]) for s in surface.lines if low < s < high]
    parts = [_welded(part.outline, edges(surface.region), WELD * size) for part in surface.panel.parts]
    outlines = [*surface.regions, *parts]
    borders = [np.concatenate([outline, outline[:1]]) for outline in outlines]
    faces = faces_between(surface.region, [*borders, *lines], GRID)
    given = np.concatenate([vertices(surface.region), *outlines])
    marks = [np.append(given[:, 0], surface.lines), given[:, 1]]
    point = all_coordinates(faces)
    faces = moved(faces, np.stack([_onto(point[:, axis], marks[axis]) for axis in (0, 1)], axis=1))
    return list(faces[np.lexsort(np.round(inner_points(faces), 6).T)])


def _welded(corner: FloatArray, edge: FloatArray, reach: float) -> FloatArray:
    """Return the corners, those within reach of an edge moved onto it, or onto its end if that is within reach too."""
    start, along = edge[:, 0], edge[:, 1] - edge[:, 0]
    from_start = corner[:, None] - start
    share = np.clip((from_start * along).sum(axis=2) / (along**2).sum(axis=1), 0.0, 1.0)
    foot = start + share[..., None] * along
    each = np.arange(len(corner))
    for candidates in (foot, np.broadcast_to(start, foot.shape)):
        distance = np.linalg.norm(corner[:, None] - candidates, axis=2)
        nearest = distance.argmin(axis=1)
        found = distance[each, nearest]
        corner = np.where(((found > GRID) & (found < reach))[:, None], candidates[each, nearest], corner)
    return corner


def _onto(values: FloatArray, marks: FloatArray) -> FloatArray:
    """Return the values. Those that the grid has moved away from a mark get the value of that mark again."""
    ordered = np.unique(marks)
    place = np.clip(np.searchsorted(ordered, values), 1, len(ordered) - 1)
    nearest = np.where(values - ordered[place - 1] < ordered[place] - values, ordered[place - 1], ordered[place])
    return np.where(np.abs(nearest - values) <= GRID, nearest, values)


def _bond_of(surface: MidSurface, faces: Sequence[Polygon]) -> IntArray:
    inside = inner_points(np.array(faces, dtype=np.object_))
    bond = np.full(len(inside), -1, dtype=np.int64)
    for number, outline in enumerate(surface.regions):
        bond[contains(polygon(outline), inside)] = number
    if (bond < 0).any():
        place = inside[bond < 0][0]
        raise InputError(
            f"wall {surface.panel.name}",
            "a part of the wall has no bond",
            found=f"near {place[0]:.4g} {ALONG} and {place[1]:.4g} m up, {counted_from(surface.panel.chart)}",
            expected="bond regions that cover the wall",
        )
    return bond


def _levels_on(faces: Sequence[Polygon], s: float) -> FloatArray:
    point = all_coordinates(np.array(faces, dtype=np.object_))
    return np.unique(point[np.abs(point[:, 0] - s) < NODE_TOLERANCE, 1])


def _distinct(levels: FloatArray) -> FloatArray:
    ordered = np.sort(levels)
    return ordered[np.append(True, np.diff(ordered) > NODE_TOLERANCE)] if len(ordered) else ordered


def _with_levels(face: Polygon, s: float, levels: FloatArray) -> Polygon:
    """Return the face with corners added at the given heights on its edges along the line at s."""

    def refined(point: FloatArray) -> FloatArray:
        parts: list[FloatArray] = []
        for start, stop in pairwise(point):
            parts.append(start[None])
            if max(abs(start[0] - s), abs(stop[0] - s)) < NODE_TOLERANCE:
                low, high = sorted((start[1], stop[1]))
                between = levels[(levels > low + NODE_TOLERANCE) & (levels < high - NODE_TOLERANCE)]
                parts.append(np.stack([np.full(len(between), s), between[:: 1 if stop[1] > start[1] else -1]], axis=1))
        return np.concatenate(parts)

    outer, *holes = map(refined, rings(face))
    return polygon(outer, holes)


def _numbered(faces: Sequence[Polygon], bond: IntArray, stations: FloatArray, finest: FloatArray, size: float) -> Subdivision:
    outlines = [[ring[:-1] for ring in rings(face)] for face in faces]
    flat = [ring for face in outlines for ring in face]
    # Rounded once more, so that equal buildings from different sources get the same mesh in spite of different last digits.
    corners, number = np.unique(np.round(np.concatenate(flat), 11) + 0.0, axis=0, return_inverse=True)
    loops = np.split(number.ravel(), np.cumsum([len(ring) for ring in flat])[:-1])
    ends = np.concatenate([np.stack([loop, np.roll(loop, -1)], axis=1) for loop in loops])
    pairs = np.unique(np.sort(ends, axis=1), axis=0)
    largest = np.full(len(pairs), size)
    for s, shared in zip(stations, finest, strict=True):
        on_line = (np.abs(corners[pairs][:, :, 0] - s) < NODE_TOLERANCE).all(axis=1)
        largest[on_line] = np.minimum(largest[on_line], shared)
    counts = np.cumsum([0] + [len(face) for face in outlines])
    return Subdivision(
        corners,
        pairs,
        largest,
        tuple(tuple(loops[start:stop]) for start, stop in pairwise(counts)),
        bond,
    )
