"""What a structure does when a support moves."""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from churchpipe.model.arguments import one_of
from churchpipe.model.arrays import FloatArray, floats, rows_of, store
from churchpipe.model.block_curve import FallenStones, path_proved

SettlementEnding = Literal["collapsed", "free", "unfinished", "unbounded", "not-converged", "unstable", "failed"]
SETTLEMENT_ENDINGS = ("collapsed", "free", "unfinished", "unbounded", "not-converged", "unstable", "failed")
SettlementStatus = Literal["optimal", "not-converged", "unstable", "unbounded", "failed"]


@dataclass(frozen=True, slots=True)
class SettlementState:
    """The state of a structure at the onset of a movement of a support.

    reaction: N, the least force along the movement with which the support must resist (Nm for a support that turns); 0 when the
    structure stands without it, NaN where nothing was found.
    velocities (nb, 6): of the centroids and rotations per unit of the movement, m or rad; opening, slip (nc,): of the contact
    points per unit of the movement: where it cracks. forces (nc, 3) N, components n, t1, t2.
    residual of the balance and violation of the friction cones, over the weight; bound_gap: kinematic against static bound, over
    the reaction; gap: what the motion lacks of one without dilatancy, over the weight.

    status: "optimal"; "not-converged": found but not proved; "unstable": the dead load alone brings it down; "unbounded": the
    structure holds the support fast; "failed".
    """

    reaction: float
    status: SettlementStatus
    velocities: FloatArray
    opening: FloatArray
    slip: FloatArray
    forces: FloatArray
    residual: float
    violation: float
    bound_gap: float
    gap: float
    message: str = ""
    seconds: float = 0.0

    def __post_init__(self) -> None:
        one_of("SettlementState.status", self.status, "optimal", "not-converged", "unstable", "unbounded", "failed")
        points = rows_of("SettlementState.forces", self.forces)
        store(
            self,
            velocities=floats("SettlementState.velocities", self.velocities, (None, 6)),
            opening=floats("SettlementState.opening", self.opening, (points,)),
            slip=floats("SettlementState.slip", self.slip, (points,)),
            forces=floats("SettlementState.forces", self.forces, (points, 3)),
        )


@dataclass(frozen=True, slots=True)
class SettlementPath:
    """What a structure does while a support moves on.

    movement (ns,): m, or rad about an axis, of the support at each step; reaction (ns,): N, or Nm, the least with which it must
    resist there, in the geometry as displaced and without dilatancy; largest (ns,) m, the largest displacement of a centroid.
    position (ns, nb, 3) m and rotation (ns, nb, 3) rad as in `BlockCapacityCurve`, and so are residual, violation, bound_gap, gap
    and dissipation. least: N, or Nm, the least reaction as drawn of an associative analysis, its bounds proved.
    fallen: stones taken out on the way, with the movement at that moment.

    status: "collapsed" stones fell that cannot be spared, at the last movement; "free" nothing rests on the support any more;
    "unfinished" the steps or the movement asked for were used up; "unbounded" the stones hold the support fast; "not-converged" a
    step's program was not solved; "unstable" the dead load alone brings it down; "failed".
    """

    movement: FloatArray
    reaction: FloatArray
    largest: FloatArray
    position: FloatArray
    rotation: FloatArray
    residual: FloatArray
    violation: FloatArray
    bound_gap: FloatArray
    gap: FloatArray
    dissipation: FloatArray
    least: float
    status: SettlementEnding
    fallen: tuple[FallenStones, ...] = field(default=())
    message: str = ""
    seconds: float = 0.0

    def __post_init__(self) -> None:
        steps = rows_of("SettlementPath.movement", self.movement)
        one_of("SettlementPath.status", self.status, *SETTLEMENT_ENDINGS)
        for name in ("movement", "reaction", "largest", "residual", "violation", "bound_gap", "gap", "dissipation"):
            store(self, **{name: floats(f"SettlementPath.{name}", getattr(self, name), (steps,))})
        for name in ("position", "rotation"):
            store(self, **{name: floats(f"SettlementPath.{name}", getattr(self, name), (steps, None, 3))})

    @property
    def proved(self) -> bool:
        """True when every step is: see `path_proved`."""
        return path_proved(self.residual, self.violation, self.bound_gap)

    @property
    def ultimate(self) -> float:
        """The movement at which the structure collapses, NaN where it did not."""
        return float(self.movement[-1]) if self.status == "collapsed" and len(self.movement) else float(np.nan)
