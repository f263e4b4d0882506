"""What a safety check says of a building that does not stand, and of loads that it cannot judge: never nothing."""

from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import churchpipe as cp
from churchpipe import compare
from churchpipe.code_check import Site
from churchpipe.io.records import Analysis
from churchpipe.loading.placing import place_loads
from churchpipe.model.checks import SafetyCheck
from churchpipe.model.placed_loads import Applied
from churchpipe.report.safety import check_table, overall
from churchpipe.report.table import Row
from churchpipe.run_folder import RunFolder
from churchpipe.terminal import remarks
from records import analysis, summary
from solids import box, on_ground

SITE = Site(ground_acceleration=1.5, soil_factor=1.2)
# Its centre lies .25 m beyond the edge of the block that bears it.
STONES = on_ground(box((0, 1), (0, 1), (0, 1)), box((0.5, 2), (0, 1), (1, 2)))
CONTACTS = cp.find_contacts(STONES)


def falling(direction: tuple[float, float, float] = (1, 0, 0)) -> tuple[cp.LimitState, cp.LoadCase]:
    load = cp.LoadCase(direction)
    state = cp.limit_analysis(STONES, CONTACTS, load, friction=0.6)
    assert state.status == "unstable"
    return state, load


def row(load: str, check: SafetyCheck | None, **more: Any) -> Row:
    return Row(replace(analysis(load=load, **more), check=check))


def test_what_does_not_stand_withstands_no_earthquake() -> None:
    check = compare.safety(STONES, *falling(), SITE)
    assert (check.satisfied, check.zeta_e, check.a_g_slv, check.a_g) == (False, 0.0, 0.0, 1.5)
    assert check.message == "the structure does not stand under its own weight"
    # Where the case says nothing of the site there is nothing to satisfy.
    assert compare.safety(STONES, *falling(), None).satisfied is None


@pytest.mark.parametrize(("asked", "status"), [(True, "unstable"), (True, "unbounded"), (False, "unstable")])
def test_a_run_checks_what_does_not_stand(asked: bool, status: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    state, load = falling()
    settings = {"load": {"direction": load.direction.tolist()}, "material": {"default": {}}}
    run = RunFolder(tmp_path, {})
    monkeypatch.setattr("churchpipe.run_folder.read_json", lambda _: settings)
    monkeypatch.setattr("churchpipe.run_folder.load_of", lambda _: load)
    monkeypatch.setattr(RunFolder, "stones", lambda *_: (STONES, CONTACTS))
    monkeypatch.setattr(RunFolder, "block_state", lambda *_: state)
    monkeypatch.setattr(RunFolder, "applied", lambda *_: Applied(place_loads(STONES, [])))
    entry = {"kind": "rigid", "name": "+x", "geometry": "base"} | ({"check": asdict(SITE)} if asked else {})
    found = run._mechanism(entry, status)
    assert ("check" in found) == (asked and status == "unstable")
    assert not found or found["check"].satisfied is False


def test_the_verdict_is_not_that_of_the_building_that_stands() -> None:
    good = SafetyCheck(zeta_e=2.7, a_g=1.5, satisfied=True)
    rows = [row("+x", compare.safety(STONES, *falling(), SITE), status="unstable", load_factor=None), row("-x", good)]
    found = overall(rows, ["+x", "-x"])
    assert found is not None
    assert not found["satisfied"]
    assert "under +x it does not stand even under its own weight" in found["words"]
    assert "is 0.00 (" in found["words"]
    table = check_table(rows)
    assert table is not None
    assert (table["sited"], [label for label, _ in table["refused"]]) == (True, [rows[0].label])


def test_loads_without_a_check_are_named_at_the_head_and_in_the_terminal() -> None:
    refused = SafetyCheck(message="check: the load is not horizontal", a_g=1.5)
    rows = [row("+x", SafetyCheck(zeta_e=2.7, a_g=1.5, satisfied=True)), row("up", refused), row("-x", None, status="unbounded")]
    found = overall(rows, ["+x", "up", "-x"])
    assert found is not None
    assert found["satisfied"]
    assert found["words"].endswith(f"There is no check of: {rows[1].label}.")
    # Of a load that multiplies what is carried none is expected, but where there is no other.
    axle = Row(replace(row("axle", refused).record, multiplies=("axle",)))
    found = overall([rows[0], axle], ["+x", "axle"])
    assert found is not None
    assert "There is no check" not in found["words"]
    found = overall([axle], ["axle"])
    assert found is not None
    assert f"No load of the case has a check: {axle.label}." in found["words"]
    # A slanted load alone is told of as well.
    records: tuple[Analysis, ...] = (rows[1].record,)
    said = remarks(replace(summary(), analyses=records))
    assert any("load up, rigid blocks" in line and "no safety check, the load is not horizontal" in line for line in said)


def test_loads_of_which_none_has_a_check_are_named_at_the_head() -> None:
    refused = SafetyCheck(message="check: the load is not horizontal", a_g=1.5)
    rows = [row("up", refused), row("-x", None, status="unbounded")]
    found = overall(rows, ["up", "-x"])
    assert found is not None
    assert found["satisfied"] is None
    assert found["words"].startswith(f"No load of the case has a check: {rows[0].label}. ")
    table = check_table(rows)
    assert table is not None
    assert table["refused"] == [(rows[0].label, refused.message)]
    # Where the case says nothing of the site it asks for no verdict.
    assert overall([row("up", replace(refused, a_g=np.nan))], ["up"]) is None


def test_a_load_that_is_not_horizontal_leaves_the_site_known() -> None:
    stones = on_ground(box((0, 1), (0, 1), (0, 2)))
    load = cp.LoadCase((1, 0, 0.2))
    state = cp.limit_analysis(stones, cp.find_contacts(stones), load, friction=0.6)
    check = compare.safety(stones, state, load, SITE)
    assert (check.satisfied, check.a_g) == (None, 1.5)
    assert check.message.startswith("the load is not horizontal")
    assert np.isnan(check.zeta_e)
