"""A shell as local problems in the stresses of its points, which are coupled by the equilibrium of its unknowns.

This is the form that the interior-point solver takes. Eliminating the stresses leaves one positive definite matrix with the
pattern of the stiffness matrix, K = sum B^T D B over the points: B the strain of the unknowns, and D the stress for a strain at
the current iterate. For planes D = (C + G^T W^-2 G)^-1, with C the elastic compliance, G the planes and W their scaling; for the
exact cell see `cell_elimination`. The symbolic analysis is done once, for dead load, limit load and every step of a curve.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
import scipy.sparse as sp

from churchpipe.conic.cholesky import Cholesky
from churchpipe.conic.interior_point.coupling import Coupling, touches
from churchpipe.conic.interior_point.info import as_share
from churchpipe.conic.interior_point.iterate import Iterate
from churchpipe.conic.interior_point.loop import Ending, interior_start, solve_coupled
from churchpipe.conic.interior_point.normal import NormalMatrix
from churchpipe.conic.interior_point.problem import CoupledProblem
from churchpipe.conic.program import Outcome
from churchpipe.homogenised_shell.cell_elimination import CellElimination
from churchpipe.homogenised_shell.cells import CellCholesky, CellCoupling, CellPoints
from churchpipe.homogenised_shell.corner_cones import central_pair
from churchpipe.homogenised_shell.direct import solve_directly
from churchpipe.homogenised_shell.elastic_step import ElasticStep, solve_step
from churchpipe.homogenised_shell.element import ShellElements
from churchpipe.homogenised_shell.energy import Energy, elastic_energy
from churchpipe.homogenised_shell.loads import load_vectors
from churchpipe.homogenised_shell.planes import plane_points
from churchpipe.homogenised_shell.points import CellStrength, PlaneStrength, local_strength
from churchpipe.homogenised_shell.settings import FIRST_STEP, LIMIT, SOLVER, STARTED_LOW, STEP
from churchpipe.homogenised_shell.step_ties import StepTies
from churchpipe.model.arrays import FloatArray
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import JointStrength
from churchpipe.model.names import Planes as PlaneSet


@dataclass(frozen=True, slots=True)
class StressState:
    """Stresses in equilibrium and the motion that goes with them, in the units of `CondensedShell`.

    x: variables of the strength, flat; stress (6, nq); load: of the part that grows; motion (n,): unknowns of the elements,
    work-conjugate to loads over the weight; multipliers of the strength, flat: their flow is the plastic strain of that motion
    except for `unexplained`, conjugate to x, which is rounding; strain (6, nq): conjugate to stress. residual of equilibrium over
    the weight; violation of the strength over the unit of stress; gap: the loop's error, relative to the objective. reward: of
    the load, 0 where none was pushed. tension (nt,): of ties that were part of the program, over the weight; None: none were.
    """

    x: FloatArray
    stress: FloatArray
    load: float
    motion: FloatArray
    multipliers: FloatArray
    unexplained: FloatArray
    strain: FloatArray
    residual: float
    lack: float
    violation: float
    gap: float
    iterations: int
    status: Outcome
    message: str
    reward: float
    tension: FloatArray | None = None

    @property
    def balanced(self) -> bool:
        """True when solved, in balance and within the strength by its own arrays; the status "almost solved" is not enough."""
        return self.status == "solved" and max(self.residual, self.violation) <= SOLVER.duality_gap

    @property
    def holds(self) -> bool:
        """True when balanced, and proved to be the best."""
        return self.balanced and self.gap <= SOLVER.duality_gap


@dataclass(frozen=True, slots=True)
class _Statement:
    """A problem and the solver of its linear systems."""

    problem: CoupledProblem
    cholesky: Cholesky


class CondensedShell:
    """A shell, its loads and its strength for the interior-point core, with one symbolic analysis.

    Units inside: forces over `weight`, N; stresses over `unit` (nq, 6), N/m and N; lengths m.
    """

    def __init__(self, elements: ShellElements, load: LoadCase, materials: Sequence[JointStrength], planes: PlaneSet) -> None:
        """Raise InputError as `loads.load_vectors` and `point_strength.point_strength`."""
        self.elements = elements
        self.loads = load_vectors(elements, load)
        self.strength = local_strength(elements, materials, planes, self.loads.unit)
        self._strain = sp.csr_matrix(self.loads.equilibrium.T)
        self._touches = touches(sp.csc_matrix(self.loads.equilibrium), 6, 1, by_point=True)
        self._coupling = Coupling(self._touches)
        self._normal = NormalMatrix(self._coupling)
        self._cholesky = Cholesky(self._normal.pattern, 1)
        self._energy: Energy | None = None
        law = self.strength
        self._elastic = CellCoupling(self._touches, law.forces, elastic=True) if isinstance(law, CellStrength) else None

    def solve(
        self,
        dead: FloatArray | None,
        live: FloatArray | None,
        *,
        compliance: FloatArray | None = None,
        before: StressState | None = None,
        reward: float = 1.0,
        cap: float = np.inf,
        progress: Callable[[float], None] | None = None,
    ) -> StressState:
        """Return the stresses with the largest  reward load - 1/2 sum (stress - origin) C (stress - origin).

        Parameters
        ----------
        dead, live: loads (m,) over the weight, the second multiplied by the load (at most `cap`); None for nothing.
        compliance_abq: C (6, 6, nq), none for limit analysis. before: the state whose stresses are the origin; none, zero.
        progress: called with the share done.
        """
        by_cell = isinstance(self.strength, CellStrength)
        if compliance is not None:
            quick = self.elastic_step(dead, live, compliance, before, reward)
            if quick is not None:
                return quick
        if compliance is None:
            # Some models whose points start with much work get no further, and get there with little.
            tried = (LIMIT, STARTED_LOW)
        else:
            chosen = FIRST_STEP if before is None else STEP
            tried = (replace(chosen, correctors=SOLVER.correctors) if by_cell else chosen,)
        iterations, start = 0, None
        nearest: tuple[CoupledProblem, Ending] | None = None
        report = as_share(progress, tried[0].duality_gap, tried[0].residual)
        for chosen, more in product(tried, self._regularisations(compliance)):
            # At the start all points together do `rate` times the work of a unit load, whatever their number.
            settings = replace(chosen, rate=chosen.rate / (chosen.force * len(self.elements.facet)))
            stated = self._statement(dead, live, compliance, before, reward, cap, more)
            begin = start or interior_start(stated.problem, settings)
            ending = solve_coupled(stated.problem, self._normal, stated.cholesky, begin, settings, report)
            iterations += ending.info.iteration
            done = ending.status not in ("running", "failed")
            if done or nearest is None or ending.info.error < nearest[1].info.error:
                nearest = stated.problem, ending
            if done:
                break
            # The next, smaller regularisation may be too small to get this far from its own start.
            start = ending.at if ending.info.error <= SOLVER.near and not by_cell else None
        assert nearest is not None
        problem, ending = nearest
        outcome = "failed" if ending.status == "running" else ending.status
        # A certificate of infeasibility is a mechanism. It is scaled by its largest entry.
        theta = ending.at.theta if outcome != "infeasible" else float(np.abs(ending.at.y).max())
        return self._state(problem, ending.at, theta, outcome, ending.info.error, iterations, ending.message)

    def elastic_step(
        self,
        dead: FloatArray | None,
        live: FloatArray | None,
        compliance: FloatArray,
        before: StressState | None,
        reward: float,
        ties: StepTies | None = None,
    ) -> StressState | None:
        """Return the state of an elastic step with the exact cell, or None where it needs the method that decides.

        ties: bars whose tensions are found with it.
        """
        law, coupling = self.strength, self._elastic
        if not isinstance(law, CellStrength) or coupling is None:
            return None
        nothing = np.zeros(self.loads.equilibrium.shape[0])
        dead, live = (nothing if part is None else part for part in (dead, live))
        pushed = reward if live.any() else 0.0
        x, z = np.zeros((3, law.forces.count)), np.zeros((3, law.forces.count))
        # Far from the apex of a strength that bears tension, about as far as no stress is.
        x[0] = 1.0 + law.forces.of_each_corner(np.abs(law.offset).max(axis=0))
        if before is not None:
            x = before.x.reshape(3, -1)
            if before.reward:
                z = before.multipliers.reshape(3, -1) * (reward / before.reward)
        work = reward * max(SOLVER.step_work / x.shape[1], SOLVER.step_corner_work)
        energy = elastic_energy(compliance, (0.0 if before is None else before.stress) - law.offset, self._energy)
        self._energy = energy
        step = ElasticStep(
            law=law,
            coupling=coupling,
            normal=self._normal,
            cholesky=self._cholesky,
            elimination=CellElimination(law.forces, energy.root),
            energy=energy,
            before=np.broadcast_to((0.0 if before is None else before.stress) - law.offset, law.offset.shape),
            dead=dead - coupling.equilibrate(law.offset),
            live=live,
            reward=reward,
            ties=StepTies.none(len(nothing)) if ties is None else ties,
            product=work,
        )
        found = solve_step(step, *central_pair(x, z, law.friction, SOLVER.step_margin, work))
        if found is None:
            return None
        at = found.x.ravel()
        stress, still = law.stress(at), law.forces.add_up(found.x)[1] - law.total
        balance = coupling.equilibrate(stress) - dead - found.load * live - found.tension @ step.ties.pull
        motion = np.zeros(self.elements.unknowns)
        motion[~self.elements.clamped] = found.motion
        return StressState(
            x=at,
            stress=stress,
            load=found.load,
            motion=motion,
            multipliers=found.z.ravel(),
            unexplained=np.zeros_like(at),
            strain=coupling.strain(found.motion),
            residual=float(max(np.abs(balance).max(initial=0.0), np.abs(still).max(initial=0.0))),
            lack=abs(float(balance @ found.motion)),
            violation=law.violation(at),
            gap=found.error,
            iterations=found.iterations,
            status="solved",
            message="",
            reward=pushed,
            tension=None if ties is None else found.tension,
        )

    def solve_directly(self, dead: FloatArray | None, live: FloatArray | None, cap: float = np.inf) -> StressState:
        """Return the stresses with the largest load by Clarabel."""
        problem = self._statement(dead, live, None, None, 1.0, cap, np.zeros(len(self.elements.facet))).problem
        at, outcome, iterations, message = solve_directly(problem, self.strength.rows())
        return self._state(problem, at, 1.0, outcome, np.nan, iterations, message)

    def _regularisations(self, compliance: FloatArray | None) -> list[FloatArray]:
        """Return compliances (nq,) to add to the steps, each to be tried where the one before fails."""
        count = len(self.elements.facet)
        if compliance is not None or isinstance(self.strength, CellStrength):
            return [np.zeros(count)]
        by_area = SOLVER.by_area * self.elements.weight / self.elements.weight.sum()
        return [by_area, np.full(count, SOLVER.by_point), np.full(count, SOLVER.by_point_last)]

    def _statement(
        self,
        dead: FloatArray | None,
        live: FloatArray | None,
        compliance: FloatArray | None,
        before: StressState | None,
        reward: float,
        cap: float,
        regularisation: FloatArray,
    ) -> _Statement:
        law = self.strength
        # Energy counts from the origin, and the variables of the solver from the offset.
        origin, start = (0.0, None) if before is None else (before.stress, before.x)
        energy = None if compliance is None else elastic_energy(compliance, origin - law.offset)
        if isinstance(law, PlaneStrength):
            local, cholesky = plane_points(law, energy, regularisation, start), self._cholesky
            coupling = self._coupling
        else:
            elimination = CellElimination(law.forces, None if energy is None else energy.root)
            coupling = CellCoupling(self._touches, law.forces, elastic=energy is not None)
            local, cholesky = CellPoints(law, elimination, energy, start), CellCholesky(self._cholesky, coupling, elimination)
        nothing = np.zeros(self.loads.equilibrium.shape[0])
        dead, live = (nothing if part is None else part for part in (dead, live))
        shift = self.loads.equilibrium @ law.offset.T.ravel()
        constant, growth = _padded(shift - dead, coupling.rows), _padded(-live, coupling.rows)
        if isinstance(law, CellStrength):
            constant[len(constant) - law.forces.rows :] -= law.total
        return _Statement(CoupledProblem(local, coupling, constant, growth, reward=reward, cap=cap), cholesky)

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
        # The stresses of an elastic step stand behind the variables of the strength.
        own = slice(0, law.variables)
        x, load = at.x[own] / theta, at.load / theta
        balance = (problem.couple(at.x) + at.load * problem.growth) / theta + problem.constant
        free = ~self.elements.clamped
        motion = np.zeros(self.elements.unknowns)
        # The solver's own multipliers z carry the rounding of z over the slacks s, which grows without bound towards the
        # solution.
        elastic = problem.quadratic(at.x) + problem.linear * at.theta
        plastic = -(problem.spread(at.y) + elastic)[own] / theta
        multipliers, unexplained = law.flow(plastic, at.z[: law.multipliers] / theta)
        motion[free] = -at.y[: int(free.sum())] / theta
        return StressState(
            x=x,
            stress=law.stress(x),
            load=load,
            motion=motion,
            multipliers=multipliers,
            unexplained=unexplained,
            strain=np.asarray(self._strain @ motion[free]).reshape(-1, 6).T,
            residual=float(np.abs(balance).max(initial=0.0)),
            lack=abs(float(balance @ at.y)) / theta,
            violation=law.violation(x),
            gap=gap,
            iterations=iterations,
            status=outcome,
            message=message,
            reward=problem.reward if problem.growth.any() else 0.0,
        )


def _padded(v: FloatArray, size: int) -> FloatArray:
    return np.concatenate([v, np.zeros(size - len(v))])
