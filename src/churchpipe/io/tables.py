"""table.csv: the analyses of a run as rows."""

import csv
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from churchpipe.io.atomic import replacing
from churchpipe.io.records import Analysis
from churchpipe.model.quantities import as_written

COLUMNS = (
    "name",
    "variant",
    "model",
    "flow",
    "method",
    "planes",
    "element_size_mm",
    "load",
    "friction",
    "cohesion_kPa",
    "contact_model",
    "compressive_strength_MPa",
    "load_factor",
    "lower_bound",
    "upper_bound",
    "status",
    "gap",
    "friction_violation",
    "equilibrium_residual",
    "cone_violation",
    "yield_violation",
    "confidence_factor",
    "zeta_e",
    "zeta_e_lc1",
    "satisfied",
    "zeta_e_stones",
    "mechanism",
    "iterations",
    "seconds",
)
# How a cell begins that spreadsheets compute; "+x" and "-y", the loads along the axes, and the names of their analyses, such as
# "-y_limit", stay as they are.
_FORMULA = re.compile(r"(?![+-][xyz](?:_[\w.,=+-]*)?\Z)[=+\-@\t\r]")


def write_table(path: str | Path, analyses: Sequence[Analysis]) -> None:
    """Write analyses, by the keys of summary.json, as CSV, one row each: first what was swept, then `COLUMNS`; `zeta_e` and its
    neighbours from the check.

    A text that a spreadsheet would take for a formula stands behind an apostrophe; names of axes ("-y") are none, nor
    those of analyses that begin with them ("-y_limit").
    """
    swept = list(dict.fromkeys(key for analysis in analyses for key in analysis.swept))
    with replacing(path) as part, part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow([*swept, *COLUMNS])
        for analysis in analyses:
            words = as_written(analysis, defaults=False)
            known = words.get("check", {}) | words
            row = [analysis.swept.get(key) for key in swept] + [known.get(key) for key in COLUMNS]
            writer.writerow([_cell(value) for value in row])


def _cell(value: Any) -> Any:
    if value is None:
        return ""
    return f"'{value}" if isinstance(value, str) and _FORMULA.match(value) else value
