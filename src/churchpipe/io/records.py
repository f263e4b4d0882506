"""An analysis in the words of summary.json."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import Material
from churchpipe.model.names import RIGID_BLOCKS, SHELL
from churchpipe.model.results import CapacityCurve, LimitState, ShellLimitState


def record_of(state: LimitState, load: LoadCase, materials: Sequence[Material]) -> dict[str, Any]:
    """Return the record of a rigid-block analysis. Friction and cohesion: one number, or one a material where they differ."""
    words: dict[str, Any] = {
        "model": RIGID_BLOCKS,
        "flow": state.flow,
        **_loading(load, materials),
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


def shell_record_of(
    result: ShellLimitState | CapacityCurve | None,
    load: LoadCase,
    materials: Sequence[Material],
    *,
    method: str,
    planes: str,
    message: str = "",
) -> dict[str, Any]:
    """Return the record of an analysis of the shell; result: None where it was refused, the message says why.

    The load factor of a capacity curve is the largest one reached.
    """
    words = {"model": SHELL, "method": method, "planes": planes, **_loading(load, materials)}
    match result:
        case ShellLimitState():
            return words | {
                "load_factor": result.load_factor,
                "lower_bound": result.lower_bound,
                "upper_bound": result.upper_bound,
                "status": result.status,
                "iterations": result.iterations,
                "seconds": round(result.seconds, 3),
                "solver": result.solver,
                "equilibrium_residual": result.equilibrium_residual,
                "yield_violation": result.yield_violation,
                "message": result.message,
            }
        case CapacityCurve():
            return words | {
                "load_factor": result.plateau if result.status in ("converged", "not-converged") else math.nan,
                "status": result.status,
                "iterations": sum(step.iterations for step in result.steps),
                "seconds": round(result.seconds, 3),
                "equilibrium_residual": max((step.residual for step in result.steps), default=math.nan),
                "yield_violation": max((step.violation for step in result.steps), default=math.nan),
                "steps": len(result.steps),
                "control_point": int(result.control_point),
                "control_mm": [1e3 * float(place) for place in result.control],
                "load_factors": [float(factor) for factor in result.load_factor],
                "message": result.message,
            }
    return words | {"load_factor": None, "status": "failed", "seconds": 0.0, "message": message}


def _loading(load: LoadCase, materials: Sequence[Material]) -> dict[str, Any]:
    return {
        "load": load.name,
        "direction": load.direction.tolist(),
        "friction": _common({material.name: material.friction for material in materials}),
        "cohesion_kPa": _common({material.name: material.cohesion / 1e3 for material in materials}),
    }


def _common(values: dict[str, float]) -> float | dict[str, float]:
    distinct = np.unique(list(values.values()))
    return float(distinct[0]) if len(distinct) == 1 else values
