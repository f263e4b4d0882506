"""Coulomb friction without dilatancy: the gap that certifies a load factor, and the interval of a mechanism.

The certificate is de Saxce's bipotential. For forces x in equilibrium and in the Coulomb cones, and velocities u with
f_L . u = 1 that open or slide without dilating,

    g = -f_D . u + sum mu n |v| - alpha = sum n w + sum (mu n |v| + t . v)  >= 0,

and g = 0 exactly when (x, u) is a collapse state with zero dilatancy. One convex program P(n) gives the smallest g for given x.
"""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from churchpipe.conic.clarabel import solve_clarabel
from churchpipe.conic.polish import restore_balance
from churchpipe.conic.program import ConeProgram
from churchpipe.conic.semidefinite import semidefinite_solver
from churchpipe.conic.solve import Solve
from churchpipe.model.arrays import FloatArray
from churchpipe.rigid_blocks.certificate import FLOW_TOLERANCE, Strength, cone_violation
from churchpipe.rigid_blocks.equilibrium import Equilibrium

# The ends of an interval are wanted to four digits.
INTERVAL_TOLERANCE = 1e-7


@dataclass(frozen=True, slots=True)
class CoulombState:
    """Forces x (nc, 3) in the Coulomb cones, their load factor, velocities y (6 nf,) and the gap between the two."""

    x: FloatArray
    load_factor: float
    y: FloatArray
    gap: float

    @property
    def relative_gap(self) -> float:
        """g / alpha; a load factor of zero is measured against a thousandth of the weight."""
        return self.gap / max(abs(self.load_factor), 1e-3)


def sliding_program(balance: Equilibrium, limit: FloatArray) -> ConeProgram:
    """Return P: shear at each point at most `limit` (nc,) whatever the normal force, so that sliding does not dilate."""
    zero = np.zeros(len(limit))
    return ConeProgram(balance.matrix, balance.dead, balance.live, limit, zero, zero, zero)


def sliding_velocities(
    balance: Equilibrium, strength: Strength, n: FloatArray, solve: Solve, *, error: float | None = None
) -> FloatArray | None:
    """Return the velocities (6 nf,) of P(n), or None when it is not solved."""
    answer = solve(sliding_program(balance, strength.friction * n + strength.cohesion), error=error)
    return answer.y if answer.outcome == "solved" else None


def coulomb_state(
    balance: Equilibrium, strength: Strength, x: FloatArray, load_factor: float, solve: Solve
) -> CoulombState | None:
    """Return the Coulomb state of forces x (nc, 3) with the velocities that fit them best, or None when P(n) is not solved."""
    limit = strength.friction * np.maximum(x[:, 0], 0.0) + strength.cohesion
    answer = solve(sliding_program(balance, limit))
    if answer.outcome != "solved":
        return None
    return CoulombState(x=x, load_factor=load_factor, y=answer.y, gap=bipotential_gap(balance, strength, x, answer.y))


def bipotential_gap(balance: Equilibrium, strength: Strength, x: FloatArray, y: FloatArray) -> float:
    """Return g = sum n |w| + sum ((mu n + c) |v| + t . v) >= 0 of forces x (nc, 3) and velocities y (6 nf,), f_L . u = 1.

    Each term is zero or more by itself, so that nothing cancels; penetration is charged like an opening.
    """
    rate = (balance.matrix.T @ (y / (balance.live @ y))).reshape(-1, 3)
    slip = np.hypot(rate[:, 1], rate[:, 2])
    sliding = (strength.friction * x[:, 0] + strength.cohesion) * slip + (x[:, 1:] * rate[:, 1:]).sum(axis=1)
    return float((x[:, 0] * np.abs(rate[:, 0])).sum() + np.maximum(sliding, 0.0).sum())


def coulomb_step(
    balance: Equilibrium, strength: Strength, n: FloatArray, y: FloatArray, solve: Solve, *, nearness: float
) -> CoulombState | None:
    """Return the Coulomb state near normal forces n (nc,) whose forces do the least work against the sliding of y."""
    found = nearest_forces(balance, strength, n, y, solve, nearness=nearness)
    return None if found is None else coulomb_state(balance, strength, *found, solve)


def nearest_forces(
    balance: Equilibrium,
    strength: Strength,
    n: FloatArray,
    y: FloatArray,
    solve: Solve,
    *,
    nearness: float,
    error: float | None = None,
) -> tuple[FloatArray, float] | None:
    """Return forces (nc, 3) in the true cones, near the normal forces n, that do the least work against sliding y.

    maximise  alpha - sum mu n |v(y)| - 1/2 sum R (mu n - mu n_given)^2,   R = nearness / (c mean(mu n)^2)
    """
    shear = strength.friction * n
    rate = (balance.matrix.T @ y).reshape(-1, 3)
    slip = np.hypot(rate[:, 1], rate[:, 2])
    curvature = nearness / (len(n) * max(float(shear.mean()), 1e-12) ** 2) * strength.friction**2
    program = ConeProgram(
        balance=balance.matrix,
        constant=balance.dead,
        growth=balance.live,
        limit=strength.cohesion,
        slope=strength.friction,
        linear=strength.friction * slip - curvature * n,
        quadratic=curvature,
    )
    answer = solve(program, error=error)
    if answer.outcome != "solved":
        return None
    return restore_balance(program, answer.x, answer.tau)


