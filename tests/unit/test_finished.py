"""Results that lie in a run folder are told again without the engine, and only if nothing differs at all."""

import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from case_texts import WALL, case_file
from churchpipe.engine import UNFINISHED
from churchpipe.finished import RECORD, asked, finished, note_finished, run_name


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[Path, Path]:
    """A case file, and a folder with its run."""
    monkeypatch.chdir(tmp_path)
    case, folder = case_file(tmp_path, WALL), Path("run")
    for name in (".snakemake/state", "plan.json", "rigid/+x/rigid.json"):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text("{}")
    note_finished(folder, asked(case, ["load.scale=2"], None), good=True)
    return case, folder


def test_the_same_case_with_the_same_changes_is_finished(run: tuple[Path, Path]) -> None:
    case, folder = run
    assert finished(folder, case, ["load.scale=2"]) is True
    # What the engine keeps for itself is no result.
    (folder / ".snakemake" / "state").write_text("else")
    assert finished(folder, case, ["load.scale=2"]) is True


def test_another_question_is_not(run: tuple[Path, Path]) -> None:
    case, folder = run
    assert finished(folder, case, []) is None
    case.write_text(case.read_text() + "\n")
    assert finished(folder, case, ["load.scale=2"]) is None


@pytest.mark.parametrize(
    "disturb",
    [
        lambda folder: (folder / "plan.json").write_text("[]"),
        lambda folder: os.utime(folder / "plan.json", (0, 0)),
        lambda folder: (folder / "rigid" / "+x" / "rigid.json").unlink(),
        lambda folder: (folder / UNFINISHED).touch(),
    ],
    ids=["edited", "another date", "deleted", "stopped later"],
)
def test_a_folder_that_was_touched_is_not(run: tuple[Path, Path], disturb: Callable[[Path], object]) -> None:
    case, folder = run
    disturb(folder)
    assert finished(folder, case, ["load.scale=2"]) is None


@pytest.mark.parametrize("text", ["", "{}", "[]", '{"question": '])
def test_a_damaged_record_is_none(text: str, run: tuple[Path, Path]) -> None:
    case, folder = run
    (folder / RECORD).write_text(text)
    assert finished(folder, case, ["load.scale=2"]) is None


def test_a_file_that_an_editor_has_open_is_no_result(run: tuple[Path, Path]) -> None:
    case, folder = run
    # So Emacs marks it, by a link to nowhere.
    (folder / ".#plan.json").symlink_to("somebody@somewhere.123")
    note_finished(folder, asked(case, [], None), good=True)
    assert finished(folder, case, []) is True
    (folder / ".#plan.json").unlink()
    assert finished(folder, case, []) is True


def test_a_copy_of_a_folder_tells_of_its_own_files(run: tuple[Path, Path]) -> None:
    case, folder = run
    copy = Path("copy")
    shutil.copytree(folder, copy)
    assert finished(copy, case, ["load.scale=2"]) is True
    (copy / "rigid" / "+x" / "rigid.json").write_text("{")
    assert finished(copy, case, ["load.scale=2"]) is None
    assert finished(folder, case, ["load.scale=2"]) is True


def test_a_drawing_is_a_part_of_the_question(tmp_path: Path) -> None:
    case, drawing = case_file(tmp_path, WALL), tmp_path / "stones.dxf"
    drawing.write_text("0")
    note_finished(tmp_path / "run", asked(case, [], drawing), good=False)
    assert finished(tmp_path / "run", case, []) is False
    drawing.write_text("1 2")
    assert finished(tmp_path / "run", case, []) is None


@pytest.mark.parametrize("other", ["a.obj", "c.obj"], ids=["edited", "added"])
def test_a_folder_of_stones_is_a_part_of_the_question_with_all_its_files(other: str, tmp_path: Path) -> None:
    case, stones = case_file(tmp_path, WALL), tmp_path / "stones"
    stones.mkdir()
    for name in ("a.obj", "b.obj"):
        (stones / name).write_text("v 0 0 0\n")
    note_finished(tmp_path / "run", asked(case, [], stones), good=True)
    assert finished(tmp_path / "run", case, []) is True
    (stones / other).write_text("v 0 0 0\nv 1 0 0\n")
    assert finished(tmp_path / "run", case, []) is None


def test_the_files_beside_a_model_of_lmgc90_are_a_part_of_the_question(tmp_path: Path) -> None:
    case, model = case_file(tmp_path, WALL), tmp_path / "model" / "DATBOX" / "BODIES.DAT"
    model.parent.mkdir(parents=True)
    model.write_text("$bdyty\n")
    for drawing in (model, model.parent, model.parent.parent):
        driven = model.with_name("DRV_DOF.DAT")
        driven.unlink(missing_ok=True)
        for text in ("$bdyty\n", "$bdyty\n$nodty\n"):
            note_finished(tmp_path / "run", asked(case, [], drawing), good=True)
            assert finished(tmp_path / "run", case, []) is True
            driven.write_text(text)
            assert finished(tmp_path / "run", case, []) is None


@pytest.mark.parametrize("edited", ["case", "drawing", ""])
def test_what_is_edited_during_a_run_is_not_answered_by_it(edited: str, tmp_path: Path) -> None:
    case, drawing = case_file(tmp_path, WALL), tmp_path / "stones.dxf"
    drawing.write_text("0")
    begun = asked(case, [], drawing)
    if edited:
        path = case if edited == "case" else drawing
        path.write_text(path.read_text() + "\n")
    note_finished(tmp_path / "run", begun, good=True)
    assert finished(tmp_path / "run", case, []) is (None if edited else True)


def test_nothing_is_finished_that_never_ran(tmp_path: Path) -> None:
    assert finished(tmp_path, case_file(tmp_path, WALL), []) is None


def test_the_name_of_a_run_is_that_of_the_case_or_of_its_file(tmp_path: Path) -> None:
    case = tmp_path / "mine.toml"
    case.write_text('name = "church"')
    assert run_name(case) == "church"
    case.write_text("name =")
    assert run_name(case) == ""
    case.write_text("")
    assert run_name(case) == "mine"
