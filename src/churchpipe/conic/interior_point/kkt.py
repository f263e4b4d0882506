"""The linear system of one interior-point iteration, reduced to the normal matrix."""

from dataclasses import dataclass

import numpy as np

from churchpipe.conic.cholesky import Cholesky, NotDefiniteError
from churchpipe.conic.interior_point.cones import ProductScaling
from churchpipe.conic.interior_point.iterate import inner
from churchpipe.conic.interior_point.normal import NormalMatrix
from churchpipe.conic.interior_point.problem import CoupledProblem
from churchpipe.conic.interior_point.residuals import largest
from churchpipe.model.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Right:
    """A right side: x (nx,), load, y (m,), z (rows,) or None for zero, and `pull` = W^-2 of what else stands in the rows of z.

    Complementarity enters as pull: W^-1 applied once to scaled products. W^-2 applied to their images would lose every digit.
    """

    x: FloatArray
    load: float
    y: FloatArray
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
            self.x + factor * other.x, self.load + factor * other.load, self.y + factor * other.y, self.z + factor * other.z
        )

    def times(self, factor: float) -> "Direction":
        """Return factor self."""
        return Direction(factor * self.x, factor * self.load, factor * self.y, factor * self.z)


class KktSystem:
    """Solves, for one scaling W,

    Q x + G^T z + B^T y = r_x,   B x + load growth = r_y,   growth . y + z_cap = r_load,   G x - W^2 z = r_z + W^2 pull,
    the row of the cap, load - w_cap^2 z_cap, among the last.
    """

    def __init__(self, problem: CoupledProblem, normal: NormalMatrix, cholesky: Cholesky) -> None:
        self._problem, self._normal, self._cholesky = problem, normal, cholesky

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
        largest = float(diagonal.max(initial=0.0)) or 1.0
        shift = regularisation * (diagonal + 1e-8 * largest)
        for attempt in range(4):
            shifted = values.copy()
            shifted[self._normal.diagonal] += 100.0**attempt * shift
            try:
                self._cholesky.factor(shifted)
                break
            except NotDefiniteError:
                if attempt == 3:
                    raise
        self._lever: FloatArray | None = None

    def solve(self, rights: list[Right], refinements: int, allowed: float) -> list[Direction]:
        """Return the solutions for several right sides, refined until the coupling rows hold to `allowed`.

        Refinement corrects x by small steps of its own: recomputed from the whole of y, it would carry the rounding of y times
        the largest compliance. The rows of x hold by construction of z.
        """
        problem = self._problem
        pulls = [right.pull if right.z is None else right.pull + self._softened(right.z) for right in rights]
        forces = [right.x + problem.transpose(pull) for right, pull in zip(rights, pulls, strict=True)]
        x = [self._comply(force) for force in forces]
        targets = np.array(
            [right.load + (pull[-1] if problem.capped else 0.0) for right, pull in zip(rights, pulls, strict=True)]
        )
        rows = [problem.couple(part) - right.y for part, right in zip(x, rights, strict=True)]
        y, load = self._bordered(np.column_stack(rows), targets)
        spread = [problem.spread(y[:, k]) for k in range(len(rights))]
        x = [self._comply(force - part) for force, part in zip(forces, spread, strict=True)]
        for _ in range(refinements):
            rows = [problem.couple(x[k]) + load[k] * problem.growth - right.y for k, right in enumerate(rights)]
            if max(largest(row) for row in rows) <= allowed:
                break
            lack = targets - np.einsum("i,ik->k", problem.growth, y) - self._softness * load
            more_y, more_load = self._bordered(np.column_stack(rows), lack)
            more = [problem.spread(more_y[:, k]) for k in range(len(rights))]
            x = [part - self._comply(extra) for part, extra in zip(x, more, strict=True)]
            y, load = y + more_y, load + more_load
            spread = [problem.spread(y[:, k]) for k in range(len(rights))]
        return [
            self._complete(right, pulls[k], x[k], spread[k], np.ascontiguousarray(y[:, k]), float(load[k]))
            for k, right in enumerate(rights)
        ]

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
        z = self._softened(problem.constrain(x, load)) - pull
        force = right.x - problem.quadratic(x) - spread
        rows = len(problem.local.right)
        exact = problem.local.balanced(problem.local_view(force), z[:rows])
        if problem.capped:
            exact = np.append(exact, right.load - inner(problem.growth, y))
        return Direction(x, load, y, exact)

    def _comply(self, force: FloatArray) -> FloatArray:
        """Return S force."""
        return self._compliance.apply(self._problem.local_view(force)).ravel()

    def _softened(self, z: FloatArray) -> FloatArray:
        """Return W^-2 z."""
        return self._scaling.solve(self._scaling.solve(z))
