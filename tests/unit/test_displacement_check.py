"""The displacement-based check of Circolare 7/2019, C8.7.1.2.1.

Free rigid blocks b x h, FC 1.35, S 1.2, F0 2.5, TC* .5 s, damping 8 %: a_g,SLV of the displacement-based check, and of the check
with q = 2, m/s2: computed for this project from the formulas of the circular.
"""

import math

import numpy as np
import pytest

from churchpipe.code_check import GRAVITY
from churchpipe.displacement_check import Oscillator, Spectrum, capacity, oscillator
from churchpipe.errors import InputError
from churchpipe.model.arrays import FloatArray

SITE = Spectrum(2.5, 0.5, soil_factor=1.2)


def rocking(breadth: float, height: float) -> tuple[FloatArray, FloatArray]:
    displacement = np.linspace(0, breadth / 2, 2001)
    lever = breadth / 2 - displacement
    return displacement, lever / np.sqrt((breadth**2 + height**2) / 4 - lever**2)


def block(breadth: float, height: float) -> Oscillator:
    displacement, load_factor = rocking(breadth, height)
    return oscillator(displacement, load_factor, breadth / 2, np.array([1.0]), np.array([1.0]))


@pytest.mark.parametrize(
    ("breadth", "height", "nonlinear", "linear"),
    [(0.3, 3, 0.918, 1.211), (0.5, 4, 1.386, 1.513), (0.9, 9, 2.173, 1.211), (0.9, 12, 2.173, 0.908), (1.2, 14, 2.676, 1.038)],
)
def test_free_blocks(breadth: float, height: float, nonlinear: float, linear: float) -> None:
    assert capacity(block(breadth, height), SITE).ground == pytest.approx(nonlinear, abs=6e-4)
    assert 2 * breadth / height * GRAVITY / (1.35 * 1.2) == pytest.approx(linear, abs=6e-4)


def test_limit_states_by_hand() -> None:
    found = capacity(block(0.5, 4), SITE)
    assert found.displacement == pytest.approx(0.4 * 0.25)
    level = 0.15 / math.sqrt(0.25**2 + 4 - 0.15**2) * GRAVITY / 1.35
    assert found.acceleration == pytest.approx(level, rel=1e-5)
    assert found.period == pytest.approx(1.68 * math.pi * math.sqrt(0.1 / level), rel=1e-5)
    assert found.governed == "displacement"
    assert SITE.displacement(found.period, found.ground, 8.0) == pytest.approx(found.displacement, rel=1e-9)
    collapse = capacity(block(0.5, 4), SITE, "SLC")
    assert collapse.displacement == pytest.approx(0.6 * 0.25)
    assert collapse.ground > found.ground


def test_one_body_as_many_stones() -> None:
    # Twenty courses: e* = 3 n^2/(4 n^2 - 1); the spectral displacement is that at three quarters of the height's mean.
    courses = np.arange(20) + 0.5
    displacement, load_factor = rocking(0.5, 4)
    many = oscillator(displacement, load_factor, 0.25, np.ones(20), courses)
    fraction = 3 * 400 / (4 * 400 - 1)
    assert many.ultimate == pytest.approx(0.25 / fraction)
    assert many.acceleration[0] == pytest.approx(0.125 * GRAVITY / (fraction * 1.35))


def test_stones_that_stand_still_and_loads_on_a_part() -> None:
    # Half of the weight moves: the mean displacement of all is half that of the moving half.
    displacement, load_factor = rocking(0.5, 4)
    still = oscillator(0.5 * displacement, load_factor, 0.125, np.ones(2), np.array([1.0, 0.0]))
    assert still.ultimate == pytest.approx(0.25)
    assert still.acceleration[0] == pytest.approx(0.125 * GRAVITY / 1.35)
    # Only one of two moving halves is pushed: alpha0 counts half as much.
    part = oscillator(displacement, load_factor, 0.25, np.ones(2), np.ones(2), pushed=np.array([1.0, 0.0]))
    assert part.ultimate == pytest.approx(0.25)
    assert part.acceleration[0] == pytest.approx(0.5 * 0.125 * GRAVITY / 1.35)


def test_a_loss_of_connections_limits_the_displacement() -> None:
    displacement = np.array([0, 0.05, 0.06, 0.2, 0.3])
    curve = oscillator(displacement, np.array([0.2, 0.19, 0.08, 0.05, 0.0]), 0.3, np.ones(1), np.ones(1))
    assert curve.loss == pytest.approx(0.05)
    assert capacity(curve, SITE).displacement == pytest.approx(0.05)
    assert capacity(curve, SITE, "SLC").displacement == pytest.approx(0.18)


def test_what_does_not_even_start_to_move() -> None:
    # A small model has little displacement: the onset governs.
    found = capacity(block(0.03, 0.3), SITE)
    assert found.governed == "onset"
    assert found.ground == pytest.approx(0.1 * GRAVITY / (1.35 * 1.2), rel=1e-6)


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
    assert spectrum.soil_amplification(ground * GRAVITY) == pytest.approx(factor)
    assert spectrum.plateau_end == pytest.approx(end)


def test_the_branches_of_the_spectrum_meet() -> None:
    for period in (0.5 / 3, 0.5, 1.6 + 4 * 2.0 / GRAVITY):
        below, above = (SITE.acceleration(period * (1 + sign * 1e-9), 2.0, 8.0) for sign in (-1, 1))
        assert below == pytest.approx(above, rel=1e-6)
    assert SITE.acceleration(0.0, 2.0, 5.0) == pytest.approx(2.4)
    assert SITE.acceleration(0.3, 2.0, 5.0) == pytest.approx(6.0)


def test_bad_input() -> None:
    displacement, load_factor = rocking(0.5, 4)
    one = np.ones(1)
    with pytest.raises(InputError, match="d0: the curve does not come to its end"):
        oscillator(displacement, load_factor, math.nan, one, one)
    with pytest.raises(InputError, match="does not go along its load"):
        oscillator(displacement, load_factor, 0.25, one, -one)
    with pytest.raises(InputError, match="load_factor: wrong shape"):
        oscillator(displacement, load_factor[:-1], 0.25, one, one)
    with pytest.raises(InputError, match="soil: unknown value; found Z"):
        Spectrum(2.5, 0.5, "Z")
    with pytest.raises(InputError, match="topography: unknown value"):
        Spectrum(2.5, 0.5, "A", "T9")
    with pytest.raises(InputError, match="amplification: out of range"):
        Spectrum(0.0, 0.5)
    with pytest.raises(InputError, match="limit: unknown limit state"):
        capacity(block(0.5, 4), SITE, "SLD")
