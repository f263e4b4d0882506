"""Coulomb friction without dilatancy: the gap that certifies a load factor, and the programs that lower it.

A contact point carries a normal force n and a shear t (2 components), together x. Stones that move with velocities u open it at
the rate w and slide in it at the rate v (2). mu is its friction, c its cohesion; f_D is the dead load, f_L the live load and
alpha the load factor that multiplies f_L. Velocities are scaled to unit work of the live load, f_L . u = 1.

Sliding without dilatancy asks that a point which slides stays closed. Then no single convex program gives the load factor, but
a gap g tells how far forces and velocities are from a collapse state (the bipotential of de Saxce). For forces that balance the
loads and keep to friction, |t| <= mu n, and velocities that overlap nowhere, w >= 0,

    g = -f_D . u + sum mu n |v| - alpha = sum n w + sum (mu n |v| + t . v)  >= 0,

and g = 0 exactly when forces and velocities are a collapse state. Of given normal forces n one convex program, P(n), finds the
velocities with the smallest g: its shear is limited by mu n, whatever the normal forces of its own solution.

Where the normal force has a limit b (a joint that crushes, a tie that yields), a point may also close, w < 0, and
dissipates b |w| then: g gains sum b max(0, -w), and its share (b - n) |w| there is as nonnegative as n w. An elastic tie of
softness s, which lengthens at the rate -w, pulls by p = -w / s, at least 0 and at most b. Its share
s (n - p)^2 / 2 + (p - n) (-w - s p) is zero exactly where n = p (Fenchel's inequality for its energy s n^2 / 2).
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from churchpipe.conic.program import ConeProgram, ConeSolution, WarmStart
from churchpipe.conic.semidefinite import semidefinite_solver
from churchpipe.conic.solve import Solve
from churchpipe.model.arrays import FloatArray
from churchpipe.rigid_blocks.certificate import FLOW_TOLERANCE, Strength, cone_violation
from churchpipe.rigid_blocks.equilibrium import Balanced, Equilibrium

# Duality gap of programs whose forces or velocities are needed as exactly as possible.
EXACT = 1e-7
# A gap is measured by the load factor, or by this where that is smaller.
LEAST_FACTOR = 1e-3
# Excess of shear over its limit, as shares of the largest limit or load, with which P(n) is tried one after another.
_SLACK = (0.0, 1e-6, 1e-4, 1e-2)


class Near(NamedTuple):
    """Forces (nc, 3) near those sought, and velocities (m,) if any are known.

    only: whether velocities that cannot be reached from there count as not found.
    """

    forces: FloatArray
    velocities: FloatArray | None
    only: bool = False


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
        return self.gap / max(abs(self.load_factor), LEAST_FACTOR)


def sliding_program(balance: Balanced, strength: Strength, limit: FloatArray) -> ConeProgram:
    """Return P: shear at each point at most `limit` (nc,) whatever the normal force, so that sliding does not dilate."""
    return balance.program(limit, np.zeros(len(limit)), strength.bound)


def sliding_velocities(
    balance: Balanced,
    strength: Strength,
    n: FloatArray,
    solve: Solve,
    *,
    duality_gap: float = EXACT,
    stressed: tuple[FloatArray, FloatArray] | None = None,
    alone: bool = False,
    near: Near | None = None,
) -> FloatArray | None:
    """Return the velocities (6 nf,) of P(n), or None when it is not solved.

    If the forces barely carry the dead load, P(n) has no interior, or no solution. Shear may then exceed its limit by `_SLACK`
    of the largest. That does not spoil the result: any velocities are allowed, and the gap is computed from the arrays.

    alone: whether the program may stop before its forces balance; shear then never exceeds its limit, because on a path forces
    that do not carry the dead load are those of another motion. near: forces and velocities near those sought. stressed: a
    pair, excess (nc,) >= 0 and forces x (nc, 3). What x adds to the gap at each point counts `excess` times more. It is linear
    in the openings, the closing and the slip, so the program is P with larger limits and another dead load.
    """
    program = sliding_program(balance, strength, strength.shear(n))
    if stressed is not None:
        excess, x = stressed
        program = replace(
            program,
            constant=program.constant + balance.dead - balance.residual(excess[:, None] * x, 0.0),
            limit=program.limit + excess * strength.shear(np.maximum(x[:, 0], 0.0)),
            bound=program.bound * (1.0 + excess),
        )
    size = max(float(program.limit.max(initial=0.0)), program.force)
    start = None
    if near is not None and near.velocities is not None:
        start = _near(program, near.forces, near.velocities, only=near.only)
    for slack in _SLACK[: 1 if alone else None]:
        limited = replace(program, limit=program.limit + slack * size)
        answer = solve(limited, duality_gap=duality_gap, velocities=alone, near=start)
        if answer.outcome == "solved":
            return answer.y
    return None


def coulomb_state(
    balance: Equilibrium, strength: Strength, x: FloatArray, load_factor: float, solve: Solve
) -> CoulombState | None:
    """Return the Coulomb state of forces x (nc, 3) with the velocities that fit them best, or None when P(n) is not solved."""
    y = sliding_velocities(balance, strength, np.maximum(x[:, 0], 0.0), solve)
    return None if y is None else CoulombState(x, load_factor, y, bipotential_gap(balance, strength, x, y))


def bipotential_gap(balance: Balanced, strength: Strength, x: FloatArray, y: FloatArray) -> float:
    """Return g of forces x (nc, 3) and velocities y (6 nf,), scaled to f_L . u = 1."""
    return float(gap_shares(balance, strength, x, y).sum())


def gap_shares(balance: Balanced, strength: Strength, x: FloatArray, y: FloatArray) -> FloatArray:
    """Return what each point adds to the gap (nc,): n |w|, or (b - n) |w| where it may close, and (mu n + c) |v| + t . v.

    An elastic tie adds what its tension misses of that by which it lengthens, see above. Each term is nonnegative by itself, so
    that nothing cancels. Where stones must not overlap, an overlap counts as much as an opening. The further points of joints
    that crush have the flow of their cones, and add n w + t . v.
    """
    rate = balance.rates(y / (balance.live @ y))
    slip = np.hypot(rate[:, 1], rate[:, 2])
    sliding = strength.shear(x[:, 0]) * slip + (x[:, 1:] * rate[:, 1:]).sum(axis=1)
    lever = x[:, 0].copy()
    closing = strength.bounded & (rate[:, 0] < 0)
    lever[closing] = np.maximum(strength.bound[closing] - lever[closing], 0.0)
    shares = lever * np.abs(rate[:, 0]) + np.maximum(sliding, 0.0)
    shares[balance.points :] = np.maximum((x * rate)[balance.points :].sum(axis=1), 0.0)
    elastic = np.flatnonzero(balance.softness)
    n, stretch, softness = x[elastic, 0], -rate[elastic, 0], balance.softness[elastic]
    pull = elastic_pull(balance, strength, rate)[elastic]
    shares[elastic] = 0.5 * softness * (n - pull) ** 2 + np.maximum((pull - n) * (stretch - softness * pull), 0.0)
    return shares


def elastic_pull(balance: Balanced, strength: Strength, rate: FloatArray) -> FloatArray:
    """Return the tensions (nc,) of elastic ties that lengthen as by rates (nc, 3), zero at all other points."""
    stretch, elastic = -rate[:, 0], balance.softness > 0
    return np.clip(np.divide(stretch, balance.softness, out=np.zeros_like(stretch), where=elastic), 0.0, strength.bound)


def gap_coefficients(balance: Balanced, strength: Strength, y: FloatArray) -> tuple[FloatArray, float]:
    """Return the coefficients (nc, 3) of the forces in the gap of velocities y (6 nf,), and its constant: see `gap_shares`."""
    rate = balance.rates(y / (balance.live @ y))
    slip = np.hypot(rate[:, 1], rate[:, 2])
    closing = strength.bounded & (rate[:, 0] < 0)
    own = np.arange(len(rate)) < balance.points
    coefficients = rate.copy()
    coefficients[:, 0] += np.where(own, strength.friction * slip - np.where(closing, 0.0, 2.0 * np.minimum(rate[:, 0], 0.0)), 0.0)
    return coefficients, float(strength.cohesion @ slip - strength.bound[closing] @ rate[closing, 0])


def coulomb_step(
    balance: Equilibrium, strength: Strength, n: FloatArray, y: FloatArray, solve: Solve, *, nearness: float
) -> CoulombState | None:
    """Return the Coulomb state near normal forces n (nc,) whose forces do the least work against the sliding of y."""
    found = nearest_forces(balance, strength, n, y, solve, nearness=nearness)
    return None if found is None else coulomb_state(balance, strength, found.x, found.tau, solve)


def nearest_forces(
    balance: Balanced,
    strength: Strength,
    n: FloatArray,
    y: FloatArray,
    solve: Solve,
    *,
    nearness: float,
    duality_gap: float = EXACT,
    excess: FloatArray | None = None,
    x: FloatArray | None = None,
    only: bool = False,
) -> ConeSolution | None:
    """Return forces (nc, 3) in the true cones, near the normal forces n, that do the least work against sliding y.

    maximise  alpha - sum mu n |v(y)| - 1/2 sum R (mu n - mu n_given)^2,   R = nearness / (c mean(mu n)^2)

    excess (nc,) >= 0: the work of n against the openings of y counts so many times more. x (nc, 3): forces near those sought.
    only: whether forces that cannot be reached from there count as not found.
    """
    shear = strength.friction * n
    rate = balance.rates(y)
    slip = np.hypot(rate[:, 1], rate[:, 2])
    curvature = (
        nearness / (len(n) * max(float(shear.mean()), 1e-3 * float(np.abs(balance.dead).max())) ** 2) * strength.friction**2
    )
    opened = 0.0 if excess is None else excess * np.where(strength.bounded, rate[:, 0], np.maximum(rate[:, 0], 0.0))
    linear = strength.friction * slip + opened - curvature * n
    program = balance.program(strength.cohesion, strength.friction, strength.bound, linear, curvature)
    answer = solve(program, duality_gap=duality_gap, near=None if x is None else _near(program, x, y, only=only))
    return answer if answer.outcome == "solved" else None


def _near(program: ConeProgram, x: FloatArray, y: FloatArray, *, only: bool = False) -> WarmStart:
    """Return forces x (nc, 3) and velocities y (m,) as a start, with the load that they balance best."""
    load = -float(program.growth @ program.residual(x, 0.0)) / float(program.growth @ program.growth)
    return WarmStart(x, load, y / float(program.growth @ y), only=only)


def dead_load_start(balance: Equilibrium) -> FloatArray:
    """Return the normal forces (nc,) >= 0 of the least-squares dead-load forces A^T (A A^T)^-1 (-f_D): the canonical start.

    Ties are left slack.
    """
    matrix = balance.wrenches.tocsc()[:, : 3 * balance.contacts]
    forces = -np.asarray(matrix.T @ semidefinite_solver(matrix)(balance.dead[: balance.rows]))
    return np.maximum(forces[::3], 0.0)


def friction_violation(strength: Strength, x: FloatArray, allowance: float = 0.0) -> float:
    """Return sum max(0, |t| - mu n - c - allowance) / sum mu n: the share by which shear exceeds the friction available."""
    shear = np.hypot(x[:, 1], x[:, 2])
    over = np.maximum(0.0, shear - strength.shear(x[:, 0]) - allowance)
    return float(over.sum() / max(float((strength.friction * x[:, 0]).sum()), 1e-300))


def admissible(balance: Equilibrium, strength: Strength, state: CoulombState) -> bool:
    """True when the forces are in equilibrium and in their cones to 1e-8 W, and no stones overlap (to 1e-6 of the fastest rate).

    Where the normal force is bounded they may: the joint crushes. Overlap is checked because the gap weighs it by the normal
    force there: where that is zero, overlap does not add to the gap.
    """
    rate = balance.rates(state.y)
    overlap = -rate[:, 0]
    overlap[balance.points :] += np.hypot(rate[balance.points :, 1], rate[balance.points :, 2])
    if float(overlap[~strength.bounded].max(initial=0.0)) > FLOW_TOLERANCE * float(np.abs(rate).max(initial=0.0)):
        return False
    residual = balance.residual(state.x, state.load_factor)
    return float(np.abs(residual).max()) < 1e-8 and cone_violation(state.x, strength) < 1e-8
