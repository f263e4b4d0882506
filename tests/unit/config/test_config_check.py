"""The [check] table of a case: what the earthquake asks."""

from pathlib import Path

import pytest

from case_texts import WALL, case_file
from churchpipe.code_check import Floor, Site
from churchpipe.config.case import read_case, read_variants
from churchpipe.config.plan import plan
from churchpipe.config.settings import site_of
from churchpipe.errors import InputError
from churchpipe.spectrum import Spectrum, StoreySpectrum, TabulatedSpectrum


def test_the_check_is_read_in_either_unit(tmp_path: Path) -> None:
    text = WALL + "[check]\na_g_m_s2 = 1.5\nsoil_factor = 1.2\n"
    assert read_case(case_file(tmp_path, text)).check == Site(1.5, 1.2, 2.0, 1.35)
    text = WALL + "[check]\nag_g = 0.15\nsoil_factor = 1.2\nq = 1.5\nconfidence_factor = 1.2\n"
    assert read_case(case_file(tmp_path, text)).check == Site(0.15 * 9.80665, 1.2, 1.5, 1.2)
    floor = "[check.floor]\nheight_m = 6\nbuilding_height_m = 12.0\nstoreys = 2\nspectral_acceleration_g = 0.5\n"
    site = read_case(case_file(tmp_path, text + floor)).check
    assert site is not None
    assert site.floor == Floor(6, 12, 2, 0.5 * 9.80665, 5.0)
    assert read_case(case_file(tmp_path, WALL)).check is None


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("soil_factor = 1.2", "check: missing key; expected either a_g_m_s2 or ag_g"),
        ("soil_factor = 1.2\na_g_m_s2 = 1.5\nag_g = 0.15", "check: two values for one acceleration"),
        ("a_g_m_s2 = 1.5", "check.soil_factor: missing key"),
        ("a_g_m_s2 = 1.5\nsoil_factor = 0", "check.soil_factor: wrong value; found 0"),
        ("a_g_m_s2 = 1.5\nsoil_factor = 1.2\nq = 0.5", "check.q: wrong value; found 0.5"),
        ("a_g_m_s2 = 1.5\nsoil_factor = 1.2\nconfidence_factor = 0.9", "check.confidence_factor: wrong value; found 0.9"),
        ("a_g_m_s2 = 1.5\nsoil_faktor = 1.2", 'Did you mean "soil_factor"?'),
        (
            "a_g_m_s2 = 1.5\nsoil_factor = 1.2\nfloor = { height_m = 9, building_height_m = 8, storeys = 1, "
            "spectral_acceleration_m_s2 = 3 }",
            "check.floor.height_m: out of range; found 9",
        ),
    ],
)
def test_a_check_that_cannot_be_made(text: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(InputError) as error:
        read_case(case_file(tmp_path, f"{WALL}[check]\n{text}\n"))
    assert said in str(error.value)


def test_the_check_is_no_setting_of_a_solve(tmp_path: Path) -> None:
    without = plan(read_variants(case_file(tmp_path, WALL)))
    made = plan(read_variants(case_file(tmp_path, WALL + "[check]\na_g_m_s2 = 1.5\nsoil_factor = 1.2\n")))
    assert (made.analyses, made.geometries) == (without.analyses, without.geometries)
    assert site_of(made.index["analyses"][0]["check"]) == Site(1.5, 1.2)


SPECTRUM = "[check]\na_g_m_s2 = 1.5\n{check}\n[check.spectrum]\n{spectrum}\n"


def spectrum_case(tmp_path: Path, check: str, spectrum: str) -> Site:
    case = read_case(case_file(tmp_path, WALL + SPECTRUM.format(check=check, spectrum=spectrum)))
    assert case.check is not None
    assert site_of(plan([case]).index["analyses"][0]["check"]) == case.check
    return case.check


def test_the_spectrum_by_its_formula_and_by_a_table(tmp_path: Path) -> None:
    site = spectrum_case(tmp_path, "", 'F0 = 2.5\nTC_star_s = 0.3\nsoil = "C"\ntopography = "T2"')
    assert site.demand == Spectrum(2.5, 0.3, "C", "T2")
    assert site.soil == pytest.approx(min(1.7 - 0.6 * 2.5 * 1.5 / 9.80665, 1.5) * 1.2)
    site = spectrum_case(tmp_path, "soil_factor = 1.2", "F0 = 2.5\nTC_star_s = 0.3")
    assert site.demand == Spectrum(2.5, 0.3, soil_factor=1.2)
    site = spectrum_case(tmp_path, "soil_factor = 1.2", "periods_s = [0.0, 0.5, 2.0]\naccelerations_m_s2 = [1.8, 4.5, 1.0]")
    assert site.demand == TabulatedSpectrum((0.0, 0.5, 2.0), (1.8, 4.5, 1.0), 1.5)


def test_a_storey_shaken_in_proportion_to_the_ground(tmp_path: Path) -> None:
    text = "F0 = 2.5\nTC_star_s = 0.3\n[check.floor]\nheight_m = 6\nbuilding_height_m = 12\nstoreys = 2\n"
    period = "spectral_acceleration_m_s2 = 3.0\nfirst_period_s = 0.4"
    site = spectrum_case(tmp_path, "soil_factor = 1.2", text + period)
    assert site.floor is not None
    assert site.demand == StoreySpectrum(Spectrum(2.5, 0.3, soil_factor=1.2), 0.4, site.floor.acceleration / 1.5)
    assert spectrum_case(tmp_path, "soil_factor = 1.2", text + "spectral_acceleration_m_s2 = 3.0").demand is None


@pytest.mark.parametrize(
    ("check", "spectrum", "said"),
    [
        ("", "F0 = 2.5\nTC_star_s = 0.3", "check.soil_factor: missing key; expected either soil_factor or soil"),
        ("soil_factor = 1.2", 'F0 = 2.5\nTC_star_s = 0.3\nsoil = "B"', "check.soil_factor: a factor given twice"),
        ("soil_factor = 1.2", "F0 = 2.5", "check.spectrum: neither formula nor table"),
        ("", 'F0 = 2.5\nTC_star_s = 0.3\nsoil = "F"', "check.spectrum.soil: wrong value; found 'F'"),
        ("soil_factor = 1.2", "F0 = 0\nTC_star_s = 0.3", "check.spectrum.F0: wrong value; found 0"),
        ("soil_factor = 1.2", "F0 = 2.5\nTC_star = 0.3", 'Did you mean "TC_star_s"?'),
        ("soil_factor = 1.2", "periods_s = [0.5, 0.5]\naccelerations_m_s2 = [1, 2]", "not rising"),
        ("soil_factor = 1.2", "periods_s = [0.0, 0.5]\naccelerations_m_s2 = [1]", "wrong shape"),
        (
            "soil_factor = 1.2",
            "periods_s = [0.0, 0.5, 2.0]\naccelerations_m_s2 = [1, 2]",
            "check.spectrum.accelerations_m_s2: wrong shape; found 2; expected one for each of the 3 periods",
        ),
        ("soil_factor = 1.2", "periods_s = []\naccelerations_m_s2 = [1]", "check.spectrum.periods_s: not rising; found []"),
        ("soil_factor = 1.2", "periods_s = [1, 0]\naccelerations_m_s2 = [1, 2]", "check.spectrum.periods_s: not rising"),
        ("soil_factor = 1.2", "F0 = 1e-300\nTC_star_s = 0.3", "check.spectrum.F0: lost to rounding; found 1e-300"),
        ("soil_factor = 1.2", "F0 = 2.5\nTC_star_s = 1e-300", "check.spectrum.TC_star_s: lost to rounding; found 1e-300"),
    ],
)
def test_a_spectrum_that_says_too_little_or_too_much(check: str, spectrum: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(InputError) as error:
        spectrum_case(tmp_path, check, spectrum)
    assert said in str(error.value)


def test_a_mechanism_above_the_building_is_said_by_its_key(tmp_path: Path) -> None:
    floor = "[check.floor]\nheight_m = 13\nbuilding_height_m = 12\nstoreys = 2\nspectral_acceleration_m_s2 = 5\n"
    with pytest.raises(InputError) as error:
        read_case(case_file(tmp_path, f"{WALL}[check]\na_g_m_s2 = 1.5\nsoil_factor = 1.2\n{floor}"))
    said = "check.floor.height_m: out of range; found 13.0; expected from 0 to the building_height_m of 12 m."
    assert said in str(error.value)
