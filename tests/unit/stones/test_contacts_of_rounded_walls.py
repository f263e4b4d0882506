"""Joints of walls that meet, in coordinates rounded to a millimetre."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import churchpipe as cp
from churchpipe.generators import house, prototype
from churchpipe.stones.blocks import derive_blocks
from solids import moved

LAID = {"brick": (0.5, 0.25, 0.25), "partitions_x": [2.0], "partition_length": 3.0, "courses": 4, "main_wall_length": 4.0}


@pytest.mark.parametrize("degrees", [17.0, 33.0, 61.0])
def test_no_joint_is_lost_and_none_is_made_by_rounding(degrees: float) -> None:
    """At 17 degrees the stones of the main wall reach a quarter of a millimetre under those of the wall that crosses it."""
    exact = derive_blocks(prototype(**LAID))
    rotation = Rotation.from_euler("z", degrees, degrees=True).as_matrix()
    rounded = moved(exact, rotation, np.array([43.21, -17.6, 0.0]))
    rounded = replace(rounded, points=np.round(rounded.points, 3))
    known, found = (set(map(tuple, np.sort(cp.find_contacts(stones).blocks, axis=1).tolist())) for stones in (exact, rounded))
    assert found == known


def test_a_joint_of_a_hundredth_of_a_metre_is_none_the_less_one() -> None:
    """A stone butts against the face of another with a centimetre of its end, too little to tell of the gaps of the drawing.

    Such are joints at the corners of toothed walls. The gap that rounding leaves there is closed, since the stones tell how far
    their corners are off.
    """
    walls = [
        {"name": "s", "start": (0, 0), "end": (7.1, 0), "toward": "+y"},
        {"name": "e", "start": (7.1, 0), "end": (7.1, 4.3), "toward": "-x"},
    ]
    laid = {"course": 0.22, "stone_length": 0.45, "height": 0.88, "thickness": 0.36, "joints": "grid"}
    exact = derive_blocks(house(**laid, walls=walls))
    rotation = Rotation.from_euler("z", 128.4, degrees=True).as_matrix()
    rounded = moved(exact, rotation, np.array([43.21, -17.6, 0.0]))
    rounded = replace(rounded, points=np.round(rounded.points, 3))
    known, found = (set(map(tuple, np.sort(cp.find_contacts(stones).blocks, axis=1).tolist())) for stones in (exact, rounded))
    assert found == known
