"""Ring beams and rigid floors on shells, beside those on stones: moments about the toes of the walls that turn, by hand."""

from dataclasses import replace

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.match import Figure
from churchpipe.model.building import PlaneChart
from churchpipe.model.shell_beams import ShellBeams
from shell_meshes import grid, joined_walls, shell, wall_points
from solids import box

GAMMA, H, LENGTH, DEEP = 18e3, 3.0, 2.0, 0.25
MASONRY = [cp.Material("default", GAMMA, 0.6), cp.Material("concrete", 24e3, 0.6)]


def on_top(model: cp.ShellModel, centroid: tuple[float, float, float], weight: float) -> cp.ShellModel:
    of_node = np.where(model.points[:, 2] > H - 1e-9, 0, -1)
    course = np.unique(model.points[:, 2])[-3]
    bearing = np.where(model.points[model.triangles, 2].min(axis=1) > course - 1e-9, 0, -1)
    beams = ShellBeams(np.array(["beam"]), np.array(["concrete"]), np.array([centroid]), np.array([weight]), of_node, bearing)
    return replace(model, beams=beams)


def mesh_of(rows: int, *walls: tuple[float, float]) -> cp.ShellModel:
    """Walls along x at these y, of these thicknesses, as one regular mesh."""
    flat, triangles = grid(round(rows * LENGTH / H), rows, LENGTH, H)
    points, joined = joined_walls([(wall_points(flat) + np.array([0.0, y, 0.0]), triangles) for y, _ in walls])
    middle = points[joined].mean(axis=1)[:, 1]
    thickness = np.select([np.abs(middle - y) < 1e-6 for y, _ in walls], [b for _, b in walls])
    made = shell(points, joined, cell=(0.5, 1.0), supported=lambda p: p[:, 2] < 1e-9)
    return replace(made, thickness=thickness, surface_weight=GAMMA * thickness)


def test_a_beam_turns_with_its_wall() -> None:
    # About the toe: (W b/2 + B b/2) / (W h/2 + B (h + d/2)), W the wall, B the beam, d its height.
    b = 0.5
    wall, beam = GAMMA * b * H * LENGTH, 24e3 * b * DEEP * LENGTH
    expected = (wall + beam) * b / 2 / (wall * H / 2 + beam * (H + DEEP / 2))
    plate = box((-9, 9), (-9, 9), (-1, 0))
    stones = cp.Assemblage.from_polyhedra([plate, box((0, LENGTH), (0, b), (0, H))], GAMMA, [0], panel=["", "wall"])
    beamed = cp.with_ring_beams(stones, ["wall"], height=DEEP, unit_weight=24e3)
    load = cp.LoadCase((0, 1, 0))
    assert cp.limit_analysis(beamed, cp.find_contacts(beamed), load, 0.6).load_factor == pytest.approx(expected, rel=1e-6)
    for rows in (4, 8):
        model = on_top(mesh_of(rows, (0.0, b)), (LENGTH / 2, 0.0, H + DEEP / 2), beam)
        state = cp.shell_limit_analysis(model, load, MASONRY, membrane="CST")
        assert state.status == "optimal"
        # f_L . u = 1 per total weight, the beam's with it.
        work = model.weight @ state.velocities[model.triangles].mean(axis=1)[:, 1] + beam * state.beam_velocities[0, 1]
        assert work == pytest.approx(wall + beam, rel=1e-6)
        assert state.load_factor == pytest.approx(expected, rel=1e-6)


def under_a_floor(thick: float, thin: float, weight: float, deep: float, apart: float) -> float:
    """Two walls that turn about their toes towards +y by one angle, and the floor that lies on the edges behind.

    Their tops move by h and rise by their thickness; the floor tilts by the difference of these rises over the distance of those
    edges, turning about them as its middle moves forward.
    """
    walls = GAMMA * H * LENGTH * np.array([thick, thin])
    # y of the two edges behind, and of the middle of the floor, from the middle of the first wall.
    edges = np.array([-thick / 2, apart - thin / 2])
    outer = np.array([-thick / 2, apart + thin / 2])
    tilt = (thin - thick) / (edges[1] - edges[0])
    rise = thick + tilt * (outer.mean() - edges[0])
    forward = H - tilt * deep / 2
    return float((walls @ [thick / 2, thin / 2] + weight * rise) / (walls.sum() * H / 2 + weight * forward))


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_rigid_floor_holds_two_walls_together(way: float) -> None:
    thick, thin, apart = 0.6, 0.4, 3.0
    plate = box((-9, 9), (-9, 9), (-1, 0))
    walls = [box((0, LENGTH), (-thick / 2, thick / 2), (0, H)), box((0, LENGTH), (apart - thin / 2, apart + thin / 2), (0, H))]
    stones = cp.Assemblage.from_polyhedra([plate, *walls], GAMMA, [0], panel=["", "south", "north"])
    floored = cp.with_ring_beams(stones, ["south", "north"], height=DEEP, unit_weight=10e3, slab=True)
    weight, middle = float(floored.weight[-1]), floored.centroid[-1]
    sizes = (thick, thin) if way > 0 else (thin, thick)
    expected = under_a_floor(*sizes, weight, DEEP, apart)
    load = cp.LoadCase((0, way, 0))
    state = cp.limit_analysis(floored, cp.find_contacts(floored), load, 2.0)
    assert state.load_factor == pytest.approx(expected, rel=1e-6)
    materials = [replace(one, friction=2.0) for one in MASONRY]
    for rows in (4, 8):
        model = on_top(mesh_of(rows, (0.0, thick), (apart, thin)), tuple(middle), weight)
        found = cp.shell_limit_analysis(model, load, materials, membrane="CST")
        assert found.load_factor == pytest.approx(expected, rel=1e-6)


