"""The capacity curve of rigid blocks at large displacements."""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arguments import one_of
from churchpipe.model.arrays import FloatArray, IntArray, floats, indices, rows_of, store
from churchpipe.model.card import card

CurveStatus = Literal["vanished", "collapsed", "unfinished", "not-converged", "unstable", "unbounded", "failed"]
CURVE_STATUSES = ("vanished", "collapsed", "unfinished", "not-converged", "unstable", "unbounded", "failed")


@dataclass(frozen=True, slots=True)
class FallenStones:
    """Stones that nothing held any more and that were taken out: which, and the displacement (m) of the curve at that moment."""

    displacement: float
    stones: IntArray

    def __post_init__(self) -> None:
        store(self, stones=indices("FallenStones.stones", self.stones, (None,)))


def path_proved(residual: FloatArray, violation: FloatArray, bound_gap: FloatArray) -> bool:
    """True when all steps (ns,) balance to 1e-8 of the weight, keep to their friction cones and bound their program to 1e-4."""
    worst = (errors.max(initial=0.0) for errors in (residual, violation, 1e-4 * bound_gap))
    return all(float(error) < 1e-8 for error in worst)


@dataclass(frozen=True, slots=True)
class BlockCapacityCurve:
    """Load factor of an assemblage against its displacement, in the geometry as displaced.

    displacement (ns,) m, of the control along the load: mean of the pushed stones weighed by their load, or the chosen point;
    load_factor (ns,); largest (ns,) m, the largest displacement of a centroid.
    position (ns, nb, 3) m, the centroids; rotation (ns, nb, 3) rad, rotation vectors from the drawing: at each step.
    What proves a step, relative to the weight or the load factor: residual of the balance, violation of the Coulomb cones,
    bound_gap of its program; gap (ns,): what its motion lacks of one without dilatancy, in load factors (of a step in which the
    load does little work, over the work of the weight at the same speed).
    dissipation (ns,) J: work of friction on the way there.
    fallen: stones taken out on the way. d0 m: displacement at which the load factor vanishes, or the structure
    collapses; NaN where the curve ends before.

    status: "vanished" the load factor came down to zero; "collapsed" stones fell out that cannot be spared; "unfinished" the
    steps or the displacement asked for were used up; "not-converged" a step's program was not solved; "unbounded" no load of
    this kind moves it on; "unstable" the dead load alone brings it down; "failed" the first load factor was not found.
    """

    displacement: FloatArray
    load_factor: FloatArray
    largest: FloatArray
    position: FloatArray
    rotation: FloatArray
    residual: FloatArray
    violation: FloatArray
    bound_gap: FloatArray
    gap: FloatArray
    dissipation: FloatArray
    status: CurveStatus
    d0: float = np.nan
    fallen: tuple[FallenStones, ...] = field(default=())
    message: str = ""
    seconds: float = 0.0

    def __post_init__(self) -> None:
        steps = rows_of("BlockCapacityCurve.displacement", self.displacement)
        one_of("BlockCapacityCurve.status", self.status, *CURVE_STATUSES)
        if rows_of("BlockCapacityCurve.position", self.position) != steps:
            raise InputError(
                "BlockCapacityCurve.position",
                "wrong shape",
                found=rows_of("BlockCapacityCurve.position", self.position),
                expected=f"{steps} steps",
            )
        for name in ("displacement", "load_factor", "largest", "residual", "violation", "bound_gap", "gap", "dissipation"):
            store(self, **{name: floats(f"BlockCapacityCurve.{name}", getattr(self, name), (steps,))})
        for name in ("position", "rotation"):
            store(self, **{name: floats(f"BlockCapacityCurve.{name}", getattr(self, name), (steps, None, 3))})

    @property
    def proved(self) -> bool:
        """True when every step is: see `path_proved`."""
        return path_proved(self.residual, self.violation, self.bound_gap)

    @property
    def initial(self) -> float:
        """The load factor that starts the motion, NaN where nothing was found."""
        return float(self.load_factor[0]) if len(self.load_factor) else float("nan")

    def _repr_html_(self) -> str:
        rows = {"first load factor": self.initial, "d0, m": self.d0, "status": self.status, "steps": len(self.load_factor)}
        return card("Capacity curve of the stones", rows)
