"""The steps of a curve as they are taken."""

import numpy as np

from churchpipe.large_displacements.control import Control
from churchpipe.large_displacements.path import MovingModel, PathStep
from churchpipe.large_displacements.poses import Poses, rotation_vectors
from churchpipe.model.block_curve import BlockCapacityCurve, CurveStatus, FallenStones


class Record:
    """The steps of a curve as they are taken."""

    def __init__(self, model: MovingModel, control: Control) -> None:
        self.model, self.control = model, control
        self.poses: list[Poses] = []
        self.proofs: list[tuple[float, float, float, float]] = []
        self.friction_work = 0.0
        self.displacement: list[float] = []
        self.load_factor: list[float] = []
        self.largest: list[float] = []
        self.work: list[float] = []
        self.fallen: list[FallenStones] = []

    def add(self, step: PathStep) -> None:
        """Add a step that was solved."""
        poses, standing = step.state.poses, ~step.state.fallen & ~self.model.stones.fixed
        gone = self.displacement[-1] + self.control.between(self.poses[-1], poses, standing) if self.poses else 0.0
        # The work of a step is done when the next one is reached.
        done = self.work[-1] + self.friction_work if self.work else 0.0
        answer, self.friction_work = step.answer, step.friction_work * self.model.force
        self.poses.append(poses)
        self.proofs.append((answer.residual, answer.violation, answer.bound_gap, answer.gap))
        self.displacement.append(gone)
        self.load_factor.append(answer.load_factor)
        away = np.linalg.norm(poses.centroid - self.model.stones.centroid, axis=1)[standing]
        self.largest.append(float(away.max(initial=0.0)))
        self.work.append(done)

    def fall(self, step: PathStep) -> None:
        """Note the stones that fall in a step."""
        at = self.displacement[-1] if self.displacement else 0.0
        self.fallen.append(FallenStones(at, np.flatnonzero(step.lost)))

    def curve(self, status: CurveStatus, message: str, seconds: float) -> BlockCapacityCurve:
        """Return the curve."""
        residual, violation, bound_gap, gap = np.array(self.proofs).reshape(-1, 4).T
        factor, count = self.load_factor, self.model.stones.count
        d0 = self.displacement[-1] if status == "collapsed" and factor else float("nan")
        if status == "vanished":
            d0 = self.displacement[-1]
            if len(factor) > 1:
                share = factor[-2] / (factor[-2] - factor[-1])
                d0 = self.displacement[-2] + share * (self.displacement[-1] - self.displacement[-2])
        return BlockCapacityCurve(
            displacement=np.array(self.displacement),
            load_factor=np.array(factor),
            largest=np.array(self.largest),
            position=np.array([pose.centroid for pose in self.poses]).reshape(-1, count, 3),
            rotation=np.array([rotation_vectors(pose.rotation) for pose in self.poses]).reshape(-1, count, 3),
            residual=residual,
            violation=violation,
            bound_gap=bound_gap,
            gap=gap,
            dissipation=np.array(self.work),
            status=status,
            d0=d0,
            fallen=tuple(self.fallen),
            message=message,
            seconds=seconds,
        )
