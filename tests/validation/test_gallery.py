"""The table of docs/gallery.md, the ready cases at collapse, associative, each under the first load of its file; and that of
docs/check.md, what a0* of the stones hangs on."""

import re

import pytest

import churchpipe as cp
from churchpipe.compare import safety
from churchpipe.config.case import Case
from manual_pages import ROOT

PAGE = (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8")
ROWS = [row.split(" | ") for row in re.findall(r"^\| (\w+ \| \d+ \| .*) \|$", PAGE, flags=re.MULTILINE)]
QUICK = ("arch", "thick_wall", "wall")


def solved(name: str) -> tuple[Case, cp.Assemblage, cp.LimitState]:
    case = cp.read_case(ROOT / "pipeline" / "cases" / f"{name}.toml")
    stones = cp.derive_blocks(case.building())
    contacts = cp.find_contacts(stones)
    strength = cp.joint_strength(stones, contacts, case.materials)
    return case, stones, cp.limit_analysis(stones, contacts, case.loads[0], *strength)


def check_row(row: list[str]) -> None:
    name, count, direction, factor, _moves, mass_fraction, acceleration = map(str.strip, row)
    case, stones, state = solved(name)
    load = case.loads[0]
    assert (int((~stones.fixed).sum()), load.name) == (int(count), direction)
    assert state.load_factor == pytest.approx(float(factor), abs=5.1e-5)
    check = safety(stones, state, load, case.check)
    # Which stones creep and which stand hangs on the last digits of the velocities.
    assert check.mass_fraction == pytest.approx(float(mass_fraction), abs=2e-3)
    assert check.a0 == pytest.approx(float(acceleration), rel=5e-3)


def test_the_page_has_all_pictures() -> None:
    pictures = set(re.findall(r"pictures/gallery/(\w+)\.png", PAGE))
    assert {row[0] for row in ROWS} == pictures
    assert set(QUICK) < pictures


@pytest.mark.parametrize("row", [row for row in ROWS if row[0] in QUICK], ids=lambda row: row[0])
def test_a_small_case(row: list[str]) -> None:
    check_row(row)


@pytest.mark.slow("docs/gallery.md: load factors, e* and a0* of the ready cases")
@pytest.mark.parametrize("row", [row for row in ROWS if row[0] not in QUICK], ids=lambda row: row[0])
def test_a_case(row: list[str]) -> None:
    check_row(row)


def check_shares(name: str, column: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Compare e* and a0* of the stones for each share of the speed from which on a stone is said to move, and a0* with e* = 1."""
    page = (ROOT / "docs" / "check.md").read_text(encoding="utf-8")
    rows = re.findall(r"^ +\| \**1/([\d ]+)\** \| (.*) \|$", page, flags=re.MULTILINE)
    assert len(rows) == 4
    [lumped] = re.findall(r"^ +\| e\\\* = 1 \| (.*) \|$", page, flags=re.MULTILINE)
    case, stones, state = solved(name)
    for share, cells in rows:
        monkeypatch.setattr("churchpipe.mechanism.STILL", 1.0 / int(share.replace(" ", "")))
        check = safety(stones, state, case.loads[0], case.check)
        fraction, acceleration = map(float, cells.split(" | ")[column].split(", "))
        assert check.mass_fraction == pytest.approx(fraction, abs=5e-3)
        assert check.a0 == pytest.approx(acceleration, rel=1e-2)
        # Stones that creep weigh something and do nothing: a0* with e* = 1 is that of the others.
        assert check.a0_lumped == pytest.approx(float(lumped.split(" | ")[column]), rel=2e-2)


@pytest.mark.parametrize(("name", "column"), [("wall", 0), ("box", 1)])
def test_what_is_said_to_move(name: str, column: int, monkeypatch: pytest.MonkeyPatch) -> None:
    check_shares(name, column, monkeypatch)
