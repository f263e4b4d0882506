"""Records of analyses for tests, by the keys of summary.json."""

from typing import Any

from churchpipe.io.records import Analysis
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


def analysis(**words: Any) -> Analysis:
    """Return an analysis of rigid blocks under +x but for what is given."""
    return as_read(Analysis, WORDS | words)
