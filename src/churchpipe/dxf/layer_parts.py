"""Vaults and round walls named by the layers or groups of their stones, beside plane walls that are."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from churchpipe.dxf.layer_walls import in_one_plane, no_wall
from churchpipe.errors import InputError
from churchpipe.geometry.clusters import components
from churchpipe.geometry.planar import overlapping
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.polyhedra import face_normals
from churchpipe.recognition.curved_walls import points_of
from churchpipe.recognition.panels import FittedPanels, fit_panels

# Faces whose normals differ by less, rad, are parallel.
PARALLEL: Final = 1e-3
# Stones of one vault are nearer to each other than this share of a stone: joints may be drawn open.
APART: Final = 0.1


def named_by_parts(stones: Assemblage, layers: Sequence[str], joint: float | None) -> Assemblage:
    """Return stones with the names of their layers as those of their parts, if the stones of each layer are one part.

    One part is one plane wall, or stones that touch and are all wedges, as those of a vault, a ring or a round wall. Where the
    stones alone show two walls or more within such a layer, or walls that they would not show by these names, the layers say
    nothing, since names of some would keep others from being found.

    Parameters
    ----------
    layers: of each stone (nb,). joint: as `fit_panels` takes it.
    """
    free, layer = np.flatnonzero(~stones.fixed), np.array(layers, dtype=np.str_)
    names = np.unique(layer[free]).tolist()
    if (stones.panel[free] != "").any() or any(map(no_wall, names)) or len(names) == len(free):
        return stones
    parts = [free[layer[free] == name] for name in names]
    vaults = [
        own for own in parts if not in_one_plane([stones.points[points_of(stones, own[k : k + 1])] for k in range(len(own))])
    ]
    if not all(_wedges(stones, own) and _together(stones, own) for own in vaults):
        return stones
    named = replace(stones, panel=np.where(stones.fixed, stones.panel, layer))
    found = _fitted(stones, joint)
    if found and not found.vaults:
        several = any(len({*found.panel[own].tolist()} - {""}) > 1 for own in vaults)
        return stones if several or _fitted(named, joint) is None else named
    return named


def _fitted(stones: Assemblage, joint: float | None) -> FittedPanels | None:
    try:
        return fit_panels(stones, joint=joint)
    except InputError:
        return None


def _wedges(stones: Assemblage, own: IntArray) -> bool:
    """Return whether each stone has two faces or more that none of its faces is parallel to."""
    _, normal, _ = face_normals(stones.points, stones.face_nodes, stones.face_ptr)
    for block in own.tolist():
        faces = normal[slice(*stones.block_face_ptr[block : block + 2])]
        if (faces @ faces.T > PARALLEL**2 / 2 - 1).all(axis=1).sum() < 2:
            return False
    return True


def _together(stones: Assemblage, own: IntArray) -> bool:
    """Return whether the boxes around stones are connected."""
    corners = [stones.points[points_of(stones, own[k : k + 1])] for k in range(len(own))]
    low, high = (np.array([reach(each, axis=0) for each in corners]) for reach in (np.min, np.max))
    margin = 0.5 * APART * float(np.cbrt(np.median(stones.volume[own])))
    plan: FloatArray = np.column_stack([low[:, :2], high[:, :2]]) + margin * np.array([-1, -1, 1, 1])
    pairs = overlapping(plan)
    above = (low[pairs[:, 0], 2] < high[pairs[:, 1], 2] + 2 * margin) & (low[pairs[:, 1], 2] < high[pairs[:, 0], 2] + 2 * margin)
    return int(components(len(own), pairs[above]).max()) == 0
