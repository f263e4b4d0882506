"""Outlines of a two-dimensional drawing to stones: extruded, stood up, named by their layers."""

import itertools
from collections import Counter
from dataclasses import replace
from enum import Enum
from typing import Final

import numpy as np

from churchpipe.dxf import schema
from churchpipe.dxf.outlines import (
    Outline,
    chords,
    cut_out,
    drawn_within,
    inside_others,
    layers_of,
    levels_of,
    outlines_of,
    parallel,
)
from churchpipe.dxf.reading import ElevationPlane
from churchpipe.dxf.stones import Stone
from churchpipe.dxf.traces import Trace, by_plane, is_flat
from churchpipe.findings import Finding
from churchpipe.geometry.planar import Region, area, common, less, pieces
from churchpipe.geometry.prism import prism_of
from churchpipe.model.arrays import FloatArray
from churchpipe.recognition.lintels import is_lintel
from churchpipe.wording import counted

# Layers of what is no stone.
NO_STONE: Final = ("OPENING", "OPENINGS")
# Less than this share of the area of a wall beside its openings is none of it.
NOTHING: Final = 1e-9
# The name of the wall on layer 0.
WALL: Final = "wall"


class _Kind(Enum):
    STONE, GROUND, OPENING = range(3)


def stones_of_traces(
    traces: list[Trace], *, thickness: float | None, plane: ElevationPlane, cut: bool, findings: list[Finding]
) -> tuple[list[Stone], Counter[str]]:
    """Return the stones whose outlines the traces are, and what was left out.

    thickness: of the stones whose outline has none of its own (the DXF thickness), drawing units, None when not given;
    plane: "xz" stands what is drawn in the plane x-y of the drawing upright, "xy" leaves it lying. Outlines on a layer that means
    ground become supports; the others are stones of a panel with the name of their layer. cut: outlines are whole walls, those on
    a layer that means opening are cut out of them, and those on a layer of lintels are as deep as the wall they are drawn on.
    """
    left: Counter[str] = Counter()
    flat = [trace for trace in traces if is_flat(trace)]
    left["lines that lie in no plane"] += len(traces) - len(flat)
    outlines: list[Outline] = []
    # A line that ends on the ground, or at an opening, is no part of its outline.
    for kind in (_Kind.STONE, _Kind.GROUND, _Kind.OPENING):
        group = [trace for trace in flat if _kind(trace) == kind]
        for level in by_plane(group):
            found, loose = outlines_of(level, findings if kind != _Kind.OPENING or cut else [])
            outlines += found
            left["lines that close nothing"] += loose
    order = {id(trace): number for number, trace in enumerate(traces)}
    outlines.sort(key=lambda outline: order[id(outline.trace)])
    openings = [outline for outline in outlines if _kind(outline.trace) == _Kind.OPENING]
    outlines = [outline for outline in outlines if _kind(outline.trace) != _Kind.OPENING]
    if not cut:
        before = len(findings)
        outlines = cut_out(outlines, openings, findings, thickness=thickness or 0.0)
        left["outlines of openings"] += len(openings) - len(findings) + before
        findings += inside_others(outlines)
    walls = [outline for outline in outlines if _kind(outline.trace) == _Kind.STONE and not _spans(outline)] if cut else []
    deep = _lintels([outline for outline in outlines if cut and _spans(outline)], walls, thickness or 0.0)
    shallow = [outline for outline in outlines if not deep.get(id(outline), outline).trace.depth]
    if shallow and thickness is None:
        remedy = "Pass --thickness, such as --thickness 0.12m."
        found = f"{counted(len(shallow), 'outline')} without a thickness"
        findings.append(shallow[0].trace.place.finding("E24", found, expected="how deep the stones are", remedy=remedy))
        return [], left
    stones: list[Stone] = []
    cuts = _cuts(walls, openings, thickness or 0.0)
    for outline in outlines:
        through = [openings[number] for number in cuts[id(outline)]] if id(outline) in cuts else []
        levels = levels_of(deep.get(id(outline), outline), thickness or 0.0)
        own = _stones(outline, [opening.region for opening in through], levels, plane)
        if not own:
            remedy = "Draw the openings smaller, put what is none on another layer, and lintels on a layer LINTEL."
            findings.append(outline.trace.place.finding("E28", "openings take all of the wall", remedy=remedy))
        stones += own
    if cut:
        left["outlines of openings in no wall"] += len(openings) - len({number for own in cuts.values() for number in own})
    of_handle = Counter(stone.name for stone in stones)
    numbers = {name: itertools.count(1) for name, many in of_handle.items() if many > 1}
    stones = [replace(s, name=f"{s.name}.{next(numbers[s.name])}") if s.name in numbers else s for s in stones]
    if outlines:
        findings += _findings(outlines, plane, cut, thickness)
    return stones, left


