"""Points of a shell with the strength of cells of rigid stones, as local problems of the interior-point solver.

The variables of a limit analysis are the forces at the corners of the cells' joints. A step of a capacity curve has the stresses
of the points besides, which alone have elastic energy; further rows say that they are the sums of the corner forces. The
multipliers of these rows are the strains of the joints, those of the sums on the stones the motions of the stones. Both are
eliminated point by point, so that the sparse matrix is that of the shell alone.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from churchpipe.conic.cholesky import Cholesky
from churchpipe.conic.interior_point.cones import Scaling
from churchpipe.conic.interior_point.coulomb import CoulombCompliance, CoulombPoints
from churchpipe.conic.interior_point.coupling import Coupling, Touches
from churchpipe.homogenised_shell.cell_elimination import CellElimination
from churchpipe.homogenised_shell.cell_forces import CellForces
from churchpipe.homogenised_shell.energy import Energy
from churchpipe.homogenised_shell.points import CellStrength
from churchpipe.homogenised_shell.settings import SOLVER
from churchpipe.model.arrays import FloatArray


class CellCoupling(Coupling):
    """Equilibrium (m, 6 nq), given by its parts, and the sums on the stones, in terms of x.

    x (n,): the corner forces (3, corners), flat; with `elastic` the stresses (6, nq) after them. Rows: equilibrium; with
    `elastic` the stresses of the corners less those of the points, (6, nq) flat; the sums on the stones.
    """

    def __init__(self, equilibrium: Touches, forces: CellForces, *, elastic: bool) -> None:
        super().__init__(equilibrium)
        self._forces, self._elastic = forces, elastic
        self._nq, self._own = self.count, self.rows
        self.rows = self._own + forces.rows + (6 * self._nq if elastic else 0)
        self._corners = 3 * forces.count

    def couple(self, x: FloatArray) -> FloatArray:
        """Return B x."""
        stress, still = self._forces.add_up(x[: self._corners].reshape(3, -1))
        own = x[self._corners :] if self._elastic else stress.ravel()
        out = super().couple(own)
        out[len(out) - len(still) :] = still
        if self._elastic:
            np.subtract(stress.ravel(), own, out=out[self._own : self._own + len(own)])
        return out

    def spread(self, y: FloatArray) -> FloatArray:
        """Return B^T y."""
        strain, joints, still = self.split(y)
        stress = super().spread(strain)
        of_corners = self._forces.spread((joints if self._elastic else stress).reshape(6, -1), still).ravel()
        return np.concatenate([of_corners, stress - joints]) if self._elastic else of_corners

    def split(self, y: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the parts of y for equilibrium, the strains of the joints (6 nq, or none) and the stones."""
        end = len(y) - self._forces.rows
        return y[: self._own], y[self._own : end], y[end:]

    def touched_units(self, unit: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return for each variable the smallest and the largest unit of the equilibrium rows that its cell enters."""
        smallest, largest = super().touched_units(unit[: self._own])
        return self._at_variables(smallest), self._at_variables(largest)

    def passing(self, x: FloatArray) -> FloatArray:
        """Return the largest stress that passes each row, or force at a corner that moves the stone."""
        stress, _ = self._forces.add_up(x[: self._corners].reshape(3, -1))
        through = np.abs(stress).max(axis=0)
        parts = [super().passing(stress.ravel())[: self._own], self._forces.of_each_row(through)]
        if self._elastic:
            parts.insert(1, np.tile(through, 6))
        return np.concatenate(parts)

    def matrix(self) -> sp.csr_matrix[np.float64]:
        """Return B of a limit analysis, for solvers that take matrices."""
        stress, still = self._forces.matrix()
        return sp.csr_matrix(sp.vstack([super().matrix()[: self._own] @ stress, still]))

    def equilibrate(self, stress: FloatArray) -> FloatArray:
        """Return the forces (m,) of stresses (6, nq)."""
        return super().couple(np.ascontiguousarray(stress).ravel())[: self._own]

    def strain(self, motion: FloatArray) -> FloatArray:
        """Return the strains (6, nq) of a motion (m,)."""
        return super().spread(motion).reshape(6, -1)

    def _at_variables(self, values: FloatArray) -> FloatArray:
        corners = np.tile(self._forces.of_each_corner(values), 3)
        return np.concatenate([corners, np.tile(values, 6)]) if self._elastic else corners


@dataclass(frozen=True, slots=True)
class CellCompliance:
    """Compliances of the corners in closed form, and of the stresses, which is E; matrix (6, 6, nq): D of `cell_elimination`."""

    corners: CoulombCompliance
    stiffness: FloatArray | None
    matrix: FloatArray

    def apply(self, force: FloatArray) -> FloatArray:
        """Return S force, (1, n)."""
        split = 3 * len(self.corners.normal)
        of_corners = self.corners.apply(force[0, :split].reshape(3, -1)).ravel()
        if self.stiffness is None:
            return of_corners[None]
        stress = np.einsum("abq,bq->aq", self.stiffness, force[0, split:].reshape(6, -1))
        return np.concatenate([of_corners, stress.ravel()])[None]


class CellPoints(CoulombPoints):
    """Cells whose corners carry Coulomb friction; in an elastic step with the energy 1/2 stress C stress + linear stress.

    law: friction of the corners, and how their forces make stresses. start: corner forces near which a step begins.
    """

    def __init__(self, law: CellStrength, elimination: CellElimination, energy: Energy | None, start: FloatArray | None) -> None:
        nothing = np.zeros_like(law.friction)
        super().__init__(nothing, law.friction, nothing, nothing)
        self._law, self._elimination, self._energy, self._start = law, elimination, energy, start
        self._corners = law.variables
        self.curved = energy is not None
        flat = [np.zeros(self._corners)] if energy is None else [np.zeros(self._corners), energy.linear.ravel()]
        self.linear = np.concatenate(flat)[None]
        self.dimension, self.count = 1, self.linear.shape[1]

    def quadratic(self, x: FloatArray) -> FloatArray:
        """Return Q x."""
        out = np.zeros_like(x)
        if self._energy is not None:
            stress = x[0, self._corners :].reshape(6, -1)
            out[0, self._corners :] = np.einsum("abq,bq->aq", self._energy.compliance, stress).ravel()
        return out

    def apply(self, x: FloatArray) -> FloatArray:
        """Return G x."""
        return super().apply(self._at_corners(x))

    def transpose(self, z: FloatArray) -> FloatArray:
        """Return G^T z."""
        out = np.zeros((1, self.count))
        cone = z.reshape(3, -1)
        view = out[0, : self._corners].reshape(3, -1)
        np.negative(cone, out=view)
        view[0] *= self.slope
        return out

    def compliance(self, scalings: Sequence[Scaling]) -> CellCompliance:  # pyright: ignore[reportIncompatibleMethodOverride]
        """Return the compliances, those of the corners in closed form."""
        corners = super().compliance(scalings)
        stiffness = None if self._energy is None else self._energy.stiffness
        return CellCompliance(corners, stiffness, self._elimination.factor(corners))

    def balanced(self, force: FloatArray, rough: Callable[[], FloatArray]) -> FloatArray:
        """Return the multipliers of the corners, which follow from the force."""
        return super().balanced(self._at_corners(force), rough)

    def interior(self, size: FloatArray) -> FloatArray:
        """Return compression of this size; in an elastic step the start, compressed, or compression of one, and its stresses."""
        if self._start is not None:
            force = self._start.reshape(3, -1).copy()
            force[0] += SOLVER.start_margin
        else:
            force = np.zeros((3, self._corners // 3))
            force[0] = size[: force.shape[1]] if self._energy is None else 1.0
        if self._energy is None:
            return force.reshape(1, -1)
        stress, _ = self._law.forces.add_up(force)
        return np.concatenate([force.ravel(), stress.ravel()])[None]

    def _at_corners(self, x: FloatArray) -> FloatArray:
        return x[0, : self._corners].reshape(3, -1)


class CellCholesky(Cholesky):
    """The linear system of shell, joints and stones: the cells' own unknowns eliminated, the shell's by sparse Cholesky."""

    def __init__(self, shell: Cholesky, coupling: CellCoupling, elimination: CellElimination) -> None:  # pyright: ignore[reportMissingSuperCall]
        self._shell, self._coupling, self._elimination = shell, coupling, elimination

    def factor(self, values: FloatArray) -> None:
        """Factorise the part of the shell; the cells' parts were factorised with their compliances."""
        self._shell.factor(values)

    def solve(self, right: FloatArray) -> FloatArray:
        """Return N^-1 right, right (rows,) or (rows, k)."""
        columns = [np.ascontiguousarray(column) for column in right.reshape(len(right), -1).T]
        reduced, shells = [], []
        for column in columns:
            shell, joints, still = self._coupling.split(column)
            part = self._elimination.reduce(joints.reshape(6, -1), still)
            reduced.append(part)
            shells.append(shell + self._coupling.equilibrate(part.stress))
        solved = self._shell.solve(np.stack(shells, axis=1))
        out = np.empty((right.shape[0], len(columns)))
        for k, part in enumerate(reduced):
            motion = np.ascontiguousarray(solved[:, k])
            joints, still = self._elimination.recover(part, self._coupling.strain(motion))
            out[:, k] = np.concatenate([motion, joints.ravel(), still])
        return out.reshape(right.shape)
