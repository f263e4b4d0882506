"""Voids in stones, told by the faces that look the other way."""

import numpy as np
import pytest

from churchpipe.geometry.hollows import with_voids
from churchpipe.model.arrays import FloatArray
from dxf_models import box

Faces = list[tuple[int, ...]]


def body(*cubes: tuple[float, float, int]) -> tuple[FloatArray, Faces, list[list[int]]]:
    """Cubes about the origin by place along x, size, and 1 where their faces look outwards, -1 inwards; the parts are theirs."""
    points, faces = np.zeros((0, 3)), Faces()
    for along, size, way in cubes:
        corners, sides = box((along - size / 2, -size / 2, -size / 2), (size, size, size))
        faces += [tuple(len(points) + node for node in side[::way]) for side in sides]
        points = np.concatenate([points, corners])
    return points, faces, [[*range(6 * k, 6 * k + 6)] for k in range(len(cubes))]


@pytest.mark.parametrize(
    ("cubes", "stones"),
    [
        ([(0, 3, 1), (0, 1, -1)], [[0, 1]]),
        # A file whose faces all look inwards.
        ([(0, 3, -1), (0, 1, 1)], [[0, 1]]),
        # In the void lies a stone, and in that a void.
        ([(0, 1, -1), (0, 4, 1), (0, 3, -1), (0, 2, 1)], [[0, 3], [1, 2]]),
        ([(0, 3, 1), (-0.8, 1, -1), (0.8, 1, -1), (5, 1, 1)], [[0, 1, 2], [3]]),
        # Two stones in one place, as another check says; two that touch; one inside out beside another.
        ([(0, 3, 1), (0, 1, 1)], [[0], [1]]),
        ([(0, 1, 1), (1, 1, -1)], [[0], [1]]),
        ([(0, 1, 1), (3, 1, -1)], [[0], [1]]),
    ],
)
def test_parts_that_look_the_other_way_within_a_stone_are_its_voids(
    cubes: list[tuple[float, float, int]], stones: list[list[int]]
) -> None:
    points, faces, parts = body(*cubes)
    assert with_voids(points, faces, parts) == [sorted(k for number in stone for k in parts[number]) for stone in stones]
