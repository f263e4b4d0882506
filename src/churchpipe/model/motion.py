"""Motions of rigid stones."""

import numpy as np

from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage


def velocity_at(stones: Assemblage, velocities: FloatArray, stone: IntArray, point: FloatArray) -> FloatArray:
    """Return the velocities (n, 3) at points (n, 3) m of some stones (n,), whose motion is velocities (nb, 6)."""
    motion = velocities[stone]
    return motion[:, :3] + np.cross(motion[:, 3:], point - stones.centroid[stone])
