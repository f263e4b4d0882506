"""The tutorial: its case is sound at every step, and gives the numbers that the page prints."""

import json
import re
from pathlib import Path

import pytest

from churchpipe import cli
from churchpipe.config.case import read_case, read_variants
from manual_pages import ROOT, case_of_the_tutorial

PAGE = (ROOT / "docs" / "tutorial.md").read_text(encoding="utf-8")
STEPS = 3


def called(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> int:
    monkeypatch.setattr("sys.argv", ["churchpipe", *arguments])
    with pytest.raises(SystemExit) as left:
        cli.main()
    return int(left.value.code or 0)


@pytest.mark.parametrize("count", [1, pytest.param(2, marks=pytest.mark.slow), STEPS])
def test_the_case_is_sound_after_each_step(count: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("nave.toml").write_text(case_of_the_tutorial(count), encoding="utf-8")
    assert called(monkeypatch, "check", "nave.toml") == 0
    assert [case.name for case in read_variants("nave.toml")] == ["nave"] * (2 if count == STEPS else 1)
    assert {panel.name for panel in read_case("nave.toml").building().panels} >= {"facade", "nave_left", "nave_right", "east"}


def load_factors(folder: Path) -> dict[tuple[str | None, str], float]:
    records = json.loads((folder / "summary.json").read_text(encoding="utf-8"))["analyses"]
    return {(record.get("variant") or None, record["load"]): record["load_factor"] for record in records}


@pytest.mark.slow("docs/tutorial.md: load factors of the nave, with its roof and with ties")
def test_the_numbers_of_the_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    rows = re.findall(r"^\| ([+-][xy]) \| (\.\d+) \|(?: (\.\d+) \|)?$", PAGE, flags=re.MULTILINE)
    assert len(rows) == 4
    for text, printed in ((case_of_the_tutorial(1), rows[:2]), (case_of_the_tutorial(), rows[2:])):
        Path("nave.toml").write_text(text, encoding="utf-8")
        assert called(monkeypatch, "run", "nave.toml", "--out", "run") == 0
        found = load_factors(Path("run"))
        if text != case_of_the_tutorial(1):
            indices = re.search(r"It is ([\d.]+) across the nave and ([\d.]+) for the facade", PAGE)
            assert indices
            checked = json.loads(Path("run", "summary.json").read_text(encoding="utf-8"))["analyses"][:2]
            assert [f"{record['check']['zeta_e']:.2f}" for record in checked] == [*indices.groups()]
            assert all(record["check"]["satisfied"] for record in checked)
        for load, bare, tied in printed:
            assert found[None, load] == pytest.approx(float(bare), abs=5e-5)
            if tied:
                assert found["two ties", load] == pytest.approx(float(tied), abs=5e-5)
