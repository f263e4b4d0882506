"""Plots (matplotlib, as SVG)."""

import io
from collections.abc import Sequence
from typing import Any

import numpy as np

from churchpipe.model.arrays import FloatArray
from churchpipe.model.results import LimitState
from churchpipe.report import colours


def convergence_svg(state: LimitState, associative: float | None = None) -> str:
    """Return an SVG of the non-associative iteration: load factor above, friction violation and gap below."""
    steps = np.arange(1, len(state.history) + 1)
    factor = np.array([step.load_factor for step in state.history])
    errors = {
        "friction violation": (np.array([step.violation for step in state.history]), colours.ALARM, "o"),
        "gap g / load factor": (np.array([step.gap for step in state.history]), colours.PUSH, "s"),
    }
    figure, (upper, lower) = new_plot(2, (7.2, 4.6))
    if np.isfinite(state.interval).all():
        upper.axhspan(*state.interval, color=colours.PUSH, alpha=0.12, lw=0, label="interval of the mechanism")
    if associative is not None and np.isfinite(associative):
        upper.axhline(associative, color=colours.INK, lw=1, ls="--", label=f"associative, {associative:.4f}")
    for number, value in enumerate(state.fixed_points):
        label = "fixed points of the starts" if number == 0 else None
        upper.axhline(value, color=colours.PUSH, lw=0.9, ls=":", label=label)
    upper.plot(steps, factor, "-o", ms=3.2, lw=1.4, color="#a8581a", label="load factor")
    upper.set_ylabel("load factor")
    for label, (values, colour, marker) in errors.items():
        seen = np.isfinite(values) & (values > 0)
        if seen.any():
            lower.semilogy(steps[seen], values[seen], "-", marker=marker, ms=3.2, lw=1.2, color=colour, label=label)
    lower.set_ylabel("error")
    lower.set_xlabel("iteration")
    for axes in (upper, lower):
        axes.margins(y=0.18)
        legend_beside(axes)
    return svg_of(figure)


def friction_svg(curves: Sequence[tuple[str, FloatArray, FloatArray]]) -> str:
    """Return an SVG of load factor against friction; each curve: label, frictions (n,), load factors (n,)."""
    figure, (axes,) = new_plot(1, (7.2, 3.2))
    for (label, friction, factor), marker in zip(curves, "os^vD<>ph*" * (len(curves) // 10 + 1), strict=False):
        order = np.argsort(friction)
        axes.plot(friction[order], factor[order], "-", marker=marker, ms=4.5, lw=1.4, label=label)
    axes.set_xlabel("friction coefficient")
    axes.set_ylabel("load factor")
    axes.set_ylim(bottom=0)
    legend_beside(axes)
    return svg_of(figure)


def new_plot(rows: int, size: tuple[float, float], columns: int = 1) -> tuple[Any, Any]:
    """Return a figure of the given size, inches, and its axes: (rows,) over one another that share x, or (rows, columns)."""
    from matplotlib.figure import Figure
    from matplotlib.ticker import MaxNLocator

    figure = Figure(figsize=size, layout="constrained")
    axes = figure.subplots(rows, columns, sharex=columns == 1, squeeze=False)
    for a in axes.ravel():
        a.grid(color="#e6e2db", lw=0.7)
        a.spines[["top", "right"]].set_visible(False)
        a.tick_params(labelsize=8)
    if columns > 1:
        return figure, axes
    if rows > 1:
        axes[-1, 0].xaxis.set_major_locator(MaxNLocator(integer=True))
    return figure, axes[:, 0]


def legend_beside(axes: Any) -> None:
    """Put the legend of axes, if they have one, to their right."""
    if axes.get_legend_handles_labels()[0]:
        axes.legend(fontsize=8, frameon=False, loc="upper left", bbox_to_anchor=(1.01, 1.0))


def svg_of(figure: Any) -> str:
    """Return a figure as an svg element."""
    from matplotlib import rc_context

    buffer = io.StringIO()
    # Text stays text (searchable, in the page's font); without metadata the file names no address at all.
    nothing = dict.fromkeys(("Creator", "Date", "Format", "Type"))
    with rc_context({"svg.fonttype": "none", "svg.hashsalt": "churchpipe", "font.family": "sans-serif"}):
        figure.savefig(buffer, format="svg", metadata=nothing)
    text = buffer.getvalue()
    return text[text.index("<svg") :]
