"""Results obtained in Python as a report: capacity curves of the stones, their checks, and supports that move."""

import re
from contextlib import nullcontext
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.code_check import Site
from churchpipe.errors import InputError
from churchpipe.spectrum import SiteSpectrum
from report_pages import Page
from solids import box, on_ground

STONES = replace(
    on_ground(*[box((0, 0.4), (0, 1), (i / 2, (i + 1) / 2)) for i in range(4)], unit_weight=2e4),
    panel=np.array(["ground", *["pier"] * 4]),
)
CONTACTS = cp.find_contacts(STONES)
PUSH = cp.LoadCase((1, 0, 0))
MASONRY = (cp.Material("default", 2e4, 0.6),)
SITE = Site(1.5, spectrum=SiteSpectrum(amplification=2.5, start=0.35, soil="C"))
TWO_PADS = cp.Assemblage.from_polyhedra(
    [box((0, 0.5), (0, 1), (-1, 0)), box((3.5, 4), (0, 1), (-1, 0)), box((0, 4), (0, 1), (0, 0.5))], 2e4, fixed=[0, 1]
)


@pytest.fixture(autouse=True)
def without_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """A drawing process costs seconds; what is drawn is tested elsewhere."""
    monkeypatch.setattr("churchpipe.report.html.mechanism_pictures", lambda _: nullcontext(lambda: ""))


@pytest.fixture(scope="module")
def curve() -> cp.BlockCapacityCurve:
    return cp.block_pushover(STONES, CONTACTS, PUSH, 0.6, step=0.02)


@pytest.fixture(scope="module")
def path() -> cp.SettlementPath:
    return cp.settlement_path(TWO_PADS, cp.find_contacts(TWO_PADS), [1], friction=0.6, furthest=0.04, step=0.02)


def written(folder: Path, results: Any = (), **given: Any) -> str:
    stones, contacts = given.pop("stones", STONES), given.pop("contacts", CONTACTS)
    cp.write_report(folder / "r.html", stones, contacts, list(results), materials=MASONRY, **given)
    return (folder / "r.html").read_text(encoding="utf-8")


def test_a_curve_has_its_diagram_crack_map_path_and_check(curve: cp.BlockCapacityCurve, tmp_path: Path) -> None:
    html = written(tmp_path, curve=[(PUSH, curve)], site=SITE)
    text = Page(html).text
    assert "Capacity curve of the stones, load +x." in text
    assert f"it starts at a load factor of {curve.initial:.4f} and ends at {1e3 * curve.d0:.4g} mm" in text
    assert "Crack map: real path, load +x" in text
    # The way of the stones, for the viewer.
    assert "real path, load +x, friction 0.6" in html
    assert html.count("load factor 0.2000") == 1
    rows = {row[0]: row[1:] for row in Page(html).rows if row}
    assert float(rows["d\u2080, with e* = 1"][0].split()[0]) == pytest.approx(1e3 * curve.d0, rel=0.02)
    assert {"SLV", "SLC"} <= rows.keys()


def test_a_bare_curve_is_of_the_load_of_the_results(curve: cp.BlockCapacityCurve, tmp_path: Path) -> None:
    state = cp.limit_analysis(STONES, CONTACTS, PUSH, 0.6)
    text = Page(written(tmp_path, [(PUSH, state)], curve=curve)).text
    assert "Capacity curve of the stones, load +x." in text
    # Without a site there is nothing to compare with, and the acceleration that starts the motion all the same.
    assert "Missing: what the earthquake asks" in text
    with pytest.raises(InputError, match=r"write_report: curve: its load is not known; .*curve=\[\(load, curve\)\]"):
        written(tmp_path, [], curve=curve)
    with pytest.raises(InputError, match="write_report: curve: its load is not known; found 2 loads"):
        written(tmp_path, [(PUSH, state), (cp.LoadCase((-1, 0, 0)), state)], curve=curve)


def test_a_limit_analysis_has_its_safety_check(tmp_path: Path) -> None:
    state = cp.limit_analysis(STONES, CONTACTS, PUSH, 0.6)
    rows = Page(written(tmp_path, [(PUSH, state)], site=Site(1.5, soil_factor=1.2))).rows
    heading = next(row for row in rows if "\u03b6_E" in row)
    found = rows[rows.index(heading) + 1]
    # a_g,SLV = q alpha g / (FC S), over a_g.
    assert found[heading.index("\u03b6_E")] == f"{2 * 0.2 * 9.80665 / 1.35 / 1.2 / 1.5:.2f}"


def test_a_check_of_what_is_pushed_besides_wants_to_know_it(tmp_path: Path) -> None:
    roof = cp.LineLoad("pier", dead=1e4)
    pushed = cp.loaded(PUSH, STONES, [roof])
    state = cp.limit_analysis(STONES, CONTACTS, pushed, 0.6)
    site = Site(1.5, soil_factor=1.2)
    assert "no check" not in Page(written(tmp_path, [(pushed, state)], loads=[roof], site=site)).text
    assert "give what the stones carry as loads=" in Page(written(tmp_path, [(pushed, state)], site=site)).text


