"""What a limit analysis of a shell proves: a stress field below, a velocity field above."""

from dataclasses import dataclass

import numpy as np

from churchpipe.conic.program import Outcome
from churchpipe.homogenised_shell.condensed import CondensedShell, StressState
from churchpipe.model.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Bounds:
    """Bounds of a load factor and the arrays that prove them.

    stress (nq, 6) N/m and N; motion (m,): the unknowns that are free, f . u = 1 per total weight. residual of equilibrium over
    the weight, violation over the unit of stress.
    """

    lower: float
    upper: float
    stress: FloatArray
    motion: FloatArray
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

    Upper bound: virtual work of the velocities, what the strength dissipates in their strain, and the largest work that the
    stresses found could do on strain which no flow explains: that is rounding.
    """
    motion = state.motion[~condensed.elements.clamped]
    earned = float(live @ motion)
    # Loads that earn nothing bound nothing: where the load reaches its cap no motion is needed.
    scale = 1.0 / earned if earned > 0 else 1.0
    law = condensed.strength
    doubt = float((np.abs(state.unexplained) * np.abs(state.x)).sum())
    # The cell bounds stress in parts that do not yield, too (`points.local_strength`): they must not strain.
    kept = ~condensed.elements.shell.yields[condensed.elements.facet]
    doubt += float(np.abs(law.offset * state.strain)[:, kept].sum())
    cost = float((law.right * state.multipliers).sum()) + float((law.offset * state.strain).sum())
    return Bounds(
        lower=state.load,
        upper=scale * (cost + doubt - float(dead @ motion)) if earned > 0 else np.inf,
        stress=state.stress.T * condensed.loads.unit,
        motion=scale * motion,
        residual=state.residual,
        violation=state.violation,
        iterations=state.iterations,
        outcome=state.status,
        message=state.message,
    )
