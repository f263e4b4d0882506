"""Stones far thinner than the others: offcuts of a boolean operation, films between faces that nearly meet."""

import numpy as np

from churchpipe.dxf.stones import Stone
from churchpipe.findings import Finding
from churchpipe.geometry.mending import signed_volumes
from churchpipe.model.arrays import FloatArray

# A stone is a sliver whose thickness is below this part of the median one. A mortar bed of 10 mm is a tenth of its stones.
THIN = 0.02


def slivers(stones: list[Stone]) -> list[Finding]:
    """Return a warning for each free stone far thinner than the median; lengths in the unit of the drawing.

    Its thickness is twice its volume over its surface, which is that of a plate.
    """
    free = [stone for stone in stones if not stone.fixed]
    if not free:
        return []
    surface = _surfaces(free)
    volume = np.abs(signed_volumes([(stone.points, stone.faces) for stone in free]))
    thickness = 2.0 * volume / np.maximum(surface, np.finfo(float).tiny)
    usual = float(np.median(thickness))
    return [
        free[index].place.finding("W48", "{} thick, the median stone {}", lengths=(float(thickness[index]), usual))
        for index in np.flatnonzero(thickness < THIN * usual).tolist()
    ]


def _surfaces(stones: list[Stone]) -> FloatArray:
    """Return the area (ns,) of all faces of each stone."""
    corner = np.concatenate([stone.points[[node for face in stone.faces for node in face]] for stone in stones])
    size = np.array([len(face) for stone in stones for face in stone.faces])
    first = np.cumsum(size) - size
    following = np.arange(1, len(corner) + 1)
    following[first + size - 1] = first
    # From a corner of each face, as buildings may stand far from the origin.
    corner = corner - np.repeat(corner[first], size, axis=0)
    area = 0.5 * np.linalg.norm(np.add.reduceat(np.cross(corner, corner[following]), first, axis=0), axis=1)
    faces = np.array([len(stone.faces) for stone in stones])
    return np.add.reduceat(area, np.cumsum(faces) - faces)
