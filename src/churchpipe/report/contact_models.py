"""Load factors of both contact models side by side, as the rows of a table."""

from collections.abc import Sequence
from typing import Any

from churchpipe.io.summary import ContactModels
from churchpipe.report.table import change, figure, minus, named_of


def contact_model_rows(pairs: Sequence[ContactModels]) -> dict[str, Any] | None:
    """Return rows of text (load, flow, load factors, difference) and the sentences about those that differ; None: no pair."""
    if not pairs:
        return None
    rows = [
        [
            named_of(minus(pair.load), pair.variant, pair.swept),
            pair.flow,
            figure(pair.corners, 4),
            figure(pair.torsion, 4),
            change(pair.difference),
        ]
        for pair in pairs
    ]
    return {"rows": rows, "sentences": list(dict.fromkeys(pair.sentence for pair in pairs if pair.sentence))}