def pushed_along(friction: float, groups: tuple[cp.JointGroup, ...] = ()) -> float:
    """Load factor of a beam that is pushed along its wall, the wall itself not; friction of the beam's material."""
    model = on_top(mesh_of(8, (0.0, 0.5)), (LENGTH / 2, 0.0, H + DEEP / 2), 10e3)
    materials = [MASONRY[0], cp.Material("concrete", 24e3, friction)]
    model, strength = cp.shell_joint_groups(model, materials, groups)
    load = cp.LoadCase((1, 0, 0), panels=("beam",))
    return cp.shell_limit_analysis(model, load, strength, membrane="CST").load_factor


def test_a_beam_slides_at_the_lesser_friction() -> None:
    for friction in (0.2, 0.4):
        assert pushed_along(friction) == pytest.approx(friction, rel=1e-6)
    # No more than the masonry's own.
    assert pushed_along(0.9) == pytest.approx(0.6, rel=1e-6)
    anchored = cp.JointGroup("anchors", between=("beam", "wall"), friction=0.6)
    assert pushed_along(0.2, (anchored,)) == pytest.approx(0.6, rel=1e-6)


def test_the_gate_sees_what_a_beam_holds() -> None:
    case = cp.read_case("pipeline/cases/box.toml")
    walls = tuple(panel.name for panel in case.building().panels)
    building = replace(case.building(), ring_beams=(cp.RingBeam(walls, 0.05, closed=True),))
    stones, model = cp.derive_blocks(building), cp.derive_shell(building, 0.6)
    contacts = cp.find_contacts(stones)
    found = cp.match_models(stones, contacts, model)
    assert found.passed
    assert {figure.name.split(" of ")[0] for figure in found.figures if "beam" in figure.name} == {"weight", "height", "length"}
    heavier = replace(model, beams=replace(model.beams, weight=model.beams.weight * 1.1))
    shorter = replace(model, beams=replace(model.beams, of_node=np.where(model.points[:, 0] < 1.0, model.beams.of_node, -1)))
    for wrong, name in ((heavier, "weight of beam"), (shorter, "length of beam")):
        bad = [figure.name for figure in cp.match_models(stones, contacts, wrong).figures if not figure.passed]
        assert any(one.startswith(name) for one in bad)


@pytest.mark.parametrize("degrees", [20.0, 45.0])
@pytest.mark.parametrize("kind", [{"closed": True}, {"slab": True}, {}])
def test_the_gate_measures_beams_along_their_walls(kind: dict[str, bool], degrees: float) -> None:
    given = cp.read_case("pipeline/cases/box.toml").building()
    angle, found = np.radians(degrees), list[Figure]()
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    walls = tuple(panel.name for panel in given.panels)
    beam = cp.RingBeam(walls if kind else walls[:1], 0.05, **kind)
    for rotation, shift in ((np.eye(3), 0.0), (turn, np.array([100.0, -50.0, 0.0]))):
        charts = [
            replace(panel.chart, origin=panel.chart.origin @ rotation.T + shift, s_axis=panel.chart.s_axis @ rotation.T)
            for panel in given.panels
            if isinstance(panel.chart, PlaneChart)
        ]
        panels = tuple(replace(panel, chart=chart) for panel, chart in zip(given.panels, charts, strict=True))
        building = replace(given, panels=panels, ring_beams=(beam,))
        stones = cp.derive_blocks(building)
        match = cp.match_models(stones, cp.find_contacts(stones), cp.derive_shell(building, 0.6))
        assert match.passed
        found += [figure for figure in match.figures if figure.name.startswith("length of")]
    straight, turned = found
    for key in ("stones", "shell", "difference"):
        assert getattr(turned, key) == pytest.approx(getattr(straight, key), abs=1e-6)


def test_a_capacity_curve_with_a_beam_ends_at_its_load_factor() -> None:
    elastic = cp.Elastic(3.18e9, 0.23, 0.303e9, 0.3, 1e-3)
    materials = [replace(one, elastic=elastic) for one in MASONRY]
    model = on_top(mesh_of(3, (0.0, 0.5)), (LENGTH / 2, 0.0, H + DEEP / 2), 10e3)
    load = cp.LoadCase((0, 1, 0))
    limit = cp.shell_limit_analysis(model, load, materials, membrane="CST")
    curve = cp.pushover(model, load, materials, membrane="CST")
    assert curve.status == "converged"
    assert curve.plateau == pytest.approx(limit.load_factor, rel=2e-3)
