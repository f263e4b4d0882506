from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from churchpipe.errors import InputError
from churchpipe.model.shell import ShellModel
from shell_meshes import grid, shell, wall_points


@pytest.fixture
def wall() -> ShellModel:
    points, triangles = grid(2, 1, 1.0, 0.5)
    return shell(wall_points(points), triangles, surface_weight=1144.0, supported=lambda p: p[:, 2] < 1e-9)


def test_area_and_weight(wall: ShellModel) -> None:
    assert wall.area.sum() == pytest.approx(0.5)
    assert wall.weight.sum() == pytest.approx(572.0)
    assert not wall.points.flags.writeable


def changed(wall: ShellModel, key: str, index: Any, value: float) -> np.ndarray:
    array = np.array(getattr(wall, key))
    array[index] = value
    return array


@pytest.mark.parametrize(
    ("key", "index", "value", "message"),
    [
        ("thickness", 1, 0.0, "thickness: out of range; found 0.0; expected > 0"),
        ("surface_weight", 0, -1.0, "surface_weight: out of range; found -1.0; expected >= 0"),
        ("unit_cells", (0, 1), 0.0, "unit_cells: out of range"),
        ("cell", 0, 1, "cell: index out of range; found 1"),
        ("triangles", (0, 0), 99, "triangles: index out of range; found 99"),
        ("triangles", (0, 0), 1, "triangles: a triangle has no area; found 0"),
        ("axes", (0, 0), 0.5, "axes: axes are not orthonormal"),
        ("axes", (0, 2), [0.0, 1.0, 0.0], "axes: axes are not orthonormal and right-handed"),
        ("points", (0, 1), 0.01, "axes: the third axis is not normal to its facet"),
        ("points", (0, 1), np.nan, "points: not a finite number"),
    ],
)
def test_what_cannot_be_a_shell_is_named(wall: ShellModel, key: str, index: Any, value: float, message: str) -> None:
    with pytest.raises(InputError) as error:
        replace(wall, **{key: changed(wall, key, index, value)})
    assert f"ShellModel.{message}" in str(error.value)


def test_a_node_without_triangle_is_named(wall: ShellModel) -> None:
    with pytest.raises(InputError, match="a node belongs to no triangle; found 8"):
        replace(
            wall,
            points=np.vstack([wall.points, [[0, 0, 9.0]]]),
            supported=np.append(wall.supported, False),
            bed_normal=np.vstack([wall.bed_normal, np.zeros((1, 3))]),
        )
