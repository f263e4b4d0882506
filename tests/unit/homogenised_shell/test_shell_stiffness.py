"""Stiffness of the facets of a shell, and figures of Malena, Portioli et al. 2019, Table 1, as computed for this project."""

from dataclasses import replace

import numpy as np
import pytest

from churchpipe.errors import InputError
from churchpipe.homogenised_shell.elastic_cell import cell_stiffness
from churchpipe.homogenised_shell.stiffness import stone_stiffness, wall_stiffness
from churchpipe.model.materials import Elastic
from hand_cell import hand_closing
from table_1 import joint_stiffness, table_1

TABLE_1 = Elastic(block_modulus=3.18e9, block_poisson=0.23, joint_modulus=0.303e9, joint_poisson=0.3, joint_thickness=1e-3)
A, B, H = 0.03, 0.08, 0.04


def test_table_1() -> None:
    stiffness = table_1(A, B, H, TABLE_1)
    membrane, bending = stiffness[:3, :3] / H * 1e-6, stiffness[3:, 3:] * 12 / H**3 * 1e-6
    np.testing.assert_allclose(membrane, [[3061, 563, 0], [563, 2644, 0], [0, 0, 924]], atol=0.5)
    np.testing.assert_allclose(bending, [[3095, 569, 0], [569, 2645, 0], [0, 0, 1157]], atol=0.5)
    np.testing.assert_array_equal(stiffness[:3, 3:], 0)


def test_joints_of_table_1() -> None:
    # A22 = h a kn and the sliding part of A11 give back kn = 407.9 and kt = 116.5 N/mm3.
    joints = joint_stiffness(A, B, H, TABLE_1)
    a, b = A + 1e-3, B + 1e-3
    kn = joints[1, 1] / (H * a)
    assert kn * 1e-9 == pytest.approx(407.9, abs=0.05)
    assert (joints[0, 0] / H - b * kn) * 4 * a / b**2 * 1e-9 == pytest.approx(116.5, abs=0.05)


def test_table_1_is_the_energy_of_the_rigid_cell_with_the_rotation_minimised_out() -> None:
    # Energy of the joints of the unit cell, integrated by Gauss points placed on the segments between its corners.
    thin = replace(TABLE_1, joint_thickness=1e-9, joint_modulus=0.303)
    kn, kt = 407.884615e6, 116.538462e6
    corners = hand_closing(A, B, H) * A * B
    station = 0.5 + np.array([-1.0, 1.0]) / np.sqrt(12)
    energy = np.zeros((9, 9))
    for joint, area in zip(corners.reshape(3, 2, 2, 3, 9), (A * H, B / 2 * H, B / 2 * H), strict=True):
        for u in station:
            for v in station:
                weights = np.outer([1 - u, u], [1 - v, v])
                jump = np.einsum("pq,pqci->ci", weights, joint)
                energy += area / 4 * jump.T @ np.diag([kn, kt, kt]) @ jump / (A * B)
    condensed = energy[:6, :6] - energy[:6, 6:] @ np.linalg.solve(energy[6:, 6:], energy[6:, :6])
    np.testing.assert_allclose(joint_stiffness(A, B, H, thin), condensed, rtol=1e-6, atol=1e-6 * condensed[3, 3])


def test_a_single_stone_is_a_plate() -> None:
    np.testing.assert_array_equal(wall_stiffness("single", A, B, H, TABLE_1), stone_stiffness(H, TABLE_1))


def test_facets_broadcast_and_cells_are_computed_once() -> None:
    cell_stiffness.cache_clear()
    many = wall_stiffness("running", [A, A, A + 1e-13, 0.275], [B, B, B, 0.57], [H, H, H, 0.9], TABLE_1)
    assert cell_stiffness.cache_info().misses == 2
    np.testing.assert_array_equal(many[:2], many[2:3].repeat(2, axis=0))
    np.testing.assert_allclose(many[3], wall_stiffness("running", 0.275, 0.57, 0.9, TABLE_1), rtol=1e-12)


def test_leaves_are_two_walls_and_a_butt_joint_a_stack() -> None:
    leaf = wall_stiffness("running", A, B, H / 2, TABLE_1)
    np.testing.assert_allclose(wall_stiffness("leaves", A, B, H, TABLE_1), 2 * leaf, rtol=1e-12)
    np.testing.assert_array_equal(wall_stiffness("butt", A, B, H, TABLE_1), wall_stiffness("stack", A, B, H, TABLE_1))


def test_an_unknown_bond_is_named() -> None:
    with pytest.raises(InputError, match="bond: unknown; found dutch"):
        wall_stiffness("dutch", A, B, H, TABLE_1)


def test_stones_and_mortar_too_unlike_are_refused() -> None:
    with pytest.raises(InputError, match="elastic: stones and mortar are so unlike"):
        wall_stiffness("running", A, B, H, replace(TABLE_1, block_modulus=1e21, joint_modulus=1e-2))


@pytest.mark.parametrize(
    ("key", "value"), [("block_modulus", 0.0), ("joint_modulus", -1.0), ("joint_thickness", 0.0), ("joint_poisson", 0.5)]
)
def test_elastic_constants_out_of_range_are_named(key: str, value: float) -> None:
    with pytest.raises(InputError, match=f"elastic.{key}"):
        wall_stiffness("running", A, B, H, replace(TABLE_1, **{key: value}))
