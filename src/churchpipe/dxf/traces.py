"""The lines of a drawing: polylines, lines, arcs and boundaries of hatches as points in space."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
from ezdxf import path as paths

from churchpipe.dxf.definitions import Matrix, transformed
from churchpipe.findings import Place
from churchpipe.geometry.nets import farthest
from churchpipe.model.arrays import FloatArray

KINDS: Final = ("LWPOLYLINE", "POLYLINE", "HATCH", "LINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE")
# A curve is drawn with chords that leave it by at most the first part of the size of what it belongs to; finely, by the second.
CHORD, FINE = 0.01, 1e-4


@dataclass(frozen=True, slots=True)
class Trace:
    """One line as drawn.

    points (n, 3), drawing units, in space; closed: said to be closed, then the first point is not repeated; normal (3,): of the
    plane it is drawn in; depth: its DXF thickness, 0 when it has none; curve: how far a curve leaves the chords taken for it;
    filled: boundary of a hatch; bearing: drawn as ground; fine (m, 3): the points of a line with curves, drawn finely, the first
    one repeated when it is closed.
    """

    points: FloatArray
    closed: bool
    normal: FloatArray
    place: Place
    layer: str
    depth: float = 0.0
    curve: float = 0.0
    filled: bool = False
    bearing: bool = False
    fine: FloatArray | None = None


@dataclass(frozen=True, slots=True)
class Plane:
    """The plane that traces are drawn in: rows of axes (3, 3) are u, v and the normal, right-handed; height along the normal."""

    axes: FloatArray
    height: float
    traces: list[Trace] = field(default_factory=list)


def traces_of(entity: Any, matrix: Matrix, place: Place, layer: str, bearing: bool) -> list[Trace]:
    """Return the traces of one entity of `KINDS`: the boundaries of a hatch, one of any other; what has no length is left out."""
    filled = entity.dxftype() == "HATCH"
    drawn = paths.from_hatch(entity) if filled else [paths.make_path(entity)]
    up = np.array(entity.dxf.get("extrusion", (0, 0, 1))) @ np.linalg.inv(matrix[0]).T
    out: list[Trace] = []
    for line in (part for whole in drawn for part in whole.sub_paths()):
        points, fine = _flattened(line)
        closed = filled or (bool(line.is_closed) and len(points) > 3)
        if not len(points) or (closed and len(points) < 4):
            continue
        curve = 0.0 if fine is None else farthest(points[:, :2], fine[:, :2])
        points = transformed(points[:-1] if closed else points, matrix)
        fine = None if fine is None else transformed(fine, matrix)
        x, y, z = points[0].tolist()
        where = Place(place.entity, place.handle, place.block, (x, y, z))
        own = entity.dxf.get("thickness", 0.0) if entity.dxf.is_supported("thickness") else 0.0
        depth = float(own) * float(np.linalg.norm(matrix[0][2]))
        out.append(Trace(points, closed, up / np.linalg.norm(up), where, layer, depth, curve, filled, bearing, fine))
    return out


def by_plane(traces: Sequence[Trace]) -> list[Plane]:
    """Sort traces by the plane they are drawn in, within a thousandth of their size."""
    planes: list[Plane] = []
    for trace in traces:
        axes = _axes(trace.normal)
        along = trace.points @ axes[2]
        size = float(np.ptp(trace.points, axis=0).max())
        height = float(along.mean())
        match = (p for p in planes if np.allclose(p.axes, axes, atol=1e-6) and abs(p.height - height) <= 1e-3 * size)
        plane = next(match, None)
        if plane is None:
            planes.append(plane := Plane(axes, height))
        plane.traces.append(trace)
    return planes


def is_flat(trace: Trace) -> bool:
    """Does a trace lie in one plane, within a thousandth of its size?"""
    return bool(np.ptp(trace.points @ trace.normal) <= 1e-3 * np.ptp(trace.points, axis=0).max())


def _flattened(line: Any) -> tuple[FloatArray, FloatArray | None]:
    """Return the corners of a path (n, 3) without those that repeat; and the path with curves drawn finely (m, 3), or None."""
    ends = np.array([tuple(vertex) for vertex in line.control_vertices()], dtype=float).reshape(-1, 3)
    size = float(np.ptp(ends, axis=0).max()) if len(ends) else 0.0
    if not (0 < size < np.inf):
        return np.zeros((0, 3)), None
    if not line.has_curves:
        return _distinct(ends, size), None
    return _distinct(_points(line, CHORD * size), size), _points(line, FINE * size)


def _points(line: Any, distance: float) -> FloatArray:
    return np.array([tuple(vertex) for vertex in line.flattening(distance, segments=1)], dtype=float)


def _distinct(points: FloatArray, size: float) -> FloatArray:
    step = np.linalg.norm(np.diff(points, axis=0) / size, axis=1) > 1e-6
    return points[np.concatenate(([True], step))]


def _axes(normal: FloatArray) -> FloatArray:
    """Return u, v and the normal: x, y and z for what is drawn in plan, v upright for what is drawn on a wall."""
    if abs(normal[2]) > 1 - 1e-9:
        return np.eye(3)
    u = np.cross([0.0, 0.0, 1.0], normal)
    u /= np.linalg.norm(u)
    return np.stack([u, np.cross(normal, u), normal])
