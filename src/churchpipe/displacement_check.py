"""The displacement-based check of the Italian code: Circolare of 21.1.2019 n. 7, C8.7.1.2.1, read in a transcription.

Elastic spectrum: NTC 2018, 3.2.3.2.1, with tables 3.2.IV and 3.2.V.
"""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from churchpipe.code_check import CONFIDENCE_FACTOR, GRAVITY
from churchpipe.errors import InputError
from churchpipe.model.arguments import positive
from churchpipe.model.arrays import FloatArray, floats

# Of d0: the displacements of the limit states; of the secant period [C8.7.1.11-12]; the damping that goes with it, percent.
_LIMITS = {"SLV": (0.40, 1.68, 8.0), "SLC": (0.60, 1.56, 10.0)}
# A load factor that falls by more than this share within a step is a loss of connection.
_LOSS = 0.5
# Bounds of the soil factor S_S = least <= top - slope F0 a_g/g <= most, and C_C = factor TC*^power.
_SOILS = {
    "A": (1.0, 1.0, 0.0, 1.0, 1.0, 0.0),
    "B": (1.0, 1.4, 0.4, 1.2, 1.1, -0.2),
    "C": (1.0, 1.7, 0.6, 1.5, 1.05, -0.33),
    "D": (0.9, 2.4, 1.5, 1.8, 1.25, -0.5),
    "E": (1.0, 2.0, 1.1, 1.6, 1.15, -0.4),
}
_TOPOGRAPHY = {"T1": 1.0, "T2": 1.2, "T3": 1.2, "T4": 1.4}
LimitName = Literal["SLV", "SLC"]


@dataclass(frozen=True, slots=True)
class Spectrum:
    """The elastic spectrum of a site but for its ground acceleration.

    amplification: F0; start: TC*, s; soil: category "A" to "E"; topography: "T1" to "T4"; soil_factor: S instead of those two,
    with C_C = 1, for spectra that do not follow them.
    """

    amplification: float
    start: float
    soil: str = "A"
    topography: str = "T1"
    soil_factor: float | None = None

    def __post_init__(self) -> None:
        positive("Spectrum.amplification", self.amplification)
        positive("Spectrum.start", self.start)
        for name, value, known in (("soil", self.soil, _SOILS), ("topography", self.topography, _TOPOGRAPHY)):
            if value not in known:
                raise InputError(f"Spectrum.{name}", "unknown value", found=value, expected=", ".join(known))
        if self.soil_factor is not None:
            positive("Spectrum.soil_factor", self.soil_factor)

    def soil_amplification(self, ground: float) -> float:
        """Return S = S_S S_T at a ground acceleration a_g, m/s2."""
        if self.soil_factor is not None:
            return self.soil_factor
        least, top, slope, most, _, _ = _SOILS[self.soil]
        own = min(max(top - slope * self.amplification * ground / GRAVITY, least), most)
        return own * _TOPOGRAPHY[self.topography]

    @property
    def plateau_end(self) -> float:
        """TC = C_C TC*, s."""
        factor, power = (1.0, 0.0) if self.soil_factor is not None else _SOILS[self.soil][4:]
        return factor * self.start**power * self.start

    def acceleration(self, period: float, ground: float, damping: float) -> float:
        """Return S_e, m/s2, at a period, s, for a ground acceleration a_g, m/s2, and a damping in percent [3.2.2]."""
        eta = max(math.sqrt(10 / (5 + damping)), 0.55)
        tc = self.plateau_end
        tb, td = tc / 3, 4 * ground / GRAVITY + 1.6
        top = ground * self.soil_amplification(ground) * eta * self.amplification
        if period < tb:
            return top * (period / tb + (1 - period / tb) / (eta * self.amplification))
        if period < tc:
            return top
        return top * tc / period if period < td else top * tc * td / period**2

    def displacement(self, period: float, ground: float, damping: float) -> float:
        """Return S_De = S_e (T / 2 pi)^2, m."""
        return self.acceleration(period, ground, damping) * (period / (2 * math.pi)) ** 2


@dataclass(frozen=True, slots=True)
class Oscillator:
    """The capacity curve of a mechanism as that of the equivalent oscillator [C8.7.1.3-5].

    displacement (ns,) d, m; acceleration (ns,) a, m/s2; ultimate: d0, m, where the acceleration vanishes.
    loss: m, the displacement at which connections are lost that cost more than half of the acceleration, or infinite.
    """

    displacement: FloatArray
    acceleration: FloatArray
    ultimate: float
    loss: float = math.inf

    def at(self, displacement: float) -> float:
        """Return a at a displacement, m/s2."""
        return float(np.interp(displacement, self.displacement, self.acceleration))


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
    if not (math.isfinite(d0) and d0 > 0):
        raise InputError("oscillator: d0", "the curve does not come to its end", found=d0, expected="a displacement > 0")
    if not float(load @ motion) > 0:
        raise InputError("oscillator: motion", "the mechanism does not go along its load", found=float(load @ motion))
    first, second, all_moving = float(weight @ motion), float(weight @ motion**2), float(weight[motion != 0].sum())
    fraction = first**2 / (all_moving * second)
    # d = d_C sum P delta^2 / (delta_C sum P delta) with the mean displacement of what is pushed as d_C.
    scale = second / first * float(load.sum()) / float(load @ motion)
    level = float(load @ motion) / first * GRAVITY / (fraction * confidence_factor)
    kept = load_factor > 0
    falls = np.flatnonzero(load_factor[1:] < (1 - _LOSS) * load_factor[:-1])
    sudden = [k for k in falls if displacement[k + 1] < 0.9 * d0]
    return Oscillator(
        np.append(displacement[kept], d0) * scale,
        np.append(load_factor[kept], 0.0) * level,
        d0 * scale,
        float(displacement[sudden[0]]) * scale if sudden else math.inf,
    )


def capacity(curve: Oscillator, spectrum: Spectrum, limit: LimitName = "SLV") -> LimitStateCapacity:
    """Return what an oscillator withstands at the limit state of life safety, "SLV", or of collapse, "SLC".

    d_SLV = .40 d0 and no more than the displacement of a loss of connections, d_SLC = .60 d0; T = 1.68 pi sqrt(d/a(d)) and
    1.56 pi sqrt(d/a(d)); damping 8 and 10 percent. The demand S_De(T) grows with a_g, which is sought by bisection; where the
    ground acceleration that starts the motion is larger, that is the capacity.
    """
    if limit not in _LIMITS:
        raise InputError("capacity: limit", "unknown limit state", found=limit, expected=", ".join(_LIMITS))
    share, secant, damping = _LIMITS[limit]
    reached = share * curve.ultimate
    if limit == "SLV":
        reached = min(reached, curve.loss)
    level = curve.at(reached)
    period = secant * math.pi * math.sqrt(reached / level)
    low, high = 0.0, 1.0
    while spectrum.displacement(period, high, damping) < reached and high < 1e3:
        high *= 2
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if spectrum.displacement(period, middle, damping) <= reached else (low, middle)
    onset = float(curve.acceleration[0])
    start = onset
    for _ in range(50):
        start = onset / spectrum.soil_amplification(start)
    return LimitStateCapacity(reached, level, period, max(low, start), "displacement" if low >= start else "onset")
