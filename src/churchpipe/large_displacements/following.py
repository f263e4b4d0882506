"""Step after step along a path, until something ends it."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Literal, Protocol

from churchpipe.large_displacements.halo import grown, shrunk
from churchpipe.large_displacements.moving_model import MovingModel
from churchpipe.large_displacements.path import PathStep, may_go_on, next_state, solve_state, without, withstands_nothing
from churchpipe.large_displacements.path_state import PathState
from churchpipe.large_displacements.settings import PATH
from churchpipe.mechanism import reference_speed
from churchpipe.wording import counted

EndingName = Literal["vanished", "free", "parted", "collapsed", "unfinished", "unbounded", "not-converged"]


@dataclass(frozen=True, slots=True)
class Ending:
    """How a path ended, and what is to be said of it."""

    status: EndingName
    message: str = ""


@dataclass(frozen=True, slots=True)
class Departure:
    """The step that a path has left last: its model, how far it went, m per unit of work, the state that lies so far along it as
    asked for, and whether it was proved."""

    model: MovingModel
    way: float
    along: Callable[[float], PathState]
    proved: bool


class Steps(Protocol):
    """What keeps the steps of a path, and may end it."""

    @property
    def left(self) -> float:
        """How far the path may still go, m per unit of work."""
        ...

    def add(self, step: PathStep) -> Ending | None:
        """Keep a step. Return how the path ends with it, or None where it goes on."""
        ...

    def fall(self, step: PathStep) -> None:
        """Keep which stones fall in a step."""
        ...

    def drops(self, step: PathStep, /) -> bool:
        """True where so much is lost on the way to a step, or the structure falls, that it should be known better where."""
        ...


def follow(model: MovingModel, state: PathState, steps: int, record: Steps, rings: int, last: Departure | None = None) -> Ending:
    """Solve and keep at most so many steps of a path, and return how it ended.

    A step is solved on the stones that move and those near to them, so many contacts away (`rings`). Stones that stand still by
    now are held; where a step moves others, it is solved again with more. Where stones fall in it, it is solved again without
    them, unless the structure cannot spare them. Where much is lost on the way to it (`Steps.drops`), it goes half as far, until
    that place is known to `PATH.located` of a step. So it does where a large model has gone from a step that is proved to one
    that is not, until it goes less far than `PATH.nearer` of a step. last: the step that led to the state, where it is known.
    """
    tiny = 0
    for _ in range(steps):
        model, state = shrunk(model, state, rings)
        fallen: list[PathStep] = []
        while True:
            step = solve_state(model, state)
            falls = bool(step.falling.any())
            if falls and may_go_on(model, step):
                fallen.append(step)
                state = without(model, state, step)
            elif not falls and (wider := grown(model, step, rings)) is not None:
                model, state = wider
            elif last and (
                (state.way > PATH.nearer * last.way and _lost(model, last, step))
                or (state.way > PATH.located * last.way and not fallen and record.drops(step))
            ):
                fallen.clear()
                model, state = shrunk(last.model, last.along(0.5 * state.way), rings)
            else:
                break
        for each in fallen:
            record.fall(each)
        if (ending := _no_further(model, state, step) or record.add(step)) is not None:
            return ending
        tiny = 0 if _proved(step) or step.way * reference_speed(step.speed) > PATH.shortest * model.step else tiny + 1
        if tiny == PATH.stalled:
            return Ending("not-converged", f"the structure jumps here, and {tiny} tiny steps found no way on")
        last = Departure(model, step.way, partial(next_state, model, step), _proved(step))
        state = next_state(model, step, record.left)
    return Ending("unfinished", "all steps asked for were used up")


def _lost(model: MovingModel, last: Departure, step: PathStep) -> bool:
    """Return whether proof is lost, in a large model, on the way to a step. From a nearer place a step often is proved, as before
    stones fall together; where that of the nearest one was not, to go less far again would not lead out."""
    return model.large and last.proved and not _proved(step)


def _proved(step: PathStep) -> bool:
    """Return whether the motion of a step proves it."""
    return step.answer.outcome == "solved" and step.misfit < PATH.fits


def _no_further(model: MovingModel, state: PathState, step: PathStep) -> Ending | None:
    """Return why a path ends at a step, which is that of a state: nothing holds its stones, or nothing leads on from it.

    A motion that misses its forces by more than `PATH.credible` leads nowhere.
    """
    answer = step.answer
    if step.falling.any():
        number = int(step.falling.sum())
        return Ending("collapsed", counted(number, "stone that cannot be spared falls", "stones that cannot be spared fall"))
    if answer.outcome == "unbounded":
        return Ending("unbounded", "the stones have locked: nothing of this kind moves them on")
    if answer.outcome == "solved" and answer.misfit <= PATH.credible:
        return None
    if withstands_nothing(model, state):
        return Ending("collapsed", "where the stones have got to, they hold no push any more, however their joints slide")
    if answer.outcome != "solved":
        return Ending("not-converged", f"the program of a step was not solved: {answer.message}")
    return Ending(
        "not-converged",
        f"no motion was found that fits its forces: they miss each other by {answer.misfit:.0%} of the load factor",
    )
