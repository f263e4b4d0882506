"""The record of each iteration of the interior-point loop, and how the loop ends."""

import math
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


def as_share(report: Callable[[float], None] | None, duality_gap: float, residual: float) -> Progress | None:
    """Return what tells the share of the way to these tolerances after each iteration.

    Errors fall by factors, so the way is measured on their logarithms. The share never falls, and 1 is solved.
    """
    if report is None:
        return None
    longest = share = 0.0

    def progress(info: Info) -> None:
        nonlocal longest, share
        left = math.log(max(info.error / duality_gap, info.residual / residual, 1.0))
        longest = max(longest, left)
        share = max(share, 1.0 - left / longest if left else 1.0)
        report(share)

    return progress
