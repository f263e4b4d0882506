"""Plots of the shell: capacity curves, load factor against the mesh, strength of the unit cell."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from churchpipe.homogenised_shell.cell_limit import cell_limit
from churchpipe.homogenised_shell.rigid_cell import rigid_cell
from churchpipe.homogenised_shell.strength import paper_planes
from churchpipe.model.arrays import FloatArray
from churchpipe.report import colours
from churchpipe.report.plots import WIDTH, legend_below, new_panels, new_plot, svg_of, svg_of_panels

Line = tuple[str, float]
_STYLES = ("--", ":", "-.", (0, (6, 1, 1, 1)), (0, (1, 3)))
_N11, _N22, _N12, _M11, _M22, _M12 = range(6)
_RAYS = 48
# Sections narrower than this, in units of the membrane force, are a line or a point.
_NOTHING = 1e-6
# Sections of the strength domain: title, first and second stress, stresses that stay as they are; in units of the membrane force
# across the bed joints, moments over the wall's thickness.
_SECTIONS = (
    ("N11 and N12, N22 = −1", _N11, _N12, {_N22: -1.0}),
    ("N22 and N12, N11 = 0", _N22, _N12, {}),
    ("N11 and N22, N12 = 0.3", _N11, _N22, {_N12: 0.3}),
    ("M11 and M22, N11 = N22 = −1", _M11, _M22, {_N11: -1.0, _N22: -1.0}),
    ("M22 and M12, N11 = N22 = −1", _M22, _M12, {_N11: -1.0, _N22: -1.0}),
    ("M11 and M12, N11 = N22 = −1", _M11, _M12, {_N11: -1.0, _N22: -1.0}),
)
# The part of a curve where it bends ends at three times the displacement at this share of its largest load factor.
_BENT = 0.97
# A section of the strength domain that runs away is cut off here.
_FARTHEST = 3.0
_NAMES = ("N11", "N22", "N12", "M11 / h", "M22 / h", "M12 / h")


def capacity_svg(curves: Sequence[tuple[str, FloatArray, FloatArray]], lines: Sequence[Line]) -> str:
    """Return an SVG of load factor against displacement; each curve: label, displacements (n,) mm, load factors (n,).

    lines: load factors of other analyses, drawn across. On the left the part where the curves bend, on the right all of them.
    """
    bend, whole = new_panels(2, (4.7, 3.2))
    for a in (bend, whole):
        for (label, place, factor), marker in zip(curves, "os^vD<>ph*" * (len(curves) // 10 + 1), strict=False):
            a.plot(place, factor, "-", marker=marker, ms=3.6, lw=1.5, label=label)
        _across(a, lines)
        a.set_xlabel("displacement of the control point along the load, mm", fontsize=8)
        a.set_ylabel("load factor", fontsize=8)
        a.set_ylim(bottom=0)
        a.set_xlim(left=0)
    bend.set_xlim(0, max(bend_of(place, factor) for _, place, factor in curves))
    legend_below(whole)
    return svg_of_panels(bend, whole)


def bend_of(place: FloatArray, factor: FloatArray) -> float:
    """Return the displacement up to which a curve bends."""
    reached = place[np.argmax(factor >= _BENT * factor.max(initial=0.0))]
    return float(3 * reached) or float(place.max(initial=0.0)) or 1.0


def mesh_svg(series: Sequence[tuple[str, FloatArray, FloatArray]], lines: Sequence[Line]) -> str:
    """Return an SVG of load factor against element size; each series: label, sizes (n,) mm, load factors (n,)."""
    figure, (axes,) = new_plot(1, (WIDTH, 3.0))
    for (label, size, factor), marker in zip(series, "os^vD<>ph*" * (len(series) // 10 + 1), strict=False):
        order = np.argsort(size)
        (drawn,) = axes.plot(size[order], factor[order], "-", marker=marker, ms=4.5, lw=1.4, label=label)
        if len(size) > 2:
            slope, start = np.polyfit(size, factor, 1)
            place = np.array([0.0, size.max()])
            label = f"straight line, {start:.4f} at size 0"
            axes.plot(place, start + slope * place, lw=0.9, ls=(0, (1, 2)), color=drawn.get_color(), label=label)
    _across(axes, lines)
    axes.set_xlabel("element size, mm")
    axes.set_ylabel("load factor")
    axes.set_xlim(left=0)
    axes.margins(y=0.2)
    legend_below(axes)
    return svg_of(figure)


def _across(axes: Any, lines: Sequence[Line]) -> None:
    for (label, value), style in zip(lines, _STYLES * (len(lines) // len(_STYLES) + 1), strict=False):
        axes.axhline(value, color=colours.INK, lw=1, ls=style, label=f"{label}, {value:.4f}")


def domain_section(
    a: float,
    b: float,
    h: float,
    friction: float,
    first: int,
    second: int,
    kept: dict[int, float],
    rays: int = _RAYS,
    bond: str = "running",
) -> tuple[FloatArray, FloatArray]:
    """Return a section of the exact strength domain of the cell of a bond, and of the eight planes, without cohesion.

    a, b, h: course height, stone length, wall thickness, m; the planes are those of running bond. first, second: which stresses
    (of N11, N22, N12, M11, M22, M12) span the section. kept: the others' values that are not zero; membrane forces N/m, moments
    over h.

    Returns corners (rays, 2) of either domain, seen from a point inside it; NaN where it is unbounded.
    """
    unit = np.array([1, 1, 1, h, h, h])
    base = np.zeros(6)
    base[list(kept)] = list(kept.values())
    # A point inside: under compression along both axes of the section.
    base[[stress for stress in (first, second) if stress in (_N11, _N22)]] = -1.0
    angle = 2 * np.pi * np.arange(rays) / rays
    direction = np.zeros((rays, 6))
    direction[:, first], direction[:, second] = np.cos(angle), np.sin(angle)
    closing = rigid_cell(bond, a, b, h).closing
    cell = np.array([cell_limit(closing, friction, h, ray * unit, base=base * unit).factor for ray in direction])
    planes = paper_planes(a, b, h, min(friction, 1.0))
    rate = direction * unit @ planes.normal.T
    room = planes.limit - planes.normal @ (base * unit)
    reach = np.divide(room, rate, out=np.full_like(rate, np.inf), where=rate > 1e-12).min(axis=1)
    ends = [
        base[[first, second]] + np.where(np.isfinite(t), t, np.nan)[:, None] * direction[:, [first, second]]
        for t in (cell, reach)
    ]
    return ends[0], ends[1]


def domain_svg(a: float, b: float, h: float, friction: float, bond: str = "running") -> str:
    """Return an SVG of sections of a bond's strength: the exact domain, and of running bond the eight planes; sizes in m."""
    axes = new_panels(len(_SECTIONS), (3.1, 2.8))
    for place, (title, first, second, kept) in zip(axes, _SECTIONS, strict=True):
        cell, planes = domain_section(a, b, h, friction, first, second, kept, bond=bond)
        drawn = [(cell, colours.ALARM, "-", "unit cell" if bond == "running" else f"cell of {bond} bond")]
        if bond == "running":
            drawn.insert(0, (planes, colours.PUSH, "--", "eight planes"))
        for corners, colour, style, label in drawn:
            closed = np.concatenate([corners, corners[:1]])
            place.plot(*closed.T, ls=style, lw=1.3, color=colour, label=label)
        place.set_title(title, fontsize=8)
        place.set_xlabel(_NAMES[first], fontsize=8)
        place.set_ylabel(_NAMES[second], fontsize=8)
        place.set_xlim(*_frame(cell[:, 0]))
        place.set_ylim(*_frame(cell[:, 1]))
    axes[0].legend(fontsize=7, frameon=False, loc="best")
    return svg_of_panels(*axes)


def _frame(values: FloatArray) -> tuple[float, float]:
    """Return limits around the finite part of a section, cut off where it runs away."""
    seen = np.clip(values[np.isfinite(values)], -_FARTHEST, _FARTHEST)
    low, high = (float(seen.min()), float(seen.max())) if len(seen) else (-1.0, 1.0)
    # A bond without strength there has but rounding to show.
    room = 0.12 * (high - low) if high - low > _NOTHING else 1.0
    return low - room, high + room
