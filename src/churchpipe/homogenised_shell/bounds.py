"""The bounds that a limit analysis of a shell proves: a lower one by its stresses, an upper one by its velocities."""

from dataclasses import dataclass

import numpy as np

from churchpipe.conic.program import Outcome
from churchpipe.homogenised_shell.condensed import CondensedShell, StressState
from churchpipe.model.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Bounds:
    """Bounds of a load factor and the arrays that prove them.

    stress (nq, 6) N/m and N, at nq points. motion (m,): velocities of the free unknowns, scaled so that the load does unit work
    per total weight. lintels: the part of the upper bound that is dissipated where the shell does not yield; the strength there
    is large but finite (`point_strength`). residual: of equilibrium, over the weight. violation: of the strength, over the unit
    of stress.
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

    The lower bound is the load of the stresses, less the work that what is left of equilibrium does on the motion: a residual
    of 1e-7 of the weight may hide several millionths of the load factor. The upper bound is the dissipation of the strength in
    the strain of the velocities (lintels included), less the work of the dead load, plus the largest work that the stresses
    could do on strain which no flow rule explains. That last part is due to rounding.
    """
    motion = state.motion[~condensed.elements.clamped]
    earned = float(live @ motion)
    # A motion on which the live load does no work bounds nothing. The load then reaches its cap without any motion.
    scale = 1.0 / earned if earned > 0 else 1.0
    law = condensed.strength
    doubt = float((np.abs(state.unexplained) * np.abs(state.x)).sum())
    cost = law.price(state.multipliers) + (law.offset * state.strain).sum(axis=0)
    lintel = ~condensed.elements.shell.yields[condensed.elements.facet]
    return Bounds(
        lower=state.load - state.lack,
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
