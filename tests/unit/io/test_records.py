"""Records of analyses: checked, the same when read again, and in units of a person in summary.json."""

import csv
import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.errors import InputError
from churchpipe.io.atomic import canonical_json, write_json
from churchpipe.io.movement_record import widest_cracks
from churchpipe.io.recording import shell_record_of
from churchpipe.io.records import Analysis, read_record, write_record
from churchpipe.io.summary import read_summary
from churchpipe.io.tables import COLUMNS, write_table
from churchpipe.io.tie_records import Gain, TieCandidate, TieForce
from churchpipe.mechanism import Part
from churchpipe.model.checks import SafetyCheck
from churchpipe.model.joint_group import JointGroup
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import Material
from churchpipe.model.quantities import as_read, as_written, declared
from churchpipe.model.results import CapacityCurve, CapacityStep
from records import EMPTY, analysis
from solids import box, on_ground

ASSOCIATIVE = replace(
    analysis(flow="associative", contact_model="corners", friction={"tuff": 0.6, "brick": 0.5}, cohesion_kPa=2.5, iterations=17),
    lower_bound=0.20649,
    upper_bound=0.20651,
    tie_forces=(TieForce("rod", 3e3, 4e3, 0.75, False, "bar", 1e-6),),
    tie_candidates=(TieCandidate("new", 4e3, 1e-6, 0.3, 0.25),),
    gains=(Gain("north", 1.5e-5, -2e-6, 0.3, 0.2),),
    parts=(Part("nave", 2e4, 1.0, 0.5, 0.75),),
    joints=(JointGroup("anchors", between=("beam", "west"), cohesion=5e4),),
    swept={"source.courses": 3},
)
SLIDING = replace(
    ASSOCIATIVE,
    flow="non-associative",
    gap=1e-7,
    interval=(0.19, 0.21),
    friction_violation=3e-9,
    fixed_points=(0.2, 0.205),
    history=(0.24, 0.2),
)
PUSHOVER = replace(
    analysis(
        model="homogenised-shell", method="pushover", planes="paper", cohesion_kPa=2.5, friction={"tuff": 0.6, "brick": 0.5}
    ),
    element_size=0.06,
    control_point=3,
    control=(0.0, 0.0015),
    load_factors=(0.0, 0.1),
    steps=2,
)
RECORDS = [ASSOCIATIVE, SLIDING, PUSHOVER, analysis(model="homogenised-shell", method="limit", status="left-out")]


@pytest.mark.parametrize("record", RECORDS)
def test_records_come_back(record: Analysis, tmp_path: Path) -> None:
    write_record(tmp_path / "a.json", record)
    assert read_record(tmp_path / "a.json", Analysis) == record
    assert as_read(Analysis, json.loads(canonical_json(as_written(record, defaults=False)))) == record


def test_artifacts_are_in_si_and_summaries_in_the_units_of_their_keys(tmp_path: Path) -> None:
    write_record(tmp_path / "a.json", PUSHOVER)
    stored = json.loads((tmp_path / "a.json").read_text())
    assert stored["cohesion"] == 2500.0
    assert stored["control"] == [0.0, 0.0015]
    assert stored["lower_bound"] is None
    words = as_written(PUSHOVER, defaults=False)
    assert (words["cohesion_kPa"], words["friction"]) == (2.5, {"tuff": 0.6, "brick": 0.5})
    assert words["control_mm"] == [0.0, 1.5]
    assert words["steps"] == 2
    assert words["variant"] is None
    assert "lower_bound" not in words
    words = as_written(ASSOCIATIVE, defaults=False)
    assert [words["tie_forces"][0][key] for key in ("tension_kN", "strength_kN")] == [3.0, 4.0]
    assert words["tie_forces"][0]["sensitivity_1_kN"] == pytest.approx(1e-3)
    assert words["tie_candidates"][0]["rate_1_kN"] == pytest.approx(1e-3)
    gain = words["gains"][0]
    assert [gain["cohesion_1_kPa"], gain["weight_1_kN"]] == pytest.approx([1.5e-2, -2e-3])
    # Load factors, with so much more: their keys end with what is more, and not with a unit of theirs.
    assert (gain["panel"], gain["with_10_kPa"], gain["with_10_kN"]) == ("north", 0.3, 0.2)
    assert words["parts"][0]["weight_kN"] == 20.0
    assert words["joints"] == [{"name": "anchors", "between": ["beam", "west"], "cohesion_kPa": 50.0}]


def test_a_number_that_is_none_comes_back_as_nan(tmp_path: Path) -> None:
    write_record(tmp_path / "a.json", replace(ASSOCIATIVE, load_factor=math.nan, status="unstable", history=(0.2, math.nan)))
    back = read_record(tmp_path / "a.json", Analysis)
    assert math.isnan(back.load_factor)
    assert back.history is not None
    assert math.isnan(back.history[1])


