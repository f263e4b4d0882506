"""Ties on the capacity curve of a shell: elastic up to their strength, then yielding; slack in compression; broken for good."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from churchpipe.errors import InputError
from churchpipe.homogenised_shell.condensed import StressState
from churchpipe.homogenised_shell.element import ShellElements
from churchpipe.homogenised_shell.loads import body_forces
from churchpipe.homogenised_shell.step_ties import StepTies
from churchpipe.homogenised_shell.ties import unit_tension
from churchpipe.model.arrays import FloatArray
from churchpipe.model.ties import Tie

# A step may stretch a tie beyond the elongation at which it breaks by this share of it: until its end the tie still pulls.
_BEYOND = 0.01


class TiePath:
    """The ties of a pushover so far.

    tension (nt,) N; elongation (nt,) m since the dead load, which is carried with their pretension.
    """

    def __init__(self, elements: ShellElements, ties: Sequence[Tie], softness: float, weight: float) -> None:
        """In the program of a step tensions are shares of `weight`, N, and motions of `softness`, m."""
        shell = elements.shell
        for tie in ties:
            if tie.stiffness is None:
                expected = "E A / L, N/m, as `place_ties` gives it"
                raise InputError(f"tie {tie.name}: stiffness", "a capacity curve needs it", found=None, expected=expected)
        self._names = [tie.name for tie in ties]
        self._pull = np.zeros((len(ties), elements.unknowns))
        for row, tie in zip(self._pull, ties, strict=True):
            row[:] = body_forces(elements, unit_tension(shell, tie))
        self._free = ~elements.clamped
        self._softness, self._weight = softness, weight
        self._stiffness = np.array([tie.stiffness for tie in ties], dtype=np.float64)
        self._most = np.array([tie.strength for tie in ties])
        self._ultimate = np.array([tie.ultimate for tie in ties])
        self._drawn = np.array([tie.pretension for tie in ties]) / self._stiffness
        self._flowed = np.zeros(len(ties))
        self._broken = np.zeros(len(ties), dtype=np.bool_)
        self._elongation = np.zeros(len(ties))
        self.tension = np.array([tie.pretension for tie in ties])

    def __len__(self) -> int:
        return len(self.tension)

    @property
    def loads(self) -> FloatArray:
        """Forces (m,) of the tensions on the free unknowns, over the weight."""
        return self.tension @ self._pull[:, self._free] / self._weight

    def in_step(self) -> StepTies:
        """Return the ties that may pull as a part of the next step."""
        pulls = self._pulls
        return StepTies(
            pull=self._pull[pulls][:, self._free],
            compliance=self._weight / (self._stiffness[pulls] * self._softness),
            length=(self._drawn + self._elongation - self._flowed)[pulls] / self._softness,
            most=self._most[pulls] / self._weight,
            before=self.tension[pulls] / self._weight,
        )

    def until_broken(self, state: StressState) -> float:
        """Return the share of a step after which its first tie breaks, 1 where none is stretched by much more than it bears."""
        longer = -self._softness * (self._pull @ state.motion)
        most = (1 + _BEYOND) * self._ultimate - self._elongation
        over = self._pulls & (longer > most)
        # To the middle of what is allowed beyond, so that the tie has broken then.
        aim = most[over] - 0.5 * _BEYOND * self._ultimate[over]
        return float((aim / longer[over]).min(initial=1.0))

    def accept(self, state: StressState, tension: FloatArray) -> list[str]:
        """Take a step and its tensions, of the ties that `in_step` returned, over the weight; return the ties that it broke."""
        pulls, whole = self._pulls, ~self._broken
        self.tension = np.zeros(len(self))
        self.tension[pulls] = self._weight * tension
        self._elongation = self._elongation - self._softness * (self._pull @ state.motion)
        elastic = self._drawn + self._elongation - self._flowed
        self._flowed = self._flowed + np.maximum(elastic - self._most / self._stiffness, 0.0)
        self._broken = self._broken | (self._elongation >= self._ultimate)
        return [self._names[tie] for tie in np.flatnonzero(whole & self._broken)]

    @property
    def _pulls(self) -> NDArray[np.bool_]:
        return ~self._broken & (self._most > 0)
