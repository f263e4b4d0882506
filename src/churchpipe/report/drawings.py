"""Drawings of the structure with its dimensions: a plan, which is a section above the floor, elevations and upright sections."""

from dataclasses import dataclass
from typing import Any

import manifold3d
import numpy as np

from churchpipe.geometry.manifolds import manifold
from churchpipe.mechanism import stone_of_point
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.polyhedra import face_normals
from churchpipe.report import colours
from churchpipe.report.drawn_loads import DrawnLoads, draw_loads
from churchpipe.report.motion import ground_plate
from churchpipe.report.plots import svg_of
from churchpipe.report.table import amount
from churchpipe.stones.ring_beams import ring_beams

# A plan cuts the walls as high as people do on paper, or through the middle of what is lower.
CUT_HEIGHT = 1.2
# A building thinner than this share of its length has no section along it, which would show its elevation again, and no
# elevations of its ends, which the section across it shows.
_THIN = 0.25
# A section passes so far beside the middle, m, and a plan so far above its height, where a joint may lie.
_BESIDE = 2e-3
# Above so many faces a drawing is a picture: as lines it would weigh megabytes.
MOST_LINES = 1200
# Inches: about as wide as it is shown, so that its dimensions can be read.
_WIDTH = 3.4
# Points: the figures of a drawing as wide as that, and of one so high that it is shown smaller, on paper as well as on screens.
_FIGURES, _HIGH = 8.0, 3.4
# Of pictures: browsers that show a finer one at half its size leave lines out, as they do lines laid on its pixels.
_DPI = 170
# Red, green and blue of the nearest faces, and of those as far as the building is deep.
NEAREST, FARTHEST = np.array([0.965, 0.953, 0.925]), np.array([0.76, 0.73, 0.67])


@dataclass(frozen=True, slots=True)
class View:
    """Which way a drawing looks: title, unit vectors (3,) across, up and towards the eye."""

    title: str
    across: tuple[float, float, float]
    up: tuple[float, float, float]
    toward: tuple[float, float, float]


PLAN = View("Plan", (1, 0, 0), (0, 1, 0), (0, 0, 1))
ELEVATIONS = (
    View("Elevation from \u2212y", (1, 0, 0), (0, 0, 1), (0, -1, 0)),
    View("Elevation from +x", (0, 1, 0), (0, 0, 1), (1, 0, 0)),
    View("Elevation from +y", (-1, 0, 0), (0, 0, 1), (0, 1, 0)),
    View("Elevation from \u2212x", (0, -1, 0), (0, 0, 1), (-1, 0, 0)),
)


def drawings_svg(stones: Assemblage, loads: DrawnLoads) -> list[tuple[str, str]]:
    """Return title and SVG of the plan, the elevations and the sections of the free stones, what they stand on and carry."""
    drawn = ~ground_plate(stones)
    low, high = _extent(stones)
    level = min(CUT_HEIGHT, 0.5 * float(high[2] - low[2]))
    plan = _drawing(stones, drawn, loads, PLAN, low[2] + level + _BESIDE)
    return [
        (f"{PLAN.title}, cut {amount(level, 2)} m above the foot", plan),
        *((view.title, _drawing(stones, drawn, loads, view)) for view in elevations(low, high)),
        *((view.title, _drawing(stones, drawn, loads, view, cut)) for view, cut in sections(low, high)),
    ]


def elevations(low: FloatArray, high: FloatArray) -> list[View]:
    """Return the elevations that show more than an edge; low, high: as in `sections`."""
    size = high - low
    return [view for view in ELEVATIONS if abs(np.array(view.across)) @ size > _THIN * abs(np.array(view.toward)) @ size]


def sections(low: FloatArray, high: FloatArray) -> list[tuple[View, float]]:
    """Return the upright sections through the middle of a building: the view, and where it cuts along `toward`, m.

    low, high: least and largest coordinates (3,) of its free stones, m.
    """
    size, middle = high - low, 0.5 * (low + high) + _BESIDE
    found = [
        (View(f"Section at y = {middle[1]:.2f} m, towards +y", *_axes(ELEVATIONS[0])), -float(middle[1])),
        (View(f"Section at x = {middle[0]:.2f} m, towards \u2212x", *_axes(ELEVATIONS[1])), float(middle[0])),
    ]
    return [section for section, across in zip(found, (1, 0), strict=True) if size[across] > _THIN * size[1 - across]]


def _axes(view: View) -> tuple[tuple[float, float, float], ...]:
    return view.across, view.up, view.toward


