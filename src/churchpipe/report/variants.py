"""The building as it is beside its variants: load factors, mechanisms, checks and costs, in one table and one chart."""

import math
from collections.abc import Iterable, Mapping, Sequence
from textwrap import fill
from typing import Any
from urllib.parse import quote

import numpy as np

from churchpipe.io.records import Analysis
from churchpipe.io.summary import VariantResult
from churchpipe.model.swept import setting
from churchpipe.report import colours
from churchpipe.report.plots import WIDTH, legend_below, new_plot, svg_of
from churchpipe.report.safety import safety_index, what_moves
from churchpipe.report.table import Row, change, figure

AS_IS = "as it is"
# Letters for which a line below the chart has room, and those of the narrowest column of them.
_LETTERS, _NARROWEST = 66, 8


def variants_section(variants: Sequence[VariantResult], analyses: Sequence[Analysis], geometry: str) -> dict[str, Any] | None:
    """Return what the section of the variants shows, or None of a case without variants.

    headings: of the load factors, by model and kind. costs: names of the cost figures. rows: one for each load and variant.
    chart: SVG. geometry: the one whose report it is for, "" where there is one alone; the others' reports are linked.
    """
    if len(variants) < 2:
        return None
    known = {record.name: Row(record) for record in analyses}
    cells: dict[str, dict[str, dict[str, Row]]] = {}
    curves: dict[tuple[str, str], list[Row]] = {}
    for variant in variants:
        for row in (known[name] for name in variant.analyses if name in known):
            if row.record.method == "curve":
                curves.setdefault((_asked(row), variant.name or AS_IS), []).append(row)
                continue
            cells.setdefault(_asked(row), {}).setdefault(variant.name or AS_IS, {}).setdefault(_kind(row), row)
    kinds = list(dict.fromkeys(kind for of_load in cells.values() for found in of_load.values() for kind in found))
    costs = list(dict.fromkeys(key for variant in variants for key in variant.cost))
    first = variants[0].geometry
    rows: list[dict[str, Any]] = []
    for load, of_load in cells.items():
        for variant in variants:
            name = variant.name or AS_IS
            if name not in of_load:
                continue
            found, asis = of_load[name], of_load.get(AS_IS, {})
            rows.append(
                {
                    "load": load,
                    "name": name,
                    "link": link_to(geometry or first, variant.geometry, first),
                    "factors": [_factor(found.get(kind), asis.get(kind), name) for kind in kinds],
                    "moves": _moves(found.values()),
                    # As in the verdict on all loads, the check by displacements governs where there is one.
                    "check": _check(curves.get((load, name), ())) or _check(found.values()),
                    "costs": [_cost(variant.cost.get(key)) for key in costs],
                }
            )
    return {"headings": kinds, "costs": costs, "rows": rows, "chart": _chart(cells, [v.name or AS_IS for v in variants])}


def _asked(row: Row) -> str:
    """Return the load of an analysis with all that is swept besides, its friction and its mesh too."""
    return ", ".join([row.load, *(setting(key, value) for key, value in row.record.swept.items())])


def _kind(row: Row) -> str:
    return f"{'shell' if row.of_shell else 'rigid blocks'}, {row.kind}"


def _factor(row: Row | None, asis: Row | None, name: str) -> tuple[str, str]:
    """Return a load factor, or what there is instead of one, and its change."""
    if row is None:
        return "", ""
    value, before = row.value("load_factor"), asis.value("load_factor") if asis else None
    if value is None:
        return row.status, ""
    # What bears less than nothing has no shares.
    if name == AS_IS or before is None or not 0 < before < math.inf or not math.isfinite(value):
        return figure(value, 4), ""
    return figure(value, 4), change(value / before - 1)


def _moves(rows: Iterable[Row]) -> str:
    """Return what moves at the lowest load factor of several analyses that say it."""
    said = [(row.value("load_factor"), words) for row in rows if (words := what_moves(row.record))]
    return min(said, key=lambda one: math.inf if one[0] is None else one[0], default=(None, ""))[1]


def _check(rows: Iterable[Row]) -> str:
    """Return the lowest safety index of several analyses, with e* = 1, and its verdict."""
    checked = [(check.zeta_e, row) for row in rows if (check := row.record.check) and check.satisfied is not None]
    lowest = min(checked, key=lambda one: one[0], default=(0.0, None))[1]
    return safety_index(lowest).partition(";")[0] if lowest else ""


def _cost(value: object) -> str:
    return f"{value:,.6g}" if isinstance(value, int | float) else str(value or "")


def link_to(here: str, there: str, first: str) -> str:
    """Return where the report of another geometry lies, seen from the report of this one; "" for this one."""
    if here == there:
        return ""
    up = "" if here == first else "../../"
    return f"{up}report.html" if there == first else f"{up}geometry/{quote(there)}/report.html"


def _chart(cells: Mapping[str, Mapping[str, Mapping[str, Row]]], names: Sequence[str]) -> str:
    """Return an SVG: for each load a bar a variant, as high as the lowest of its load factors; dots for all of them."""
    axes: Any
    figure_, (axes,) = new_plot(1, (WIDTH, 2.8))
    width = 0.8 / len(names)
    for number, name in enumerate(names):
        bars: list[tuple[float, float]] = []
        for group, of_load in enumerate(cells.values()):
            values = [value for row in of_load.get(name, {}).values() if (value := row.value("load_factor")) is not None]
            values = [value for value in values if math.isfinite(value)]
            if values:
                place = group + (number - (len(names) - 1) / 2) * width
                bars.append((place, min(values)))
                axes.plot([place] * len(values), values, "o", ms=3.2, color=colours.INK, zorder=3)
        if bars:
            place, height = np.array(bars).T
            colour = colours.PUSH if name == AS_IS else colours.PANELS[(number - 1) % len(colours.PANELS)]
            axes.bar(place, height, 0.9 * width, color=colour, label=name)
    axes.set_axisbelow(True)
    room = max(_LETTERS // max(len(cells), 1), _NARROWEST)
    axes.set_xticks(range(len(cells)), [fill(load, room, break_long_words=False) for load in cells])
    axes.set_ylabel("load factor")
    legend_below(axes)
    return svg_of(figure_)
