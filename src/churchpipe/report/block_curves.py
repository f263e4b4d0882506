"""Capacity curves of the stones at large displacements, in the report."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from churchpipe.report.plots import legend_beside, new_plot, svg_of

_ENDINGS = {
    "vanished": "the load factor has vanished",
    "collapsed": "stones fall that the structure cannot spare",
    "unfinished": "it was not followed further",
    "unbounded": "the stones have locked",
    "not-converged": "a step was not solved",
}


def block_curve_plots(analyses: Sequence[Mapping[str, Any]], geometry: str | None) -> list[tuple[str, str, list[str]]]:
    """Return (load, SVG, a sentence on each curve) for the loads that have curves of the stones.

    analyses: the records of the summary. geometry: that of the report where there are several.
    """
    of_load: dict[str, list[Mapping[str, Any]]] = {}
    for record in analyses:
        mine = record.get("method") == "curve" and record.get("displacement_m")
        if mine and record.get("geometry") == geometry:
            of_load.setdefault(str(record["load"]), []).append(record)
    return [(load, _svg(records), [_sentence(record) for record in records]) for load, records in of_load.items()]


def _svg(records: Sequence[Mapping[str, Any]]) -> str:
    figure, (axes,) = new_plot(1, (7.2, 3.4))
    for record in records:
        axes.plot(
            np.array(record["displacement_m"]) * 1e3, record["load_factors"], "-o", ms=2.5, lw=1.4, label=curve_label(record)
        )
    axes.set_xlabel("displacement along the load, mm", fontsize=8)
    axes.set_ylabel("load factor", fontsize=8)
    axes.set_xlim(left=0)
    axes.set_ylim(bottom=0)
    legend_beside(axes)
    return svg_of(figure)


def curve_label(record: Mapping[str, Any]) -> str:
    """Return what tells a curve from others of its load: what was swept, or its friction."""
    swept = [f"{key.rpartition('.')[2]} = {value}" for key, value in record.get("swept", {}).items()]
    return ", ".join(swept) or f"friction {record['friction']}"


def _sentence(record: Mapping[str, Any]) -> str:
    last = record["d0_m"] if record["d0_m"] is not None else record["displacement_m"][-1]
    fallen = f"; {record['fallen_stones']} stones have fallen on the way" if record["fallen_stones"] else ""
    start = f"{curve_label(record)}: it starts at a load factor of {record['load_factor']:.4f}"
    return f"{start} and ends at {last * 1e3:.4g} mm, where {_ENDINGS[record['ending']]}{fallen}."
