"""Triangles without an area that programs leave in a mesh: they close nothing, and hide where one body ends."""

from collections import Counter
from collections.abc import Sequence

import numpy as np

from churchpipe.geometry.mending import NEARLY, Face
from churchpipe.model.arrays import FloatArray
from churchpipe.model.surfaces import edges


def degenerate(points: FloatArray, faces: Sequence[Face]) -> list[int]:
    """Return the numbers of triangles on a line that no surface needs.

    One with two corners at one place is an edge of other faces. One with three closes a gap between a long edge and the two
    halves of it beside that edge; where its edges belong to an odd number of faces, that is no gap, and all of them are even
    without it.

    Parameters
    ----------
    points: (n, 3). faces: of three vertices or more, indices below n.
    """
    numbers = np.array([number for number, face in enumerate(faces) if len(face) == 3], dtype=np.int64)
    if not len(numbers):
        return []
    corner = points[np.array([faces[number] for number in numbers.tolist()], dtype=np.int64)]
    side = np.roll(corner, -1, axis=1) - corner
    length = np.linalg.norm(side, axis=2)
    longest = length.max(axis=1)
    height = np.linalg.norm(np.cross(side[:, 0], side[:, 1]), axis=1) / np.where(longest > 0, longest, 1.0)
    thin = numbers[height <= NEARLY * longest].tolist()
    if not thin:
        return []
    place = np.unique(points + 0.0, axis=0, return_inverse=True)[1].ravel().tolist()
    around = [[(min(place[a], place[b]), max(place[a], place[b])) for a, b in edges(face)] for face in faces]
    uses = Counter(edge for own in around for edge in own)

    def needless(own: list[tuple[int, int]]) -> bool:
        sides = {edge for edge in own if edge[0] != edge[1]}
        # What is at one place, or touches nothing, is for those to judge who look for bodies.
        if len(sides) == 1:
            return uses[sides.pop()] > 2
        return len(sides) == 3 and all(uses[edge] % 2 for edge in sides) and any(uses[edge] > 1 for edge in sides)

    return [number for number in thin if needless(around[number])]
