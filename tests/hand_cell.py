"""The unit cell of running bond derived by hand, to check the cell that is computed from its stones.

A block of length b and height a in a wall of thickness h meets one neighbour across a head joint and two across half bed joints.
The other three joints are periodic images of these. With x the place of a block in the wall, blocks are displaced like the plate:
translations E x and -1/2 x chi x, rotations chi x, and one rotation omega that all blocks share.
"""

from typing import Any

import numpy as np

from churchpipe.homogenised_shell.cell_limit import CellLimit, cell_limit
from churchpipe.homogenised_shell.rigid_cell import rigid_cell


def openings(a: float, b: float, h: float, motion: np.ndarray) -> np.ndarray:
    """Return the openings (12, 3) of the corners, normal first, under six strains and omega: one corner at a time, in 3-D."""
    e11, e22, g12, k11, k22, k12, *omega = motion
    strain = np.array([[e11, g12 / 2, 0], [g12 / 2, e22, 0], [0, 0, 0]])
    bend = np.array([[k11, k12 / 2, 0], [k12 / 2, k22, 0], [0, 0, 0]])
    joints = [((b, 0), 0, [(b / 2, -a / 2), (b / 2, a / 2)])]
    joints += [((b / 2, a), 1, [(0, a / 2), (b / 2, a / 2)]), ((-b / 2, a), 1, [(-b / 2, a / 2), (0, a / 2)])]
    out = []
    for neighbour, normal, corners in joints:
        v = np.array([*neighbour, 0.0])
        turn = np.array([-(bend @ v)[1], (bend @ v)[0], 0.0]) + omega
        for corner in corners:
            for depth in (-h / 2, h / 2):
                y = np.array([*corner, depth])
                there = strain @ v + [0, 0, -v @ bend @ v / 2] + np.cross(turn, y - v)
                out.append((there - np.cross(omega, y))[[normal, 1 - normal, 2]])
    return np.array(out)


def hand_closing(a: float, b: float, h: float) -> np.ndarray:
    """Return the closing (12, 3, 9) of the corners per area of wall for each strain and rotation, as of `rigid_cell`."""
    return -np.stack([openings(a, b, h, unit) for unit in np.eye(9)], axis=-1) / (a * b)


def running_limit(a: float, b: float, h: float, friction: float, direction: Any, **more: Any) -> CellLimit:
    """Return the limit of running bond, its cell computed from its stones."""
    return cell_limit(rigid_cell("running", a, b, h).closing, friction, h, direction, **more)
