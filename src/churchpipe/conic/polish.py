"""Bring a solver's forces back into balance without leaving their cones."""

import numpy as np
import scipy.sparse as sp

from churchpipe.conic.program import ConeProgram
from churchpipe.conic.semidefinite import semidefinite_solver
from churchpipe.model.arrays import BoolArray, FloatArray

# Added to the diagonal of the metric, over the largest normal force, so that every force can change a little.
_TRACE = 1e-10
# The factor is inexact by what was added to its diagonal. At most so many corrections follow, until the balance holds to
# rounding.
_SWEEPS = 8
_ROUNDING = 1e-14
# Forces that balance to this share of the largest load are left as they are. A mechanism has been seen to make 1500 times as much
# of the load factor of an imbalance, which is then next to nothing.
_BALANCED = 1e-13


def restore_balance(program: ConeProgram, x: FloatArray, tau: float) -> tuple[FloatArray, float]:
    """Return forces (c, 3) and tau near the given ones that satisfy balance x + constant + tau growth = 0 to rounding.

    The correction is the smallest one in the metric of each cone's barrier at x (the Dikin ellipsoid, which lies inside
    the cone): a force near the boundary of its cone moves along it, one near zero hardly at all. What only the
    collapse mechanism could balance goes into tau.
    """
    if program.imbalance(x, tau) <= _BALANCED:
        return x, tau
    root = _metric_root(program, x)
    columns = sp.csc_matrix(program.matrix() @ root)
    solve = semidefinite_solver(columns)
    lever = solve(program.growth)
    stiffness = float(program.growth @ lever) + (1.0 if tau < program.cap * (1 - 1e-6) else np.inf)
    for _ in range(_SWEEPS):
        shift = solve(program.residual(x, tau))
        step = float(program.growth @ shift) / stiffness
        x = x - np.asarray(root @ (columns.T @ (shift - step * lever))).reshape(x.shape)
        tau -= step
        if program.imbalance(x, tau) <= _ROUNDING:
            break
    return x, tau


def _metric_root(program: ConeProgram, x: FloatArray) -> sp.csc_matrix[np.float64]:
    """Return a block-diagonal root R (3c, 3c) of the metric R R^T: the inverse Hessian of the cones' barrier at x.

    The cone of s = (limit + slope n, t) alone has the root [[s0, t], [t, t t / (s0 + d) + d I]], d^2 = s0^2 - |t|^2, in which
    nothing cancels; a trace of the identity is added. Without slope n and t have roots of their own. Where n >= 0 is a
    constraint of its own, or n <= bound, `_stiffening` makes the root smaller.
    """
    n, shear = np.maximum(x[:, 0], 0.0), x[:, 1:]
    trace = _TRACE * max(float(n.max(initial=0.0)), 1e-300)
    reach = np.maximum(program.limit + program.slope * n, 0.0)
    length = np.hypot(shear[:, 0], shear[:, 1])
    slack = np.sqrt(np.maximum(reach - length, 0.0) * (reach + length))
    sloped = program.slope != 0
    root = np.zeros((len(x), 3, 3))
    t = np.where(sloped[:, None], shear, 0.0)
    root[:, 1:, 1:] = t[:, :, None] * t[:, None, :] / np.maximum(reach + slack, 1e-300)[:, None, None]
    root[:, 0, 1:] = root[:, 1:, 0] = t
    root[:, 0, 0] = np.where(sloped, reach, n)
    root += np.eye(3) * (np.where([1.0, 0.0, 0.0], 0.0, slack[:, None]) + trace)[:, :, None]
    root[:, 0] /= np.where(sloped, program.slope, 1.0)[:, None]
    guarded = sloped & ~((program.slope > 0) & (program.limit == 0))
    root -= _stiffening(root, guarded, n + trace)
    bounded = np.isfinite(program.bound)
    if bounded.any():
        root -= _stiffening(root, bounded, np.where(bounded, np.maximum(program.bound - n, 0.0), 0.0) + trace)
    points = len(x)
    columns = np.broadcast_to(3 * np.arange(points)[:, None, None] + np.arange(3), (points, 3, 3))
    entries = (root.ravel(), (columns.transpose(0, 2, 1).ravel(), columns.ravel()))
    return sp.csc_matrix(sp.coo_matrix(entries, shape=(3 * points, 3 * points)))


def _stiffening(root: FloatArray, chosen: BoolArray, slack: FloatArray) -> FloatArray:
    """Return what a barrier of n takes off the roots (c, 3, 3) of the chosen points; slack (c,): how far n is from its limit.

    With v the first row of R, v v^T / slack^2 more in the Hessian makes R (I - v v^T / (h (h + slack))) of R,
    h^2 = slack^2 + |v|^2.
    """
    v = np.where(chosen[:, None], root[:, 0], 0.0)
    h = np.sqrt(slack**2 + (v**2).sum(axis=1))
    return np.einsum("kij,kj,kl->kil", root, v / (h * (h + slack))[:, None], v)
