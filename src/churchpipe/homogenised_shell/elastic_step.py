"""One step of a capacity curve with the exact cell, by an interior-point method of its own.

It begins at stresses t_n that have an equilibrium to go to, so that nothing has to be decided, as in `conic.interior_point`,
but only found:

    minimise  1/2 (t - t_n) C (t - t_n) - reward load    s.t.  H t = f_D + load f_L,  t = S x,  T x = total,  F x in K,

and with ties as `step_ties` says.

Stresses t count from the offset of the strength; x are the forces at the corners of the cells, S and T their sums, K the cones.
Multipliers: the motion u of the shell, the strains e of the joints, the motions m of the stones, z of the cones. Throughout
t = t_n + C^-1 (H^T u + e), and F z = S^T e + T^T m but for a share of what was missing at the start. An iteration eliminates x,
z, e and m point by point (`cell_elimination`), predicts, and corrects (Mehrotra 1992; Gondzio 1996). The load and the tensions
are eliminated last: they border the matrix of the motion with a few columns.
"""

from dataclasses import dataclass

import numpy as np

from churchpipe.conic.cholesky import Cholesky, NotDefiniteError
from churchpipe.conic.interior_point.coulomb import CoulombCompliance
from churchpipe.conic.interior_point.normal import NormalMatrix
from churchpipe.homogenised_shell.cell_elimination import CellElimination
from churchpipe.homogenised_shell.cell_passes import answer_cells, push_cells
from churchpipe.homogenised_shell.cells import CellCoupling
from churchpipe.homogenised_shell.corner_cones import CornerCones
from churchpipe.homogenised_shell.energy import Energy
from churchpipe.homogenised_shell.points import CellStrength
from churchpipe.homogenised_shell.settings import SOLVER
from churchpipe.homogenised_shell.step_ties import StepTies, TieIterate, TieWay
from churchpipe.model.arrays import FloatArray

# A step goes this share of the way to the boundary of the first cone; three in succession that are shorter than `_SHORT` end it.
_FRACTION = 0.99
_SHORT = 1e-3
# Most centring of a step; a corrector aims at a step longer by `_REACH`, and at this share of the mean product at the least.
_MOST_CENTRING = 0.03
_REACH = 0.5
_TARGET = 0.3
_WIN = 0.01
# Added to the diagonal, relative to it.
_REGULARISATION = 1e-14
# So many corrections of the balance at the end, with the last factor.
_SWEEPS = 2


@dataclass(frozen=True, slots=True)
class ElasticStep:
    """The program of a step: its strength, equilibrium H with the solvers of its linear systems, energy and loads (m,).

    before (6, nq): t_n. reward: of the load; without live forces the load stays 1, and the reward is the unit of the objective.
    product: of each bound of a tie at the start.
    """

    law: CellStrength
    coupling: CellCoupling
    normal: NormalMatrix
    cholesky: Cholesky
    elimination: CellElimination
    energy: Energy
    before: FloatArray
    dead: FloatArray
    live: FloatArray
    reward: float
    ties: StepTies
    product: float


@dataclass(frozen=True, slots=True)
class StepSolution:
    """Corner forces x and multipliers z (3, corners), load, tensions (nt,), motion (m,), and the error over the objective."""

    x: FloatArray
    z: FloatArray
    load: float
    tension: FloatArray
    motion: FloatArray
    error: float
    iterations: int


@dataclass(frozen=True, slots=True)
class _Way:
    """A direction: of the motion, -du, the load, the tensions (nt,), the strains e of the joints, the motions m of the stones."""

    motion: FloatArray
    load: float
    tension: FloatArray
    strain: FloatArray
    stones: FloatArray


