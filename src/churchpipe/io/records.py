"""An analysis in the words of summary.json."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import Material
from churchpipe.model.results import LimitState


def record_of(state: LimitState, load: LoadCase, materials: Sequence[Material]) -> dict[str, Any]:
    """Return the record of a rigid-block analysis. Friction and cohesion: one number, or one a material where they differ."""
    words: dict[str, Any] = {
        "model": "rigid-block",
        "flow": state.flow,
        "load": load.name,
        "direction": load.direction.tolist(),
        "friction": _common({material.name: material.friction for material in materials}),
        "cohesion_kPa": _common({material.name: material.cohesion / 1e3 for material in materials}),
        "load_factor": state.load_factor,
        "lower_bound": state.lower_bound,
        "upper_bound": state.upper_bound,
        "status": state.status,
        "iterations": state.iterations,
        "seconds": round(state.seconds, 3),
        "solver": state.solver,
        "equilibrium_residual": state.equilibrium_residual,
        "cone_violation": state.cone_violation,
        "message": state.message,
    }
    if state.flow == "non-associative":
        words["gap"] = state.gap
        words["interval"] = list(state.interval)
        words["friction_violation"] = state.friction_violation
        words["fixed_points"] = list(state.fixed_points)
        words["history"] = [step.load_factor for step in state.history]
    return words


def _common(values: dict[str, float]) -> float | dict[str, float]:
    distinct = np.unique(list(values.values()))
    return float(distinct[0]) if len(distinct) == 1 else values
