"""A report shows of each analysis what belongs to it: meshes of its own geometry, stones that answer the same question."""

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.io.records import Analysis
from churchpipe.io.summary import Mesh
from churchpipe.match import Match
from churchpipe.model.results import Iteration
from churchpipe.report import html
from churchpipe.report.figures import Job
from churchpipe.report.html import write_report
from churchpipe.report.viewer import static_text, viewer_data
from records import analysis, summary
from shell_meshes import grid, shell, wall_points
from solids import box, moved, on_ground

STONES = replace(on_ground(box((0, 1), (0, 0.5), (0, 1))), panel=np.array(["", "wall"]))
CONTACTS = cp.find_contacts(STONES)
STATE = cp.limit_analysis(STONES, CONTACTS, cp.LoadCase((0, 1, 0)), 0.6)
OF_SHELL: dict[str, Any] = {"model": "homogenised-shell", "method": "limit", "planes": "cell"}


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[Job]:
    """The pictures that a report asks for, in place of them."""
    jobs: list[Job] = []

    @contextmanager
    def none(asked: Sequence[Job]) -> Iterator[object]:
        jobs.extend(asked)
        yield lambda: "not drawn"

    monkeypatch.setattr(html, "mechanism_pictures", none)
    return jobs


def mesh() -> cp.ShellModel:
    flat, triangles = grid(2, 2, 1.0, 1.0)
    return shell(wall_points(flat), triangles)


def shell_state(model: cp.ShellModel) -> cp.ShellLimitState:
    count = len(model.triangles)
    fields = {"stress": np.zeros((count, 6)), "edge_rotation": np.zeros(1), "plastic": np.ones((count, 6))}
    return cp.ShellLimitState(0.25, "optimal", 0.25, 0.25, velocities=np.ones((len(model.points), 3)), **fields)


@pytest.mark.parametrize(("load", "overlays"), [("+y", 1), ("+x", 0)])
def test_opened_joints_lie_on_the_shell_of_the_same_question_alone(
    load: str, overlays: int, drawn: list[Job], tmp_path: Path
) -> None:
    of_stones, of_shell = analysis(name="stones", load="+y", flow="associative"), analysis(name="shell", load=load, **OF_SHELL)
    model = mesh()
    write_report(
        tmp_path / "report.html",
        summary=replace(summary(), analyses=(of_stones, of_shell)),
        stones=STONES,
        contacts=CONTACTS,
        results=[(of_stones, STATE)],
        case_text="",
        versions={},
        shells={"base": model},
        shell_results=[(of_shell, "base", shell_state(model))],
    )
    files = [str(part) for _, arguments in drawn for part in arguments if isinstance(part, Path)]
    assert len(files) == 2 + overlays
    assert sum("overlay" in file for file in files) == overlays


def test_a_report_of_another_geometry_has_the_sizes_of_its_own_mesh(drawn: list[Job], tmp_path: Path) -> None:
    sizes = {name: {"elements": many, "nodes": many + 1, "element_size": 0.1} for name, many in (("a", 11), ("b", 22))}
    meshes = {name: Mesh(geometry=name, match=Match(), **size) for name, size in sizes.items()}
    found = replace(summary(), shells=meshes, shell=meshes["a"], analyses=(analysis(name="stones", flow="associative"),))
    given: dict[str, Any] = {"stones": STONES, "contacts": CONTACTS, "results": [], "case_text": "", "versions": {}}
    for name, elements, nodes in (("a", 11, 12), ("b", 22, 23)):
        write_report(tmp_path / "report.html", summary=found, shells={name: mesh()}, **given)
        page = (tmp_path / "report.html").read_text(encoding="utf-8")
        facts = dict(re.findall(r"<dt>(shell \w+)</dt><dd>(\d+)</dd>", page))
        assert facts == {"shell elements": f"{elements}", "shell nodes": f"{nodes}"}
    assert drawn == []


def test_a_run_without_dilatancy_is_compared_with_the_associative_one_of_its_contact_model(
    drawn: list[Job], tmp_path: Path
) -> None:
    results: list[tuple[Analysis, cp.LimitState]] = []
    for number, model in enumerate(("corners", "torsion")):
        for flow in ("associative", "non-associative"):
            state = replace(STATE, load_factor=0.5 - 0.1 * number, flow=flow, history=(Iteration(0.3, 1e-3),))
            state = replace(state, history=()) if flow == "associative" else state
            results.append((analysis(name=f"{model} {flow}", load="+y", flow=flow, contact_model=model), state))
    write_report(
        tmp_path / "report.html",
        summary=replace(summary(), analyses=tuple(record for record, _ in results)),
        stones=STONES,
        contacts=CONTACTS,
        results=results,
        case_text="",
        versions={},
    )
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert re.findall(r"associative, (0\.\d{4})<", page) == ["0.5000", "0.4000"]
    assert drawn


def test_the_viewer_knows_how_far_the_fastest_stone_goes() -> None:
    # Of stones that creep one falls out a hundred times as fast: the measure of the mechanism is not the largest motion.
    stones = on_ground(*[box((2 * i, 2 * i + 1), (0, 1), (0, 1)) for i in range(-12, 12)])
    velocities = np.zeros((stones.count, 6))
    velocities[1:, 0], velocities[-1, 0] = 1.0, 100.0
    state = cp.LimitState(0.5, "optimal", 0.5, 0.5, np.zeros((0, 3)), velocities)
    (found,) = viewer_data(stones, [(analysis(), state, "fast")])["analyses"]
    assert found["fastest"] == 100.0 > found["reference_speed"]
    # What the page calls the largest displacement is that of this stone.
    assert re.search(
        r"largest displacement as drawn \$\{lengthText\(amplitude \* state\.analysis\.fastest\)\}", static_text("viewer.js")
    )


def test_the_size_of_a_turned_building_is_said_to_be_along_the_axes(drawn: list[Job], tmp_path: Path) -> None:
    half = np.sqrt(0.5)
    stones = moved(STONES, np.array([[half, -half, 0], [half, half, 0], [0, 0, 1]]), np.zeros(3))
    given: dict[str, Any] = {"contacts": cp.find_contacts(stones), "results": [], "case_text": "", "versions": {}}
    found = replace(summary(), analyses=(analysis(name="stones", flow="associative"),))
    write_report(tmp_path / "report.html", summary=found, stones=stones, **given)
    # A block of 1 x .5 m at 45 degrees reaches 1.5 / sqrt(2) along x and along y: neither is its length.
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "<dt>size along x \u00d7 y \u00d7 z</dt><dd>1.06 \u00d7 1.06 \u00d7 1.00 m</dd>" in page
    assert drawn == []