def test_a_load_that_pushes_nothing_sideways_has_no_check_and_says_why(tmp_path: Path) -> None:
    beam = cp.Assemblage.from_polyhedra(
        [box((0, 1), (0, 1), (-1, 0)), box((2, 3), (0, 1), (-1, 0)), box((0, 3.5), (0, 1), (0, 0.5))], 2e4, fixed=[0, 1]
    )
    joints, above = cp.find_contacts(beam), cp.load_from_above(beam, (3.25, 0.5), 1e3)
    state = cp.limit_analysis(beam, joints, above, 0.6)
    html = written(tmp_path, [(above, state)], stones=beam, contacts=joints, site=SITE)
    assert "no check. the load pushes no weight: the check is of loads that push the building sideways" in Page(html).text
    assert repr(above) == "Load case: name from above; pushes no weight; live (x, y, z), kN (0, 0, -1)"


def test_a_support_that_moves_has_its_reaction_and_its_cracks(path: cp.SettlementPath, tmp_path: Path) -> None:
    contacts = cp.find_contacts(TWO_PADS)
    text = Page(written(tmp_path, stones=TWO_PADS, contacts=contacts, settlement=path)).text
    assert "support that moves along -z" in text
    assert f"must resist with {path.reaction[0] / 1e3:.4g} kN" in text
    assert "At 40 mm" in text
    # Of other stones than those of the report, as where the ground was cut for it.
    named = Page(written(tmp_path, settlement={"east pier": (TWO_PADS, contacts, path)})).text
    assert "east pier" in named
    assert f"must resist with {path.reaction[0] / 1e3:.4g} kN" in named


@pytest.mark.slow
def test_a_support_that_turns_is_told_in_degrees(tmp_path: Path) -> None:
    contacts = cp.find_contacts(STONES)
    turned = cp.settlement_path(STONES, contacts, [0], (0, 1, 0), friction=0.6, about=(0.4, 0.0, 0.0), furthest=0.02, step=0.02)
    text = Page(written(tmp_path, settlement=turned)).text
    assert "support that turns about +y" in text
    assert "At 1.146 deg" in text


WRONG: list[tuple[dict[str, Any], str]] = [
    ({"curve": 3}, r"write_report: curve: wrong kind; found 3"),
    ({"curve": [PUSH]}, r"write_report: curve\[0\]: wrong kind; found LoadCase"),
    ({"curve": [(PUSH, 3)]}, r"write_report: curve\[0\]: wrong kind; found 3; expected a BlockCapacityCurve"),
    ({"settlement": 3}, r"write_report: settlement: wrong kind; found 3"),
    (
        {"settlement": (STONES, CONTACTS)},
        r"write_report: settlement: no path; found 2 entries; expected stones, contacts and path",
    ),
    ({"settlement": {"a": 3}}, r"write_report: settlement a: wrong kind; found 3"),
    ({"site": 3}, r"write_report: site: wrong kind; found 3; expected a Site"),
    ({"name": 3}, r"write_report: name: wrong kind; found 3; expected a str"),
    ({}, r"write_report: results: nothing to report; found none; expected results, a curve or a settlement"),
]


@pytest.mark.parametrize(("given", "said"), WRONG)
def test_what_is_wrong_is_named(given: dict[str, Any], said: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=said):
        written(tmp_path, **given)


def test_paths_of_other_stones_are_named(curve: cp.BlockCapacityCurve, path: cp.SettlementPath, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"write_report: settlement: a path of other stones; found 3 stones; expected 5"):
        written(tmp_path, settlement=path)
    moved = replace(curve, position=curve.position + 0.1)
    with pytest.raises(InputError, match=r"write_report: curve: a path of other stones; found 173 mm from where stone"):
        written(tmp_path, curve=[(PUSH, moved)])


def test_a_curve_among_the_results_is_told_its_place(curve: cp.BlockCapacityCurve, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"not a result of this model; .* Give capacity curves of the stones as curve="):
        written(tmp_path, [(PUSH, curve)])


