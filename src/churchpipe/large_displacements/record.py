"""The steps of a path as they are taken."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from churchpipe.large_displacements.control import Control
from churchpipe.large_displacements.moving_model import MovingModel
from churchpipe.large_displacements.path import PathState, PathStep, state_at
from churchpipe.large_displacements.poses import Poses, rotation_vectors, screw
from churchpipe.model.arrays import FloatArray
from churchpipe.model.stone_path import FallenStones, StepArrays, StonePath

Progress = Callable[[str, float], None]


class Record:
    """The steps of a path as they are taken."""

    def __init__(self, model: MovingModel, control: Control) -> None:
        self.model, self.control = model, control
        self.poses: list[Poses] = []
        self.proofs: list[tuple[float, float, float]] = []
        self.friction_power = 0.0
        self.displacement: list[float] = []
        self.load_factor: list[float] = []
        self.largest: list[float] = []
        self.work: list[float] = []
        self.fallen: list[FallenStones] = []

    @property
    def left(self) -> float:
        """How far the path may still go, m per unit of work."""
        return np.inf

    def note(self, step: PathStep) -> None:
        """Take down a step that was solved."""
        poses, standing = step.state.poses, ~step.state.fallen & ~self.model.stones.fixed
        gone = self.displacement[-1] + self.control.between(self.poses[-1], poses, standing) if self.poses else 0.0
        # The work of a step is done when the next one is reached.
        done = self.work[-1] + self.friction_power * step.state.way if self.work else 0.0
        answer, self.friction_power = step.answer, step.friction_power * self.model.force
        self.poses.append(poses)
        self.proofs.append((answer.residual, answer.violation, answer.misfit))
        self.displacement.append(gone)
        self.load_factor.append(answer.load_factor)
        away = np.linalg.norm(poses.centroid - self.model.stones.centroid, axis=1)[standing]
        self.largest.append(float(away.max(initial=0.0)))
        self.work.append(done)

    def go_on_from(self, path: StonePath, displacement: FloatArray, load_factor: FloatArray) -> PathState:
        """Take over the steps of a path but for the last one, and return the state of that, from which to go on."""
        model, last = self.model, len(path.position) - 1
        every = [Poses(centroid, screw(rotation)[0]) for centroid, rotation in zip(path.position, path.rotation, strict=True)]
        self.poses, self.displacement, self.load_factor = every[:last], displacement[:last].tolist(), load_factor[:last].tolist()
        self.largest, self.work = path.largest[:last].tolist(), path.dissipation[:last].tolist()
        proofs = path.residual, path.violation, path.misfit
        self.proofs = [(float(a), float(b), float(c)) for a, b, c in zip(*(array[:last] for array in proofs), strict=True)]
        self.fallen = list(path.fallen)
        # The state goes a way of one unit from the step before, on which friction does the work that the path had kept for it.
        self.friction_power = float(path.dissipation[last] - path.dissipation[last - 1]) if last else 0.0
        return replace(state_at(model, every, path.fallen), way=1.0)

    def fall(self, step: PathStep) -> None:
        """Note the stones that fall in a step."""
        at = self.displacement[-1] if self.displacement else 0.0
        self.fallen.append(FallenStones(at, np.flatnonzero(step.lost)))

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
        )
