"""Spectra of the ground (NTC 2018, 3.2.3.2.1) and of a storey (Circolare 7/2019, C7.2.3)."""

import math
from dataclasses import replace
from typing import Any

import pytest

from churchpipe.errors import InputError
from churchpipe.model.quantities import GRAVITY
from churchpipe.spectrum import SiteSpectrum, Spectrum, StoreySpectrum, TabulatedSpectrum, spectral_displacement

SITE = Spectrum(2.5, 0.5, soil_factor=1.2)


@pytest.mark.parametrize(
    ("soil", "topography", "ground", "factor", "end"),
    [
        ("A", "T1", 0.25, 1.0, 0.3),
        ("B", "T1", 0.25, 1.4 - 0.4 * 2.5 * 0.25, 1.1 * 0.3**0.8),
        ("C", "T2", 0.05, 1.5 * 1.2, 1.05 * 0.3**0.67),
        ("D", "T1", 0.5, 0.9, 1.25 * 0.3**0.5),
        ("E", "T4", 0.25, (2.0 - 1.1 * 2.5 * 0.25) * 1.4, 1.15 * 0.3**0.6),
    ],
)
def test_soils(soil: str, topography: str, ground: float, factor: float, end: float) -> None:
    spectrum = Spectrum(2.5, 0.3, soil, topography)
    made = spectrum.parameters(ground * GRAVITY)
    assert (made.soil_factor, made.plateau_end) == pytest.approx((factor, end))
    # S = S_S S_T, T_C = C_C TC*, T_B = T_C / 3, T_D = 4 a_g/g + 1.6 [3.2.3.2.1].
    share = {"T1": 1.0, "T2": 1.2, "T4": 1.4}[topography]
    assert (made.stratigraphic, made.topographic) == pytest.approx((factor / share, share))
    assert made.period_factor == pytest.approx(end / 0.3)
    assert (made.rising_end, made.velocity_end) == pytest.approx((end / 3, 4 * ground + 1.6))


def test_a_soil_factor_that_is_given_leaves_the_periods_those_of_rock() -> None:
    made = SITE.parameters(2.0)
    assert (made.stratigraphic, made.topographic, made.soil_factor, made.period_factor) == (None, None, 1.2, 1.0)
    assert (made.rising_end, made.plateau_end) == (0.5 / 3, 0.5)


def test_the_branches_of_the_spectrum_meet() -> None:
    for period in (0.5 / 3, 0.5, 1.6 + 4 * 2.0 / GRAVITY):
        below, above = (SITE.acceleration(period * (1 + sign * 1e-9), 2.0, 8.0) for sign in (-1, 1))
        assert below == pytest.approx(above, rel=1e-6)
    assert SITE.acceleration(0.0, 2.0, 5.0) == pytest.approx(2.4)
    assert SITE.acceleration(0.3, 2.0, 5.0) == pytest.approx(6.0)


def test_a_table_of_points() -> None:
    table = TabulatedSpectrum((0.0, 0.1, 0.5, 2.0), (2.0, 5.0, 5.0, 1.0), ground=2.0)
    assert table.acceleration(0.05, 2.0, 5.0) == pytest.approx(3.5)
    # It grows with a_g and falls with the damping, but for that of the ground itself.
    assert table.acceleration(0.3, 1.0, 10.0) == pytest.approx(2.5 * math.sqrt(10 / 15))
    assert table.acceleration(0.0, 2.0, 10.0) == pytest.approx(2.0)
    # Beyond the last point the displacement stays.
    assert spectral_displacement(table, 5.0, 2.0, 5.0) == pytest.approx(spectral_displacement(table, 2.0, 2.0, 5.0))


