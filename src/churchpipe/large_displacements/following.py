"""Step after step along a path, until something ends it."""

from dataclasses import dataclass
from typing import Literal, Protocol

from churchpipe.large_displacements.halo import grown
from churchpipe.large_displacements.moving_model import MovingModel
from churchpipe.large_displacements.path import (
    PathState,
    PathStep,
    may_go_on,
    next_state,
    solve_state,
    without,
)

EndingName = Literal["vanished", "free", "collapsed", "unfinished", "unbounded", "not-converged"]


@dataclass(frozen=True, slots=True)
class Ending:
    """How a path ended, and what is to be said of it."""

    status: EndingName
    message: str = ""


class Steps(Protocol):
    """What takes down the steps of a path, and may end it."""

    @property
    def left(self) -> float:
        """How far the path may still go, m per unit of work."""
        ...

    def add(self, step: PathStep) -> Ending | None:
        """Take down a step; return how the path ends with it, None where it goes on."""
        ...

    def fall(self, step: PathStep) -> None:
        """Take down the stones that fall in a step."""
        ...


def follow(model: MovingModel, state: PathState, steps: int, record: Steps, rings: int) -> Ending:
    """Take step after step, so many at the most, and return how it ended. Stones that fall and can be spared are taken out.

    rings: contacts from a moving stone to those held.
    """
    for _ in range(steps):
        taken = solve_state(model, state)
        while (wider := grown(model, taken, rings)) is not None:
            model, state = wider
            taken = solve_state(model, state)
        while taken.lost.any():
            if not may_go_on(model, taken):
                return Ending("collapsed", f"{int(taken.lost.sum())} stones that cannot be spared fall")
            record.fall(taken)
            state = without(model, taken)
            taken = solve_state(model, state)
        if taken.answer.outcome == "unbounded":
            return Ending("unbounded", "the stones have locked: nothing of this kind moves them on")
        if taken.answer.outcome != "solved":
            return Ending("not-converged", f"the program of a step was not solved: {taken.answer.message}")
        ending = record.add(taken)
        if ending is not None:
            return ending
        state = next_state(model, taken, record.left)
    return Ending("unfinished", f"all {steps} steps were used up")
