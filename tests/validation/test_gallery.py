"""The table of docs/gallery.md: the ready cases at collapse, associative, each under the first load of its file."""

import re

import pytest

import churchpipe as cp
from churchpipe.compare import safety
from manual_pages import ROOT

PAGE = (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8")
ROWS = [row.split(" | ") for row in re.findall(r"^\| (\w+ \| \d+ \| .*) \|$", PAGE, flags=re.MULTILINE)]
QUICK = ("arch", "thick_wall", "wall")


def check_row(row: list[str]) -> None:
    name, count, direction, factor, _moves, mass_fraction, acceleration = map(str.strip, row)
    case = cp.read_case(ROOT / "pipeline" / "cases" / f"{name}.toml")
    load = case.loads[0]
    stones = cp.derive_blocks(case.building())
    contacts = cp.find_contacts(stones)
    state = cp.limit_analysis(stones, contacts, load, *cp.joint_strength(stones, contacts, case.materials))
    assert (int((~stones.fixed).sum()), load.name) == (int(count), direction)
    assert state.load_factor == pytest.approx(float(factor), abs=5.1e-5)
    check = safety(stones, state, load, case.check)
    # Which stones creep and which stand hangs on the last digits of the velocities.
    assert check["mass_fraction"] == pytest.approx(float(mass_fraction), abs=2e-3)
    assert check["a0_m_s2"] == pytest.approx(float(acceleration), rel=5e-3)


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
