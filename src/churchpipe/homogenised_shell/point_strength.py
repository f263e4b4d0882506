"""Strength at each point of a shell, that of the point's facet: of a running bond or of a lintel."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from churchpipe.errors import InputError
from churchpipe.homogenised_shell.element import ShellElements
from churchpipe.homogenised_shell.settings import SOLVER
from churchpipe.homogenised_shell.strength import Cones, Planes, PlaneSet, strength
from churchpipe.model.arrays import FloatArray
from churchpipe.model.materials import JointStrength, by_name


def point_strength(
    elements: ShellElements, materials: Sequence[JointStrength], planes: PlaneSet, unit: FloatArray
) -> Planes | Cones:
    """Return the strength of all points (nq,). unit (nq, 6): of stress, N/m and N.

    Facets that do not yield, such as lintels, get the strength of a running bond with the friction and tension of
    `settings.SOLVER`, the same in N11 and in N22.

    Raises
    ------
    InputError: as `strength.strength`; a material of the shell that is not given.
    """
    shell, facet = elements.shell, elements.facet
    friction, cohesion = by_facet(shell.material, materials)
    lintel = ~shell.yields[facet]
    a, b = shell.unit_cells[shell.cell[facet]].T
    friction = np.where(lintel, SOLVER.lintel_friction, friction[facet])
    law = strength(planes, a, b, shell.thickness[facet], friction, np.where(lintel, 0.0, cohesion[facet]))
    apex = SOLVER.lintel_tension * unit * np.array([1.0, 1.0, 0.0, 0.0, 0.0, 0.0])
    if isinstance(law, Planes):
        limit = np.einsum("qpi,qi->qp", law.normal, apex)
        return replace(law, limit=np.where(lintel[:, None], limit, law.limit))
    return replace(law, apex=np.where(lintel[:, None], apex, law.apex))


def by_facet(names: npt.NDArray[np.str_], materials: Sequence[JointStrength]) -> tuple[FloatArray, FloatArray]:
    """Return friction (nt,) and cohesion (nt,)."""
    known = by_name(materials)
    used, which = np.unique(names, return_inverse=True)
    missing = [str(name) for name in used if str(name) not in known]
    if missing:
        raise InputError("materials", "a material of the shell is not given", found=missing[0], expected=", ".join(known))
    friction = np.array([known[str(name)].friction for name in used])
    cohesion = np.array([known[str(name)].cohesion for name in used])
    return friction[which], cohesion[which]
