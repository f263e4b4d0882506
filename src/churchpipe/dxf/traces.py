"""The lines of a drawing: polylines, lines, arcs and boundaries of hatches as points in space."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Final

import numpy as np
from ezdxf import path as paths
from ezdxf.entities.boundary_paths import EdgePath, LineEdge
from ezdxf.entities.solid import Solid
from ezdxf.lldxf import const
from ezdxf.math import Vec3

from churchpipe.dxf.definitions import Matrix, transformed
from churchpipe.dxf.schema import LARGEST_COORDINATE
from churchpipe.findings import Place
from churchpipe.geometry.planar import nested, polygon
from churchpipe.model.arrays import FloatArray

# Areas: bounded by paths, of which some may be voids, or by four corners.
BOUNDED: Final = ("HATCH", "MPOLYGON")
AREAS: Final = (*BOUNDED, "SOLID", "TRACE")
KINDS: Final = ("LWPOLYLINE", "POLYLINE", "LINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE", *AREAS)
# A curve is drawn with chords that leave it by at most the first part of the size of what it belongs to; finely, by the second.
CHORD, FINE = 0.01, 1e-4
# A line lies in a plane if it leaves it by no more than this part of its size.
FLAT = 1e-3


@dataclass(frozen=True, slots=True)
class Trace:
    """One line as drawn.

    points (n, 3), drawing units, in space; closed: said to be closed, then the first point is not repeated; normal (3,): of the
    plane it is drawn in; depth: its DXF thickness, 0 when it has none; filled: boundary of a hatch, or of another of `AREAS`;
    void: of a part of it that is left empty; added: length of sides that are not drawn and close such a boundary, drawing units;
    bearing: drawn as ground; fine (m, 3): the points of a line with curves, drawn finely, the first one repeated when it is
    closed.
    """

    points: FloatArray
    closed: bool
    normal: FloatArray
    place: Place
    layer: str
    depth: float = 0.0
    filled: bool = False
    void: bool = False
    added: float = 0.0
    bearing: bool = False
    fine: FloatArray | None = None


@dataclass(frozen=True, slots=True)
class Plane:
    """The plane that traces are drawn in: rows of axes (3, 3) are u, v and the normal, right-handed; height along the normal."""

    axes: FloatArray
    height: float
    traces: list[Trace] = field(default_factory=list)


def traces_of(entity: Any, matrix: Matrix, place: Place, layer: str, bearing: bool) -> list[Trace]:
    """Return the traces of one entity of `KINDS`: all boundaries of a hatch, one of any other; what has no length is left out."""
    extrusion = np.array(entity.dxf.get("extrusion", (0, 0, 1)))
    if not 0.0 < float(np.linalg.norm(extrusion)) < np.inf:
        raise ValueError(f"the direction of its extrusion is {tuple(extrusion.tolist())}")
    bounded, filled = (entity.dxftype() in kinds for kinds in (BOUNDED, AREAS))
    drawn = _boundaries(entity) if bounded else [(line, 0.0) for line in _path(entity).sub_paths()]
    normal = extrusion @ np.linalg.inv(matrix[0]).T
    up: FloatArray = np.asarray(normal / np.linalg.norm(normal), dtype=np.float64)
    across = _axes(up)[:2].T
    own = entity.dxf.get("thickness", 0.0) if entity.dxf.is_supported("thickness") else 0.0
    # Along the normal of its plane, whichever way an insert stretches it.
    depth = float(own) * float(np.linalg.norm(extrusion) / np.linalg.norm(normal))
    out: list[Trace] = []
    scale = float(np.linalg.norm(matrix[0] @ across[:, 0]))
    for line, added in drawn:
        points, fine = _flattened(line)
        closed = filled or (bool(line.is_closed) and len(points) > 3)
        if not len(points) or (closed and len(points) < 4):
            continue
        points = transformed(points, matrix)
        fine = None if fine is None else transformed(fine, matrix)
        points = points[:-1] if closed else points
        x, y, z = points[0].tolist()
        where = Place(place.entity, place.handle, place.block, (x, y, z))
        # Ends that meet but for rounding leave nothing open.
        added = scale * added if scale * added > 1e-6 * float(np.ptp(points, axis=0).max()) else 0.0
        sane = bool((np.abs(points) <= LARGEST_COORDINATE).all())
        own_plane = _plane_of(points, up) if sane and _apart(points, up) > FLAT else up
        out.append(Trace(points, closed, own_plane, where, layer, depth, filled, added=added, bearing=bearing, fine=fine))
    several = bounded and len(out) > 1 and all((np.abs(trace.points) <= LARGEST_COORDINATE).all() for trace in out)
    return _with_voids(out, across, entity.dxf.get("hatch_style", 0)) if several else out


def _path(entity: Any) -> Any:
    """Return the path of an entity; of a spline of the first degree the polyline that it is, with its corners; of a polyline with
    a spline fitted to it the spline, without the frame that nobody sees."""
    if entity.dxftype() == "SPLINE" and entity.dxf.degree == 1 and len(entity.control_points) > 1:
        line = paths.from_vertices([Vec3(tuple(point)) for point in entity.control_points])
        if entity.closed and not line.is_closed:
            line.close()
        return line
    if entity.dxftype() == "POLYLINE" and entity.dxf.flags & entity.SPLINE_FIT_VERTICES_ADDED:
        entity = entity.copy()
        entity.vertices[:] = [v for v in entity.vertices if not v.dxf.flags & v.SPLINE_FRAME_CONTROL_POINT]
    if isinstance(entity, Solid) and not np.isfinite([tuple(corner) for corner in entity.wcs_vertices()]).all():
        # The path would go past such a corner.
        raise ValueError("a coordinate of a corner is no number")
    return paths.make_path(entity)


def _boundaries(hatch: Any) -> list[tuple[Any, float]]:
    """Return the closed paths of the boundaries of a hatch, and the length of the sides of each that are not drawn.

    Boundaries about texts are left out: they are no voids.
    """
    height, ocs = hatch.dxf.elevation.z, hatch.ocs()
    out: list[tuple[Any, float]] = []
    for boundary in hatch.paths:
        if boundary.path_type_flags & const.BOUNDARY_PATH_TEXTBOX:
            continue
        for line in paths.from_hatch_boundary_path(boundary, ocs, elevation=height).sub_paths():
            added = 0.0
            if isinstance(boundary, EdgePath):
                # Where an edge does not begin at the end of another, ezdxf puts a straight one between them.
                ends = [
                    [ocs.to_wcs((*end, height)) for end in (edge.start, edge.end)]
                    for edge in boundary.edges
                    if isinstance(edge, LineEdge)
                ]
                added = sum(a.distance(b) for a, b in _sides(line) if not any(_same((a, b), side) for side in ends))
            elif not line.is_closed:
                added = line.start.distance(line.end)
                line.close()
            out.append((line, added))
    return out


def _sides(line: Any) -> Iterator[tuple[Any, Any]]:
    """Yield both ends of each straight side of a path."""
    start = line.start
    for command in line.commands():
        if command.type == paths.Command.LINE_TO:
            yield start, command.end
        start = command.end


def _same(side: tuple[Any, Any], other: Sequence[Any]) -> bool:
    (a, b), (c, d) = side, other
    return (a.isclose(c) and b.isclose(d)) or (a.isclose(d) and b.isclose(c))


def _with_voids(traces: list[Trace], across: FloatArray, style: int) -> list[Trace]:
    """Return the boundaries of a hatch, those of voids marked as its style has it; without those that bound nothing in it.

    across (3, 2): two axes in its plane; style: 0 hatched and left empty in turn from the outside inwards, 1 empty from the
    first void inwards, 2 no voids.
    """
    inner = nested(np.array([polygon(trace.points @ across) for trace in traces], dtype=np.object_))[:, 0]
    level = np.bincount(inner, minlength=len(traces))
    deepest = {1: 1, 2: 0}.get(style, len(traces))
    marked = zip(traces, level.tolist(), strict=True)
    return [replace(trace, void=number % 2 == 1) for trace, number in marked if number <= deepest]


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
    return _apart(trace.points, trace.normal) <= FLAT


def _apart(points: FloatArray, normal: FloatArray) -> float:
    """Return by how much points (n, 3) leave a plane, as a share of their extent."""
    return float(np.ptp(points @ normal) / np.ptp(points, axis=0).max())


def _plane_of(points: FloatArray, drawn: FloatArray) -> FloatArray:
    """Return the normal of the plane that a line in space (n, 3) lies in, toward who looks along y; `drawn` of a straight one."""
    _, spread, axes = np.linalg.svd(points - points.mean(axis=0))
    if len(points) < 3 or spread[1] <= FLAT * spread[0]:
        return drawn
    normal = np.round(axes[2], 12)
    return normal / np.linalg.norm(normal) * (-1.0 if normal @ [0.01, 1.0, 0.0001] > 0 else 1.0)


def _flattened(line: Any) -> tuple[FloatArray, FloatArray | None]:
    """Return the corners of a path (n, 3) without those that repeat; and the path with curves drawn finely (m, 3), or None.

    Corners that no building has are returned as they are, for whoever gathers the lines to name.
    """
    ends = np.array([tuple(vertex) for vertex in line.control_vertices()], dtype=float).reshape(-1, 3)
    if not (np.abs(ends) <= LARGEST_COORDINATE).all():
        return ends, None
    size = float(np.ptp(ends, axis=0).max()) if len(ends) else 0.0
    if size == 0:
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
