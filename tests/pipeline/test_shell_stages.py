"""The stages of the shell, called one after the other: what they hand on, and what happens when there is no shell to be had."""

import csv
import html
import re
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
import pyvista

from churchpipe import stages
from churchpipe.cli.runs import check_nodes
from churchpipe.compare import bad_news
from churchpipe.config.case import read_case
from churchpipe.configuring import configure
from churchpipe.dxf.writer import write_dxf
from churchpipe.errors import InputError
from churchpipe.generators import box, wall
from churchpipe.io.atomic import read_json
from churchpipe.io.npz import Absent, read_if_made, read_npz, write_npz
from churchpipe.io.records import Analysis
from churchpipe.io.summary import Summary
from churchpipe.match import Match
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import Material
from churchpipe.model.quantities import as_read
from churchpipe.model.results import LimitState, ShellLimitState
from churchpipe.model.shell import ShellModel
from churchpipe.stones.blocks import derive_blocks
from churchpipe.terminal import remarks
from solids import moved

# A wall of 1.2 x 1.0 x .25 m pushed out of its plane: it turns over at .25 / 1.0.
CASE = """
name = "slab"
[source]
generator = "wall"
length_mm = 1200
brick_mm = [400, 250, 100]
courses = 10
[material.default]
unit_weight_kN_m3 = 18
friction = 0.6
elastic = { block_E_GPa = 3.18, block_nu = 0.23, joint_E_GPa = 0.303, joint_nu = 0.3, joint_thickness_mm = 1.0 }
[[load]]
direction = [0, 1, 0]
[shell]
element_size_mm = 400
analyses = ["limit"]
"""
DRAWN = """
name = "drawn"
[source]
dxf = "drawn.dxf"
[material.default]
unit_weight_kN_m3 = 18
friction = 0.6
[[load]]
direction = [0, 1, 0]
[shell]
element_size_mm = 400
"""
SPIKE = ([(0.5, 0.0, 1.0), (0.7, 0.0, 1.0), (0.6, 0.25, 1.0), (0.6, 0.1, 1.03)], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])


def make(case: Path, *overrides: str, spoil: Callable[[Path], None] | None = None) -> dict[str, Any]:
    """Do the work of the engine for a case with one geometry; return summary.json. spoil: called with the path of each mesh."""
    out = case.parent / "run"
    plan = configure(case, out, overrides)
    index = read_json(plan)
    base = out / "geometry" / "base"
    settings, building, stones, contacts = (
        base / name for name in ("settings.json", "building.json", "assemblage.npz", "contacts.npz")
    )
    if index["drawing"]:
        stages.drawing(settings, Path(index["drawing"]), stones, base / "stones.vtu")
        stages.panels(settings, stones, building, base / "fitted.npz", base / "fit.json")
    else:
        stages.source(settings, building)
        stages.blocks(building, stones, base / "stones.dxf", base / "stones.vtu")
    stages.contacts(base / "tolerances.json", stones, contacts)
    fitted = base / "fitted.npz" if index["drawing"] else stones
    for mesh in index["shells"]:
        folder = out / "shell" / mesh["name"]
        stages.shell(folder / "settings.json", building, folder / "shell.npz")
        if spoil:
            spoil(folder / "shell.npz")
        stages.match(folder / "shell.npz", folder / "carried.json", fitted, contacts, folder / "match.json")
    for entry in index["analyses"]:
        folder = out / entry["kind"] / entry["name"]
        mesh = out / "shell" / entry.get("shell", "")
        inputs = (stones, contacts) if entry["kind"] == "rigid" else (mesh / "shell.npz", mesh / "match.json", fitted)
        results = (folder / f"{entry['kind']}.npz", folder / f"{entry['kind']}.json")
        stages.STAGES[entry["kind"]](folder / "settings.json", *inputs, *results)
    stages.compare(plan, out / "summary.json", out / "table.csv")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("churchpipe.report.html.mechanism_pictures", lambda _: nullcontext(lambda: "not drawn in this test"))
        stages.report(plan, out / "summary.json", stones, contacts, out / "report.html")
    return read_json(out / "summary.json")


def page(case: Path) -> str:
    """The report's text, without what is between its tags."""
    text = (case.parent / "run" / "report.html").read_text(encoding="utf-8")
    return re.sub(r"\s+", " ", re.sub(r"<(script|style).*?</\1>|<[^>]*>", " ", text, flags=re.DOTALL))


@pytest.fixture
def case(tmp_path: Path) -> Path:
    path = tmp_path / "slab.toml"
    path.write_text(CASE)
    return path


