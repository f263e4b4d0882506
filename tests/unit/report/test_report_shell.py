"""The shell in the report: what the viewer gets, opened joints, pictures and plots."""

import base64
import re
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread

from churchpipe.homogenised_shell.strength import paper_planes
from churchpipe.io.records import Analysis
from churchpipe.io.summary import Pair
from churchpipe.model.results import CapacityCurve, CapacityStep, ShellLimitState
from churchpipe.report.both import capacity_plots, compared, domain_plot, gate, mesh_plot, partner
from churchpipe.report.motion import joint_opening, opened_joints, plastic_size, reference_strain
from churchpipe.report.page import template
from churchpipe.report.shell_picture import shell_picture
from churchpipe.report.shell_plots import bend_of, capacity_svg, domain_section, domain_svg
from churchpipe.report.shell_view import borders, joint_outlines, shell_data
from churchpipe.report.table import Row
from churchpipe.stones.contacts import find_contacts
from records import analysis, summary
from shell_meshes import grid, joined_walls, shell, wall_points
from solids import box, on_ground


def floats(text: str) -> np.ndarray:
    return np.frombuffer(base64.b64decode(text), dtype="<f4")


def folded_shell():
    """Two walls of 1 x 1 m that meet at right angles."""
    flat, triangles = grid(2, 2, 1.0, 1.0)
    front = wall_points(flat)
    return shell(*joined_walls([(front, triangles), (front[:, [1, 0, 2]], triangles)]), bed=(1, 1, 0))


def rocking_pair():
    """Two cubes of 1 m on the ground, one on the other; the upper one turns about its lower edge at x = 1, to +x."""
    stones = on_ground(box((0, 1), (0, 1), (0, 1)), box((0, 1), (0, 1), (1, 2)), unit_weight=2e4, reach=3)
    velocities = np.zeros((stones.count, 6))
    spin = np.array([0.0, 1.0, 0.0])
    velocities[-1] = [*np.cross(spin, stones.centroid[-1] - [1, 0, 1]), *spin]
    return stones, find_contacts(stones), velocities


def test_the_joint_that_opens_is_found() -> None:
    stones, contacts, velocities = rocking_pair()
    opening = joint_opening(contacts, stones, velocities)
    upper = (contacts.blocks == [1, 2]).all(axis=1)
    # The far edge, 1 m from the axis, opens at 1 rad/s x 1 m.
    np.testing.assert_allclose(opening[upper], 1.0)
    assert not opening[~upper].any()
    assert opened_joints(opening).tolist() == upper.tolist()
    assert not opened_joints(np.zeros(3)).any()


def test_outlines_run_around_their_joints() -> None:
    _, contacts, _ = rocking_pair()
    corners, pointer = joint_outlines(contacts, np.arange(len(contacts.blocks)))
    assert pointer.tolist() == [0, 4, 8]
    for start, stop in pairwise(pointer):
        square = corners[start:stop]
        np.testing.assert_allclose(np.linalg.norm(np.roll(square, -1, axis=0) - square, axis=1), 1.0)
    assert joint_outlines(contacts, np.empty(0, dtype=np.int64))[0].shape == (0, 3)


def test_plastic_strain_counts_stretching_and_bending_at_the_faces() -> None:
    plastic = np.array([[3e-3, 0, 0, 0, 0, 0], [0, 0, 2e-3, 0, 0, 0], [0, 0, 0, 0, 0.1, 0], [0, 0, 0, 0, 0, 0]])
    size = plastic_size(plastic, np.full(4, 0.04))
    # Shear angles count half their square; a curvature of .1/m strains the faces, .02 m away, by .002.
    np.testing.assert_allclose(size, [3e-3, 2e-3 / np.sqrt(2), 2e-3, 0])
    assert 2e-3 < reference_strain(size) <= 3e-3
    assert reference_strain(np.zeros(3)) == 0