@pytest.mark.parametrize("text", ["[]", "{}", '{"schema": "churchpipe rigid-record 1"}', '{"schema": "other"}'])
def test_what_is_no_record_is_named(text: str, tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text(text)
    with pytest.raises(InputError, match=r"a\.json.*run the case again"):
        read_record(tmp_path / "a.json", Analysis)


def test_what_is_damaged_is_named(tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text('{"schema": "churchpipe analysis 1", "load": "+x"}')
    with pytest.raises(InputError, match=r"a\.json: a damaged record.*run the case again"):
        read_record(tmp_path / "a.json", Analysis)
    write_json(tmp_path / "summary.json", EMPTY | {"analyses": [{"load": "+x"}]})
    with pytest.raises(InputError, match=r"a summary of another version.*run the case again"):
        read_summary(tmp_path / "summary.json")


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"status": "fine"}, "status: unknown value"),
        ({"iterations": -1}, "iterations: out of range"),
        ({"friction": {"tuff": -0.6}}, "friction of tuff: out of range"),
        ({"flow": "sliding"}, "flow: unknown value"),
        ({"control": (0.0,), "load_factors": ()}, "displacements without load factors"),
    ],
)
def test_values_are_checked(change: dict, said: str) -> None:
    with pytest.raises(InputError, match=said):
        replace(analysis(), **change)


def test_what_was_refused_says_why() -> None:
    record = shell_record_of(
        "friction: too large", LoadCase((1, 0, 0)), [Material("m", 1.0, 1.2)], method="limit", planes="paper"
    )
    assert (record.status, record.message, record.friction) == ("failed", "friction: too large", 1.2)
    left_out = shell_record_of("no match", LoadCase((1, 0, 0)), [], method="limit", planes="cell", status="left-out")
    assert left_out.status == "left-out"


def test_a_curve_is_checked_and_frozen() -> None:
    step = CapacityStep(0.0, 0.0, 1e-9, 0.0, 1e-9, 12, 0.5)
    good = {
        "load_factor": np.zeros(1), "control": np.zeros(1), "control_point": 1, "displacement": np.zeros((2, 3)),
        "edge_rotation": np.zeros(1), "plastic": np.zeros((1, 6)), "multipliers": np.zeros((1, 8)), "steps": (step,),
        "status": "converged",
    }  # fmt: skip
    with pytest.raises(ValueError, match="read-only"):
        CapacityCurve(**good).load_factor[0] = 1.0
    for change in ({"control_point": 2}, {"control": np.zeros(2)}, {"status": "fine"}, {"plastic": np.zeros((1, 5))}):
        with pytest.raises(InputError, match="CapacityCurve"):
            CapacityCurve(**good | change)


def test_columns_of_the_table_are_keys_of_a_record() -> None:
    # A unit that changes in the record changes here, too.
    known = {item.key for kind in (Analysis, SafetyCheck) for item in declared(kind).values()}
    assert set(COLUMNS) <= known


def test_ground_is_no_wall_whatever_its_name() -> None:
    # Stones of no wall have no name, as ground of a drawing has none: the joints of a wall with it are of that wall alone.
    stones = replace(on_ground(box((0, 1), (0, 1), (0, 1)), box((3, 4), (0, 1), (0, 1))), panel=np.array(["", "wall", ""]))
    contacts = cp.find_contacts(stones)
    opening = np.where((contacts.blocks == 1).any(axis=1), 2e-3, 1e-3)
    found = widest_cracks(stones, contacts, opening, 2 * opening)
    assert [(crack.wall, crack.opening, crack.slip) for crack in found] == [("wall", 2e-3, 4e-3), ("", 1e-3, 2e-3)]


def test_the_table_tells_analyses_apart(tmp_path: Path) -> None:
    """By their names, which are the same in summary.json, and by the cohesion and the size of the elements."""
    shell = analysis(name="-y_limit", model="homogenised-shell", method="limit", cohesion_kPa=50.0, element_size_mm=300.0)
    named = analysis(name="=2+5_associative", flow="associative", cohesion_kPa={"tuff": 20.0, "brick": 50.0})
    write_table(tmp_path / "table.csv", [shell, named])
    with (tmp_path / "table.csv").open(encoding="utf-8") as file:
        first, second = csv.DictReader(file)
    assert (first["name"], first["cohesion_kPa"], first["element_size_mm"]) == ("-y_limit", "50.0", "300.0")
    assert second["name"] == "'=2+5_associative"
    assert second["cohesion_kPa"] == "{'tuff': 20.0, 'brick': 50.0}"
    assert second["element_size_mm"] == ""
