"""Names that are markup, formulas, commands to a terminal, of other scripts or endless: shown, never obeyed."""

import csv
import html
import io
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from rich.console import Console

import churchpipe as cp
from churchpipe.io.tables import write_table
from churchpipe.io.vtu import write_vtu
from churchpipe.report.joints_vtu import write_joints
from churchpipe.terminal import results_table
from records import analysis, summary

NAMES = {
    "markup": "</script></title><img src=x onerror=alert(1)>&amp;",
    "quotes": "\"'`${1}{{ 7 * 7 }}{% raw %}",
    "line ends": "one\ntwo\r\nthree",
    "terminal": "[bold]x[/red]",
    "formula": '=HYPERLINK("http://x")',
    "right to left": "\u202e\u05d0\u05d1",
    "emoji": "\U0001f9f1\U0001f3f0",
    "long": "long " * 400,
    "a path": "../../a/b\\c:d",
}


@pytest.mark.parametrize("name", NAMES.values(), ids=NAMES.keys())
def test_a_name_is_text_wherever_it_stands(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if name != NAMES["markup"]:
        # A mechanism is drawn in seconds, and no name stands in it.
        monkeypatch.setattr("churchpipe.report.html.mechanism_pictures", lambda _: nullcontext(lambda: ""))
    cube = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    polyhedra = [(cube - [0, 0, 1], faces), (cube, faces)]
    stones = cp.Assemblage.from_polyhedra(
        polyhedra, unit_weight=18e3, fixed=[0], material=name, panel=["ground", name], block_id=["ground", name]
    )
    contacts = cp.find_contacts(stones)
    load = cp.LoadCase((1, 0, 0), name=name)
    materials = [cp.JointStrength(name, friction=0.6)]
    state = cp.limit_analysis(stones, contacts, load, friction=0.6)
    cp.write_report(tmp_path / "r.html", stones, contacts, [(load, state)], materials=materials, name=name)
    page = (tmp_path / "r.html").read_text(encoding="utf-8")
    assert "<img src=x" not in page
    assert html.escape(name[:40].split("\n")[0], quote=False).replace('"', "&#34;").replace("'", "&#39;") in page
    record = analysis(load=name, flow="associative", load_factor=0.5)
    write_table(tmp_path / "t.csv", [record])
    with (tmp_path / "t.csv").open(newline="", encoding="utf-8") as file:
        (row,) = csv.DictReader(file)
    assert row["load"] == (f"'{name}" if name.startswith("=") else name)
    console = Console(file=io.StringIO(), width=200, markup=False)
    console.print(results_table(replace(summary(case=name), analyses=(record,))))
    write_vtu(tmp_path / "m.vtu", stones, state.velocities)
    write_joints(tmp_path / "j.vtu", stones, contacts, state)
    for file, kept in (("m.vtu", "name"), ("j.vtu", "second")):
        ElementTree.parse(tmp_path / file)
        assert kept in (tmp_path / file).read_text(encoding="utf-8")


@pytest.mark.parametrize("name", NAMES.values(), ids=NAMES.keys())
def test_a_name_comes_back_from_a_drawing_or_is_refused(name: str, tmp_path: Path) -> None:
    cube = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    polyhedra = [(cube - [0, 0, 1], faces), (cube, faces)]
    stones = cp.Assemblage.from_polyhedra(polyhedra, unit_weight=18e3, fixed=[0], material=name, block_id=["ground", name])
    try:
        cp.write_dxf(stones, tmp_path / "d.dxf", materials=[cp.Material(name, unit_weight=18e3, friction=0.6)])
    except cp.InputError:
        assert not (tmp_path / "d.dxf").exists()
        return
    found, _ = cp.read_dxf(tmp_path / "d.dxf")
    assert name in found.block_id
