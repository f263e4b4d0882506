"""The schema for editors takes what the reader of cases takes, and the reference page is up to date."""

import json
import re
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest

from churchpipe import generators
from churchpipe.config.json_schema import case_schema
from churchpipe.config.overrides import apply_overrides
from churchpipe.config.reference import reference_page
from churchpipe.dxf.writer import write_dxf
from churchpipe.errors import InputError
from churchpipe.model.carried import LineLoad, PointLoad
from churchpipe.model.quantities import declared
from churchpipe.resources import sample_case, sample_names
from churchpipe.stones.blocks import derive_blocks
from command_line import call

SCHEMA = jsonschema.Draft7Validator(case_schema())
PAGE = Path(__file__).parents[3] / "docs" / "reference_case.md"


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


def test_an_imported_case_names_the_schema_and_stands_up_to_it(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    odd = 'granite "A" [x]'
    wall = derive_blocks(generators.wall(length=0.4, courses=1, brick=(0.2, 0.1, 0.1)))
    stones = replace(wall, material=np.full(wall.count, odd))
    write_dxf(stones, tmp_path / "a.dxf")
    assert call(capsys, "import-dxf", tmp_path / "a.dxf", "-o", tmp_path / "a", "--load", "+x")[0] == 0
    text = (tmp_path / "a" / "case.toml").read_text()
    assert text.splitlines()[0] == "#:schema ./case.schema.json"
    assert json.loads((tmp_path / "a" / "case.schema.json").read_text()) == case_schema()
    table = tomllib.loads(text)
    assert table["material"] == {odd: {"cohesion_kPa": 0}}
    for key in ("unit_weight_kN_m3", "friction"):
        assert f"# {key} =    # not in the drawing: fill it in\n" in text
    table["material"][odd] |= {"unit_weight_kN_m3": 20, "friction": 0.6}
    assert not messages(table)


def test_the_reference_page_is_up_to_date() -> None:
    made = "churchpipe schema --markdown > docs/reference_case.md"
    assert PAGE.read_text(encoding="utf-8") == reference_page(), f"make it again: {made}"


def test_keys_of_places_along_a_wall_say_from_where_they_are_measured() -> None:
    rows = re.findall(
        r"^\| `(along_m|from_m|centre_mm|start_mm)` \| (.*?) \|", PAGE.read_text(encoding="utf-8"), flags=re.MULTILINE
    )
    assert {key for key, _ in rows} == {"along_m", "from_m", "centre_mm", "start_mm"}
    # The line of a wall of a house begins at a point of the plan.
    for key, meaning in [row for row in rows if not row[1].startswith("x and y of")]:
        words = "not from the end of the wall as `along_m`" if key == "centre_mm" else "end with the smaller x"
        assert words in meaning, f"{key}: {meaning}"


def test_the_place_of_a_point_load_has_no_default() -> None:
    along = {kind: declared(kind)[name].meaning for kind, name in ((LineLoad, "begin"), (PointLoad, "along"))}
    assert along[LineLoad].endswith("by default its own end.")
    assert along[PointLoad].endswith("needed with `wall`.")
    with pytest.raises(InputError, match="no place on the wall"):
        PointLoad("north", dead=1e3)


def test_check_examines_a_case(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    path.write_text(sample_case("s22_friction"))
    code, out, _ = call(capsys, "check", path)
    assert code == 0
    assert "1 structure," in out
    path.write_text(sample_case("chapel").replace("height_m = 5.0", "height_m = 5.1"))
    code, _, err = call(capsys, "check", path)
    assert code == 1
    assert "source.height_m: not a whole number of courses" in err


def test_every_key_has_a_meaning() -> None:
    """Each is declared with a sentence; the tables of the reference and the hints of editors show it."""
    schema = case_schema()
    tables = {"the whole file": schema} | schema["$defs"]
    missing = [
        f"{name}.{key}"
        for name, table in tables.items()
        for key, value in table["properties"].items()
        if not value.get("description")
    ]
    assert not missing
