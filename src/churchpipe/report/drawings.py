"""Drawings of the structure as it stands: a plan, which is a section above the floor, and elevations, with their dimensions."""

from dataclasses import dataclass
from typing import Any

import manifold3d
import numpy as np

from churchpipe.geometry.manifolds import manifold
from churchpipe.mechanism import stone_of_point
from churchpipe.model.arrays import BoolArray, FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.polyhedra import face_normals
from churchpipe.report import colours
from churchpipe.report.motion import ground_plate
from churchpipe.report.plots import svg_of

# A plan cuts the walls as high as people do on paper, or through the middle of what is lower.
CUT_HEIGHT = 1.2
# Above so many faces a drawing is a picture: as lines it would weigh megabytes.
MOST_LINES = 1200
_WIDTH = 5.2


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


def drawings_svg(stones: Assemblage) -> list[tuple[str, str]]:
    """Return title and SVG of the plan and of the four elevations of the free stones and of what they stand on."""
    drawn = ~ground_plate(stones)
    low, high = _extent(stones)
    height = float(high[2] - low[2])
    level = min(CUT_HEIGHT, 0.5 * height)
    plan = _drawing(stones, drawn, PLAN, low[2] + level)
    return [(f"{PLAN.title}, cut {level:.2f} m above the foot", plan)] + [
        (view.title, _drawing(stones, drawn, view)) for view in ELEVATIONS
    ]


def _drawing(stones: Assemblage, drawn: BoolArray, view: View, cut: float | None = None) -> str:
    from matplotlib.collections import PolyCollection
    from matplotlib.figure import Figure

    axes_2d = np.array([view.across, view.up], dtype=float)
    shown = drawn.copy()
    if cut is not None:
        shown &= _lowest(stones) < cut - 1e-9
    faces = _faces(stones, shown, np.array(view.toward, dtype=float), cut)
    low, high = _corners(stones, axes_2d)
    size = np.maximum(high - low, 1e-9)
    figure = Figure(figsize=(_WIDTH, min(max(_WIDTH * (size[1] / size[0]) + 0.9, 1.4), 6.5)), layout="constrained", dpi=170)
    axes: Any = figure.subplots()
    pale = PolyCollection([stones.points[face] @ axes_2d.T for face in faces], facecolors="#f6f3ec", edgecolors=colours.EDGE)
    pale.set_linewidth(0.35)
    pale.set_rasterized(len(faces) > MOST_LINES)
    axes.add_collection(pale)
    if cut is not None:
        solid = PolyCollection(_section(stones, shown, cut), facecolors="#b9a58c", edgecolors=colours.INK, linewidths=0.6)
        axes.add_collection(solid)
    _dimensions(axes, low, high)
    axes.set_aspect("equal")
    axes.axis("off")
    return svg_of(figure)


def _faces(stones: Assemblage, shown: BoolArray, toward: FloatArray, cut: float | None) -> list[Any]:
    """Return the corners of the faces that look towards the eye, the farthest first; of a cut drawing those below the cut."""
    _, normal, mean = face_normals(stones.points, stones.face_nodes, stones.face_ptr)
    seen = np.repeat(shown, np.diff(stones.block_face_ptr)) & (normal @ toward > 1e-3)
    if cut is not None:
        seen &= mean[:, 2] < cut
    order = np.flatnonzero(seen)
    order = order[np.argsort(mean[order] @ toward, kind="stable")]
    return [stones.face_nodes[stones.face_ptr[f] : stones.face_ptr[f + 1]] for f in order]


def _section(stones: Assemblage, shown: BoolArray, level: float) -> list[FloatArray]:
    """Return the polygons (n, 2) m that a horizontal plane cuts out of the stones."""
    found: list[FloatArray] = []
    for stone in np.flatnonzero(shown & (_highest(stones) > level)):
        first, last = stones.block_point_ptr[stone : stone + 2]
        begin, end = stones.block_face_ptr[stone : stone + 2]
        faces = [stones.face_nodes[stones.face_ptr[f] : stones.face_ptr[f + 1]] - first for f in range(begin, end)]
        cut: manifold3d.CrossSection = manifold(stones.points[first:last], faces).slice(level)
        found += [np.asarray(ring) for ring in cut.to_polygons()]
    return found


def _dimensions(axes: Any, low: FloatArray, high: FloatArray) -> None:
    """Draw the width below and the height (of a plan: the depth) to the left, in metres."""
    gap = 0.06 * float((high - low).max())
    lines = (
        ((low[0], low[1] - gap), (high[0], low[1] - gap), high[0] - low[0], 0),
        ((low[0] - gap, low[1]), (low[0] - gap, high[1]), high[1] - low[1], 90),
    )
    for start, end, length, angle in lines:
        axes.annotate(
            "", start, end, arrowprops={"arrowstyle": "<|-|>", "lw": 0.7, "color": colours.INK, "shrinkA": 0, "shrinkB": 0}
        )
        middle = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2)
        axes.text(
            *middle, f"{length:.2f} m", rotation=angle, fontsize=8, ha="center", va="center",
            bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.5},
        )  # fmt: skip
    axes.set_xlim(low[0] - 2 * gap, high[0] + gap)
    axes.set_ylim(low[1] - 2 * gap, high[1] + gap)


def _extent(stones: Assemblage) -> tuple[FloatArray, FloatArray]:
    free = stones.points[~stones.fixed[stone_of_point(stones)]]
    return free.min(axis=0), free.max(axis=0)


def _corners(stones: Assemblage, axes_2d: FloatArray) -> tuple[FloatArray, FloatArray]:
    free = stones.points[~stones.fixed[stone_of_point(stones)]] @ axes_2d.T
    return free.min(axis=0), free.max(axis=0)


def _lowest(stones: Assemblage) -> FloatArray:
    return np.minimum.reduceat(stones.points[:, 2], stones.block_point_ptr[:-1])


def _highest(stones: Assemblage) -> FloatArray:
    return np.maximum.reduceat(stones.points[:, 2], stones.block_point_ptr[:-1])
