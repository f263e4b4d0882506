"""Outlines of a two-dimensional drawing to stones: extruded, stood up, named by their layers."""

import itertools
from collections import Counter
from dataclasses import replace
from typing import Final

import numpy as np

from churchpipe.dxf import schema
from churchpipe.dxf.outlines import Outline, outlines_of
from churchpipe.dxf.reading import ElevationPlane
from churchpipe.dxf.stones import Stone
from churchpipe.dxf.traces import Trace, by_plane, is_flat
from churchpipe.findings import Finding
from churchpipe.geometry.planar import area, polygon
from churchpipe.model.arrays import FloatArray

# Layers that mean ground, whoever drew it; layers of what is no stone.
GROUND: Final = (schema.SUPPORT, "SUPPORT", "SUPPORTS", "GROUND")
NO_STONE: Final = ("OPENING", "OPENINGS")
# The name of the wall on layer 0.
WALL: Final = "wall"


def stones_of_traces(
    traces: list[Trace], *, thickness: float | None, plane: ElevationPlane, findings: list[Finding]
) -> tuple[list[Stone], Counter[str]]:
    """Return the stones whose outlines the traces are, and what was left out.

    thickness: of the stones whose outline has none of its own (the DXF thickness), drawing units, None when not given;
    plane: "xz" stands what is drawn in the plane x-y of the drawing upright, "xy" leaves it lying. Outlines on a layer that means
    ground become supports; the others are stones of a panel with the name of their layer.
    """
    left: Counter[str] = Counter()
    drawn = [trace for trace in traces if trace.layer not in NO_STONE]
    left["outlines of openings"] += len(traces) - len(drawn)
    warped = [trace for trace in drawn if not is_flat(trace)]
    left["lines that lie in no plane"] += len(warped)
    flat = [trace for trace in drawn if is_flat(trace)]
    outlines: list[Outline] = []
    # A line that ends on the ground is no part of its outline.
    for group in ([t for t in flat if not _bears(t)], [t for t in flat if _bears(t)]):
        for level in by_plane(group):
            found, loose = outlines_of(level, findings)
            outlines += found
            left["lines that close nothing"] += loose
    order = {id(trace): number for number, trace in enumerate(traces)}
    outlines.sort(key=lambda outline: order[id(outline.trace)])
    shallow = [outline for outline in outlines if not outline.trace.depth]
    if shallow and thickness is None:
        remedy = "Pass --thickness, such as --thickness 0.12m."
        finding = shallow[0].trace.place.finding
        findings.append(
            finding("E24", f"{len(shallow)} outlines without a thickness", expected="how deep the stones are", remedy=remedy)
        )
        return [], left
    stones = [_stone(outline, thickness or 0.0, plane) for outline in outlines]
    of_handle = Counter(stone.name for stone in stones)
    numbers = {name: itertools.count(1) for name, many in of_handle.items() if many > 1}
    stones = [replace(s, name=f"{s.name}.{next(numbers[s.name])}") if s.name in numbers else s for s in stones]
    if outlines:
        findings += _said(outlines, plane)
    return stones, left


def _stone(outline: Outline, thickness: float, plane: ElevationPlane) -> Stone:
    trace, axes = outline.trace, outline.plane.axes
    depth = (trace.depth or thickness) * (-1.0 if trace.depth and trace.normal @ axes[2] < 0 else 1.0)
    levels = sorted((outline.plane.height, outline.plane.height + depth))
    flat = outline.corners
    points = np.concatenate([flat @ axes[:2] + level * axes[2] for level in levels])
    if plane == "xz" and axes[2][2] == 1.0:
        points = stood_up(points)
    count = len(flat)
    sides = ((i, (i + 1) % count, (i + 1) % count + count, i + count) for i in range(count))
    faces = (tuple(range(count))[::-1], tuple(range(count, 2 * count)), *sides)
    bearing = _bears(trace)
    panel = "" if bearing else WALL if trace.layer == "0" else trace.layer
    size = float(np.sqrt(area(polygon(flat))))
    return Stone(points, faces, bearing, trace.place, trace.place.handle, "default", panel, size=size)


def _bears(trace: Trace) -> bool:
    return trace.bearing or trace.layer in GROUND


def stood_up(points: FloatArray) -> FloatArray:
    """Turn points (n, 3) about x, so that what is drawn with y upwards has z upwards."""
    return np.stack([points[:, 0], -points[:, 2], points[:, 1]], axis=1)


def _said(outlines: list[Outline], plane: ElevationPlane) -> list[Finding]:
    layers = Counter(outline.trace.layer for outline in outlines)
    named = ", ".join(f"{layer} ({count})" for layer, count in layers.items())
    lying = sum(bool(outline.plane.axes[2][2] == 1.0) for outline in outlines)
    what = f"{len(outlines)} outlines were taken for stones, on the layers {named}"
    if lying and plane == "xz":
        what += "; the drawing's x-y is taken for the elevation x-z"
    remedy = "Pass --plane xy if it is a plan." if lying and plane == "xz" else ""
    out = [outlines[0].trace.place.finding("W24", what, remedy=remedy)]
    curved = [outline.trace for outline in outlines if outline.trace.curve]
    for trace in curved:
        out.append(trace.place.finding("W27", "curved sides, up to {} from the chords taken for them", lengths=(trace.curve,)))
    return out
