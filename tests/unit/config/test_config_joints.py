"""What a case says of its joints besides friction and cohesion: where friction acts, and at which pressure stones crush."""

from pathlib import Path

import pytest

from case_texts import WALL, case_file
from churchpipe.code_check import Site
from churchpipe.config.case import read_case, read_variants
from churchpipe.config.plan import plan
from churchpipe.config.settings import strengths_of
from churchpipe.errors import InputError

CRUSHING = WALL.replace("friction = 0.6\n", "friction = 0.6\ncompressive_strength_MPa = 1.5\n")


def test_a_strength_in_megapascals(tmp_path: Path) -> None:
    case = read_case(case_file(tmp_path, CRUSHING))
    assert [material.compressive_strength for material in case.materials] == [1.5e6]
    made = plan(read_variants(case_file(tmp_path, CRUSHING + "[rigid]\ncrushing_parts = 6\n")))
    (settings,) = made.analyses.values()
    assert settings["crushing_parts"] == 6
    assert [material.compressive_strength for material in strengths_of(settings)] == [1.5e6]
    (plain,) = plan(read_variants(case_file(tmp_path, WALL))).analyses.values()
    assert "crushing_parts" not in plain
    assert strengths_of(plain)[0].compressive_strength is None


def test_one_contact_model_or_both(tmp_path: Path) -> None:
    made = plan(read_variants(case_file(tmp_path, WALL + '[rigid]\ncontact_model = ["corners", "torsion"]\n')))
    assert list(made.analyses) == ["+y_associative", "+y_associative_torsion"]
    assert [settings.get("contact_model") for settings in made.analyses.values()] == [None, "torsion"]
    made = plan(read_variants(case_file(tmp_path, WALL + '[rigid]\ncontact_model = "torsion"\n')))
    assert list(made.analyses) == ["+y_associative_torsion"]


def test_a_knowledge_level(tmp_path: Path) -> None:
    site = read_case(case_file(tmp_path, WALL + '[check]\na_g_m_s2 = 1.5\nsoil_factor = 1.2\nknowledge_level = "LC2"\n')).check
    assert site == Site(1.5, 1.2, knowledge_level="LC2")
    assert (site.confidence(crushing=True), site.confidence(crushing=False)) == (1.2, 1.35)
    assert Site(1.5, 1.2, confidence_factor=1.1).confidence(crushing=True) == 1.1


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (CRUSHING.replace("1.5", "0"), "material.default.compressive_strength_MPa: wrong value; found 0"),
        (CRUSHING.replace("_MPa", "_kPa"), 'Did you mean "compressive_strength_MPa"?'),
        (WALL + '[rigid]\ncontact_model = "edges"\n', "rigid.contact_model"),
        (WALL + "[rigid]\ncrushing_parts = 5\n", "rigid.crushing_parts"),
        (WALL + '[check]\na_g_m_s2 = 1.5\nsoil_factor = 1.2\nknowledge_level = "LC4"\n', "check.knowledge_level"),
    ],
)
def test_what_is_refused(text: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(InputError) as error:
        read_case(case_file(tmp_path, text))
    assert said in str(error.value)


def test_a_doubtful_strength_is_questioned(tmp_path: Path) -> None:
    made = plan(read_variants(case_file(tmp_path, CRUSHING.replace("1.5", "1500"))))
    assert any("compressive_strength_MPa is 1500 MPa" in question for question in made.index["questions"])


@pytest.mark.parametrize(
    ("group", "said"),
    [
        ('kind = "head"', "joints.0 are those of kind head"),
        ('between = ["wall", "ground"]', "joints.0 are those between wall and ground"),
        ('between = ["wall", "beam on wall"]', ""),
        ("above_m = 0.3", ""),
    ],
)
def test_joints_that_the_shell_has_no_strength_for_are_asked_about_before_a_run(group: str, said: str, tmp_path: Path) -> None:
    beam = '[[ring_beams]]\nwalls = ["wall"]\nheight_m = 0.2\n'
    text = WALL + beam + f'[[joints]]\nname = "weak"\nfriction = 0.3\n{group}\n'
    asked = plan(read_variants(case_file(tmp_path, text + "[shell]\nelement_size_mm = 400\n"))).index["questions"]
    told = [one for one in asked if one.startswith("joints.0 are")]
    assert len(told) == bool(said)
    assert not said or told[0].startswith(said)
    assert plan(read_variants(case_file(tmp_path, text))).index["questions"] == []
