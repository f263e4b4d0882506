"""A shell as local problems in the stresses of its points, which are coupled by the equilibrium of its unknowns.

This is the form that the interior-point solver takes. Eliminating the stresses leaves one positive definite matrix with the
pattern of the stiffness matrix, K = sum B^T (Q + G^T D G)^-1 B over the points: B the strain of the unknowns, Q the elastic
compliance, G the rows of the strength and D their weights at the current iterate. Its symbolic analysis is done once, for the
dead load, the limit load and every step of a capacity curve.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp

from churchpipe.conic.cholesky import Cholesky
from churchpipe.conic.interior_point.cones import cone_shape
from churchpipe.conic.interior_point.coupling import Coupling, touches
from churchpipe.conic.interior_point.iterate import Iterate
from churchpipe.conic.interior_point.local import LocalProblems
from churchpipe.conic.interior_point.loop import interior_start, solve_coupled
from churchpipe.conic.interior_point.nonnegative import Nonnegative
from churchpipe.conic.interior_point.normal import NormalMatrix
from churchpipe.conic.interior_point.problem import CoupledProblem
from churchpipe.conic.interior_point.settings import Settings
from churchpipe.conic.program import Outcome
from churchpipe.homogenised_shell.cells import CORNERS, CellCoupling, CellPoints
from churchpipe.homogenised_shell.direct import solve_directly
from churchpipe.homogenised_shell.element import ShellElements
from churchpipe.homogenised_shell.flow import plastic_flow
from churchpipe.homogenised_shell.planes import PlanePoints
from churchpipe.homogenised_shell.points import local_strength
from churchpipe.homogenised_shell.program import load_vectors
from churchpipe.homogenised_shell.settings import SOLVER, STEP
from churchpipe.homogenised_shell.strength import PlaneSet
from churchpipe.model.arrays import FloatArray
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import JointStrength


@dataclass(frozen=True, slots=True)
class StressState:
    """Stresses in equilibrium and the motion that goes with them, in the units of `CondensedShell`.

    x (d, nq) local variables; stress (6, nq); load: of the part that grows; motion (n,): unknowns of the elements, work-conjugate
    to loads over the weight; multipliers (rows, nq) of the strength: their flow is the plastic strain of that motion except for
    `unexplained` (d, nq), conjugate to x, which is rounding; strain (6, nq): conjugate to stress. residual of equilibrium over
    the weight; violation of the strength over the unit of stress; gap: the loop's error, relative to the objective.
    """

    x: FloatArray
    stress: FloatArray
    load: float
    motion: FloatArray
    multipliers: FloatArray
    unexplained: FloatArray
    strain: FloatArray
    residual: float
    violation: float
    gap: float
    iterations: int
    status: Outcome
    message: str

    @property
    def holds(self) -> bool:
        """True when solved and proved by its own arrays; the status "almost solved" is not enough."""
        return self.status == "solved" and max(self.residual, self.violation, self.gap) <= SOLVER.duality_gap


@dataclass(frozen=True, slots=True)
class _System:
    """Equilibrium of all points, its normal matrix and the symbolic analysis of that."""

    coupling: Coupling
    normal: NormalMatrix
    cholesky: Cholesky


class CondensedShell:
    """A shell, its loads and its strength for the interior-point core, with one symbolic analysis.

    Units inside: forces over `weight`, N; stresses over `unit` (nq, 6), N/m and N; lengths m.
    """

    def __init__(self, elements: ShellElements, load: LoadCase, materials: Sequence[JointStrength], planes: PlaneSet) -> None:
        """Raise InputError as `program.load_vectors` and `strength.strength`."""
        self.elements = elements
        self.loads = load_vectors(elements, load)
        self.strength = local_strength(elements, materials, planes, self.loads.unit)
        self._strain = sp.csr_matrix(self.loads.equilibrium.T)
        self._planes = isinstance(self.strength.cones[0], Nonnegative)
        self._system = self._structure()

    def solve(
        self,
        dead: FloatArray | None,
        live: FloatArray | None,
        *,
        compliance: FloatArray | None = None,
        origin: FloatArray | None = None,
        reward: float = 1.0,
        cap: float = np.inf,
        settings: Settings | None = None,
    ) -> StressState:
        """Return the stresses x with the largest  reward load - 1/2 sum (x - origin) Q (x - origin),  Q = of^T compliance of.

        Parameters
        ----------
        dead, live: loads (m,) over the weight, the second multiplied by the load (at most `cap`); None for nothing.
        compliance_abq: (6, 6, nq), none for limit analysis. origin: local variables (d, nq), zero by default.
        """
        if settings is None:
            settings = STEP if self._planes else replace(STEP, correctors=SOLVER.correctors)
        iterations, start = 0, None
        for more in self._regularisations(compliance):
            problem = self._problem(dead, live, compliance, origin, reward, cap, more)
            begin = start or interior_start(problem, settings)
            ending = solve_coupled(problem, self._system.normal, self._system.cholesky, begin, settings)
            iterations += ending.info.iteration
            if ending.status not in ("running", "failed"):
                break
            # The next, smaller regularisation may be too small to get this far from its own start.
            start = ending.at if ending.info.error <= SOLVER.near else None
        outcome = "failed" if ending.status == "running" else ending.status
        # A certificate of infeasibility is a mechanism. It is scaled by its largest entry.
        theta = ending.at.theta if outcome != "infeasible" else float(np.abs(ending.at.y).max())
        return self._state(problem, ending.at, theta, outcome, ending.info.error, iterations, ending.message)

    def solve_directly(self, dead: FloatArray | None, live: FloatArray | None, cap: float = np.inf) -> StressState:
        """Return the stresses with the largest load by Clarabel."""
        problem = self._problem(dead, live, None, None, 1.0, cap, np.zeros(len(self.elements.facet)))
        law = self.strength
        _, d, nq = law.matrix.shape
        rows = np.moveaxis(law.matrix, 2, 0)
        i, j = np.arange(rows.shape[1]), np.arange(d)
        place = np.arange(nq)
        row = np.broadcast_to(place[:, None, None] + nq * i[:, None], rows.shape).ravel()
        column = np.broadcast_to(place[:, None, None] + nq * j, rows.shape).ravel()
        matrix = sp.csr_matrix((rows.ravel(), (row, column)), shape=(len(i) * nq, d * nq))
        matrix.eliminate_zeros()
        at, outcome, iterations, message = solve_directly(problem, matrix)
        return self._state(problem, at, 1.0, outcome, np.nan, iterations, message)

    def _regularisations(self, compliance: FloatArray | None) -> list[FloatArray]:
        """Return compliances (nq,) to add to the steps, each to be tried where the one before fails."""
        count = len(self.elements.facet)
        if compliance is not None or not self._planes:
            return [np.zeros(count)]
        by_area = SOLVER.by_area * self.elements.weight / self.elements.weight.sum()
        return [by_area, np.full(count, SOLVER.by_point), np.full(count, SOLVER.by_point_last)]

    def _problem(
        self,
        dead: FloatArray | None,
        live: FloatArray | None,
        compliance: FloatArray | None,
        origin: FloatArray | None,
        reward: float,
        cap: float,
        regularisation: FloatArray,
    ) -> CoupledProblem:
        law = self.strength
        d, nq = law.inner.shape
        root = None
        if compliance is not None:
            root = np.einsum("qba,biq->aiq", np.linalg.cholesky(np.moveaxis(compliance, 2, 0)), law.of)
        linear = np.zeros((d, nq))
        if root is not None and origin is not None:
            linear = -np.einsum("aiq,aq->iq", root, np.einsum("aiq,iq->aq", root, origin))
        if self._planes:
            quadratic = np.zeros((d, d, nq)) if compliance is None else compliance
            local: LocalProblems = PlanePoints(quadratic, linear, law.matrix, law.right, law.inner, regularisation)
        else:
            friction = -np.einsum("rrq->rq", law.matrix)[:CORNERS].ravel()
            local = CellPoints(friction, np.concatenate([law.of, law.still]), root, linear, law.inner)
        coupling = self._system.coupling
        rows = coupling.rows
        nothing = np.zeros(self.loads.equilibrium.shape[0])
        dead, live = (nothing if part is None else part for part in (dead, live))
        shift = self.loads.equilibrium @ law.offset.T.ravel()
        return CoupledProblem(
            local,
            coupling,
            _padded(shift - dead, rows),
            _padded(-live, rows),
            reward=reward,
            cap=cap,
        )

    def _structure(self) -> "_System":
        law = self.strength
        if self._planes:
            coupling = Coupling(touches(sp.csc_matrix(self.loads.equilibrium), 6, 1, by_point=True))
        else:
            coupling = CellCoupling(self.loads.equilibrium, np.concatenate([law.of, law.still]))
        normal = NormalMatrix(coupling)
        return _System(coupling, normal, Cholesky(normal.pattern, 1))

    def _state(
        self,
        problem: CoupledProblem,
        at: Iterate,
        theta: float,
        outcome: Outcome,
        gap: float,
        iterations: int,
        message: str,
    ) -> StressState:
        law = self.strength
        x, load = (at.x / theta).reshape(law.inner.shape), at.load / theta
        stress = law.offset + np.einsum("aiq,iq->aq", law.of, x)
        balance = (problem.couple(at.x) + at.load * problem.growth) / theta + problem.constant
        slack = law.right - np.einsum("riq,iq->rq", law.matrix, x)
        free = ~self.elements.clamped
        motion = np.zeros(self.elements.unknowns)
        # The solver's own multipliers z carry the rounding of z over the slacks s, which grows without bound towards the
        # solution.
        elastic = problem.local.quadratic(problem.local_view(at.x)) + problem.local.linear * at.theta
        plastic = -(problem.local_view(problem.spread(at.y)) + elastic).reshape(law.inner.shape) / theta
        multipliers, unexplained = plastic_flow(law, plastic, (at.z[: slack.size] / theta).reshape(slack.shape))
        motion[free] = -at.y[: int(free.sum())] / theta
        return StressState(
            x=x,
            stress=stress,
            load=load,
            motion=motion,
            multipliers=multipliers,
            unexplained=unexplained,
            strain=np.asarray(self._strain @ motion[free]).reshape(-1, 6).T,
            residual=float(np.abs(balance).max(initial=0.0)),
            violation=max(0.0, -min(cone.margin(slack.reshape(cone_shape(cone))) for cone in law.cones)),
            gap=gap,
            iterations=iterations,
            status=outcome,
            message=message,
        )


def _padded(v: FloatArray, size: int) -> FloatArray:
    return np.concatenate([v, np.zeros(size - len(v))])
