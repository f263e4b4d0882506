"""Strength of the points of a shell in the form of the interior-point solver: rows and cones of one local problem each."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from churchpipe.conic.interior_point.cones import Cone
from churchpipe.conic.interior_point.nonnegative import Nonnegative
from churchpipe.conic.interior_point.second_order import SecondOrder
from churchpipe.homogenised_shell.element import ShellElements
from churchpipe.homogenised_shell.point_strength import point_strength
from churchpipe.homogenised_shell.strength import Planes, PlaneSet
from churchpipe.model.arrays import FloatArray
from churchpipe.model.materials import JointStrength


@dataclass(frozen=True, slots=True)
class LocalStrength:
    """Strength of every point in variables x (d, nq), in units of stress.

    stress = offset (6, nq) + of_aiq x;  still_miq x = 0 (moments on the stones of the exact cell, or none);
    right (rows, nq) - matrix_riq x in the cones; inner (d, nq) is inside.
    size (rows, nq): multipliers divided by it and by the area are those of the planes of `strength.Planes`; of the exact cell
    the first twelve are the openings of the joints' corners, m.
    """

    of: FloatArray
    offset: FloatArray
    still: FloatArray
    matrix: FloatArray
    right: FloatArray
    cones: tuple[Cone, ...]
    inner: FloatArray
    size: FloatArray


def local_strength(
    elements: ShellElements, materials: Sequence[JointStrength], planes: PlaneSet, unit: FloatArray
) -> LocalStrength:
    """Return the strength of all points; unit (nq, 6). Raises as `point_strength`."""
    law = point_strength(elements, materials, planes, unit)
    nq = len(elements.facet)
    if isinstance(law, Planes):
        normal = law.normal * unit[:, None]
        size = np.abs(normal).max(axis=2)
        matrix = np.moveaxis(normal / size[..., None], 0, 2)
        inner = np.zeros((6, nq))
        inner[:2] = -1.0
        return LocalStrength(
            of=np.broadcast_to(np.eye(6)[:, :, None], (6, 6, nq)),
            offset=np.zeros((6, nq)),
            still=np.zeros((0, 6, nq)),
            matrix=np.ascontiguousarray(matrix),
            right=np.ascontiguousarray((law.limit / size).T),
            cones=(Nonnegative(matrix.shape[0], nq),),
            inner=inner,
            size=size.T,
        )
    a, b = elements.shell.unit_cells[elements.shell.cell[elements.facet]].T
    # Variables component first, as the cones take them: 12 normal forces, then the shears.
    closing = np.swapaxes(law.closing, 1, 2).reshape(nq, 36, 9)
    size = np.abs(closing[..., :3] / unit[:, None, :3]).max(axis=(1, 2))[:, None, None]
    turn = closing[..., 6:] / np.abs(closing[..., 6:]).max(axis=1, keepdims=True)
    slope = np.repeat([1.0, 0.0], [12, 24])[:, None] * (law.friction - 1.0) + 1.0
    inner = np.zeros((36, nq))
    inner[:12] = 1.0
    return LocalStrength(
        of=np.ascontiguousarray(np.moveaxis(closing[..., :6] / unit[:, None] / size, 0, 2).swapaxes(0, 1)),
        offset=np.ascontiguousarray((law.apex / unit).T),
        still=np.ascontiguousarray(np.moveaxis(turn, 0, 2).swapaxes(0, 1)),
        matrix=-np.eye(36)[:, :, None] * slope,
        right=np.zeros((36, nq)),
        cones=(SecondOrder(3, 12, nq),),
        inner=inner,
        size=np.broadcast_to(1.0 / (size[:, 0, 0] * law.friction * a * b), (36, nq)),
    )
