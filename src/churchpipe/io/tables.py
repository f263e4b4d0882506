"""summary.json and table.csv: what people and programs read when a run is done."""

import csv
import json
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from churchpipe.errors import InputError
from churchpipe.io.atomic import replacing

# What every summary has.
SUMMARY = ("case", "blocks", "interfaces", "weight_kN", "analyses")
COLUMNS = (
    "variant",
    "model",
    "flow",
    "method",
    "planes",
    "load",
    "friction",
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
# How a cell begins that spreadsheets compute; "+x" and "-y", the loads along the axes, stay as they are.
_FORMULA = re.compile(r"(?![+-][xyz]\Z)[=+\-@\t\r]")


def read_json(path: str | Path) -> Any:
    """Read a JSON artifact.

    Raises
    ------
    InputError: the file is missing or not JSON.
    """
    try:
        return json.loads(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(str(path), "cannot be read", found=error.strerror or error, expected="an artifact of a run") from error
    except ValueError as error:
        raise InputError(str(path), "not JSON", found=error, remedy="Delete the file and run the case again.") from error


def read_summary(path: str | Path) -> dict[str, Any]:
    """Read summary.json.

    Raises
    ------
    InputError: the file is missing, not JSON, or without the keys of a summary.
    """
    summary = read_json(path)
    missing = [key for key in SUMMARY if not isinstance(summary, dict) or key not in summary]
    if missing:
        raise InputError(
            str(path), "not a summary of a run", expected=", ".join(missing), remedy="Delete the file and run the case again."
        )
    return summary


def write_table(path: str | Path, analyses: Sequence[dict[str, Any]]) -> None:
    """Write analyses, as summary.json has them, as CSV, one row each: first what was swept, then `COLUMNS`; `zeta_e` and its
    neighbours from the check.

    A text that a spreadsheet would take for a formula stands behind an apostrophe; names of axes ("-y") are none.
    """
    swept = list(dict.fromkeys(key for analysis in analyses for key in analysis.get("swept", {})))
    with replacing(path) as part, part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow([*swept, *COLUMNS])
        for analysis in analyses:
            known = analysis.get("check", {}) | analysis
            row = [analysis.get("swept", {}).get(key) for key in swept] + [known.get(key) for key in COLUMNS]
            writer.writerow([_cell(value) for value in row])


def _cell(value: Any) -> Any:
    if value is None:
        return ""
    return f"'{value}" if isinstance(value, str) and _FORMULA.match(value) else value
