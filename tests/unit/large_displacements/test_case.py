"""Capacity curves in a case: settings, artifact, record."""

import re
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import pyvista

import churchpipe as cp
from case_texts import case_file
from churchpipe import compare, stages
from churchpipe.config.case import Case
from churchpipe.config.plan import plan
from churchpipe.configuring import configure
from churchpipe.errors import InputError
from churchpipe.io.npz import read_npz, write_npz
from churchpipe.io.recording import curve_record_of
from churchpipe.large_displacements.poses import rotation_vectors, screw
from churchpipe.model.block_curve import BlockCapacityCurve
from churchpipe.model.names import GOOD
from churchpipe.model.results import LimitState
from churchpipe.model.stone_path import FallenStones
from churchpipe.report.block_curves import block_curve_plots
from churchpipe.report.frames import frames, placed, write_path
from churchpipe.report.notes import status_note
from churchpipe.report.table import Row
from records import analysis
from solids import box, on_ground

CASE = """
name = "pier"
[source]
generator = "wall"
length_mm = 600
height_mm = 1800
thickness_mm = 300
brick_mm = [600, 300, 300]
[material.default]
unit_weight_kN_m3 = 18
friction = 0.6
[[load]]
direction = [0, 1, 0]
"""
PUSH = cp.LoadCase((1, 0, 0))
DRY = cp.Material("default", 18e3, 0.6)
BLOCK = on_ground(box((0, 0.5), (0, 1), (0, 2)))


@pytest.fixture(scope="module")
def curve() -> BlockCapacityCurve:
    return cp.block_pushover(BLOCK, cp.find_contacts(BLOCK), PUSH, 0.6, step=0.05)


def read(tmp_path: Path, more: str) -> Case:
    path = tmp_path / "case.toml"
    path.write_text(CASE + more, encoding="utf-8")
    return cp.read_case(path)


def test_a_case_asks_for_a_curve_of_each_load(tmp_path: Path) -> None:
    case = read(tmp_path, "[rigid.curve]\nstep_mm = 20\ncontrol_mm = [0, 0, 1800]\n[[load]]\ndirection = [0, -1, 0]\n")
    todo = plan([case])
    assert [(entry["kind"], entry["name"]) for entry in todo.index["analyses"] if entry["kind"] == "curve"] == [
        ("curve", "+y_curve"),
        ("curve", "-y_curve"),
    ]
    settings = todo.analyses["+y_curve"]
    assert (settings["step"], settings["steps"], settings["control"]) == (0.02, 400, (0.0, 0.0, 1.8))
    assert "furthest" not in settings
    assert settings["halo"] == 5
    begins = [entry["begins_from"] for entry in todo.index["analyses"] if entry["kind"] == "curve"]
    assert [[todo.analyses[name]["flow"] for name in names] for names in begins] == [["associative"], ["associative"]]
    both = plan([read(tmp_path, '[rigid]\nflow = ["associative", "non-associative"]\n[rigid.curve]\n')])
    begins = [entry["begins_from"] for entry in both.index["analyses"] if entry["kind"] == "curve"]
    assert [both.analyses[name]["flow"] for name in begins[0]] == ["associative", "non-associative"]
    assert not any(entry["kind"] == "curve" for entry in plan([read(tmp_path, "")]).index["analyses"])


def test_a_curve_takes_the_first_contact_model(tmp_path: Path, curve: BlockCapacityCurve) -> None:
    case = read(tmp_path, '[rigid]\ncontact_model = ["torsion", "corners"]\n[rigid.curve]\n')
    settings = next(value for name, value in plan([case]).analyses.items() if name.endswith("curve"))
    assert settings["contact_model"] == "torsion"
    assert curve_record_of(curve, BLOCK, PUSH, [DRY], (), settings["contact_model"]).contact_model == "torsion"