def _cuts(walls: list[Outline], openings: list[Outline], thickness: float) -> dict[int, list[int]]:
    """Return the numbers of the openings that are cut out of each wall, by the id of the wall."""
    cuts: dict[int, list[int]] = {}
    for number, opening in enumerate(openings):
        across = [wall for wall in walls if parallel(wall, opening) and area(common(wall.region, opening.region)) > 0]
        for wall in drawn_within(opening, across, thickness):
            cuts.setdefault(id(wall), []).append(number)
    return cuts


def _lintels(lintels: list[Outline], walls: list[Outline], thickness: float) -> dict[int, Outline]:
    """Return the wall on which each lintel without a thickness of its own is drawn, by the id of the lintel: it is as deep."""
    found: dict[int, Outline] = {}
    for lintel in (lintel for lintel in lintels if not lintel.trace.depth):
        across = [wall for wall in walls if parallel(wall, lintel) and area(common(wall.region, lintel.region)) > 0]
        found |= {id(lintel): wall for wall in drawn_within(lintel, across, thickness)[:1]}
    return found


def _stones(outline: Outline, cut: list[Region], levels: tuple[float, float], plane: ElevationPlane) -> list[Stone]:
    """Return the bodies of an outline, extruded between two levels: one, or several where openings (regions) cut it into parts,
    or none."""
    trace, axes = outline.trace, outline.plane.axes
    whole = outline.region
    rest = [part for part in pieces(less(whole, cut)) if area(part) > NOTHING * area(whole)] if cut else pieces(whole)
    bodies = [prism_of(part) for part in rest]
    bearing = _bears(trace)
    panel = "" if bearing else WALL if trace.layer == "0" else trace.layer
    stones: list[Stone] = []
    for flat, faces in bodies:
        points = flat[:, :2] @ axes[:2] + np.array(levels)[flat[:, 2].astype(np.int64)][:, None] * axes[2]
        points = stood_up(points) if plane == "xz" and axes[2][2] == 1.0 else points
        size = None if cut else float(np.sqrt(area(whole)))
        stones.append(Stone(points, faces, bearing, trace.place, trace.place.handle, "default", panel, size=size))
    return stones


def _spans(outline: Outline) -> bool:
    return is_lintel(outline.trace.layer)


def _kind(trace: Trace) -> _Kind:
    return _Kind.OPENING if trace.layer in NO_STONE else _Kind.GROUND if _bears(trace) else _Kind.STONE


def _bears(trace: Trace) -> bool:
    return trace.bearing or trace.layer in schema.GROUND


def stood_up(points: FloatArray) -> FloatArray:
    """Turn points (n, 3) about x, so that what is drawn with y upwards has z upwards."""
    return np.stack([points[:, 0], -points[:, 2], points[:, 1]], axis=1)


def laid_down(point: FloatArray) -> FloatArray:
    """Return the place (3,) in a drawing of a point of what `stood_up` has turned."""
    return np.array([point[0], point[2], -point[1]])


def _findings(outlines: list[Outline], plane: ElevationPlane, cut: bool, thickness: float | None) -> list[Finding]:
    lying = sum(bool(outline.plane.axes[2][2] == 1.0) for outline in outlines)
    kind = "whole wall" if cut else "stone"
    taken = counted(len(outlines), f"outline was taken for a {kind}", f"outlines were taken for {kind}s")
    what = f"{taken}, on the layers {layers_of(outlines)}"
    if lying and plane == "xz":
        what += "; the drawing's x-y is taken for the elevation x-z"
    # The thickness that was given, or is swept, changes nothing there.
    own = [depth for outline in outlines if (depth := abs(outline.trace.depth)) and thickness is not None]
    own = own if any(not np.isclose(depth, thickness or 0.0) for depth in own) else []
    lengths = tuple(dict.fromkeys((min(own), max(own)))) if own else ()
    if own:
        has = counted(len(own), "of them has a DXF thickness of its own", "of them have a DXF thickness of their own")
        what += f"; {has}, {' to '.join(['{}'] * len(lengths))}, which goes before the one given"
    unwanted = "Put outlines that are no walls on a layer that is off, or on OPENING or LINTEL." if cut else ""
    remedy = "Pass --plane xy if it is a plan." if lying and plane == "xz" else unwanted
    out = [outlines[0].trace.place.finding("W24", what, lengths=lengths, remedy=remedy)]
    return out + [chords(outline.trace, outline.curve) for outline in outlines if outline.curve]
