"""Elastic spectra of the ground (NTC 2018, 3.2.3.2.1, or a table) and of a storey (Circolare 7/2019, C7.2.3)."""

import math
from dataclasses import dataclass
from typing import Annotated, Literal, Protocol

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arguments import one_of, positive
from churchpipe.model.arrays import floats, store
from churchpipe.model.checks import DemandCurve, SpectrumParameters
from churchpipe.model.doubts import doubt_fields
from churchpipe.model.quantities import GRAVITY, Quantity, Usual

# Bounds of the soil factor S_S = least <= top - slope F0 a_g/g <= most, and C_C = factor TC*^power (tables 3.2.IV and 3.2.V).
SOILS = {
    "A": (1.0, 1.0, 0.0, 1.0, 1.0, 0.0),
    "B": (1.0, 1.4, 0.4, 1.2, 1.1, -0.2),
    "C": (1.0, 1.7, 0.6, 1.5, 1.05, -0.33),
    "D": (0.9, 2.4, 1.5, 1.8, 1.25, -0.5),
    "E": (1.0, 2.0, 1.1, 1.6, 1.15, -0.4),
}
TOPOGRAPHY = {"T1": 1.0, "T2": 1.2, "T3": 1.2, "T4": 1.4}
_F0 = Quantity(low=0.0, above=True, usual=Usual(2.2, 3.2, "the code has 2.2 at least"), key="F0")
_TC = Quantity(low=0.0, above=True, usual=Usual(0.1, 0.7, "on rock, mostly .25 to .45 s"), key="TC_star_s")
_PERIODS, _LEVELS = Quantity(key="periods_s"), Quantity(key="accelerations_m_s2")
_LEVEL = Quantity(low=0.0, above=True)
# The period of a storey's spectrum is that of the building within these factors, the upper one for its softening by damage.
_SHORTER, _LONGER = 0.8, 1.1


class Demand(Protocol):
    """What an earthquake asks of an oscillator."""

    def acceleration(self, period: float, ground: float, damping: float) -> float:
        """Return the spectral acceleration, m/s2, at a period, s, for a ground acceleration a_g, m/s2, and a damping, percent."""
        ...


def damping_factor(damping: float) -> float:
    """Return eta = sqrt(10/(5 + xi)) >= .55 of a damping xi in percent [3.2.4]."""
    return max(math.sqrt(10 / (5 + damping)), 0.55)


def spectral_displacement(demand: Demand, period: float, ground: float, damping: float) -> float:
    """Return S_De = S_e (T / 2 pi)^2, m."""
    return demand.acceleration(period, ground, damping) * (period / (2 * math.pi)) ** 2


def demand_curve(demand: Demand, ground: float, damping: float, furthest: float) -> DemandCurve:
    """Return the demand at a_g, points of periods whose displacements reach `furthest`, m, for the diagram."""
    period = np.concatenate([np.linspace(0.0, 1.0, 41), np.linspace(1.05, 8.0, 140)])
    level = np.array([demand.acceleration(float(t), ground, damping) for t in period])
    displacement = level * (period / (2 * math.pi)) ** 2
    last = int(np.argmax(displacement > furthest)) or len(period) - 1
    reached, levels = (tuple(values[: last + 1].tolist()) for values in (displacement, level))
    return DemandCurve(displacement=reached, acceleration=levels)


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
        for name, value, known in (("soil", self.soil, SOILS), ("topography", self.topography, TOPOGRAPHY)):
            one_of(f"Spectrum.{name}", value, *known)
        if self.soil_factor is not None:
            positive("Spectrum.soil_factor", self.soil_factor)

    def parameters(self, ground: float) -> SpectrumParameters:
        """Return what makes the spectrum at a ground acceleration a_g, m/s2."""
        soil, topography, whole, longer = None, None, self.soil_factor, 1.0
        if whole is None:
            least, top, slope, most, factor, power = SOILS[self.soil]
            soil = min(max(top - slope * self.amplification * ground / GRAVITY, least), most)
            topography = TOPOGRAPHY[self.topography]
            whole, longer = soil * topography, factor * self.start**power
        plateau_end = longer * self.start
        return SpectrumParameters(
            amplification=self.amplification,
            start=self.start,
            stratigraphic=soil,
            topographic=topography,
            soil_factor=whole,
            period_factor=longer,
            rising_end=plateau_end / 3,
            plateau_end=plateau_end,
            velocity_end=4 * ground / GRAVITY + 1.6,
        )

    def acceleration(self, period: float, ground: float, damping: float) -> float:
        """Return S_e, m/s2, at a period, s, for a ground acceleration a_g, m/s2, and a damping in percent [3.2.2]."""
        eta, made = damping_factor(damping), self.parameters(ground)
        tb, tc, td = made.rising_end, made.plateau_end, made.velocity_end
        top = ground * made.soil_factor * eta * self.amplification
        if period < tb:
            return top * (period / tb + (1 - period / tb) / (eta * self.amplification))
        if period < tc:
            return top
        return top * tc / period if period < td else top * tc * td / period**2


