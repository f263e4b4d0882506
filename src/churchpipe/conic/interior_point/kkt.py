"""The linear system of one interior-point iteration, reduced to the normal matrix."""

from dataclasses import dataclass

import numpy as np

from churchpipe.conic.cholesky import Cholesky, NotDefiniteError
from churchpipe.conic.interior_point.cones import ProductScaling
from churchpipe.conic.interior_point.iterate import inner, plus
from churchpipe.conic.interior_point.normal import NormalMatrix
from churchpipe.conic.interior_point.problem import CoupledProblem, largest
from churchpipe.model.arrays import FloatArray

# Imbalance that no sweep can lower, in the unit of force.
_ROUNDING = 1e-15


@dataclass(frozen=True, slots=True)
class Right:
    """A right side: x (nx,), load, y (m,), z (rows,), None for zero, and `pull` = W^-2 of what else stands in the rows of z.

    Complementarity enters as pull: W^-1 applied once to scaled products. W^-2 applied to their images would lose every digit.
    """

    x: FloatArray | None
    load: float
    y: FloatArray | None
    z: FloatArray | None
    pull: FloatArray


@dataclass(frozen=True, slots=True)
class Direction:
    """A solution: x (nx,), load, y (m,), z (rows,)."""

    x: FloatArray
    load: float
    y: FloatArray
    z: FloatArray

    def plus(self, other: "Direction", factor: float = 1.0) -> "Direction":
        """Return self + factor other."""
        return Direction(
            plus(self.x, other.x, factor),
            self.load + factor * other.load,
            plus(self.y, other.y, factor),
            plus(self.z, other.z, factor),
        )


