"""Stiffness of running bond in closed form: Table 1 of Malena et al. (2019), stones and elastic joints in series."""

import numpy as np

from churchpipe.homogenised_shell.stiffness import stone_stiffness
from churchpipe.model.materials import Elastic


def table_1(a: float, b: float, h: float, elastic: Elastic) -> np.ndarray:
    """Return the stiffness (6, 6) of a wall: the compliances of stones (an isotropic plate) and joints added."""
    compliance = np.linalg.inv(stone_stiffness(h, elastic)) + np.linalg.inv(joint_stiffness(a, b, h, elastic))
    return np.linalg.inv(compliance)


def joint_stiffness(a: float, b: float, h: float, elastic: Elastic) -> np.ndarray:
    """Return the stiffness (6, 6) of rigid stones with elastic joints, the rotations of the stones minimised out.

    Stiffness per area of a joint, confined by the stones: kn across, kt along it.
    """
    t, nu = elastic.joint_thickness, elastic.joint_poisson
    kt = elastic.joint_modulus / (2 * (1 + nu)) / t
    kn = elastic.joint_modulus * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) / t
    a, b = a + t, b + t
    along = b * kn + b**2 * kt / (4 * a)
    bed, head = a * kt, kn * b**2 / (4 * a) + b * kt
    roll = h * kt
    diagonal = [
        h * along,
        h * a * kn,
        h * bed * head / (bed + head),
        h**3 / 12 * along + roll * b**4 / (192 * a),
        h**3 / 12 * a * kn,
        (h**3 / 12 * (bed + head) + roll * (a * b**2 / 48 + a**2 * b / 12)) / 4,
    ]
    return np.diag(diagonal)
