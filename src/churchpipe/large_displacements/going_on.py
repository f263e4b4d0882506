"""What the last step of a path leaves to the next, so that a path that was interrupted goes on as it would have."""

from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from churchpipe.large_displacements.path import PathStep
from churchpipe.large_displacements.path_state import PathState
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.stone_path import LastStep

# Points nearer to each other than this share of the reach of joints are the same ones.
SAME = 1e-6


def last_step(step: PathStep, power: float) -> LastStep:
    """Return what a step leaves to the next one; power: N m per unit of work, what friction takes."""
    state, joints = step.state, step.state.joints
    contacts, _ = joints.at(state.poses)
    return LastStep(
        pair=joints.pair,
        point=contacts.point,
        pressing=joints.pressing,
        shear=joints.shear,
        sliding=joints.sliding,
        before=np.zeros((0, 6)) if state.before is None else state.before,
        way=state.way,
        length=state.length,
        fastest=state.fastest,
        velocity=step.velocity,
        onward=step.way,
        power=power,
        held=step.held,
    )


def gone_on(state: PathState, last: LastStep, near: float) -> PathState:
    """Return a state with the forces and the motion of the last step; near: m, how far its points may lie from those here."""
    if not len(last.pair):
        return state
    joints = state.joints
    point = joints.at(state.poses)[0].point
    origin, known = _origin(last, joints.pair, point, near)
    share = np.where(known, 1.0 / np.maximum(np.bincount(origin[known], minlength=len(last.pair)), 1)[origin], 0.0)
    joints = replace(
        joints,
        pressing=share * last.pressing[origin],
        shear=share[:, None] * last.shear[origin],
        sliding=np.where(known, last.sliding[origin], 0.0),
    )
    before = last.before if len(last.before) else None
    return replace(state, joints=joints, before=before, way=last.way, length=last.length, fastest=last.fastest)


def _origin(last: LastStep, pair: IntArray, point: FloatArray, near: float) -> tuple[IntArray, BoolArray]:
    """Return the point of the last step that each point (nc, 3) between a pair of stones (nc, 2) is, and whether there is one."""
    if np.array_equal(last.pair, pair) and float(np.abs(last.point - point).max()) < SAME * near:
        # Two points of a pair may lie at one place, which the nearest one would not tell apart.
        return np.arange(len(pair)), np.ones(len(pair), dtype=bool)
    _, ours = np.unique(np.concatenate([last.pair, pair]), axis=0, return_inverse=True)
    # A fourth coordinate holds points of different pairs apart.
    apart = 4.0 * near * ours.reshape(-1)
    tree = cKDTree(np.column_stack([last.point, apart[: len(last.pair)]]))
    distance, origin = tree.query(np.column_stack([point, apart[len(last.pair) :]]))
    known = np.asarray(distance <= near)
    return np.where(known, origin, 0), known
