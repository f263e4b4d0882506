"""Load factors of free walls as shells, brick 80 x 40 x 30 mm, 28.6 kN/m3, cohesionless.

Closed forms: a wall of thickness t and height H overturns out of plane at t / H, and slides in its plane at the friction
coefficient; a pier B x H splits along a line as steep as the stones' stagger, mu_b = 2 a / b, and turns about its toe, which
bounds the load factor by (B H/2 - B^2 mu_b/3) / (H^2/2 - B^2 mu_b^2/6) from above (friction <= mu_b); a strip that spans
along its courses and may dilate bends at M11 = (1 + p + q)/2 h k, k = c h / tan phi. Series of meshes: independent
calculation made for this project.
"""

from dataclasses import replace

import numpy as np
import pytest

import churchpipe as cp
from churchpipe import generators
from churchpipe.homogenised_shell.limit import shell_limit_analysis
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import Material, UnitWeight
from churchpipe.model.results import ShellLimitState
from churchpipe.model.shell import ShellModel
from shell_meshes import grid, joined_walls, plate_points, shell, wall_points

OUT, ALONG = LoadCase((0, 1, 0)), LoadCase((1, 0, 0))


def free_wall(rows: int, width: float = 0.63, height: float = 0.63, cell: tuple[float, float] = (0.03, 0.08)) -> ShellModel:
    points, triangles = grid(round(rows * width / height), rows, width, height)
    return shell(wall_points(points), triangles, cell=cell, surface_weight=28.6e3 * 0.04, supported=lambda p: p[:, 2] < 1e-9)


def push(model: ShellModel, load: LoadCase, friction: float = 0.7, **choices: str) -> ShellLimitState:
    state = shell_limit_analysis(model, load, [Material("default", 28.6e3, friction)], **choices)  # pyright: ignore[reportArgumentType]
    assert state.status == "optimal"
    assert state.upper_bound - state.lower_bound == pytest.approx(0, abs=1e-6 * state.load_factor)
    assert state.equilibrium_residual < 1e-8
    assert state.yield_violation < 1e-8
    return state


@pytest.mark.parametrize("rows", [2, 4, 16])
@pytest.mark.parametrize("membrane", ["CST", "LST"])
def test_wall_overturns_out_of_plane(rows: int, membrane: str) -> None:
    for load in (OUT, LoadCase((0, -1, 0))):
        state = push(free_wall(rows), load, membrane=membrane)
        assert state.load_factor == pytest.approx(0.04 / 0.63, rel=1e-6)
        # The top moves along the load, and evenly.
        top = state.velocities[-5 * rows :, 1] * load.direction[1]
        assert top.min() > 0


@pytest.mark.parametrize("planes", ["paper", "paper+torsion"])
@pytest.mark.parametrize("membrane", ["CST", "LST"])
def test_clamped_walls_are_too_strong_by_the_width_of_their_hinge(planes: str, membrane: str) -> None:
    rows = [2, 4, 8, 16] if membrane == "CST" else [4]
    factors = [push(free_wall(n), OUT, planes=planes, membrane=membrane).load_factor for n in rows]
    assert factors[len(rows) > 1] == pytest.approx(0.071588, abs=1e-6)
    if len(rows) == 1:
        return
    assert factors == pytest.approx([0.0788, 0.0716, 0.0675, 0.0655], abs=5e-5)
    # From above and of first order; the limit from the last three by Richardson, its order fitted.
    coarse, middle, fine = factors[1:]
    ratio = (coarse - middle) / (middle - fine)
    assert fine - (middle - fine) / (ratio - 1) == pytest.approx(0.04 / 0.63, rel=0.01)


def test_wall_slides_in_its_plane_at_the_friction_coefficient() -> None:
    assert push(free_wall(2), ALONG, 0.2, membrane="LST").load_factor == pytest.approx(0.2, abs=1e-6)
    assert push(free_wall(4), ALONG, 0.2, membrane="CST").load_factor == pytest.approx(0.2, abs=1e-6)
    # Finer meshes find a mechanism of sliding and cracking below it.
    assert push(free_wall(16), ALONG, 0.2, membrane="CST").load_factor == pytest.approx(0.1952, abs=5e-5)


def test_pier_in_its_plane() -> None:
    b, h, mu_b = 1.0, 2.0, 0.8
    wedge = (b * h / 2 - b**2 * mu_b / 3) / (h**2 / 2 - b**2 * mu_b**2 / 6)
    assert wedge == pytest.approx(0.387, abs=5e-4)
    piers = [free_wall(n, b, h, (0.4, 1.0)) for n in (4, 8, 16)]
    constant = [push(pier, ALONG, membrane="CST").load_factor for pier in piers]
    corners = [push(pier, ALONG, membrane="LST", stations="corners").load_factor for pier in piers[:2]]
    inner = [push(pier, ALONG, membrane="LST").load_factor for pier in piers[:2]]
    # Each mesh contains the one before: upper bounds fall, below the wedge, which combines with sliding.
    assert constant == sorted(constant, reverse=True)
    assert constant[-1] < wedge
    assert corners[1] < corners[0] < wedge
    assert all(np.array(inner) < corners)
    assert all(np.array(corners) < constant[:2])
    assert inner == pytest.approx([0.3533, 0.3523], abs=5e-5)


