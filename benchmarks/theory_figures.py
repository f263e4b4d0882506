"""Figures of docs/theory.md and docs/shell.md: docs/pictures/contact_forces.png and shell_cell.png.

python benchmarks/theory_figures.py
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Polygon

PICTURES = Path(__file__).parents[1] / "docs" / "pictures"
STONE, FORCE, MOTION = "#e6dccb", "#0072b2", "#d55e00"
FRICTION = 0.6


def arrow(axes: Axes, start: tuple[float, float], step: tuple[float, float], colour: str, label: str = "") -> None:
    axes.annotate(
        "", (start[0] + step[0], start[1] + step[1]), start, arrowprops={"arrowstyle": "->", "color": colour, "lw": 1.6}
    )
    if label:
        axes.text(start[0] + 1.12 * step[0], start[1] + 1.12 * step[1], label, color=colour, ha="center", va="center")


def stone(axes: Axes, corners: list[tuple[float, float]]) -> None:
    axes.add_patch(Polygon(corners, facecolor=STONE, edgecolor="0.4", lw=1))


def plain(axes: Axes, title: str, x: tuple[float, float], y: tuple[float, float]) -> None:
    axes.set_title(title, fontsize=10)
    axes.set(xlim=x, ylim=y)
    axes.set_aspect("equal")
    axes.axis("off")


def joint(axes: Axes) -> None:
    """An interface between two stones, apart for the eye, with the forces at two of its corners."""
    slant = np.array([0.45, 0.25])
    for height, low in ((0.0, True), (0.75, False)):
        front = [(0.0, height), (2.0, height), (2.0, height + 0.6), (0.0, height + 0.6)]
        stone(axes, front)
        stone(axes, [front[1], tuple(front[1] + slant), tuple(front[2] + slant), front[2]])
        if low:
            stone(axes, [front[3], front[2], tuple(front[2] + slant), tuple(front[3] + slant)])
    points = np.array([(0.0, 0.6), (2.0, 0.6), (2.45, 0.85), (0.45, 0.85)])
    axes.plot(*points.T, "o", color="0.2", ms=4)
    arrow(axes, (2.0, 0.6), (0.0, -0.5), FORCE)
    axes.text(1.94, 0.3, "$n_k$", color=FORCE, ha="right", va="center")
    arrow(axes, (2.0, 0.6), (0.55, -0.15), FORCE, "$t_k$")
    arrow(axes, (0.0, 0.6), (0.0, -0.3), FORCE)
    arrow(axes, (0.0, 0.6), (-0.3, 0.05), FORCE)
    plain(axes, "forces of the upper stone on the lower\nat contact points, the corners of the joint", (-0.4, 2.9), (-0.1, 1.75))


def cone(axes: Axes) -> None:
    """Coulomb's cone, a force on it, and the two ways in which the joint may then slide."""
    n = np.array([0.0, 1.6])
    axes.fill(np.concatenate([n, n[::-1]]), np.concatenate([FRICTION * n, -FRICTION * n[::-1]]), color=STONE)
    axes.plot(n, FRICTION * n, n, -FRICTION * n, color="0.4", lw=1)
    force = np.array([1.1, FRICTION * 1.1])
    arrow(axes, (0.0, 0.0), (float(force[0]), float(force[1])), FORCE)
    size = 0.5 / np.hypot(1.0, FRICTION)
    arrow(axes, (float(force[0]), float(force[1])), (-FRICTION * size, size), MOTION)
    axes.text(0.8, 1.1, "associative", color=MOTION, ha="right")
    arrow(axes, (float(force[0]), float(force[1])), (0.0, 0.62), "0.2", "without\ndilatancy")
    axes.text(1.64, 0.98, r"$|t| = \mu n$", ha="left", va="center", fontsize=9)
    axes.axhline(0, color="0.6", lw=0.6)
    axes.text(1.7, -0.1, "$n$", va="center")
    axes.text(-0.03, 1.05, "$t$", ha="right")
    axes.axvline(0, color="0.6", lw=0.6)
    plain(
        axes,
        "a force at which the joint slides, and how it moves:\nto the left of the vertical it opens",
        (-0.25, 2.2),
        (-0.75, 1.75),
    )


