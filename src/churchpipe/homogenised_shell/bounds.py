"""What a limit analysis of a shell proves: a stress field below, a velocity field above."""

from dataclasses import dataclass

import numpy as np

from churchpipe.conic.interior_point.nonnegative import Nonnegative
from churchpipe.conic.program import Outcome
from churchpipe.homogenised_shell.condensed import CondensedShell, StressState
from churchpipe.homogenised_shell.points import LocalStrength
from churchpipe.model.arrays import FloatArray

_SWEEPS = 100


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
    scale = 1.0 / earned if earned > 0 else 1.0
    law = condensed.strength
    multipliers, unexplained = plastic_flow(law, state.rate, state.multipliers)
    doubt = float((np.abs(unexplained) * np.abs(state.x)).sum())
    cost = float((law.right * multipliers).sum()) + float((law.offset * state.strain).sum())
    return Bounds(
        lower=state.load,
        upper=scale * (cost + doubt - float(dead @ motion)),
        stress=state.stress.T * condensed.loads.unit,
        motion=scale * motion,
        residual=state.residual,
        violation=state.violation,
        iterations=state.iterations,
        outcome=state.status,
        message=state.message,
    )


def plastic_flow(law: LocalStrength, rate: FloatArray, start: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return multipliers in the cones (rows, nq) with G^T z as near to a strain rate (d, nq) as can be, and what is left of it.

    Planes: Hildreth's sweeps from `start`. Cones of the exact cell: one row a variable, so the nearest point of each cone.
    """
    if isinstance(law.cones[0], Nonnegative):
        z = np.maximum(start, 0.0)
        left = rate - np.einsum("riq,rq->iq", law.matrix, z)
        square = (law.matrix**2).sum(axis=1)
        square[square == 0] = 1.0
        for _ in range(_SWEEPS):
            for row, normal in enumerate(law.matrix):
                moved = np.maximum(z[row] + (normal * left).sum(axis=0) / square[row], 0.0)
                left -= normal * (moved - z[row])
                z[row] = moved
        return z, left
    size = np.einsum("iiq->iq", law.matrix)
    asked = np.where(size == 0, 0.0, rate / np.where(size == 0, 1.0, size)).reshape(3, 12, -1)
    length = np.sqrt((asked[1:] ** 2).sum(axis=0))
    top = np.clip(0.5 * (asked[0] + length), np.maximum(asked[0], 0.0), None)
    top = np.where(asked[0] >= length, asked[0], np.where(asked[0] <= -length, 0.0, top))
    inside = np.concatenate([top[None], asked[1:] * np.where(length > top, top / np.maximum(length, 1e-300), 1.0)])
    z = inside.reshape(rate.shape)
    return z, rate - size * z
