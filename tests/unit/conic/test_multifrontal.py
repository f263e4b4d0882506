"""The multifrontal factorisation against dense algebra, on matrices whose elimination trees differ."""

import numpy as np
import pytest
import scipy.sparse as sp

from churchpipe.conic.cholesky import Cholesky, NotDefiniteError
from churchpipe.conic.multifrontal import Multifrontal
from churchpipe.conic.supernodes import PARTS, supernodes
from churchpipe.model.arrays import FloatArray


def grid(side: int, width: int) -> sp.csc_matrix:
    """Return the Laplacian of a grid with `width` unknowns at a node, all of which couple, with a positive diagonal."""
    line = sp.diags([-1.0, 2.0, -1.0], [-1, 0, 1], shape=(side, side))
    nodes = sp.kron(line, sp.eye(side)) + sp.kron(sp.eye(side), line)
    dense = np.eye(width) + 0.1 * np.random.default_rng(3).normal(size=(width, width))
    return sp.csc_matrix(sp.kron(nodes, dense @ dense.T) + 0.01 * sp.eye(side * side * width))


def arrow(count: int) -> sp.csc_matrix:
    """Return a matrix whose last row is full, and whose other rows couple to it alone."""
    matrix = sp.lil_matrix(sp.eye(count) * 2.0)
    matrix[-1, :-1] = matrix[:-1, -1] = 0.5
    matrix[-1, -1] = float(count)
    return sp.csc_matrix(matrix)


MATRICES = {
    "one row": sp.csc_matrix([[4.0]]),
    "diagonal": sp.csc_matrix(sp.diags(np.arange(1.0, 40.0))),
    "full": sp.csc_matrix(grid(5, 1).toarray() + np.full((25, 25), 0.3)),
    "arrow": arrow(60),
    "grid": grid(30, 3),
    "two grids apart": sp.csc_matrix(sp.block_diag([grid(12, 2), grid(17, 1)])),
}


def lower(matrix: sp.csc_matrix) -> sp.csc_matrix:
    out = sp.csc_matrix(sp.tril(matrix))
    out.sort_indices()
    return out


def factored(triangle: sp.csc_matrix, order: np.ndarray) -> Multifrontal:
    factor = Multifrontal(triangle, order)
    factor.take(triangle.data)
    factor.factor()
    return factor


def dissection(side: int, width: int) -> np.ndarray:
    """Return an order of a grid that leaves its middle line, and then those of the halves, to the end."""

    def ordered(nodes: np.ndarray) -> np.ndarray:
        if min(nodes.shape) < 4:
            return nodes.ravel()
        along = nodes if nodes.shape[0] >= nodes.shape[1] else nodes.T
        middle = len(along) // 2
        return np.concatenate([ordered(along[:middle]), ordered(along[middle + 1 :]), along[middle]])

    return (ordered(np.arange(side * side).reshape(side, side))[:, None] * width + np.arange(width)).ravel()


@pytest.mark.parametrize("name", MATRICES)
def test_it_solves_as_dense_algebra_does(name: str) -> None:
    matrix = MATRICES[name]
    triangle = lower(matrix)
    factor = factored(triangle, np.arange(matrix.shape[0]))
    right = np.random.default_rng(1).normal(size=matrix.shape[0])
    np.testing.assert_allclose(factor.solve(right), np.linalg.solve(matrix.toarray(), right), rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize("name", MATRICES)
def test_several_right_sides_are_solved_one_by_one(name: str) -> None:
    matrix = MATRICES[name]
    triangle = lower(matrix)
    order = np.random.default_rng(2).permutation(matrix.shape[0])
    factor = factored(triangle, order)
    right = np.random.default_rng(1).normal(size=(matrix.shape[0], 3))
    assert np.array_equal(factor.solve(right), np.stack([factor.solve(column) for column in right.T], axis=1))
    np.testing.assert_allclose(matrix @ factor.solve(right), right, atol=1e-10)


def test_a_second_matrix_of_the_pattern_leaves_nothing_of_the_first() -> None:
    triangle = lower(MATRICES["grid"])
    fresh = factored(triangle, np.arange(triangle.shape[0]))
    factor = factored(sp.csc_matrix(3.0 * triangle), np.arange(triangle.shape[0]))
    factor.take(triangle.data)
    factor.factor()
    right = np.ones(triangle.shape[0])
    assert np.array_equal(factor.solve(right), fresh.solve(right))


@pytest.mark.parametrize("place", [0, 1350, 2699])
def test_a_matrix_that_is_not_definite_is_told(place: int) -> None:
    triangle = lower(MATRICES["grid"])
    values = triangle.data.copy()
    values[triangle.indptr[place]] = -1.0
    factor = Multifrontal(triangle, np.arange(triangle.shape[0]))
    factor.take(values)
    with pytest.raises(ArithmeticError) as told:
        factor.factor()
    assert told.value.args[0] >= place


def solved(monkeypatch: pytest.MonkeyPatch, threads: str, matrix: sp.csc_matrix, right: FloatArray) -> FloatArray:
    monkeypatch.setenv("OMP_NUM_THREADS", threads)
    return factored(lower(matrix), dissection(30, 3)).solve(right)


def test_the_last_digit_does_not_hang_on_the_number_of_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    matrix = MATRICES["grid"]
    right = np.random.default_rng(1).normal(size=matrix.shape[0])
    one, two = (solved(monkeypatch, threads, matrix, right) for threads in ("1", "2"))
    assert np.array_equal(one, two)


def test_fronts_hold_the_factor_and_parts_hold_every_front_once() -> None:
    matrix = MATRICES["grid"]
    triangle = lower(matrix)
    tree = supernodes(triangle, dissection(30, 3))
    dense = np.linalg.cholesky(matrix[tree.order][:, tree.order].toarray())
    held = np.zeros_like(dense, dtype=bool)
    for s in range(len(tree.start)):
        own = np.arange(tree.start[s], tree.start[s] + tree.width[s])
        held[np.ix_(np.concatenate([own, tree.below[tree.at[s] : tree.at[s + 1]]]), own)] = True
    assert not (np.abs(dense) > 1e-14)[~held & np.tri(len(dense), dtype=bool)].any()
    parts = [np.arange(first, last + 1) for first, last in zip(tree.part_first, tree.part_last, strict=True)]
    assert np.array_equal(np.sort(np.concatenate([*parts, tree.top])), np.arange(len(tree.start)))
    assert len(parts) >= PARTS / 2


@pytest.mark.parametrize("installed", [True, False])
def test_the_order_is_that_of_metis_or_without_it_of_minimum_degree(monkeypatch: pytest.MonkeyPatch, installed: bool) -> None:
    if not installed:
        monkeypatch.setattr("churchpipe.conic.cholesky.find_spec", lambda _: None)
    matrix = MATRICES["grid"]
    triangle = lower(matrix)
    factor = Cholesky(triangle, 3)
    factor.factor(triangle.data)
    right = np.random.default_rng(1).normal(size=(matrix.shape[0], 2))
    np.testing.assert_allclose(matrix @ factor.solve(right), right, atol=1e-9)
    # Row by row the factor has four times as many entries.
    assert triangle.nnz <= factor.nonzeros() < 0.5 * factored(triangle, np.arange(matrix.shape[0])).nonzeros()


def test_a_matrix_that_is_not_definite_is_told_by_the_same_name() -> None:
    triangle = lower(MATRICES["grid"])
    with pytest.raises(NotDefiniteError, match="at column"):
        Cholesky(triangle, 3).factor(-triangle.data)
