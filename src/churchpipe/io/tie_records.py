"""What helps, in the records of analyses: what each tie carries, and what candidates, cohesion and weight would add."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from churchpipe.model.gains import Sensitivities
from churchpipe.model.quantities import Quantity
from churchpipe.model.results import CapacityCurve, LimitState, ShellLimitState
from churchpipe.model.ties import RankedTie, Tie

# A tie yields at its strength, but for what a solver leaves.
_YIELDING = 1e-4


@dataclass(frozen=True, slots=True)
class TieForce:
    """A tie in an analysis: its tension, its strength and their ratio, whether it yields, what governs its strength, and what
    each unit of force more would add."""

    name: str
    tension: Annotated[float, Quantity("_kN")]
    strength: Annotated[float, Quantity("_kN")]
    share: float
    yielded: bool
    governs: str
    sensitivity: Annotated[float, Quantity("_1_kN")]


@dataclass(frozen=True, slots=True)
class TieCandidate:
    """A tie that is not there: its strength, what each unit of it would add, the most that it could make of the load factor, NaN
    where that has no bound, and the load factor with it, NaN where it was not analysed."""

    name: str
    strength: Annotated[float, Quantity("_kN")]
    rate: Annotated[float, Quantity("_1_kN")]
    most: float
    load_factor: float


@dataclass(frozen=True, slots=True)
class Gain:
    """What cohesion in all joints of a wall, and weight, would add to a load factor; and the load factors with 10 kPa or 10 kN
    more, NaN where they were not analysed."""

    panel: str
    cohesion: Annotated[float, Quantity("_1_kPa")]
    weight: Annotated[float, Quantity("_1_kN")]
    with_cohesion: Annotated[float, Quantity(key="with_10_kPa")] = np.nan
    with_weight: Annotated[float, Quantity(key="with_10_kN")] = np.nan


def gains_of(rates: Sensitivities) -> tuple[Gain, ...]:
    """Return what would help, by wall; nothing where there is one alone."""
    columns = (rates.panel, rates.cohesion, rates.weight, rates.with_cohesion, rates.with_weight)
    return tuple(Gain(*one) for one in zip(*(each.tolist() for each in columns), strict=True)) if len(rates.panel) > 1 else ()


def tie_forces_of(ties: Sequence[Tie], state: LimitState | ShellLimitState | CapacityCurve) -> tuple[TieForce, ...]:
    """Return what each tie of an analysis carries; of a capacity curve, at its end."""
    if isinstance(state, CapacityCurve):
        last = state.tie_forces[-1] if len(state.steps) else np.zeros(0)
        return tuple(_tie_force(tie, float(tension), np.nan) for tie, tension in zip(ties, last, strict=False))
    return tuple(
        _tie_force(tie, float(tension), float(gain))
        for tie, tension, gain in zip(ties, state.tie_forces, state.tie_sensitivity, strict=bool(len(state.tie_forces)))
    )


def _tie_force(tie: Tie, tension: float, gain: float) -> TieForce:
    share = tension / tie.strength if tie.strength > 0 else np.nan
    return TieForce(tie.name, tension, tie.strength, share, bool(share >= 1 - _YIELDING), tie.governs, gain)


def candidates_of(ranked: Sequence[RankedTie]) -> tuple[TieCandidate, ...]:
    """Return what each candidate would add."""
    return tuple(TieCandidate(one.tie.name, one.tie.strength, one.rate, one.most, one.load_factor) for one in ranked)
