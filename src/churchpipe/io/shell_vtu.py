"""The shell for ParaView and for Gmsh."""

from collections.abc import Container, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from churchpipe.errors import Extra
from churchpipe.io.atomic import replacing
from churchpipe.io.vtu import write_named
from churchpipe.model.results import CapacityCurve, ShellLimitState
from churchpipe.model.shell import ShellModel


def write_shell_mechanism(path: str | Path, shell: ShellModel, state: ShellLimitState | CapacityCurve) -> None:
    """Write the facets with the motion and the plastic strain of an analysis: velocities of a mechanism, also of a shell that
    falls under its dead load, or displacements, m, at the last step of a curve."""
    moved = state.velocities if isinstance(state, ShellLimitState) else state.displacement
    real = isinstance(state, CapacityCurve) and state.status != "unstable"
    motion = {"displacement" if real else "velocity": moved}
    strain = {"plastic_membrane": state.plastic[:, :3], "plastic_curvature": state.plastic[:, 3:]}
    _write(path, shell, motion, strain)


def write_shell_vtu(path: str | Path, shell: ShellModel) -> None:
    """Write the facets as triangles.

    Cell data: `bed` and `up` (vectors along the bed joint and up the courses), `normal`, `thickness` m, `surface_weight` N/m2,
    `course_height` and `stone_length` m, `yields`, `panel` and `material` (numbers in alphabetical order of the names),
    `panel_name` and `material_name`; point data: `supported`.
    """
    _write(path, shell, {}, {})


def _write(path: str | Path, shell: ShellModel, of_nodes: Mapping[str, Any], of_facets: Mapping[str, Any]) -> None:
    point_data, cell_data = _data(shell)
    mesh = _mesh(shell, point_data | dict(of_nodes), cell_data | dict(of_facets))
    write_named(path, mesh, {"panel_name": shell.panel, "material_name": shell.material})


def write_shell_msh(path: str | Path, shell: ShellModel) -> None:
    """Write the facets for Gmsh (format 2.2): a physical surface a panel, the data of `write_shell_vtu` as views.

    Names have an apostrophe in the place of a double quote, which would end them.
    """
    with Extra("a file for ParaView or Gmsh"):
        import meshio

    point_data, cell_data = _data(shell)
    panels, number = np.unique(shell.panel, return_inverse=True)
    group = (number + 1).astype(np.int32)
    mesh = _mesh(shell, point_data, cell_data | {"gmsh:physical": group, "gmsh:geometrical": group})
    for row, name in enumerate(panels):
        mesh.field_data[_quoted(str(name), mesh.field_data)] = np.array([row + 1, 2])
    with replacing(path) as part:
        # Binary: meshio's text form spells NumPy 2 numbers in a way that no reader takes.
        meshio.gmsh.write(part, mesh, fmt_version="2.2", binary=True)


def _quoted(name: str, others: Container[str]) -> str:
    """Return a name as it may stand between double quotes, another one than those given."""
    name = name.replace('"', "'")
    while name in others:
        name += "'"
    return name


def shell_mesh(shell: ShellModel) -> Any:
    """Return the facets as triangles of a `meshio.Mesh`, with the data of `write_shell_vtu`."""
    return _mesh(shell, *_data(shell))


def _data(shell: ShellModel) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return point data and cell data."""
    cell_data: dict[str, Any] = {
        "bed": shell.axes[:, 0],
        "up": shell.axes[:, 1],
        "normal": shell.axes[:, 2],
        "thickness": shell.thickness,
        "surface_weight": shell.surface_weight,
        "course_height": shell.unit_cells[shell.cell, 0],
        "stone_length": shell.unit_cells[shell.cell, 1],
        "yields": shell.yields.astype(np.float64),
        "panel": np.unique(shell.panel, return_inverse=True)[1].astype(np.float64),
        "material": np.unique(shell.material, return_inverse=True)[1].astype(np.float64),
    }
    return {"supported": shell.supported.astype(np.float64)}, cell_data


def _mesh(shell: ShellModel, point_data: dict[str, Any], cell_data: dict[str, Any]) -> Any:
    with Extra("a file for ParaView or Gmsh"):
        import meshio

    return meshio.Mesh(
        shell.points,
        [("triangle", shell.triangles)],
        point_data=point_data,
        cell_data={name: [values] for name, values in cell_data.items()},
    )
