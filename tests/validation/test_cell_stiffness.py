"""Elastic stiffness of the walls of the shell: finite elements of one period against Table 1 and other closed forms."""

from dataclasses import replace

import numpy as np
import pytest

from churchpipe.homogenised_shell.elastic_cell import cell_stiffness
from churchpipe.homogenised_shell.stiffness import stone_stiffness, wall_stiffness
from churchpipe.model.materials import Elastic
from table_1 import joint_stiffness, table_1

# The bricks of S22: 80 x 30 mm faces, 40 mm thick, joints of 1 mm (Malena et al. 2019).
A, B, H = 0.03, 0.08, 0.04
ELASTIC = Elastic(3.18e9, 0.23, 0.303e9, 0.3, 1e-3)
BONDS = ["running", "stack", "flemish", "english"]


@pytest.mark.parametrize("size", [1.0, 0.4])
def test_rigid_stones_with_thin_joints_meet_table_1(size: float) -> None:
    # Table 1 takes stones as rigid and joints as surfaces. The thinner the joints and the stiffer the stones beside them, the
    # nearer: what is left is as long as the joint is thick, and extrapolates to none.
    apart = []
    for thickness in (5e-5, 5e-6):
        elastic = replace(ELASTIC, joint_thickness=thickness, block_modulus=1e6 * ELASTIC.joint_modulus * A / thickness)
        found, expected = cell_stiffness("running", A, B, size * H, elastic), joint_stiffness(A, B, size * H, elastic)
        apart.append(np.diag(found) / np.diag(expected) - 1)
        scale = np.sqrt(np.diag(expected))
        rest = found / np.outer(scale, scale)
        assert np.abs(rest - np.diag(np.diag(rest))).max() < 5e-3
    assert np.abs(apart[0]).max() < 2e-3
    assert np.abs(apart[1]).max() < 2e-4
    assert np.abs(10 * apart[1] - apart[0]).max() / 9 < 2e-5


@pytest.mark.parametrize(("bond", "size"), [("running", 0.5), ("stack", 2.0), ("flemish", 1.0), ("english", 1.0)])
def test_one_material_is_a_plate(bond: str, size: float) -> None:
    elastic = Elastic(3e9, 0.2, 3e9, 0.2, 1e-3)
    found, plate = cell_stiffness(bond, A, B, size * H, elastic), stone_stiffness(size * H, elastic)
    scale = np.sqrt(np.diag(plate))
    np.testing.assert_allclose(found / np.outer(scale, scale), plate / np.outer(scale, scale), rtol=0, atol=1e-9)


def test_beds_between_long_stones_are_layers() -> None:
    # Stones without head joints between them, nothing contracts: layers in series up the courses and side by side along them.
    elastic = replace(ELASTIC, block_poisson=0.0, joint_poisson=0.0)
    long = 1e3
    found = cell_stiffness("stack", A, long, H, elastic, element=1e9)
    t, stone, mortar = elastic.joint_thickness, elastic.block_modulus, elastic.joint_modulus
    up = (A + t) / (A / stone + t / mortar)
    shear = (A + t) / (2 * A / stone + 2 * t / mortar)
    assert found[1, 1] == pytest.approx(H * up, rel=1e-5)
    assert found[4, 4] == pytest.approx(H**3 / 12 * up, rel=1e-5)
    assert found[2, 2] == pytest.approx(H * shear, rel=1e-5)
    # One head joint of 1 mm in a kilometre of stone lets go of 1e-5 of it.
    assert found[0, 0] == pytest.approx(H * (A * stone + t * mortar) / (A + t), rel=1e-4)


def test_table_1_beside_solids() -> None:
    # docs/shell_results.md, "Stiffness of bonds".
    found, closed = wall_stiffness("running", A, B, H, ELASTIC), table_1(A, B, H, ELASTIC)
    assert np.diag(closed) / np.diag(found) == pytest.approx((1.026, 0.989, 1.010, 1.035, 0.990, 1.219), abs=1e-3)
    # Poisson's coupling, and no other.
    scale = np.sqrt(np.diag(found))
    others = np.abs(found / np.outer(scale, scale))
    assert (closed / found)[[0, 3], [1, 4]] == pytest.approx([1.0, 1.0], abs=0.05)
    others[np.ix_([0, 1], [0, 1])] = others[np.ix_([3, 4], [3, 4])] = 0.0
    assert (others - np.diag(np.diag(others))).max() < 1e-9


@pytest.mark.slow("docs/shell_results.md: Stiffness of bonds")
@pytest.mark.parametrize("bond", BONDS)
def test_finer_elements_change_it_by_less_than_a_hundredth(bond: str) -> None:
    for a, b, h, elastic in ((A, B, H, ELASTIC), (0.275, 0.57, 0.9, Elastic(3e9, 0.2, 0.3e9, 0.2, 0.01))):
        finer = 0.5
        found, fine = cell_stiffness(bond, a, b, h, elastic), cell_stiffness(bond, a, b, h, elastic, finer)
        ratio = np.diag(found) / np.diag(fine)
        assert ratio.min() > 1 - 1e-6
        assert ratio.max() < 1.01
