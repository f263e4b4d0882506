"""Points with the strength of the exact cell, against dense matrices, and what results say of other strengths."""

import numpy as np
import pytest
import scipy.sparse as sp

import churchpipe as cp
from churchpipe.conic.interior_point.second_order import SecondOrder
from churchpipe.homogenised_shell.cells import CORNERS, CellCoupling, CellPoints
from shell_meshes import grid, shell, wall_points

COUNT = 5


def points(rng: np.random.Generator, *, elastic: bool) -> tuple[CellPoints, np.ndarray, np.ndarray, np.ndarray]:
    sums = rng.normal(size=(9, 36, COUNT))
    root = np.einsum("abq,biq->aiq", rng.normal(size=(6, 6, COUNT)), sums[:6]) if elastic else None
    friction = rng.uniform(0.3, 1.2, CORNERS * COUNT)
    local = CellPoints(friction, sums, root, np.zeros((36, COUNT)), np.ones((36, COUNT)))
    return local, sums, np.zeros((6, 36, COUNT)) if root is None else root, friction


@pytest.mark.parametrize("elastic", [True, False])
@pytest.mark.parametrize("spread", [1.0, 1e3])
def test_compliances_are_the_inverse_of_the_stiffness(elastic: bool, spread: float) -> None:
    rng = np.random.default_rng(3)
    local, sums, root, friction = points(rng, elastic=elastic)
    cone = SecondOrder(3, 1, CORNERS * COUNT)
    inside = rng.normal(size=(2, 3, 1, CORNERS * COUNT))
    inside[:, 0] = np.sqrt((inside[:, 1:] ** 2).sum(axis=1)) + rng.uniform(0.1, 1.0, (2, 1, CORNERS * COUNT))
    inside *= spread ** rng.uniform(-1, 1, (2, 1, 1, CORNERS * COUNT))
    scaling = cone.scaling(inside[0], inside[1])
    found = local.compliance([scaling])
    force = rng.normal(size=(36, COUNT))
    answer = found.apply(force.reshape(3, -1)).reshape(36, COUNT)
    for k in range(COUNT):
        stiffness = np.einsum("ai,aj->ij", root[:, :, k], root[:, :, k])
        for c in range(CORNERS):
            at = c * COUNT + k
            w, eta = scaling.w[:, 0, at], scaling.eta[0, at]
            square = eta**2 * (2 * np.outer(w, w) - np.diag([1.0, -1.0, -1.0]))
            rows = np.diag([friction[at], 1.0, 1.0])
            mine = c + CORNERS * np.arange(3)
            stiffness[np.ix_(mine, mine)] += rows @ np.linalg.inv(square) @ rows
        inverse = np.linalg.inv(stiffness)
        np.testing.assert_allclose(answer[:, k], inverse @ force[:, k], rtol=1e-7, atol=1e-8 * np.abs(answer[:, k]).max())
        seen = sums[:, :, k] @ inverse @ sums[:, :, k].T
        np.testing.assert_allclose(found.matrix[:, :, k], seen, rtol=1e-7, atol=1e-8 * np.abs(seen).max())


def test_the_coupling_is_its_matrix() -> None:
    rng = np.random.default_rng(4)
    local, sums, _, _ = points(rng, elastic=True)
    equilibrium = sp.csr_matrix(rng.normal(size=(7, 6 * COUNT)))
    coupling = CellCoupling(equilibrium, sums)
    matrix = coupling.matrix()
    x, y = rng.normal(size=36 * COUNT), rng.normal(size=coupling.rows)
    assert coupling.rows == 7 + 3 * COUNT
    np.testing.assert_allclose(coupling.couple(x), matrix @ x, atol=1e-12)
    np.testing.assert_allclose(coupling.spread(y), matrix.T @ y, atol=1e-12)
    stress = np.einsum("aiq,iq->aq", sums[:6], x.reshape(36, -1)).T.ravel()
    np.testing.assert_allclose(coupling.couple(x)[:7], equilibrium @ stress, atol=1e-12)
    assert [unit.shape for unit in coupling.touched_units(np.ones(coupling.rows))] == [(local.count,)] * 2


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