def drawing(folder: Path, stones: Assemblage) -> Path:
    write_dxf(stones, folder / "drawn.dxf", materials=[Material("default", 18e3, 0.6)], loads=[LoadCase((0, 1, 0))])
    (folder / "case.toml").write_text(DRAWN)
    return folder / "case.toml"


def polyhedra(stones: Assemblage) -> list[tuple[Any, Any]]:
    found = []
    for number in range(stones.count):
        start, stop = stones.block_point_ptr[number : number + 2]
        faces = range(*stones.block_face_ptr[number : number + 2])
        nodes = [(stones.face_nodes[stones.face_ptr[f] : stones.face_ptr[f + 1]] - start).tolist() for f in faces]
        found.append((stones.points[start:stop], nodes))
    return found


def slab_with_spike() -> Assemblage:
    slab = derive_blocks(wall(length=1.2, brick=(0.4, 0.25, 0.1), courses=10, materials=(Material("default", 18e3, 0.6),)))
    return Assemblage.from_polyhedra([*polyhedra(slab), SPIKE], 18e3, fixed=[0])


def test_both_models_are_in_the_summary(case: Path) -> None:
    summary = make(case)
    run = case.parent / "run"
    assert list(summary) == [
        *("case", "blocks", "interfaces", "contact_points", "weight_kN", "near_misses", "joints"),
        *("shell", "match", "analyses", "comparison", "guidance", "questions"),
    ]
    agree = "in which all limit analyses agree"
    assert summary["guidance"][0].startswith(
        f"Load +y: use 0.2500 (rigid blocks, associative; shell, limit load, 400 mm), {agree}"
    )
    assert summary["guidance"][0] in html.unescape(page(case))
    assert summary["questions"] == []
    shell = read_npz(run / "shell" / "base" / "shell.npz", ShellModel)
    assert summary["shell"] == {"elements": len(shell.triangles), "nodes": len(shell.points), "element_size_mm": 400}
    assert summary["match"]["passed"]
    assert {"weight", "thickness"} <= {figure["name"] for figure in summary["match"]["figures"]}
    rigid, limit = summary["analyses"]
    assert (rigid["model"], limit["model"], limit["method"], limit["planes"]) == (
        "rigid-block",
        "homogenised-shell",
        "limit",
        "cell",
    )
    assert rigid["load_factor"] == pytest.approx(0.25, rel=1e-6)
    # Three elements a side: the hinge lies above the foot, within the lowest row. tests/validation refines.
    assert limit["load_factor"] == pytest.approx(0.25, rel=1e-6)
    assert limit["lower_bound"] == pytest.approx(limit["upper_bound"], abs=1e-6)
    (pair,) = summary["comparison"]
    assert (pair["rigid-block"], pair["homogenised-shell"]) == (rigid["name"], limit["name"])
    assert pair["ratio"] == pytest.approx(limit["load_factor"] / rigid["load_factor"])
    # Both turn about the foot.
    assert pair["overlap"] > 0.99
    with (run / "table.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [(row["model"], row["flow"], row["method"]) for row in rows] == [
        ("rigid-block", "associative", ""),
        ("homogenised-shell", "", "limit"),
    ]
    assert bad_news(as_read(Summary, summary)) == []
    # For ParaView and Gmsh.
    state = read_npz(run / "limit" / "+y_limit" / "limit.npz", ShellLimitState)
    mesh: Any = pyvista.read(run / "shell" / "base" / "shell.vtu")
    np.testing.assert_allclose(np.abs(mesh["bed"]), np.tile([1.0, 0, 0], (len(state.plastic), 1)), atol=1e-12)
    assert len(meshio.read(run / "shell" / "base" / "shell.msh").points) == len(mesh.points)
    moved: Any = pyvista.read(run / "limit" / "+y_limit" / "mechanism.vtu")
    np.testing.assert_allclose(moved["velocity"], state.velocities)
    np.testing.assert_allclose(moved["plastic_curvature"], state.plastic[:, 3:])


