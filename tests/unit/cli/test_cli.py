"""The command line: what it answers, and with which exit code. The pipeline itself is tested in tests/pipeline."""

import errno
import io
import json
import math
import os
import re
import shutil
import signal
import subprocess
import sys
from itertools import pairwise
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from ezdxf.filemanagement import new, readfile
from rich.console import Console

import churchpipe
from case_texts import WALL, case_file
from churchpipe import cli, engine
from churchpipe.cli import entry
from churchpipe.config.asrun import claim
from churchpipe.config.case import Drawing, read_case
from churchpipe.dxf.reader import read_drawing
from churchpipe.dxf.reading import Reading
from churchpipe.dxf.writer import write_dxf
from churchpipe.engine import Event
from churchpipe.importing import parse_direction
from churchpipe.io.atomic import read_json, write_json
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import Elastic, Material
from churchpipe.resources import sample_case, sample_names
from churchpipe.terminal import Display
from command_line import call
from corpus_files import CORPUS
from damaged_drawings import SAMPLES
from imprecise import corner
from records import EMPTY, MATCHED, WORDS
from solids import box, on_ground, prism


@pytest.fixture
def two_cubes() -> Assemblage:
    return on_ground(box((0, 1), (0, 1), (0, 1)), box((0, 1), (0, 1), (1, 2)), unit_weight=2e4, reach=3)


