"""The capacity curve of rigid blocks at large displacements."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np

from churchpipe.model.arguments import check_kind, one_of
from churchpipe.model.arrays import BoolArray, FloatArray, floats, store
from churchpipe.model.card import Shown
from churchpipe.model.pictures import diagram
from churchpipe.model.stone_path import StonePath

CurveStatus = Literal["vanished", "collapsed", "unfinished", "not-converged", "unstable", "unbounded", "failed"]
CURVE_STATUSES = ("vanished", "collapsed", "unfinished", "not-converged", "unstable", "unbounded", "failed")

# Curves that are apart by less than this share of the first load factor are one: the steps of either are known no better.
ALIKE = 1e-5
# A tie that takes up or loses more than this share of the most that it ever bears does so suddenly.
_SUDDEN = 0.5


def vanishing(displacement: FloatArray, load_factor: FloatArray) -> float:
    """Return where a curve (ns,) that came down to zero vanishes, m.

    That is before the first of its last steps that are not above zero, or, where the last load factor is but rounding above zero,
    at the last.
    """
    above = np.flatnonzero(load_factor > 0)
    if not len(above) or above[-1] == len(load_factor) - 1:
        return float(displacement[-1 if len(above) else 0])
    around = slice(above[-1], above[-1] + 2)
    (before, last), (high, low) = displacement[around], load_factor[around]
    return float(before + high / (high - low) * (last - before))


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class BlockCapacityCurve(Shown, StonePath):
    """Load factor of an assemblage against its displacement, in the geometry as displaced.

    displacement (ns,) m, of the control along the load: mean of the pushed stones weighed by their load, or the chosen point;
    load_factor (ns,). tie_forces (ns, nt) N. d0 m: displacement at which the load factor vanishes, or the structure collapses;
    NaN where the curve ends before.

    status: "vanished" the load factor came down to zero; "collapsed" stones fell out that cannot be spared; "unfinished" the
    steps or the displacement asked for were used up, or the load has lifted what it moves; "not-converged" a step's program was
    not solved; "unbounded" no load of this kind moves it on; "unstable" the dead load alone brings it down; "failed" the first
    load factor was not found.
    """

    displacement: FloatArray
    load_factor: FloatArray
    status: CurveStatus
    d0: float = np.nan
    tie_forces: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))

    def __post_init__(self) -> None:
        StonePath.__post_init__(self)
        one_of("BlockCapacityCurve.status", self.status, *CURVE_STATUSES)
        for name in ("displacement", "load_factor"):
            store(self, **{name: floats(f"BlockCapacityCurve.{name}", getattr(self, name), (len(self.position),))})
        check_kind("BlockCapacityCurve.d0", self.d0, float, int)
        store(self, tie_forces=floats("BlockCapacityCurve.tie_forces", self.tie_forces, (None, None)))

    def until(self, step: int) -> "BlockCapacityCurve":
        """Return the curve up to a step, that included: what `block_pushover(resume=...)` may go on from."""
        return replace(self.first_steps(step), d0=np.nan)

    @property
    def initial(self) -> float:
        """The load factor that starts the motion, NaN where nothing was found."""
        return float(self.load_factor[0]) if len(self.load_factor) else float("nan")

    def plot(self) -> Any:
        """Return the diagram of the curve (`churchpipe.plot`)."""
        return diagram(self)

    def _rows(self) -> tuple[str, Mapping[str, object]]:
        rows = {"first load factor": self.initial, "d0, m": self.d0, "status": self.status, "steps": len(self.load_factor)}
        return "Capacity curve of the stones", rows


def step_difference(curve: BlockCapacityCurve, halved: BlockCapacityCurve) -> tuple[float, float]:
    """Return how far the load factors of two curves are apart, and at which displacement, m, for as far as both go.

    A share of the first load factor of the first one; NaN where one of them has no steps. Where a curve goes back, as in a snap,
    it is taken from where it is further than ever before. Within a step in which a tie tightens, breaks or hangs slack a curve
    may have any load factor between those of the step's ends: where in the step that happens is not known.

    Raises
    ------
    InputError: something that is no capacity curve of the stones.
    """
    for name, each in (("curve", curve), ("halved", halved)):
        check_kind(f"step_difference: {name}", each, BlockCapacityCurve)
    if not len(curve.displacement) or not len(halved.displacement):
        return np.nan, np.nan
    one, other = _advancing(curve), _advancing(halved)
    place = np.union1d(one.displacement, other.displacement)
    place = place[place <= min(one.displacement[-1], other.displacement[-1])]
    (low, high), (least, most) = one.range(place), other.range(place)
    apart = np.maximum(np.maximum(low - most, least - high), 0.0) / max(abs(curve.initial), 1e-12)
    widest = int(np.argmax(apart))
    return float(apart[widest]), float(place[widest])


@dataclass(frozen=True, slots=True)
class _Advancing:
    """Steps (ns,) of a curve that go further than ever before; sudden (ns - 1,): whether a tie changes much between two."""

    displacement: FloatArray
    load_factor: FloatArray
    sudden: BoolArray

    def range(self, place: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the least and the greatest load factor (n,) that the curve may have at displacements (n,)."""
        between = np.interp(place, self.displacement, self.load_factor)
        step = np.searchsorted(self.displacement, place, side="left") - 1
        within = ~np.isin(place, self.displacement)
        within[within] = self.sudden[step[within]]
        ends = self.load_factor[step[within, None] + np.array([0, 1])]
        low, high = between.copy(), between
        low[within], high[within] = ends.min(axis=1), ends.max(axis=1)
        return low, high


def _advancing(curve: BlockCapacityCurve) -> _Advancing:
    reach = np.maximum.accumulate(curve.displacement)
    further = np.append(True, curve.displacement[1:] > reach[:-1])
    tension = curve.tie_forces if len(curve.tie_forces) == len(further) else np.zeros((len(further), 0))
    change, most = np.abs(np.diff(tension[further], axis=0)), tension.max(axis=0, initial=0.0)
    return _Advancing(curve.displacement[further], curve.load_factor[further], (change > _SUDDEN * most).any(axis=1))
