from fractions import Fraction

import numpy as np
import pytest

from churchpipe.conic.interior_point.nonnegative import NonnegativeScaling
from churchpipe.homogenised_shell.planes import PlanePoints
from churchpipe.homogenised_shell.strength import paper_planes

rng = np.random.default_rng(5)
PLANES = paper_planes(0.275, 0.57, 0.9, 0.6).normal / np.array([1, 1, 1, 0.9, 0.9, 0.9])


def points(count: int, lent: float, quadratic: np.ndarray | None = None) -> PlanePoints:
    matrix = np.repeat(PLANES[:, :, None], count, axis=2)
    return PlanePoints(
        np.zeros((6, 6, count)) if quadratic is None else quadratic,
        np.zeros((6, count)),
        matrix,
        np.zeros((8, count)),
        np.zeros((6, count)),
        np.full((6, count), lent),
    )


def scaling(factor: np.ndarray) -> list[NonnegativeScaling]:
    return [NonnegativeScaling(factor, factor)]


def exact_solution(stiffness: list[list[Fraction]], force: list[Fraction]) -> list[Fraction]:
    """Solve by Gauss in rational numbers."""
    a = [[*row, value] for row, value in zip(stiffness, force, strict=True)]
    n = len(a)
    for j in range(n):
        pivot = next(i for i in range(j, n) if a[i][j] != 0)
        a[j], a[pivot] = a[pivot], a[j]
        for i in range(n):
            if i != j:
                ratio = a[i][j] / a[j][j]
                a[i] = [p - ratio * q for p, q in zip(a[i], a[j], strict=True)]
    return [a[i][n] / a[i][i] for i in range(n)]


def test_compliance_is_the_inverse_of_the_stiffness() -> None:
    count = 40
    root = rng.normal(size=(6, 6, count))
    quadratic = np.einsum("aik,ajk->ijk", root, root)
    local = points(count, 0.0, quadratic)
    factor = 10 ** rng.uniform(-1, 1, size=(8, count))
    stiffness = quadratic + np.einsum("ri,rk,rj->ijk", PLANES, factor**-2, PLANES)
    found = local.compliance(scaling(factor))
    product = np.einsum("ijk,jlk->ilk", stiffness, found.matrix)
    np.testing.assert_allclose(product, np.repeat(np.eye(6)[:, :, None], count, axis=2), atol=1e-9)
    force = rng.normal(size=(6, count))
    np.testing.assert_allclose(found.apply(force), np.einsum("ijk,jk->ik", found.matrix, force), rtol=1e-8, atol=1e-9)


def test_small_motions_across_flowing_planes_keep_their_digits() -> None:
    # Two planes flow (z / s = 1e20), the others are far (1e-12): compliances differ by thirty orders of magnitude.
    count = 20
    factor = np.full((8, count), 1e6)
    for k in range(count):
        factor[rng.choice(8, 2, replace=False), k] = 1e-10
    local = points(count, 1e-9)
    force = rng.normal(size=(6, count))
    slack = local.apply(local.compliance(scaling(factor)).apply(force)).reshape(8, count)
    for k in range(count):
        normal = [[Fraction(v) for v in row] for row in PLANES]
        weight = [1 / Fraction(v) ** 2 for v in factor[:, k]]
        stiffness = [
            [
                sum(
                    (w * row[i] * row[j] for w, row in zip(weight, normal, strict=True)),
                    Fraction(1e-9) if i == j else Fraction(0),
                )
                for j in range(6)
            ]
            for i in range(6)
        ]
        x = exact_solution(stiffness, [Fraction(v) for v in force[:, k]])
        size = max(abs(float(v)) for v in x)
        for r in np.flatnonzero(factor[:, k] < 1):
            wanted = float(sum((p * q for p, q in zip(normal[r], x, strict=True)), Fraction(0)))
            # A motion of size 1e9 along the planes is rounded; what it does across them must not be more than that.
            assert abs(slack[r, k] - wanted) <= 1e-14 * size


def test_multipliers_take_what_the_planes_can() -> None:
    count = 30
    local = points(count, 1e-9)
    factor = 10 ** rng.uniform(-10, 1, size=(8, count))
    local.compliance(scaling(factor))
    true = rng.uniform(0.5, 1.0, size=(8, count))
    force = local.transpose(true.ravel())
    noisy = true * (1 + 1e-3 * rng.normal(size=true.shape))
    left = force - local.transpose(local.balanced(force, noisy.ravel))
    before = force - local.transpose(noisy.ravel())
    assert np.abs(before).max() > 1e-4
    # The proximal stiffness keeps a share of 1e-9 over 1e-2.
    assert np.abs(left).max() < 1e-6 * np.abs(before).max()


def test_without_a_scaling_multipliers_stay() -> None:
    z = rng.normal(size=8)
    np.testing.assert_array_equal(points(1, 1e-9).balanced(np.ones((6, 1)), lambda: z), z)
    assert points(1, 1e-9).quadratic(np.ones((6, 1))) == pytest.approx(np.zeros((6, 1)))