def test_planes_bound_the_exact_cell() -> None:
    model = free_wall(4)
    askew = LoadCase((1, 1, 0))
    by_planes = {
        planes: push(model, askew, planes=planes, membrane="LST").load_factor for planes in ("paper", "paper+torsion", "cell")
    }
    assert by_planes["cell"] <= by_planes["paper+torsion"] * (1 + 1e-6)
    assert by_planes["paper+torsion"] <= by_planes["paper"] * (1 + 1e-6)


WIDTH = ARM = 0.1
PRESSURE = 1000.0


def bent_strip(span: float) -> ShellModel:
    """A flat strip, beds along x, on four rigid pendulums at its corners, bent evenly by loads on an arm beyond each end.

    Pendulums, because the flow needs the strip to stretch both ways: a clamp or a fixed line would make it infinitely strong.
    """
    flat, strip = grid(round(span / ARM) + 2, 1, span + 2 * ARM, WIDTH)
    points = plate_points(flat - [ARM, 0.0])
    heads = [np.linalg.norm(points - [x, y, 0.0], axis=1).argmin() for x in (0.0, span) for y in (0.0, WIDTH)]
    feet = np.repeat(points[heads], 2, axis=0) + np.tile([[0.0, 0.0, -1.0], [0.3, 0.0, -0.5]], (4, 1))
    pendulums = np.column_stack([heads, len(points) + np.arange(8).reshape(4, 2)])
    model = shell(np.vstack([points, feet]), np.vstack([strip, pendulums]), supported=lambda p: p[:, 2] < -0.9)
    middle = model.points[model.triangles].mean(axis=1)[:, 0]
    own = np.arange(len(model.triangles)) < len(strip)
    return replace(model, surface_weight=np.where(own & ((middle < 0) | (middle > span)), PRESSURE, 0.0), yields=own)


@pytest.mark.parametrize("planes", ["paper", "paper+torsion", "cell"])
def test_strip_bends_along_its_courses_by_hand(planes: str) -> None:
    h, tg, mu_b, b = 0.04, 0.7, 0.75, 0.08
    p, q = tg * b / (4 * h * mu_b), tg / mu_b * np.hypot(1, b / (4 * h))
    capacity = (1 + p + q) / 2
    assert capacity == pytest.approx(1.2551, abs=5e-5)
    k = PRESSURE * ARM**2 / h
    masonry = [Material("default", 0.0, tg, k * tg / h)]
    spans = np.array([1.0, 2.0, 4.0])
    found: list[float] = []
    for span in spans:
        state = shell_limit_analysis(bent_strip(span), LoadCase((0, 0, -1)), masonry, planes=planes, membrane="CST")  # pyright: ignore[reportArgumentType]
        assert state.status == "optimal"
        # The arm's weight, a third of each facet on each corner, about the line of pendulums: p arm^2 / 2 a width.
        found.append(PRESSURE * (1 + state.load_factor) * ARM**2 / 2 / (h * k))
    # From below: even bending at capacity, less in the arms. From above: the flow of f7 everywhere, arms included, with
    # e11 : e22 : chi11 : chi22 = 1 : p + q : 2/h : 2/h (q - p), its work that of the arms' lumped weights.
    above = capacity * (spans + 2 * ARM) / (spans + 5 / 6 * ARM - (q - p) * WIDTH**2 / (6 * ARM))
    assert (np.array(found) >= capacity).all()
    assert (np.array(found) <= above).all()
    # What the arms add is of first order in arm / span.
    assert 2 * found[2] - found[1] == pytest.approx(capacity, rel=2e-3)


def prototype_s5(dx: float, dz: float, cut: int) -> ShellModel:
    """The mid-planes of S5 (Malena et al. 2019, section 4.1): main wall .6 m, two partitions .3 m long."""
    walls = []
    for origin, along, length in (((0, 0), (1, 0), 0.6), ((0, 0), (0, 1), 0.3), ((0.6, 0), (0, 1), 0.3)):
        flat, triangles = grid(round(length / dx), round(0.63 / dz), length, 0.63, cut)
        walls.append((np.column_stack([np.array(origin) + flat[:, :1] * np.array(along), flat[:, 1]]), triangles))
    points, triangles = joined_walls(walls)
    return shell(points, triangles, bed=(1, 1, 0), surface_weight=28.6e3 * 0.04, supported=lambda p: p[:, 2] < 1e-9)


@pytest.mark.slow("docs/shell_results.md: S5 in elements of constant strain")
def test_s5_with_constant_strain_at_20_by_30_mm() -> None:
    factor = push(prototype_s5(0.02, 0.03, 4), OUT, planes="paper", membrane="CST").load_factor
    assert 0.3155 < factor < 0.322


