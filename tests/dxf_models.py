"""Small assemblages and drawings shared by the tests of the DXF reader and writer."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np

from churchpipe.dxf.writer import write_dxf
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.materials import Material

BOX_FACES = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
STONE = Material("stone", 18e3, 0.6)


def box(origin: tuple[float, float, float], size: tuple[float, float, float]) -> tuple[np.ndarray, tuple[tuple[int, ...], ...]]:
    unit = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)], dtype=float)
    return np.array(origin) + unit * np.array(size), BOX_FACES


def prism(outline: np.ndarray, depth: float) -> tuple[np.ndarray, tuple[tuple[int, ...], ...]]:
    """A counter-clockwise outline in the x-y plane, extruded along z."""
    count = len(outline)
    points = np.column_stack([np.tile(outline, (2, 1)), np.repeat([0.0, depth], count)])
    sides = tuple((i, (i + 1) % count, (i + 1) % count + count, i + count) for i in range(count))
    return points, (tuple(range(count))[::-1], tuple(range(count, 2 * count)), *sides)


def wedge_and_ground() -> Assemblage:
    """Ground plate and one stone without any symmetry: a prism over the triangle (0, 0), (0.6, 0), (0, 0.3), 0.2 m high."""
    return Assemblage.from_polyhedra(
        [box((-2, -2, -0.1), (4, 4, 0.1)), prism(np.array([(0, 0), (0.6, 0), (0, 0.3)], dtype=float), 0.2)],
        18e3,
        fixed=[0],
        material="stone",
        block_id=["ground", "wedge"],
    )


def edited(path: Path, edit: Callable[[Any], None], stones: Assemblage | None = None) -> Path:
    """Write a drawing, change it with ezdxf, save it again."""
    write_dxf(stones or wedge_and_ground(), path, materials=[STONE])
    document = ezdxf.readfile(path)
    edit(document)
    document.saveas(path)
    return path


def assert_same(read: Assemblage, written: Assemblage) -> None:
    """Equal arrays, points to 1e-12 m."""
    for name in (
        "face_nodes",
        "face_ptr",
        "block_face_ptr",
        "block_point_ptr",
        "material",
        "panel",
        "course",
        "fixed",
        "block_id",
    ):
        np.testing.assert_array_equal(getattr(read, name), getattr(written, name), err_msg=name)
    np.testing.assert_allclose(read.points, written.points, rtol=0, atol=1e-12)
    np.testing.assert_allclose(read.centroid, written.centroid, rtol=0, atol=1e-11)
    free = ~written.fixed
    np.testing.assert_allclose(read.unit_weight[free], written.unit_weight[free], rtol=1e-15)
