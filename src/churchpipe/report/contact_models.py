"""Load factors of both contact models side by side, as the rows of a table."""

from collections.abc import Mapping
from typing import Any

from churchpipe.report.table import figure, minus


def contact_model_rows(summary: Mapping[str, Any]) -> dict[str, Any] | None:
    """Return rows of text (load, flow, load factors, difference) and the sentences about those that differ; None: no pair."""
    pairs = summary.get("contact_models", ())
    if not pairs:
        return None
    rows = [
        [
            minus(str(pair["load"])),
            pair["flow"],
            figure(pair["corners"], 4),
            figure(pair["torsion"], 4),
            minus(f"{100 * pair['difference']:+.1f} %"),
        ]
        for pair in pairs
    ]
    return {"rows": rows, "sentences": list(dict.fromkeys(pair["sentence"] for pair in pairs if "sentence" in pair))}