def test_a_storey() -> None:
    storey = StoreySpectrum(SITE, first_period=0.4, peak=3.6, damping=5.0)
    peak = 3.6 * 2.0
    # Stiff parts have the acceleration of the storey, those in tune with the building 1.1 xi^-1/2 eta times that.
    assert storey.acceleration(0.0, 2.0, 5.0) == pytest.approx(peak)
    assert storey.acceleration(0.4, 2.0, 5.0) == pytest.approx(peak * 1.1 / math.sqrt(0.05))
    assert storey.acceleration(0.4, 2.0, 8.0) == pytest.approx(peak * 1.1 / math.sqrt(0.05) * math.sqrt(10 / 13))
    for edge in (0.8 * 0.4, 1.1 * 0.4):
        assert storey.acceleration(edge * (1 - 1e-9), 2.0, 8.0) == pytest.approx(
            storey.acceleration(edge * (1 + 1e-9), 2.0, 8.0), rel=1e-5
        )
    # At twice the upper end: most / (1 + most - 1) = 1.
    assert storey.acceleration(2.2 * 0.4, 2.0, 5.0) == pytest.approx(max(peak, SITE.acceleration(0.88, 2.0, 5.0)))
    # Slow parts are shaken by the ground at least.
    assert storey.acceleration(6.0, 2.0, 8.0) >= SITE.acceleration(6.0, 2.0, 8.0)


def test_bad_input() -> None:
    with pytest.raises(InputError, match="soil: unknown value; found Z"):
        Spectrum(2.5, 0.5, "Z")
    with pytest.raises(InputError, match="topography: unknown value"):
        Spectrum(2.5, 0.5, "A", "T9")
    with pytest.raises(InputError, match="amplification: out of range"):
        Spectrum(0.0, 0.5)
    with pytest.raises(InputError, match="period: not rising"):
        TabulatedSpectrum((0.0, 0.5, 0.5), (1.0, 1.0, 1.0), 1.0)
    with pytest.raises(InputError, match="level: wrong shape"):
        TabulatedSpectrum((0.0, 0.5), (1.0,), 1.0)
    with pytest.raises(InputError, match="level: out of range"):
        TabulatedSpectrum((0.0, 0.5), (1.0, 0.0), 1.0)
    with pytest.raises(InputError, match="first_period: out of range"):
        StoreySpectrum(SITE, 0.0, 3.0)
    with pytest.raises(InputError, match="peak: out of range"):
        StoreySpectrum(SITE, 0.4, -1.0)


def test_a_spectrum_given_by_a_case() -> None:
    assert SiteSpectrum(2.5, 0.5).of(2.0, 1.2) == SITE
    assert SiteSpectrum(2.5, 0.5, "C", "T2").of(2.0, None) == Spectrum(2.5, 0.5, "C", "T2")
    table = SiteSpectrum(period=(0.0, 1.0), level=(2.0, 3.0))
    assert table.of(2.0, 1.2) == TabulatedSpectrum((0.0, 1.0), (2.0, 3.0), 2.0)


@pytest.mark.parametrize(
    "given",
    [
        {},
        {"amplification": 2.5},
        {"amplification": 2.5, "period": (0.0, 1.0)},
        {"period": (0.0, 1.0)},
        {"amplification": 2.5, "start": 0.5, "period": (0.0, 1.0), "level": (1.0, 1.0)},
    ],
)
def test_half_a_spectrum(given: dict[str, Any]) -> None:
    with pytest.raises(InputError, match="neither formula nor table, or parts of both"):
        SiteSpectrum(**given)
    with pytest.raises(InputError, match="soil: given with a table"):
        SiteSpectrum(period=(0.0, 1.0), level=(1.0, 1.0), soil="B")


def test_a_topography_that_nothing_would_heed() -> None:
    # S of [check] has the topography in it, and so has a table.
    for given in (SiteSpectrum(2.5, 0.5), SiteSpectrum(period=(0.0, 1.0), level=(1.0, 1.0))):
        with pytest.raises(InputError, match="topography: given without soil; found T4"):
            replace(given, topography="T4")


def test_a_storey_on_the_ground_is_shaken_as_the_ground() -> None:
    storey = StoreySpectrum(SITE, first_period=0.4, peak=0.0)
    assert storey.acceleration(0.4, 2.0, 5.0) == SITE.acceleration(0.4, 2.0, 5.0)
