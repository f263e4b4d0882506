"""Which places lie within a stone: what a third stone fills is no joint of the two beside it."""

from collections.abc import Sequence

import numpy as np

from churchpipe.geometry.locate import solid_angles
from churchpipe.geometry.planar import meeting
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray


def filled(corners: Sequence[FloatArray], solid: IntArray, places: FloatArray, beside: IntArray) -> BoolArray:
    """Return which places (n, 3) lie within a solid that is none of the two beside each (n, 2).

    The winding number of the surface of a solid is one inside it, and zero outside.

    Parameters
    ----------
    corners: of each face (n, 3), outward, the faces of one solid in a row. solid (nf,): the solid of each face, rising from 0.
    """
    inside = np.zeros(len(places), dtype=np.bool_)
    if not len(places):
        return inside
    first = np.searchsorted(solid, np.arange(int(solid[-1]) + 2)).tolist()
    low, high = (
        edge.reduceat(np.array([edge.reduce(face, axis=0) for face in corners]), first[:-1], axis=0)
        for edge in (np.minimum, np.maximum)
    )
    # The tree of boxes has two dimensions: those in which the solids spread most.
    across = np.argsort(np.ptp(np.concatenate([low, high]), axis=0))[1:]
    boxes = np.concatenate([low[:, across], high[:, across]], axis=1)
    place, other = meeting(np.tile(places[:, across], 2), boxes).T
    near = ((places[place] >= low[other]) & (places[place] <= high[other])).all(axis=1)
    near &= (beside[place] != other[:, None]).all(axis=1)
    for n, k in zip(place[near].tolist(), other[near].tolist(), strict=True):
        faces = corners[first[k] : first[k + 1]]
        fans = [np.stack([face[[0, step, step + 1]] for step in range(1, len(face) - 1)]) for face in faces]
        inside[n] |= solid_angles(np.concatenate(fans) - places[n]).sum() > 2.0 * np.pi
    return inside
