"""Sections of vaults in the report: which macro-elements are vaults, their lines of thrust, the rings of domes."""

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.generators import arch, dome, vault
from churchpipe.model.building import Building
from churchpipe.report.html import write_report
from churchpipe.report.table import Row
from churchpipe.report.thrust import section_figure
from churchpipe.report.vault_sections import vault_sections
from churchpipe.thrust_lines import vaulted
from records import analysis, summary

WALLS: dict[str, Any] = {"wall_height": 1.0, "wall_thickness": 0.3, "wall_course": 0.25}
BARREL: dict[str, Any] = {"span": 1.8, "thickness": 0.2, "courses": 13, "stone_length": 0.5, "length": 1.0} | WALLS
DRUM: dict[str, Any] = {"drum_height": 0.5, "drum_thickness": 0.3, "drum_course": 0.25}
DOME: dict[str, Any] = {"span": 1.8, "thickness": 0.2, "rings": 7, "sides": 16} | DRUM


def pushed(building: Building, degrees: float = 0.0, **record: object) -> tuple[cp.Assemblage, cp.Contacts, Row]:
    stones, angle = cp.derive_blocks(building), np.radians(degrees)
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    stones = replace(stones, points=stones.points @ turn.T, centroid=stones.centroid @ turn.T)
    contacts = cp.find_contacts(stones)
    state = cp.limit_analysis(stones, contacts, cp.LoadCase((1, 0, 0)), friction=0.7)
    keys = ("flow", "load_factor", "lower_bound", "upper_bound", "status", "iterations", "seconds")
    return stones, contacts, Row(analysis(**{key: getattr(state, key) for key in keys} | record), state)


def test_a_barrel_on_walls_has_one_section_across_it() -> None:
    stones, contacts, row = pushed(vault(**BARREL))
    across = vaulted(stones, contacts)
    assert list(across) == ["vault"]
    # Its beds look along x.
    assert across["vault"][1, 1] == pytest.approx(0.0, abs=1e-12)
    (section,) = vault_sections(stones, contacts, [row])
    assert section.label == "vault: associative, load +x, friction 0.7"
    assert section.words.startswith("Thrust in 14 joints of the section")
    assert "joints are hinges" in section.words
    assert section.drawing.startswith("<svg")
    assert section.rings == ()


@pytest.mark.parametrize(
    ("building", "strip"),
    [
        (vault(span=1.8, thickness=0.2, courses=13, stone_length=0.5, length=2.0), 0.5),
        # Stones that are longer across the vault than along it.
        (arch(mean_radius=1.0, thickness=0.2, width=0.2, voussoirs=11), 0.2),
        (dome(span=1.8, thickness=0.2, rings=5, sides=16), None),
    ],
)
def test_the_strip_of_a_section_does_not_depend_on_how_the_vault_is_turned(building: Building, strip: float | None) -> None:
    told: list[tuple[float, float]] = []
    for degrees in (0.0, 37.0):
        stones, contacts, _ = pushed(building, degrees)
        along = cp.LoadCase((np.cos(np.radians(degrees)), np.sin(np.radians(degrees)), 0))
        state = cp.limit_analysis(stones, contacts, along, friction=0.7)
        (section,) = vault_sections(stones, contacts, [Row(analysis(load_factor=state.load_factor), state)])
        ((most, width),) = re.findall(r"(\S+) kN at most in a strip of (\S+) m;", section.words)
        told.append((float(most), float(width)))
    assert told[0][1] == told[1][1] == (strip or told[0][1])
    if strip:
        # Of a dome the section along x is another one. Forces are not unique along a vault, but nearly so.
        assert told[0][0] == pytest.approx(told[1][0], rel=0.02)