def dead_load_start(balance: Equilibrium) -> FloatArray:
    """Return the normal forces (nc,) >= 0 of the least-squares dead-load forces A^T (A A^T)^-1 (-f_D): the canonical start."""
    solve = semidefinite_solver(sp.csc_matrix(balance.matrix @ balance.matrix.T))
    forces = -(balance.matrix.T @ solve(balance.dead))
    return np.maximum(forces[::3], 0.0)


def mechanism_interval(balance: Equilibrium, strength: Strength, state: CoulombState) -> tuple[float, float]:
    """Return the smallest and largest load factor of the Coulomb states that fit the mechanism as well as the given one.

    For fixed velocities the compatible states are convex: sum n (w + mu |v|) + t . v <= defect is one linear row, with
    the defect of the given state. The self-stress of sliding contacts is statically free, so the interval has a length.
    """
    rate = (balance.matrix.T @ state.y).reshape(-1, 3)
    slip = np.hypot(rate[:, 1], rate[:, 2])
    opening = np.maximum(rate[:, 0], 0.0)
    cost = np.column_stack([opening + strength.friction * slip, rate[:, 1:]])
    given = float((cost * state.x).sum())
    ends: list[float] = []
    for sign in (-1.0, 1.0):
        # The defect scales with the load factor: twice the certified accuracy leaves the given state strictly inside. Where that
        # is too thin a slice for double precision, a little more of it.
        for share in (1e-5, 2e-5, 4e-5):
            program = _end_program(balance, strength, cost, given + share * abs(state.load_factor), sign)
            # One dense row would fill the block matrix of our own solver.
            answer = solve_clarabel(program, tolerance=INTERVAL_TOLERANCE)
            if answer.outcome == "solved":
                break
        ends.append(sign * answer.tau if answer.outcome == "solved" else np.nan)
    # The given state is one of them, whatever the last digits of the two ends.
    return float(np.minimum(ends[0], state.load_factor)), float(np.maximum(ends[1], state.load_factor))


def _end_program(balance: Equilibrium, strength: Strength, cost: FloatArray, allowed: float, sign: float) -> ConeProgram:
    """State the search for the smallest (sign -1) or largest load factor of states with sum cost . x <= allowed."""
    # The row in the size of the others: its right side as large as the largest load.
    size = float(np.abs(balance.dead).max()) / abs(allowed)
    row = sp.hstack([sp.csr_matrix(size * cost.reshape(1, -1)), sp.csr_matrix([[1.0, 0.0, 0.0]])])
    zero = np.zeros(len(cost) + 1)
    return ConeProgram(
        balance=sp.csc_matrix(sp.vstack([sp.hstack([balance.matrix, sp.csr_matrix((len(balance.dead), 3))]), row])),
        constant=np.append(balance.dead, -size * allowed),
        growth=np.append(sign * balance.live, 0.0),
        limit=np.append(strength.cohesion, 0.0),
        slope=np.append(strength.friction, 0.0),
        linear=zero,
        quadratic=zero,
    )


def friction_violation(strength: Strength, x: FloatArray, allowance: float = 0.0) -> float:
    """Return sum max(0, |t| - mu n - c - allowance) / sum mu n: the share of the friction that is overdrawn."""
    shear = np.hypot(x[:, 1], x[:, 2])
    over = np.maximum(0.0, shear - strength.friction * x[:, 0] - strength.cohesion - allowance)
    return float(over.sum() / max(float((strength.friction * x[:, 0]).sum()), 1e-300))


def admissible(balance: Equilibrium, strength: Strength, state: CoulombState) -> bool:
    """True when the forces are in equilibrium and in their cones to 1e-8 W, and no stones overlap (to 1e-6 of the fastest rate).

    The gap charges overlap to the normal force there: where none acts, it costs nothing.
    """
    rate = (balance.matrix.T @ state.y).reshape(-1, 3)
    if -float(rate[:, 0].min(initial=0.0)) > FLOW_TOLERANCE * float(np.abs(rate).max(initial=0.0)):
        return False
    residual = balance.matrix @ state.x.ravel() + balance.dead + state.load_factor * balance.live
    return float(np.abs(residual).max()) < 1e-8 and cone_violation(state.x, strength) < 1e-8
