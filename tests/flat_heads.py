"""Walls with an opening whose head is flat and has no lintel, for tests and `benchmarks/lintels.py`."""

from itertools import pairwise

import numpy as np

import churchpipe as cp

COURSE, STONE, THICKNESS = 0.25, 0.5, 0.5
_CORNERS = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
_FACES = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))


def flat_headed_wall(top: float, width: float = 1.5, length: float = 5.0) -> tuple[cp.Assemblage, cp.Contacts]:
    """A wall of courses of .25 m in running bond, its opening in the middle between 1 and 2 m of height; m."""
    boxes = [(-1.0, length + 1.0, -COURSE)]
    left, right = 0.5 * (length - width), 0.5 * (length + width)
    for course in range(round(top / COURSE)):
        low = COURSE * course
        joints = np.arange(STONE * (0.5 if course % 2 == 0 else 1.0), length - 1e-6, STONE)
        ends = [0.0, *joints.tolist(), length]
        cut = 1.0 - 1e-6 < low < 2.0 - 1e-6
        for begin, end in pairwise(ends):
            spans = [(begin, min(end, left)), (max(begin, right), end)] if cut else [(begin, end)]
            boxes += [(a, b, low) for a, b in spans if b - a > 1e-6]
    solids = [([(a + x * (b - a), THICKNESS * y, low + COURSE * z) for x, y, z in _CORNERS], _FACES) for a, b, low in boxes]
    stones = cp.Assemblage.from_polyhedra(solids, 20e3, fixed=[0])
    return stones, cp.find_contacts(stones)