class KktSystem:
    """Solves, for one scaling W of the cones and given right sides r, with B the coupling of a `CoupledProblem`,

    Q x + G^T z + B^T y = r_x,   B x + load growth = r_y,   growth . y + z_cap = r_load,   G x - W^2 z = r_z + W^2 pull,
    the row of the cap of the load, load - w_cap^2 z_cap, among the last. Eliminating x and z leaves the normal matrix in y.
    """

    def __init__(self, problem: CoupledProblem, normal: NormalMatrix, cholesky: Cholesky) -> None:
        self._problem, self._normal, self._cholesky = problem, normal, cholesky
        self.factorisations = 0

    def update(self, scaling: ProductScaling, regularisation: float) -> None:
        """Assemble and factorise at a new scaling.

        Raises
        ------
        NotDefiniteError: even with a thousand times the regularisation.
        """
        problem = self._problem
        self._scaling = scaling
        local = scaling.parts[: len(problem.local.cones)]
        self._compliance = problem.local.compliance(local)
        cap = scaling.parts[-1].apply(np.ones((1, 1)))[0, 0] if problem.capped else np.inf
        self._softness = 1.0 / cap**2
        values = self._normal.assemble(self._compliance.matrix)
        diagonal = values[self._normal.diagonal]
        # Rows that nothing resists get next to no stiffness: a load on them then fixes the multiplier.
        body = diagonal.reshape(-1, problem.coupling.block).max(axis=1)
        body = np.where(body > 0, body, float(body.max(initial=0.0)) or 1.0)
        shift = regularisation * (diagonal + 1e-8 * np.repeat(body, problem.coupling.block))
        for attempt in range(4):
            values[self._normal.diagonal] = diagonal + 100.0**attempt * shift
            self.factorisations += 1
            try:
                self._cholesky.factor(values)
                break
            except NotDefiniteError:
                if attempt == 3:
                    raise
        self._lever: FloatArray | None = None

    def solve(self, rights: list[Right]) -> list[Direction]:
        """Return the solutions for several right sides, their coupling rows as exact as the factor is."""
        problem = self._problem
        pulls = [self._pull(right) for right in rights]
        forces = [problem.transpose(pull) for pull in pulls]
        for force, right in zip(forces, rights, strict=True):
            if right.x is not None:
                force += right.x
        targets = np.array([self._target(right, pull) for right, pull in zip(rights, pulls, strict=True)])
        rows = [_less(problem.couple(self._comply(force)), right.y) for force, right in zip(forces, rights, strict=True)]
        y, load = self._bordered(np.stack(rows, axis=1), targets)
        out: list[Direction] = []
        for k, right in enumerate(rights):
            column = np.ascontiguousarray(y[:, k])
            spread = problem.spread(column)
            forces[k] -= spread
            x = self._comply(forces[k])
            out.append(self._complete(right, pulls[k], x, spread, column, float(load[k])))
        return out

    def refine(self, right: Right, found: Direction, refinements: int, allowed: float) -> Direction:
        """Return a solution whose coupling rows hold to `allowed`, or after so many refinements.

        They correct x by small steps of its own: recomputed from the whole of y, it would carry the rounding of y times the
        largest compliance. The rows of x hold by construction of z.
        """
        problem = self._problem
        x, load, y = found.x, found.load, found.y
        pull = self._pull(right)
        for _ in range(refinements):
            row = _less(problem.couple(x) + load * problem.growth, right.y)
            if problem.imbalance(row) <= allowed:
                break
            lack = self._target(right, pull) - inner(problem.growth, y) - self._softness * load
            more, more_load = self._bordered(row[:, None], np.array([lack]))
            x = x - self._comply(problem.spread(more[:, 0]))
            load, y = load + float(more_load[0]), y + more[:, 0]
        return found if x is found.x else self._complete(right, pull, x, problem.spread(y), y, load)

    def balance(self, x: FloatArray, load: float, sweeps: int) -> tuple[FloatArray, float]:
        """Return x and load with coupling x + constant + load growth = 0 to rounding.

        The correction is the smallest in the metric of the scaling: a point near the boundary of its cone moves along it. What
        only a mechanism could balance goes into the load.
        """
        problem = self._problem
        for _ in range(sweeps):
            rows = problem.couple(x) + problem.constant + load * problem.growth
            if largest(rows) <= _ROUNDING:
                break
            y, step = self._bordered(rows[:, None], np.zeros(1))
            x, load = x - self._comply(problem.spread(y[:, 0])), load + float(step[0])
        return x, load

    def _bordered(self, rows: FloatArray, targets: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return y (m, k), load (k,) with N y - load growth = rows, growth . y + softness load = targets."""
        growth = self._problem.growth
        if self._lever is None:
            solved = self._cholesky.solve(np.column_stack([rows, growth]))
            self._lever = solved[:, -1].copy()
            self._stiffness = inner(growth, self._lever) + self._softness
            solved = solved[:, :-1]
        else:
            solved = self._cholesky.solve(rows)
        load = (targets - np.einsum("i,ik->k", growth, solved)) / self._stiffness
        return solved + self._lever[:, None] * load, load

    def _complete(
        self, right: Right, pull: FloatArray, x: FloatArray, spread: FloatArray, y: FloatArray, load: float
    ) -> Direction:
        problem = self._problem
        rows = len(problem.local.right)
        force = np.negative(spread, out=spread)
        if right.x is not None:
            force += right.x
        if problem.local.curved:
            force -= problem.quadratic(x)
        z = problem.local.balanced(problem.local_view(force), lambda: (self._softened(problem.constrain(x, load)) - pull)[:rows])
        if problem.capped:
            z = np.append(z, right.load - inner(problem.growth, y))
        return Direction(x, load, y, z)

    def _pull(self, right: Right) -> FloatArray:
        return right.pull if right.z is None else right.pull + self._softened(right.z)

    def _target(self, right: Right, pull: FloatArray) -> float:
        return right.load + (float(pull[-1]) if self._problem.capped else 0.0)

    def _comply(self, force: FloatArray) -> FloatArray:
        """Return S force."""
        return self._compliance.apply(self._problem.local_view(force)).ravel()

    def _softened(self, z: FloatArray) -> FloatArray:
        """Return W^-2 z."""
        return self._scaling.soften(z)


def _less(rows: FloatArray, right: FloatArray | None) -> FloatArray:
    return rows if right is None else rows - right
