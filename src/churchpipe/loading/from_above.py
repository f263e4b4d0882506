"""A load on whatever lies uppermost at a place in plan: anywhere on the back of a vault."""

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arguments import check_kind, positive
from churchpipe.model.arrays import FloatArray, floats
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.loads import LoadCase
from churchpipe.model.polyhedra import face_normals


def load_from_above(stones: Assemblage, place: tuple[float, float], force: float = 1.0, name: str = "from above") -> LoadCase:
    """Return the load that presses down at a place in plan on the uppermost stone there; the load factor multiplies the force.

    Parameters
    ----------
    stones
        Of the whole structure.
    place
        x and y, m.
    force
        N.
    name
        Of the load.

    Raises
    ------
    InputError
        No stone lies there, a force that is not above 0.
    """
    check_kind("load_from_above: stones", stones, Assemblage)
    positive("load_from_above: force", force)
    at = floats("load_from_above: place", place, (2,))
    stone, height = _uppermost(stones, at)
    live = np.zeros((stones.count, 6))
    down = np.array([0.0, 0.0, -force])
    live[stone, :3] = down
    live[stone, 3:] = np.cross(np.append(at, height) - stones.centroid[stone], down)
    return LoadCase(name=name, live=live)


def _uppermost(stones: Assemblage, at: FloatArray) -> tuple[int, float]:
    """Return the free stone whose upper side is highest above a place in plan, and the height of that, m."""
    _, normal, mean = face_normals(stones.points, stones.face_nodes, stones.face_ptr)
    owner = np.repeat(np.arange(stones.count), np.diff(stones.block_face_ptr))
    found: list[tuple[float, int]] = []
    for face in np.flatnonzero((normal[:, 2] > 1e-6) & ~stones.fixed[owner]).tolist():
        corner = stones.points[stones.face_nodes[slice(*stones.face_ptr[face : face + 2])], :2]
        if (corner.min(axis=0) <= at).all() and (corner.max(axis=0) >= at).all() and _covers(corner, at):
            slope = normal[face, :2] / normal[face, 2]
            found.append((float(mean[face, 2] - slope @ (at - mean[face, :2])), int(owner[face])))
    if not found:
        low: FloatArray = stones.points[:, :2].min(axis=0).round(3)
        high: FloatArray = stones.points[:, :2].max(axis=0).round(3)
        raise InputError(
            "load_from_above: place",
            "no stone lies there",
            found=at.tolist(),
            expected=f"a place on a stone, within {low.tolist()} to {high.tolist()} m",
        )
    height, stone = max(found)
    return stone, height


def _covers(corner: FloatArray, at: FloatArray) -> bool:
    """Return whether a polygon (k, 2) covers a point, by the crossings of a ray; points on its border may count either way."""
    after = np.roll(corner, -1, axis=0)
    passed = (corner[:, 1] > at[1]) != (after[:, 1] > at[1])
    run = np.where(passed, after[:, 1] - corner[:, 1], 1.0)
    x = corner[:, 0] + (at[1] - corner[:, 1]) / run * (after[:, 0] - corner[:, 0])
    return bool((passed & (x > at[0])).sum() % 2)