@pytest.mark.parametrize("degrees", [0.0, 30.0])
@pytest.mark.parametrize("corner", ["round", "mitre"])
def test_a_groin_vault_has_the_arch_at_its_end_and_no_rings(corner: str, degrees: float) -> None:
    """Its courses are no rings: no hoop goes round them. Along the middle of a barrel there is hardly a bed."""
    building = vault(span=1.7, thickness=0.3, courses=9, stone_length=0.4, kind="groin", corner=corner)
    stones, contacts, row = pushed(building, degrees)
    (section,) = vault_sections(stones, contacts, [row])
    # Beds of nine courses from springing to springing.
    assert section.words.startswith("Thrust in 10 joints of the section")
    assert section.rings == ()


def test_a_pavilion_has_rings() -> None:
    stones, contacts, row = pushed(vault(span=1.7, thickness=0.3, courses=9, stone_length=0.8, kind="pavilion"))
    (section,) = vault_sections(stones, contacts, [row])
    assert len(section.rings) == 5


@pytest.mark.parametrize(
    ("building", "joints"),
    [(vault(**BARREL, laid="rings"), 27), (arch(mean_radius=1.0, thickness=0.2, width=0.5, voussoirs=12), 13)],
)
def test_rings_of_voussoirs_have_a_section(building: Building, joints: int) -> None:
    stones, contacts, row = pushed(building)
    (section,) = vault_sections(stones, contacts, [row])
    assert section.words.startswith(f"Thrust in {joints} joints of the section")
    assert section.rings == ()


@pytest.mark.slow
def test_a_dome_has_the_forces_of_its_rings_beside(tmp_path: Path) -> None:
    stones, contacts, row = pushed(dome(**DOME))
    (section,) = vault_sections(stones, contacts, [row])
    assert section.label.startswith("dome: ")
    assert len(section.rings) == 7
    # The lowest bed carries the dome.
    weight = stones.weight[stones.panel == "dome"].sum() / 1e3
    assert float(section.rings[0][3]) == pytest.approx(weight, abs=0.01)
    assert row.state is not None
    page = tmp_path / "report.html"
    given = {"summary": replace(summary(case="dome"), analyses=(row.record,)), "case_text": "", "versions": {}}
    write_report(page, stones=stones, contacts=contacts, results=[(row.record, row.state)], **given)
    assert "Lines of thrust in vaults and domes" in page.read_text(encoding="utf-8")


def test_the_value_without_dilatancy_is_drawn_where_there_is_one() -> None:
    stones, contacts, row = pushed(vault(**BARREL))
    sliding = Row(replace(row.record, flow="non-associative"), row.state)
    (section,) = vault_sections(stones, contacts, [row, sliding])
    assert section.label.startswith("vault: non-associative")


def test_walls_and_analyses_without_forces_have_no_section() -> None:
    stones, contacts, row = pushed(vault(**BARREL))
    assert "wall_left" not in vaulted(stones, contacts)
    assert row.state is not None
    lost = cp.LimitState(0.1, "failed", 0.1, 0.1, np.full_like(row.state.forces, np.nan), row.state.velocities)
    assert vault_sections(stones, contacts, [Row(row.record, lost)]) == []


@pytest.mark.parametrize("through", [0.5, 0.4])
def test_stones_that_a_section_cuts_are_drawn_however_long_they_are(through: float) -> None:
    """Those of the walls are five times as long as the strip is wide. At .5 m two stones of every other course meet."""
    stones, contacts, row = pushed(vault(**BARREL))
    assert row.state
    place, direction, width = (0.0, through), (1.0, 0.0), 0.1
    line = cp.thrust_line(stones, contacts, row.state.forces, "vault", place, direction, width)
    figure = section_figure(stones, line, ("vault", "wall_left", "wall_right"), place, direction, width)
    drawn = [patch.get_path().vertices for patch in figure.axes[0].patches]
    for middle in (0.125, 0.375, 0.625, 0.875):
        sides = {float(np.sign(corner[:, 0].mean())) for corner in drawn if corner[:, 1].min() < middle < corner[:, 1].max()}
        assert sides == {-1.0, 1.0}, middle
