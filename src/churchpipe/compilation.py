"""Whether the solvers' loops have been compiled, which happens once after installation."""

import os
from pathlib import Path

# Its loops, of all solvers the first to be called, are compiled by numba at their first call and kept.
SOLVER = Path("conic", "interior_point")


def compiled() -> bool:
    """Return whether compiled loops of the solvers are kept from an earlier run."""
    if folder := os.environ.get("NUMBA_CACHE_DIR"):
        return any(Path(folder).rglob("*.nbi"))
    return any((Path(__file__).parent / SOLVER / "__pycache__").glob("*.nbi"))
