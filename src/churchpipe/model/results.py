"""What the analyses return."""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from churchpipe.model.arrays import FloatArray, floats, store

Status = Literal["optimal", "converged", "not-converged", "unstable", "unbounded", "failed"]


@dataclass(frozen=True, slots=True)
class Iteration:
    """One step of the non-associative iteration: load factor, relative friction violation, and gap g / alpha if computed."""

    load_factor: float
    violation: float
    gap: float = np.nan


@dataclass(frozen=True, slots=True)
class LimitState:
    """The result of a rigid-block limit analysis.

    load_factor: NaN when unstable or failed, inf when unbounded. lower_bound, upper_bound: static and kinematic bounds
    (NaN for a non-associative result, which has none). forces (nc, 3) N, components n, t1, t2; velocities (nb, 6),
    translation of the centroid and rotation, scaled to f_L . u = 1 per total weight (for an unstable structure: the
    falling mechanism, f_D . u = 1 per total weight). equilibrium_residual and cone_violation are relative to the total weight.
    gap: de Saxce gap g of a non-associative state (NaN when associative); interval: load factors compatible with its
    mechanism; friction_violation: sum of |t| beyond the cone over sum of mu n. fixed_points: every distinct load factor
    that the starts of the iteration led to.

    Load factor and velocities of moving parts are meaningful; single point forces are not unique.
    """

    load_factor: float
    status: Status
    lower_bound: float
    upper_bound: float
    forces: FloatArray
    velocities: FloatArray
    equilibrium_residual: float = np.nan
    cone_violation: float = np.nan
    iterations: int = 0
    seconds: float = 0.0
    solver: str = ""
    flow: Literal["associative", "non-associative"] = "associative"
    history: tuple[Iteration, ...] = field(default=())
    gap: float = np.nan
    interval: tuple[float, float] = (np.nan, np.nan)
    friction_violation: float = np.nan
    fixed_points: tuple[float, ...] = field(default=())
    message: str = ""

    def __post_init__(self) -> None:
        store(
            self,
            forces=floats("LimitState.forces", self.forces, (None, 3), finite=False),
            velocities=floats("LimitState.velocities", self.velocities, (None, 6), finite=False),
        )