@pytest.mark.slow
def test_a_curve_of_another_load_or_of_other_joints_than_its_pair_is_refused(
    curve: cp.BlockCapacityCurve, tmp_path: Path
) -> None:
    sideways = cp.LoadCase((0, 1, 0))
    for given in ([(sideways, curve)], [(PUSH, curve, cp.block_pushover(STONES, CONTACTS, sideways, 0.6, step=0.02))]):
        with pytest.raises(InputError, match="write_report: curve: a curve of another load; found a pair with "):
            written(tmp_path, curve=given)
    state = cp.limit_analysis(STONES, CONTACTS, sideways, 0.6)
    with pytest.raises(InputError, match=r"found a pair with \+y"):
        written(tmp_path, [(sideways, state)], curve=curve)
    smooth = cp.block_pushover(STONES, CONTACTS, PUSH, 0.5, step=0.02)
    with pytest.raises(InputError, match="made with other values; found another friction"):
        written(tmp_path, curve=[(PUSH, curve, smooth)])
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("other", "said"),
    [
        ((0.4, 1.0, (0.5, 0.5, 1.0, 0.5)), "forces that leave 0.25 of the weight"),
        # As heavy, and half as deep: the forces balance, their moments do not.
        ((0.2, 2.0, (0.5, 0.5, 0.5, 0.5)), "a moment of "),
    ],
    ids=["heavier", "of the same weight"],
)
def test_a_state_of_other_stones_with_as_many_joints_is_refused(
    other: tuple[float, float, tuple[float, ...]], said: str, tmp_path: Path
) -> None:
    depth, width, heights = other
    tops = np.cumsum(heights)
    bodies = [box((0, depth), (0, width), (top - height, top)) for top, height in zip(tops, heights, strict=True)]
    stones = on_ground(*bodies, unit_weight=2e4)
    contacts = cp.find_contacts(stones)
    assert (stones.count, len(contacts.point)) == (STONES.count, len(CONTACTS.point))
    for flow in ("associative", "non-associative"):
        state = cp.limit_analysis(stones, contacts, PUSH, 0.6, flow=flow)
        with pytest.raises(InputError, match=r"write_report: results\[0\]: a result of another structure.*" + said):
            written(tmp_path, [(PUSH, state)])
        written(tmp_path, [(PUSH, cp.limit_analysis(STONES, CONTACTS, PUSH, 0.6, flow=flow, contact_model="torsion"))])


def test_a_state_of_another_load_or_of_ties_that_are_not_given_is_refused(tmp_path: Path) -> None:
    state = cp.limit_analysis(STONES, CONTACTS, PUSH, 0.6)
    with pytest.raises(InputError, match=r"a result of another structure, load or ties.*balance \+y"):
        written(tmp_path, [(cp.LoadCase((0, 1, 0)), state)])
    tie = cp.Tie("tie", (0.2, 0.5, 2.0), (0.2, 0.5, 0.0), stones=(4, 0), strength=1e4)
    tied = cp.limit_analysis(STONES, CONTACTS, PUSH, 0.6, ties=[tie])
    with pytest.raises(InputError, match="found one of 1 ties; expected one of 0"):
        written(tmp_path, [(PUSH, tied)])
    written(tmp_path, [(PUSH, tied)], ties=[tie])


def test_loads_that_no_load_case_has_are_refused(curve: cp.BlockCapacityCurve, tmp_path: Path) -> None:
    roof = cp.LineLoad("pier", name="roof", dead=5e3)
    state = cp.limit_analysis(STONES, CONTACTS, PUSH, 0.6)
    said = "loads= names a load that the load case has not; found line load roof, and nothing of it in"
    with pytest.raises(InputError, match=r"write_report: results\[0\]: " + said):
        written(tmp_path, [(PUSH, state)], loads=[roof])
    with pytest.raises(InputError, match=r"write_report: curve\[0\]: " + said):
        written(tmp_path, curve=[(PUSH, curve)], loads=[roof])
    pushed = cp.loaded(PUSH, STONES, [roof])
    written(tmp_path, [(pushed, cp.limit_analysis(STONES, CONTACTS, pushed, 0.6))], loads=[roof])
    with pytest.raises(InputError, match="a result of another structure, load or ties"):
        written(tmp_path, [(pushed, state)], loads=[roof])


@pytest.mark.parametrize("folder", [".", "there"])
def test_a_report_is_not_written_to_a_folder(folder: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "there").mkdir()
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match="write_report: path: a folder; found '?" + re.escape(folder)):
        cp.write_report(folder, STONES, CONTACTS, [], materials=MASONRY)


@pytest.mark.parametrize(
    ("path", "said"),
    [
        ("a.npz/x", "a file where a folder would be, a.npz/x"),
        ("a.npz/b/x", "a file where a folder would be, a.npz/b/x"),
        ("/proc/x", "No such file or directory, /proc/x"),
        ("x" * 300, f"File name too long, {'x' * 200} ..."),
    ],
)
def test_a_file_that_cannot_stand_there_is_refused(path: str, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.npz").write_text("mine")
    state = cp.limit_analysis(STONES, CONTACTS, PUSH, 0.6)

    def report(file: str) -> None:
        cp.write_report(file, STONES, CONTACTS, [(PUSH, state)], materials=MASONRY)

    for write, name, ending in ((partial(cp.save, STONES), "save", "npz"), (report, "write_report", "html")):
        with pytest.raises(InputError) as error:
            write(f"{path}.{ending}")
        message = said if said.endswith("...") else f"{said}.{ending}"
        assert f"{name}: path: the file cannot be written; found {message}" in str(error.value)
    assert (tmp_path / "a.npz").read_text() == "mine"
    (tmp_path / "b.npz").mkdir()
    with pytest.raises(InputError, match=r"save: path: the file cannot be written; found a folder of this name, b\.npz"):
        cp.save(STONES, "b.npz")
