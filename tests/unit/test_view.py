"""The page of a model before any analysis: a case, a drawing, a mesh; names, walls, openings, and hostile names."""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from case_texts import WALL, case_file
from churchpipe import cli
from churchpipe.dxf.writer import write_dxf
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import Material
from churchpipe.report import colours
from corpus_files import CORPUS
from damaged_drawings import SAMPLES
from solids import box, on_ground

CASE = Path(__file__).parents[2] / "pipeline" / "cases" / "wall.toml"
HOSTILE = "</script><script>alert(1)</script>"


def viewed(folder: Path, monkeypatch: pytest.MonkeyPatch, file: Path, *options: str) -> tuple[int, str]:
    """The exit code of `view`, and the page it wrote."""
    monkeypatch.chdir(folder)
    monkeypatch.setattr("sys.argv", ["churchpipe", "view", str(file), "--no-open", *options])
    with pytest.raises(SystemExit) as left:
        cli.main()
    page = folder / f"{file.stem}.view.html"
    return int(left.value.code or 0), page.read_text(encoding="utf-8") if page.is_file() else ""


def data(page: str) -> dict:
    found = re.search(r'<script id="viewer-data" type="application/json">(.*?)</script>', page, re.DOTALL)
    assert found
    return json.loads(found[1])


def test_a_case_is_shown_with_its_openings(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    code, page = viewed(tmp_path, monkeypatch, CASE, "--set", "material.default.friction=5")
    assert code == 0
    assert capsys.readouterr().out == "wall.view.html\n"
    assert re.search(r"opening[\w-]* 0\.80 × 1\.00 m", page)
    assert "wall 250 mm" in page
    near, far = (np.array(outline["points"]) for outline in data(page)["outlines"])
    assert np.allclose(np.ptp(near, axis=0), [0.8, 0.0, 1.0])
    assert np.allclose(np.abs(near - far).max(axis=0), [0.0, 0.25, 0.0])
    assert "friction" in page
    assert "Questions" in page


def test_a_drawing_and_a_mesh_are_shown(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    code, page = viewed(tmp_path, monkeypatch, SAMPLES / "s5.dxf")
    assert code == 0
    assert "churchpipe import" in page
    assert len(data(page)["panels"]) > 1
    assert "<h2>Walls</h2>" in page
    assert viewed(tmp_path, monkeypatch, CORPUS / "sound.obj", "--units", "m", "--support", "base")[0] == 0


def test_a_drawing_with_errors_is_shown_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    code, page = viewed(tmp_path, monkeypatch, CORPUS / "open-body.dxf")
    assert code == 1
    assert "E10" in page


def test_names_from_drawings_are_text(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stones = on_ground(box((0, 1), (0, 0.5), (0, 1)), box((0, 1), (0, 0.5), (1, 2)), unit_weight=2e4, reach=3)
    named = replace(stones, panel=np.array(["", HOSTILE, HOSTILE]), block_id=np.array(["ground", HOSTILE, "b"]))
    file = tmp_path / "named.dxf"
    write_dxf(named, file, materials=[Material("default", 2e4, 0.6)], loads=[LoadCase((1, 0, 0))])
    code, page = viewed(tmp_path, monkeypatch, file)
    assert code == 0
    assert "<script>alert" not in page
    assert HOSTILE in [panel["name"] for panel in data(page)["panels"]]
    assert "&lt;script&gt;alert(1)" in page


# A roof, a tie that only a variant has, and a beam; without the beam the variant would be of the same stones, too.
CARRYING = """
[[line_loads]]
name = "roof"
wall = "wall"
dead_kN_m = 3
[[ring_beams]]
walls = ["wall"]
height_m = 0.2
[[variants]]
name = "tied"
[[variants.add.ties]]
name = "<b>bar</b>"
start = { wall = "wall", along_m = 0.3, height_m = 0.3 }
end = { wall = "wall", along_m = 0.9, height_m = 0.3 }
area_mm2 = 100
steel_strength_MPa = 235
[[variants]]
name = "without the beam"
remove = ["ring_beams"]
"""


def test_what_a_case_carries_is_shown(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    code, page = viewed(tmp_path, monkeypatch, case_file(tmp_path, WALL + CARRYING))
    assert code == 0
    shown = data(page)
    (tie,) = shown["loads"]["ties"]
    assert tie["added"]
    assert np.abs(np.subtract(*tie["ends"]))[0] == pytest.approx(0.6)
    directions = np.array([arrow["direction"] for arrow in shown["loads"]["arrows"]])
    assert len(directions)
    assert np.allclose(directions, [0, 0, -1])
    assert [panel["colour"] for panel in shown["panels"] if panel["name"].startswith("beam ")] == [colours.BEAM]
    for words in ("line load roof", "Ring beams", "&lt;b&gt;bar", "dashed: only in a variant"):
        assert words in page
    assert "What the building carries" not in viewed(tmp_path, monkeypatch, case_file(tmp_path, WALL, "bare.toml"))[1]


def test_a_load_that_stands_nowhere_is_named_with_its_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    far = WALL + CARRYING.replace("along_m = 0.9", "along_m = 9")
    assert viewed(tmp_path, monkeypatch, case_file(tmp_path, far))[0] == 1
    said = capsys.readouterr().err
    assert "case.toml:" in said
    assert "along" in said


def test_what_a_drawing_carries_is_shown(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = f"""
[source]
dxf = "{SAMPLES / "s5.dxf"}"
[material.default]
unit_weight_kN_m3 = 28.6
friction = 0.7
[[load]]
direction = [0, 1, 0]
[[line_loads]]
wall = "main"
dead_kN_m = 1
"""
    code, page = viewed(tmp_path, monkeypatch, case_file(tmp_path, text))
    assert code == 0
    assert data(page)["loads"]["arrows"]