def overturning(axes: Axes) -> None:
    """A block that its own weight, times the load factor, turns about its edge."""
    stone(axes, [(0, 0), (0.8, 0), (0.8, 1.6), (0, 1.6)])
    angle = -0.22
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    corners = (np.array([(-0.8, 0), (0, 0), (0, 1.6), (-0.8, 1.6)]) @ turn.T) + [0.8, 0]
    axes.add_patch(Polygon(corners, fill=False, edgecolor=MOTION, ls="--", lw=1.2))
    arrow(axes, (0.4, 0.8), (0.0, -0.5), FORCE)
    axes.text(0.34, 0.5, "$W$", color=FORCE, ha="right", va="center")
    arrow(axes, (0.4, 0.8), (0.75, 0.0), FORCE, r"$\alpha W$")
    axes.plot([-0.3, 1.5], [0, 0], color="0.3", lw=1.5)
    axes.text(0.4, -0.14, "$b$", ha="center")
    axes.text(-0.12, 0.8, "$h$", va="center")
    plain(axes, r"the mechanism of one block: $\alpha = b / h$" + "\nif friction is not less", (-0.5, 1.6), (-0.25, 1.85))


def cell(axes: Axes) -> None:
    """Running bond, one cell of it, and the axes of the shell."""
    length, height = 1.0, 0.45
    for course in range(4):
        for column in range(3):
            x, y = column * length + 0.5 * length * (course % 2), course * height
            stone(axes, [(x, y), (x + length, y), (x + length, y + height), (x, y + height)])
    cut = [(1.0, height), (2.0, height), (2.5, 2 * height), (1.5, 2 * height)]
    axes.add_patch(Polygon(cut, fill=False, edgecolor=MOTION, lw=1.8))
    axes.text(0.5, -0.2, "$b$", ha="center")
    axes.text(-0.1, 0.5 * height, "$a$", va="center", ha="right")
    arrow(axes, (3.75, 0.4), (0.6, 0.0), FORCE, "1")
    arrow(axes, (3.75, 0.4), (0.0, 0.6), FORCE, "2")
    plain(
        axes,
        "one period of running bond (framed);\n1 along the beds, 2 up the courses, 3 out of the wall",
        (-0.3, 4.6),
        (-0.3, 2.7),
    )


def facet(axes: Axes) -> None:
    """The unknowns of a facet."""
    corners = np.array([(0.0, 0.0), (2.2, 0.2), (0.8, 1.7)])
    stone(axes, [tuple(corner) for corner in corners])
    middles = 0.5 * (corners + np.roll(corners, -1, axis=0))
    stations = np.array([corners.mean(axis=0) + 0.5 * (corner - corners.mean(axis=0)) for corner in corners])
    axes.plot(*corners.T, "o", color=FORCE, ms=7, label="3 translations")
    axes.plot(*middles.T, "s", color=FORCE, ms=6, mfc="none", label="3 translations (LST)")
    axes.plot(*stations.T, "x", color="0.2", ms=6, label="strain is taken here")
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        middle, along = 0.5 * (start + end), 0.22 * (end - start) / np.linalg.norm(end - start)
        side = np.array([along[1], -along[0]]) * 0.8
        begin, step = middle + side - along, 2 * along
        arrow(axes, (float(begin[0]), float(begin[1])), (float(step[0]), float(step[1])), MOTION)
    axes.plot([], [], color=MOTION, label="1 rotation about the edge")
    axes.legend(loc="lower center", fontsize=8, frameon=False, ncols=2, bbox_to_anchor=(0.5, -0.25))
    plain(axes, "the unknowns of a facet", (-0.3, 2.5), (-0.3, 1.9))


def main() -> None:
    """Draw both pictures."""
    for name, parts, width in (("contact_forces", (joint, cone, overturning), 12), ("shell_cell", (cell, facet), 10)):
        figure, axes = plt.subplots(1, len(parts), figsize=(width, 3.6), layout="constrained")
        for place, draw in zip(axes, parts, strict=True):
            draw(place)
        figure.savefig(PICTURES / f"{name}.png", dpi=110)


if __name__ == "__main__":
    main()
