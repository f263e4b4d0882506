"""Capacity curves of the stones at large displacements, in the report."""

import math
from collections.abc import Sequence

import numpy as np

from churchpipe.io.records import Analysis
from churchpipe.model.block_curve import ALIKE
from churchpipe.model.swept import setting
from churchpipe.report.plots import WIDTH, legend_below, new_plot, svg_of
from churchpipe.report.table import by_material
from churchpipe.wording import three_figures

_ENDINGS = {
    "vanished": "the load factor has vanished",
    "collapsed": "stones fall that the structure cannot spare",
    "unfinished": "it was not followed further",
    "unbounded": "the stones have locked",
    "not-converged": "a step was not solved",
}


def block_curve_plots(analyses: Sequence[Analysis], geometry: str | None) -> list[tuple[str, str, list[str]]]:
    """Return (load, SVG, a sentence on each curve) for the loads that have curves of the stones; those of the shell beside them.

    analyses: the records of the summary. geometry: that of the report where there are several.
    """
    of_load: dict[str, list[Analysis]] = {}
    of_shell: dict[str, list[Analysis]] = {}
    for record in (record for record in analyses if record.geometry == geometry):
        if record.method == "curve" and record.displacement:
            of_load.setdefault(record.load, []).append(record)
        if record.method == "pushover" and record.control:
            of_shell.setdefault(record.load, []).append(record)
    return [
        (load, _svg(records, of_shell.get(load, ())), [*map(_sentence, records), *map(_of_shell, of_shell.get(load, ()))])
        for load, records in of_load.items()
    ]


def _svg(records: Sequence[Analysis], shells: Sequence[Analysis]) -> str:
    figure, (axes,) = new_plot(1, (WIDTH, 3.0))
    for record in records:
        places, factors = 1e3 * np.array(record.displacement), np.array(record.load_factors)
        proved = _proved(record)
        (line,) = axes.plot(places[:proved], factors[:proved], "-o", ms=2.5, lw=1.4, label=curve_label(record))
        if proved < len(places):
            # From the last step that is proved, so that no piece of the line is missing.
            rest, label = slice(max(proved - 1, 0), None), f"{curve_label(record)}, steps not proved"
            look = {"lw": 0.8, "alpha": 0.6, "ms": 3.5, "mfc": "white", "zorder": 1}
            axes.plot(places[rest], factors[rest], "-o", color=line.get_color(), label=label, **look)
        if record.no_equilibria:
            jumps, label = np.array(record.no_equilibria) - 1, f"{curve_label(record)}, no equilibria"
            axes.plot(places[jumps], factors[jumps], "x", ms=6, color=line.get_color(), label=label)
        if (again := record.halved) and again.displacement:
            label = f"{curve_label(record)}, steps half as long"
            axes.plot(1e3 * np.array(again.displacement), again.load_factors, ":", lw=1.4, color=line.get_color(), label=label)
    reached = [of.displacement or (0.0,) for record in records for of in (record, record.halved) if of]
    # A control point may go backwards.
    least, furthest = (end(1e3 * place for places in reached for place in (*places, 0.0)) for end in (min, max))
    for record in shells:
        label = f"shell, {curve_label(record)}"
        axes.plot(1e3 * np.array(record.control), record.load_factors, "--s", ms=2.5, lw=1.2, label=label)
    axes.set_xlabel("displacement along the load, mm", fontsize=8)
    axes.set_ylabel("load factor", fontsize=8)
    # Displacements of the shell are small in its theory: its plateau goes on for ever.
    axes.set_xlim(1.05 * least, 1.05 * furthest if furthest > 0 or least < 0 else None)
    axes.set_ylim(bottom=0)
    legend_below(axes)
    return svg_of(figure)


def curve_label(record: Analysis) -> str:
    """Return what tells a curve from others of its load: its variant of the building, and what was swept, or its friction."""
    swept = [setting(key, value) for key, value in record.swept.items()]
    return ", ".join([*([record.variant] if record.variant else []), *(swept or [f"friction {by_material(record.friction)}"])])


def _of_shell(record: Analysis) -> str:
    return f"Dashed: the shell at small displacements, elastic and associative, against that of its {control_words(record)}."


def control_words(record: Analysis) -> str:
    """Return which node a capacity curve of the shell follows, and where it lies."""
    place = ", ".join(f"{value:.4g}" for value in record.control_at or ())
    return f"node {record.control_point}" + (f" at ({place}) m" if place else "")


def _sentence(record: Analysis) -> str:
    last = (record.displacement or (0.0,))[-1] if record.d0 is None or math.isnan(record.d0) else record.d0
    fell = zip(record.fallen_stones or (), record.fell_at or (), strict=True)
    names = ", ".join(f"{name} (at {three_figures(at * 1e3)} mm)" for name, at in fell)
    fallen = f". On the way fell {names}" if names else ""
    start = f"{curve_label(record)}: it starts at a load factor of {record.load_factor:.4f}"
    end = f"{start} and ends at {last * 1e3:.4g} mm, where {_ENDINGS[str(record.ending)]}{fallen}."
    jumps = " Crosses are no equilibria: there the structure jumps, or stones of it hang." if record.no_equilibria else ""
    return f"{end}{_not_proved(record)}{jumps}{_halved(record)}"


def _proved(record: Analysis) -> int:
    """Return how many steps from the first one on are proved; all of them where an old record does not say."""
    count = len(record.displacement or ())
    return count if record.proved_steps is None else min(record.proved_steps, count)


def _not_proved(record: Analysis) -> str:
    """Return from where on the steps of a curve are not proved, "" where all are."""
    places, proved = record.displacement or (), _proved(record)
    if proved == len(places):
        return ""
    beyond = f"Beyond {three_figures(1e3 * places[proved - 1])} mm" if proved else "From the first step on"
    return f" {beyond} (hollow points) the steps are not proved: do not rely on load factors and displacements from there on."


def _halved(record: Analysis) -> str:
    """Return what steps half as long make of a curve, "" where it was not followed so."""
    again = record.halved
    if again is None or not again.displacement:
        return ""
    last = again.displacement[-1] if math.isnan(again.d0) else again.d0
    away = f"up to {100 * again.difference:.2g} % of the first load factor away, at {three_figures(1e3 * again.difference_at)} mm"
    away = "the same" if again.difference < ALIKE else away
    return f" With steps half as long (dotted) it is {away}, and ends at {last * 1e3:.4g} mm, where {_ENDINGS[again.ending]}."
