"""Strength of the points of a shell in the form of the interior-point solver: rows and cones of one local problem each."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import scipy.sparse as sp

from churchpipe.conic.pressed import POINTS, ROWS, UNIT_POINT, UNIT_ROW, pressed_closing
from churchpipe.homogenised_shell.cell_forces import CellForces, cell_forces
from churchpipe.homogenised_shell.element import ShellElements
from churchpipe.homogenised_shell.flow import flow_of_cones, flow_of_planes
from churchpipe.homogenised_shell.point_strength import PointCells, point_strength
from churchpipe.homogenised_shell.strength import Planes
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.materials import JointStrength
from churchpipe.model.names import Planes as PlaneSet

# S of `conic.pressed` in the units of corner forces.
UNIT = 1.0


def _none() -> IntArray:
    return np.zeros(0, dtype=np.int64)


@dataclass(frozen=True, slots=True)
class PlaneStrength:
    """Strength of every point by planes, in units of stress: matrix_riq stress <= right.

    matrix (rows, 6, nq), right (rows, nq). size (rows, nq): multipliers divided by it and by the area are those of the planes of
    `strength.Planes`. The variables x (6 nq,) are the stresses.
    """

    matrix: FloatArray
    right: FloatArray
    size: FloatArray

    @property
    def variables(self) -> int:
        """Number of variables."""
        return self.matrix[0].size

    @property
    def multipliers(self) -> int:
        """Number of multipliers."""
        return self.right.size

    @property
    def offset(self) -> FloatArray:
        """Stress (6, nq) of the variables zero."""
        return np.zeros(self.matrix.shape[1:])

    def stress(self, x: FloatArray) -> FloatArray:
        """Return the stresses (6, nq)."""
        return x.reshape(self.matrix.shape[1:])

    def violation(self, x: FloatArray) -> float:
        """Return the largest excess over the strength, at least zero."""
        return max(0.0, float((np.einsum("riq,iq->rq", self.matrix, self.stress(x)) - self.right).max()))

    def flow(self, rate: FloatArray, start: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return multipliers (rows nq,) that explain a rate conjugate to x, found from `start`, and the remainder (6 nq,)."""
        z, rest = flow_of_planes(self.matrix, rate.reshape(self.matrix.shape[1:]), start.reshape(self.right.shape))
        return z.ravel(), rest.ravel()

    def price(self, multipliers: FloatArray) -> FloatArray:
        """Return the dissipation (nq,) of multipliers beyond the work of the offset."""
        return (self.right * multipliers.reshape(self.right.shape)).sum(axis=0)

    def rates(self, multipliers: FloatArray) -> FloatArray:
        """Return the rates (planes, nq) of the planes of `strength.Planes` times the areas of the points."""
        return multipliers.reshape(self.size.shape) / self.size

    def rows(self) -> sp.csr_matrix[np.float64]:
        """Return the planes (rows nq, 6 nq), all component first, for solvers that take matrices."""
        r, i, q = (index.ravel() for index in np.indices(self.matrix.shape))
        count = self.matrix.shape[2]
        matrix = sp.csr_matrix((self.matrix.ravel(), (r * count + q, i * count + q)))
        matrix.eliminate_zeros()
        return matrix


