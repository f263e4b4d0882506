"""Elastic stiffness of a wall: stones and elastic joints in series (Malena et al. 2019, Table 1)."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from churchpipe.bond.period import period_of
from churchpipe.errors import InputError
from churchpipe.homogenised_shell.rigid_cell import joint_energy
from churchpipe.homogenised_shell.unit_cell import positive
from churchpipe.model.arrays import FloatArray
from churchpipe.model.materials import Elastic, JointStrength, by_name
from churchpipe.model.shell import ShellModel


def wall_stiffness(bond: str, a: npt.ArrayLike, b: npt.ArrayLike, h: npt.ArrayLike, elastic: Elastic) -> FloatArray:
    """Return the stiffness C (..., 6, 6) of a wall, stress (N11 .. M12) = C strain (E11, E22, 2 E12, chi11, chi22, 2 chi12).

    bond: a name of `bond.period`, or "single", one stone without joints (a lintel). a, b, h: course height, stone length, wall
    thickness, m, which broadcast. Membrane stiffness N/m, bending stiffness N m. The compliances of stones (an isotropic plate)
    and of joints between rigid stones are added; for running bond the latter in closed form. Against one period in finite
    elements this is within 5 %, but for M12, which is 16 to 23 % too stiff (docs/shell.md).

    Raises
    ------
    InputError: another bond, sizes or elastic constants out of range.
    """
    a, b, h = np.broadcast_arrays(positive("a", a), positive("b", b), positive("h", h))
    stones = stone_stiffness(h, elastic)
    if bond == "single":
        return stones
    if bond == "running":
        joints = running_joint_stiffness(a, b, h, elastic)
    else:
        sizes, which = np.unique(np.stack([a.ravel(), b.ravel(), h.ravel()], axis=1), axis=0, return_inverse=True)
        found = np.array([joint_stiffness(bond, height, length, depth, elastic) for height, length, depth in sizes.tolist()])
        joints = found[which.ravel()].reshape(*a.shape, 6, 6)
        if bond == "leaves":
            # Each leaf is a plate of half the thickness.
            stones = 2 * stone_stiffness(h / 2, elastic)
    compliance = np.linalg.inv(stones) + np.linalg.inv(joints)
    return np.asarray(np.linalg.inv(compliance), dtype=np.float64)


def joint_stiffness(bond: str, a: float, b: float, h: float, elastic: Elastic) -> FloatArray:
    """Return the stiffness (6, 6) of rigid stones in any bond with elastic joints, the motions of the stones minimised out."""
    across, along = joint_moduli(elastic)
    t = elastic.joint_thickness
    whole = joint_energy(period_of(bond, a + t, b + t, h), across, along)
    # The least energy; motions that no joint feels, as of a loose leaf, have none.
    return whole[:6, :6] - whole[:6, 6:] @ np.linalg.lstsq(whole[6:, 6:], whole[6:, :6], rcond=1e-12)[0]


def joint_moduli(elastic: Elastic) -> tuple[float, float]:
    """Return the stiffness of a joint per its area, confined by the stones, N/m3: across it and along it."""
    t, nu = elastic.joint_thickness, elastic.joint_poisson
    along = elastic.joint_modulus / (2 * (1 + nu)) / t
    return elastic.joint_modulus * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) / t, along


def facet_stiffness(shell: ShellModel, materials: Sequence[JointStrength]) -> FloatArray:
    """Return the stiffness (nt, 6, 6) of each facet: of its bond where it yields, of one stone where it does not.

    Raises
    ------
    InputError: as `wall_stiffness`; a material of the shell without elastic constants, or not given.
    """
    known = by_name(materials)
    a, b = shell.unit_cells[shell.cell].T
    out = np.zeros((len(shell.triangles), 6, 6))
    for name in np.unique(shell.material).tolist():
        if name not in known:
            raise InputError("materials", "a material of the shell is not given", found=name, expected=", ".join(known))
        elastic = known[name].elastic
        if elastic is None:
            raise InputError(
                f"material {name}",
                "no elastic constants, which a capacity curve needs",
                expected="elastic = { block_E_GPa, block_nu, joint_E_GPa, joint_nu, joint_thickness_mm }",
            )
        own = shell.material == name
        for bond in ("single", *np.unique(shell.bonds).tolist()):
            chosen = own & (~shell.yields if bond == "single" else shell.yields & (shell.bonds[shell.cell] == bond))
            if chosen.any():
                out[chosen] = wall_stiffness(bond, a[chosen], b[chosen], shell.thickness[chosen], elastic)
    return out


def stone_stiffness(h: npt.ArrayLike, elastic: Elastic) -> FloatArray:
    """Return the stiffness (..., 6, 6) of an isotropic plate of thickness h, m, made of the stones' material."""
    h = positive("h", h)
    nu = elastic.block_poisson
    plane = elastic.block_modulus / (1 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]])
    out = np.zeros((*h.shape, 6, 6))
    out[..., :3, :3] = h[..., None, None] * plane
    out[..., 3:, 3:] = (h**3 / 12)[..., None, None] * plane
    return out


def running_joint_stiffness(a: npt.ArrayLike, b: npt.ArrayLike, h: npt.ArrayLike, elastic: Elastic) -> FloatArray:
    """Return the stiffness (..., 6, 6) of rigid stones in running bond with elastic joints, their rotations minimised out.

    Stiffness per area of a joint: kn across, kt along it.
    """
    t = elastic.joint_thickness
    kn, kt = joint_moduli(elastic)
    a, b, h = positive("a", a) + t, positive("b", b) + t, positive("h", h)
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
    return np.stack(np.broadcast_arrays(*diagonal), axis=-1)[..., None] * np.eye(6)
