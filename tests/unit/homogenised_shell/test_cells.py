"""Points with the strength of the exact cell, against dense matrices, and what results say of other strengths."""

import numpy as np
import pytest
import scipy.sparse as sp

import churchpipe as cp
from churchpipe.conic.interior_point.coupling import touches
from churchpipe.conic.interior_point.second_order import SecondOrder
from churchpipe.homogenised_shell.cell_elimination import CellElimination
from churchpipe.homogenised_shell.cell_forces import CellForces, cell_forces
from churchpipe.homogenised_shell.cells import CellCoupling, CellPoints
from churchpipe.homogenised_shell.energy import Energy, elastic_energy
from churchpipe.homogenised_shell.points import CellStrength
from shell_meshes import grid, shell, wall_points

# Two kinds of cells, of 12 corners with 3 motions and of 5 corners with 4, that take turns among seven points.
KIND = np.array([0, 1, 0, 0, 1, 0, 1])
COUNT = len(KIND)


def closings(rng: np.random.Generator) -> list[np.ndarray]:
    return [rng.normal(size=(12, 3, 9)), rng.normal(size=(5, 3, 10))]


def points(rng: np.random.Generator, *, elastic: bool) -> tuple[CellPoints, CellForces, Energy | None, CellElimination]:
    forces = cell_forces(closings(rng), KIND)
    root = rng.normal(size=(COUNT, 6, 6)) + 3 * np.eye(6)
    energy = elastic_energy(np.moveaxis(root @ np.swapaxes(root, 1, 2), 0, 2), rng.normal(size=(6, COUNT))) if elastic else None
    law = CellStrength(forces, np.zeros((6, COUNT)), rng.uniform(0.3, 1.2, forces.count), np.ones(COUNT))
    elimination = CellElimination(forces, None if energy is None else energy.root)
    return CellPoints(law, elimination, energy, None), forces, energy, elimination


def inside(rng: np.random.Generator, count: int, spread: float) -> np.ndarray:
    values = rng.normal(size=(2, 3, 1, count))
    values[:, 0] = np.sqrt((values[:, 1:] ** 2).sum(axis=1)) + rng.uniform(0.1, 1.0, (2, 1, count))
    return values * spread ** rng.uniform(-1, 1, (2, 1, 1, count))


@pytest.mark.parametrize("elastic", [True, False])
@pytest.mark.parametrize("spread", [1.0, 1e3])
def test_the_cells_own_unknowns_are_eliminated_from_the_linear_system(elastic: bool, spread: float) -> None:
    rng = np.random.default_rng(3)
    local, forces, energy, elimination = points(rng, elastic=elastic)
    values = inside(rng, forces.count, spread)
    found = local.compliance([SecondOrder(3, 1, forces.count).scaling(values[0], values[1])])
    # The system of strains of the joints and motions of the stones, dense: sums of the corners' compliances.
    stress, still = (matrix.toarray() for matrix in forces.matrix())
    sums = np.vstack([stress, still])
    each = [found.apply(row[None])[0] for row in np.eye(local.count)]
    compliance = np.array(each)
    size = 3 * forces.count
    flow = sums @ compliance[:size, :size] @ sums.T
    own = len(stress)
    seen = flow[:own, :own] - flow[:own, own:] @ np.linalg.solve(flow[own:, own:], flow[own:, :own])
    if energy is not None:
        stiff = compliance[size:, size:]
        seen = stiff - stiff @ np.linalg.solve(seen + stiff, stiff)
    for a in range(6):
        for b in range(6):
            part = seen[a * COUNT : (a + 1) * COUNT, b * COUNT : (b + 1) * COUNT]
            np.testing.assert_allclose(found.matrix[a, b], np.diag(part), rtol=1e-6, atol=1e-8 * np.abs(seen).max())
            assert np.abs(part - np.diag(np.diag(part))).max() <= 1e-8 * np.abs(seen).max()
    # What the right sides of the cells leave to the shell, and the cells' unknowns for its strains.
    strain, right_joints, right_still = rng.normal(size=(6, COUNT)), rng.normal(size=(6, COUNT)), rng.normal(size=forces.rows)
    if energy is None:
        right_joints = np.zeros((6, 0))
    reduced = elimination.reduce(right_joints, right_still)
    joints, motion = elimination.recover(reduced, strain)
    if energy is None:
        expected = np.linalg.solve(flow[own:, own:], right_still - flow[own:, :own] @ strain.ravel())
        pushed = -flow[:own, own:] @ np.linalg.solve(flow[own:, own:], right_still)
        np.testing.assert_allclose(motion, expected, rtol=1e-6, atol=1e-8 * np.abs(expected).max())
    else:
        whole = flow.copy()
        whole[:own, :own] += stiff
        expected = np.linalg.solve(whole, np.concatenate([right_joints.ravel() + stiff @ strain.ravel(), right_still]))
        pushed = stiff @ np.linalg.solve(whole, np.concatenate([right_joints.ravel(), right_still]))[:own]
        got = np.concatenate([joints.ravel(), motion])
        np.testing.assert_allclose(got, expected, rtol=1e-6, atol=1e-7 * np.abs(expected).max())
    np.testing.assert_allclose(reduced.stress.ravel(), pushed, rtol=1e-6, atol=1e-7 * np.abs(pushed).max())


