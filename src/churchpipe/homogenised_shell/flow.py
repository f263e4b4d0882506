"""The flow rule at the points of a shell: which multipliers of the strength explain a strain rate."""

import numpy as np

from churchpipe.conic.interior_point.nonnegative import Nonnegative
from churchpipe.homogenised_shell.points import LocalStrength
from churchpipe.model.arrays import FloatArray

# The sweeps end when no multiplier changes by more than this share of the largest rate. Planes that nearly coincide need many.
_SWEEPS, _ROUNDS, _SETTLED = 50, 40, 1e-13


def plastic_flow(law: LocalStrength, rate: FloatArray, start: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return multipliers z in the cones (rows, nq) for which G^T z is nearest to a strain rate (d, nq), and the remainder.

    For planes, Hildreth's sweeps from `start`. For the cones of the exact cell each variable has a row of its own, so the
    nearest point of each cone is the answer.
    """
    if isinstance(law.cones[0], Nonnegative):
        return _by_planes(law.matrix, rate, start)
    size = np.einsum("iiq->iq", law.matrix)
    asked = np.where(size == 0, 0.0, rate / np.where(size == 0, 1.0, size)).reshape(3, 12, -1)
    length = np.sqrt((asked[1:] ** 2).sum(axis=0))
    top = np.clip(0.5 * (asked[0] + length), np.maximum(asked[0], 0.0), None)
    top = np.where(asked[0] >= length, asked[0], np.where(asked[0] <= -length, 0.0, top))
    inside = np.concatenate([top[None], asked[1:] * np.where(length > top, top / np.maximum(length, 1e-300), 1.0)])
    z = inside.reshape(rate.shape)
    return z, rate - size * z


def _by_planes(matrix: FloatArray, rate: FloatArray, start: FloatArray) -> tuple[FloatArray, FloatArray]:
    z = np.maximum(start, 0.0)
    left = rate - np.einsum("riq,rq->iq", matrix, z)
    square = (matrix**2).sum(axis=1)
    square[square == 0] = 1.0
    settled = _SETTLED * np.abs(rate).max(initial=0.0)
    moving = np.arange(rate.shape[1])
    for _ in range(_ROUNDS):
        normals, squares = matrix[:, :, moving], square[:, moving]
        some, rest = z[:, moving], left[:, moving]
        for _ in range(_SWEEPS):
            for row, normal in enumerate(normals):
                moved = np.maximum(some[row] + (normal * rest).sum(axis=0) / squares[row], 0.0)
                rest -= normal * (moved - some[row])
                some[row] = moved
        change = np.abs(rest - left[:, moving]).max(axis=0, initial=0.0)
        z[:, moving], left[:, moving] = some, rest
        moving = moving[change > settled]
        if not len(moving):
            break
    return z, left
