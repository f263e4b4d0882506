"""The [check] table of a case: what the earthquake asks."""

from pathlib import Path

import pytest

from case_texts import WALL, case_file
from churchpipe.code_check import Floor, Site
from churchpipe.config import read_case, read_variants
from churchpipe.config.plan import plan
from churchpipe.config.settings import site_of
from churchpipe.errors import InputError


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
            "check.floor: out of range; found 9",
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
