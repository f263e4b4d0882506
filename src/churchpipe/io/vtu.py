"""Stones for ParaView."""

from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from churchpipe.errors import Extra
from churchpipe.io.atomic import replacing
from churchpipe.model.arrays import BoolArray, IntArray, NameArray
from churchpipe.model.assemblage import Assemblage


def write_vtu(
    path: str | Path, stones: Assemblage, velocities: npt.ArrayLike | None = None, fallen: BoolArray | None = None
) -> None:
    """Write the stones as polyhedral cells, with the data of `stones_mesh` and `name`, `panel_name`, `material_name`.

    velocities (nb, 6): point data `velocity` (warp by it to see the mechanism), cell data `speed` of the centroid. fallen (nb,):
    cell data of that name, 1 of stones that have fallen.
    """
    mesh, order = _mesh(stones, velocities, fallen)
    names = {"name": stones.block_id, "panel_name": stones.panel, "material_name": stones.material}
    write_named(path, mesh, {key: values[order] for key, values in names.items()})


def write_named(path: str | Path, mesh: Any, names: Mapping[str, NameArray]) -> None:
    """Write a `meshio.Mesh` as a .vtu file with texts of its cells, by the name of the array: meshio writes numbers alone."""
    with replacing(path) as part:
        mesh.write(part, file_format="vtu")
        texts = "".join(_texts(name, values) for name, values in names.items())
        before, end, after = part.read_text(encoding="utf-8").rpartition("</CellData>")
        part.write_text(before + texts + end + after, encoding="utf-8")


def _texts(name: str, values: NameArray) -> str:
    # A text is its bytes and a zero; most texts come several times.
    listed = values.tolist()
    coded = {value: " ".join(map(str, (*value.encode(), 0))) for value in set(listed)}
    codes = " ".join(map(coded.__getitem__, listed))
    return f'<DataArray type="String" Name="{name}" format="ascii">{codes}</DataArray>\n'


def stones_mesh(stones: Assemblage) -> Any:
    """Return the stones as polyhedral cells of a `meshio.Mesh`.

    Cell data: `stone` (index), `fixed`, `course`, `panel` and `material` (numbers in alphabetical order of the names),
    `unit_weight` N/m3.
    """
    return _mesh(stones, None)[0]


def _mesh(stones: Assemblage, velocities: npt.ArrayLike | None, fallen: BoolArray | None = None) -> tuple[Any, IntArray]:
    """Return the mesh of the stones, and the stones in the order of its cells."""
    with Extra("a file for ParaView"):
        import meshio

    owner = np.repeat(np.arange(stones.count), np.diff(stones.block_point_ptr))
    cell_data: dict[str, npt.NDArray[Any]] = {
        "stone": np.arange(stones.count),
        "fixed": stones.fixed.astype(np.int64),
        "course": stones.course,
        "panel": np.unique(stones.panel, return_inverse=True)[1].astype(np.int64),
        "material": np.unique(stones.material, return_inverse=True)[1].astype(np.int64),
        "unit_weight": stones.unit_weight,
    }
    if fallen is not None:
        cell_data["fallen"] = fallen.astype(np.int64)
    point_data: dict[str, Any] = {}
    if velocities is not None:
        motion = np.nan_to_num(np.asarray(velocities, dtype=float))
        arm = stones.points - stones.centroid[owner]
        point_data["velocity"] = motion[owner, :3] + np.cross(motion[owner, 3:], arm)
        cell_data["speed"] = np.linalg.norm(motion[:, :3], axis=1)
    blocks, order = _cells(stones)
    split = np.cumsum([len(cells) for _, cells in blocks])[:-1]
    cells: dict[str, Any] = {name: [*np.split(values[order], split)] for name, values in cell_data.items()}
    return meshio.Mesh(stones.points, blocks, point_data=point_data, cell_data=cells), order


def _cells(stones: Assemblage) -> tuple[list[Any], IntArray]:
    """Return cell blocks by number of points, as meshio wants polyhedra, and the stones in that order."""
    # Of so many parts, slices take a third of the time of np.split.
    faces = [stones.face_nodes[first:last] for first, last in pairwise(stones.face_ptr.tolist())]
    sizes = np.diff(stones.block_point_ptr)
    order = np.argsort(sizes, kind="stable")
    blocks = []
    for size in np.unique(sizes):
        members = order[sizes[order] == size]
        blocks.append((f"polyhedron{size}", [faces[stones.block_face_ptr[i] : stones.block_face_ptr[i + 1]] for i in members]))
    return blocks, order