def _drawing(stones: Assemblage, drawn: BoolArray, loads: DrawnLoads, view: View, cut: float | None = None) -> str:
    """Return the SVG of a view; of what lies beyond a plane alone, where one cuts the stones at this distance towards the eye."""
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import to_rgb
    from matplotlib.figure import Figure

    turned = np.array(_axes(view), dtype=float)
    axes_2d = turned[:2]
    # Coordinates of the drawing: across, up, towards the eye.
    points = stones.points @ turned.T
    shown = drawn.copy()
    if cut is not None:
        shown &= np.minimum.reduceat(points[:, 2], stones.block_point_ptr[:-1]) < cut - 1e-9
    seen = _faces(stones, shown, points, cut)
    faces = [stones.face_nodes[stones.face_ptr[face] : stones.face_ptr[face + 1]] for face in seen]
    beam = np.repeat(ring_beams(stones), np.diff(stones.block_face_ptr))[seen]
    low, high = _corners(stones, axes_2d)
    size = np.maximum(high - low, 1e-9)
    height = min(max(_WIDTH * float(size[1] / size[0]) + 0.6, 1.4), 4.4)
    figures = _FIGURES * max(1.0, height / _HIGH)
    figure = Figure(figsize=(_WIDTH, height), layout="constrained", dpi=_DPI)
    axes: Any = figure.subplots()
    fill = shades(np.array([points[face, 2].mean() for face in faces]), float(np.ptp(points[shown[stone_of_point(stones)], 2])))
    fill[beam] = to_rgb(colours.BEAM)
    pale = PolyCollection([points[face, :2] for face in faces], facecolors=fill, edgecolors=colours.EDGE)
    pale.set_linewidth(0.3)
    pale.set_snap(False)
    pale.set_rasterized(len(faces) > MOST_LINES)
    axes.add_collection(pale)
    if cut is not None:
        solid = PolyCollection(
            cut_polygons(stones, shown, points, cut), facecolors="#b9a58c", edgecolors=colours.INK, linewidths=0.5
        )
        axes.add_collection(solid)
    # A plan shows what bears on the walls above it, too.
    reached = draw_loads(axes, loads, turned, None if view is PLAN else cut, figures)
    _dimensions(axes, low, high, points[shown[stone_of_point(stones)], :2], reached, figures)
    axes.set_aspect("equal")
    axes.axis("off")
    return svg_of(figure)


def shades(near: FloatArray, depth: float) -> FloatArray:
    """Return the colours (n, 3) of faces, darker the farther they are, so that a wall seen through a door is not taken for it.

    near (n,): how near each is; depth: of all that is drawn.
    """
    share = (near.max(initial=-np.inf) - near) / max(depth, 1e-9)
    return NEAREST + np.clip(share, 0.0, 1.0)[:, None] * (FARTHEST - NEAREST)


def _faces(stones: Assemblage, shown: BoolArray, points: FloatArray, cut: float | None) -> IntArray:
    """Return the faces that look towards the eye, the farthest first; of a cut drawing those beyond the cut.

    points: the corners (nv, 3) in the coordinates of the drawing.
    """
    _, normal, mean = face_normals(points, stones.face_nodes, stones.face_ptr)
    seen = np.repeat(shown, np.diff(stones.block_face_ptr)) & (normal[:, 2] > 1e-3)
    if cut is not None:
        seen &= mean[:, 2] < cut
    order = np.flatnonzero(seen)
    return order[np.argsort(mean[order, 2], kind="stable")]


def cut_polygons(stones: Assemblage, shown: BoolArray, points: FloatArray, level: float) -> list[FloatArray]:
    """Return the polygons (n, 2) m that a plane across the view cuts out of the stones; points as in `_faces`."""
    found: list[FloatArray] = []
    highest = np.maximum.reduceat(points[:, 2], stones.block_point_ptr[:-1])
    for stone in np.flatnonzero(shown & (highest > level)).tolist():
        first, last = stones.block_point_ptr[stone : stone + 2]
        cut: manifold3d.CrossSection = manifold(points[first:last], stones.solid(stone)[1]).slice(level)
        found += [np.asarray(ring) for ring in cut.to_polygons()]
    return found


def _dimensions(axes: Any, low: FloatArray, high: FloatArray, corners: FloatArray, reached: FloatArray, figures: float) -> None:
    """Draw the width below and the height (of a plan: the depth) to the left, in metres, beside all stones that are drawn.

    low, high: what is measured; corners, reached: points (n, 2) of the stones, supports among them, and of what else is
    drawn; figures: size of the figures, points.
    """
    gap = 0.06 * float((high - low).max())
    least, most = np.min([low, *corners], axis=0), np.max([high, *corners], axis=0)
    lines = (
        ((low[0], least[1] - gap), (high[0], least[1] - gap), high[0] - low[0], 0),
        ((least[0] - gap, low[1]), (least[0] - gap, high[1]), high[1] - low[1], 90),
    )
    for start, end, length, angle in lines:
        axes.annotate(
            "", start, end, arrowprops={"arrowstyle": "<|-|>", "lw": 0.7, "color": colours.INK, "shrinkA": 0, "shrinkB": 0}
        )
        middle = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2)
        axes.text(
            *middle, f"{amount(float(length), 2)} m", rotation=angle, fontsize=figures, ha="center", va="center",
            bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.5},
        )  # fmt: skip
    least, most = np.min([least - 2 * gap, *reached], axis=0), np.max([most + gap, *reached], axis=0)
    axes.set_xlim(least[0], most[0])
    axes.set_ylim(least[1], most[1])


def _extent(stones: Assemblage) -> tuple[FloatArray, FloatArray]:
    free = stones.points[~stones.fixed[stone_of_point(stones)]]
    return free.min(axis=0), free.max(axis=0)


def _corners(stones: Assemblage, axes_2d: FloatArray) -> tuple[FloatArray, FloatArray]:
    free = stones.points[~stones.fixed[stone_of_point(stones)]] @ axes_2d.T
    return free.min(axis=0), free.max(axis=0)
