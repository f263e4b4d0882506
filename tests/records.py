"""Records of analyses and summaries for tests, by the keys of summary.json."""

from typing import Any

from churchpipe.io.records import Analysis
from churchpipe.io.summary import Summary
from churchpipe.model.quantities import as_read

WORDS: dict[str, Any] = {
    "name": "",
    "variant": None,
    "model": "rigid-block",
    "load": "+x",
    "direction": [1.0, 0.0, 0.0],
    "friction": 0.7,
    "cohesion_kPa": 0.0,
    "load_factor": 0.25,
    "status": "optimal",
    "seconds": 0.0,
    "equilibrium_residual": 0.0,
    "message": "",
}
_TOLERANCES = {"contact_gap_mm": 1e-3, "contact_angle_deg": 1e-3, "overlap_mm": 1e-3, "given": []}
# A summary of nothing.
EMPTY: dict[str, Any] = {
    "case": "w",
    "blocks": 1,
    "interfaces": 1,
    "contact_points": 4,
    "weight_kN": 1.0,
    "near_misses": {"count": 0},
    "joints": _TOLERANCES | {"closed": {"count": 0, "largest_gap_mm": 0.0}, "interpenetrating": {"count": 0, "deepest_mm": 0.0}},
    "analyses": [],
    "guidance": [],
    "questions": [],
}
MATCHED: dict[str, Any] = {
    "figures": [{"name": "weight", "stones": 1.0, "shell": 1.0, "unit": "N", "difference": 0.0, "tolerance": 0.005}]
}


def summary(**words: Any) -> Summary:
    """Return an empty summary but for what is given."""
    return as_read(Summary, EMPTY | words)


def analysis(**words: Any) -> Analysis:
    """Return an analysis of rigid blocks under +x but for what is given."""
    return as_read(Analysis, WORDS | words)