@pytest.mark.slow
def test_both_models_answer_one_question_where_a_beam_is_of_a_material_of_its_own(case: Path) -> None:
    # The shell named the friction of its walls alone, was not set beside the stones, and its larger value was advised.
    beam = """
[material.concrete]
unit_weight_kN_m3 = 25
friction = 0.5
[[ring_beams]]
walls = ["wall"]
height_m = 0.2
material = "concrete"
"""
    case.write_text(case.read_text(encoding="utf-8") + beam, encoding="utf-8")
    summary = make(case)
    blocks, shell = (
        next(a for a in summary["analyses"] if a["model"] == model) for model in ("rigid-block", "homogenised-shell")
    )
    assert blocks["friction"] == shell["friction"] == {"default": 0.6, "concrete": 0.5}
    (pair,) = summary["comparison"]
    assert (pair["rigid-block"], pair["homogenised-shell"]) == (blocks["name"], shell["name"])
    assert pair["ratio"] == pytest.approx(shell["load_factor"] / blocks["load_factor"])
    careful = min(blocks["load_factor"], shell["load_factor"])
    assert summary["guidance"][0].startswith(f"Load +y: use {careful:.4f}")


@pytest.mark.slow
def test_a_sweep_of_meshes_is_reported_side_by_side_with_the_stones(case: Path) -> None:
    summary = make(case, 'sweep={"shell.element_size_mm"=[600,400]}')
    assert [mesh["element_size_mm"] for mesh in summary["shells"].values()] == [600, 400]
    assert summary["shell"]["elements"] == summary["shells"]["element_size_mm=600"]["elements"]
    # The careful one of those that answer one question stands first.
    rigid, coarse, fine = sorted(summary["analyses"], key=lambda record: -record.get("element_size_mm", np.inf))
    assert rigid.get("swept") is None
    assert (coarse["element_size_mm"], fine["element_size_mm"]) == (600, 400)
    assert coarse["elements"] < fine["elements"]
    assert [pair["rigid-block"] for pair in summary["comparison"]] == [rigid["name"]] * 2
    text = page(case)
    for words in (
        "The two models side by side",
        "limit load, 600 mm, friction 0.6",
        "Are the two models one building?",
        "supported length x thickness",
        "Sensitivity to the mesh.",
        "moments M a wall can bear together (running bond, course height 100 mm, stone length 400 mm",
        "thickness 250 mm, friction 0.6",
        "where it meets size 0 is an extrapolation, not a bound",
        "opened joints on plastic strain",
    ):
        assert words in text, words
    assert "do not match" not in text


def test_the_capacity_curve_ends_on_the_limit_load(case: Path) -> None:
    summary = make(case, 'shell.analyses=["limit","pushover"]', "shell.control_point_mm=[0,0,1000]")
    _, limit, pushed = summary["analyses"]
    assert (pushed["method"], pushed["status"]) == ("pushover", "converged")
    assert pushed["load_factor"] == pytest.approx(limit["load_factor"], rel=5e-3)
    assert pushed["load_factor"] == max(pushed["load_factors"])
    assert len(pushed["control_mm"]) == len(pushed["load_factors"])
    assert (pushed["control_mm"][0], pushed["load_factors"][0]) == (0.0, 0.0)
    shell = read_npz(case.parent / "run" / "shell" / "base" / "shell.npz", ShellModel)
    np.testing.assert_allclose(shell.points[pushed["control_point"]][[0, 2]], [0, 1.0], atol=1e-9)
    assert summary["comparison"][1]["overlap"] > 0.99
    text = page(case)
    node, place = pushed["control_point"], ", ".join(f"{value:.4g}" for value in pushed["control_at_m"])
    assert pushed["control_at_m"] == shell.points[node].tolist()
    assert f"Capacity curve, load +y, friction 0.6, displacement of node {node} at ({place}) m." in text
    assert f"shell, limit analysis, {limit['load_factor']:.4f}" in text


@pytest.mark.slow
def test_a_stack_bond_has_a_shell_that_resists_no_shear(case: Path) -> None:
    # Without compression along its beds: docs/shell.md says why, and that the rigid blocks are the ones to use.
    summary = make(case, 'shell.analyses=["limit"]', "source.pattern=stack")
    shell, blocks = summary["analyses"]
    assert blocks["load_factor"] > 0.05
    assert shell["status"] == "optimal"
    assert shell["load_factor"] == pytest.approx(0.0, abs=1e-5)


def thicker(path: Path) -> None:
    shell = read_npz(path, ShellModel)
    write_npz(path, replace(shell, thickness=1.1 * shell.thickness, surface_weight=1.1 * shell.surface_weight))


def test_a_wrong_shell_is_stopped_at_the_gate(case: Path) -> None:
    summary = make(case, spoil=thicker)
    assert not summary["match"]["passed"]
    assert {f["name"] for f in summary["match"]["figures"] if not f["passed"]} >= {"weight", "thickness"}
    # The rigid blocks stand; of the shell nothing is said.
    assert [analysis["model"] for analysis in summary["analyses"]] == ["rigid-block"]
    assert "comparison" not in summary
    assert bad_news(as_read(Summary, summary)) == [as_read(Match, summary["match"])]
    assert isinstance(read_if_made(case.parent / "run" / "limit" / "+y_limit" / "limit.npz", ShellLimitState), Absent)
    text = page(case)
    assert "The two models do not match." in text
    assert "differs" in text
    assert "The two models side by side" not in text


