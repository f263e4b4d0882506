"""Elastic stiffness of the walls of the shell against finite elements of one period, stones and mortar as solids (scikit-fem)."""

import numpy as np
import pytest

from churchpipe.homogenised_shell.stiffness import wall_stiffness
from churchpipe.model.materials import Elastic
from periodic_cell import cell_stiffness

# The bricks of S22: 80 x 30 mm faces, 40 mm thick, joints of 1 mm (Malena et al. 2019).
A, B, H = 0.03, 0.08, 0.04
ELASTIC = Elastic(3.18e9, 0.23, 0.303e9, 0.3, 1e-3)


@pytest.mark.parametrize(
    ("bond", "ratio"),
    [
        ("running", (1.045, 1.031, 1.019, 1.054, 1.032, 1.230)),
        ("stack", (1.037, 1.031, 0.966, 1.037, 1.031, 1.194)),
        ("flemish", (1.048, 1.016, 1.017, 1.047, 1.006, 1.162)),
        ("english", (1.051, 1.012, 1.017, 1.045, 1.007, 1.172)),
    ],
)
def test_stones_and_joints_in_series_against_solids(bond: str, ratio: tuple[float, ...]) -> None:
    # docs/shell.md, "Stiffness": for running bond the closed form of Table 1.
    found, expected = wall_stiffness(bond, A, B, H, ELASTIC), cell_stiffness(bond, A, B, H, ELASTIC, divisions=1)
    assert np.diag(found) / np.diag(expected) == pytest.approx(ratio, abs=2e-3)
    scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    np.testing.assert_allclose(expected / scale, expected.T / scale, atol=1e-6)
    # Poisson's coupling, and no other.
    assert (found / expected)[[0, 3], [1, 4]] == pytest.approx([1.0, 1.0], abs=0.05)
    others = np.abs(expected / scale)
    others[np.ix_([0, 1], [0, 1])] = others[np.ix_([3, 4], [3, 4])] = 0.0
    assert (others - np.diag(np.diag(others))).max() < 1e-5


@pytest.mark.parametrize("size", [0.5, 2.0])
def test_one_material_is_a_plate(size: float) -> None:
    elastic = Elastic(3e9, 0.2, 3e9, 0.2, 1e-3)
    h = size * H
    found = cell_stiffness("running", A, B, h, elastic, divisions=1)
    plane = 3e9 / (1 - 0.2**2) * np.array([[1, 0.2, 0], [0.2, 1, 0], [0, 0, 0.4]])
    np.testing.assert_allclose(found[:3, :3], h * plane, rtol=1e-6, atol=1e-6 * h * plane.max())
    np.testing.assert_allclose(found[3:, 3:], h**3 / 12 * plane, rtol=1e-6, atol=1e-6 * h**3 / 12 * plane.max())
