"""Bring a solver's forces back into balance without leaving their cones."""

import numpy as np
import scipy.sparse as sp

from churchpipe.conic.program import ConeProgram
from churchpipe.conic.semidefinite import semidefinite_solver
from churchpipe.model.arrays import FloatArray


def restore_balance(program: ConeProgram, x: FloatArray, tau: float, sweeps: int = 3) -> tuple[FloatArray, float]:
    """Return forces (c, 3) and tau near the given ones that satisfy balance x + constant + tau growth = 0 to rounding.

    The correction is the smallest one in the metric of each cone's barrier at x (the Dikin ellipsoid, which lies inside
    the cone): a force near the boundary of its cone moves along it, one near zero hardly at all. What only the
    collapse mechanism could balance goes into tau.
    """
    metric = _cone_metric(program, x)
    solve = semidefinite_solver(sp.csc_matrix(program.balance @ metric @ program.balance.T))
    out = x.ravel().copy()
    lever = solve(program.growth)
    stiffness = float(program.growth @ lever) + (1.0 if tau < program.cap * (1 - 1e-6) else np.inf)
    for _ in range(sweeps):
        residual = program.balance @ out + program.constant + tau * program.growth
        shift = solve(residual)
        step = float(program.growth @ shift) / stiffness
        out -= metric @ (program.balance.T @ (shift - step * lever))
        tau -= step
    return out.reshape(-1, 3), tau


def _cone_metric(program: ConeProgram, x: FloatArray) -> sp.csc_matrix:
    """Return the block-diagonal inverse Hessian (3c, 3c) of the cones' barrier at x, kept positive by a trace of identity."""
    n, shear = np.maximum(x[:, 0], 0.0), x[:, 1:]
    reach = np.maximum(program.limit + program.slope * n, 0.0)
    slack = np.maximum(reach**2 - (shear**2).sum(axis=1), 0.0)
    coulomb = (program.slope > 0) & (program.limit == 0)
    slope = np.where(coulomb, program.slope, 1.0)
    # metric_kij: for a Coulomb cone 2 s s^T - slack J in s = (mu n, t); elsewhere n and t on their own.
    s = np.where(coulomb[:, None], np.column_stack([reach / slope, shear]), 0.0)
    metric = 2.0 * s[:, :, None] * s[:, None, :]
    metric[:, 0, 0] += np.where(coulomb, -slack / slope**2, n**2)
    trace = 1e-10 * max(float(n.max(initial=0.0)), 1e-300)
    metric[:, 1, 1] += slack + trace**2
    metric[:, 2, 2] += slack + trace**2
    metric[:, 0, 0] += trace**2
    points = len(x)
    columns = np.broadcast_to(3 * np.arange(points)[:, None, None] + np.arange(3), (points, 3, 3))
    matrix = sp.coo_matrix(
        (metric.ravel(), (columns.transpose(0, 2, 1).ravel(), columns.ravel())), shape=(3 * points, 3 * points)
    )
    return sp.csc_matrix(matrix)
