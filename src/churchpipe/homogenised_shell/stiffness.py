"""Elastic stiffness of a shell: of the bond of each facet, from finite elements of its period, or of one stone."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from churchpipe.errors import InputError
from churchpipe.homogenised_shell.cell_limit import positive
from churchpipe.homogenised_shell.elastic_cell import cell_stiffness
from churchpipe.model.arrays import FloatArray
from churchpipe.model.materials import Elastic, JointStrength, by_name
from churchpipe.model.shell import ShellModel

# Sizes nearer than this, m, are those of one cell.
_SAME_SIZE = 1e-9


def wall_stiffness(bond: str, a: npt.ArrayLike, b: npt.ArrayLike, h: npt.ArrayLike, elastic: Elastic) -> FloatArray:
    """Return the stiffness C (..., 6, 6) of a wall, stress (N11 .. M12) = C strain (E11, E22, 2 E12, chi11, chi22, 2 chi12).

    bond: a name of `bond.period`, or "single", one stone without joints (a lintel). a, b, h: course height, stone length, wall
    thickness, m, which broadcast. Membrane stiffness N/m, bending stiffness N m. Each size of cell is computed once.

    Raises
    ------
    InputError: another bond, sizes or elastic constants out of range, as `elastic_cell.cell_stiffness`.
    """
    a, b, h = np.broadcast_arrays(positive("a", a), positive("b", b), positive("h", h))
    if bond == "single":
        return stone_stiffness(h, elastic)
    sizes, which = np.unique(np.stack([a.ravel(), b.ravel(), h.ravel()], axis=1), axis=0, return_inverse=True)
    found = np.array([_of_cell(bond, x, y, z, elastic) for x, y, z in (np.round(sizes / _SAME_SIZE) * _SAME_SIZE).tolist()])
    return found[which.ravel()].reshape(*a.shape, 6, 6)


def _of_cell(bond: str, a: float, b: float, h: float, elastic: Elastic) -> FloatArray:
    """Return the stiffness (6, 6) of one cell. Leaves that no header ties are two walls of half the thickness."""
    if bond == "leaves":
        return 2 * cell_stiffness("running", a, b, h / 2, elastic)
    return cell_stiffness("stack" if bond == "butt" else bond, a, b, h, elastic)


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
