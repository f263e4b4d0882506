"""Cone programs on the interior-point loop: scaling of units, one symbolic analysis for all programs of a balance."""

from dataclasses import replace
from time import perf_counter, process_time

import numpy as np

from churchpipe.conic.cholesky import Cholesky
from churchpipe.conic.interior_point.coulomb import CoulombPoints
from churchpipe.conic.interior_point.coupling import Coupling, touches
from churchpipe.conic.interior_point.info import Progress
from churchpipe.conic.interior_point.iterate import Iterate
from churchpipe.conic.interior_point.loop import Ending, interior_start, solve_coupled
from churchpipe.conic.interior_point.normal import NormalMatrix
from churchpipe.conic.interior_point.problem import CoupledProblem
from churchpipe.conic.interior_point.settings import CLOSE, FAR, NEARLY, WARM_ITERATIONS, Settings
from churchpipe.conic.interior_point.warm import warm_start
from churchpipe.conic.interior_point.wrenches import WrenchCoupling
from churchpipe.conic.program import ConeProgram, ConeSolution, WarmStart
from churchpipe.conic.wrenches import BODY, Balance, Wrenches, as_matrix
from churchpipe.errors import InputError
from churchpipe.model.arrays import FloatArray

# A limit or a bound below this share of the largest load is none at all: it leaves no interior in double precision.
_NOTHING = 1e-13


def solve_interior_point(
    program: ConeProgram, settings: Settings | None = None, progress: Progress | None = None
) -> ConeSolution:
    """Solve one cone program; `InteriorPointSolver` solves several that share a balance."""
    begin = perf_counter()
    answer = InteriorPointSolver(program.balance).solve(program, settings, progress)
    return replace(answer, seconds=perf_counter() - begin)