@pytest.mark.parametrize(
    ("lines", "said"),
    [("step_mm = 0", "rigid.curve.step_mm"), ("stpes = 3", "steps"), ("control_mm = [0, 0]", "rigid.curve.control_mm")],
)
def test_bad_keys(tmp_path: Path, lines: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        read(tmp_path, f"[rigid.curve]\n{lines}\n")


def test_the_artifact_comes_back(tmp_path: Path, curve: BlockCapacityCurve) -> None:
    whole = replace(curve, fallen=(FallenStones(0.1, np.array([1]), 2),))
    write_npz(tmp_path / "curve.npz", whole)
    again = read_npz(tmp_path / "curve.npz", BlockCapacityCurve)
    assert (again.status, again.d0, len(again.fallen)) == (curve.status, curve.d0, 1)
    assert again.fallen[0].stones.tolist() == [1]
    assert np.array_equal(again.position, curve.position)


def test_the_record(curve: BlockCapacityCurve) -> None:
    record = curve_record_of(curve, BLOCK, PUSH, [DRY])
    assert (record.model, record.method, record.status, record.ending) == ("rigid-block", "curve", "converged", "vanished")
    assert record.d0 == pytest.approx(0.25, abs=1e-6)
    assert record.load_factor == pytest.approx(0.25, abs=1e-6)
    assert curve_record_of(curve, BLOCK, PUSH, [cp.Material("default", 18e3, 0.6, 1e3)]).message.startswith("cohesion")
    # A step that is not proved, and stones that do not stand, are bad news.
    doubtful = replace(curve, residual=curve.residual + 1e-3)
    assert curve_record_of(doubtful, BLOCK, PUSH, [DRY]).status == "not-converged"
    late = replace(curve, misfit=np.append(curve.misfit[:-1], 0.05))
    record, count = curve_record_of(late, BLOCK, PUSH, [DRY]), len(curve.misfit)
    assert f"only the first {count - 1} of its {count} steps are proved; a shorter step may prove more" in record.message
    assert status_note(BLOCK, Row(record)).startswith("The capacity curve is not proved to its end")
    fallen = on_ground(box((0, 1), (0, 1), (0, 1)), box((0.6, 1.6), (0, 1), (1, 2)))
    unstable = curve_record_of(cp.block_pushover(fallen, cp.find_contacts(fallen), PUSH), fallen, PUSH, [DRY])
    assert unstable.status not in GOOD


def test_the_report_shows_each_load_once(curve: BlockCapacityCurve) -> None:
    record = curve_record_of(curve, BLOCK, PUSH, [DRY])
    swept = {"material.default.friction": 0.5}
    other = replace(record, swept=swept, d0=None, ending="unfinished", fallen_stones=("a7",), fell_at=(0.1,))
    ((load, plot, sentences),) = block_curve_plots([record, other, analysis(method="limit")], None)
    assert load == "+x"
    assert plot.lstrip().startswith("<")
    assert (
        sentences[0]
        == "friction 0.6: it starts at a load factor of 0.2500 and ends at 250 mm, where the load factor has vanished."
    )
    assert sentences[1].startswith("friction 0.5")
    assert sentences[1].endswith("not followed further. On the way fell a7 (at 100 mm).")
    assert block_curve_plots([record], "other") == []
    assert "no equilibria" not in plot
    # A curve against a control point that goes backwards is seen as one that goes forwards is.
    ticks = [
        {float(text.replace("\u2212", "-")) for text in re.findall(r">([\u2212\d.]+)</text>", seen)}
        for seen in (
            plot,
            block_curve_plots([replace(record, displacement=tuple(-place for place in record.displacement or ()))], None)[0][1],
        )
    ]
    assert {-200.0, 0.0} < ticks[1]
    assert {0.0, 200.0} < ticks[0]
    assert max(ticks[1]) < 1.0 <= -min(ticks[1])
    # Variants of one geometry are in one plot.
    ((_, plot, sentences),) = block_curve_plots([record, replace(record, variant="tied")], None)
    assert [sentence.partition(":")[0] for sentence in sentences] == ["friction 0.6", "tied, friction 0.6"]
    assert ">tied, friction 0.6<" in plot
    jumping = replace(curve, misfit=np.where(np.arange(len(curve.misfit)) == 2, 3.0, 0.0))
    assert curve_record_of(curve, BLOCK, PUSH, [DRY]).no_equilibria == ()
    jumped = curve_record_of(jumping, BLOCK, PUSH, [DRY])
    assert jumped.no_equilibria == (3,)
    ((_, plot, sentences),) = block_curve_plots([jumped], None)
    assert "friction 0.6, no equilibria" in plot
    assert sentences[0].endswith("Crosses are no equilibria: there the structure jumps, or stones of it hang.")


def test_the_report_marks_the_steps_that_are_not_proved(curve: BlockCapacityCurve) -> None:
    count = len(curve.misfit)
    late = curve_record_of(replace(curve, misfit=np.append(curve.misfit[:-2], [0.05, 0.5])), BLOCK, PUSH, [DRY])
    assert late.proved_steps == count - 2
    ((_, plot, (sentence,)),) = block_curve_plots([late], None)
    assert f"Beyond {1e3 * curve.displacement[-3]:.3g} mm (hollow points) the steps are not proved" in sentence
    assert "steps not proved" in plot
    # Nothing is marked where all are proved, nor where an old record does not say; all is where none is.
    for record in (curve_record_of(curve, BLOCK, PUSH, [DRY]), replace(late, proved_steps=None)):
        ((_, plot, (sentence,)),) = block_curve_plots([record], None)
        assert "not proved" not in sentence + plot
    ((_, _, (sentence,)),) = block_curve_plots([replace(late, proved_steps=0)], None)
    assert "From the first step on (hollow points)" in sentence


def test_curves_take_no_part_in_the_advice_nor_in_the_comparison(curve: BlockCapacityCurve) -> None:
    record = replace(curve_record_of(curve, BLOCK, PUSH, [DRY]), name="a")
    shell = replace(record, name="s", model="homogenised-shell", method="limit")
    assert compare.guidance([record, replace(record, load_factor=0.1)]) == []
    assert compare.pairs([record, shell]) == []


def test_the_curve_of_the_shell_stands_in_the_same_diagram(curve: BlockCapacityCurve) -> None:
    record = curve_record_of(curve, BLOCK, PUSH, [DRY])
    shell = {"model": "homogenised-shell", "method": "pushover", "friction": 0.6, "control_point": 7}
    shell |= {"control_mm": [0.0, 5.0, 900.0], "load_factors": [0.0, 0.2, 0.24]}
    ((_, plot, sentences),) = block_curve_plots([record, analysis(**shell)], None)
    assert "shell, friction 0.6" in plot
    assert sentences[-1].startswith("Dashed: the shell at small displacements")
    assert sentences[-1].endswith("node 7.")


def test_the_path_for_paraview(tmp_path: Path, curve: BlockCapacityCurve) -> None:
    stones = on_ground(box((0, 0.5), (0, 1), (0, 2)))
    series = tmp_path / "path.pvd"
    (tmp_path / "path_99.vtu").touch()
    write_path(series, stones, curve)
    files = sorted(file.name for file in tmp_path.glob("*.vtu"))
    assert files == [f"path_{number:02d}.vtu" for number in range(len(frames(len(curve.displacement))))]
    written = [line for line in series.read_text().splitlines() if "DataSet" in line]
    assert [line.split('file="')[1].split('"')[0] for line in written] == files
    # Where the last file has the stone is where the curve left it.
    last = pyvista.read(tmp_path / files[-1]).points
    assert last == pytest.approx(placed(stones, curve.position[-1], curve.rotation[-1]).points, abs=1e-9)
    assert frames(100)[[0, -1]].tolist() == [0, 99]
    write_path(series, stones, cp.block_pushover(FALLEN, cp.find_contacts(FALLEN), PUSH))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("travel", ["grows", "goes back", "stands still"])
def test_the_files_for_paraview_have_times_in_their_order(tmp_path: Path, curve: BlockCapacityCurve, travel: str) -> None:
    # Viewers sort files by their times, and show those of one time together.
    steps = len(curve.displacement)
    gone = {"grows": curve.displacement, "goes back": -curve.displacement, "stands still": np.zeros(steps)}[travel]
    write_path(tmp_path / "path.pvd", BLOCK, replace(curve, displacement=gone))
    reader = pyvista.PVDReader(tmp_path / "path.pvd")
    expected = curve.displacement[frames(steps)] if travel == "grows" else frames(steps) + 1
    assert [part.time for part in reader.datasets] == pytest.approx(expected)
    assert reader.time_values == sorted(part.time for part in reader.datasets)


def test_the_files_for_paraview_say_which_stones_have_fallen(tmp_path: Path, curve: BlockCapacityCurve) -> None:
    falls = replace(curve.until(3), fallen=(FallenStones(float(curve.displacement[1]), np.array([1]), 1),))
    write_path(tmp_path / "path.pvd", BLOCK, falls)
    found = [pyvista.read(tmp_path / f"path_0{step}.vtu") for step in range(4)]
    by_stone = [dict(zip(mesh["stone"].tolist(), mesh["fallen"].tolist(), strict=True)) for mesh in found]
    assert by_stone == [{0: 0, 1: gone} for gone in (0, 0, 1, 1)]


def test_the_motion_for_paraview_leads_to_the_next_step(tmp_path: Path, curve: BlockCapacityCurve) -> None:
    # A tenth of a radian: past half a turn, where vectors of rotation jump, and about another axis than before.
    turns = (
        [(0, 3.1, 0), (0, 3.2 - 2 * np.pi, 0)],
        [(0, 1.5, 0), rotation_vectors(screw(np.array([[0, 0, 0.1]]))[0] @ ABOUT_Y)[0]],
    )
    for before, after in turns:
        rotation = np.zeros((2, BLOCK.count, 3))
        rotation[0, ~BLOCK.fixed], rotation[1, ~BLOCK.fixed] = before, after
        write_path(tmp_path / "path.pvd", BLOCK, replace(curve.until(1), rotation=rotation))
        first, second = (pyvista.read(tmp_path / f"path_0{number}.vtu") for number in (0, 1))
        assert first.points + first["velocity"] == pytest.approx(second.points, abs=0.5 * 0.1**2 * 1.2)


ABOUT_Y = screw(np.array([[0, 1.5, 0]]))[0]
FALLEN = on_ground(box((0, 1), (0, 1), (0, 1)), box((0.6, 1.6), (0, 1), (1, 2)))


@pytest.mark.slow
def test_a_killed_run_goes_on_from_its_steps(tmp_path: Path) -> None:
    case, out = tmp_path / "case.toml", tmp_path / "run"
    case.write_text(CASE + "[rigid.curve]\nstep_mm = 2\nsteps = 60\n", encoding="utf-8")
    configure(case, out)
    geometry, folder = out / "geometry" / "base", out / "curve" / "+y_curve"
    stages.source(geometry / "settings.json", geometry / "building.json")
    stages.blocks(geometry / "building.json", geometry / "assemblage.npz", geometry / "stones.dxf", geometry / "stones.vtu")
    stages.contacts(geometry / "tolerances.json", geometry / "assemblage.npz", geometry / "contacts.npz")
    given = folder / "settings.json", geometry / "assemblage.npz", geometry / "contacts.npz"
    files = [str(file) for file in (*given, folder / "curve.npz", folder / "curve.json")]
    code = "import pathlib, sys; from churchpipe import stages; stages.curve(*map(pathlib.Path, sys.argv[1:]))"
    with subprocess.Popen([sys.executable, "-c", code, *files]) as run:
        while not list(folder.glob("steps_*.npz")):
            assert run.poll() is None
            time.sleep(0.01)
        run.kill()
    assert not (folder / "curve.npz").exists()
    stages.curve(*map(Path, files))
    found = read_npz(folder / "curve.npz", BlockCapacityCurve)
    assert "continued from step" in found.message
    assert len(found.load_factor) == 60
    assert found.proved
    # A pier of .3 x 1.8 m that rocks about its toe.
    lever = 0.15 - found.displacement
    assert found.load_factor == pytest.approx(lever / np.sqrt((0.3**2 + 1.8**2) / 4 - lever**2), abs=1e-6)
    assert list(folder.glob("steps_*.npz")) == []


def test_steps_are_not_gone_on_from_where_the_curve_begins_from_other_analyses(tmp_path: Path) -> None:
    out = tmp_path / "run"
    configure(case_file(tmp_path, CASE + "[rigid.curve]\nstep_mm = 20\nsteps = 4\n"), out)
    geometry, folder = out / "geometry" / "base", out / "curve" / "+y_curve"
    stages.source(geometry / "settings.json", geometry / "building.json")
    stages.blocks(geometry / "building.json", geometry / "assemblage.npz")
    stages.contacts(geometry / "tolerances.json", geometry / "assemblage.npz", geometry / "contacts.npz")
    inputs = geometry / "assemblage.npz", geometry / "contacts.npz"
    begun, other = tmp_path / "begun.npz", tmp_path / "other.npz"
    stages.rigid(out / "rigid" / "+y_associative" / "settings.json", *inputs, begun, tmp_path / "rigid.json")
    write_npz(other, replace(read_npz(begun, LimitState), message="another start"))
    files = folder / "settings.json", *inputs, folder / "curve.npz", folder / "curve.json"

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    def message(first: Path) -> str:
        with pytest.raises(KeyboardInterrupt):
            stages.curve(*files, begun, progress=interrupt)
        assert list(folder.glob("steps_*.npz"))
        stages.curve(*files, first)
        return read_npz(folder / "curve.npz", BlockCapacityCurve).message

    assert "continued from step" in message(begun)
    assert "continued from step" not in message(other)


def test_a_line_load_travels_with_the_top_of_its_wall(tmp_path: Path) -> None:
    # A pier .3 x 1.8 m, .6 m long, with P on the middle of its top, which moves with it.
    out = tmp_path / "run"
    more = '[[line_loads]]\nname = "roof"\nwall = "wall"\ndead_kN_m = 4\n[rigid.curve]\nstep_mm = 10\n'
    configure(case_file(tmp_path, CASE + more), out)
    geometry, folder = out / "geometry" / "base", out / "curve" / "+y_curve"
    stages.source(geometry / "settings.json", geometry / "building.json")
    stages.blocks(geometry / "building.json", geometry / "assemblage.npz", geometry / "stones.dxf", geometry / "stones.vtu")
    stages.contacts(geometry / "tolerances.json", geometry / "assemblage.npz", geometry / "contacts.npz")
    stages.curve(
        folder / "settings.json",
        geometry / "assemblage.npz",
        geometry / "contacts.npz",
        folder / "curve.npz",
        folder / "curve.json",
    )
    found = read_npz(folder / "curve.npz", BlockCapacityCurve)
    weight, carried, b, h = 0.6 * 0.3 * 1.8 * 18.0, 4 * 0.6, 0.3, 1.8
    assert found.load_factor[0] == pytest.approx((weight + carried) * b / 2 / (weight * h / 2 + carried * h), rel=1e-6)
    turn = np.linalg.norm(found.rotation[:, int(np.argmax(found.position[0, :, 2]))], axis=1)
    low, high = ((b / 2 * np.cos(turn) - z * np.sin(turn), z * np.cos(turn) + b / 2 * np.sin(turn)) for z in (h / 2, h))
    expected = (weight * low[0] + carried * high[0]) / (weight * low[1] + carried * high[1])
    assert found.load_factor == pytest.approx(expected, abs=1e-6)
    assert found.status == "vanished"
