"""Crack maps: the joints of a wall that are open, on its elevation."""

from typing import Any

import numpy as np

from churchpipe.geometry.charts import counted_towards
from churchpipe.mechanism import stone_of_point
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.report import colours
from churchpipe.report.plots import new_plot, svg_of
from churchpipe.wording import three_figures

# Inches: two maps stand beside each other.
_MAP = 4.8
# Joints open by less than this share of the widest, or by less than so many metres, are drawn shut; so many of the widest have
# their figure.
_SHUT, _INVISIBLE, _FIGURES = 0.01, 1e-6, 6
# Width and height of a figure, as shares of the larger side of the elevation.
_FIGURE = np.array([0.12, 0.05])
# Joints that are seen no wider than this share of their length are seen on edge.
_ON_EDGE = 0.1


def crack_map_svg(stones: Assemblage, contacts: Contacts, opening: FloatArray, wall: str) -> str:
    """Return an SVG of a wall's elevation with its joints as wide and as dark as they are open; "" where none is.

    opening (ni,) m. The wall is drawn as it was, along its longest direction in plan, from its left end on; joints with other
    walls are among its own.
    """
    mine = np.flatnonzero((stones.panel == wall) & ~stones.fixed)
    own = np.isin(contacts.blocks, mine)
    cracked = np.flatnonzero(own.any(axis=1) & (opening > max(_SHUT * float(opening.max(initial=0.0)), _INVISIBLE)))
    if not len(mine) or not len(cracked):
        return ""
    corners = np.isin(stone_of_point(stones), mine)
    # Of the corners: centroids of stones that stand on each other have no direction.
    axis = _direction(stones.points[corners, :2])
    seen, points = _seen(stones.points, axis), _seen(contacts.point, axis)
    start = np.array([float(seen[corners, 0].min()), 0.0])
    seen, points = seen - start, points - start
    outlines = [_outline(seen[stones.block_point_ptr[i] : stones.block_point_ptr[i + 1]]) for i in mine]
    lines = [_drawn(points[contacts.point_ptr[i] : contacts.point_ptr[i + 1]]) for i in cracked]
    low, high = (edge(np.concatenate(outlines), axis=0) for edge in (np.min, np.max))
    length, height = high - low
    plot, (axes,) = new_plot(1, (_MAP, float(np.clip(3.2 * height / max(length, 1e-9), 1.2, 4.0)) + 0.6))
    _draw(plot, axes, outlines, lines, 1e3 * opening[cracked])
    axes.set_aspect("equal")
    axes.grid(visible=False)
    axes.set_xlabel("m along the wall", fontsize=8)
    axes.set_ylabel("height, m", fontsize=8)
    return svg_of(plot)


def counted_on(stones: Assemblage, wall: str) -> str:
    """Return from where lengths along the crack map of a wall are counted."""
    corners = np.isin(stone_of_point(stones), np.flatnonzero((stones.panel == wall) & ~stones.fixed))
    plan = stones.points[corners, :2]
    axis = _direction(plan)
    reach, middle = plan @ axis, plan.mean(axis=0)
    return counted_towards(middle + (reach.min() - middle @ axis) * axis, axis)


def _draw(plot: Any, axes: Any, outlines: list[FloatArray], lines: list[FloatArray], width: FloatArray) -> None:
    """Draw stones and, above them, joints (k) open by width (k,) mm, the widest with their figures."""
    from matplotlib.collections import LineCollection, PolyCollection
    from matplotlib.colors import LinearSegmentedColormap
    from matplotlib.patheffects import withStroke

    colour = LinearSegmentedColormap.from_list("opening", colours.SPEED_STOPS[1:])
    axes.add_collection(PolyCollection(outlines, facecolor="#f6f3ec", edgecolor="#cfc8ba", lw=0.4))
    order = np.argsort(width)
    joints = LineCollection(
        [lines[i] for i in order], array=width[order], cmap=colour, linewidths=1.0 + 4.0 * width[order] / width.max()
    )
    joints.set_clim(0.0, float(width.max()))
    axes.add_collection(joints)
    # Figures stand out against joints as dark as they are.
    halo = [withStroke(linewidth=2.0, foreground="white")]
    for i in _apart(order[::-1], lines, np.ptp(np.concatenate(outlines), axis=0).max()):
        middle, text = _middle(lines[i]), three_figures(width[i])
        axes.annotate(text, middle, xytext=(3, 3), textcoords="offset points", fontsize=8, path_effects=halo)
    axes.autoscale_view()
    bar = plot.colorbar(joints, ax=axes, shrink=0.7)
    bar.set_label("opening, mm", fontsize=8)
    bar.ax.tick_params(labelsize=8)


def _apart(order: IntArray, lines: list[FloatArray], size: float) -> list[int]:
    """Return some of the joints in this order, whose figures do not cover each other on an elevation of this size, m."""
    middle, chosen = np.array([_middle(line) for line in lines]), list[int]()
    for i in order.tolist():
        if len(chosen) == _FIGURES:
            break
        if all(float(np.abs((middle[i] - middle[j]) / _FIGURE).max()) > size for j in chosen):
            chosen.append(i)
    return chosen


def _direction(plan: FloatArray) -> FloatArray:
    """Return the unit vector (2,) in plan along which points (n, 2) reach furthest, towards +x or +y."""
    spread = plan - plan.mean(axis=0)
    axis = np.linalg.eigh(spread.T @ spread)[1][:, -1]
    return axis * (1.0 if axis[np.argmax(np.abs(axis))] > 0 else -1.0)


def _seen(points: FloatArray, axis: FloatArray) -> FloatArray:
    """Return points (n, 3) on the elevation (n, 2): along an axis in plan, and up."""
    return np.column_stack([points[:, :2] @ axis, points[:, 2]])


def _outline(points: FloatArray) -> FloatArray:
    """Return the convex outline (k, 2) of points (n, 2)."""
    from scipy.spatial import ConvexHull

    return points[ConvexHull(points).vertices]


def _drawn(points: FloatArray) -> FloatArray:
    """Return what a joint with these points (n, 2) is drawn by: the longest line (2, 2) between them where it is seen on edge, or
    else its outline (k, 2), closed."""
    apart = np.linalg.norm(points[:, None] - points[None], axis=2)
    ends = points[list(np.unravel_index(int(apart.argmax()), apart.shape))]
    across = (points - ends[0]) @ np.array([[0.0, 1.0], [-1.0, 0.0]]) @ (ends[1] - ends[0])
    if np.ptp(across) <= _ON_EDGE * apart.max() ** 2:
        return ends
    outline = _outline(points)
    return np.concatenate([outline, outline[:1]])


def _middle(line: FloatArray) -> FloatArray:
    return 0.5 * (line.min(axis=0) + line.max(axis=0))
