"""Lines of a drawing to outlines of stones: closed ones, almost closed ones, and the meshes of a net of lines."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from churchpipe.dxf.traces import Plane, Trace
from churchpipe.findings import Finding
from churchpipe.model.arrays import FloatArray

# Ends of an outline that miss each other, or cross, by up to this part of its length meet.
ALMOST = 0.1
# Lines of a net meet where they are closer than this part of its median line.
SNAP = 1e-3
# Corners within this part of the size of an outline of the line through their neighbours are none.
STRAIGHT = 1e-6


@dataclass(frozen=True, slots=True)
class Outline:
    """A closed outline in its plane: corners (n, 2), counter-clockwise, none on a straight side; and what it came from."""

    corners: FloatArray
    plane: Plane
    trace: Trace


def outlines_of(plane: Plane, findings: list[Finding]) -> tuple[list[Outline], int]:
    """Return the outlines drawn in a plane, in drawing order, and how many lines close nothing."""
    traces = [trace for trace in plane.traces if not trace.filled]
    flat = [trace.points @ plane.axes[:2].T for trace in traces]
    rings = [_ring(points, trace, findings) for points, trace in zip(flat, traces, strict=True)]
    loose = [k for k, ring in enumerate(rings) if ring is None]
    found: list[tuple[int, FloatArray]] = []
    left = 0
    if loose:
        net, open_lines, used = _net(flat, rings, loose)
        rings = [None if k in used else ring for k, ring in enumerate(rings)]
        found += net
        for k in open_lines:
            if len(flat[k]) < 3:
                left += 1
                continue
            gap = float(np.linalg.norm(flat[k][0] - flat[k][-1]))
            findings.append(traces[k].place.finding("W25", "the outline is not closed: a side of {} was added", lengths=(gap,)))
            rings[k] = flat[k]
    found += [(k, ring) for k, ring in enumerate(rings) if ring is not None]
    outlines = [_outline(corners, plane, traces[k], findings) for k, corners in sorted(found, key=lambda pair: pair[0])]
    sound = [outline for outline in outlines if outline is not None]
    filled = [_outline(t.points @ plane.axes[:2].T, plane, t, findings) for t in plane.traces if t.filled]
    return sound + _not_drawn([outline for outline in filled if outline is not None], sound), left


def _ring(points: FloatArray, trace: Trace, findings: list[Finding]) -> FloatArray | None:
    """Return the corners of a trace that is closed, or almost: then a finding says how its ends were joined."""
    if trace.closed:
        return points
    if len(points) < 4:
        return None
    reach = ALMOST * float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
    gap = float(np.linalg.norm(points[0] - points[-1]))
    if gap <= 1e-6 * reach:
        return points[:-1]
    meeting = _crossing(points[1], points[0], points[-2], points[-1])
    joined: FloatArray | None = None
    if meeting is not None and max(np.linalg.norm(points[[0, -1]] - meeting, axis=1)) <= reach:
        joined = np.concatenate([meeting[None], points[1:-1]])
    elif gap <= reach:
        joined = np.concatenate([0.5 * (points[:1] + points[-1:]), points[1:-1]])
    if joined is not None:
        findings.append(trace.place.finding("W25", "the outline is not closed: its ends, {} apart, were joined", lengths=(gap,)))
    return joined


def _crossing(a: FloatArray, b: FloatArray, c: FloatArray, d: FloatArray) -> FloatArray | None:
    """Return where the lines a-b and c-d meet, None when they are nearly parallel."""
    u, v = b - a, d - c
    cross = float(u[0] * v[1] - u[1] * v[0])
    if abs(cross) < 0.1 * np.linalg.norm(u) * np.linalg.norm(v):
        return None
    w = c - a
    return a + u * float(w[0] * v[1] - w[1] * v[0]) / cross


def _net(
    flat: Sequence[FloatArray], rings: Sequence[FloatArray | None], loose: Sequence[int]
) -> tuple[list[tuple[int, FloatArray]], list[int], set[int]]:
    """Return the meshes of a net of lines, each with the trace most of it is drawn with; the lines that meet no other; and the
    closed outlines that are part of the net, as lines of it end on them."""
    lines = [shapely.LineString(flat[k]) for k in loose]
    reach = SNAP * float(np.median([line.length for line in lines]))
    ends = shapely.points(np.concatenate([flat[k][[0, -1]] for k in loose]))
    own = np.repeat(np.arange(len(loose)), 2)
    closed = [k for k, ring in enumerate(rings) if ring is not None]
    borders = [shapely.LinearRing(rings[k]) for k in closed]
    everything = np.array([*lines, *borders], dtype=object)
    end, other = shapely.STRtree(everything).query(ends, predicate="dwithin", distance=reach)
    meets = own[end] != other
    joined = set(own[end[meets]].tolist())
    hit = {closed[k - len(lines)] for k in other[meets].tolist() if k >= len(lines)}
    alone = [loose[k] for k in range(len(loose)) if k not in joined and k not in set(other[meets].tolist())]
    chosen = [k for k in loose if k not in alone] + sorted(hit)
    if not chosen:
        return [], alone, set()
    sources = [shapely.LinearRing(rings[k]) if k in hit else _lengthened(flat[k], reach) for k in chosen]
    tree = shapely.STRtree(np.array(sources, dtype=object))
    meshes, _, dangles, _ = shapely.polygonize_full(shapely.get_parts(shapely.union_all(np.array(sources, dtype=object))))
    out: list[tuple[int, FloatArray]] = []
    for mesh in shapely.get_parts(meshes):
        # Between two lines that were meant to be one there is no stone.
        if mesh.area > reach * mesh.length:
            corners = shapely.get_coordinates(mesh.exterior)[:-1]
            longest = int(np.argmax(np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1)))
            middle = 0.5 * (corners[longest] + corners[(longest + 1) % len(corners)])
            out.append((chosen[int(tree.nearest(shapely.Point(middle)))], corners))
    ends_left = [part for part in shapely.get_parts(dangles) if part.length > 3 * reach]
    unused = {chosen[int(tree.nearest(shapely.line_interpolate_point(part, 0.5, normalized=True)))] for part in ends_left}
    return out, alone + sorted(k for k in unused if len(flat[k]) == 2 and k not in hit), hit


def _lengthened(points: FloatArray, reach: float) -> shapely.LineString:
    """Return a line drawn on at both ends, so that it crosses what it was meant to end on."""
    out = points.copy()
    for end, beside in ((0, 1), (-1, -2)):
        along = points[end] - points[beside]
        out[end] += reach * along / np.linalg.norm(along)
    return shapely.LineString(out)


def _outline(corners: FloatArray, plane: Plane, trace: Trace, findings: list[Finding]) -> Outline | None:
    corners = _cornered(corners)
    polygon = shapely.Polygon(corners) if len(corners) >= 3 else shapely.Polygon()
    if polygon.is_empty or not polygon.is_valid or polygon.area <= 1e-9 * polygon.length**2:
        why = shapely.is_valid_reason(polygon).split("[")[0] if not polygon.is_empty else "it has no area"
        problem = "the outline crosses itself" if "ntersection" in why else "the outline encloses nothing"
        findings.append(trace.place.finding("E25", problem, expected="a closed outline of one stone", remedy="Redraw it."))
        return None
    if not shapely.is_ccw(polygon.exterior):
        corners = corners[::-1]
    return Outline(corners, plane, trace)


def _cornered(corners: FloatArray) -> FloatArray:
    """Leave out corners that repeat, or lie on the straight line between their neighbours."""
    size = float(np.ptp(corners, axis=0).max())
    while len(corners) >= 3:
        before, after = np.roll(corners, 1, axis=0), np.roll(corners, -1, axis=0)
        chord, offset = after - before, corners - before
        length = np.linalg.norm(chord, axis=1)
        off = np.abs(chord[:, 0] * offset[:, 1] - chord[:, 1] * offset[:, 0])
        between = np.einsum("ij,ij->i", offset, chord) * np.einsum("ij,ij->i", corners - after, chord) <= 0
        none = (off <= STRAIGHT * size * length) & between | (np.linalg.norm(offset, axis=1) <= STRAIGHT * size)
        # Never two neighbours at once: of two corners at one place one must stay.
        none &= ~np.roll(none, 1) | (np.arange(len(none)) == 0)
        if not none.any():
            break
        first = int(np.argmax(none))
        corners = np.delete(corners, first, axis=0) if none.sum() == 1 else corners[~none]
    return corners


def _not_drawn(filled: list[Outline], drawn: list[Outline]) -> list[Outline]:
    """Return the hatches that fill no outline drawn besides."""
    if not filled or not drawn:
        return filled
    borders = np.array([shapely.Polygon(outline.corners) for outline in drawn], dtype=object)
    tree = shapely.STRtree(borders)
    out: list[Outline] = []
    for outline in filled:
        own = shapely.Polygon(outline.corners)
        near = borders[tree.query(own, predicate="intersects")]
        if not (shapely.area(shapely.intersection(near, own)) > 0.5 * np.minimum(shapely.area(near), own.area)).any():
            out.append(outline)
    return out
