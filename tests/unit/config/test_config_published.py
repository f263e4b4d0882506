"""The [[published]] tables of a case, and the starts of its non-associative iteration."""

import math
from pathlib import Path

import pytest

from case_texts import WALL, case_file
from churchpipe.config.case import read_case, read_variants
from churchpipe.config.plan import plan
from churchpipe.config.published import Published
from churchpipe.errors import InputError
from churchpipe.resources import pipeline_folder

TWO_LOADS = (
    WALL
    + """[[load]]
direction = [1, 0, 0]
name = "along"
[rigid]
flow = ["associative", "non-associative"]
"""
)
CITED = '[[published]]\nload = "+y"\nmodel = "rigid"\nflow = "associative"\nload_factor = 0.5\nsource = "Book, p. 3"\n'


def test_published_values_are_read(tmp_path: Path) -> None:
    measured = '[[published]]\nload = "along"\nmodel = "experiment"\nload_factor = 1.25\nsource = "Test 7"\nfriction = 0.6\n'
    assert read_case(case_file(tmp_path, TWO_LOADS + CITED + measured)).published == (
        Published("+y", "rigid", 0.5, "Book, p. 3", flow="associative"),
        Published("along", "experiment", 1.25, "Test 7", friction=0.6),
    )
    assert read_case(case_file(tmp_path, TWO_LOADS)).published == ()


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            '"+y"',
            '"alnog"',
            'published.0.load: no such load in this case; found alnog; expected one of +y, along. Did you mean "along"?',
        ),
        (
            '"rigid"',
            '"rigid-block"',
            "published.0.model: wrong value; found 'rigid-block'; expected 'rigid', 'shell' or 'experiment'",
        ),
        ('flow = "associative"\n', "", "published.0.flow: missing key"),
        ('"rigid"', '"shell"', "published.0.flow: only rigid blocks have a flow rule; found associative"),
        ("0.5", "0.0", "published.0.load_factor: wrong value; found 0.0"),
        ('source = "Book, p. 3"\n', "", "published.0.source: missing key"),
        ("load_factor", "loadfactor", 'Did you mean "load_factor"?'),
    ],
)
def test_a_published_value_that_fits_nothing(old: str, new: str, said: str, tmp_path: Path) -> None:
    assert old in CITED
    with pytest.raises(InputError) as error:
        read_case(case_file(tmp_path, TWO_LOADS + CITED.replace(old, new)))
    assert said in str(error.value)


def test_published_values_are_no_settings_of_a_solve(tmp_path: Path) -> None:
    without = plan(read_variants(case_file(tmp_path, TWO_LOADS)))
    cited = plan(read_variants(case_file(tmp_path, TWO_LOADS + CITED)))
    assert (cited.analyses, cited.geometries) == (without.analyses, without.geometries)
    assert without.index["published"] == []
    assert cited.index["published"] == [
        {
            "load": "+y",
            "model": "rigid",
            "load_factor": 0.5,
            "source": "Book, p. 3",
            "flow": "associative",
            "friction": None,
        }
    ]


def test_the_church_cites_table_2() -> None:
    cases = pipeline_folder() / "cases"
    cited = {(v.load, v.model, v.flow): v.load_factor for v in read_case(cases / "church.toml").published}
    assert cited == {
        ("+x", "rigid", "associative"): 0.221,
        ("+x", "rigid", "non-associative"): 0.201,
        ("+x", "shell", None): 0.210,
        ("-y", "rigid", "associative"): 0.237,
        ("-y", "rigid", "non-associative"): 0.224,
        ("-y", "shell", None): 0.229,
        ("tower +x", "rigid", "non-associative"): 0.339,
        ("tower +x", "shell", None): 0.345,
    }
    assert all(read_variants(path) for path in cases.glob("*.toml"))


def test_tolerances_of_joints_touch_the_contacts_alone(tmp_path: Path) -> None:
    path = case_file(tmp_path, TWO_LOADS)
    asked = ["rigid.contact_gap_mm=12", "rigid.contact_angle_deg=2", "rigid.overlap_mm=3"]
    wide, proposed = plan(read_variants(path, asked)), plan(read_variants(path))
    assert wide.contacts["base"] == pytest.approx({"contact_gap": 0.012, "contact_angle": math.radians(2), "overlap": 0.003})
    assert proposed.contacts["base"] == {}
    assert (wide.geometries, wide.analyses) == (proposed.geometries, proposed.analyses)
    with pytest.raises(InputError, match=r"rigid\.contact_gap_mm"):
        read_case(path, ["rigid.contact_gap_mm=0"])


def test_starts_of_the_iteration(tmp_path: Path) -> None:
    path = case_file(tmp_path, TWO_LOADS)
    assert read_case(path).rigid.start is None
    assert read_case(path, ["rigid.start=uniform"]).rigid.start == ("uniform",)
    both = ['rigid.start=["associative", "uniform"]', "rigid.bipotential_gap=1e-4"]
    assert read_case(path, both).rigid.start == ("associative", "uniform")
    settings = plan(read_variants(path, both)).analyses
    assert settings["+y_non-associative"]["start"] == ["associative", "uniform"]
    assert settings["+y_non-associative"]["bipotential_gap"] == 1e-4
    assert settings["+y_associative"] == plan(read_variants(path)).analyses["+y_associative"]
    for override, said in (
        (
            "rigid.start=cold",
            "rigid.start.0: wrong value; found 'cold'; expected 'centre', 'dead-load', 'uniform', 'associative' or 'scattered'",
        ),
        ("rigid.start=[]", "rigid.start: wrong value"),
        ("rigid.bipotential_gap=0", "rigid.bipotential_gap: wrong value"),
        ("rigid.bipotential_gap=1", "rigid.bipotential_gap: wrong value"),
    ):
        with pytest.raises(InputError) as error:
            read_case(path, [override])
        assert said in str(error.value)
