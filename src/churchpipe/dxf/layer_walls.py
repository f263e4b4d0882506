"""Walls named by the layers of their stones, where stones are drawn as solids without attributes."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from churchpipe.dxf import schema
from churchpipe.dxf.stones import Stone
from churchpipe.model.arrays import FloatArray

# All stones of a wall are as thick together as the thickest of them, but for what rounding and rough faces add.
ROUGH = 0.02


def named_by_layers(stones: list[Stone]) -> list[Stone]:
    """Return stones with the names of their layers as those of their walls, if on each layer stands one plane wall.

    Else a layer has the stones of several walls, as one for all stones of a building or one for each sort of stone has, and the
    walls are known by their stones alone: then nothing is named, since names of some would keep others from being found.
    """
    on: dict[str, list[Stone]] = {}
    for stone in stones:
        if not stone.fixed and not stone.panel:
            on.setdefault(stone.layer, []).append(stone)
    if any(map(no_wall, on)) or not all(in_one_plane([stone.points for stone in own]) for own in on.values()):
        return stones
    return [stone if stone.fixed or stone.panel else replace(stone, panel=stone.layer) for stone in stones]


def no_wall(layer: str) -> bool:
    """Return whether a layer has a name that is none of a wall: no name, the layer of all CAD programs, one of the layout."""
    return layer in ("", "0", *schema.LAYERS)


def in_one_plane(stones: Sequence[FloatArray]) -> bool:
    """Return whether stones, the corners (n, 3) of each, side by side are no thicker than one of them."""
    plan = [points[:, :2] for points in stones]
    together = np.concatenate(plan)
    try:
        corners = together[ConvexHull(together - together.mean(axis=0)).vertices]
    except (QhullError, ValueError):
        return False
    along = np.roll(corners, -1, axis=0) - corners
    across = np.stack([-along[:, 1], along[:, 0]]) / np.linalg.norm(along, axis=1)
    # A convex outline is thinnest across one of its sides.
    thickness = np.ptp(together @ across, axis=0)
    thinnest = across[:, thickness.argmin()]
    return float(thickness.min()) <= (1 + ROUGH) * max(float(np.ptp(own @ thinnest)) for own in plan)
