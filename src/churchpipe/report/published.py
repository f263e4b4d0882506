"""Published load factors beside ours, as the rows of a table."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from churchpipe.model.names import MODELS, RIGID_BLOCKS, SHELL
from churchpipe.model.swept import MESH_SIZE, setting
from churchpipe.report.table import Row, change, figure, friction_text, minus, swept

_MODELS = {"rigid": RIGID_BLOCKS, "shell": SHELL}


def published_rows(published: Sequence[Mapping[str, Any]], rows: Sequence[Row]) -> list[list[str]]:
    """Return a row of cells for each published load factor and each analysis that answers the same question.

    published: the fields of `config.Published`. Cells: load, what is published, its load factor, our analysis, its load factor,
    how far ours is off, the source; one row with "not analysed" where this run has nothing to compare.
    """
    table: list[list[str]] = []
    for value in published:
        start = [minus(value["load"]), _published(value), figure(value["load_factor"], 3)]
        ours = [_ours(row, value["load_factor"]) for row in rows if _same_question(row, value)]
        table += [[*start, *cells, value["source"]] for cells in ours or [["not analysed", "", ""]]]
    return table


def _same_question(row: Row, value: Mapping[str, Any]) -> bool:
    record = row.record
    if record.load != value["load"] or value["friction"] not in (None, record.friction):
        return False
    # What was measured on the real thing stands beside every analysis.
    model = _MODELS.get(value["model"])
    return model is None or (record.model == model and value["flow"] in (None, record.flow))


def _published(value: Mapping[str, Any]) -> str:
    model = _MODELS.get(value["model"])
    words = [MODELS[model] if model else value["model"], value["flow"] or ""]
    return ", ".join([word for word in words if word] + _friction(value["friction"]))


def _ours(row: Row, published: float) -> list[str]:
    factor = row.value("load_factor")
    words = [row.record.model_words, row.kind, row.mesh_size]
    words += [setting(key, value) for key, value in swept(row).items() if key != MESH_SIZE]
    words += [f"friction {friction_text(row)}"] if row.record.swept else []
    words += [row.status] if row.status not in ("optimal", "converged") else []
    apart = "" if factor is None or math.isinf(factor) else change(factor / published - 1)
    return [", ".join(word for word in words if word), figure(factor, 4), apart]


def _friction(value: float | None) -> list[str]:
    return [] if value is None else [f"friction {value:g}"]
