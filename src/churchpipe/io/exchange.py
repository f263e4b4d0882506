"""Models and results for other programs: tables (pandas), meshes (meshio), files of arrays."""

from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from churchpipe.errors import Extra, InputError
from churchpipe.io.atomic import named_by_caller
from churchpipe.io.npz import SCHEMAS, Absent, read_any, write_npz
from churchpipe.io.shell_vtu import shell_mesh
from churchpipe.io.vtu import stones_mesh
from churchpipe.model.arguments import check_kind, path_of
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.block_curve import BlockCapacityCurve
from churchpipe.model.contacts import Contacts
from churchpipe.model.results import CapacityCurve
from churchpipe.model.shell import ShellModel


def save(value: Any, path: str | Path) -> None:
    """Write a model or a result to a file of arrays (npz, without pickle), which `load` reads.

    Parameters
    ----------
    value
        Assemblage, Contacts, ShellModel, or a result of an analysis.
    path
        The file, which ends in .npz.

    Raises
    ------
    InputError
        Something else, another ending, a file that cannot be written.
    """
    if type(value) not in SCHEMAS or isinstance(value, Absent):
        expected = ", ".join(sorted(kind.__name__ for kind in SCHEMAS if kind is not Absent))
        raise InputError("save: value", "not a model or a result", found=type(value).__name__, expected=expected)
    if path_of("save: path", path).suffix != ".npz":
        raise InputError(f"save: {path}", "another ending", expected="a name that ends in .npz")
    with named_by_caller("save: path", path):
        write_npz(path, value)


def load(path: str | Path) -> Any:
    """Return the model or the result that `save`, or a run, wrote to a file.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    InputError
        Not such a file, or one of another version.
    """
    return read_any(path)


def to_pandas(value: Assemblage | Contacts | CapacityCurve | BlockCapacityCurve) -> Any:
    """Return a table (pandas.DataFrame): a row a stone, an interface, or a step of a curve. SI units.

    Parameters
    ----------
    value
        The stones, their contacts, or a capacity curve.

    Raises
    ------
    InputError
        Something else; pandas is not installed.
    """
    with Extra("a table of pandas"):
        pd: Any = import_module("pandas")
    axes = "xyz"
    match value:
        case Assemblage():
            columns: dict[str, Any] = {"stone": value.block_id, "panel": value.panel, "course": value.course}
            columns |= {"material": value.material, "fixed": value.fixed, "volume": value.volume, "weight": value.weight}
            columns |= {axes[c]: value.centroid[:, c] for c in range(3)}
        case Contacts():
            columns = {"first": value.blocks[:, 0], "second": value.blocks[:, 1], "kind": value.kind, "area": value.area}
            columns |= {"points": value.points_per_interface}
            columns |= {f"normal_{axes[c]}": value.frame[:, 0, c] for c in range(3)}
        case CapacityCurve():
            columns = {"displacement": value.control, "load_factor": value.load_factor}
        case BlockCapacityCurve():
            columns = {"displacement": value.displacement, "load_factor": value.load_factor, "largest": value.largest}
        case _:
            raise InputError(
                "to_pandas: value", "no table of this", found=type(value).__name__, expected="stones, contacts or a curve"
            )
    return pd.DataFrame({name: np.asarray(column) for name, column in columns.items()})


def to_meshio(model: Assemblage | ShellModel) -> Any:
    """Return a mesh (meshio.Mesh) with the data of its stones or facets: polyhedra of stones, triangles of a shell.

    Parameters
    ----------
    model
        The stones or the shell.

    Raises
    ------
    InputError
        Something else; meshio is not installed.
    """
    check_kind("to_meshio: model", model, Assemblage, ShellModel)
    return stones_mesh(model) if isinstance(model, Assemblage) else shell_mesh(model)
