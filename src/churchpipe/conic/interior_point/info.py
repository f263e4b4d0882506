"""The record of each iteration of the interior-point loop, and how the loop ends."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, TypeAlias

Status = Literal["running", "solved", "infeasible", "unbounded", "failed"]


@dataclass(frozen=True, slots=True)
class Info:
    """One iteration: errors are relative to the objective.

    error: the largest of the gap of the objectives, the complementarity, and the work of the residuals on their multipliers;
    residual: the largest of the coupling rows, each in its own unit; step and correctors: what led here.
    """

    iteration: int
    primal: float
    dual: float
    error: float
    residual: float
    product: float
    step: float
    correctors: int


Progress: TypeAlias = Callable[[Info], None]