def test_a_drawing_takes_the_same_road(tmp_path: Path, case: Path) -> None:
    wanted = make(case)
    (tmp_path / "drawn").mkdir()
    slab = derive_blocks(wall(length=1.2, brick=(0.4, 0.25, 0.1), courses=10, materials=(Material("default", 18e3, 0.6),)))
    untagged = replace(slab, panel=np.full(slab.count, ""))
    found = make(drawing(tmp_path / "drawn", untagged))
    assert found["match"] | {"figures": []} == {
        "passed": True,
        "junction_overlap": pytest.approx(0, abs=1e-9),
        "figures": [],
    }
    assert found["shell"] == wanted["shell"]
    assert [a["load_factor"] for a in found["analyses"]] == pytest.approx(
        [a["load_factor"] for a in wanted["analyses"]], rel=1e-6
    )
    assert found["comparison"][0]["overlap"] == pytest.approx(wanted["comparison"][0]["overlap"], abs=1e-3)


def test_stones_that_fit_no_wall_are_named(tmp_path: Path) -> None:
    stones = slab_with_spike()
    case = drawing(tmp_path, stones)
    summary = make(case)
    assert summary["match"]["unfit"] == [stones.block_id[-1]]
    # A pyramid of 30 mm over .025 m2 on a slab of .3 m3: so little may be missing.
    assert summary["match"]["figures"][0]["difference"] == pytest.approx(0.00025 / 0.30025, rel=1e-6)
    assert summary["match"]["passed"]
    assert f"1 stone fits no wall and is missing from the shell: {stones.block_id[-1]}." in page(case)


@pytest.mark.slow
@pytest.mark.parametrize("degrees", [0.0, 17.0])
def test_a_run_tells_of_stones_moved_into_line(tmp_path: Path, degrees: float) -> None:
    room = box(length=2.0, width=1.5, courses=6, brick=(0.5, 0.25, 0.25), materials=(Material("default", 18e3, 0.6),))
    turn = np.radians(degrees)
    rotation = np.array([[np.cos(turn), -np.sin(turn), 0.0], [np.sin(turn), np.cos(turn), 0.0], [0.0, 0.0, 1.0]])
    stones = moved(derive_blocks(room), rotation, np.zeros(3))
    case = drawing(tmp_path, replace(stones, points=np.round(stones.points, 5)))
    summary = make(case)
    assert summary["match"]["passed"]
    if degrees == 0.0:
        assert "moved" not in summary["match"]
        return
    said = summary["match"]["moved"]
    assert re.fullmatch(r"For the shell alone, stones were moved into line .* by 0\.0\d+ mm at most \([\w-]+\)\.", said)
    assert said in page(case)
    assert said in remarks(as_read(Summary, summary))


def test_a_drawing_without_walls_is_analysed_as_stones(tmp_path: Path) -> None:
    foot = ([(x, y, z) for z in (-1.0, 0.0) for x, y in ((-2, -2), (2, -2), (2, 2), (-2, 2))], None)
    faces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
    spike = (np.array(SPIKE[0]) - [0.6, 0.1, 1.0], SPIKE[1])
    case = drawing(tmp_path, Assemblage.from_polyhedra([(foot[0], faces), spike], 18e3, fixed=[0]))
    summary = make(case)
    assert not summary["match"]["passed"]
    assert "no wall can be fitted" in summary["match"]["message"]
    assert [analysis["status"] for analysis in summary["analyses"]] == ["optimal"]
    assert bad_news(as_read(Summary, summary)) == [as_read(Match, summary["match"])]
    text = page(case)
    assert "There is no shell of this building." in text
    assert "Traceback" not in text


def test_what_the_shell_refuses_does_not_stop_the_stones(case: Path) -> None:
    summary = make(case, "material.default.friction=1.2", "shell.planes=paper")
    rigid, limit = summary["analyses"]
    assert rigid["status"] == "optimal"
    assert (limit["status"], limit["load_factor"]) == ("failed", None)
    assert 'Use planes = "cell"' in limit["message"]
    (bad,) = bad_news(as_read(Summary, summary))
    assert isinstance(bad, Analysis)
    assert bad.name == limit["name"]
    assert "Use planes = &#34;cell&#34;" in page(case)


