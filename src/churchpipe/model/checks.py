"""The safety checks of a mechanism and of a capacity curve as data, declared once: SI here, units in the keys of summary.json.

`code_check` and `displacement_check` make them. Unless a name says otherwise, figures are of e* = 1, all that moves one body: the
careful ones. Those that end in `_stones` are of the e* of the stones, each lumped at its centroid.
"""

import math
from dataclasses import dataclass, field
from typing import Annotated, Literal

from churchpipe.model.quantities import Quantity

_Acceleration = Annotated[float, Quantity("_m_s2")]
_Length = Annotated[float, Quantity("_m")]
_Lengths = Annotated[tuple[float, ...], Quantity("_m")]
_Accelerations = Annotated[tuple[float, ...], Quantity("_m_s2")]

# How a check ends what it says of a curve that is another one with steps half as long.
UNRELIABLE = "no single curve is to be relied on"


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """What both checks have in common; NaN and None where the case does not say what the earthquake asks.

    message: why there is no check, "" where there is one. alpha0: load factor as a multiplier of all weights that move.
    moving_weight: N of these. confidence_factor: FC. mass_fraction: e* of the stones. participating_mass: M*, kg, with it.
    a_g: ground acceleration of the site. a_g_slv: the one that the mechanism withstands; zeta_e: their ratio, capacity over
    demand.
    """

    message: str = ""
    alpha0: float = math.nan
    moving_weight: Annotated[float, Quantity("_kN")] = math.nan
    confidence_factor: float = math.nan
    mass_fraction: float = math.nan
    participating_mass: Annotated[float, Quantity("_t")] = math.nan
    a_g: _Acceleration = math.nan
    a_g_slv: _Acceleration = math.nan
    zeta_e: float = math.nan
    satisfied: bool | None = None
    a_g_slv_stones: _Acceleration = math.nan
    zeta_e_stones: float = math.nan
    satisfied_stones: bool | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class SafetyCheck(Check):
    """The check of the ultimate limit state with a behaviour factor.

    a0: spectral acceleration a0* that activates the mechanism, with e* of the stones; a0_lumped: alpha0 g / FC, with e* = 1,
    which is never larger. moving_stones: their number; begins: height of the lowest corner of them above that of the building.
    demand: a_g S / q; floor_height: Z that the case gives for a mechanism above the ground; floor_demand: a_Z / q.
    zeta_e_lc1: zeta_e with the confidence factor of the lowest knowledge level, where FC is another.
    """

    a0_lumped: _Acceleration = math.nan
    a0: _Acceleration = math.nan
    moving_stones: int | None = None
    begins: _Length = math.nan
    soil_factor: float = math.nan
    q: float = math.nan
    demand: _Acceleration = math.nan
    floor_height: _Length = math.nan
    floor_demand: _Acceleration = math.nan
    zeta_e_lc1: float = math.nan


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitStateCheck:
    """A limit state: the displacement and acceleration of the oscillator there, its secant period s, its damping, the spectral
    displacement that the site asks, the ground acceleration that is withstood, and what governs that."""

    displacement: _Length
    acceleration: _Acceleration
    period: Annotated[float, Quantity("_s")]
    damping_percent: float
    demand: _Length
    a_g: _Acceleration
    governed: Literal["displacement", "onset"]


@dataclass(frozen=True, slots=True, kw_only=True)
class SpectrumParameters:
    """What makes the elastic spectrum of the ground at one a_g, by the letters of NTC 2018, 3.2.3.2.1.

    amplification: F0; start: TC*, s; stratigraphic, topographic: S_S and S_T, None where the case gives their product alone;
    soil_factor: that, S; period_factor: C_C; rising_end, plateau_end, velocity_end: T_B, T_C and T_D, s, where the branches end.
    """

    amplification: Annotated[float, Quantity(key="F0")]
    start: Annotated[float, Quantity(key="TC_star_s")]
    stratigraphic: Annotated[float | None, Quantity(key="S_S")] = None
    topographic: Annotated[float | None, Quantity(key="S_T")] = None
    soil_factor: Annotated[float, Quantity(key="S")]
    period_factor: Annotated[float, Quantity(key="C_C")]
    rising_end: Annotated[float, Quantity(key="T_B_s")]
    plateau_end: Annotated[float, Quantity(key="T_C_s")]
    velocity_end: Annotated[float, Quantity(key="T_D_s")]


@dataclass(frozen=True, slots=True, kw_only=True)
class DemandCurve:
    """Spectral displacements (n,) and accelerations (n,) that the site asks with a damping."""

    displacement: _Lengths
    acceleration: _Accelerations


@dataclass(frozen=True, slots=True, kw_only=True)
class DisplacementCheck(Check):
    """The displacement-based check of a capacity curve.

    a0: where the motion starts; d0: displacement at which the acceleration vanishes. displacement, acceleration (n,): of the
    oscillator. a_g_slc: capacity of SLC. d0_stones, a_g_slc_stones: d0 and a_g_slc with e* of the stones. idealised_d0,
    a_g_slv_idealised: d0 and capacity of SLV of the two straight lines of the same area. missing: what the case does not say.
    unproved: which steps of the curve are not proved, and what the check makes of them. lost_seat: which joist loses its seat
    first, and where, if one does. halved: what steps half as long make of it. limit_states, demand: by the names SLV and SLC.
    spectrum: its parameters at a_g, None of a table. force_based: the check with q of the mechanism that starts the curve.
    governs: which one, and why. collapse_first: what makes a_g_slc smaller than a_g_slv, if it is.
    """

    a0: _Acceleration = math.nan
    d0: _Length = math.nan
    d0_stones: _Length = math.nan
    displacement: _Lengths = field(default=(), repr=False)
    acceleration: _Accelerations = field(default=(), repr=False)
    idealised_d0: _Length = math.nan
    missing: str = ""
    unproved: str = ""
    halved: str = ""
    lost_seat: str = ""
    limit_states: dict[str, LimitStateCheck] = field(default_factory=dict[str, LimitStateCheck])
    a_g_slc: _Acceleration = math.nan
    a_g_slc_stones: _Acceleration = math.nan
    a_g_slv_idealised: _Acceleration = math.nan
    force_based: SafetyCheck | None = None
    governs: str = ""
    collapse_first: str = ""
    spectrum: SpectrumParameters | None = None
    demand: dict[str, DemandCurve] = field(default_factory=dict[str, DemandCurve], repr=False)

    @property
    def said(self) -> list[str]:
        """The sentences of the check, those that there are."""
        every = self.unproved, self.halved, self.lost_seat, self.governs, self.collapse_first
        return [sentence for sentence in every if sentence]
