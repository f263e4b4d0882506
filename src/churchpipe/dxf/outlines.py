"""Lines of a drawing to outlines of stones: closed ones, almost closed ones, and the meshes of a net of lines."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from operator import itemgetter

import numpy as np

from churchpipe.dxf.traces import Plane, Trace
from churchpipe.findings import Finding, Place
from churchpipe.geometry.divisions import divided
from churchpipe.geometry.nets import Left, covering, farthest, net_of, outline_flaw, turned_left, without_idle_corners
from churchpipe.geometry.planar import Region, extent, less, nested, polygon
from churchpipe.model.arrays import FloatArray

# Ends of an outline that miss each other, or cross, by up to this part of its length meet.
ALMOST = 0.1


@dataclass(frozen=True, slots=True)
class Outline:
    """What a closed outline encloses in its plane, without voids, no corner on a straight side; what it came from; and how far
    the curve of that leaves the chords taken for it, 0 of a mesh of a net, whose curves are findings already."""

    region: Region
    plane: Plane
    trace: Trace
    curve: float = 0.0


def outlines_of(plane: Plane, findings: list[Finding]) -> tuple[list[Outline], int]:
    """Return the outlines drawn in a plane, in drawing order, and how many lines close nothing."""
    axes = plane.axes[:2].T
    curves = [None if trace.fine is None else trace.fine @ axes for trace in plane.traces]
    lines = divided([trace.points @ axes for trace in plane.traces], curves, [trace.closed for trace in plane.traces])
    away = {id(trace): _away(line, fine) for trace, line, fine in zip(plane.traces, lines, curves, strict=True)}
    traces = [trace for trace in plane.traces if not trace.filled]
    flat = [line for trace, line in zip(plane.traces, lines, strict=True) if not trace.filled]
    rings = [_ring(points, trace, findings) for points, trace in zip(flat, traces, strict=True)]
    opened = [k for k, ring in enumerate(rings) if ring is None]
    found: list[tuple[int, FloatArray]] = []
    meshes = left = 0
    if opened:
        closed = [(k, ring) for k, ring in enumerate(rings) if ring is not None]
        index = opened + [k for k, _ in closed]
        net = net_of([flat[k] for k in opened], [ring for _, ring in closed])
        found += [(index[k], corners) for k, corners in net.meshes]
        meshes = len(found)
        used = {*opened, *(index[border] for border in net.borders)} - {index[line] for line in (*net.alone, *net.loose)}
        for k in sorted(used):
            if away[id(traces[k])]:
                findings.append(chords(traces[k], away[id(traces[k])]))
        # A line that encloses no stone with others is one as it was drawn, wherever its ends were tried.
        apart = set(net.alone)
        for k, gap in sorted(part for part in net.mended.items() if part[0] not in apart):
            what = "an end of the line misses the line that it should end on, or runs past it, by {}: they meet"
            remedy = "End it in the drawing where it should end if it was not meant to meet that line."
            place = _at(traces[index[k]], net.mended_at[k], plane)
            findings.append(place.finding("W25", what, lengths=(gap,), remedy=remedy))
        for k, (gap, middle) in sorted((part for part in net.doubtful.items() if part[0] not in apart), key=itemgetter(0)):
            what = "a side is so short that lines near it, which miss each other by up to {}, may end at either end of it"
            remedy = "Let the lines here end on each other: two stones may be taken for one, or for neighbours."
            findings.append(_at(traces[index[k]], middle, plane).finding("W25", what, lengths=(gap,), remedy=remedy))
        for area in (area for area in net.left if area.line not in apart):
            findings.append(_left_out(area, traces[index[area.line]], plane))
        for k in (index[border] for border in net.borders):
            rings[k] = None
        for k in (index[line] for line in net.alone):
            if len(flat[k]) < 3:
                left += 1
                continue
            gap = float(np.linalg.norm(flat[k][0] - flat[k][-1]))
            findings.append(traces[k].place.finding("W25", "the outline is not closed: a side of {} was added", lengths=(gap,)))
            rings[k] = flat[k]
        left += len(net.loose)
    found += [(k, ring) for k, ring in enumerate(rings) if ring is not None]
    bent = [(k, corners, 0.0 if n < meshes else away[id(traces[k])]) for n, (k, corners) in enumerate(found)]
    outlines = [
        _outline(corners, plane, traces[k], curve, findings) for k, corners, curve in sorted(bent, key=lambda one: one[0])
    ]
    sound = [outline for outline in outlines if outline is not None]
    filled = [(trace, line) for trace, line in zip(plane.traces, lines, strict=True) if trace.filled]
    for trace, _ in filled:
        if trace.added:
            what = "the boundary of the hatch is not closed: sides of {} in all were added"
            findings.append(trace.place.finding("W25", what, lengths=(trace.added,)))
    hatches = [_outline(line, plane, trace, away[id(trace)], findings) for trace, line in filled]
    fillings = [outline for outline in hatches if outline is not None and not outline.trace.void]
    voids = [outline for outline in hatches if outline is not None and outline.trace.void]
    borders = covering(_regions(sound), _regions(voids), alike=True)
    hatched = covering(_regions(sound), _regions(fillings), alike=True)
    for outline in (o for o, border, own in zip(sound, borders, hatched, strict=True) if border and not own):
        what = f"the outline is the border of a void in a hatch, of a stone or of mortar; its layer is {outline.trace.layer}"
        remedy = "Put it on a layer OPENING if it is a void, hatch it if it is a stone, or switch the layer of the hatch off."
        findings.append(outline.trace.place.finding("E29", what, remedy=remedy))
    whole = cut_out([*sound, *fillings], voids, findings)
    sound, fillings = whole[: len(sound)], whole[len(sound) :]
    # A hatch that fills an outline drawn besides is no stone of its own.
    fills = covering(_regions(fillings), _regions(sound))
    return sound + [outline for outline, drawn in zip(fillings, fills, strict=True) if not drawn], left


def parallel(first: Outline, second: Outline) -> bool:
    """Are two outlines drawn in planes one behind the other?"""
    return np.allclose(first.plane.axes, second.plane.axes, atol=1e-6)


def levels_of(outline: Outline, thickness: float) -> tuple[float, float]:
    """Return from where to where the body of an outline goes along the normal of its plane; thickness: if it has none itself."""
    trace = outline.trace
    depth = (trace.depth or thickness) * (-1.0 if trace.depth and trace.normal @ outline.plane.axes[2] < 0 else 1.0)
    ends = (outline.plane.height, outline.plane.height + depth)
    return min(ends), max(ends)


def drawn_within(opening: Outline, bodies: Sequence[Outline], thickness: float) -> list[Outline]:
    """Return those of the bodies before and behind an opening within whose thickness it is drawn; if in none, the only one."""
    low, high = levels_of(opening, 0.0)
    near = 1e-3 * _size(opening.region)
    spans = [levels_of(body, thickness) for body in bodies]
    within = [body for body, (back, front) in zip(bodies, spans, strict=True) if back - near <= high and low <= front + near]
    return within or [*bodies][: len(bodies) == 1]


def cut_out(
    outlines: Sequence[Outline], voids: Sequence[Outline], findings: list[Finding], *, thickness: float = 0.0
) -> list[Outline]:
    """Return outlines without the voids that lie wholly in them. Each void cut out is a finding.

    thickness: of stones whose outline has none of its own, drawing units.
    """
    out = list(outlines)
    if not voids:
        return out
    around: dict[int, list[int]] = {}
    for inner, outer in nested(np.array(_regions([*outlines, *voids]), dtype=np.object_)).tolist():
        if inner >= len(out) > outer and parallel(out[outer], voids[inner - len(out)]):
            around.setdefault(inner - len(out), []).append(outer)
    cut: set[int] = set()
    for number, stones in around.items():
        within = {id(stone) for stone in drawn_within(voids[number], [outlines[stone] for stone in stones], thickness)}
        for stone in (stone for stone in stones if id(outlines[stone]) in within):
            out[stone] = replace(out[stone], region=less(out[stone].region, [voids[number].region]))
            cut.add(number)
    for void in (voids[number] for number in sorted(cut)):
        findings.append(void.trace.place.finding("W29", "a void, {} wide, was cut out of a stone", lengths=(_size(void.region),)))
    return out


def inside_others(outlines: Sequence[Outline]) -> list[Finding]:
    """Return a finding of each outline that others at its height lie in."""
    if len(outlines) < 2:
        return []
    inside: dict[int, list[Outline]] = {}
    for number, other in nested(np.array(_regions(outlines), dtype=np.object_)).tolist():
        inner, outer = outlines[number], outlines[other]
        near = abs(inner.plane.height - outer.plane.height) <= 1e-3 * _size(outer.region)
        if near and np.allclose(inner.plane.axes, outer.plane.axes, atol=1e-6):
            inside.setdefault(other, []).append(inner)
    out: list[Finding] = []
    for number, inner in inside.items():
        place, layer = outlines[number].trace.place, outlines[number].trace.layer
        if len(inner) == 1:
            own = inner[0].trace
            found = f"the outline, on layer {own.layer}, lies inside that of {place.entity} #{place.handle}, on layer {layer}"
            out.append(own.place.finding("E29", found))
        else:
            remedy = "Put it on a layer that is off if it is no stone, or those in it on a layer OPENING if they are voids."
            found = f"{len(inner)} outlines lie inside this one, whose layer is {layer}; theirs: {layers_of(inner)}"
            out.append(place.finding("E29", found, remedy=remedy))
    return out


def layers_of(outlines: Sequence[Outline]) -> str:
    """Return the layers of outlines as a message names them, with how many outlines each has."""
    return ", ".join(f"{layer} ({count})" for layer, count in Counter(outline.trace.layer for outline in outlines).items())


def _left_out(area: Left, trace: Trace, plane: Plane) -> Finding:
    """Return the finding of an area that lines enclose and that is no stone, placed in its middle."""
    if area.narrow:
        what = "lines enclose an area {} long, {} wide: it is left out, since lines so near each other are taken for one"
        remedy = "Draw what they enclose as an outline if it is a stone."
    else:
        what = (
            "the line crosses others and encloses with them an area {} long, {} wide: it is left out, since no stone is so small"
        )
        remedy = "Let them cross in one point, or draw what they enclose as an outline if it is a stone."
    return _at(trace, area.at, plane).finding("W25", what, lengths=(area.length, area.width), remedy=remedy)


def _at(trace: Trace, at: FloatArray, plane: Plane) -> Place:
    """Return a place at a trace, at the point (2,) of its plane."""
    x, y, z = (at @ plane.axes[:2] + plane.height * plane.axes[2]).tolist()
    return replace(trace.place, position=(x, y, z))


def _regions(outlines: Sequence[Outline]) -> list[Region]:
    return [outline.region for outline in outlines]


def _size(region: Region) -> float:
    low_u, low_v, high_u, high_v = extent(region).tolist()
    return max(high_u - low_u, high_v - low_v)


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


def _away(line: FloatArray, fine: FloatArray | None) -> float:
    """Return how far a curve drawn finely (m, 2) is from the chords taken for it; 0 of a line without curves."""
    if fine is None:
        return 0.0
    return farthest(np.concatenate([line, line[:1]]) if np.array_equal(fine[0], fine[-1]) else line, fine)


def chords(trace: Trace, apart: float) -> Finding:
    """Return the finding of a curve that chords were taken for; apart: how far it leaves them, drawing units."""
    return trace.place.finding("W27", "curved sides, up to {} from the chords taken for them", lengths=(apart,))


def _outline(corners: FloatArray, plane: Plane, trace: Trace, curve: float, findings: list[Finding]) -> Outline | None:
    corners = without_idle_corners(corners)
    if flaw := outline_flaw(corners):
        finding = trace.place.finding
        findings.append(finding("E25", f"the outline {flaw}", expected="a closed outline of one stone", remedy="Redraw it."))
        return None
    return Outline(polygon(turned_left(corners)), plane, trace, curve)
