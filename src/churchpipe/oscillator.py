"""A capacity curve as that of the equivalent oscillator, and what this withstands.

Circolare of 21.1.2019 n. 7, C8.7.1.2.1, read in a transcription.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from churchpipe.code_check import CONFIDENCE_FACTOR
from churchpipe.errors import InputError
from churchpipe.model.arrays import FloatArray, floats
from churchpipe.model.quantities import GRAVITY
from churchpipe.spectrum import Demand, spectral_displacement

LimitName = Literal["SLV", "SLC"]


@dataclass(frozen=True, slots=True)
class LimitStateRule:
    """Of a limit state: its displacement over d0, secant period over pi sqrt(d/a) [C8.7.1.11-12], damping in percent."""

    share: float
    secant: float
    damping: float


LIMIT_STATES: dict[LimitName, LimitStateRule] = {
    "SLV": LimitStateRule(0.40, 1.68, 8.0),
    "SLC": LimitStateRule(0.60, 1.56, 10.0),
}
# A load factor that falls by more than this share within a step, or within the second share of d0 however short the steps, is a
# loss of connections.
_LOSS, _WITHIN = 0.5, 0.05
# It begins to fall where it has this share, the last time, of what it was at the step from which the fall lies so near.
_BEFORE = 0.9
FOLLOW = "Follow the curve further: more steps, or a larger furthest_mm, in [rigid.curve]."


@dataclass(frozen=True, slots=True)
class Oscillator:
    """The capacity curve of a mechanism as that of the equivalent oscillator [C8.7.1.3-5].

    displacement (ns,) d, m; acceleration (ns,) a, m/s2; ultimate: d0, m, where the acceleration vanishes.
    loss: m, the displacement short of d_SLV at which connections are lost that cost half of the acceleration, or infinite.
    seat: m, the displacement at which a beam loses its seat, or infinite.
    fraction: e* of the stones, the share of the moving mass that takes part; weight: N, of what moves.
    """

    displacement: FloatArray
    acceleration: FloatArray
    ultimate: float
    loss: float = math.inf
    fraction: float = 1.0
    weight: float = math.nan
    seat: float = math.inf

    def at(self, displacement: float) -> float:
        """Return a at a displacement, m/s2: the least where the curve has gone back and passes it more than once."""
        ends = np.stack([self.displacement[:-1], self.displacement[1:]])
        passed = np.flatnonzero((ends.min(axis=0) <= displacement) & (displacement <= ends.max(axis=0)))
        if not len(passed):
            return float(np.interp(displacement, self.displacement, self.acceleration))
        (begin, end), (high, low) = ends[:, passed], (self.acceleration[passed], self.acceleration[passed + 1])
        share = np.divide(displacement - begin, end - begin, out=np.ones_like(begin), where=end != begin)
        return float((high + share * (low - high)).min())

    @property
    def lumped(self) -> "Oscillator":
        """The same with e* = 1, all that moves one body: smaller displacements and accelerations, the careful curve."""
        return replace(
            self,
            displacement=self.displacement * self.fraction,
            acceleration=self.acceleration * self.fraction,
            ultimate=self.ultimate * self.fraction,
            loss=self.loss * self.fraction,
            seat=self.seat * self.fraction,
            fraction=1.0,
        )

    @property
    def idealised(self) -> "Oscillator":
        """The two straight lines of one rigid body that rocks: up to the same onset, and down to zero with the same area."""
        onset, area = float(self.acceleration[0]), float(np.trapezoid(self.acceleration, self.displacement))
        end = 2 * area / onset
        return replace(self, displacement=np.array([0.0, end]), acceleration=np.array([onset, 0.0]), ultimate=end, loss=math.inf)


@dataclass(frozen=True, slots=True)
class LimitStateCapacity:
    """What a mechanism withstands at a limit state.

    displacement: d, m; acceleration: a(d), m/s2; period: secant, s; ground: the largest a_g, m/s2, whose demand it meets.
    governed: "displacement", or "onset" where it does not even start to move before.
    """

    displacement: float
    acceleration: float
    period: float
    ground: float
    governed: Literal["displacement", "onset"]


def oscillator(
    displacement: FloatArray,
    load_factor: FloatArray,
    d0: float,
    weight: FloatArray,
    motion: FloatArray,
    *,
    pushed: FloatArray | None = None,
    confidence_factor: float = CONFIDENCE_FACTOR,
) -> Oscillator:
    """Return the equivalent oscillator of a capacity curve.

    Parameters
    ----------
    displacement, load_factor (ns,), d0 m: of the curve, its control the mean displacement of the pushed stones along the load.
    weight, motion (nb,): of each stone N, and its displacement along the load in the initial mechanism, of any size.
    pushed (nb,): N, the weight that the load factor multiplies; None: all of it.

    Raises
    ------
    InputError: no curve to zero, arrays that do not agree, a mechanism that does not go along its load.
    """
    displacement = floats("oscillator: displacement", displacement, (None,))
    load_factor = floats("oscillator: load_factor", load_factor, (len(displacement),))
    weight = floats("oscillator: weight", weight, (None,))
    motion = floats("oscillator: motion", motion, (len(weight),))
    load = weight if pushed is None else floats("oscillator: pushed", pushed, (len(weight),))
    if not float(load @ motion) > 0:
        raise InputError("oscillator: motion", "the mechanism does not go along its load", found=float(load @ motion))
    if not (math.isfinite(d0) and d0 > 0):
        raise InputError(
            "oscillator: d0",
            "the curve does not come to its end",
            found=f"a load factor of {load_factor[-1]:.4g} where it was left" if len(load_factor) else "no steps",
            expected="a load factor that comes down to zero",
            remedy=FOLLOW,
        )
    first, second, all_moving = float(weight @ motion), float(weight @ motion**2), float(weight[motion != 0].sum())
    fraction = first**2 / (all_moving * second)
    # d = d_C sum P delta^2 / (delta_C sum P delta) with the mean displacement of what is pushed as d_C.
    scale = second / first * float(load.sum()) / float(load @ motion)
    level = float(load @ motion) / first * GRAVITY / (fraction * confidence_factor)
    kept, lost = load_factor > 0, _loss(displacement, load_factor, d0)
    return Oscillator(
        np.append(displacement[kept], d0) * scale,
        np.append(load_factor[kept], 0.0) * level,
        d0 * scale,
        lost * scale if lost < LIMIT_STATES["SLV"].share * d0 else math.inf,
        fraction,
        all_moving,
    )


def _loss(displacement: FloatArray, load_factor: FloatArray, d0: float) -> float:
    """Return where connections are lost on a curve (ns,), m, infinite where none are: where the load factor begins to fall.

    Before the fall it is still near what it was where the fall came within reach, wherever steps lie between the two.
    """
    sudden = np.flatnonzero(_soon(displacement, load_factor, _WITHIN * d0) < (1 - _LOSS) * load_factor)
    if not len(sudden):
        return math.inf
    near = load_factor[sudden[0] :] / load_factor[sudden[0]]
    before = near[: int(np.argmax(near < 1 - _LOSS)) or None]
    return float(displacement[sudden[0] + np.flatnonzero(before >= _BEFORE)[-1]])


def _soon(displacement: FloatArray, load_factor: FloatArray, within: float) -> FloatArray:
    """Return the least load factor (ns,) on the way from each step to the next, or for as long as it is no further than so, m.

    On the way, not by displacement: a curve may go back.
    """
    soon = load_factor.copy()
    for step, start in enumerate(displacement[:-1].tolist()):
        far = np.flatnonzero(np.abs(displacement[step:] - start) > within)
        last = step + int(far[0]) if len(far) else len(displacement)
        soon[step] = load_factor[step : max(last, step + 2)].min()
        if last < len(displacement):
            rim = start + math.copysign(within, displacement[last] - start)
            way, factor = displacement[last - 1 : last + 1], load_factor[last - 1 : last + 1]
            soon[step] = min(soon[step], factor[0] + np.diff(factor)[0] * (rim - way[0]) / np.diff(way)[0])
    return soon


def capacity(curve: Oscillator, demand: Demand, limit: LimitName = "SLV") -> LimitStateCapacity:
    """Return what an oscillator withstands at the limit state of life safety, "SLV", or of collapse, "SLC".

    d_SLV = .40 d0 and no more than the displacement of a loss of connections, d_SLC = .60 d0, neither beyond the displacement at
    which a beam loses its seat; T = 1.68 pi sqrt(d/a(d)) and
    1.56 pi sqrt(d/a(d)); damping 8 and 10 percent. The largest a_g is sought up to which the demand S_De(T) is met; where the
    ground acceleration that starts the motion is larger, or connections are lost at once, that is the capacity.
    """
    if limit not in LIMIT_STATES:
        raise InputError("capacity: limit", "unknown limit state", found=limit, expected=", ".join(LIMIT_STATES))
    rule = LIMIT_STATES[limit]
    # Where a floor comes down, what saves lives has come to its end as well.
    reached = min(rule.share * curve.ultimate, curve.seat)
    if limit == "SLV":
        reached = min(reached, curve.loss)
    level = curve.at(reached)
    period = rule.secant * math.pi * math.sqrt(reached / level)
    onset = float(curve.acceleration[0])
    # Without a displacement there is no period, and no earthquake would ask for any.
    moved = _largest(lambda ground: spectral_displacement(demand, period, ground, rule.damping) <= reached) if reached else 0.0
    still = _largest(lambda ground: demand.acceleration(0.0, ground, 5.0) <= onset)
    return LimitStateCapacity(reached, level, period, max(moved, still), "displacement" if moved >= still else "onset")


def _largest(bearable: Callable[[float], bool]) -> float:
    """Return the largest ground acceleration, m/s2, up to which all are bearable.

    Demands need not grow with a_g: a_g S of soil D falls by 6 % where S comes down to .9. So the first one that is not bearable
    is looked for in short steps, which miss no more than 3e-5 of the demand at its peak, and then by bisection.
    """
    low, high = 0.0, 1e-3
    while bearable(high) and high < 1e3:
        low, high = high, 1.01 * high
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if bearable(middle) else (low, middle)
    return low
