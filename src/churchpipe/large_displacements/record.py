"""The steps of a path as they are taken."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from churchpipe.large_displacements.control import Control
from churchpipe.large_displacements.following import Departure, Ending
from churchpipe.large_displacements.going_on import gone_on, last_step
from churchpipe.large_displacements.moving_model import MovingModel
from churchpipe.large_displacements.path import PathStep, onward
from churchpipe.large_displacements.path_arguments import check_given
from churchpipe.large_displacements.path_state import PathState, state_at
from churchpipe.large_displacements.poses import Poses, rotation_vectors, screw
from churchpipe.large_displacements.settings import PATH
from churchpipe.mechanism import stone_speed
from churchpipe.model.arrays import BoolArray, FloatArray
from churchpipe.model.stone_path import FallenStones, LastStep, StepArrays, StonePath

# So many places where a structure jumps are told each for itself.
_FEW_JUMPS = 3


class Record(ABC):
    """The steps of a path as they are taken; where: the analysis, for what is said of it."""

    where = ""

    def __init__(self, model: MovingModel, control: Control) -> None:
        self.model, self.control = model, control
        self.poses: list[Poses] = []
        self.proofs: list[tuple[float, float, float]] = []
        self.friction_power = 0.0
        # The work up to the next step, where another run has summed it.
        self.work_known: float | None = None
        self.displacement: list[float] = []
        self.load_factor: list[float] = []
        self.largest: list[float] = []
        self.work: list[float] = []
        self.fallen: list[FallenStones] = []
        self.resumed = self.given = ""
        self.step: PathStep | None = None
        # The last step of another run, where the path goes on from it.
        self.departure: Departure | None = None
        # The motion of the last step (nb, 6).
        self.velocity: FloatArray | None = None

    @property
    def left(self) -> float:
        """How far the path may still go, m per unit of work."""
        return np.inf

    def note(self, step: PathStep) -> None:
        """Take down a step that was solved."""
        poses, standing = step.state.poses, _standing(self.model, step)
        gone = self.displacement[-1] + self.gone(step) if self.poses else 0.0
        answer, power = step.answer, step.friction_power * self.model.force
        # The work of a step is done when the next one is reached, at the mean of the powers at its ends.
        mean = 0.5 * (self.friction_power + power) if self._steady(step.velocity) else self.friction_power
        done = self.work[-1] + mean * step.state.way if self.work else 0.0
        if self.work_known is not None:
            done, self.work_known = self.work_known, None
        self.friction_power, self.velocity = power, step.velocity
        self.step = step
        self.poses.append(poses)
        self.proofs.append((answer.residual, answer.violation, step.misfit))
        self.displacement.append(gone)
        self.load_factor.append(answer.load_factor)
        away = np.linalg.norm(poses.centroid - self.model.stones.centroid, axis=1)[standing]
        self.largest.append(float(away.max(initial=0.0)))
        self.work.append(done)

    def gone(self, step: PathStep) -> float:
        """Return how far the control point has gone from the last step to this one, m."""
        return self.control.between(self.poses[-1], step.state.poses, _standing(self.model, step))

    def jumps(self) -> list[str]:
        """Return in words which steps are no equilibria, see `StonePath.jumps`."""
        jump = [misfit > PATH.credible for _, _, misfit in self.proofs]
        edges = np.flatnonzero(np.diff([False, *jump, False]))
        said = []
        for first, end in edges.reshape(-1, 2):
            steps = f"step {first + 1} is no equilibrium" if end == first + 1 else f"steps {first + 1} to {end} are no equilibria"
            place = f"{1e3 * self.displacement[first]:.3g} mm"
            said.append(f"{steps}: from {place} on the structure jumps, or stones of it hang, with forces across open gaps")
        others = edges.reshape(-1, 2)[_FEW_JUMPS:]
        if len(others) > 1:
            count, place = int(np.diff(others).sum()), f"{1e3 * self.displacement[others[0, 0]]:.3g} mm"
            return [*said[:_FEW_JUMPS], f"from {place} on {count} more steps, in {len(others)} places, are no equilibria, either"]
        return said

    def _steady(self, velocity: FloatArray) -> bool:
        """Return whether the motion (nb, 6) at the end of a step is that of the step, as in `path.onward`.

        Where it is another one, as when what slid begins to rock, the power at the end tells nothing of the step.
        """
        if self.velocity is None:
            return True
        change, speed = (stone_speed(self.model.stones, each).max() for each in (velocity - self.velocity, velocity))
        return bool(change < PATH.steady * speed)

    @abstractmethod
    def reached(self) -> Ending | None:
        """Return how the path ends with the steps so far, None where it goes on."""

    def go_on_from(self, path: StonePath, displacement: FloatArray, load_factor: FloatArray, *, halo: bool) -> PathState:
        """Take over the steps of a path, and return the state from which to go on.

        It is that after the last step, as if the path had not been interrupted. Where the motion of that step is not known, or
        another end is asked for, it is that of the last step, which is left out here and solved again. halo: whether stones are
        held at all; where it is not known which of them the last step held, those that have moved are held no more. Raises
        InputError where the path is that of other stones, or of another load, strength or ties.
        """
        path.check_of(f"{self.where}: resume", self.model.stones, "steps")
        count, last = self.model.stones.count, len(path.position) - 1
        check_given(self.where, path.given, self.given)
        moved = (path.position[-1] != path.position[0]) | (path.rotation[-1] != path.rotation[0])
        held = path.last.held if halo and len(path.last.held) == count else self.model.held & ~moved.any(axis=1)
        model = self.model = replace(self.model, held=held)
        self.resumed = f"continued from step {last}"
        every = [Poses(centroid, screw(rotation)[0]) for centroid, rotation in zip(path.position, path.rotation, strict=True)]
        self.poses, self.displacement, self.load_factor = list(every), displacement.tolist(), load_factor.tolist()
        self.largest, self.work = path.largest.tolist(), path.dissipation.tolist()
        proofs = path.residual, path.violation, path.misfit
        self.proofs = [(float(a), float(b), float(c)) for a, b, c in zip(*proofs, strict=True)]
        self.fallen = list(path.fallen)
        state = gone_on(state_at(model, every, path.fallen), path.last, model.reach)
        state = replace(state, load_factor=self.load_factor[-1], first=abs(self.load_factor[0]))
        if len(path.last.velocity) == count and self.reached() is None:
            self.friction_power, self.velocity = path.last.power, path.last.velocity
            led = partial(onward, model, state, path.last.velocity, path.last.onward, self.proofs[-1][2])
            self.departure = Departure(model, path.last.onward, led, self.proofs[-1][2] < PATH.fits)
            return led(self.left)
        for each in (self.poses, self.displacement, self.load_factor, self.largest, self.work, self.proofs):
            each.pop()
        self.work_known = float(path.dissipation[last])
        return state

    @abstractmethod
    def drops(self, step: PathStep, /) -> bool:
        """True where something is lost on the way to a step, and the place is to be known better."""

    def fall(self, step: PathStep) -> None:
        """Note the stones that fall in a step."""
        at = self.displacement[-1] if self.displacement else 0.0
        self.fallen.append(FallenStones(at, np.flatnonzero(step.falling), max(len(self.displacement) - 1, 0)))

    def arrays(self) -> StepArrays:
        """Return the arrays that all paths have: where the stones are at each step, and what proves it."""
        residual, violation, misfit = np.array(self.proofs).reshape(-1, 3).T
        count = self.model.stones.count
        return StepArrays(
            position=np.array([pose.centroid for pose in self.poses]).reshape(-1, count, 3),
            rotation=np.array([rotation_vectors(pose.rotation) for pose in self.poses]).reshape(-1, count, 3),
            largest=np.array(self.largest),
            residual=residual,
            violation=violation,
            misfit=misfit,
            dissipation=np.array(self.work),
            last=LastStep() if self.step is None else last_step(self.step, self.friction_power),
            given=self.given,
        )


def _standing(model: MovingModel, step: PathStep) -> BoolArray:
    """Return which stones (nb,) stand at a step: neither fallen nor fixed."""
    return ~step.state.fallen & ~model.stones.fixed


def vanished(load_factor: Sequence[float], misfit: float, nothing: float) -> bool:
    """Return whether a curve ends because it has no load factor left.

    misfit: of the last step, over its load factor. The forces of a step that is no equilibrium act across open gaps, and the next
    may stand higher again: two in a row end the curve. nothing: a load factor that the balance cannot tell from zero.
    """
    if load_factor[-1] > nothing:
        return False
    return misfit <= PATH.credible or (len(load_factor) > 1 and load_factor[-2] <= nothing)
