"""Joints in the balance of rigid blocks that crush where they are pressed: five more points and nine more rows each."""

from dataclasses import replace

import numpy as np

from churchpipe.conic.pressed import CORNERS, POINTS, pressed_joints
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.rigid_blocks.certificate import Strength
from churchpipe.rigid_blocks.equilibrium import Equilibrium


def with_pressed(balance: Equilibrium, strength: Strength, first: IntArray, capacity: FloatArray) -> tuple[Equilibrium, Strength]:
    """Return balance and strength with the cones of joints that crush (nj,), after contact points and ties.

    first (nj,): the first of the four points of each, its corners in order; capacity (nj,): area times strength, in the unit of
    force. The unit S of `conic.pressed` is the mean of the weight over these joints.
    """
    count = len(first)
    if not count:
        return balance, strength
    joints = pressed_joints(first[:, None] + np.arange(CORNERS), capacity, 1.0 / count, balance.points)
    further = np.zeros(POINTS * count)
    pressed = replace(
        balance,
        pressed=joints,
        dead=np.concatenate([balance.dead, joints.constant]),
        live=np.concatenate([balance.live, np.zeros_like(joints.constant)]),
    )
    values = ((strength.friction, further + 1.0), (strength.cohesion, further), (strength.bound, further + np.inf))
    return pressed, Strength(*(np.concatenate(pair) for pair in values))
