"""Records of analyses: checked, the same when read again, and in units of a person in summary.json."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from churchpipe.errors import InputError
from churchpipe.io.recording import shell_record_of
from churchpipe.io.records import (
    Curve,
    LeftOut,
    Outcome,
    Question,
    RigidRecord,
    ShellRecord,
    Sliding,
    read_record,
    write_record,
)
from churchpipe.io.tie_records import Gain
from churchpipe.model.joint_group import JointGroup
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import Material
from churchpipe.model.results import CapacityCurve, CapacityStep

QUESTION = Question("-y", (0.0, -1.0, 0.0), {"tuff": 0.6, "brick": 0.5}, {"tuff": 2500.0, "brick": 2500.0})
OUTCOME = Outcome("optimal", 0.2065, 0.20649, 0.20651, 1e-9, 0.0, 17, 1.23456, "interior-point", "")
SLIDING = Sliding(1e-7, (0.19, 0.21), 3e-9, (0.2, 0.205), (0.24, 0.2))
RECORDS = [
    RigidRecord(QUESTION, OUTCOME, "associative"),
    RigidRecord(QUESTION, OUTCOME, "non-associative", SLIDING),
    ShellRecord(QUESTION, OUTCOME, "limit", "cell"),
    ShellRecord(QUESTION, Outcome("converged", 0.2216), "pushover", "paper", Curve(3, (0.0, 0.0015), (0.0, 0.1))),
    LeftOut("the two models do not match"),
]


@pytest.mark.parametrize("record", RECORDS)
def test_records_come_back(record: RigidRecord | ShellRecord | LeftOut, tmp_path: Path) -> None:
    write_record(tmp_path / "a.json", record)
    first = (tmp_path / "a.json").read_text()
    back = read_record(tmp_path / "a.json")
    write_record(tmp_path / "b.json", back)
    assert (tmp_path / "b.json").read_text() == first
    assert type(back) is type(record)
    if not isinstance(record, LeftOut):
        assert not isinstance(back, LeftOut)
        assert json.dumps(back.as_words()) == json.dumps(record.as_words())


def test_artifacts_are_in_si_and_summaries_in_the_units_of_their_keys(tmp_path: Path) -> None:
    record = RECORDS[3]
    assert isinstance(record, ShellRecord)
    write_record(tmp_path / "a.json", record)
    stored = json.loads((tmp_path / "a.json").read_text())
    assert stored["question"]["cohesion"] == {"tuff": 2500.0, "brick": 2500.0}
    assert stored["curve"]["control"] == [0.0, 0.0015]
    assert stored["outcome"]["lower_bound"] is None
    words = record.as_words()
    assert (words["cohesion_kPa"], words["friction"]) == (2.5, {"tuff": 0.6, "brick": 0.5})
    assert words["control_mm"] == [0.0, 1.5]
    assert words["steps"] == 2


def test_a_number_that_is_none_comes_back_as_nan(tmp_path: Path) -> None:
    write_record(tmp_path / "a.json", RigidRecord(QUESTION, Outcome("unstable"), "associative"))
    back = read_record(tmp_path / "a.json")
    assert isinstance(back, RigidRecord)
    assert math.isnan(back.outcome.load_factor)


@pytest.mark.parametrize("text", ["[]", "{}", '{"schema": "churchpipe rigid-record 1"}', '{"schema": "other"}'])
def test_what_is_no_record_is_named(text: str, tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text(text)
    with pytest.raises(InputError, match=r"a\.json.*run the case again"):
        read_record(tmp_path / "a.json")


def test_values_are_checked() -> None:
    with pytest.raises(InputError, match="status: unknown value"):
        Outcome("fine")  # pyright: ignore[reportArgumentType]
    with pytest.raises(InputError, match="iterations: out of range"):
        Outcome("optimal", iterations=-1)
    with pytest.raises(InputError, match="friction of tuff: out of range"):
        Question("-y", (0.0, -1.0, 0.0), {"tuff": -0.6}, {})
    with pytest.raises(InputError, match="flow: unknown value"):
        RigidRecord(QUESTION, OUTCOME, "sliding")
    with pytest.raises(InputError, match="displacements without load factors"):
        Curve(0, (0.0,), ())


def test_what_was_refused_says_why() -> None:
    record = shell_record_of(
        "friction: too large", LoadCase((1, 0, 0)), [Material("m", 1.0, 1.2)], method="limit", planes="paper"
    )
    words = record.as_words()
    assert (words["status"], words["message"], words["friction"]) == ("failed", "friction: too large", 1.2)


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


def test_what_would_help_the_walls_is_kept(tmp_path: Path) -> None:
    gains = (Gain("north", 1.5e-5, -2e-6), Gain("south", 0.0, 3e-6))
    record = RigidRecord(QUESTION, OUTCOME, "associative", gains=gains)
    write_record(tmp_path / "r.json", record)
    assert read_record(tmp_path / "r.json") == record
    first = record.as_words()["gains"][0]
    assert (first["panel"], first["cohesion_1_kPa"], first["weight_1_kN"]) == (
        "north",
        pytest.approx(1.5e-2),
        pytest.approx(-2e-3),
    )


def test_joints_of_their_own_are_kept(tmp_path: Path) -> None:
    groups = [JointGroup("damp course", kind="base", friction=0.3), JointGroup("anchors", between=("beam", "west"), cohesion=5e4)]
    load = LoadCase((1, 0, 0))
    record = shell_record_of("refused", load, [Material("m", 1.0, 0.6)], method="limit", planes="cell", joints=groups)
    write_record(tmp_path / "r.json", record)
    assert read_record(tmp_path / "r.json") == record
    assert record.as_words()["joints"] == [
        {"name": "damp course", "kind": "base", "friction": 0.3},
        {"name": "anchors", "between": ["beam", "west"], "cohesion_kPa": 50.0},
    ]