def state_of(mesh):
    nodes, facets = len(mesh.points), len(mesh.triangles)
    fields = {"stress": np.zeros((facets, 6)), "edge_rotation": np.zeros(1), "plastic": np.ones((facets, 6))}
    return ShellLimitState(0.25, "optimal", 0.25, 0.25, velocities=np.ones((nodes, 3)), **fields)


def test_borders_are_rims_and_folds() -> None:
    # Two walls of 2 x 2 cells: eight rim edges each, two of them shared; the diagonals within are not drawn.
    edge = borders(folded_shell())
    assert len(edge) == 14
    sides = folded_shell().points[edge]
    np.testing.assert_allclose(np.linalg.norm(sides[:, 1] - sides[:, 0], axis=1), 0.5)


def test_the_viewer_gets_meshes_motions_and_joints() -> None:
    stones, contacts, velocities = rocking_pair()
    corner = folded_shell()
    origin = np.array([0.5, 0.5, 0.0])
    data = shell_data({"base": corner}, [("limit", "base", state_of(corner), 0)], stones, contacts, [velocities], origin)
    np.testing.assert_allclose(floats(data["meshes"][0]["points"]).reshape(-1, 3), corner.points - origin, atol=1e-6)
    (analysis,) = data["analyses"]
    assert (analysis["mesh"], analysis["partner"], analysis["real"]) == (0, 0, False)
    assert len(floats(analysis["strain"])) == len(corner.triangles)
    np.testing.assert_allclose(floats(analysis["motion"]), 1.0)
    # One joint opens, four corners at z = 1.
    np.testing.assert_allclose(floats(data["joints"][0]["points"]).reshape(-1, 3)[:, 2], np.ones(4))


def test_a_picture_of_the_shell_is_drawn(tmp_path: Path) -> None:
    _, contacts, _ = rocking_pair()
    corner = folded_shell()
    joints = joint_outlines(contacts, np.array([0]))
    scene = (corner, 0.1 * np.ones((len(corner.points), 3)), np.ones((len(corner.triangles), 6)))
    shell_picture(*scene, tmp_path / "overlay.png", np.array([0.6, -0.7, 0.4]), joints, size=(300, 220))
    pixels = imread(tmp_path / "overlay.png")
    assert pixels.shape[:2] == (220, 300)
    assert np.ptp(pixels[..., :3]) > 0.5


def curve() -> CapacityCurve:
    factor, place = np.array([0.0, 0.1, 0.19, 0.2]), np.array([0.0, 1e-5, 1e-4, 1e-3])
    steps = tuple(CapacityStep(float(d), float(f), 1e-12, 0.0, 1e-9, 10, 0.1) for d, f in zip(place, factor, strict=True))
    empty = np.zeros((1, 6))
    return CapacityCurve(factor, place, 0, np.zeros((3, 3)), np.zeros(3), empty, np.zeros((1, 8)), steps, "converged")


def record(name: str, factor: float, **more: object) -> Analysis:
    return analysis(**{"name": name, "friction": 0.6, "load_factor": factor} | more)