class InteriorPointSolver:
    """Solves programs with one balance (m, 3c): structure, ordering and symbolic analysis are done once."""

    def __init__(self, balance: Balance) -> None:
        self._balance, self._rows = balance, balance.shape[0]
        wrenches = isinstance(balance, Wrenches)
        self._coupling = WrenchCoupling(balance) if wrenches else Coupling(touches(balance, 3, BODY, by_point=True))
        self._lever = self._coupling.largest_entries()
        self._normal = NormalMatrix(self._coupling)
        self._cholesky = Cholesky(self._normal.pattern, BODY)

    def solve(
        self,
        program: ConeProgram,
        settings: Settings | None = None,
        progress: Progress | None = None,
        near: WarmStart | None = None,
    ) -> ConeSolution:
        """Solve a program with the balance of this solver.

        near: where to begin, for a program without cap and bounds; without success there, the solve begins anew, unless it
        is to be begun there only.

        Returns
        -------
        ConeSolution: x lies in the cones to the last digit; outcome "failed" when not even `settings.acceptable` was reached.
        """
        begin = perf_counter()
        settings = settings or Settings()
        if np.isfinite(program.bound).any():
            # A multiplier that stops short leaves a point that opens too slowly, for which its bound has to be paid.
            settings = replace(settings, ignored=0.0)
        if not _same(program.balance, self._balance):
            raise InputError("InteriorPointSolver.solve", "another balance", expected="the balance that the solver was made for")
        force = program.force
        growth = _pad(program.growth / force, self._coupling.rows)
        # The work of a unit load on unit rates is the unit of the objective: rates are then of order one.
        reward = max(float(np.abs(growth).sum()), 1.0)
        limit, bound = (np.where(size / force > _NOTHING, size / force, 0.0) for size in (program.limit, program.bound))
        local = CoulombPoints(limit, program.slope, reward * force * program.linear, reward * force**2 * program.quadratic, bound)
        problem = CoupledProblem(
            local,
            self._coupling.masked(local.active),
            _pad(program.constant / force, len(growth)),
            growth,
            reward=reward,
            cap=program.cap,
            row_unit=self._row_unit(program) / force,
        )
        nothing = _unsupported(problem)
        if nothing is not None:
            y = nothing[: self._rows] / force
            return ConeSolution(
                np.zeros((program.points, 3)),
                np.nan,
                y,
                "infeasible",
                0,
                perf_counter() - begin,
                "interior-point",
                "a body without contact",
            )
        # With a cap, which the load reaches, joints carry what stands on them. Without one they may carry as little as the
        # lighter body.
        heavy = problem.capped

        def enough(at: Iterate) -> bool:
            rates = problem.spread(at.y) + at.theta * problem.linear + problem.quadratic(at.x)
            return local.overlap(problem.local_view(rates)) <= settings.duality_gap

        spent, ending = 0, None
        if near is not None and not local.bounded and not problem.capped:
            x, y = near.x.T / force, _pad(near.y * (force * reward), len(growth))
            start = warm_start(problem, local, x, near.tau, y, near.error)
            brief = replace(
                settings,
                iterations=min(settings.iterations, WARM_ITERATIONS),
                nearly=NEARLY if settings.duality_gap > CLOSE else 0.0,
                nearest=FAR if near.only else 0.0,
            )
            ending = solve_coupled(problem, self._normal, self._cholesky, start, brief, progress, enough)
            spent = ending.factorisations
            if ending.message and max(ending.info.error, settings.duality_gap) <= CLOSE:
                # Near the solution, and held up by what points that stopped short still lack, or by the limit alone.
                patient = replace(settings, ignored=0.0)
                ending = solve_coupled(problem, self._normal, self._cholesky, ending.at, patient, progress, enough)
                spent += ending.factorisations
            if near.only and (ending.status != "solved" or ending.message):
                answer = self._solution(ending, local, force, reward)
                return replace(answer, outcome="failed", iterations=spent, seconds=perf_counter() - begin)
        if ending is None or ending.status != "solved" or ending.message:
            start = interior_start(problem, settings, heavy=heavy)
            ending = solve_coupled(problem, self._normal, self._cholesky, start, settings, progress, enough)
            spent += ending.factorisations
        if ending.message:
            # From the other size of forces; and the few multipliers that stop short save iterations, but now and then leave
            # residuals that no later step removes.
            start, patient = interior_start(problem, settings, heavy=not heavy), replace(settings, ignored=0.0)
            second = solve_coupled(problem, self._normal, self._cholesky, start, patient, progress, enough)
            spent += second.factorisations
            ending = second if ending.status == "failed" or not second.message else ending
        answer = self._solution(ending, local, force, reward)
        return replace(answer, iterations=spent, seconds=perf_counter() - begin)

    def _row_unit(self, program: ConeProgram) -> FloatArray:
        """Return the largest load on each body times the largest lever of each of its rows (m,).

        Measured by the total weight, the fall of one light stone would pass for rounding.
        """
        loads = _pad(np.maximum(np.abs(program.constant), np.abs(program.growth)), self._coupling.rows)
        own = loads.reshape(-1, BODY).max(axis=1)
        own = np.where(own > 0, own, own.max(initial=0.0) or 1.0)
        return np.repeat(own, BODY) * self._lever

    def factorisation_seconds(self) -> float:
        """Return the processor time of one bare factorisation of the last matrix, s, the best of three."""
        times: list[float] = []
        for _ in range(3):
            begin = process_time()
            self._cholesky.factor_again()
            times.append(process_time() - begin)
        return min(times)

    def factor_nonzeros(self) -> int:
        """Return the number of stored entries of the last factor."""
        return self._cholesky.nonzeros()

    def _solution(self, ending: Ending, local: CoulombPoints, force: float, reward: float) -> ConeSolution:
        at = ending.at
        unit = _unit(ending, at)
        x, load = local.inside(at.x.reshape(3, -1) / unit).T * force, at.load / unit
        return ConeSolution(
            x=np.ascontiguousarray(x),
            tau=load,
            y=at.y[: self._rows] / (force * unit if ending.status == "infeasible" else force * unit * reward),
            outcome="failed" if ending.status == "running" else ending.status,
            iterations=ending.factorisations,
            seconds=0.0,
            solver="interior-point",
            message=ending.message,
        )


def _unit(ending: Ending, at: Iterate) -> float:
    """Return what the variables are divided by: theta, or the size of a certificate."""
    if ending.status == "unbounded":
        return at.load if at.load > 0 else max(float(np.abs(at.x).max(initial=0.0)), 1e-300)
    if ending.status == "infeasible":
        return max(float(np.abs(at.y).max(initial=0.0)), 1e-300)
    return at.theta


def _unsupported(problem: CoupledProblem) -> FloatArray | None:
    """Return a certificate of infeasibility from rows that nothing resists, if they alone give one."""
    rows = ~problem.coupling.touched_rows()
    constant, growth = np.where(rows, problem.constant, 0.0), np.where(rows, problem.growth, 0.0)
    square = float(growth @ growth)
    y = constant - (float(constant @ growth) / square * growth if square > 0 else 0.0)
    work = float(constant @ y)
    return y / work if work > 1e-12 * max(float(problem.constant @ problem.constant), 1e-300) else None


def _same(a: Balance, b: Balance) -> bool:
    if a is b or a.shape != b.shape:
        return a is b
    if isinstance(a, Wrenches) and isinstance(b, Wrenches):
        return all(np.array_equal(mine, other) for mine, other in zip(a.arrays, b.arrays, strict=True))
    first, second = as_matrix(a), as_matrix(b)
    return np.array_equal(first.indices, second.indices) and np.array_equal(first.data, second.data)


def _pad(v: FloatArray, size: int) -> FloatArray:
    return np.concatenate([v, np.zeros(size - len(v))])
