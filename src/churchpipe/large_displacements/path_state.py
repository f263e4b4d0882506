"""Where a path has got to, and the stones as they stand there."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from churchpipe.large_displacements.joints import Joints
from churchpipe.large_displacements.moving_model import MovingModel, bearing
from churchpipe.large_displacements.poses import Poses, displaced, start_poses
from churchpipe.large_displacements.renewal import renewed
from churchpipe.model.arrays import BoolArray, FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.stone_path import FallenStones


@dataclass(frozen=True, slots=True)
class PathState:
    """Where a path has got to: poses, joints, which stones have fallen (nb,), length of the step, m per unit of work.

    fastest: `falling.usual_speed` of the last step whose motion was credible. before (nb, 6): velocities of the last step at the
    origin, None as drawn; way (m per unit of work): how far it went; load_factor: its own. rest (nt,) m: what ties have been
    pulled to. first: the first load factor of the path, 0 before it is known.
    """

    poses: Poses
    joints: Joints
    fallen: BoolArray
    length: float
    fastest: float = np.inf
    before: FloatArray | None = None
    way: float = 0.0
    load_factor: float = 0.0
    rest: FloatArray = field(default_factory=lambda: np.zeros(0))
    first: float = 0.0

    @property
    def tangents(self) -> FloatArray:
        """The tangents t1, t2 of each point: k point, a which of them, c axis of the drawing."""
        return self.joints.at(self.poses)[0].frame[self.joints.interface, 1:]


def first_state(model: MovingModel) -> PathState:
    """Return the state as drawn."""
    still = model.stones.fixed | model.held
    joints = model.drawn.selected(bearing(still, model.drawn.blocks))
    none = np.zeros(len(still), dtype=bool)
    return PathState(start_poses(model.stones), joints, none, model.step, rest=model.ties.first_rest)


def state_at(model: MovingModel, every: Sequence[Poses], fallen: Sequence[FallenStones]) -> PathState:
    """Return the state at the last of all poses of a path so far, without the stones that have fallen: to go on from there.

    The stones are taken through all poses: which of them came to bear on each other, and how deep they may have sunk in, is not
    told by the last one. What the joints slid by and how fast the stones were is not known any more: the next program finds it.
    """
    gone = np.zeros(model.stones.count, dtype=bool)
    for part in fallen:
        gone[part.stones] = True
    state = replace(first_state(model), fallen=gone)
    for poses in every:
        state = renewed_state(model, replace(state, poses=poses))
    return state


def renewed_state(model: MovingModel, state: PathState) -> PathState:
    """Return the state with its contacts found anew where its stones are, and what its ties have been pulled to."""
    stones = standing(model, state)
    crushing = model.strength is not None
    joints = renewed(state.joints, stones, state.poses, state.fallen, model.reach, model.rest, crushing=crushing)
    return replace(state, joints=joints, rest=model.ties.yielded(state.rest, state.poses))


def last_motion(state: PathState) -> FloatArray:
    """Return the velocities (nb, 6) of the last step, at the centroids where the stones are now; zero as drawn."""
    if state.before is None:
        return np.zeros((len(state.fallen), 6))
    velocity = state.before.copy()
    velocity[:, :3] += np.cross(velocity[:, 3:], state.poses.centroid)
    return velocity


def standing(model: MovingModel, state: PathState) -> Assemblage:
    """Return the stones where they are, with those that are held or have fallen as fixed ones."""
    return displaced(model.stones, state.poses, model.stones.fixed | model.held | state.fallen)