def test_curves_have_the_load_factors_of_the_same_question_across() -> None:
    of_shell = {"model": "homogenised-shell", "element_size_mm": 60.0}
    rows = [
        Row(record("a", 0.21, flow="associative")),
        Row(record("b", 0.44, flow="associative", friction=0.7)),
        Row(record("c", 0.205, method="limit", **of_shell), None, ("base", state_of(folded_shell()))),
        Row(record("d", 0.2, method="pushover", **of_shell), None, ("base", curve())),
    ]
    ((heading, plot),) = capacity_plots(rows)
    assert heading == "load +x, friction 0.6"
    assert "rigid blocks, associative, 0.2100" in plot
    assert "shell, limit analysis, 0.2050" in plot
    assert "0.4400" not in plot
    assert [partner(row, rows[:2]) for row in rows[2:]] == [0, 0]
    assert mesh_plot(rows) == ""
    assert compared([Pair("+x", "a", "c", 0.205 / 0.21, 0.987)], rows) == [
        ["+x", "associative, friction 0.6", "0.2100", "limit load, 60 mm, friction 0.6", "0.2050", "\u22122.4 %", "0.99"]
    ]
    # Where the control point lies is said, too.
    placed = replace(rows[3].record, control_point=0, control_at=(0.0, 0.25, 3.9), control=(0.0,), load_factors=(0.0,))
    ((told, _),) = capacity_plots([*rows[:3], replace(rows[3], record=placed)])
    assert told == f"{heading}, displacement of node 0 at (0, 0.25, 3.9) m"
    # Those of a variant have a plot of their own, which names it.
    pushed = Row(record("g", 0.2, method="pushover", variant="two ties", **of_shell), None, ("base", curve()))
    assert [heading for heading, _ in capacity_plots([*rows, pushed])] == [heading, f"two ties, {heading}"]
    sizes = [
        Row(record(f"{variant} {size}", 0.2, method="limit", variant=variant, **of_shell | {"element_size_mm": size}))
        for variant in (None, "two ties")
        for size in (60.0, 120.0)
    ]
    assert re.findall(r">(shell, [^<]*)<", mesh_plot(sizes)) == [
        "shell, limit load, load +x, friction 0.6",
        "shell, limit load, two ties, load +x, friction 0.6",
    ]
    tied = [Row(record("e", 0.3, variant="two ties")), Row(record("f", 0.3, variant="two ties", **of_shell))]
    assert compared([Pair("+x", "e", "f", 1.0)], tied)[0][0] == "+x, two ties"


def test_the_bend_of_a_curve_is_looked_at_closely() -> None:
    assert bend_of(np.array([0.0, 1, 2, 90]), np.array([0.0, 0.5, 0.98, 1.0])) == 6
    assert bend_of(np.zeros(1), np.zeros(1)) == 1
    assert "load factor" in capacity_svg([("c", np.array([0.0, 1, 2]), np.array([0.0, 0.5, 1]))], [])


def test_a_mesh_series_is_extrapolated() -> None:
    of_shell = {"model": "homogenised-shell", "method": "limit"}
    rows = [Row(record(f"s{h}", 0.2 + 1e-4 * h, element_size_mm=float(h), **of_shell)) for h in (40, 80, 120)]
    plot = mesh_plot([Row(record("a", 0.21, flow="associative")), *rows])
    # 0.2 + h / 10 m: a straight line through the points.
    assert "0.2000 at size 0" in plot
    assert "rigid blocks, associative, 0.2100" in plot


def test_what_is_swept_tells_curves_and_mesh_series_apart() -> None:
    of_shell = {"model": "homogenised-shell"}
    cohesions = [{"cohesion_kPa": c, "swept": {"material.default.cohesion_kPa": c}} for c in (0.0, 20.0)]
    series = [
        Row(record(f"s{h}", 0.2, method="limit", element_size_mm=float(h), **of_shell, **swept))
        for swept in cohesions
        for h in (40, 80)
    ]
    words = [f"load +x, friction 0.6, cohesion {c} kPa" for c in (0.0, 20.0)]
    assert re.findall(r">(shell, [^<]*)<", mesh_plot(series)) == [f"shell, limit load, {word}" for word in words]
    pushed = [
        Row(record("d", 0.2, method="pushover", element_size_mm=60.0, **of_shell, **swept), None, ("base", curve()))
        for swept in cohesions
    ]
    assert [heading for heading, _ in capacity_plots(pushed)] == words


def test_the_strength_that_is_drawn_has_the_friction_of_its_cell() -> None:
    flat, triangles = grid(4, 2, 2.0, 1.0)
    wall = shell(wall_points(flat), triangles)
    # Two facets of thick ashlar before many of thin brick.
    thick = np.arange(len(triangles)) < 2
    mesh = replace(wall, thickness=np.where(thick, 0.3, 0.2), material=np.where(thick, "ashlar", "brick"))
    pushed = Row(record("s", 0.2, model="homogenised-shell", method="limit", friction={"ashlar": 0.8, "brick": 0.5}))
    assert domain_plot({"base": mesh}, [pushed])[1].endswith("thickness 200 mm, friction 0.5")


