"""Joints in the balance of rigid blocks that crush where they are pressed: more points and rows of their own."""

from dataclasses import replace

import numpy as np

from churchpipe.conic.pressed import PressedJoints, pressed_joints
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.rigid_blocks.certificate import Strength
from churchpipe.rigid_blocks.equilibrium import Equilibrium

# Where the corners of a parallelogram lie in it.
_CORNERS = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])


def with_pressed(balance: Equilibrium, strength: Strength, first: IntArray, capacity: FloatArray) -> tuple[Equilibrium, Strength]:
    """Return balance and strength with the cones of joints that crush (nj,), after contact points and ties.

    first (nj,): the first of the four points of each, its corners in order; capacity (nj,): area times strength, in the unit of
    force. The unit S of `conic.pressed` is the mean of the weight over these joints.
    """
    count = len(first)
    if not count:
        return balance, strength
    point = (first[:, None] + np.arange(len(_CORNERS))).ravel()
    joint, place = np.repeat(np.arange(count), len(_CORNERS)), np.tile(_CORNERS, (count, 1))
    joints = pressed_joints(point, joint, place, capacity, 1.0 / count, balance.points)
    pressed = replace(
        balance,
        pressed=joints,
        dead=np.concatenate([balance.dead, joints.constant]),
        live=np.concatenate([balance.live, np.zeros_like(joints.constant)]),
    )
    return pressed, with_further(strength, joints)


def with_further(strength: Strength, joints: PressedJoints) -> Strength:
    """Return the strength of points and of the further points of joints that crush."""
    further = np.zeros(joints.matrix.shape[1] // 3 - len(strength.friction))
    values = ((strength.friction, further + 1.0), (strength.cohesion, further), (strength.bound, further + np.inf))
    return Strength(*(np.concatenate(pair) for pair in values))
