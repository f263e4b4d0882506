"""Joints of walls that meet, in coordinates rounded to a millimetre."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import churchpipe as cp
from churchpipe.generators import prototype
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
