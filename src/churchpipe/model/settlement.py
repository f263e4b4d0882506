"""What a structure does when a support moves."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from churchpipe.model.arguments import one_of
from churchpipe.model.arrays import FloatArray, floats, rows_of, store, store_arrays
from churchpipe.model.card import Shown
from churchpipe.model.pictures import diagram
from churchpipe.model.stone_path import StonePath

SettlementEnding = Literal["collapsed", "free", "parted", "unfinished", "unbounded", "not-converged", "unstable", "failed"]
SETTLEMENT_ENDINGS = ("collapsed", "free", "parted", "unfinished", "unbounded", "not-converged", "unstable", "failed")
SettlementStatus = Literal["optimal", "not-converged", "unstable", "unbounded", "failed"]


@dataclass(frozen=True, slots=True, repr=False)
class SettlementState(Shown):
    """The state of a structure at the onset of a movement of a support.

    reaction: N, the least force against the movement with which the support must resist (Nm for a support that turns); 0 when the
    structure stands without it; negative when the support must be pushed along, as one that moves in on an arch; NaN where
    nothing was found.
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
        store_arrays(self, velocities=(None, 6), opening=(points,), slip=(points,), forces=(points, 3))

    def _rows(self) -> tuple[str, Mapping[str, object]]:
        rows = {"reaction, N or Nm": self.reaction, "status": self.status}
        return "Support that begins to move", rows | ({"message": self.message} if self.message else {})


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class SettlementPath(Shown, StonePath):
    """What a structure does while a support moves on.

    movement (ns,): m, or rad about an axis, of the support at each step; reaction (ns,): N, or Nm, the least with which it must
    resist there, in the geometry as displaced and without dilatancy: one value of several, since more than one set of forces may
    fit a motion. least: N, or Nm, the least reaction as drawn of all equilibria, from an associative analysis, its bounds proved.

    status: "collapsed" stones fell that cannot be spared, at the last movement; "free" nothing rests on the support any more;
    "parted" what does bears nothing else, and has gone on with it by its own size; "unfinished" the steps or the movement asked
    for were used up; "unbounded" the stones hold the support fast; "not-converged" a step's program was not solved; "unstable"
    the dead load alone brings it down; "failed".
    """

    movement: FloatArray
    reaction: FloatArray
    least: float
    status: SettlementEnding

    def __post_init__(self) -> None:
        StonePath.__post_init__(self)
        one_of("SettlementPath.status", self.status, *SETTLEMENT_ENDINGS)
        for name in ("movement", "reaction"):
            store(self, **{name: floats(f"SettlementPath.{name}", getattr(self, name), (len(self.position),))})

    def until(self, step: int) -> "SettlementPath":
        """Return the path up to a step, that included: what `settlement_path(resume=...)` may go on from."""
        return self.first_steps(step)

    @property
    def ultimate(self) -> float:
        """The movement at which the structure collapses, NaN where it did not."""
        return float(self.movement[-1]) if self.status == "collapsed" and len(self.movement) else float(np.nan)

    def plot(self) -> Any:
        """Return the diagram of the path, reaction against movement (`churchpipe.plot`)."""
        return diagram(self)

    def _rows(self) -> tuple[str, Mapping[str, object]]:
        first = float(self.reaction[0]) if len(self.reaction) else float("nan")
        rows = {"first reaction, N or Nm": first, "least of all equilibria, N or Nm": self.least}
        ends = {"movement at collapse, m or rad": self.ultimate, "status": self.status, "steps": len(self.movement)}
        return "Support that moves", rows | ends
