"""Strength at each point of a shell, that of the point's facet: of its bond or of a lintel."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import get_args

import numpy as np
import numpy.typing as npt

from churchpipe.errors import InputError
from churchpipe.homogenised_shell.cell_limit import cohesion_shift
from churchpipe.homogenised_shell.element import ShellElements
from churchpipe.homogenised_shell.foot_joints import pair_closing
from churchpipe.homogenised_shell.rigid_cell import rigid_cell
from churchpipe.homogenised_shell.settings import SOLVER
from churchpipe.homogenised_shell.strength import Planes, paper_planes
from churchpipe.model.arguments import one_of
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.materials import JointStrength, by_name
from churchpipe.model.names import Planes as PlaneSet


@dataclass(frozen=True, slots=True)
class PointCells:
    """The exact strength of points: stress = apex + sum_kc f_kc closing_kci with corner forces f in Coulomb's cone.

    closings: one (corners, 3, 6 + still) for each kind of cell, of `rigid_cell`.
    areas (ng,): of the wall that one cell of a kind fills, m2; capacity: what each joint of a kind bears before it crushes, N,
    none where it does not; kind (nq,) of each point; friction (nq,); apex (nq, 6) N/m and N.
    """

    closings: tuple[FloatArray, ...]
    areas: FloatArray
    capacity: tuple[FloatArray, ...]
    kind: IntArray
    friction: FloatArray
    apex: FloatArray


def point_strength(
    elements: ShellElements, materials: Sequence[JointStrength], planes: PlaneSet, unit: FloatArray
) -> Planes | PointCells:
    """Return the strength of all points (nq,). unit (nq, 6): of stress, N/m and N.

    Facets that do not yield, such as lintels, get the strength of a running bond with the friction and tension of
    `settings.SOLVER`, the same in N11 and in N22.

    Raises
    ------
    InputError: unknown planes; as `strength.paper_planes`; planes for another bond than running bond; a material of the shell
    that is not given.
    """
    one_of("planes", planes, *get_args(PlaneSet))
    shell, facet = elements.shell, elements.facet
    friction, cohesion, endurance = by_facet(shell.material, materials)
    lintel = ~shell.yields[facet]
    friction = np.where(lintel, SOLVER.lintel_friction, friction[facet])
    dry = lintel | (shell.bonds[shell.cell] == "butt")[facet]
    cohesion = np.where(dry, 0.0, cohesion[facet])
    tension = SOLVER.lintel_tension * unit * np.array([1.0, 1.0, 0.0, 0.0, 0.0, 0.0])
    sizes = np.column_stack([shell.unit_cells[shell.cell], shell.thickness])
    bond, rank = np.unique(shell.bonds, return_inverse=True)
    if planes == "cell":
        # Facets of one wall share one cell.
        endurance = np.where(shell.yields, endurance, np.inf)
        known, kind = np.unique(np.column_stack([sizes, rank.ravel()[shell.cell], endurance]), axis=0, return_inverse=True)
        cells = [rigid_cell(str(bond[int(which)]), a, b, h) for a, b, h, which, _ in known.tolist()]
        apex = cohesion_shift(sizes[facet, 2], friction, cohesion)
        apex = np.where(lintel[:, None], tension, apex)
        closings, areas = [cell.closing for cell in cells], [cell.area for cell in cells]
        capacity = [
            each * cell.joints if np.isfinite(each) else np.zeros(0) for each, cell in zip(known[:, 4], cells, strict=True)
        ]
        of_point = kind.ravel()[facet].astype(np.int64)
        below = slice(elements.inner, len(facet))
        if elements.inner < len(facet):
            # Joints that bear as much before they crush are of one kind.
            most, which = np.unique((endurance * shell.thickness)[facet[below]], return_inverse=True)
            of_point[below] = len(closings) + which
            crushing = [each[np.isfinite(each)] for each in most[:, None]]
            closings += [pair_closing(crushes=len(each) > 0) for each in crushing]
            areas += [1.0] * len(most)
            capacity += crushing
            # Cohesion moves both corners of a pair away from the joint, each by its half.
            apex[below] = apex[below, 1, None] * np.array([0.5, 0.0, 0.0, 0.5, 0.0, 0.0])
        return PointCells(
            closings=tuple(closings),
            areas=np.array(areas),
            capacity=tuple(capacity),
            kind=of_point,
            friction=friction,
            apex=apex,
        )
    other = [str(name) for name in bond if name != "running"]
    if other:
        raise InputError(
            "planes",
            "the planes are those of running bond",
            found=f"{planes}, and a wall in {other[0]} bond",
            expected='planes = "cell", which is computed from the stones of any bond',
        )
    a, b, h = sizes[facet].T
    law = paper_planes(a, b, h, friction, cohesion, torsion=planes == "paper+torsion")
    limit = np.einsum("qpi,qi->qp", law.normal, tension)
    return replace(law, limit=np.where(lintel[:, None], limit, law.limit))


def by_facet(names: npt.NDArray[np.str_], materials: Sequence[JointStrength]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return friction, cohesion Pa and compressive strength Pa, infinite where nothing crushes, all (nt,)."""
    known = by_name(materials)
    used, which = np.unique(names, return_inverse=True)
    missing = [str(name) for name in used if str(name) not in known]
    if missing:
        raise InputError("materials", "a material of the shell is not given", found=missing[0], expected=", ".join(known))
    friction = np.array([known[str(name)].friction for name in used])
    cohesion = np.array([known[str(name)].cohesion for name in used])
    crushing = np.array([known[str(name)].compressive_strength or np.inf for name in used])
    return friction[which], cohesion[which], crushing[which]
