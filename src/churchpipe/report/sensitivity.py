"""Load factor against whatever number a run sweeps: friction, length of the stones, any key of the case."""

import math
from collections.abc import Sequence

import numpy as np

from churchpipe.model.swept import MESH_SIZE, heading, setting
from churchpipe.report.plots import sensitivity_svg
from churchpipe.report.table import Row


def sensitivity_plots(rows: Sequence[Row]) -> list[tuple[str, str]]:
    """Return what is swept, in words, and the plot of each number that takes several values in comparable analyses."""
    keys = dict.fromkeys(key for row in rows for key in _numbers(row))
    # The size of the mesh has a plot of its own, with the load factors of the rigid blocks across.
    plots = [(heading(key), _plot(key, rows)) for key in keys if key != MESH_SIZE]
    return [(words, plot) for words, plot in plots if plot]


def _plot(key: str, rows: Sequence[Row]) -> str:
    curves: dict[str, list[tuple[float, float]]] = {}
    for row in rows:
        value, factor = _numbers(row).get(key), row.value("load_factor")
        if value is not None and factor is not None and math.isfinite(factor):
            curves.setdefault(_curve(row, key, rows), []).append((value, factor))
    drawn = [(label, *np.array(points).T) for label, points in curves.items() if len({value for value, _ in points}) > 1]
    return sensitivity_svg(drawn, heading(key)) if drawn else ""


def _curve(row: Row, key: str, rows: Sequence[Row]) -> str:
    """Name the curve that an analysis belongs to: all that tells it from others but the number itself."""
    models = ["shell"] if row.of_shell else ["rigid blocks"] if any(other.of_shell for other in rows) else []
    others = [setting(other, value) for other, value in row.record.swept.items() if other != key]
    models += [row.variant] if row.variant else []
    return ", ".join([*models, row.kind, f"load {row.load}", *others])


def _numbers(row: Row) -> dict[str, float]:
    return {key: float(v) for key, v in row.record.swept.items() if isinstance(v, int | float) and not isinstance(v, bool)}
