"""Supports that move, in a case: settings, stage, record, report."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import churchpipe as cp
from case_texts import case_file
from churchpipe import compare, stages
from churchpipe.closure import code_of
from churchpipe.config.case import Case
from churchpipe.config.plan import plan
from churchpipe.configuring import configure
from churchpipe.errors import InputError
from churchpipe.io.atomic import read_json
from churchpipe.io.kept_steps import KeptSteps
from churchpipe.io.movement_record import Turn, movement_record
from churchpipe.io.npz import read_npz, write_npz
from churchpipe.io.summary import read_summary, write_summary
from churchpipe.model.quantities import as_written, in_unit
from churchpipe.model.settlement import SettlementPath
from churchpipe.model.stone_path import no_step
from churchpipe.report.movements import movements_shown
from churchpipe.run_folder import read_run
from records import summary
from solids import box, on_ground

CASE = """
[source]
generator = "wall"
length_m = 1.6
brick_mm = [400, 250, 200]
courses = 5
[material.default]
unit_weight_kN_m3 = 18
friction = 0.6
"""
CORNER = 'name = "corner"\nwithin_mm = [[-100, -500], [500, 500]]\nfurthest_mm = 20\nstep_mm = 10\n'


def read(tmp_path: Path, lines: str) -> Case:
    return cp.read_case(case_file(tmp_path, f"{CASE}[[movements]]\n{lines}"))


def test_a_case_that_only_moves_a_support(tmp_path: Path) -> None:
    case = read(tmp_path, CORNER)
    assert case.loads == ()
    todo = plan([case])
    assert todo.index["movements"] == [{"name": "corner", "geometry": "base", "variant": None, "swept": {}}]
    settings = todo.movements["corner"]
    assert (settings["within"], settings["furthest"]) == (((-0.1, -0.5), (0.5, 0.5)), 0.02)
    assert settings["direction"] == (0.0, 0.0, -1.0)
    assert read(tmp_path, 'support = "wall"\n').movements[0].name == "wall"


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ("", "movements.0: one support is needed"),
        ('support = "wall"\nwithin_mm = [[0, 0], [1, 1]]', "movements.0: one support is needed"),
        ('support = "wall"\ndirection = [0, 0, 0]', "movements.0.direction: no direction"),
        ('support = "wall"\nfurthest_deg = 2', "an angle of a support that moves along"),
        ('support = "wall"\nabout_mm = [0, 0, 0]\nfurthest_mm = 2', "a length of a support that turns"),
        ('support = "wall"\nstep_mm = 0', "movements.0.step_mm"),
        ('support = "wall"\nfurthest_mm = 1e-9', "movements.0.furthest_mm: wrong value; found 1e-09"),
        ('support = "wall"\nabout_mm = [0, 0, 0]\nfurthest_deg = 400', "movements.0.furthest_deg: wrong value; found 400"),
        ('support = "wall"\nabout_mm = [0, 0, 0]\nfurthest_deg = 5e-5', "movements.0.furthest_deg: wrong value; found 5e-05"),
        ('suport = "wall"', 'Did you mean "support"?'),
        ('support = "wall"\nfurthest_m = 0.02', 'Did you mean "furthest_mm"?'),
        ('support = "wall"\n[[movements]]\nsupport = "wall"', "two movements of one name"),
    ],
)
def test_bad_keys(tmp_path: Path, lines: str, said: str) -> None:
    with pytest.raises(InputError) as error:
        read(tmp_path, lines)
    assert said in str(error.value)


def staged(tmp_path: Path, lines: str) -> Path:
    """The folder of a run after the stage of its only movement."""
    out = tmp_path / "run"
    configure(case_file(tmp_path, f"{CASE}[[movements]]\n{lines}"), out)
    geometry, (name,) = out / "geometry" / "base", [entry["name"] for entry in read_run(out / "plan.json").index["movements"]]
    stages.source(geometry / "settings.json", geometry / "building.json")
    stages.blocks(geometry / "building.json", geometry / "assemblage.npz", geometry / "stones.dxf", geometry / "stones.vtu")
    stages.contacts(geometry / "tolerances.json", geometry / "assemblage.npz", geometry / "contacts.npz")
    folder = out / "movement" / name
    made = [folder / file for file in ("assemblage.npz", "contacts.npz", "movement.npz", "movement.json")]
    given = folder / "settings.json", geometry / "tolerances.json", geometry / "assemblage.npz", geometry / "contacts.npz"
    stages.movement(*given, *made)
    return out


@pytest.mark.slow
def test_the_stage_its_record_and_the_report(tmp_path: Path) -> None:
    run = read_run(staged(tmp_path, CORNER) / "plan.json")
    (record,) = run.movements()
    assert (record.movement, record.status, record.ending) == ("corner", "converged", "unfinished")
    assert record.displacement[-1] == pytest.approx(0.02, abs=1e-9)
    assert record.cracks[0].wall == "wall"
    assert record.cracks[0].opening == pytest.approx(0.02, rel=1e-3)
    assert record.least_reaction <= record.reaction[0]
    assert run.movements("other") == []
    (shown,) = movements_shown([(record, *run.moved("corner"))])
    assert shown.sentence.endswith("At 20 mm it was not followed further.")
    # Of the two values of the reaction the larger leads, which is careful for the support, whichever it is.
    for reaction in (record.reaction[0], 0.5 * record.least_reaction):
        again = replace(record, reaction=(reaction, *record.reaction[1:]))
        larger = max(reaction, record.least_reaction) / 1e3
        assert f"must resist with {larger:.4g} kN" in movements_shown([(again, *run.moved("corner"))])[0].sentence
    # Two steps of 10 mm, or three: whether a step is cut short at an event as drawn hangs on rounding.
    (halfway, _), (last, _) = shown.maps
    assert halfway in [f"wall, movement {1e3 * moved:.3g} mm" for moved in record.displacement[1:-1]]
    assert last == "wall, movement 20 mm"
    assert all(drawing.startswith("<svg") for _, drawing in shown.maps)
    assert shown.rows[0][0] == "wall"
    assert compare.bad_news(replace(summary(), movements=(record,))) == []
    unstable = replace(record, status="unstable")
    assert compare.bad_news(replace(summary(), movements=(unstable,))) == [unstable]
    # The same again from summary.json, in the units of its keys.
    write_summary(tmp_path / "summary.json", replace(summary(), movements=(record,)))
    assert read_json(tmp_path / "summary.json")["movements"][0]["movement_mm"][-1] == pytest.approx(20, abs=1e-6)
    assert read_summary(tmp_path / "summary.json").movements[0].reaction == pytest.approx(record.reaction)


def test_a_movement_of_the_whole_ground_is_questioned_beside_the_results(tmp_path: Path) -> None:
    lines = 'support = "wall"\nfurthest_mm = 2\n[[movements]]\nsupport = "wall"\nname = "tilt"\nabout_mm = [0, 0, 0]\n'
    out = tmp_path / "run"
    configure(case_file(tmp_path, f"{CASE}[[movements]]\n{lines}[[movements]]\n{CORNER}"), out)
    geometry = out / "geometry" / "base"
    stages.source(geometry / "settings.json", geometry / "building.json")
    stages.blocks(geometry / "building.json", geometry / "assemblage.npz", geometry / "stones.dxf", geometry / "stones.vtu")
    stages.contacts(geometry / "tolerances.json", geometry / "assemblage.npz", geometry / "contacts.npz")
    [asked] = read_run(out / "plan.json").ground_questions()
    assert asked.startswith('The movement "wall" takes along all ground that the building stands on: it moves as a whole')


def test_a_support_that_turns(tmp_path: Path) -> None:
    lines = 'name = "tilt"\nsupport = "ground"\ndirection = [1, 0, 0]\nabout_mm = [0, 125, 0]\nfurthest_deg = 3\nstep_mm = 20\n'
    (record,) = read_run(staged(tmp_path, lines) / "plan.json").movements()
    assert isinstance(record, Turn)
    assert record.turns
    assert {"movement_deg", "least_reaction_kNm"} <= as_written(record).keys()
    assert in_unit(record, "displacement")[0][-1] == pytest.approx(3, abs=1e-6)


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ('support = "nave"\n', "movements, nave: support: no wall or stone of this name on the ground; found nave"),
        ("within_mm = [[9000, 0], [9500, 100]]\n", "movements, rectangle: support: nothing stands on the ground there"),
    ],
)
def test_supports_that_are_not_there(tmp_path: Path, lines: str, said: str) -> None:
    with pytest.raises(InputError) as error:
        staged(tmp_path, lines)
    assert said in str(error.value)


def test_what_cannot_be_moved_is_said() -> None:
    none = np.zeros(0)
    path = SettlementPath(movement=none, reaction=none, **no_step(2), least=np.nan, status="unstable", message="it falls")
    stones = on_ground(box((0, 1), (0, 1), (0, 1)))
    asked = {"name": "a", "about": None, "direction": (0, 0, -1), "without_ties": False}
    (shown,) = movements_shown([(movement_record(path, asked, stones, [], []), stones, cp.find_contacts(stones), path)])
    assert shown.sentence == "It could not be moved: it falls."


def test_the_artifact_comes_back(tmp_path: Path) -> None:
    out = staged(tmp_path, CORNER)
    path = read_npz(out / "movement" / "corner" / "movement.npz", SettlementPath)
    write_npz(tmp_path / "again.npz", path)
    again = read_npz(tmp_path / "again.npz", SettlementPath)
    assert again.status == path.status
    assert np.array_equal(again.rotation, path.rotation)
    assert read_json(out / "plan.json")["analyses"] == []


@pytest.mark.slow
def test_a_killed_run_goes_on_from_its_steps(tmp_path: Path) -> None:
    out = staged(tmp_path, CORNER)
    folder, geometry = out / "movement" / "corner", out / "geometry" / "base"
    given = [folder / "settings.json", geometry / "tolerances.json", geometry / "assemblage.npz", geometry / "contacts.npz"]
    made = [folder / file for file in ("assemblage.npz", "contacts.npz", "movement.npz", "movement.json")]
    whole = read_npz(made[2], SettlementPath)
    kept = KeptSteps(SettlementPath, folder, given, code_of("movement"))
    assert kept.found() is None
    kept.keep(whole.until(1))
    stages.movement(*given, *made)
    again = read_npz(made[2], SettlementPath)
    assert "continued from step 1" in again.message
    assert again.movement[[0, 1, -1]] == pytest.approx(whole.movement[[0, 1, -1]], abs=1e-9)
    assert again.reaction[0] == whole.reaction[0]
    assert list(folder.glob("steps_*.npz")) == []


def test_ties_that_are_left_out_are_told(tmp_path: Path) -> None:
    ends = 'start = { wall = "wall", along_m = 0.2, height_m = 0.9 }\nend = { wall = "wall", along_m = 1.4, height_m = 0.9 }\n'
    tie = f'[[ties]]\nname = "rod"\n{ends}area_mm2 = 100\nsteel_strength_MPa = 200\n'
    path = case_file(tmp_path, f"{CASE}[[movements]]\n{CORNER}{tie}")
    assert plan([cp.read_case(path)]).movements["corner"]["without_ties"]
    assert not plan([read(tmp_path, CORNER)]).movements["corner"]["without_ties"]
    words = {"name": "corner", "about": None, "direction": (0, 0, -1), "without_ties": True}
    stones = on_ground(box((0, 1), (0, 1), (0, 1)))
    moved = cp.settlement_path(stones, cp.find_contacts(stones), [0], step=0.1, furthest=0.1)
    record = movement_record(moved, words, stones, [], [])
    assert record.message.endswith("; ties are left out")
    soft = cp.Material("default", 18e3, 0.6, compressive_strength=2e6)
    told = movement_record(moved, words | {"without_ties": False}, stones, [soft], []).message
    assert told.endswith("; joints crush")
    # Cohesion that stands in [[joints]] alone is left out all the same, and the report says so.
    grouped = movement_record(moved, words, stones, [], [], [cp.JointGroup("mortar", kind="bed", cohesion=5e4)])
    assert "cohesion, which opening joints lose, is left out" in grouped.message
    (shown,) = movements_shown([(grouped, stones, cp.find_contacts(stones), moved)])
    assert shown.sentence.endswith("Cohesion, which opening joints lose, is left out. Ties are left out.")