@pytest.mark.slow
def test_s5_with_quadratic_membrane_at_40_by_45_mm() -> None:
    model = prototype_s5(0.04, 0.045, 2)
    assert push(model, OUT, planes="paper").load_factor == pytest.approx(0.316, abs=5e-4)
    assert push(model, OUT, planes="paper+torsion").load_factor == pytest.approx(0.316, abs=5e-4)


WALL = generators.wall(length=2.0, brick=(0.25, 0.25, 0.1), courses=12, materials=(UnitWeight("default", 18e3),))


def both(carried: list[cp.LineLoad | cp.PointLoad], load: LoadCase, size: float) -> tuple[ShellLimitState, float]:
    """A wall of 2 m x 1.2 m that carries loads: as a shell, and the load factor of its stones."""
    stones, model = cp.derive_blocks(WALL), cp.derive_shell(WALL, size)
    state = shell_limit_analysis(model, cp.shell_loaded(load, model, stones, carried), [Material("default", 18e3, 0.7)])
    held = cp.limit_analysis(stones, cp.find_contacts(stones), cp.loaded(load, stones, carried), 0.7)
    return state, held.load_factor


@pytest.mark.parametrize(
    ("dead", "size"),
    [(5e3, 0.2), *(pytest.param(dead, size, marks=pytest.mark.slow) for dead in (200.0, 1e3, 5e3) for size in (0.12, 0.06))],
)
def test_a_wall_without_cohesion_carries_a_line_out_to_its_free_ends(dead: float, size: float) -> None:
    """The courses carry an even load on the top of the wall straight down: nothing pulls, so that the shell stands, and in its
    plane its load factor is hardly another than without load (.4323, .4320 and .4238), as that of the stones."""
    state, of_stones = both([cp.LineLoad("wall", dead=dead)], ALONG, size)
    assert state.status == "optimal"
    assert 0.417 < state.load_factor < 0.4324
    assert state.load_factor < of_stones


@pytest.mark.slow
@pytest.mark.parametrize("place", [0.05, *(pytest.param(place, marks=pytest.mark.slow) for place in (0.5, 1.0))])
def test_a_point_load_does_not_depend_on_the_mesh(place: float) -> None:
    """A stone presses on all of its bed; as a force at one point of a facet the same load gives .16 to .41."""
    found = [both([cp.PointLoad("wall", place, dead=2e3)], ALONG, size)[0] for size in (0.08, 0.12, 0.2)]
    assert [state.status for state in found] == ["optimal"] * 3
    assert all(0.423 < state.load_factor < 0.436 for state in found)


def test_a_point_load_on_the_corner_of_a_wall_without_cohesion_brings_its_shell_down() -> None:
    """Our own figures of docs/limits.md: no stone's bed bears it, but the edge of one."""
    state, of_stones = both([cp.PointLoad("wall", 2.0, dead=500.0)], ALONG, 0.12)
    assert state.status == "unstable"
    assert "nor a load on the very end of a wall" in state.message
    assert of_stones == pytest.approx(0.2732, abs=1e-3)


def test_a_coarse_shell_falls_under_a_load_that_only_presses_down() -> None:
    """Our own figures of docs/limits.md: stresses that vary linearly in large facets cannot keep to the stones below the load."""
    masonry = [Material("default", 18e3, 0.6)]
    building = generators.wall(length=4.0, brick=(0.5, 0.4, 0.25), courses=8, materials=masonry)
    stones, axle = cp.derive_blocks(building), cp.PointLoad("wall", 2.0, dead=1e3, mass=0.0, name="axle")
    load = LoadCase(multiplies=["axle"])

    def as_shell(size: float) -> ShellLimitState:
        model = cp.derive_shell(building, size)
        return shell_limit_analysis(model, cp.shell_loaded(load, model, stones, [axle]), masonry)

    assert as_shell(1.0).load_factor == pytest.approx(47.93, abs=0.01)
    assert as_shell(0.5).status == "unbounded"
    of_stones = cp.limit_analysis(stones, cp.find_contacts(stones), cp.loaded(load, stones, [axle]), 0.6)
    assert of_stones.status == "unbounded"


@pytest.mark.parametrize("load", [ALONG, OUT])
def test_a_stack_without_cohesion_stands_on_an_edge(load: LoadCase) -> None:
    """docs/shell_results.md: its shell has no tension along the beds, and so no load factor above zero, nor one below."""
    masonry = [Material("default", 18e3, 0.6)]
    building = generators.wall(length=4.0, brick=(0.5, 0.5, 0.25), courses=12, pattern="stack", materials=masonry)
    state = shell_limit_analysis(cp.derive_shell(building, 1.0), load, masonry)
    assert str(state.load_factor) == "0.0"
    assert state.message.startswith("the dead load stands as on an edge, and no push is carried")