@dataclass(frozen=True, slots=True)
class TabulatedSpectrum:
    """An elastic spectrum given by points, soil included, with a damping of 5 percent.

    period: s, rising; level: m/s2, S_e at each; ground: m/s2, the a_g that it belongs to: for another one it grows in proportion.
    Between the points it runs straight; beyond the last one the displacement stays what it is there.
    """

    period: tuple[float, ...]
    level: tuple[float, ...]
    ground: float

    def __post_init__(self) -> None:
        positive("TabulatedSpectrum.ground", self.ground)
        period = floats("TabulatedSpectrum.period", self.period, (None,))
        level = floats("TabulatedSpectrum.level", self.level, (None,))
        store(self, period=tuple(period.tolist()), level=tuple(level.tolist()))
        if len(period) < 2 or period[0] < 0 or not (np.diff(period) > 0).all():
            expected = "two periods >= 0 or more, each greater than the one before"
            raise InputError("TabulatedSpectrum.period", "not rising", found=period.tolist(), expected=expected)
        if len(level) != len(period):
            expected = f"one for each of the {len(period)} periods"
            raise InputError("TabulatedSpectrum.level", "wrong shape", found=len(level), expected=expected)
        if not (level > 0).all():
            raise InputError("TabulatedSpectrum.level", "out of range", found=float(level.min()), expected="> 0")

    def acceleration(self, period: float, ground: float, damping: float) -> float:
        """Return S_e, m/s2; at the period zero, where damping changes nothing, the acceleration of the ground."""
        last = self.period[-1]
        level = float(np.interp(period, self.period, self.level)) * (min(last / period, 1.0) ** 2 if period > 0 else 1.0)
        eta = damping_factor(damping) if period > 0 else 1.0
        return level * eta * ground / self.ground


@dataclass(frozen=True, slots=True)
class StoreySpectrum:
    """The spectrum of a storey that the building's first mode shakes, never below that of the ground [C7.2.5-8].

    ground: that of the ground; first_period: T1 of the building, s; peak: a_Z / a_g, the largest acceleration of the storey
    [C7.2.8] over that of the ground, to which it is proportional; damping: xi of the building, percent.
    """

    ground: Demand
    first_period: float
    peak: float
    damping: float = 5.0

    def __post_init__(self) -> None:
        positive("StoreySpectrum.first_period", self.first_period)
        positive("StoreySpectrum.damping", self.damping)
        # A storey at the height zero is the ground.
        positive("StoreySpectrum.peak", self.peak, allow_zero=True)

    def acceleration(self, period: float, ground: float, damping: float) -> float:
        """Return S_eZ, m/s2, at a period, s, for a ground acceleration a_g, m/s2, and a damping in percent [C7.2.7].

        Written from memory of that equation: compare it with the text before use.
        """
        low, high = _SHORTER * self.first_period, _LONGER * self.first_period
        # Here the building's damping is a share and no percentage: a part in tune with it is shaken some five times as hard.
        most = max(1.1 * (self.damping / 100) ** -0.5 * damping_factor(damping), 1.0)
        away = (1 - period / low) ** 1.6 if period < low else (period / high - 1) ** 1.2 if period > high else 0.0
        storey = self.peak * ground * most / (1 + (most - 1) * away)
        return max(storey, self.ground.acceleration(period, ground, damping))


@dataclass(frozen=True, slots=True)
class SiteSpectrum:
    """The elastic spectrum of the site as a case gives it: by F0 and TC*, or as a table with a damping of 5 percent.

    Raises
    ------
    InputError: half of either, or both; periods that do not rise; soil with a table, topography without soil.
    """

    amplification: Annotated[float | None, _F0, "F0: amplification on rock."] = None
    start: Annotated[float | None, _TC, "TC*: period at which the branch of constant velocity begins on rock."] = None
    soil: Annotated[Literal["A", "B", "C", "D", "E"] | None, "Category of the soil, instead of `soil_factor` in [check]."] = None
    topography: Annotated[Literal["T1", "T2", "T3", "T4"], "Category of the topography, with `soil`."] = "T1"
    period: Annotated[tuple[Annotated[float, Quantity(low=0.0)], ...] | None, _PERIODS, "Periods of a table, rising."] = None
    level: Annotated[tuple[Annotated[float, _LEVEL], ...] | None, _LEVELS, "S_e at these periods, soil included."] = None

    def __post_init__(self) -> None:
        for name, value, known in (("soil", self.soil, SOILS), ("topography", self.topography, TOPOGRAPHY)):
            if value is not None or name == "topography":
                one_of(f"spectrum: {name}", value, *known)
        given = [value is not None for value in (self.amplification, self.start, self.period, self.level)]
        if given not in ([True, True, False, False], [False, False, True, True]):
            expected = "F0 and TC_star_s, or periods_s and accelerations_m_s2"
            raise InputError("spectrum", "neither formula nor table, or parts of both", expected=expected)
        if self.soil is not None and self.period is not None:
            raise InputError("spectrum: soil", "given with a table", expected="a table, which has the soil in it, or soil")
        if self.soil is None and self.topography != "T1":
            raise InputError(
                "spectrum: topography",
                "given without soil",
                found=self.topography,
                expected="soil with it; a table and soil_factor of [check] have the topography in them",
            )
        try:
            self.of(1.0, 1.0)
        except InputError as error:
            # The fields of both spectra have the names of those here, which are keys of the case.
            raise error.at(f"spectrum: {error.where.rpartition('.')[2]}") from error
        doubt_fields(self)

    def of(self, ground: float, soil_factor: float | None) -> Spectrum | TabulatedSpectrum:
        """Return the spectrum of a site with this a_g, m/s2, and this S, None where it follows from the soil."""
        if self.period is not None and self.level is not None:
            return TabulatedSpectrum(self.period, self.level, ground)
        assert self.amplification is not None
        assert self.start is not None
        return Spectrum(self.amplification, self.start, self.soil or "A", self.topography, None if self.soil else soil_factor)