@dataclass(frozen=True, slots=True)
class CellStrength:
    """Strength of every point by its cell, in units of stress: stress = offset (6, nq) + sums of the corner forces x.

    friction (corners,) of the corners; opening (nq,): multipliers times it and over the area of the point are the openings of
    the joints' corners, m. The variables x (3 corners,) are the forces, each within its cone. Joints that crush have further
    corners and rows (`conic.pressed`): the rows `unit_row` have the sum S, one a joint, which the corners `unit_corner` make at
    the points `unit_point`.
    """

    forces: CellForces
    offset: FloatArray
    friction: FloatArray
    opening: FloatArray
    unit_row: IntArray = field(default_factory=_none)
    unit_corner: IntArray = field(default_factory=_none)
    unit_point: IntArray = field(default_factory=_none)

    @property
    def total(self) -> FloatArray:
        """What the sums on stones and joints amount to (rows,)."""
        out = np.zeros(self.forces.rows)
        out[self.unit_row] = UNIT
        return out

    @property
    def variables(self) -> int:
        """Number of variables."""
        return 3 * self.forces.count

    @property
    def multipliers(self) -> int:
        """Number of multipliers."""
        return self.variables

    def stress(self, x: FloatArray) -> FloatArray:
        """Return the stresses (6, nq)."""
        return self.offset + self.forces.add_up(x.reshape(3, -1))[0]

    def violation(self, x: FloatArray) -> float:
        """Return the largest excess over the strength, at least zero."""
        normal, *shear = x.reshape(3, -1)
        return max(0.0, float((np.sqrt(shear[0] ** 2 + shear[1] ** 2) - self.friction * normal).max()))

    def flow(self, rate: FloatArray, _start: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return multipliers (3 corners,) that explain a rate conjugate to x, and the remainder."""
        scale = np.stack([-self.friction, -np.ones_like(self.friction), -np.ones_like(self.friction)])
        z = flow_of_cones(rate.reshape(3, -1) / scale)
        return z.ravel(), (rate.reshape(3, -1) - scale * z).ravel()

    def price(self, multipliers: FloatArray) -> FloatArray:
        """Return the dissipation (nq,) of multipliers beyond the work of the offset, the cones' apex: that of joints that crush.

        S has the multiplier y of its row, which adds y to both n and t2 of the further corner in it; friction is 1 there.
        """
        z = multipliers.reshape(3, -1)[:, self.unit_corner]
        return np.bincount(self.unit_point, UNIT * (z[0] + z[2]) / 2, minlength=len(self.opening)).astype(np.float64)

    def rates(self, multipliers: FloatArray) -> FloatArray:
        """Return the openings (m) of the joints' corners (most corners of a cell, nq) times the areas of the points.

        Further corners, of joints that crush, follow the corners of a cell.
        """
        return self.forces.by_corner(multipliers[: len(self.friction)]) * self.opening

    def rows(self) -> sp.csr_matrix[np.float64]:
        """Return the rows of the cones (3 corners, 3 corners), component first, for solvers that take matrices."""
        return sp.csr_matrix(sp.diags(-np.concatenate([self.friction, np.ones(2 * len(self.friction))])))


def local_strength(
    elements: ShellElements, materials: Sequence[JointStrength], planes: PlaneSet, unit: FloatArray
) -> PlaneStrength | CellStrength:
    """Return the strength of all points; unit (nq, 6). Raises as `point_strength`."""
    law = point_strength(elements, materials, planes, unit)
    if isinstance(law, Planes):
        normal = law.normal * unit[:, None]
        size = np.abs(normal).max(axis=2)
        matrix = np.moveaxis(normal / size[..., None], 0, 2)
        return PlaneStrength(np.ascontiguousarray(matrix), np.ascontiguousarray((law.limit / size).T), size.T)
    forces, sizes = scaled_forces(law, unit)
    friction = forces.of_each_corner(law.friction)
    rows: list[IntArray] = [_none()]
    corners: list[IntArray] = [_none()]
    points: list[IntArray] = [_none()]
    for kind, (closing, capacity) in enumerate(zip(law.closings, law.capacity, strict=True)):
        own, real, motions = np.flatnonzero(law.kind == kind), len(closing), closing.shape[2] - 6
        first, place = int(forces.corner[kind]), np.arange(len(own))
        friction[first + real * len(own) : int(forces.corner[kind + 1])] = 1.0
        for joint in range(len(capacity)):
            rows.append(int(forces.row[kind]) + (motions + ROWS * joint + UNIT_ROW) * len(own) + place)
            corners.append(first + (real + POINTS * joint + UNIT_POINT) * len(own) + place)
            points.append(own)
    return CellStrength(
        forces=forces,
        offset=np.ascontiguousarray((law.apex / unit).T),
        friction=friction,
        opening=(sizes * law.areas)[law.kind] * law.friction,
        unit_row=np.concatenate(rows),
        unit_corner=np.concatenate(corners),
        unit_point=np.concatenate(points),
    )


def scaled_forces(law: PointCells, unit: FloatArray) -> tuple[CellForces, FloatArray]:
    """Return the sums of the corner forces of all points in units of stress, and the unit of force (ng,) of each kind.

    Corner forces have units that give stresses of order one; the rows of the stones are scaled to one as well.
    """
    closings: list[FloatArray] = []
    sizes = np.empty(len(law.closings))
    for kind, closing in enumerate(law.closings):
        mine = unit[int((law.kind == kind).argmax())]
        sizes[kind] = np.abs(closing[..., :3] / mine[:3]).max()
        still = closing[..., 6:] / np.abs(closing[..., 6:]).max(axis=(0, 1))
        scaled = np.concatenate([closing[..., :6] / mine / sizes[kind], still], axis=2)
        # A force of N newtons is size N in these units.
        closings.append(pressed_closing(scaled, np.sqrt(law.capacity[kind] * sizes[kind] / UNIT)))
    return cell_forces(closings, law.kind), sizes
