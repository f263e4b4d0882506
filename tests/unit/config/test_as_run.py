"""as-run.toml: the case as it was run runs again, from anywhere."""

import tomllib
from pathlib import Path

import pytest

from churchpipe.config.asrun import as_run
from churchpipe.config.case import Drawing, read_case, read_variants
from churchpipe.config.case_file import read_table
from churchpipe.config.overrides import apply_overrides
from churchpipe.resources import sample_case, sample_names

TEXT = """name = "mill"
[source]   # or: dxf = "other.dxf"
dxf = 'walls/mill.dxf'
[material."old brick"]
unit_weight_kN_m3 = 18.0
friction = 0.6
[[load]]
direction = [1, 0, 0]
name = 'to the "west"'
[rigid]
flow = ["associative", "non-associative"]
[sweep]
"material.old brick.friction" = [0.5, 0.6]
"rigid.start" = ["associative", "uniform"]
"""


@pytest.fixture
def case(tmp_path: Path) -> Path:
    path = tmp_path / "here" / "case.toml"
    path.parent.mkdir()
    path.write_text(TEXT)
    return path


def elsewhere(tmp_path: Path, text: str) -> Path:
    (tmp_path / "runs").mkdir(exist_ok=True)
    path = tmp_path / "runs" / "as-run.toml"
    path.write_text(text)
    return path


def test_the_text_is_kept_and_the_drawing_found(case: Path, tmp_path: Path) -> None:
    text = as_run(case, ())
    drawing = (case.parent / "walls" / "mill.dxf").as_posix()
    assert text == TEXT.replace("'walls/mill.dxf'", f'"{drawing}"')
    source = read_case(elsewhere(tmp_path, text)).source
    assert isinstance(source, Drawing)
    assert source.path == Path(drawing)


CHANGES = ["load.0.direction=[0, 0, 1]", "material.default.friction=0.55", "rigid.start=uniform", "shell.element_size_mm=250"]


@pytest.mark.parametrize("name", sample_names())
def test_it_says_what_the_case_with_its_changes_says(name: str, tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    path.write_text(sample_case(name).replace("name = ", "#name = ", 1))
    for changes in ([], CHANGES, ["sweep={source.first_course=['x', 'y']}", *CHANGES]):
        wanted = {"name": "case"} | apply_overrides(read_table(path), changes)
        text = as_run(path, changes)
        assert tomllib.loads(text) == wanted
        # What people wrote beside their numbers stays.
        assert text.count("#") >= path.read_text().count("#") - len(changes)


def test_changes_are_part_of_it(case: Path, tmp_path: Path) -> None:
    changes = ["rigid.start=uniform", "load.0.direction=[0, 1, 0]", "material.old brick.friction=0.55"]
    text = as_run(case, changes)
    assert text.startswith("# --set rigid.start=uniform\n")
    again = read_variants(elsewhere(tmp_path, text))
    wanted = read_variants(case, changes)
    assert [v.table | {"source": None} for v in again] == [v.table | {"source": None} for v in wanted]
    assert again[0].loads[0].name == 'to the "west"'
    assert isinstance(again[0].source, Drawing)
    assert again[0].source.path == case.parent / "walls" / "mill.dxf"


def test_a_case_without_a_name_keeps_its_own(tmp_path: Path) -> None:
    path = tmp_path / "parish.toml"
    path.write_text(TEXT.replace('name = "mill"\n', "", 1))
    for changes in ([], ["rigid.start=uniform"]):
        assert read_case(elsewhere(tmp_path, as_run(path, changes))).name == "parish"
