"""The cone program to which every limit analysis is reduced, and the solution that a solver returns."""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import scipy.sparse as sp

from churchpipe.conic.wrenches import Balance, apply, as_matrix, transpose
from churchpipe.errors import InputError
from churchpipe.model.arrays import FloatArray, floats, store, store_arrays

Outcome = Literal["solved", "infeasible", "unbounded", "failed"]


@dataclass(frozen=True, slots=True)
class ConeProgram:
    """Maximise the multiplier of a load under balance and cone constraints.

    maximise    tau - linear . n - 1/2 quadratic . n^2
    subject to  balance x + constant + tau growth = 0,   tau <= cap,
                0 <= n_k <= bound_k,   |t_k| <= limit_k + slope_k n_k,   x_k = (n_k, t1_k, t2_k)

    `balance` (m, 3c): the wrenches of rigid bodies, or a matrix; `constant`, `growth` (m,); `limit` (c,) >= 0; `slope` (c,);
    `linear`, `quadratic` (c,), the latter >= 0; `cap` may be infinite; `bound` (c,) >= 0, or one for all, infinite unless given:
    a point without limit and slope has n alone, a bounded scalar. The multipliers y (m,) of the balance satisfy growth . y = 1
    at an optimum (tau < cap).
    """

    balance: Balance
    constant: FloatArray
    growth: FloatArray
    limit: FloatArray
    slope: FloatArray
    linear: FloatArray
    quadratic: FloatArray
    cap: float = np.inf
    bound: FloatArray = field(default_factory=lambda: np.array(np.inf))

    def __post_init__(self) -> None:
        rows, columns = self.balance.shape
        if columns % 3:
            raise InputError("ConeProgram.balance", "wrong shape", found=(rows, columns), expected="three columns a point")
        points = columns // 3
        store_arrays(self, constant=(rows,), growth=(rows,), limit=(points,), slope=(points,), linear=(points,))
        store_arrays(self, quadratic=(points,))
        store(self, bound=floats("ConeProgram.bound", np.broadcast_to(self.bound, (points,)), (points,), finite=False))
        if (self.limit < 0).any() or (self.quadratic < 0).any() or not (self.bound >= 0).all():
            raise InputError("ConeProgram", "negative limit, quadratic cost or bound", expected=">= 0")

    @property
    def points(self) -> int:
        """Number of cones."""
        return len(self.limit)

    @property
    def force(self) -> float:
        """The largest load of a row, the unit of force for errors; 1 when there is none."""
        size = max(float(np.abs(self.constant).max(initial=0.0)), float(np.abs(self.growth).max(initial=0.0)))
        return size if size > 0 else 1.0

    def residual(self, x: FloatArray, tau: float) -> FloatArray:
        """Return balance x + constant + tau growth (m,) of forces x (c, 3)."""
        return apply(self.balance, x) + self.constant + tau * self.growth

    def rates(self, y: FloatArray) -> FloatArray:
        """Return balance^T y (c, 3) of multipliers y (m,): how fast each point opens and slides."""
        return transpose(self.balance, y)

    def matrix(self) -> sp.csc_matrix[np.float64]:
        """Return the balance as a matrix (m, 3c), its columns point by point."""
        return as_matrix(self.balance)

    def imbalance(self, x: FloatArray, tau: float) -> float:
        """Return the largest residual of forces x (c, 3) over the largest load; infinite where one is not a number."""
        worst = float(np.abs(self.residual(x, tau)).max(initial=0.0)) / self.force
        return worst if np.isfinite(worst) else np.inf


@dataclass(frozen=True, slots=True)
class WarmStart:
    """Forces x (c, 3), tau and multipliers y (m,) near those of a solution, in the units of the program, to begin with.

    error: how far from the solution they are thought to be, a share of the objective. only: whether the program counts as not
    solved where nothing comes of this start, instead of being begun anew without it.
    """

    x: FloatArray
    tau: float
    y: FloatArray
    error: float = 3.0
    only: bool = False


@dataclass(frozen=True, slots=True)
class ConeSolution:
    """A solver's answer, in the units of the program.

    x (c, 3) forces; tau; y (m,) multipliers of the balance. outcome "infeasible": y is a certificate, balance^T y in the
    dual cone with constant . y > 0 and growth . y = 0. "unbounded": x is a ray, balance x + growth = 0. iterations: of all
    starts and solvers that were tried, one factorisation each.
    """

    x: FloatArray
    tau: float
    y: FloatArray
    outcome: Outcome
    iterations: int
    seconds: float
    solver: str
    message: str = ""
