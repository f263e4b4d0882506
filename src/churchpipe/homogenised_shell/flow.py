"""The flow rule at the points of a shell: which multipliers of the strength explain a strain rate."""

import numpy as np

from churchpipe.homogenised_shell.settings import SOLVER
from churchpipe.model.arrays import FloatArray


def flow_of_cones(rate: FloatArray) -> FloatArray:
    """Return the multipliers (3, corners) in second-order cones that are nearest to rates: each corner has rows of its own."""
    length = np.sqrt((rate[1:] ** 2).sum(axis=0))
    top = np.maximum(0.5 * (rate[0] + length), np.maximum(rate[0], 0.0))
    top = np.where(rate[0] >= length, rate[0], np.where(rate[0] <= -length, 0.0, top))
    return np.concatenate([top[None], rate[1:] * np.where(length > top, top / np.maximum(length, 1e-300), 1.0)])


def flow_of_planes(matrix: FloatArray, rate: FloatArray, start: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return multipliers z >= 0 (rows, nq) for which G^T z is nearest to rates (6, nq), by Hildreth's sweeps, and the remainder.

    matrix_riq: G (rows, 6, nq). The sweeps begin at `start`.
    """
    z = np.maximum(start, 0.0)
    left = rate - np.einsum("riq,rq->iq", matrix, z)
    square = (matrix**2).sum(axis=1)
    square[square == 0] = 1.0
    tolerance = SOLVER.flow_tolerance * np.abs(rate).max(initial=0.0)
    moving = np.arange(rate.shape[1])
    for _ in range(SOLVER.flow_rounds):
        normals, squares = matrix[:, :, moving], square[:, moving]
        some, rest = z[:, moving], left[:, moving]
        for _ in range(SOLVER.flow_sweeps):
            for row, normal in enumerate(normals):
                moved = np.maximum(some[row] + (normal * rest).sum(axis=0) / squares[row], 0.0)
                rest -= normal * (moved - some[row])
                some[row] = moved
        change = np.abs(rest - left[:, moving]).max(axis=0, initial=0.0)
        z[:, moving], left[:, moving] = some, rest
        moving = moving[change > tolerance]
        if not len(moving):
            break
    return z, left
