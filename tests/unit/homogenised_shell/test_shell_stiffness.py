"""Figures of Malena, Portioli et al. 2019, Table 1, as computed for this project."""

from dataclasses import replace

import numpy as np
import pytest

from churchpipe.errors import InputError
from churchpipe.homogenised_shell.stiffness import joint_stiffness, running_joint_stiffness, stone_stiffness, wall_stiffness
from churchpipe.homogenised_shell.unit_cell import joint_closing
from churchpipe.model.materials import Elastic

TABLE_1 = Elastic(block_modulus=3.18e9, block_poisson=0.23, joint_modulus=0.303e9, joint_poisson=0.3, joint_thickness=1e-3)
A, B, H = 0.03, 0.08, 0.04


def test_table_1() -> None:
    stiffness = wall_stiffness("running", A, B, H, TABLE_1)
    membrane, bending = stiffness[:3, :3] / H * 1e-6, stiffness[3:, 3:] * 12 / H**3 * 1e-6
    np.testing.assert_allclose(membrane, [[3061, 563, 0], [563, 2644, 0], [0, 0, 924]], atol=0.5)
    np.testing.assert_allclose(bending, [[3095, 569, 0], [569, 2645, 0], [0, 0, 1157]], atol=0.5)
    np.testing.assert_array_equal(stiffness[:3, 3:], 0)


def test_joints_of_table_1() -> None:
    # A22 = h a kn and the sliding part of A11 give back kn = 407.9 and kt = 116.5 N/mm3.
    joints = running_joint_stiffness(A, B, H, TABLE_1)
    a, b = A + 1e-3, B + 1e-3
    kn = joints[1, 1] / (H * a)
    assert kn * 1e-9 == pytest.approx(407.9, abs=0.05)
    assert (joints[0, 0] / H - b * kn) * 4 * a / b**2 * 1e-9 == pytest.approx(116.5, abs=0.05)


def test_joint_stiffness_is_the_energy_of_the_cell_with_the_rotation_minimised_out() -> None:
    # Energy of the joints of the unit cell, integrated by Gauss points placed on the segments between its corners.
    thin = replace(TABLE_1, joint_thickness=1e-9, joint_modulus=0.303)
    kn, kt = 407.884615e6, 116.538462e6
    corners = joint_closing(A, B, H) * A * B
    station = 0.5 + np.array([-1.0, 1.0]) / np.sqrt(12)
    energy = np.zeros((9, 9))
    for joint, area in zip(corners.reshape(3, 2, 2, 3, 9), (A * H, B / 2 * H, B / 2 * H), strict=True):
        for u in station:
            for v in station:
                weights = np.outer([1 - u, u], [1 - v, v])
                jump = np.einsum("pq,pqci->ci", weights, joint)
                energy += area / 4 * jump.T @ np.diag([kn, kt, kt]) @ jump / (A * B)
    condensed = energy[:6, :6] - energy[:6, 6:] @ np.linalg.solve(energy[6:, 6:], energy[6:, :6])
    np.testing.assert_allclose(running_joint_stiffness(A, B, H, thin), condensed, rtol=1e-6, atol=1e-6 * condensed[3, 3])


def test_stones_alone_when_joints_are_very_stiff() -> None:
    stiff = replace(TABLE_1, joint_modulus=1e20)
    np.testing.assert_allclose(wall_stiffness("running", A, B, H, stiff), stone_stiffness(H, TABLE_1), rtol=1e-6, atol=1e-3)
    np.testing.assert_array_equal(wall_stiffness("single", A, B, H, stiff), stone_stiffness(H, TABLE_1))


def test_facets_broadcast() -> None:
    many = wall_stiffness("running", [A, 0.275], [B, 0.57], [H, 0.9], TABLE_1)
    np.testing.assert_allclose(many[1], wall_stiffness("running", 0.275, 0.57, 0.9, TABLE_1), rtol=1e-12)


def test_running_bond_computed_from_its_stones_has_the_stiffness_of_table_1() -> None:
    found = joint_stiffness("running", A, B, H, TABLE_1)
    expected = running_joint_stiffness(A, B, H, TABLE_1)
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())
    with pytest.raises(InputError, match="bond: unknown; found dutch"):
        wall_stiffness("dutch", A, B, H, TABLE_1)


@pytest.mark.parametrize(
    ("key", "value"), [("block_modulus", 0.0), ("joint_modulus", -1.0), ("joint_thickness", 0.0), ("joint_poisson", 0.5)]
)
def test_elastic_constants_out_of_range_are_named(key: str, value: float) -> None:
    with pytest.raises(InputError, match=f"elastic.{key}"):
        wall_stiffness("running", A, B, H, replace(TABLE_1, **{key: value}))
