"""The schema for editors takes what the reader of cases takes, and the reference page is up to date."""

import json
import tomllib
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from test_cli import call

from churchpipe.config.json_schema import case_schema
from churchpipe.config.overrides import apply_overrides
from churchpipe.config.reference import reference_page
from churchpipe.resources import sample_case, sample_names

SCHEMA = jsonschema.Draft7Validator(case_schema())
PAGE = Path(__file__).parents[2] / "docs" / "reference_case.md"


def messages(table: dict[str, Any]) -> list[str]:
    return [error.message for error in SCHEMA.iter_errors(table)]


@pytest.mark.parametrize("name", sample_names())
def test_every_sample_is_taken(name: str) -> None:
    assert messages(tomllib.loads(sample_case(name))) == []


def test_a_drawing_and_a_case_without_strengths_are_taken() -> None:
    assert messages({"source": {"dxf": "plan.dxf", "support": "base"}, "material": {"tuff": {}}}) == []
    assert messages({"source": {"file": "wall.obj", "up": "y", "scale": 10}, "material": {"tuff": {}}}) == []


@pytest.mark.parametrize(
    "change",
    [
        "source.lenght_m=3",
        "source.length_mm=3200",
        "source.length_m=-1",
        "source.courses=2.5",
        'source.pattern="stacked"',
        "rigid.frow=1",
        "material.default.friction=-1",
        "load=[{direction=[1, 0]}]",
        "source={}",
    ],
)
def test_mistakes_are_marked(change: str) -> None:
    assert messages(apply_overrides(tomllib.loads(sample_case("wall")), [change]))


def test_a_written_case_names_the_schema_beside_it(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert call(capsys, "generate", "wall", "-o", tmp_path / "wall.toml")[0] == 0
    first = (tmp_path / "wall.toml").read_text().splitlines()[0]
    assert first == "#:schema ./case.schema.json"
    assert json.loads((tmp_path / "case.schema.json").read_text()) == case_schema()
    code, out, _ = call(capsys, "schema")
    assert (code, json.loads(out)) == (0, case_schema())


def test_the_reference_page_is_up_to_date() -> None:
    made = "churchpipe schema --markdown > docs/reference_case.md"
    assert PAGE.read_text(encoding="utf-8") == reference_page(), f"make it again: {made}"


def test_check_examines_a_case(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    path.write_text(sample_case("s22_friction"))
    code, out, _ = call(capsys, "check", path)
    assert code == 0
    assert "1 structures" in out
    path.write_text(sample_case("chapel").replace("height_m = 5.0", "height_m = 5.1"))
    code, _, err = call(capsys, "check", path)
    assert code == 1
    assert "source.height_m: not a whole number of courses" in err
