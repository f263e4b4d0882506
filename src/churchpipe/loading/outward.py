"""A load that pushes a vault apart: the measure of its safety that goes to zero as it becomes too thin."""

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arguments import check_kind
from churchpipe.model.arrays import floats
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.loads import LoadCase


def outward_load(stones: Assemblage, axis: tuple[float, float] = (0.0, 0.0), name: str = "outward") -> LoadCase:
    """Return the load that pushes each stone by its weight, level and away from an upright axis.

    The mechanism by which a dome or a vault on a central plan falls when it is too thin opens outwards all round. A push along
    one direction does no work on it, so its load factor says nothing of how near that is; the load factor of this one falls to
    zero in proportion to the thickness that is left.

    Parameters
    ----------
    stones
        Of the vault and what carries it.
    axis
        x and y of the upright axis, m.
    name
        Of the load.

    Raises
    ------
    InputError
        No stone lies beside the axis, an axis that is no place in plan.
    """
    check_kind("outward_load: stones", stones, Assemblage)
    reach = stones.centroid[:, :2] - floats("outward_load: axis", axis, (2,))
    distance = np.linalg.norm(reach, axis=1, keepdims=True)
    # A stone on the axis, the key, is pushed nowhere.
    beside = distance > 1e-6 * stones.size
    push = np.zeros((stones.count, 6))
    push[:, :2] = np.where(beside, reach / np.where(beside, distance, 1.0), 0.0) * stones.weight[:, None]
    if not push.any():
        raise InputError("outward_load: axis", "no stone lies beside it", found=axis, expected="x and y of the middle, m")
    return LoadCase(name=name, live=push)
