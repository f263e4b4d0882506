"""The line of thrust drawn in a section."""

from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull

from churchpipe.model.assemblage import Assemblage
from churchpipe.report import colours
from churchpipe.thrust_lines import ThrustLine

_INCHES, _DOTS = (6.0, 4.0), 130
_STONE = "#efe7da"
# A joint whose thrust passes further out than this share of half its width is a hinge.
HINGE = 0.98
# A stone touches the section when it is closer to it than this share of the size of all.
_TOUCHES = 1e-6


def thrust_picture(
    stones: Assemblage,
    line: ThrustLine,
    path: str | Path,
    panels: tuple[str, ...],
    through: tuple[float, float] = (0.0, 0.0),
    direction: tuple[float, float] = (1.0, 0.0),
    width: float = 1.0,
) -> None:
    """Write a PNG of the stones of some panels in a strip about an upright section, or cut by it, and of its line of thrust.

    panels, through, direction, width: as in `thrust_line`. The line is thicker where more force passes; a circle marks a joint
    at whose edge it passes, a hinge.
    """
    section_figure(stones, line, panels, through, direction, width).savefig(path, dpi=_DOTS)


def section_figure(
    stones: Assemblage,
    line: ThrustLine,
    panels: tuple[str, ...],
    through: tuple[float, float],
    direction: tuple[float, float],
    width: float,
) -> Any:
    """Return the figure that `thrust_picture` writes."""
    from matplotlib.figure import Figure

    along = np.append(np.asarray(direction, dtype=np.float64), 0.0)
    along /= np.linalg.norm(along)
    origin = np.append(np.asarray(through, dtype=np.float64), 0.0)
    beside = np.cross([0.0, 0.0, 1.0], along)
    first, off = stones.block_point_ptr[:-1], (stones.points - origin) @ beside
    within = np.abs((stones.centroid - origin) @ beside) <= width / 2
    # Stones of walls may be longer than the strip is wide. Where two meet in the section both are drawn, else none would be.
    close = _TOUCHES * stones.size
    within |= (np.minimum.reduceat(off, first) <= close) & (np.maximum.reduceat(off, first) >= -close)
    figure = Figure(figsize=_INCHES, layout="constrained")
    axes = figure.add_subplot(aspect="equal")
    for stone in np.flatnonzero(np.isin(stones.panel, panels) & within).tolist():
        corner = stones.points[slice(*stones.block_point_ptr[stone : stone + 2])]
        flat = np.stack([(corner - origin) @ along, corner[:, 2]], axis=1)
        axes.fill(*flat[ConvexHull(flat).vertices].T, facecolor=_STONE, edgecolor=colours.EDGE, linewidth=0.6)
    for start, stop, force in zip(line.place[:-1], line.place[1:], line.force[:-1] / line.force.max(), strict=True):
        axes.plot(*np.stack([start, stop]).T, color=colours.SPEED_STOPS[-1], linewidth=1.0 + 2.5 * force, solid_capstyle="round")
    hinge = np.abs(line.eccentricity) > HINGE * line.half
    axes.plot(*line.place[hinge].T, "o", markerfacecolor="white", markeredgecolor=colours.SPEED_STOPS[-1], markersize=7)
    axes.set_xlabel("along the section, m")
    axes.set_ylabel("z, m")
    return figure
