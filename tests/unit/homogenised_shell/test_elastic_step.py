"""Steps of a capacity curve with the exact cell: corners against dense matrices, steps against the method that decides."""

from dataclasses import replace

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.conic.interior_point.second_order import SecondOrder
from churchpipe.homogenised_shell import condensed as module
from churchpipe.homogenised_shell.cell_forces import CellForces, cell_forces
from churchpipe.homogenised_shell.cell_passes import answer_cells, push_cells
from churchpipe.homogenised_shell.condensed import CondensedShell, StressState
from churchpipe.homogenised_shell.corner_cones import CornerCones, central_pair
from churchpipe.homogenised_shell.elastic_step import ElasticStep, StepSolution, solve_step
from churchpipe.homogenised_shell.element import shell_elements
from churchpipe.homogenised_shell.stiffness import facet_stiffness
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import Elastic, Material
from shell_meshes import grid, shell, wall_points

ELASTIC = Elastic(3.18e9, 0.23, 0.303e9, 0.3, 1e-3)
ASKEW = LoadCase((1, 1, 0))
CORNERS = 40


def corners(seed: int) -> tuple[CornerCones, np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    slope = rng.uniform(0.3, 1.2, CORNERS)
    s, z = rng.normal(size=(2, 3, CORNERS))
    for v in (s, z):
        v[0] = np.hypot(v[1], v[2]) + rng.uniform(0.01, 1.0, CORNERS)
        v *= 10 ** rng.uniform(-2, 2, CORNERS)
    return CornerCones(np.vstack([s[:1] / slope, s[1:]]), z.copy(), slope), s, z, slope


def cells(seed: int) -> CellForces:
    """Return the sums of forces at the corners of eight cells, of four corners or of six."""
    rng = np.random.default_rng(seed)
    return cell_forces([rng.normal(size=(4, 3, 9)), rng.normal(size=(6, 3, 12))], np.array([1, 0, 0, 1, 0, 0, 1, 1]))


def product(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    return np.vstack([(u * v).sum(axis=0)[None], u[:1] * v[1:] + v[:1] * u[1:]])


def test_corners_answer_by_the_scaling_of_their_cones() -> None:
    cones, s, z, slope = corners(1)
    scaling = SecondOrder(3, 1, CORNERS).scaling(s[:, None], z[:, None])
    forces, rng = cells(7), np.random.default_rng(2)
    aim, lack = rng.normal(size=(2, 3, CORNERS))
    strain, stones = rng.normal(size=(6, 8)), rng.normal(size=forces.rows)
    opening = 0.3 * lack + forces.spread(strain, stones)
    rate = answer_cells(cones, forces, aim, lack, 0.3, strain, stones)
    cones.keep()
    dz = np.vstack([opening[:1] / slope, opening[1:]])
    # W^-2 (aim - s - ds) = dz, and the rates of both cones.
    before = cones.x.copy()
    length = 0.9 / rate
    total = cones.move(length)
    ds = (cones.x - before) / length * np.vstack([slope, np.ones((2, CORNERS))])
    np.testing.assert_allclose(scaling.soften((aim - s - ds)[:, None])[:, 0], dz, rtol=1e-6, atol=1e-9 * np.abs(dz).max())
    cone = SecondOrder(3, 1, CORNERS)
    none = np.zeros(1)
    rates = [cone.rates(a[:, None], b[:, None], b[:, None], none).max() for a, b in ((s, ds), (z, dz))]
    assert rate == pytest.approx(max(rates), rel=1e-8)
    moved = s + length * ds
    assert total == pytest.approx((moved * (z + length * dz)).sum(), rel=1e-10)
    # The compliance, and forces that answer: x + dx = F^-1 aim - F^-1 W^2 F^-1 opening.
    again, *_ = corners(1)
    reached = before + (cones.x - before) / length
    expected = np.vstack([aim[:1] / slope, aim[1:]]) - again.compliance().apply(opening)
    np.testing.assert_allclose(reached, expected, rtol=1e-6, atol=1e-9 * np.abs(expected).max())
    for found, sums in zip(push_cells(again, forces, aim, 2.0 * opening, 0.5), forces.add_up(expected), strict=True):
        np.testing.assert_allclose(found, sums, rtol=1e-6, atol=1e-8 * np.abs(sums).max())


def test_aims_of_corrections() -> None:
    cones, s, z, slope = corners(3)
    scaling = SecondOrder(3, 1, CORNERS).scaling(s[:, None], z[:, None])
    opening = 0.1 * np.random.default_rng(4).normal(size=(3, CORNERS))
    aim = np.zeros((3, CORNERS))
    forces = cells(8)
    answer_cells(cones, forces, aim, opening, 1.0, np.zeros((6, 8)), np.zeros(forces.rows))
    cones.keep()
    dz = np.vstack([opening[:1] / slope, opening[1:]])
    ds = aim - s - scaling.apply(scaling.apply(dz[:, None]))[:, 0]
    scaled = scaling.solve(ds[:, None])[:, 0], scaling.apply(dz[:, None])[:, 0]
    lam = scaling.point[:, 0]
    wanted = -product(*scaled)
    wanted[0] += 0.3
    found = cones.second_order(0.3)
    np.testing.assert_allclose(product(lam, scaling.solve(found[:, None])[:, 0]), wanted, rtol=1e-6, atol=1e-8)
    length, target = 0.5, 0.2
    at = product(lam + length * scaled[0], lam + length * scaled[1])
    fix = SecondOrder(3, 1, CORNERS).recentre(at[:, None], 0.1 * target, 10 * target)[:, 0]
    found = cones.recentred(aim, length, target) - aim
    np.testing.assert_allclose(product(lam, scaling.solve(found[:, None])[:, 0]), fix, rtol=1e-6, atol=1e-8)


def test_central_pair() -> None:
    _, s, z, slope = corners(5)
    # On the boundary: slacks that bear, multipliers that open, and a corner where both vanish.
    s[0], z[0] = np.hypot(s[1], s[2]), np.hypot(z[1], z[2])
    s[:, ::2], z[:, 1::2] = 0.0, 0.0
    z[:, 0] = 0.0
    margin, size = 0.01, 1e-6
    x, near = central_pair(np.vstack([s[:1] / slope, s[1:]]), z, slope, margin, size)
    slack = np.vstack([x[:1] * slope, x[1:]])
    np.testing.assert_allclose(product(slack, near), np.vstack([np.full(CORNERS, size), np.zeros((2, CORNERS))]), atol=1e-12)
    weight = margin**2 / size
    np.testing.assert_allclose(slack - weight * near, s - weight * z, rtol=1e-9, atol=1e-9 * weight)
    np.testing.assert_allclose(slack[:, 0], [margin, 0, 0], atol=1e-12)
    np.testing.assert_allclose(near[:, 0], [size / margin, 0, 0], atol=1e-12)


def steps(model: cp.ShellModel, materials: list[Material]) -> list[StressState]:
    """Return the states of dead load and of two steps."""
    shell_condensed = CondensedShell(shell_elements(model), ASKEW, materials, "cell")
    loads = shell_condensed.loads
    unit = loads.unit.T
    flexibility = np.linalg.inv(facet_stiffness(model, materials))[shell_condensed.elements.facet]
    flexibility *= shell_condensed.elements.weight[:, None, None] / (loads.weight * 1e-6)
    compliance = np.moveaxis(flexibility, 0, 2) * unit[:, None] * unit[None, :]
    states = [shell_condensed.solve(loads.dead, None, compliance=compliance, cap=1.0)]
    for reward in (1.0, 10.0):
        states.append(shell_condensed.solve(loads.dead, loads.live, compliance=compliance, before=states[-1], reward=reward))
    return states


@pytest.mark.parametrize(("bond", "crushes"), [("running", False), ("running", True), ("english", False)])
def test_steps_agree_with_the_method_that_decides(bond: str, crushes: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    points, triangles = grid(3, 3, 0.63, 0.63)
    model = shell(wall_points(points), triangles, surface_weight=1144.0, supported=lambda p: p[:, 2] < 1e-9)
    model = replace(model, bonds=np.array([bond]))
    materials = [Material("default", 28.6e3, 0.7, 0.0, ELASTIC, compressive_strength=1e6 if crushes else None)]
    own = steps(model, materials)
    monkeypatch.setattr(module, "solve_step", lambda *_: None)
    other = steps(model, materials)
    assert all(state.holds for state in (*own, *other))
    # Each was solved by the other method.
    assert [state.iterations for state in own] != [state.iterations for state in other]
    for mine, theirs in zip(own, other, strict=True):
        assert mine.load == pytest.approx(theirs.load, rel=1e-6)
        np.testing.assert_allclose(mine.stress, theirs.stress, atol=1e-4 * np.abs(theirs.stress).max())
        np.testing.assert_allclose(mine.motion, theirs.motion, atol=1e-3 * np.abs(theirs.motion).max())


def test_corners_begin_with_their_part_of_the_work_and_no_less_than_the_least(monkeypatch: pytest.MonkeyPatch) -> None:
    points, triangles = grid(3, 3, 0.63, 0.63)
    model = shell(wall_points(points), triangles, surface_weight=1144.0, supported=lambda p: p[:, 2] < 1e-9)
    materials = [Material("default", 28.6e3, 0.7, 0.0, ELASTIC)]
    begun: list[np.ndarray] = []

    def noted(step: ElasticStep, x: np.ndarray, z: np.ndarray) -> StepSolution | None:
        slack = np.vstack([x[:1] * step.law.friction, x[1:]])
        begun.append((slack * z).sum(axis=0) / step.reward)
        return solve_step(step, x, z)

    monkeypatch.setattr(module, "solve_step", noted)
    shared = steps(model, materials)
    monkeypatch.setattr(module, "SOLVER", replace(module.SOLVER, step_corner_work=1e-2))
    least = steps(model, materials)
    count = len(begun[0])
    for k in range(3):
        np.testing.assert_allclose(begun[k], module.SOLVER.step_work / count, rtol=1e-6)
        np.testing.assert_allclose(begun[3 + k], 1e-2, rtol=1e-6)
    assert [state.iterations for state in shared] != [state.iterations for state in least]
    for one, other in zip(shared, least, strict=True):
        assert one.holds
        assert other.holds
        assert one.load == pytest.approx(other.load, rel=1e-6)


def test_a_shell_that_falls_is_left_to_the_method_that_decides() -> None:
    points, triangles = grid(3, 3, 0.63, 0.63)
    # A wall on its side, held along one edge.
    model = shell(
        np.column_stack([points, np.zeros(len(points))]), triangles, surface_weight=1144.0, supported=lambda p: p[:, 0] < 1e-9
    )
    curve = cp.pushover(model, ASKEW, [Material("default", 28.6e3, 0.7, 0.0, ELASTIC)])
    assert curve.status == "unstable"
