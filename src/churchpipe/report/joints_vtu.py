"""The joints of the stones for ParaView: forces, openings and slips of an analysis."""

from pathlib import Path
from typing import Any

import numpy as np

from churchpipe.errors import Extra
from churchpipe.io.vtu import write_named
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.model.results import LimitState
from churchpipe.report.motion import corner_rates
from churchpipe.report.shell_view import joint_order
from churchpipe.report.viewer import joint_values


def write_joints(path: Path, stones: Assemblage, contacts: Contacts, state: LimitState) -> None:
    """Write the interfaces as polygons.

    Cell data: `normal_force` and `shear_force` N (resultants), `opening` and `slip` (the largest rates of its corners), `area`
    m2, `normal` (from the first stone to the second), and the texts `kind`, `first` and `second` (names of the stones). Point
    data: `force` N (vector, on the second stone; zero where the analysis has none) and `opening` (rate) of the contact points.
    """
    with Extra("a file for ParaView"):
        import meshio

    order = joint_order(contacts)
    frame = contacts.frame[contacts.interface_of_point]
    forces = state.forces if len(state.forces) == len(contacts.point) else np.zeros((len(contacts.point), 3))
    rates = corner_rates(contacts, stones, np.nan_to_num(state.velocities))
    sizes = np.diff(contacts.point_ptr)
    # meshio keeps polygons of one number of corners together.
    rank = np.argsort(sizes, kind="stable")
    corners = [order[contacts.point_ptr[i] : contacts.point_ptr[i + 1]] for i in rank]
    blocks: list[Any] = [("polygon", [corners[k] for k in np.flatnonzero(sizes[rank] == size)]) for size in np.unique(sizes)]
    split = np.cumsum([len(cells) for _, cells in blocks])[:-1]
    normal, shear, opening, slip = joint_values(stones, contacts, state).T
    values: dict[str, Any] = {
        "normal_force": normal,
        "shear_force": shear,
        "opening": opening,
        "slip": slip,
        "area": contacts.area,
    }
    values |= {"normal": contacts.frame[:, 0]}
    cell_data: dict[str, Any] = {key: np.split(part[rank], split) for key, part in values.items()}
    mesh = meshio.Mesh(
        contacts.point,
        blocks,
        point_data={"force": np.einsum("pa,pac->pc", forces, frame), "opening": rates[:, 0]},
        cell_data=cell_data,
    )
    first, second = (stones.block_id[side][rank] for side in contacts.blocks.T)
    write_named(path, mesh, {"kind": contacts.kind[rank], "first": first, "second": second})
