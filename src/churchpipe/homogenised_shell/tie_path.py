"""Ties on the capacity curve of a shell: elastic up to their strength, then yielding; slack in compression; broken for good.

A tension is a dead load on the facets under the anchors. That of a step follows from the elongation at its end, which follows
from the tension: their difference is brought to zero by Broyden's method, from the flexibility of the shell that does not yield.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from churchpipe.errors import InputError
from churchpipe.homogenised_shell.condensed import StressState
from churchpipe.homogenised_shell.element import ShellElements
from churchpipe.homogenised_shell.loads import body_forces
from churchpipe.homogenised_shell.settings import SOLVER
from churchpipe.homogenised_shell.ties import unit_tension
from churchpipe.model.arrays import FloatArray
from churchpipe.model.ties import Tie


class TiePath:
    """The ties of a pushover so far.

    tension (nt,) N; elongation (nt,) m since the dead load, which is carried with their pretension.
    """

    def __init__(self, elements: ShellElements, ties: Sequence[Tie]) -> None:
        shell = elements.shell
        for tie in ties:
            if tie.stiffness is None:
                expected = "E A / L, N/m, as `place_ties` gives it"
                raise InputError(f"tie {tie.name}: stiffness", "a capacity curve needs it", found=None, expected=expected)
        self._pull = np.zeros((len(ties), elements.unknowns))
        for row, tie in zip(self._pull, ties, strict=True):
            row[:] = body_forces(elements, unit_tension(shell, tie))
        self._free = ~elements.clamped
        self._stiffness = np.array([tie.stiffness for tie in ties], dtype=np.float64)
        self._most = np.array([tie.strength for tie in ties])
        self._ultimate = np.array([tie.ultimate for tie in ties])
        self._drawn = np.array([tie.pretension for tie in ties]) / self._stiffness
        self._flowed = np.zeros(len(ties))
        self._broken = np.zeros(len(ties), dtype=np.bool_)
        self._flexibility = np.zeros((len(ties), len(ties)))
        self.elongation = np.zeros(len(ties))
        self.tension = np.array([tie.pretension for tie in ties])

    def __len__(self) -> int:
        return len(self.tension)

    def soften(self, solve: Callable[[FloatArray], FloatArray]) -> None:
        """Take the flexibility of the shell; solve: displacements of the free unknowns, m, under forces on them, N."""
        pull = self._pull[:, self._free]
        self._flexibility = np.array([pull @ solve(row) for row in pull]).reshape(len(self), len(self))

    def loads(self, tension: FloatArray) -> FloatArray:
        """Return the forces (m,) of tensions (nt,) on the free unknowns, N."""
        return tension @ self._pull[:, self._free]

    def step(self, solved: Callable[[FloatArray], StressState], softness: float) -> tuple[StressState, FloatArray, FloatArray]:
        """Return the state of a step with tensions that follow from it, these (nt,) N, and the elongations (nt,) m.

        solved: the state for given tensions; its motion times `softness` is in m. A state that does not hold is returned as it
        is; one whose tensions were not found is "failed".
        """
        tension: FloatArray = self.tension
        slope: FloatArray = np.eye(len(self)) + self._stiffness[:, None] * self._flexibility
        moved = changed = np.zeros(len(self))
        for _ in range(SOLVER.tie_rounds):
            state = solved(tension)
            stretched: FloatArray = self.elongation - softness * (self._pull @ state.motion)
            apart: FloatArray = tension - self._law(stretched)
            if not state.holds or np.abs(apart).max(initial=0.0) <= SOLVER.tie_tension * self._most.max(initial=0.0):
                return state, tension, stretched
            changed = apart - changed
            slope = slope + np.outer(changed - slope @ moved, moved) / max(float(moved @ moved), np.finfo(float).tiny)
            most = np.where(self._broken, 0.0, self._most)
            target: FloatArray = np.clip(tension - np.linalg.lstsq(slope, apart, rcond=None)[0], 0.0, most)
            if np.abs(target - tension).max() <= SOLVER.tie_tension * self._most.max():
                # At a bound that the slope points beyond.
                target = 0.5 * (tension + self._law(stretched))
            moved, changed, tension = target - tension, apart, target
        return (
            replace(solved(tension), status="failed", message="the tensions of the ties were not found"),
            tension,
            self.elongation,
        )

    def accept(self, tension: FloatArray, elongation: FloatArray) -> None:
        """Take a step's tensions and elongations."""
        self.tension, self.elongation = tension, elongation
        elastic = self._drawn + elongation - self._flowed
        self._flowed = self._flowed + np.maximum(elastic - self._most / self._stiffness, 0.0)
        self._broken = self._broken | (elongation >= self._ultimate)

    def _law(self, elongation: FloatArray) -> FloatArray:
        """Return the tensions (nt,) at elongations (nt,)."""
        elastic = self._stiffness * (self._drawn + elongation - self._flowed)
        return np.where(self._broken, 0.0, np.clip(elastic, 0.0, self._most))