@pytest.mark.parametrize("path", ["", " "])
def test_an_empty_path_is_no_place_to_write_to(
    path: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    # A variable of a shell that is not set: without a word all would be written into the current folder.
    case = case_file(tmp_path, WALL)
    monkeypatch.chdir(tmp_path)
    drawing = str(SAMPLES / "sound.dxf")
    for command in ("run CASE", "view CASE", "export-dxf CASE", "generate wall", f"import {drawing}", f"check {drawing}"):
        code, _, err = call(capsys, *command.replace("CASE", str(case)).split(), "--out", path)
        assert code == 2, command
        assert "no path" in err
    code, _, err = call(capsys, "view", case, "--out", ".")
    assert code == 2
    assert "--out .: a folder; expected the name of the page to write." in err
    assert sorted(tmp_path.iterdir()) == [case]


@pytest.mark.slow
def test_a_dry_run_in_the_current_folder_leaves_it_as_it_is(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    case = case_file(tmp_path, WALL)
    monkeypatch.chdir(tmp_path)
    code, out, _ = call(capsys, "run", case, "--out", ".", "--dry-run")
    assert code == 0
    assert "report" in out
    assert sorted(tmp_path.iterdir()) == [case]


def test_version_and_help(capsys: pytest.CaptureFixture[str]) -> None:
    assert call(capsys, "--version") == (0, f"churchpipe {churchpipe.__version__}\n", "")
    code, out, _ = call(capsys, "--help")
    assert code == 0
    for command in ("run", "show", "import-dxf", "check", "export-dxf", "generate", "doctor", "Exit codes"):
        assert command in out
    assert "stage " not in out


@pytest.mark.parametrize(
    ("typed", "offered"),
    [
        ("churchpipe ru", ["run"]),
        ("churchpipe run --mod", ["--model"]),
        ("churchpipe export", ["export-dxf", "export-obj"]),
        ("churchpipe generate chap", ["chapel", "chapel_variants"]),
        ("churchpipe run case.toml --model sh", ["shell"]),
    ],
)
def test_the_shell_completes_commands_and_options(typed: str, offered: list[str]) -> None:
    bash, program = shutil.which("bash"), Path(sys.executable).with_name("churchpipe")
    assert bash
    words = typed.split()
    script = f"""
        source <(_CHURCHPIPE_COMPLETE=source_bash churchpipe)
        COMP_WORDS=({typed}) COMP_CWORD={len(words) - 1}
        _churchpipe_completion churchpipe {words[-1]} {words[-2]}
        printf '%s\\n' "${{COMPREPLY[@]}}"
    """
    path = f"{program.parent}:/usr/bin:/bin"
    done = subprocess.run(
        [bash, "-c", script], capture_output=True, text=True, check=True, env={"PATH": path, "HOME": "/nowhere"}
    )
    assert done.stdout.split() == offered


def test_import_is_light() -> None:
    heavy = [
        "gmsh",
        "ezdxf",
        "cvxpy",
        "numpy",
        "scipy",
        "shapely",
        "clarabel",
        "pydantic",
        "typer",
        "snakemake",
        "pyvista",
        "meshio",
    ]
    code = f"import churchpipe, sys; print([m for m in {heavy} if m in sys.modules])"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "[]\n"


def test_all_stable_names_load() -> None:
    names: list[str] = vars(churchpipe)["__all__"]
    for name in names:
        assert name == "__version__" or getattr(churchpipe, name).__name__.rpartition(".")[2] == name
        assert name in dir(churchpipe)
    with pytest.raises(AttributeError, match="attribute nonsense"):
        attrgetter("nonsense")(churchpipe)
    stub = (Path(churchpipe.__file__).parent / "__init__.pyi").read_text()
    assert set(names) == set(re.findall(r"import \w+ as (\w+)", stub))


@pytest.mark.parametrize(
    "arguments",
    [
        ("run",),
        ("run", "none.toml"),
        ("show", "nowhere"),
        ("fly",),
        ("generate", "palace"),
        ("check", "none.dxf"),
        ("run", "--jobs", "0"),
    ],
)
def test_usage_is_2(arguments: tuple[str, ...], capsys: pytest.CaptureFixture[str]) -> None:
    code, _, err = call(capsys, *arguments)
    assert code == 2
    assert err


def test_a_case_that_check_would_take_for_a_drawing_is_not_written(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    code, _, err = call(capsys, "generate", "wall", "-o", tmp_path / "mine.txt")
    assert code == 2
    assert "mine.txt: not the name of a case; expected a name that ends in .toml" in err
    assert not list(tmp_path.iterdir())


def test_an_option_that_would_do_nothing_is_refused(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    case, mesh = tmp_path / "w.toml", CORPUS / "sound.obj"
    assert call(capsys, "generate", "wall", "-o", case)[0] == 0
    for command, option, value in (("check", "--units", "mm"), ("check", "--out", tmp_path / "f"), ("view", "--thickness", "1m")):
        code, _, err = call(capsys, command, case, option, value)
        assert code == 2
        assert f"{option}: not for a case" in err
    for command in ("check", "view"):
        code, _, err = call(capsys, command, mesh, "--set", "material.default.friction=0.5")
        assert code == 2
        assert "--set: for a case alone" in err
    assert not (tmp_path / "f").exists()


def test_a_folder_without_stones_is_named(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    assert f"{tmp_path.name}: 1 error in the file" in call(capsys, "check", ".")[2]


def test_a_case_with_mistakes_is_1(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert call(capsys, "generate", "wall", "-o", tmp_path / "w.toml")[0] == 0
    code, out, err = call(capsys, "run", tmp_path / "w.toml", "--out", tmp_path / "run", "--set", "source.lenght_m=3")
    assert code == 1
    assert 'Did you mean "length_m"?' in err
    assert out == ""
    assert not (tmp_path / "run").exists()
    assert call(capsys, "run", tmp_path / "w.toml", "--set", "nonsense")[0] == 2


def test_generate_writes_a_case_once(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    code, out, _ = call(capsys, "generate", "prototype")
    assert code == 0
    assert 'name = "s22"' in out
    (tmp_path / "mine.toml").write_text("precious")
    code, _, err = call(capsys, "generate", "arch", "-o", tmp_path / "mine.toml")
    assert code == 2
    assert "exists already" in err
    assert (tmp_path / "mine.toml").read_text() == "precious"


def test_cases_of_one_sample_are_run_in_folders_of_their_own(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    # A run is a folder: what is no name of one keeps that of the sample.
    for file, name in (("before", "before"), ('the "new"', "arch")):
        assert call(capsys, "generate", "arch", "-o", tmp_path / f"{file}.toml")[0] == 0
        assert read_case(tmp_path / f"{file}.toml").name == name


def test_an_imported_case_is_exported_as_it_was_drawn(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    code, _, _ = call(capsys, "import", SAMPLES / "sound.dxf", "-o", tmp_path / "case")
    assert code == 0
    # Folders are made, as those of a run and of an import.
    drawing = tmp_path / "new" / "folder" / "again.dxf"
    code, out, _ = call(capsys, "export-dxf", tmp_path / "case" / "case.toml", "-o", drawing)
    assert code == 0
    first, again = (read_drawing(path).stones for path in (SAMPLES / "sound.dxf", drawing))
    assert f"{int((~first.fixed).sum())} stones" in out
    assert sorted(again.block_id) == sorted(first.block_id)
    assert again.volume.sum() == pytest.approx(first.volume.sum(), rel=1e-12)


def test_a_case_is_exported_as_a_mesh_and_imported_again(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    call(capsys, "generate", "wall", "-o", tmp_path / "w.toml")
    mesh = tmp_path / "new" / "w.obj"
    code, out, err = call(capsys, "export-obj", tmp_path / "w.toml", "-o", mesh, "--set", "source.courses=10")
    assert code == 0
    assert err == "In the mesh are the stones, with the names of their walls and materials; all else is the case's alone.\n"
    given = ("--unit-weight-kN-m3", "18", "--friction", "0.6", "--load", "+x")
    code, _, _ = call(capsys, "import", mesh, "-o", tmp_path / "case", *given)
    assert code == 0
    generated = churchpipe.derive_blocks(read_case(tmp_path / "w.toml", ["source.courses=10"]).building())
    read, _ = churchpipe.read_stones(tmp_path / "case" / "w.obj", unit_weight=18e3)
    assert f"{int((~generated.fixed).sum())} stones" in out
    assert sorted(read.block_id) == sorted(generated.block_id)
    assert read.weight.sum() == pytest.approx(generated.weight.sum(), rel=1e-12)
    code, _, err = call(capsys, "export-obj", tmp_path / "case" / "case.toml", "-o", tmp_path / "case" / "w.obj")
    assert code == 2
    assert "the file that the case is made of" in err
    # Of a folder neither a file is lost, nor is one more of its bodies made.
    (tmp_path / "parts").mkdir()
    mesh.rename(tmp_path / "parts" / "w.obj")
    code, _, _ = call(capsys, "import", tmp_path / "parts", "-o", tmp_path / "whole", *given)
    assert code == 0
    for name, said in (("w", "the file that the case is made of"), ("v", "in the folder that the case is made of")):
        code, _, err = call(capsys, "export-obj", tmp_path / "whole/case.toml", "-o", tmp_path / f"whole/parts/{name}.obj")
        assert code == 2
        assert said in err
    code, _, err = call(capsys, "export-obj", tmp_path / "w.toml", "-o", tmp_path / "w.stl")
    assert code == 2
    assert "expected a name that ends in .obj" in err


def test_a_fault_in_what_a_variant_bears_ends_a_run_before_it_begins(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    call(capsys, "generate", "box", "-o", tmp_path / "box.toml")
    place = "along_m = 0.5, height_m = 2.5 }"
    tie = f'[[ties]]\nname = "tie"\nstart = {{ wall = "south", {place}\nend = {{ wall = "north", {place}\n'
    tie += "area_mm2 = 200\nsteel_strength_MPa = 235\nplate_mm = [200, 200]\n"
    low = '[[variants]]\nname = "low"\nchange = { "ties.0.start.height_m" = 0.05, "ties.0.end.height_m" = 0.05 }\n'
    (tmp_path / "box.toml").write_text((tmp_path / "box.toml").read_text() + tie + low)
    code, out, err = call(capsys, "run", tmp_path / "box.toml", "-o", tmp_path / "run", "--dry-run")
    assert (code, out) == (1, "")
    assert 'with variant "low" of line' in err
    assert "ties.0: tie tie: start: its plate overhangs the masonry" in err
    # All bear a roof that pushes, in the same direction.
    roof = '[[line_loads]]\nwall = "south"\ndead_kN_m = 3\nthrust_kN_m = 0.5\ntoward = [0, -1, 0]\n'
    (tmp_path / "box.toml").write_text((tmp_path / "box.toml").read_text().replace("0.05", "2.4") + roof)
    code, out, err = call(capsys, "run", tmp_path / "box.toml", "-o", tmp_path / "run", "--dry-run")
    assert (code, err) == (0, "")
    assert "stages would be run" in out


def test_what_a_drawing_has_no_place_for_is_said(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    call(capsys, "generate", "wall", "-o", tmp_path / "w.toml")
    more = '[[joints]]\nname = "damp"\nkind = "base"\nfriction = 0.3\n[[variants]]\nname = "dry"\nremove = ["joints.damp"]\n'
    more += '[check]\nag_g = 0.1\nsoil_factor = 1.2\n[sweep]\n"check.q" = [1.5, 2.0]\n'
    (tmp_path / "w.toml").write_text((tmp_path / "w.toml").read_text() + more)
    code, _, err = call(capsys, "export-dxf", tmp_path / "w.toml", "-o", tmp_path / "w.dxf")
    assert code == 0
    assert err == "Not in the drawing, and the case's alone: rigid, check, joints, variants, sweep.\n"


def test_export_and_import_give_the_same_case(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    call(capsys, "generate", "wall", "-o", tmp_path / "w.toml")
    changes = ("--set", "source.courses=10", "--set", "material.default.friction=0.55")
    code, out, _ = call(capsys, "export-dxf", tmp_path / "w.toml", "-o", tmp_path / "w.dxf", *changes)
    assert code == 0
    code, out, err = call(capsys, "import-dxf", tmp_path / "w.dxf", "-o", tmp_path / "new")
    assert (code, err) == (0, "")
    assert "fill" not in out
    imported = read_case(tmp_path / "new" / "case.toml")
    original = read_case(tmp_path / "w.toml", ["material.default.friction=0.55"])
    assert imported.materials == original.materials
    assert [load.name for load in imported.loads] == ["+x", "+y"]
    drawn = read_drawing(tmp_path / "new" / "w.dxf").stones
    generated = churchpipe.derive_blocks(read_case(tmp_path / "w.toml", ["source.courses=10"]).building())
    np.testing.assert_allclose(drawn.points, generated.points, atol=1e-12)
    code, _, err = call(capsys, "import-dxf", tmp_path / "w.dxf", "-o", tmp_path / "new")
    assert code == 2
    assert "case.toml: exists already" in err


def test_import_keeps_all_that_a_drawing_tells(capsys: pytest.CaptureFixture[str], tmp_path: Path, two_cubes: Assemblage) -> None:
    elastic = Elastic(3.18e9, 0.23, 0.303e9, 0.3, 1e-3)
    material = Material("default", 2e4, 1 / 3, 1234.5, elastic, compressive_strength=3.2e6)
    load = LoadCase((0.6, -0.8, 0), name='the "west" wind', panels=("front", "back"), profile="linear")
    write_dxf(two_cubes, tmp_path / "a.dxf", materials=[material], loads=[load])
    assert call(capsys, "import-dxf", tmp_path / "a.dxf", "-o", tmp_path / "a")[0] == 0
    case = read_case(tmp_path / "a" / "case.toml")
    assert case.materials == (material,)
    assert (case.loads[0].name, case.loads[0].panels, case.loads[0].profile) == (load.name, load.panels, "linear")
    np.testing.assert_allclose(case.loads[0].direction, load.direction, rtol=1e-15)


def test_options_override_and_gaps_are_told(capsys: pytest.CaptureFixture[str], tmp_path: Path, two_cubes: Assemblage) -> None:
    write_dxf(two_cubes, tmp_path / "a.dxf")
    code, out, err = call(capsys, "import-dxf", tmp_path / "a.dxf", "-o", tmp_path / "a")
    assert code == 0
    assert "W19" in err
    for key in ("material.default.unit_weight_kN_m3", "material.default.friction", "[[load]]"):
        assert f"Still to be filled in: {key}" in out
    code, _, err = call(capsys, "run", tmp_path / "a" / "case.toml", "--out", tmp_path / "run")
    assert code == 1
    assert "material.default.unit_weight_kN_m3, material.default.friction, load" in err
    given = ("--unit-weight-kN-m3", 18, "--friction", 0.65, "--load", "-y", "--load", "1,1,0", "--units", "m")
    code, out, _ = call(capsys, "import-dxf", tmp_path / "a.dxf", "-o", tmp_path / "b", *given)
    assert code == 0
    assert "fill" not in out
    case = read_case(tmp_path / "b" / "case.toml")
    assert [(m.unit_weight, m.friction) for m in case.materials] == [(18e3, 0.65)]
    assert [load.name for load in case.loads] == ["-y", "(0.707, 0.707, 0)"]


def test_a_drawing_with_errors_leaves_nothing(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    stones = on_ground(box((0, 1), (0, 1), (0, 1)), box((0, 1), (0, 1), (1.5, 2)), box((0.5, 1.5), (0, 1), (0, 1)), reach=3)
    write_dxf(stones, tmp_path / "a.dxf", materials=[Material("default", 18e3, 0.6)])
    for command in (("check", tmp_path / "a.dxf"), ("import-dxf", tmp_path / "a.dxf", "-o", tmp_path / "out")):
        code, _, err = call(capsys, *command)
        assert code == 1
        assert "1 pair overlaps (B1 and B3)" in err
        assert "without a path to a support (B2 at" in err
    assert not (tmp_path / "out").exists()
    (tmp_path / "cut.dxf").write_bytes((tmp_path / "a.dxf").read_bytes()[:5000])
    code, _, err = call(capsys, "check", tmp_path / "cut.dxf")
    assert code == 1
    assert "dxf/E" in err


def test_a_sound_drawing_is_0(capsys: pytest.CaptureFixture[str], tmp_path: Path, two_cubes: Assemblage) -> None:
    write_dxf(two_cubes, tmp_path / "a.dxf", materials=[Material("default", 2e4, 0.6)])
    code, out, err = call(capsys, "check", tmp_path / "a.dxf")
    assert (code, err) == (0, "")
    assert "2 stones, 2 m3, nothing to report." in out


@pytest.mark.parametrize(
    ("text", "direction"),
    [("+x", (1, 0, 0)), ("-y", (0, -1, 0)), ("z", (0, 0, 1)), ("1, -2,0.5", (1, -2, 0.5)), ("-X", (-1, 0, 0))],
)
def test_directions(text: str, direction: tuple[float, float, float]) -> None:
    assert parse_direction(text) == direction
    # No minus before a zero: a case says [0, -1, 0].
    assert not any(math.copysign(1, part) < 0 for part in parse_direction(text) if part == 0)


@pytest.mark.parametrize("text", ["north", "1,2", "+-x", "1,2,a", "", "0,0,0", "nan,0,1", "inf,0,0"])
def test_no_directions(text: str, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    (tmp_path / "a.dxf").touch()
    code, _, err = call(capsys, "import-dxf", tmp_path / "a.dxf", "-o", tmp_path / "a", "--load", text)
    assert code == 2
    assert "not a direction" in err


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("--friction", "nan"),
        ("--friction", -1),
        ("--friction", "inf"),
        ("--unit-weight-kN-m3", 0),
        ("--unit-weight-kN-m3", "nan"),
    ],
)
def test_numbers_that_are_none(option: str, value: str | int, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    (tmp_path / "a.dxf").touch()
    code, _, err = call(capsys, "import-dxf", tmp_path / "a.dxf", "-o", tmp_path / "a", option, value)
    assert code == 2
    assert f"{option}: out of range; found {float(value)}" in err
    assert not (tmp_path / "a").exists()


def test_one_load_given_twice(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    (tmp_path / "a.dxf").touch()
    code, _, err = call(capsys, "import-dxf", tmp_path / "a.dxf", "-o", tmp_path / "a", "--load", "+x", "--load", "2,0,0")
    assert code == 2
    assert "one direction given twice; found +x" in err


def test_an_imported_wall_gets_a_shell(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    samples = Path(__file__).parents[3] / "cad_samples"
    code, out, _ = call(capsys, "import-dxf", samples / "s5.dxf", "-o", tmp_path / "s5")
    assert code == 0
    assert "3 walls fitted for the shell: main, partition-1, partition-2." in out
    shell = read_case(tmp_path / "s5" / "case.toml").shell
    assert shell is not None
    assert (shell.element_size, shell.analyses, shell.planes) == (0.06, ("limit", "pushover"), "cell")
    assert call(capsys, "import-dxf", samples / "arch.dxf", "-o", tmp_path / "arch")[0] == 0
    shell = read_case(tmp_path / "arch" / "case.toml").shell
    assert shell is not None
    # A ring of voussoirs is taken as running bond; this drawing has no elastic constants.
    assert shell.analyses == ("limit",)
    assert "give each material its elastic constants" in (tmp_path / "arch" / "case.toml").read_text()


def test_a_large_drawing_is_not_asked_for_both_flow_rules(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, two_cubes: Assemblage, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_dxf(two_cubes, tmp_path / "a.dxf")
    given = ("--unit-weight-kN-m3", 18, "--friction", 0.65, "--load", "-y")
    for folder, many, flow in (("few", 3000, ("associative", "non-associative")), ("many", 1, ("associative",))):
        monkeypatch.setattr("churchpipe.config.imported.MANY_STONES", many)
        assert call(capsys, "import-dxf", tmp_path / "a.dxf", "-o", tmp_path / folder, *given)[0] == 0
        assert read_case(tmp_path / folder / "case.toml").rigid.flow == flow


def test_stones_that_make_no_wall_get_no_shell(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    spike = prism([(0, 0), (1, 0), (0.5, 0.8)], 1.0)
    write_dxf(on_ground(spike, unit_weight=2e4, reach=3), tmp_path / "a.dxf", materials=[Material("default", 2e4, 0.6)])
    code, out, _ = call(capsys, "import-dxf", tmp_path / "a.dxf", "-o", tmp_path / "a", "--load", "+x")
    assert code == 0
    assert "No shell: no wall can be fitted" in out
    assert read_case(tmp_path / "a" / "case.toml").shell is None


def test_generate_names_every_sample(capsys: pytest.CaptureFixture[str]) -> None:
    _, out, _ = call(capsys, "generate", "--help")
    for name in sample_names():
        assert name in out


def test_show_wants_a_run(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    code, _, err = call(capsys, "show", tmp_path)
    assert code == 1
    assert "churchpipe run" in err
    (tmp_path / "summary.json").write_text("{")
    assert call(capsys, "show", tmp_path)[0] == 1
    (tmp_path / "summary.json").write_text("{}")
    code, _, err = call(capsys, "show", tmp_path)
    assert code == 1
    assert "not a summary of a run; found no blocks" in err


def test_show_prints_every_analysis(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    bounds = {"load_factor": 0.473684, "lower_bound": 0.473684, "upper_bound": 0.473685, "swept": {"source.courses": 3}}
    none = {"load_factor": None, "lower_bound": None, "upper_bound": None, "status": "unstable"}
    analyses = [
        WORDS | bounds | {"flow": "associative"},
        WORDS | none | {"load": "-y", "flow": "non-associative", "friction": {"tuff": 0.6, "brick": 0.5}},
    ]
    sizes = {"case": "w", "blocks": 9, "interfaces": 19, "contact_points": 76, "weight_kN": 1.296}
    write_json(tmp_path / "summary.json", EMPTY | sizes | {"analyses": analyses})
    code, out, _ = call(capsys, "show", tmp_path)
    assert code == 0
    assert read_json(tmp_path / "summary.json")["case"] == "w"
    for text in (
        "w: 9 stones, 19 interfaces, 1.296 kN",
        "0.473684",
        "1.0e-06",
        "optimal",
        "tuff 0.6, brick 0.5",
        "none",
        "unstable",
    ):
        assert text in out


@pytest.mark.parametrize("name", ["[/x]", "[bold]s", ":smile:", "[red]"])
def test_names_are_printed_as_they_are(
    name: str, capsys: pytest.CaptureFixture[str], tmp_path: Path, two_cubes: Assemblage
) -> None:
    folder = tmp_path / name
    folder.mkdir(parents=True)
    check = {"zeta_e": 0.98, "zeta_e_stones": 1.31, "satisfied": False}
    analysis = WORDS | {"load": name, "flow": "associative", "load_factor": 0.2, "check": check}
    summary = EMPTY | {"case": name, "analyses": [analysis]}
    write_json(folder / "summary.json", summary)
    code, out, _ = call(capsys, "show", folder)
    assert code == 0
    assert f"{name}: 1 stone" in out
    assert f" {name} " in out
    assert "0.98" in out
    drawing = folder / f"{name.replace('/', '')}.dxf"
    write_dxf(two_cubes, drawing, materials=[Material("default", 2e4, 0.6)], loads=[LoadCase((1, 0, 0))])
    code, out, _ = call(capsys, "check", drawing)
    assert code == 0
    assert f"{drawing}: " in out
    code, out, _ = call(capsys, "generate", "wall", "-o", folder / "case.toml")
    assert f"{folder / 'case.toml'}: edit it" in out
    code, out, _ = call(capsys, "import-dxf", drawing, "-o", folder / "made")
    assert code == 0
    assert f"{folder / 'made' / 'case.toml'}" in out
    code, out, _ = call(capsys, "export-dxf", folder / "case.toml", "-o", folder / "out.dxf")
    assert code == 0
    assert f"{folder / 'out.dxf'}" in out


def test_no_person_reads_nan(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    nan = float("nan")
    check = {"zeta_e": nan, "zeta_e_stones": None, "satisfied": False}
    numbers = {"load_factor": nan, "lower_bound": nan, "upper_bound": nan, "equilibrium_residual": nan, "check": check}
    analyses = [
        WORDS | {"load": "+x", "flow": "associative", "status": "failed", **numbers},
        WORDS | {"load": "-x", "flow": "associative", "status": "unbounded", "load_factor": None},
    ]
    summary = EMPTY | {"analyses": analyses}
    (tmp_path / "summary.json").write_text(json.dumps(summary))
    code, out, _ = call(capsys, "show", tmp_path)
    assert code == 0
    assert "nan" not in out.lower()
    assert "none" in out
    assert "no limit" in out


def test_show_tells_both_models_apart(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    rigid = WORDS | {"flow": "associative", "load": "-y", "load_factor": 0.2065}
    shell = WORDS | {"model": "homogenised-shell", "load": "-y", "load_factor": 0.222}
    summary = EMPTY | {
        "case": "s22",
        "blocks": 869,
        "interfaces": 2415,
        "weight_kN": 2.29,
        "shell": {"elements": 1681, "nodes": 939, "element_size_mm": 60.0},
        "match": MATCHED | {"unfit": ["B7"]},
        "analyses": [rigid, shell | {"method": "limit"}, shell | {"method": "pushover", "status": "converged"}],
    }
    write_json(tmp_path / "summary.json", summary)
    code, out, _ = call(capsys, "show", tmp_path)
    assert code == 0
    for text in ("shell of 1681 elements", "rigid blocks", "limit load", "capacity curve", "missing from the shell: B7."):
        assert text in out
    (weight,) = MATCHED["figures"]
    failed = {"figures": [weight | {"difference": 0.1}, weight | {"name": "volume"}]}
    write_json(tmp_path / "summary.json", summary | {"match": failed, "analyses": [rigid]})
    assert "No shell. The two models do not match: weight. The rigid blocks stand." in call(capsys, "show", tmp_path)[1]


def test_show_says_why_an_analysis_has_no_load_factor(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    shell = WORDS | {"model": "homogenised-shell", "method": "limit", "load_factor": None}
    fell = shell | {"status": "unstable", "message": "the dead load alone brings it down"}
    summary = EMPTY | {"analyses": [fell, shell | {"status": "optimal"}]}
    write_json(tmp_path / "summary.json", summary)
    out = call(capsys, "show", tmp_path)[1]
    assert out.count("load +x, shell, limit load: unstable, the dead load alone brings it down.\n") == 1
    many = [fell | {"variant": f"v{number}"} for number in range(10)]
    write_json(tmp_path / "summary.json", summary | {"analyses": many})
    out = call(capsys, "show", tmp_path)[1]
    assert "v7, load +x" in out
    assert "v8, load +x" not in out
    assert "and 2 more in the report" in out


def test_show_does_not_show_what_a_failed_run_left(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    write_json(tmp_path / "summary.json", EMPTY | {"analyses": []})
    assert call(capsys, "show", tmp_path)[0] == 0
    (tmp_path / engine.UNFINISHED).write_text("load +x: panels: no such panel")
    code, out, err = call(capsys, "show", tmp_path)
    assert (code, out) == (1, "")
    assert "the last run did not go to its end; found load +x: panels: no such panel" in err


def test_show_tells_what_moves_and_what_the_check_finds(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    one = {"weight_kN": 1.0, "moving": 1.0, "displacement": 1.0}
    parts = [{"name": name, "motion": share} | one for name, share in (("facade", 0.9), ("nave", 0.1), ("apse", 0.0))]
    check = {
        "alpha0": 0.27,
        "moving_weight_kN": 123.4,
        "a0_lumped_m_s2": 1.937,
        "mass_fraction": 0.4368,
        "zeta_e": 0.8,
        "satisfied": False,
    }
    analysis = WORDS | {"name": "-y_associative", "load": "-y", "flow": "associative", "load_factor": 0.2}
    movement = {
        **{key: WORDS[key] for key in ("name", "variant", "direction", "friction", "message", "equilibrium_residual", "seconds")},
        "movement": "pier",
        "turns": False,
        "ultimate_mm": 87.2,
        "movement_mm": [87.2],
        "reaction_kN": [9.0],
        "steps": 1,
        "least_reaction_kN": 8.0,
        "largest_displacement_mm": 90.0,
        "fallen_stones": [],
        "cone_violation": 0.0,
        "misfit": 0.0,
        "ending": "unbounded",
        "status": "converged",
        "cracks": [{"wall": "nave", "opening_mm": 12.0, "slip_mm": 1.0}],
    }
    summary = EMPTY | {"analyses": [analysis | {"parts": parts, "check": check}]}
    write_json(tmp_path / "summary.json", summary | {"movements": [movement]})
    _, out, _ = call(capsys, "show", tmp_path)
    for text in ("facade 90 %, nave 10 %", "123.4", "1.937", "0.4368", "not satisfied"):
        assert text in out
    assert "Support pier: at 87.2 mm the stones hold the support fast; widest crack 12 mm in nave" in out
    assert "12 mm in nave; as it begins to move it must resist with 9 kN without dilatancy, 8 kN at the least" in out
    # It stands for a building with its ties, and is followed without them: that is said here, too.
    without = movement | {"message": "the stones hold it; ties are left out"}
    write_json(tmp_path / "summary.json", summary | {"movements": [without]})
    assert "8 kN at the least; ties are left out\n" in call(capsys, "show", tmp_path)[1]
    pushed = movement | {"least_reaction_kN": -2.0, "reaction_kN": [-1.5]}
    write_json(tmp_path / "summary.json", summary | {"movements": [pushed]})
    assert "it must be pushed with 2 kN at most (1.5 kN without dilatancy)" in call(capsys, "show", tmp_path)[1]
    # One that is not followed to its end says how far it went.
    unfinished = movement | {"ultimate_mm": None, "movement_mm": [0.0, 61.5], "ending": "unfinished"}
    write_json(tmp_path / "summary.json", summary | {"movements": [unfinished, unfinished | {"movement_mm": []}]})
    _, out, _ = call(capsys, "show", tmp_path)
    assert "Support pier: at 61.5 mm it was not followed further" in out
    assert "Support pier: at 0 mm it was not followed further" in out
    # One of a structure that does not stand has no place, no crack and no reaction.
    none = unfinished | {"movement_mm": [], "reaction_kN": [], "ending": "unstable", "status": "unstable"}
    write_json(tmp_path / "summary.json", summary | {"movements": [none | {"message": "the dead load alone brings it down"}]})
    assert "Support pier: it could not be moved, the dead load alone brings it down\n" in call(capsys, "show", tmp_path)[1]
    shut = movement | {"cracks": [{"wall": "nave", "opening_mm": 6e-6, "slip_mm": 0.0}]}
    write_json(tmp_path / "summary.json", summary | {"movements": [shut]})
    assert "widest crack none" in call(capsys, "show", tmp_path)[1]
    # Stones of a mesh stand in no wall.
    loose = movement | {"cracks": [{"wall": "", "opening_mm": 30.0, "slip_mm": 0.0}]}
    write_json(tmp_path / "summary.json", summary | {"movements": [loose]})
    assert "widest crack 30 mm in stones of no wall; as it" in call(capsys, "show", tmp_path)[1]
    # One support of several buildings or strengths says of which it is.
    other = unfinished | {"variant": "tied", "swept": {"material.default.friction": 0.5}}
    write_json(tmp_path / "summary.json", summary | {"movements": [other]})
    _, out, _ = call(capsys, "show", tmp_path)
    assert "Support pier, tied, friction 0.5: at 61.5 mm it was not followed further" in out
    # Without analyses there is no table, and the sizes stand alone.
    write_json(tmp_path / "summary.json", EMPTY | {"movements": [movement]})
    _, out, _ = call(capsys, "show", tmp_path)
    assert out.startswith("w: 1 stone, 1 interface, 1 kN\nSupport pier: at 87.2 mm")


def test_what_a_curve_leaves_out_is_said(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """A curve without cohesion starts far below the limit analysis beside it; one that was left early has no check."""
    check = {"alpha0": 0.1, "confidence_factor": 1.35, "a_g_slv_m_s2": 1.0, "zeta_e": 0.8, "satisfied": False}
    limit = WORDS | {"flow": "associative", "load_factor": 0.4, "cohesion_kPa": 50.0}
    lost, left = "cohesion, which opening joints lose, is left out", "all steps asked for were used up"
    curve = limit | {"flow": None, "method": "curve", "status": "converged", "message": f"{left}; {lost}"}
    refused = curve | {"check": {"message": "check: no mechanism; found 1 step of the curve; expected two or more."}}
    write_json(tmp_path / "summary.json", EMPTY | {"analyses": [limit, refused]})
    _, out, _ = call(capsys, "show", tmp_path)
    assert f"load +x, rigid blocks, capacity curve of the stones: {left}; {lost}." in out
    assert "no safety check" not in out  # nobody asked for one
    write_json(tmp_path / "summary.json", EMPTY | {"analyses": [limit | {"check": check}, refused]})
    _, out, _ = call(capsys, "show", tmp_path)
    assert "capacity curve of the stones: no safety check, no mechanism; found 1 step of the curve; expected two" in out


def test_long_lists_are_folded(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    analysis = WORDS | {"flow": "associative", "load_factor": 0.2}
    summary = EMPTY | {"analyses": [analysis] * 100}
    write_json(tmp_path / "summary.json", summary | {"questions": [f"value {n}?" for n in range(20)]})
    _, out, _ = call(capsys, "show", tmp_path)
    assert out.count("optimal") == 40
    assert "and 60 more, all of them in table.csv and in the report" in out
    assert out.count("Question: ") == 8
    assert "and 12 more in the report" in out


def test_show_lists_the_runs_of_a_folder(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    analyses = [WORDS | {"flow": "associative", "load_factor": factor} for factor in (0.25, 0.5)]
    for name in ("good", "stopped", "empty"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "plan.json").write_text("{}")
    write_json(tmp_path / "good" / "summary.json", EMPTY | {"analyses": analyses})
    (tmp_path / "stopped" / engine.UNFINISHED).write_text("it was stopped")
    code, out, _ = call(capsys, "show", tmp_path)
    assert code == 0
    assert re.search(r"good .* 2 +0\.2500 to 0\.5000 +well", out)
    assert re.search(r"stopped .* it was stopped", out)
    assert re.search(r"empty .* no results", out)


def test_a_case_of_a_drawing_is_checked_with_its_drawing(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert call(capsys, "import", SAMPLES / "sound.dxf", "-o", tmp_path / "made")[0] == 0
    case = tmp_path / "made" / "case.toml"
    code, out, _ = call(capsys, "check", case)
    assert code == 0
    assert "stones." in out
    assert "analys" in out
    whole = case.read_text()
    for table, said in (
        (
            '[[load]]\ndirection = [0, 1, 0]\nname = "leaf"\npanels = ["roof"]\n',
            "load.1.panels: no such panel; found roof; expected",
        ),
        ('[[joints]]\nname = "j"\nwalls = ["roof"]\ncohesion_kPa = 10\n', "joints.0: no such panel; found roof"),
        ("[[point_loads]]\ndead_kN = 10\nat_m = [90, 0, 3]\n", "point_loads.0"),
    ):
        case.write_text(f"{whole}\n{table}")
        code, _, err = call(capsys, "check", case)
        assert code == 1
        assert re.search(rf"case.toml: line \d+, {said}", err)
    case.write_text(whole)
    (tmp_path / "made" / "sound.dxf").write_bytes((CORPUS / "open-body.dxf").read_bytes())
    code, _, err = call(capsys, "check", case)
    assert code == 1
    assert "5 errors in the file" in err


def test_the_samples_of_a_case_are_counted(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    sampled = """[sample]
number = 12
[[sample.parameters]]
key = "material.default.friction"
distribution = "uniform"
low = 0.5
high = 0.7
"""
    code, out, _ = call(capsys, "check", case_file(tmp_path, WALL + sampled))
    assert code == 0
    assert "1 analysis, 12 samples of uncertain values." in out


def test_a_case_is_checked_with_the_stones_that_a_run_would_lay(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    case = tmp_path / "chapel.toml"
    assert call(capsys, "generate", "chapel", "-o", case)[0] == 0
    code, out, _ = call(capsys, "check", case)
    assert code == 0
    assert "chapel.toml: 1282 stones, 3929 joints." in out
    case.write_text(case.read_text().replace("inner_radius_m = 1.2", "inner_radius_m = 1.6"))
    code, _, err = call(capsys, "check", case)
    assert code == 1
    assert re.search(r"chapel\.toml: line 5, source: wall east, bond: .*narrower than a quarter of a stone", err)


# A box whose door leaves 0.15 x 0.25 m of masonry beside it: no stone of 0.6 m is laid there.
NARROW = """
[source]
generator = "box"
length_m = 3.0
width_m = 2.4
brick_mm = [600, 200, 250]
courses = 4
joints = "bay"

[[source.openings_x]]
start_m = 0.3
width_m = 0.8
height_courses = 3

[material.default]
unit_weight_kN_m3 = 18
friction = 0.6

[[load]]
direction = [0, 1, 0]
"""


@pytest.mark.parametrize("carried", ["", '[[line_loads]]\nwall = "north"\ndead_kN_m = 1\n'], ids=["bare", "loaded"])
@pytest.mark.parametrize("command", ["check", "view", "export-dxf", "export-obj", "run"])
def test_stones_that_cannot_be_laid_have_the_line_of_their_source(
    command: str, carried: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    names = {"view": "page.html", "export-dxf": "stones.dxf", "export-obj": "stones.obj", "run": "run"}
    written = ["-o", tmp_path / names[command]] if command in names else []
    code, _, err = call(capsys, command, case_file(tmp_path, NARROW + carried), *written)
    assert code == 1
    assert re.search(r"case\.toml: line 2, source: wall south, bond: .*narrower than a quarter of a stone", err)


def test_progress_elsewhere_than_on_a_terminal_is_lines(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [0.0]
    monkeypatch.setattr("churchpipe.terminal.time.perf_counter", lambda: now[0])
    page = io.StringIO()
    with Display(Console(file=page, width=120)) as display:
        display.show(Event("total", share=2))
        display.show(Event("start", "rigid", "+x"))
        display.show(Event("progress", "rigid", "+x", "dead load", 0.0))
        now[0] = 40.0
        display.show(Event("progress", "rigid", "+x", "non-associative", 0.4))
        display.show(Event("progress", "rigid", "+x", "non-associative", 0.5))
        display.show(Event("done", "rigid", "+x", share=50.0))
    lines = page.getvalue().splitlines()
    assert lines[0] == "rigid  +x: non-associative, 40 %"
    assert lines[1].split() == ["rigid", "+x", "50.0", "s", "50", "%"]
    assert len(lines) == 2


def test_a_place_that_cannot_be_written_to_is_named(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    taken = tmp_path / "taken"
    taken.write_text("a file, not a folder")
    code, _, err = call(capsys, "run", Path(__file__).parents[3] / "pipeline" / "cases" / "wall.toml", "--out", taken)
    assert code == cli.USAGE
    assert "taken: a file, where the folder of the run would be" in err.replace("\n", " ")
    assert taken.read_text() == "a file, not a folder"


def test_what_a_message_says_to_type_joins_rings_of_straight_chords(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """Two rings of voussoirs without curves, 11 and 12 to a half circle: their faces lean against each other by 8 degrees."""
    document = new("R2010", units=4)
    for radius, angles in ((1000, np.linspace(0, 180, 12)), (1200, [0, *np.linspace(180 / 22, 180 - 180 / 22, 11), 180])):
        for begin, end in pairwise(np.radians(angles)):
            corners = [
                (r * np.cos(a), r * np.sin(a))
                for r, a in ((radius, begin), (radius + 200, begin), (radius + 200, end), (radius, end))
            ]
            document.modelspace().add_lwpolyline(corners, close=True)
    drawing, given = tmp_path / "rings.dxf", ("--thickness", "0.3m", "--support", "base")
    document.saveas(drawing)
    code, _, err = call(capsys, "check", drawing, *given)
    assert code == 1
    found = re.search(r"join them with (--contact-gap \S+ --contact-angle-deg \S+) of check and import", err)
    assert found, err
    given += tuple(found[1].split())
    assert call(capsys, "check", drawing, *given)[0] == 0
    given += ("--overlap", "15mm", "--unit-weight-kN-m3", 18, "--friction", 0.6, "--load", "+x")
    assert call(capsys, "import", drawing, "-o", tmp_path / "case", *given)[0] == 0
    rigid = read_case(tmp_path / "case" / "case.toml").rigid
    assert (rigid.contact_angle, rigid.overlap) == pytest.approx((math.radians(8.2), 0.015))
    code, out, _ = call(capsys, "check", tmp_path / "case" / "case.toml")
    assert (code, "Near misses" in out) == (0, False)
    # 10 and 11 joints in the rings, 22 between them, 4 on the ground.
    stones = read_drawing(drawing, thickness=0.3, support="base", unit_weight=18e3).stones
    contacts = churchpipe.find_contacts(stones, contact_gap=rigid.contact_gap, contact_angle=rigid.contact_angle)
    assert len(np.unique(np.sort(contacts.blocks, axis=1), axis=0)) == 10 + 11 + 22 + 4


def test_joints_kept_open_are_reached_across_however_wide_each_was_drawn(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    drawing, given = outlines(tmp_path / "a.dxf", 12), ("--thickness", "0.12m", "--support", "base")
    given += ("--joint", "10mm", "--joint-mode", "keep")
    code, out, _ = call(capsys, "import", drawing, "-o", tmp_path / "a", *given, "--unit-weight-kN-m3", 18, "--friction", 0.6)
    assert code == 0
    # Three joints of 10 mm, and four of 12 mm between the courses.
    assert "Joints closed across a gap: 7, up to 12 mm where widest; contact gap 15 mm" in out
    assert "contact_gap_mm = 15\n" in (tmp_path / "a" / "case.toml").read_text(encoding="utf-8")


def test_a_joint_wider_than_the_stones_is_a_slip_of_the_pen(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    drawing = outlines(tmp_path / "a.dxf", 10)
    code, _, err = call(capsys, "check", drawing, "--thickness", "0.12m", "--support", "base", "--joint", "1m")
    assert code == 1
    assert "E26 a.dxf: a joint of 1 m between stones whose smallest dimension is 0.065 m: 0.13 m at most can be closed" in err
    given = ("--thickness", "0.12m", "--support", "base", "--joint", "4cm")
    code, _, err = call(capsys, "check", outlines(tmp_path / "b.dxf", 40), *given, "--joint-mode", "keep")
    assert code == 1
    assert "wide ones take --joint-mode grow" in err


def test_a_case_of_a_folder_of_stones_is_checked(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    folder = tmp_path / "stones"
    folder.mkdir()
    shutil.copy(CORPUS / "sound.obj", folder / "part.obj")
    keys = 'file = "stones"\nunits = "m"\nsupport = "base"'
    text = WALL.replace('generator = "wall"\nlength_m = 1.2\nbrick_mm = [400, 250, 200]\ncourses = 3', keys)
    code, out, err = call(capsys, "check", case_file(tmp_path, text))
    assert code == 0, err
    assert re.search(r"stones: \d+ stones", out)
    shutil.rmtree(folder)
    code, _, err = call(capsys, "check", case_file(tmp_path, text))
    assert code == 1
    assert "source.file: no such file; found" in err


def test_a_drawing_given_for_a_case_is_to_be_imported(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    code, _, err = call(capsys, "run", outlines(tmp_path / "a.dxf", 10))
    assert code == 1
    assert "churchpipe import makes a case" in err


def test_the_command_to_run_a_case_can_be_copied(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    code, out, _ = call(capsys, "generate", "wall", "-o", tmp_path / "my [1] case.toml")
    assert code == 0
    assert f"churchpipe run '{tmp_path}/my [1] case.toml'" in out


def outlines(path: Path, gap: float) -> Path:
    """Write five bricks of 250 x 65 mm in two courses, as outlines with joints between them, flagged mm."""
    document = new("R2010")
    document.header["$INSUNITS"] = 4
    for left, low, length in ((0, 0, 250), (260, 0, 250), (0, 65 + gap, 120), (130, 65 + gap, 250), (390, 65 + gap, 120)):
        corners = [(left, low), (left + length, low), (left + length, low + 65), (left, low + 65)]
        document.modelspace().add_lwpolyline(corners, close=True, dxfattribs={"layer": "FACADE"})
    document.saveas(path)
    return path


def test_a_drawing_of_outlines_becomes_a_case_that_reads_it_the_same_way(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    drawing = outlines(tmp_path / "a.dxf", 10)
    given = ("--thickness", "12 cm", "--joint", "10mm", "--support", "base", "--mortar", "ignored")
    code, out, err = call(capsys, "import-dxf", drawing, "-o", tmp_path / "a", *given, "--unit-weight-kN-m3", 18, "--load", "+x")
    assert code == 0
    assert [line.split()[0] for line in err.splitlines()] == ["dxf/W12", "dxf/W24", "dxf/W26"]
    assert "findings.json" in out
    case = read_case(tmp_path / "a" / "case.toml", ["material.default.friction=0.6"])
    reading = Reading(support="base", thickness=0.12, joint=0.01, mortar="ignored")
    assert case.source == Drawing(tmp_path / "a" / "a.dxf", reading)
    record = json.loads((tmp_path / "a" / "findings.json").read_text())
    assert [finding["code"] for finding in record["findings"]] == ["W12", "W24", "W26"]
    circles: list[Any] = list(readfile(tmp_path / "a" / "findings.dxf").modelspace().query("CIRCLE"))
    assert {circle.dxf.layer[:3] for circle in circles} == {"W12", "W24"}
    np.testing.assert_allclose(circles[0].dxf.center, (0, 0, 0))


def test_check_leaves_a_drawing_of_what_is_wrong(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    drawing = outlines(tmp_path / "a.dxf", 10)
    code, _, err = call(capsys, "check", drawing, "--thickness", "0.12m", "-o", tmp_path / "found")
    assert code == 1
    assert "Pass --joint 10mm" in err
    assert {finding["code"] for finding in json.loads((tmp_path / "found" / "findings.json").read_text())["findings"]} >= {
        "E26",
        "E12",
    }
    assert len(readfile(tmp_path / "found" / "findings.dxf").modelspace().query("CIRCLE"))


@pytest.mark.parametrize("text", ["0.12", "12 furlongs", "m", "-3mm", "0mm", "1e999m"])
def test_lengths_that_are_none(text: str, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    code, _, err = call(capsys, "check", outlines(tmp_path / "a.dxf", 0), f"--thickness={text}")
    assert code == 2
    assert "not a length" in err


def test_a_unit_weight_that_was_passed_is_not_asked_for(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    given = ("--thickness", "0.12m", "--support", "base", "--unit-weight-kN-m3", 18)
    code, _, err = call(capsys, "import-dxf", outlines(tmp_path / "a.dxf", 0), "-o", tmp_path / "a", *given, "--joint", "10mm")
    assert code == 0
    assert "W19" not in err


def test_a_drawing_with_open_joints_needs_a_decision(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    drawing = tmp_path / "corner.dxf"
    write_dxf(corner(head_gap=0.01), drawing)
    code, _, err = call(capsys, "check", drawing)
    assert code == 1
    assert "48 pairs of faces nearly meet" in err
    assert "contact_gap_mm = 10 in [rigid]" in err
    code, out, _ = call(capsys, "check", drawing, "--contact-gap", "10mm")
    assert code == 0
    assert "Joints closed across a gap: 48, up to 10 mm where widest; contact gap 10 mm, as asked for." in out
    assert call(capsys, "check", drawing, "--joint", "10mm", "--joint-mode", "keep")[0] == 0
    code, out, _ = call(capsys, "import-dxf", drawing, "-o", tmp_path / "corner", "--contact-gap", "1mm")
    assert code == 0
    assert "Near misses: 48 pairs of faces" in out
    assert "contact_gap_mm = 1\n" in (tmp_path / "corner" / "case.toml").read_text(encoding="utf-8")


def test_report_is_found_and_printed(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert call(capsys, "report", tmp_path)[0] == 1
    (tmp_path / "report.html").write_text("<h1>nave &amp; apse</h1>" + "<p>a sentence</p>" * 400)
    assert call(capsys, "report", tmp_path) == (0, f"{tmp_path / 'report.html'}\n", "")
    code, out, _ = call(capsys, "report", tmp_path, "--pdf")
    assert code == 0
    pages = int(out.split()[0])
    assert pages > 3
    assert (tmp_path / "report.pdf").read_bytes().startswith(b"%PDF")
    assert not list(tmp_path.glob(".part-*"))


def test_a_library_that_printing_needs_is_named(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "report.html").write_text("<h1>nave</h1>")
    monkeypatch.setitem(sys.modules, "weasyprint", None)
    code, _, err = call(capsys, "report", tmp_path, "--pdf")
    assert code == 1
    assert "the report as a PDF: a package is not installed" in err
    assert not (tmp_path / "report.pdf").exists()


def test_a_full_disk_is_told_without_a_traceback(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    # A write that fails, unlike an open, does not name its file.
    def full() -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(entry, "app", full)
    monkeypatch.setattr("signal.signal", lambda *_: None)
    with pytest.raises(SystemExit) as caught:
        entry.main()
    assert caught.value.code == 2
    assert "A file cannot be written: No space left on device. Choose another place to write to." in capsys.readouterr().err


@pytest.mark.parametrize(
    ("before", "end"), [(signal.SIG_DFL, KeyboardInterrupt), (signal.SIG_IGN, SystemExit)], ids=["closed", "nohup"]
)
def test_a_terminal_that_is_closed_interrupts_but_for_nohup(
    before: signal.Handlers, end: type[BaseException], monkeypatch: pytest.MonkeyPatch
) -> None:
    known = {number: signal.getsignal(number) for number in (signal.SIGTERM, signal.SIGHUP)}
    monkeypatch.setattr(entry, "app", lambda: os.kill(os.getpid(), signal.SIGHUP))
    signal.signal(signal.SIGHUP, before)
    try:
        with pytest.raises(end):
            entry.main()
    finally:
        for number, handler in known.items():
            signal.signal(number, handler)


@pytest.mark.parametrize(("encoding", "found"), [("latin-1", r"\u2013"), ("ascii", r"\xfc")])
def test_a_terminal_that_cannot_write_a_name_is_said(
    encoding: str, found: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def app() -> None:
        "nave s\u00fcd \u2013 \u03b1".encode(encoding)

    monkeypatch.setattr(entry, "app", app)
    monkeypatch.setattr("signal.signal", lambda *_: None)
    with pytest.raises(SystemExit) as ended:
        entry.main()
    assert ended.value.code == 2
    error = capsys.readouterr().err
    assert f"found {found}. Set LC_ALL=C.UTF-8" in error.replace("\n", " ")
    assert error.isascii()


def test_a_folder_whose_name_is_no_text_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / os.fsdecode("gr\xfc\xdfe".encode("latin-1"))
    folder.mkdir()
    case_file(folder, WALL)
    monkeypatch.chdir(folder)
    monkeypatch.setattr(entry, "app", lambda: claim(tmp_path / "run", Path("case.toml")))
    monkeypatch.setattr("signal.signal", lambda *_: None)
    with pytest.raises(SystemExit) as ended:
        entry.main()
    assert ended.value.code == 2
    error = capsys.readouterr().err
    assert "not in UTF-8" in error
    assert r"gr\xfc\xdfe/case.toml. Rename it." in error


@pytest.mark.parametrize("bad", [False, True], ids=["results", "no run"])
def test_a_reader_that_has_left_is_no_error(bad: bool, tmp_path: Path) -> None:
    if not bad:
        write_json(tmp_path / "summary.json", EMPTY)
    with subprocess.Popen(
        [sys.executable, "-m", "churchpipe", "show", tmp_path], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout
        assert process.stderr
        process.stdout.close()
        said = process.stderr.read()
    assert (process.returncode, "no results" in said) == ((1, True) if bad else (0, False))
    assert "Traceback" not in said


@pytest.mark.parametrize(("command", "code"), [("--help", 0), ("run --help", 0), ("run --bogus", 2)])
def test_a_reader_of_the_help_may_leave(command: str, code: int) -> None:
    with subprocess.Popen(
        [sys.executable, "-m", "churchpipe", *command.split()], stdout=subprocess.PIPE, stderr=subprocess.STDOUT
    ) as process:
        assert process.stdout
        process.stdout.close()
    assert process.returncode == code


@pytest.mark.parametrize("closed", ["<&-", ">&-", "2>&-", "<&- >&- 2>&-"])
def test_streams_may_be_closed(closed: str, tmp_path: Path) -> None:
    case = tmp_path / "arch.toml"
    case.write_text(sample_case("arch"), encoding="utf-8")
    line = f"exec {sys.executable} -m churchpipe check {case} {closed}"
    done = subprocess.run(["sh", "-c", line], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert ("27 stones" in done.stdout) == (">&-" not in closed.replace("2>&-", ""))


@pytest.mark.parametrize("number", ["0", "-1", "99999999999"])
def test_no_such_number_of_jobs(capsys: pytest.CaptureFixture[str], number: str, tmp_path: Path) -> None:
    case = tmp_path / "arch.toml"
    case.write_text(sample_case("arch"), encoding="utf-8")
    code, _, said = call(capsys, "run", case, "--jobs", number, "--out", tmp_path / "run")
    assert code == 2
    assert "--jobs" in said
    assert not (tmp_path / "run").exists()
