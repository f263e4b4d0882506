"""The page of a model before any analysis: a case, a drawing, a mesh; names, walls, openings, and hostile names."""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from churchpipe import cli
from churchpipe.dxf.writer import write_dxf
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import Material
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
    return json.loads(re.search(r'<script id="viewer-data" type="application/json">(.*?)</script>', page, re.DOTALL)[1])


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
