"""Ties in a step of the capacity curve of a shell: elastic between no tension and their strength.

The energy of a tie is quadratic in its tension T, so the ties are part of the step's own program, and tensions and motion are
found together. Each tie adds

    1/2 c T^2 - l T,    0 <= T <= T_max

to what is minimised, with its compliance c and the elastic elongation l that it would have if the shell did not move. Equilibrium
becomes H t = f_D + P T + load f_L, P the forces of unit tensions. With multipliers of both bounds,

    c T - l + P^T u = a - b,    a T = 0,    b (T_max - T) = 0.

An interior-point iteration takes both products to one target with those of the joints (`elastic_step`).
"""

from dataclasses import dataclass
from typing import Self

import numpy as np

from churchpipe.model.arrays import FloatArray

# The tensions begin this share of their strength inside their bounds at the least.
_INSIDE = 0.005


@dataclass(frozen=True, slots=True)
class StepTies:
    """Ties (nt,) of a step, in the units of `condensed.CondensedShell`.

    pull (nt, m): forces of unit tensions on the free unknowns. compliance: elongation over tension. length: elastic elongation
    before the step. most: strength, > 0. before: tension before the step.
    """

    pull: FloatArray
    compliance: FloatArray
    length: FloatArray
    most: FloatArray
    before: FloatArray

    @classmethod
    def none(cls, unknowns: int) -> Self:
        """Return no ties on a shell of so many free unknowns."""
        nothing = np.zeros(0)
        return cls(np.zeros((0, unknowns)), nothing, nothing, nothing, nothing)


@dataclass(frozen=True, slots=True)
class TieWay:
    """A direction (nt,): of the tensions, and of the multipliers of their bounds."""

    tension: FloatArray
    low: FloatArray
    high: FloatArray


class TieIterate:
    """Tensions (nt,) inside their bounds, and the multipliers of these."""

    def __init__(self, ties: StepTies, product: float) -> None:
        """Begin near the tensions before the step, with one product at all bounds."""
        self._ties = ties
        inside = _INSIDE * ties.most
        self.tension: FloatArray = np.clip(ties.before, inside, ties.most - inside)
        # What is left to the strength is kept by itself: as a difference it would be lost to rounding near the strength.
        self._left: FloatArray = ties.most - self.tension
        self._low, self._high = product / self.tension, product / self._left

    def __len__(self) -> int:
        return len(self.tension)

    @property
    def products(self) -> float:
        """Sum of the products at all bounds."""
        return float(self._low @ self.tension + self._high @ self._left)

    @property
    def softness(self) -> FloatArray:
        """Compliances (nt,) with those of the bounds."""
        return self._ties.compliance + self._low / self.tension + self._high / self._left

    def misfit(self, motion: FloatArray) -> FloatArray:
        """Return by how much elongations (nt,) and tensions do not fit."""
        ties = self._ties
        return ties.compliance * self.tension - ties.length + ties.pull @ motion - self._low + self._high

    def aimed(self, misfit: FloatArray, aim: FloatArray) -> FloatArray:
        """Return the misfits that are left where the products (2, nt) of lower and upper bounds go to their aim."""
        low, high = self._ways(aim)
        return misfit - low + high

    def answer(self, tension: FloatArray, aim: FloatArray) -> tuple[TieWay, float]:
        """Return the direction whose products aim there with changes of tension (nt,), and the rate at which a bound is met."""
        low, high = self._ways(aim)
        way = TieWay(tension, low - self._low / self.tension * tension, high + self._high / self._left * tension)
        rates = (-way.tension / self.tension, way.tension / self._left, -way.low / self._low, -way.high / self._high)
        return way, float(np.max(rates, initial=0.0))

    def second_order(self, way: TieWay, target: float) -> FloatArray:
        """Return the aim (2, nt) of all products, less what the direction does in second order."""
        return target - np.array([way.low, -way.high]) * way.tension

    def move(self, way: TieWay, length: float) -> None:
        """Go so far along a direction."""
        self.tension, self._left = self.tension + length * way.tension, self._left - length * way.tension
        self._low, self._high = self._low + length * way.low, self._high + length * way.high

    def _ways(self, aim: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the changes of the multipliers that take the products to their aim (2, nt) at these tensions."""
        low, high = aim
        return low / self.tension - self._low, high / self._left - self._high
