"""The lengths that a path is measured by."""

import numpy as np

from churchpipe.model.arrays import BoolArray
from churchpipe.model.assemblage import Assemblage

# The largest displacement of a step, and how far apart points may be that can still come to bear, over the thinnest side of the
# stones that move.
STEP, REACH = 0.1, 0.2


def thinnest(stones: Assemblage, moving: BoolArray) -> float:
    """Return the median over the moving stones of the least side of their boxes, m."""
    low, high = (edge.reduceat(stones.points, stones.block_point_ptr[:-1], axis=0) for edge in (np.minimum, np.maximum))
    return float(np.median((high - low)[moving].min(axis=1)))
