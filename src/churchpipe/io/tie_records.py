"""What helps, in the records of analyses: what each tie carries, and what candidates, cohesion and weight would add."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from churchpipe.model.gains import Sensitivities
from churchpipe.model.results import CapacityCurve, LimitState, ShellLimitState
from churchpipe.model.ties import RankedTie, Tie

# A tie yields at its strength, but for what a solver leaves.
_YIELDING = 1e-4


@dataclass(frozen=True, slots=True)
class TieForce:
    """A tie in an analysis: its tension and its strength, N, what governs that, and what each newton more would add, 1/N."""

    name: str
    tension: float
    strength: float
    governs: str
    sensitivity: float

    def as_words(self) -> dict[str, Any]:
        """Return the tie in the words of summary.json; a tie at its strength yields."""
        share = self.tension / self.strength if self.strength > 0 else np.nan
        return {
            "name": self.name,
            "tension_kN": self.tension / 1e3,
            "strength_kN": self.strength / 1e3,
            "share": share,
            "yielded": bool(share >= 1 - _YIELDING),
            "governs": self.governs,
            "sensitivity_1_kN": 1e3 * self.sensitivity,
        }


@dataclass(frozen=True, slots=True)
class TieCandidate:
    """A tie that is not there: its strength, N, what each newton would add, 1/N, the most that it could make of the load factor,
    and the load factor with it, NaN where it was not analysed."""

    name: str
    strength: float
    rate: float
    most: float
    load_factor: float

    def as_words(self) -> dict[str, Any]:
        """Return the candidate in the words of summary.json."""
        return {
            "name": self.name,
            "strength_kN": self.strength / 1e3,
            "rate_1_kN": 1e3 * self.rate,
            "most": self.most,
            "load_factor": self.load_factor,
        }


@dataclass(frozen=True, slots=True)
class Gain:
    """What changes of a wall would add to a load factor: cohesion of all its joints, 1/Pa, and weight, 1/N; and the load factors
    with 10 kPa or 10 kN more, NaN where they were not analysed."""

    panel: str
    cohesion: float
    weight: float
    with_cohesion: float = np.nan
    with_weight: float = np.nan

    def as_words(self) -> dict[str, Any]:
        """Return the wall in the words of summary.json."""
        rates = {"cohesion_1_kPa": 1e3 * self.cohesion, "weight_1_kN": 1e3 * self.weight}
        return {"panel": self.panel, **rates, "with_10_kPa": self.with_cohesion, "with_10_kN": self.with_weight}


def gains_of(rates: Sensitivities) -> tuple[Gain, ...]:
    """Return what would help, by wall; nothing where there is one alone."""
    columns = (rates.panel, rates.cohesion, rates.weight, rates.with_cohesion, rates.with_weight)
    return tuple(Gain(*one) for one in zip(*(each.tolist() for each in columns), strict=True)) if len(rates.panel) > 1 else ()


def tie_forces_of(ties: Sequence[Tie], state: LimitState | ShellLimitState | CapacityCurve) -> tuple[TieForce, ...]:
    """Return what each tie of an analysis carries; of a capacity curve, at its end."""
    if isinstance(state, CapacityCurve):
        last = state.tie_forces[-1] if len(state.steps) else np.zeros(0)
        return tuple(TieForce(tie.name, float(t), tie.strength, tie.governs, np.nan) for tie, t in zip(ties, last, strict=False))
    return tuple(
        TieForce(tie.name, float(tension), tie.strength, tie.governs, float(gain))
        for tie, tension, gain in zip(ties, state.tie_forces, state.tie_sensitivity, strict=bool(len(state.tie_forces)))
    )


def candidates_of(ranked: Sequence[RankedTie]) -> tuple[TieCandidate, ...]:
    """Return what each candidate would add."""
    return tuple(TieCandidate(one.tie.name, one.tie.strength, one.rate, one.most, one.load_factor) for one in ranked)


def tie_words(ties: Sequence[TieForce]) -> dict[str, Any]:
    """Return the key of summary.json, where there are ties."""
    return {"tie_forces": [tie.as_words() for tie in ties]} if ties else {}
