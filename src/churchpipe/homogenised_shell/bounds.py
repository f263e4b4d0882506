"""What a limit analysis of a shell proves: a stress field below, a velocity field above."""

from dataclasses import dataclass

import numpy as np

from churchpipe.conic.program import Outcome
from churchpipe.homogenised_shell.condensed import CondensedShell, StressState
from churchpipe.model.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Bounds:
    """Bounds of a load factor and the arrays that prove them.

    stress (nq, 6) N/m and N; motion (m,): the unknowns that are free, f . u = 1 per total weight. lintels: the part of the upper
    bound that parts which do not yield dissipate, since their strength is large but finite (`point_strength`). residual of
    equilibrium over the weight, violation over the unit of stress.
    """

    lower: float
    upper: float
    stress: FloatArray
    motion: FloatArray
    lintels: float
    residual: float
    violation: float
    iterations: int
    outcome: Outcome
    message: str

    def agree(self, tolerance: float, size: float) -> bool:
        """True when the bounds meet to a share of the load factor, or of `size` if that is larger, and equilibrium holds."""
        close = abs(self.upper - self.lower) <= tolerance * max(abs(self.lower), size)
        return close and self.admissible

    @property
    def admissible(self) -> bool:
        """True when the stresses are in equilibrium and within the strength."""
        return max(self.residual, self.violation) <= 1e-6


def proved_bounds(condensed: CondensedShell, state: StressState, dead: FloatArray, live: FloatArray) -> Bounds:
    """Return the bounds that a solution proves.

    Upper bound: virtual work of the velocities, what the strength dissipates in their strain (of lintels, too), and the largest
    work that the stresses found could do on strain which no flow explains: that is rounding.
    """
    motion = state.motion[~condensed.elements.clamped]
    earned = float(live @ motion)
    # Loads that earn nothing bound nothing: where the load reaches its cap no motion is needed.
    scale = 1.0 / earned if earned > 0 else 1.0
    law = condensed.strength
    doubt = float((np.abs(state.unexplained) * np.abs(state.x)).sum())
    cost = (law.right * state.multipliers).sum(axis=0) + (law.offset * state.strain).sum(axis=0)
    lintel = ~condensed.elements.shell.yields[condensed.elements.facet]
    return Bounds(
        lower=state.load,
        upper=scale * (float(cost.sum()) + doubt - float(dead @ motion)) if earned > 0 else np.inf,
        stress=state.stress.T * condensed.loads.unit,
        motion=scale * motion,
        lintels=scale * float(cost[lintel].sum()),
        residual=state.residual,
        violation=state.violation,
        iterations=state.iterations,
        outcome=state.status,
        message=state.message,
    )