@pytest.mark.slow
def test_what_the_planes_refuse_the_exact_cell_takes(case: Path) -> None:
    again = make(case, "material.default.friction=1.2", "shell.element_size_mm=600")
    assert again["analyses"][1]["status"] == "optimal"


@pytest.mark.slow
def test_planes_of_the_paper_say_that_they_are_too_strong(case: Path) -> None:
    summary = make(case, "shell.planes=paper", "shell.element_size_mm=600")
    (limit,) = (record for record in summary["analyses"] if record["model"] == "homogenised-shell")
    assert "outer approximation" in limit["message"]
    assert "The planes of the paper overrate the strength" in summary["guidance"][0]
    assert "outer approximation" in page(case)
    assert "planes of the paper (too strong)" in page(case)
    with (case.parent / "run" / "table.csv").open() as file:
        assert [row["planes"] for row in csv.DictReader(file)] == ["", "paper"]


@pytest.mark.slow
def test_the_check_and_the_macro_elements_are_in_the_summary_and_the_report(tmp_path: Path) -> None:
    path = tmp_path / "box.toml"
    path.write_text(
        'name = "box"\n[source]\ngenerator = "box"\nlength_m = 2.0\nwidth_m = 1.5\nthickness_m = 0.25\n'
        "brick_mm = [500, 250, 250]\ncourses = 8\n[material.default]\nunit_weight_kN_m3 = 18\nfriction = 0.6\n"
        "[[load]]\ndirection = [0, 1, 0]\n[shell]\nelement_size_mm = 250\n[check]\na_g_m_s2 = 1.5\nsoil_factor = 1.2\n"
    )
    shell, blocks = make(path)["analyses"]
    check = blocks["check"]
    # By hand, C8.7.1.2: M* = e* sum P / g, a0* = alpha0 g / (e* FC), a_g S / q = .9, zeta = a0* / .9, with e* = 1 first.
    assert check["alpha0"] == pytest.approx(blocks["load_factor"], rel=1e-9)
    assert check["participating_mass_t"] == pytest.approx(check["mass_fraction"] * check["moving_weight_kN"] / 9.80665)
    assert check["a0_m_s2"] == pytest.approx(check["alpha0"] * 9.80665 / (1.35 * check["mass_fraction"]))
    assert check["zeta_e"] == pytest.approx(check["alpha0"] * 9.80665 / 1.35 / 0.9)
    assert check["zeta_e_stones"] == pytest.approx(check["a0_m_s2"] / 0.9)
    with (tmp_path / "run/table.csv").open() as file:
        [_, first] = csv.DictReader(file)
    assert float(first["zeta_e"]) == check["zeta_e"] < float(first["zeta_e_stones"])
    stones = read_npz(tmp_path / "run/geometry/base/assemblage.npz", Assemblage)
    drift = read_npz(tmp_path / "run/rigid/+y_associative/rigid.npz", LimitState).velocities[:, 1]
    mass = (stones.weight @ drift) ** 2 / (stones.weight @ drift**2) / 9806.65
    assert check["participating_mass_t"] == pytest.approx(mass, rel=1e-4)
    assert 0 < check["mass_fraction"] < 1
    assert "check" not in shell
    for record in (blocks, shell):
        assert len(record["parts"]) == 4
        assert sum(part["motion"] for part in record["parts"]) == pytest.approx(1)
        assert max(part["displacement"] for part in record["parts"]) == 1
    assert sum(part["weight_kN"] for part in shell["parts"]) == pytest.approx(sum(p["weight_kN"] for p in blocks["parts"]))
    assert blocks["parts"][0]["name"] == shell["parts"][0]["name"]
    text = page(path)
    assert "What moves" in text
    assert "a_g,SLV" in text


def test_a_node_that_the_mesh_has_not_is_told_as_what_is_wrong_with_the_case(tmp_path: Path) -> None:
    path = tmp_path / "slab.toml"
    path.write_text(CASE.replace('"limit"', '"pushover"') + "control_point = 100000\n")
    with pytest.raises(InputError, match=r"^shell\.control_point: no such node; found 100000; expected 0 to \d+\.$"):
        make(path)
    said = r"slab\.toml: line 17, shell\.control_point: no such node; found 100000; expected 0 to \d+\. .* control_point_mm gives"
    with pytest.raises(InputError, match=said):
        check_nodes(tmp_path / "run", [read_case(path)])
    check_nodes(tmp_path / "run", [read_case(path, ["shell.control_point=2"])])
