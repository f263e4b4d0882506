"""Plots (matplotlib, as SVG)."""

import io
from collections.abc import Sequence
from typing import Any

import numpy as np

from churchpipe.model.arrays import FloatArray
from churchpipe.model.contacts import Contacts
from churchpipe.model.results import LimitState, StartRun
from churchpipe.report import colours
from churchpipe.stones.histogram import angle_histogram, gap_histogram

# One a start of the non-associative iteration.
_RUN_COLOURS = ("#a8581a", colours.PUSH, "#4f7d4a")
_CERTIFIED = 1e-5
# Width of a plot, inches: its words can be read on a phone, too. Of its legend: height of a line, inches, and the longest label
# of which two stand beside each other, letters.
WIDTH = 5.0
_LINE = 0.19
_SHORT = 30


def convergence_svg(state: LimitState, associative: float | None = None) -> str:
    """Return an SVG of the non-associative iteration: load factor above, friction violation and gap below.

    One curve a start, beside it the interval of load factors that its mechanism allows.
    """
    runs = state.starts or (
        StartRun("", state.load_factor, state.status == "converged", state.gap, state.interval, state.history),
    )
    from churchpipe.report.powers import label_powers

    figure, (upper, lower) = new_plot(2, (WIDTH, 4.2))
    if associative is not None and np.isfinite(associative):
        upper.axhline(associative, color=colours.INK, lw=1, ls="--", label=f"associative, {associative:.4f}")
    end = max(len(run.history) for run in runs)
    for number, (run, colour) in enumerate(zip(runs, _RUN_COLOURS, strict=False)):
        start = f", {run.start} start" if run.start else ""
        steps = np.arange(1, len(run.history) + 1)
        factor = np.array([step.load_factor for step in run.history])
        upper.plot(steps, factor, "-o", ms=3.2, lw=1.4, color=colour, label=f"load factor{start}")
        if np.isfinite(run.interval).all():
            low, high = run.interval
            place = end + (1 + number) * max(0.03 * end, 0.3)
            label = f"interval of the mechanism, {low:.4f} to {high:.4f}"
            bars = np.array([[max(run.load_factor - low, 0.0)], [max(high - run.load_factor, 0.0)]])
            upper.errorbar([place], [run.load_factor], yerr=bars, fmt="_", capsize=4, lw=2, color=colour, label=label)
        errors = (("friction violation", "violation", "o", ":"), ("gap g / load factor", "gap", "s", "-"))
        for words, name, marker, line in errors:
            values = np.array([getattr(step, name) for step in run.history])
            seen = np.isfinite(values) & (values > 0)
            if seen.any():
                label = words + start
                lower.semilogy(steps[seen], values[seen], ls=line, marker=marker, ms=3.2, lw=1.2, color=colour, label=label)
    if lower.get_yscale() == "log":
        label_powers(lower.yaxis)
    if any(np.isfinite(step.gap) for run in runs for step in run.history):
        lower.axhline(_CERTIFIED, color=colours.INK, lw=0.8, ls="--", label="gap of a certified state")
    upper.set_ylabel("load factor")
    lower.set_ylabel("error")
    lower.set_xlabel("iteration")
    for axes in (upper, lower):
        axes.margins(y=0.18)
    legend_below(upper, lower)
    return svg_of(figure)


def sensitivity_svg(curves: Sequence[tuple[str, FloatArray, FloatArray]], words: str) -> str:
    """Return an SVG of load factor against a quantity; each curve: label, its values (n,), load factors (n,)."""
    figure, (axes,) = new_plot(1, (WIDTH, 2.8))
    for (label, value, factor), marker in zip(curves, "os^vD<>ph*" * (len(curves) // 10 + 1), strict=False):
        order = np.argsort(value)
        axes.plot(value[order], factor[order], "-", marker=marker, ms=4.5, lw=1.4, label=label)
    axes.set_xlabel(words)
    axes.set_ylabel("load factor")
    axes.set_ylim(bottom=0)
    legend_below(axes)
    return svg_of(figure)


def gaps_svg(contacts: Contacts) -> str:
    """Return an SVG of how far apart faces are that meet or nearly meet, and at which angle; "" where all joints are exact."""
    given = contacts.tolerances
    gaps, angles = gap_histogram(contacts), angle_histogram(contacts)
    if not len(contacts.near_misses) and not gaps.joints[1:].any() and not angles.joints[1:].any():
        return ""
    from churchpipe.report.powers import Powers, label_powers

    left, right = new_panels(2, (3.8, 2.8))
    panels = (
        (left, gaps, 1e3, given.contact_gap, "gap, mm", "contact gap"),
        (right, angles, np.degrees(1.0), given.contact_angle, "angle, degrees", "contact angle"),
    )
    for axes, found, unit, limit, words, name in panels:
        edges, width = unit * found.edges[:-1], unit * np.diff(found.edges)
        axes.bar(edges, found.joints, width, align="edge", color="#4f7d4a", label="joints")
        axes.bar(edges, found.near_misses, width, align="edge", bottom=found.joints, color=colours.PUSH, label="near misses")
        axes.axvline(unit * limit, color=colours.INK, lw=1, ls="--", label=f"{name}, {unit * limit:.3g}")
        axes.set_xscale("log")
        axes.set_yscale("symlog", linthresh=1)
        label_powers(axes.xaxis)
        axes.yaxis.set_major_formatter(Powers())
        axes.set_xlabel(words)
        axes.set_ylabel("pairs of faces")
        axes.legend(fontsize=7, frameon=False)
    return svg_of_panels(left, right)


def new_plot(rows: int, size: tuple[float, float]) -> tuple[Any, Any]:
    """Return a figure of the given size, inches, and its axes (rows,), over one another with the same x."""
    from matplotlib.figure import Figure
    from matplotlib.ticker import MaxNLocator

    figure = Figure(figsize=size, layout="constrained")
    axes = figure.subplots(rows, sharex=True, squeeze=False)[:, 0]
    for a in axes:
        a.set_prop_cycle(color=colours.LINES)
        a.grid(color="#e6e2db", lw=0.7)
        a.spines[["top", "right"]].set_visible(False)
        a.tick_params(labelsize=8)
        # Values that hardly differ would be told as what they have beyond a number in the corner.
        a.ticklabel_format(useOffset=False)
    if rows > 1:
        axes[-1].xaxis.set_major_locator(MaxNLocator(integer=True))
    return figure, axes


def new_panels(count: int, size: tuple[float, float]) -> list[Any]:
    """Return axes that stand beside each other, and on a phone below each other: each in a figure of this size, inches."""
    return [new_plot(1, size)[1][0] for _ in range(count)]


def svg_of_panels(*axes: Any) -> str:
    """Return the figures of `new_panels` as svg elements in a box."""
    kind = "panels many" if len(axes) > 4 else "panels"
    return f'<div class="{kind}">' + "".join(svg_of(each.figure) for each in axes) + "</div>"


def legend_below(*several: Any) -> None:
    """Put one legend of all axes, if they have any, below their figure, which becomes so much higher.

    Beside them it would take a third of the width, and on a phone the words of the plot would be too small to read.
    """
    found = [(handle, label) for axes in several for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)]
    if not found:
        return
    handles, labels = zip(*found, strict=True)
    columns = 2 if max(map(len, labels)) <= _SHORT else 1
    figure = several[0].figure
    width, height = figure.get_size_inches()
    figure.set_size_inches(width, height + 0.1 + _LINE * -(-len(labels) // columns))
    figure.legend(handles, labels, loc="outside lower left", ncols=columns, fontsize=8, frameon=False)


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