def test_the_mechanism_of_a_shell_that_falls_has_no_size() -> None:
    stones, contacts, velocities = rocking_pair()
    corner = folded_shell()
    count, facets, step = len(corner.points), len(corner.triangles), CapacityStep(0.0, 0.0, 1e-12, 0.0, 1e-9, 10, 0.1)
    found = {}
    for status in ("converged", "unstable"):
        moved = np.ones((count, 3)), np.zeros(3), np.ones((facets, 6)), np.zeros((facets, 8))
        state = CapacityCurve(np.zeros(1), np.zeros(1), 0, *moved, (step,), status)
        shown = shell_data({"base": corner}, [("curve", "base", state, 0)], stones, contacts, [velocities], np.zeros(3))
        found[status] = shown["analyses"][0]["real"]
    assert found == {"converged": True, "unstable": False}


def test_sections_of_the_domain_agree_with_the_planes_where_these_are_exact() -> None:
    # M11 and M22 under N11 = N22 = -1: N22 / 2 bounds M22 / h, and the planes are exact.
    cell, planes = domain_section(0.03, 0.08, 0.04, 0.7, 3, 4, {0: -1.0, 1: -1.0}, rays=16)
    np.testing.assert_allclose(cell, planes, rtol=1e-5)
    assert np.abs(cell[:, 1]).max() == pytest.approx(0.5, rel=1e-6)
    # Along M11 alone: 1.2551 (theory of the corrected planes).
    assert cell[0, 0] == pytest.approx(1.2551, abs=1e-4)
    # In twisting the eight planes are unbounded, the cell is not; wherever both end, the planes hold the cell inside.
    cell, planes = domain_section(0.03, 0.08, 0.04, 0.7, 4, 5, {0: -1.0, 1: -1.0}, rays=16)
    assert np.isnan(planes[4]).all()
    assert np.isfinite(cell).all()
    known = paper_planes(0.03, 0.08, 0.04, 0.7)
    stress = np.zeros((16, 6))
    stress[:, :2] = -1.0
    stress[:, [4, 5]] = cell * 0.04
    assert (stress @ known.normal.T - known.limit).max() < 1e-6


@pytest.mark.parametrize(
    ("overlap", "told"),
    [
        ("0.0 %", "comes to as much as"),
        ("-0.0 %", "comes to as much as"),
        ("-0.3 %", "is 0.3 % less than"),
        ("0.6 %", "0.6 % of"),
    ],
)
def test_the_gate_says_what_mid_surfaces_come_to(overlap: str, told: str) -> None:
    match = {"passed": True, "message": "", "unfit": (), "moved": "", "rows": [["weight", "1 N", "1 N", "0", "1 %", "agrees"]]}
    assert told in " ".join(template("match.html").render(match={**match, "junction_overlap": overlap}).split())


@pytest.mark.parametrize(
    ("difference", "told"), [(0.0, "0 %"), (1.3e-16, "< 0.001 %"), (3.2e-4, "0.032 %"), (0.00503, "0.503 %"), (0.0212, "2.12 %")]
)
def test_the_gate_tells_differences_as_it_tells_what_is_allowed(difference: float, told: str) -> None:
    weight = {"name": "weight", "stones": 1.0, "shell": 1.0, "unit": "N", "difference": difference, "tolerance": 0.005}
    shown = gate(summary(match={"figures": [weight]}), [])
    assert shown is not None
    assert shown["rows"][0][3:5] == [told, "0.5 %"]


@pytest.mark.slow
def test_the_plot_of_the_domain_names_its_axes() -> None:
    text = re.sub("<[^>]*>", " ", domain_svg(0.03, 0.08, 0.04, 0.7))
    # What has no strength is drawn to the scale of the compression, not to that of its rounding.
    assert not re.search(r"1e.\d", re.sub("<[^>]*>", " ", domain_svg(0.03, 0.08, 0.04, 0.7, "stack")))
    for word in ("unit cell", "eight planes", "M12 / h", "N22 and N12, N11 = 0"):
        assert word in text
