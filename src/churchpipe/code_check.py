"""From a load factor to the safety check of the Italian code: NTC 2018 with the Circolare of 21.1.2019 n. 7, C8.7.1.2."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Literal

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arguments import check_kind, one_of
from churchpipe.model.arrays import FloatArray
from churchpipe.model.checks import Check, SafetyCheck, SpectrumParameters
from churchpipe.model.doubts import doubt_fields, question
from churchpipe.model.quantities import GRAVITY, Count, Quantity, Usual, check_ranges, in_range, unit_of
from churchpipe.spectrum import Demand, SiteSpectrum, Spectrum, StoreySpectrum

KnowledgeLevel = Literal["LC1", "LC2", "LC3"]
# Confidence factors of the knowledge levels (C8.5.4). Where crushing of the masonry is not modelled the circular asks for that of
# the lowest, whatever is known of the building (C8.7.1).
LEVELS: dict[KnowledgeLevel, float] = {"LC1": 1.35, "LC2": 1.2, "LC3": 1.0}
CONFIDENCE_FACTOR = LEVELS["LC1"]
BEHAVIOUR_FACTOR = 2.0
NO_PUSH = "the load pushes no weight: the check is of loads that push the building sideways"

# EN 1998-1, 3.2.1: below .04 g the seismicity is very low. A value in g that was written as one in m/s2 lies there as a rule, and
# one in m/s2 that was written as one in g above .6 g.
_USUAL_GROUND = Usual(0.04, 0.6, "design values on rock are mostly 0.04 to 0.6 g")
_GROUND = Quantity(low=0.0, above=True, usual=_USUAL_GROUND, key="ag_g", other="a_g_m_s2")
_SPECTRAL = Quantity(
    "_g", 0.0, above=True, usual=Usual(0.001, 5, "some three times the ground acceleration"), other="spectral_acceleration_m_s2"
)
_SOIL = Quantity(low=0.0, above=True, usual=Usual(0.8, 3, "S_S up to 1.8 times S_T up to 1.4"))
_HIGH = Usual(1, 200, "houses to the tallest spires")
_DAMPING = Usual(1, 20, "the code has 5")
_FIRST = Usual(0.02, 4, "masonry buildings mostly have .1 to 1 s")
_BEHAVIOUR = Quantity(low=1, usual=Usual(1, 4, "2 for local mechanisms, at most 3 to 4 for whole buildings of masonry"), key="q")
# Of a table: S_e at the period 0 over a_g S, either way; the plateau over it, as F0 has it; where it ends.
_FIRST_LEVEL = 1.25
_PEAK = Usual(1.8, 3.5, "F0 is 2.2 to 3.2")
_LAST = Usual(0.8, 20, "what rocks has some seconds, and beyond the table the displacement stays what it is there")
# S_e(T1) of a floor that is read off a diagram of the spectrum is off it by no larger a share.
_SAME_LEVEL = 0.1
# A mechanism that begins no higher, m, is shaken as on the ground.
_ABOVE = 0.5
_CONFIDENCE = Quantity(low=1, usual=Usual(1, 1.35, "the code has 1, 1.2 and 1.35"))


@dataclass(frozen=True, slots=True)
class Floor:
    """A mechanism that begins at a height Z in the building, shaken by its first mode alone.

    height: Z of the mechanism above the foundation, m; building_height: H, m; storeys: n; spectral_acceleration: S_e(T1), m/s2,
    of the elastic spectrum at the building's first period, soil included; damping_percent: xi of the building; first_period: T1,
    s, which the displacement-based check needs.

    Raises
    ------
    InputError: a value out of its range.
    """

    height: Annotated[float, Quantity("_m", 0.0), "Z: where the mechanism begins, above the foundation."]
    building_height: Annotated[
        float, Quantity("_m", 0.0, above=True, usual=_HIGH), "H: height of the building above the foundation."
    ]
    storeys: Annotated[Count, "Number of storeys."]
    spectral_acceleration: Annotated[float, _SPECTRAL, "S_e(T1): elastic spectrum at the building's first period, soil included."]
    damping_percent: Annotated[float, Quantity(low=0.0, above=True, usual=_DAMPING), "Damping of the building."] = 5.0
    first_period: Annotated[
        float | None,
        Quantity("_s", 0.0, above=True, usual=_FIRST),
        "T1: first period of the building, for the displacement-based check.",
    ] = None

    def __post_init__(self) -> None:
        check_ranges(self, "check: ")
        if not 0 <= self.height <= self.building_height:
            expected = f"from 0 to the building_height of {float(self.building_height):g} m"
            raise InputError("check: height", "out of range", found=self.height, expected=expected)
        doubt_fields(self)

    @property
    def acceleration(self) -> float:
        """a_Z, m/s2: S_e(T1) gamma psi sqrt(1 + .0004 xi^2) [C7.2.8], gamma = 3 n / (2 n + 1) [C7.2.10], psi = Z / H."""
        gamma = 3 * self.storeys / (2 * self.storeys + 1)
        shape = self.height / self.building_height
        return self.spectral_acceleration * gamma * shape * math.sqrt(1 + 0.0004 * self.damping_percent**2)


@dataclass(frozen=True, slots=True)
class Site:
    """What the earthquake asks, which no model knows.

    ground_acceleration: a_g, m/s2, on rock for the ultimate limit state (SLV); soil_factor: S = S_S S_T, None where the soil of
    the spectrum gives it; behaviour_factor: q; confidence_factor: FC; knowledge_level: whose factor takes its place in analyses
    of stones that crush; floor: for a mechanism above the ground, besides;
    spectrum: for the displacement-based check.

    Raises
    ------
    InputError: a value out of its range, a soil factor given twice or not at all.
    """

    ground_acceleration: Annotated[float, _GROUND, "a_g: on rock, for the ultimate limit state (SLV)."]
    soil_factor: Annotated[
        float | None, _SOIL, "S = S_S S_T: soil and topography; by default that of `soil` in the spectrum."
    ] = None
    behaviour_factor: Annotated[float, _BEHAVIOUR, "q: behaviour factor."] = BEHAVIOUR_FACTOR
    confidence_factor: Annotated[float, _CONFIDENCE, "FC: confidence factor, by the level of knowledge."] = CONFIDENCE_FACTOR
    floor: Annotated[Floor | None, "For a mechanism that begins above the ground."] = None
    spectrum: Annotated[SiteSpectrum | None, "Elastic spectrum, for the displacement-based check of capacity curves."] = None
    knowledge_level: Annotated[
        KnowledgeLevel | None,
        "Its FC (1.35, 1.2, 1) takes the place of `confidence_factor` where the masonry crushes (`compressive_strength_MPa`).",
    ] = None

    def __post_init__(self) -> None:
        check_ranges(self, "check: ")
        for name, value, kind in (("floor", self.floor, Floor), ("spectrum", self.spectrum, SiteSpectrum)):
            if value is not None:
                check_kind(f"check: {name}", value, kind)
        if self.knowledge_level is not None:
            one_of("check: knowledge_level", self.knowledge_level, *LEVELS)
        by_soil = self.spectrum is not None and self.spectrum.soil is not None
        if (self.soil_factor is None) != by_soil:
            problem = "a factor given twice" if by_soil else "missing key"
            raise InputError("check: soil_factor", problem, expected="either soil_factor or soil in [check.spectrum]")
        doubt_fields(self, asked=self.questions)

    @property
    def questions(self) -> list[str]:
        """What to ask about the spectrum, where other values of the site contradict it."""
        return [*self._table_questions(), *self._period_questions()]

    def _period_questions(self) -> list[str]:
        """Return what to ask where S_e(T1) of the floor is not that of the spectrum."""
        found = self.spectrum.of(self.ground_acceleration, self.soil_factor) if self.spectrum else None
        if found is None or self.floor is None or self.floor.first_period is None:
            return []
        given, period = self.floor.spectral_acceleration, self.floor.first_period
        level = found.acceleration(period, self.ground_acceleration, self.floor.damping_percent)
        if abs(given - level) <= _SAME_LEVEL * level:
            return []
        return [
            f"check.floor.spectral_acceleration_m_s2 is {given:.4g} m/s2, and the spectrum of the case has {level:.4g} m/s2 at "
            f"first_period_s, {period:g} s. Is it meant?"
        ]

    def _table_questions(self) -> list[str]:
        """Return what to ask about a spectrum given as a table: whether it is one of this a_g and S, and in m/s2 and seconds."""
        period, level = (self.spectrum.period, self.spectrum.level) if self.spectrum else (None, None)
        if not period or not level or self.soil_factor is None:
            return []
        ground = self.ground_acceleration * self.soil_factor
        asked: list[str] = []
        if period[0] == 0 and not ground / _FIRST_LEVEL <= level[0] <= _FIRST_LEVEL * ground:
            asked.append(
                f"The table of the spectrum begins at the period 0 with {level[0]:.4g} m/s2, where S_e is a_g S, here "
                f"{ground:.4g} m/s2. Is it meant?"
            )
        elif not _PEAK.low <= max(level) / ground <= _PEAK.high:
            asked.append(
                f"The table of the spectrum rises to {max(level):.4g} m/s2, {max(level) / ground:.3g} times a_g S = {ground:.4g} "
                f"m/s2, usual are {_PEAK.low:g} to {_PEAK.high:g} times: {_PEAK.reason}. Is it meant?"
            )
        unit = unit_of("periods_s")
        return [*asked, *filter(None, [question("the last period of the table of the spectrum", period[-1], _LAST, unit)])]

    def confidence(self, crushing: bool) -> float:
        """Return FC of an analysis, whether or not the masonry crushes in it."""
        return LEVELS[self.knowledge_level] if crushing and self.knowledge_level else self.confidence_factor

    @property
    def soil(self) -> float:
        """S = S_S S_T."""
        if self.soil_factor is not None:
            return self.soil_factor
        return self.parameters.soil_factor if self.parameters else math.nan

    @property
    def parameters(self) -> SpectrumParameters | None:
        """What makes the spectrum of the ground at a_g, None of a table or without one."""
        found = self.spectrum.of(self.ground_acceleration, self.soil_factor) if self.spectrum else None
        return found.parameters(self.ground_acceleration) if isinstance(found, Spectrum) else None

    @property
    def demand(self) -> Demand | None:
        """The spectrum at the foot of the mechanism, None where the case does not say it."""
        found = self.spectrum.of(self.ground_acceleration, self.soil_factor) if self.spectrum else None
        if found is None or self.floor is None:
            return found
        if self.floor.first_period is None:
            return None
        peak = self.floor.acceleration / self.ground_acceleration
        return StoreySpectrum(found, self.floor.first_period, peak, self.floor.damping_percent)


def activation(
    load_factor: float,
    weight: FloatArray,
    pushed: FloatArray,
    displacement: FloatArray,
    confidence_factor: float = CONFIDENCE_FACTOR,
) -> SafetyCheck:
    """Return the spectral acceleration that activates a mechanism, without a site to compare it with.

    Parameters
    ----------
    load_factor: of the limit analysis.
    weight: (n,) N of the bodies that move, P_k + Q_k. pushed: (n,) N of each that the load factor multiplies: the weight itself
        where the load is proportional to weight and acts on all.
    displacement: (n,) virtual horizontal displacements of the centroids along the load, d_x,k, in any unit.

    e* = [sum P d_x]^2 / (sum P sum P d_x^2), M* = e* sum P / g [C8.7.1.5]; a0* = alpha0 g / (e* FC).
    alpha0 is that of [C8.7.1.1]: the work done over sum P d_x of all that moves. For a load on some parts alone, or one that
    grows with height, the work load_factor sum(pushed d_x) is so turned into a multiplier of all the weights that move.

    Raises
    ------
    InputError: arrays of different length, nothing that moves along the load, a load factor that is no number, FC below 1.
    """
    in_range(Site, "confidence_factor", "check: confidence_factor", confidence_factor)
    if not (weight.shape == pushed.shape == displacement.shape):
        shapes = f"{weight.shape}, {pushed.shape}, {displacement.shape}"
        raise InputError("check", "weights and displacements of different bodies", found=shapes, expected="one of each a body")
    if not math.isfinite(load_factor):
        raise InputError("check", "no load factor", found=load_factor, expected="a number")
    first, second = float(weight @ displacement), float(weight @ displacement**2)
    if not first > 0:
        raise InputError("check", "the mechanism does not move along the load", found=f"sum of P d_x = {first:g}", expected="> 0")
    whole = float(weight.sum())
    fraction = first**2 / (whole * second)
    alpha = load_factor * float(pushed @ displacement) / first
    return SafetyCheck(
        alpha0=alpha,
        moving_weight=whole,
        confidence_factor=confidence_factor,
        mass_fraction=fraction,
        participating_mass=fraction * whole / GRAVITY,
        a0_lumped=alpha * GRAVITY / confidence_factor,
        a0=alpha * GRAVITY / (fraction * confidence_factor),
    )


def verified(found: SafetyCheck, site: Site) -> SafetyCheck:
    """Return the check of an a0* against a_g S / q (C8.7.1.2.1.7), and against a_Z / q where the site has a floor.

    a_g,SLV = q a0* / S and zeta_E = a_g,SLV / a_g. With a floor both are lessened by what it asks beyond the ground, the spectrum
    being proportional to a_g.
    """
    ground = site.ground_acceleration * site.soil / site.behaviour_factor
    floor = site.floor.acceleration / site.behaviour_factor if site.floor else math.nan
    demand = max(ground, floor) if site.floor else ground
    index, of_stones = found.a0_lumped / demand, found.a0 / demand
    share = found.confidence_factor / CONFIDENCE_FACTOR
    return replace(
        found,
        a_g=site.ground_acceleration,
        soil_factor=site.soil,
        q=site.behaviour_factor,
        demand=ground,
        floor_height=site.floor.height if site.floor else found.floor_height,
        floor_demand=floor if site.floor else found.floor_demand,
        a_g_slv=index * site.ground_acceleration,
        zeta_e=index,
        zeta_e_lc1=found.zeta_e_lc1 if share == 1.0 else share * index,
        satisfied=found.a0_lumped >= demand,
        a_g_slv_stones=of_stones * site.ground_acceleration,
        zeta_e_stones=of_stones,
        satisfied_stones=found.a0 >= demand,
    )


def floor_questions(checks: Iterable[tuple[str, Check | None]]) -> list[str]:
    """Return what to ask about mechanisms that begin above the ground and are compared with its acceleration alone.

    checks: each with the name of its load, the one that leads before the others of this load.
    """
    first: dict[str, SafetyCheck] = {}
    for load, found in checks:
        if isinstance(found, SafetyCheck) and found.satisfied is not None:
            first.setdefault(load, found)
    above = [(load, found.begins) for load, found in first.items() if found.begins >= _ABOVE and math.isnan(found.floor_demand)]
    if not above:
        return []
    heights = ", ".join(
        f"{'what moves ' if n else 'What moves '}under {load} begins {z:.2f} m" for n, (load, z) in enumerate(above)
    )
    return [
        f"{heights} above the foot of the building, which shakes more there than on the ground, and the check is that of the "
        "ground alone: a table [check.floor] adds what the building below does. Is it left out on purpose?"
    ]


def low_floor_questions(checks: Iterable[tuple[str, Check | None]]) -> list[str]:
    """Return what to ask about mechanisms that begin higher than the floor that shakes them, since a_Z grows with its height.

    The foot of the model lies on the foundation or above it, so that Z is no less than where a mechanism begins above that foot.

    checks: each with the name of its load; of variants, too, whose floor may be another.
    """
    low: dict[tuple[str, float], float] = {}
    for load, found in checks:
        if isinstance(found, SafetyCheck) and found.begins - found.floor_height >= _ABOVE:
            key = load, found.floor_height
            low[key] = max(low.get(key, 0.0), found.begins)
    return [
        f"What moves under {load} begins {begins:.2f} m above the foot of the building, and check.floor.height_m is {given:g} m. "
        "The floor of the check shakes less than what moves does, and the check is not safe. Is it meant?"
        for (load, given), begins in low.items()
    ]


def is_horizontal(direction: Sequence[float] | FloatArray) -> bool:
    """Return whether a load (3,) pushes sideways and has no vertical component, without which it stands for no earthquake."""
    return abs(direction[2]) <= 1e-9 and any(direction)


def along(direction: FloatArray, velocities: FloatArray) -> FloatArray:
    """Return the horizontal displacements (..., nb) along a load's direction (3,); velocities (..., nb, 6) or (..., nb, 3).

    Raises
    ------
    InputError: the load is not horizontal, or pushes no weight, so that it stands for no earthquake.
    """
    if not direction.any():
        raise InputError("check", NO_PUSH)
    if not is_horizontal(direction):
        raise InputError("check", "the load is not horizontal", found=np.round(direction, 6).tolist(), expected="no z component")
    return velocities[..., :2] @ direction[:2]
