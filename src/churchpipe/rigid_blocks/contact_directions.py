"""Multipliers u and velocities y of a step (`contact_newton`), by a factor of its whole matrix or by conjugate gradients.

With a factor they are exact, at the price of a matrix of twice the rows and of a few solves; conjugate gradients take two
matrices and some twenty solves, to an error of a hundredth. What they leave out are motions that hardly resist, along which exact
steps now and then go too far and come to nothing.
"""

from typing import NamedTuple

import numpy as np

from churchpipe.conic.wrenches import BODY
from churchpipe.model.arrays import FloatArray
from churchpipe.rigid_blocks.contact_system import ContactSystem, multiply


class Direction(NamedTuple):
    """Multipliers u of the balance and velocities y, both (6 nf,), and the change of the load factor."""

    u: FloatArray
    y: FloatArray
    load_factor: float


class Blocks(NamedTuple):
    """Blocks (3, 3, nc) of the matrices A, M and K, and the factor of K in the matrix of a step."""

    plain: FloatArray
    mixed: FloatArray
    both: FloatArray
    stiffness: float


class ExactDirections:
    """Directions by a factor of the whole matrix."""

    def __init__(self, system: ContactSystem, blocks: Blocks) -> None:
        """Raise NotDefiniteError where there is no factor."""
        self._system = system
        plain, mixed, both, stiffness = blocks
        rows = np.concatenate([plain, mixed], axis=1), np.concatenate([mixed.transpose(1, 0, 2), -stiffness * both], axis=1)
        system.factorise(system.pair, np.concatenate(rows))
        # The loads that keep the work of u and of y as given: what they change, and the work of that (2, 2).
        live = np.stack([system.live, np.zeros_like(system.live)], axis=1)
        self._levers = self._solve(live, live[:, ::-1])
        self._works = np.stack([system.live @ each for each in self._levers])

    def find(self, rows: FloatArray, raised: FloatArray, excess: float, pull: float) -> Direction:
        """Return the direction of the right sides rows and -raised (6 nf,) in which the load does the work -pull and -excess."""
        live = self._system.live
        u, y = self._solve(rows, -raised)
        loads = np.linalg.solve(self._works, [float(live @ u) + pull, float(live @ y) + excess])
        return Direction(u - self._levers[0] @ loads, y - self._levers[1] @ loads, -float(loads[0]))

    def _solve(self, first: FloatArray, second: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return u and y of right sides of the balance and of the velocities, each (6 nf,) or (6 nf, k)."""
        shape = first.shape
        pair = np.concatenate([each.reshape(-1, BODY, *shape[1:]) for each in (first, second)], axis=1)
        found = self._system.pair.solve(pair.reshape(-1, *shape[1:])).reshape(pair.shape)
        return found[:, :BODY].reshape(shape), found[:, BODY:].reshape(shape)


class GradientDirections:
    """Directions by conjugate gradients on the velocities alone, near the solutions of K."""

    def __init__(self, system: ContactSystem, blocks: Blocks, lever: FloatArray, share: float) -> None:
        """lever (6 nf,): the solution of A for the live load; share: of K that stands for the matrix of the velocities.

        Raises
        ------
        NotDefiniteError
        """
        self._system, self._lever = system, lever
        self._mixed, self._stiff = blocks.mixed, blocks.stiffness * blocks.both
        system.factorise(system.velocities, share * blocks.both)
        self._guess = system.velocities.solve(system.live)
        self._stiffness, self._guess_work = float(system.live @ lever), float(system.live @ self._guess)

    def find(self, rows: FloatArray, raised: FloatArray, excess: float, pull: float) -> Direction:
        """Return the same as with a factor."""
        system, live = self._system, self._system.live
        right = raised + self._crossed(self._free(rows) - self._lever * (pull / self._stiffness), transposed=True)
        y = self._velocities(right, excess)
        lack = system.balance.solve(rows - self._crossed(y))
        gain = (float(live @ lack) + pull) / self._stiffness
        return Direction(lack - self._lever * gain, y, -gain)

    def _velocities(self, right: FloatArray, excess: float) -> FloatArray:
        """Return dy with H dy = right, f_L . dy = -excess."""
        settings = self._system.settings
        y = self._guess * (-excess / self._guess_work)
        left = right - self._hessian(y) if excess else right
        change = self._near(left)
        along, size = change, float(left @ change)
        goal = settings.inner**2 * size
        for _ in range(settings.inner_steps):
            if not size > goal:
                break
            bent = self._hessian(along)
            length = size / float(along @ bent)
            y, left = y + length * along, left - length * bent
            change = self._near(left)
            before, size = size, float(left @ change)
            along = change + (size / before) * along
        return y

    def _hessian(self, y: FloatArray) -> FloatArray:
        """Return H y, what is left of the whole matrix where u is eliminated."""
        system = self._system
        rates = system.rates(y)
        free = self._free(system.couple(multiply(self._mixed, rates)))
        return system.couple(multiply(self._stiff, rates) + multiply(self._mixed, system.rates(free), transposed=True))

    def _crossed(self, y: FloatArray, *, transposed: bool = False) -> FloatArray:
        return self._system.couple(multiply(self._mixed, self._system.rates(y), transposed=transposed))

    def _free(self, rows: FloatArray) -> FloatArray:
        """Return the solution of A for these rows that does no work with the live load."""
        found = self._system.balance.solve(rows)
        return found - self._lever * (float(self._system.live @ found) / self._stiffness)

    def _near(self, rows: FloatArray) -> FloatArray:
        """Return the same of K."""
        found = self._system.velocities.solve(rows)
        return found - self._guess * (float(self._system.live @ found) / self._guess_work)