def solve_step(step: ElasticStep, x: FloatArray, z: FloatArray) -> StepSolution | None:
    """Return the solution of a step from forces and multipliers inside their cones, or None where the way there is lost."""
    run = _Run(step, CornerCones(x, z, step.law.friction))
    short = 0
    for iteration in range(SOLVER.step_iterations + 1):
        error = run.measure()
        if error <= SOLVER.step_gap and run.residual <= SOLVER.step_residual:
            return run.solution(error, iteration) if iteration else None
        if not np.isfinite(error) or short >= 3:
            return None
        try:
            with np.errstate(all="ignore"):
                length = run.advance()
        except NotDefiniteError:
            return None
        short = short + 1 if length < _SHORT else 0
    return None


class _Run:
    """The iterate of a step, its residuals and the factor of the last linear system."""

    def __init__(self, step: ElasticStep, cones: CornerCones) -> None:
        self._step, self._cones = step, cones
        law = step.law
        self._motion, self._load = np.zeros(len(step.dead)), 1.0
        self._strain, self._stones = np.zeros_like(step.before), np.zeros(law.forces.rows)
        self._stress, self._deformation = step.before, np.zeros_like(step.before)
        self._lack = -cones.z * np.stack([law.friction, np.ones_like(law.friction), np.ones_like(law.friction)])
        # The share of what was missing at the start, `lack`, that still is.
        self._left = 1.0
        self._nothing = np.zeros_like(cones.x)
        self._ties = TieIterate(step.ties, step.product)
        self._products = -float(np.vdot(self._lack, cones.x)) + self._ties.products
        self._moves = bool(step.live.any())
        if self._moves:
            left = step.coupling.equilibrate(step.before) - step.dead - self._ties.tension @ step.ties.pull
            self._load = float(step.live @ left) / float(step.live @ step.live)
        self._compliance: CoulombCompliance | None = None
        # What borders the matrix of the motion: the load that grows and the tensions, forces of one unit of each (k, m).
        self._border: FloatArray = np.vstack([*([step.live] if self._moves else []), step.ties.pull])
        # Motions (k, m) under these, by the last factor; None until they are needed.
        self._levers: FloatArray | None = None

    def measure(self) -> float:
        """Find the residuals, and return the gap and the work of the residuals over the objective."""
        step, forces = self._step, self._step.law.forces
        stress, still = forces.add_up(self._cones.x)
        self._joints, self._unbalanced = stress - self._stress, still - step.law.total
        self._rows = self._balance()
        self._misfit = self._ties.misfit(self._motion)
        self._short = step.reward - float(step.live @ self._motion) if self._moves else 0.0
        self.residual = float(np.abs(self._rows).max(initial=0.0))
        energy = 0.5 * float(np.vdot(self._stress - step.before, self._deformation))
        work = abs(float((self._joints * self._strain).sum())) + abs(float(self._unbalanced @ self._stones))
        work += abs(float(self._rows @ self._motion)) + abs(self._short * self._load)
        work += abs(self._left * float(np.vdot(self._lack, self._cones.x)))
        work += float(np.abs(self._misfit) @ self._ties.tension)
        # Relative to the objective, or to a thousandth of its unit if that is larger.
        return (self._products + work) / max(abs(step.reward * self._load - energy), 1e-3 * step.reward)

    def advance(self) -> float:
        """Go one step and return its length.

        Raises
        ------
        NotDefiniteError: the matrix has lost its definiteness.
        """
        step, cones = self._step, self._cones
        self._factor()
        ties = self._ties
        mean = self._products / (cones.x.shape[1] + 2 * len(ties))
        _, tied, rate = self._try(self._nothing, np.zeros((2, len(ties))))
        cones.keep()
        target = min((1.0 - min(1.0, 1.0 / max(rate, 1e-300))) ** 3, _MOST_CENTRING) * mean
        aim, aim_ties = cones.second_order(target), ties.second_order(tied, target)
        way, tied, rate = self._try(aim, aim_ties)
        cones.keep()
        for _ in range(SOLVER.correctors):
            if rate <= _FRACTION:
                break
            other = cones.recentred(aim, min(1.0, 1.0 / rate + _REACH), max(target, _TARGET * mean))
            corrected, tied_so, better = self._try(other, aim_ties)
            if 1.0 / better < 1.0 / rate + _WIN * _REACH:
                break
            cones.keep()
            rate, way, tied, aim = better, corrected, tied_so, other
        length = min(1.0, _FRACTION / max(rate, 1e-300))
        self._products = cones.move(length)
        ties.move(tied, length)
        self._products += ties.products
        self._motion = self._motion - length * way.motion
        self._load += length * way.load
        self._strain, self._stones = self._strain + length * way.strain, self._stones + length * way.stones
        self._left *= 1.0 - length
        self._deformation = step.coupling.strain(self._motion) + self._strain
        self._stress = step.before + self._elastic(self._deformation)
        return length

    def solution(self, error: float, iterations: int) -> StepSolution:
        """Return the iterate, the last digits of its balance put right by the smallest correction in the metric of the cones."""
        step, forces = self._step, self._step.law.forces
        assert self._compliance is not None
        x = self._cones.x
        for _ in range(_SWEEPS):
            stress, still = forces.add_up(x)
            rows = self._balance()
            way = self._solved(rows, stress - self._stress, still - step.law.total, 0.0, np.zeros(len(self._ties)))
            x = x - self._compliance.apply(forces.spread(way.strain, way.stones))
            self._load += way.load
            self._ties.tension = self._ties.tension + way.tension
            self._stress = self._stress + self._elastic(way.strain - step.coupling.strain(way.motion))
        return StepSolution(x, self._cones.z, self._load, self._ties.tension, self._motion, error, iterations)

    def _factor(self) -> None:
        step = self._step
        self._compliance = self._cones.compliance()
        values = step.normal.assemble(step.elimination.factor(self._compliance))
        values[step.normal.diagonal] *= 1.0 + _REGULARISATION
        step.cholesky.factor(values)
        self._levers = None

    def _balance(self) -> FloatArray:
        """Return what of equilibrium (m,) is left."""
        step = self._step
        borne = step.dead + self._load * step.live + self._ties.tension @ step.ties.pull
        return step.coupling.equilibrate(self._stress) - borne

    def _try(self, aim: FloatArray, aim_ties: FloatArray) -> tuple[_Way, TieWay, float]:
        """Return the direction whose products aim there, its part of the ties, and the rate at which the first bound is met."""
        law = self._step.law
        stress, still = push_cells(self._cones, law.forces, aim, self._lack, self._left)
        misfit = self._ties.aimed(self._misfit, aim_ties)
        way = self._solved(self._rows, stress - self._stress, still - law.total, self._short, misfit)
        rate = answer_cells(self._cones, law.forces, aim, self._lack, self._left, way.strain, way.stones)
        tied, rate_ties = self._ties.answer(way.tension, aim_ties)
        return way, tied, max(rate, rate_ties)

    def _solved(self, rows: FloatArray, joints: FloatArray, stones: FloatArray, short: float, misfit: FloatArray) -> _Way:
        step = self._step
        reduced = step.elimination.reduce(joints, stones)
        right = rows + step.coupling.equilibrate(reduced.stress)
        grown: FloatArray = np.zeros(len(self._border))
        if len(grown) and self._levers is None:
            # All at once take less time than one after the other.
            motion, *levers = np.ascontiguousarray(step.cholesky.solve(np.column_stack([right, *self._border])).T)
            self._levers = np.array(levers)
        else:
            motion = step.cholesky.solve(right)
        if self._levers is not None:
            first = [short] if self._moves else []
            soft = np.concatenate([np.zeros(len(first)), self._ties.softness])
            wanted = self._border @ motion + np.concatenate([first, -misfit])
            grown = np.asarray(np.linalg.solve(self._border @ self._levers.T + np.diag(soft), wanted), dtype=np.float64)
            motion = motion - grown @ self._levers
        strain, moved = step.elimination.recover(reduced, step.coupling.strain(motion))
        split = int(self._moves)
        return _Way(motion, float(grown[:split].sum()), grown[split:], strain, moved)

    def _elastic(self, strain: FloatArray) -> FloatArray:
        return np.einsum("abq,bq->aq", self._step.energy.stiffness, strain)