@pytest.mark.parametrize("elastic", [True, False])
def test_the_coupling_and_its_transpose_agree(elastic: bool) -> None:
    rng = np.random.default_rng(4)
    local, forces, _, _ = points(rng, elastic=elastic)
    equilibrium = sp.csr_matrix(rng.normal(size=(7, 6 * COUNT)))
    coupling = CellCoupling(touches(sp.csc_matrix(equilibrium), 6, 1, by_point=True), forces, elastic=elastic)
    x, y = rng.normal(size=local.count), rng.normal(size=coupling.rows)
    assert coupling.rows == 7 + forces.rows + (6 * COUNT if elastic else 0)
    assert coupling.couple(x) @ y == pytest.approx(coupling.spread(y) @ x, rel=1e-12)
    stress, still = forces.matrix()
    of_corners = stress @ x[: 3 * forces.count]
    own = x[3 * forces.count :] if elastic else of_corners
    np.testing.assert_allclose(coupling.couple(x)[:7], equilibrium @ own.reshape(6, -1).T.ravel(), atol=1e-12)
    np.testing.assert_allclose(coupling.couple(x)[-forces.rows :], still @ x[: 3 * forces.count], atol=1e-12)
    if elastic:
        np.testing.assert_allclose(coupling.couple(x)[7 : 7 + 6 * COUNT], of_corners - own, atol=1e-12)
    else:
        np.testing.assert_allclose(coupling.couple(x), coupling.matrix() @ x, atol=1e-12)
    assert [unit.shape for unit in coupling.touched_units(np.ones(coupling.rows))] == [(local.count,)] * 2
    assert coupling.passing(x).shape == (coupling.rows,)


def test_forces_are_kept_kind_by_kind() -> None:
    rng = np.random.default_rng(5)
    tables = closings(rng)
    forces = cell_forces(tables, KIND)
    force = rng.normal(size=(3, forces.count))
    stress, _ = forces.add_up(force)
    by_corner = [forces.by_corner(component) for component in force]
    for point, kind in enumerate(KIND):
        mine = np.array([component[: len(tables[kind]), point] for component in by_corner])
        np.testing.assert_allclose(stress[:, point], np.einsum("ic,cis->s", mine, tables[kind])[:6], atol=1e-12)
    np.testing.assert_array_equal(by_corner[0][5:, KIND == 1], 0.0)
    np.testing.assert_array_equal(forces.by_corner(forces.of_each_corner(np.arange(7.0)))[:5], np.tile(np.arange(7.0), (5, 1)))


@pytest.mark.slow
def test_the_exact_cell_is_the_default_and_other_strengths_say_so() -> None:
    flat, triangles = grid(4, 4, 0.63, 0.63)
    model = shell(wall_points(flat), triangles, surface_weight=28.6e3 * 0.04, supported=lambda p: p[:, 2] < 1e-9)
    elastic = cp.Elastic(3.18e9, 0.23, 0.303e9, 0.3, 1e-3)
    masonry, load = [cp.Material("default", 28.6e3, 0.7, elastic=elastic)], cp.LoadCase((0.3, 1, 0))
    for analysis in (cp.shell_limit_analysis, cp.pushover):
        by_default, exact = analysis(model, load, masonry), analysis(model, load, masonry, planes="cell")
        np.testing.assert_array_equal(by_default.load_factor, exact.load_factor)
        assert "outer approximation" not in by_default.message
        for planes in ("paper", "paper+torsion"):
            other = analysis(model, load, masonry, planes=planes)
            assert "outer approximation" in other.message
            assert np.max(other.load_factor) >= np.max(exact.load_factor) * (1 - 1e-6)
