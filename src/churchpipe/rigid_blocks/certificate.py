"""Certificates: the claims of an analysis, verified from its own arrays alone."""

from dataclasses import dataclass

import numpy as np

from churchpipe.model.arrays import BoolArray, FloatArray
from churchpipe.rigid_blocks.equilibrium import Equilibrium

BOUND_TOLERANCE = 1e-6
RESIDUAL_TOLERANCE = 1e-8
# Rates that leave the cone of the flow rule, or make stones overlap, are tolerated up to this share of the fastest rate.
FLOW_TOLERANCE = 1e-6
# A residual below this share of the forces that act on a stone is rounding.
_PASSING = 1e-6


@dataclass(frozen=True, slots=True)
class Strength:
    """Strength of each contact point and tie, and of the further points of joints that crush, all (points,).

    friction: coefficient mu. cohesion c: shear without normal force; bound: the largest normal force of a contact or tension of
    a tie, infinite where nothing limits it; both in units of the total weight.
    """

    friction: FloatArray
    cohesion: FloatArray
    bound: FloatArray

    def shear(self, n: FloatArray) -> FloatArray:
        """Return the shear mu n + c that normal forces n (nc + nt,) allow."""
        return self.friction * n + self.cohesion

    @property
    def bounded(self) -> BoolArray:
        """Which points have a finite bound (nc + nt,)."""
        return np.isfinite(self.bound)


@dataclass(frozen=True, slots=True)
class Certificate:
    """Static and kinematic bounds of a load factor, and the errors that they rest on.

    equilibrium_residual, cone_violation: relative to the total weight; stone_residual: of each stone relative to its own load,
    the largest. Measured by the total weight alone, the fall of one light stone would pass for rounding. flow_violation: how
    far the flow leaves the dual cones, relative to the fastest rate; what presses on nothing would do so at no price.
    """

    lower_bound: float
    upper_bound: float
    equilibrium_residual: float
    cone_violation: float
    stone_residual: float
    flow_violation: float

    @property
    def balanced(self) -> bool:
        """True when the forces balance every stone to 1e-6 of its load, all to 1e-8 of the weight, and keep to their cones."""
        return (
            self.equilibrium_residual < RESIDUAL_TOLERANCE
            and self.cone_violation < RESIDUAL_TOLERANCE
            and self.stone_residual < BOUND_TOLERANCE
        )

    @property
    def lacks(self) -> tuple[str, ...]:
        """What keeps it from being a proof: bounds that agree to 1e-6, balanced forces, a flow admissible to 1e-6."""
        # The bounds of a load factor near zero are compared absolutely, with the weight as the unit.
        size = max(abs(self.upper_bound), 1e-3)
        limits = (
            ("distance of the bounds", abs(self.upper_bound - self.lower_bound) / size, BOUND_TOLERANCE),
            ("equilibrium residual over the weight", self.equilibrium_residual, RESIDUAL_TOLERANCE),
            ("force beyond friction over the weight", self.cone_violation, RESIDUAL_TOLERANCE),
            ("residual of a stone over its load", self.stone_residual, BOUND_TOLERANCE),
            ("overlap of stones over the fastest rate", self.flow_violation, FLOW_TOLERANCE),
        )
        return tuple(f"{what} {value:.1e}, allowed {allowed:.0e}" for what, value, allowed in limits if not value <= allowed)

    @property
    def holds(self) -> bool:
        """True when nothing is lacking."""
        return not self.lacks


# The certificate of a solver that found nothing.
UNPROVED = Certificate(*[np.nan] * 6)


def certify(
    balance: Equilibrium, strength: Strength, x: FloatArray, tau: float, y: FloatArray, weight: FloatArray | None = None
) -> Certificate:
    """Return the certificate of forces x (nc, 3), load factor tau and velocities y (6 nf,), all in scaled units.

    weight (rows,): what a stone's residual is measured by beside its loads of this balance, if that leaves its weight out.

    lower (static): tau of forces in equilibrium, once brought into their cones. upper (kinematic): see `kinematic_bound`.

    The forces must balance to rounding (`conic.polish.restore_balance`): a mechanism's velocities multiply an equilibrium
    residual, so that 2e-9 of the weight has hidden an error of 3e-6 in the load factor.
    """
    inside = into_cones(x, strength)
    residual = balance.residual(inside, tau)
    upper_bound, flow_violation = kinematic_bound(balance, strength, inside[:, 0], y)
    return Certificate(
        lower_bound=tau,
        upper_bound=upper_bound,
        equilibrium_residual=float(np.abs(residual).max()),
        cone_violation=cone_violation(x, strength),
        stone_residual=_stone_residual(balance, residual, inside, balance.dead if weight is None else weight),
        flow_violation=flow_violation,
    )


def _stone_residual(balance: Equilibrium, residual: FloatArray, x: FloatArray, weight: FloatArray) -> float:
    """Return the largest residual (rows,) over the load of its stone and the lever of its row, or a share of the forces there."""
    lever, passing = balance.wrenches.sizes(x[: balance.points])
    load = np.maximum(np.abs(weight), np.abs(balance.live))[: balance.rows].reshape(-1, 6).max(axis=1)
    unit = np.maximum(np.repeat(load, 6) * lever, _PASSING * passing)
    return float((np.abs(residual[: balance.rows]) / np.maximum(unit, 1e-300)).max())


def kinematic_bound(balance: Equilibrium, strength: Strength, n: FloatArray, y: FloatArray) -> tuple[float, float]:
    """Return the load factor by virtual work of velocities y (6 nf,), and how far their flow leaves the dual cones.

        alpha = -f_D . u + sum bound max(0, mu |v_t| - v_n) + sum c |v_t|,   f_L . u = 1

    A point without bound must open as fast as sliding dilates, v_n >= mu |v_t|. Flow that leaves this cone, which rounding
    makes, is charged to the forces n (nc + nt,) instead of the bound, and measured by the fastest rate.
    """
    power = balance.live @ y
    if not power > 0:
        return np.inf, np.inf
    u = y / power
    rate = balance.rates(u)
    slip = np.hypot(rate[:, 1], rate[:, 2])
    excess = np.maximum(0.0, strength.friction * slip - rate[:, 0])
    bounded = strength.bounded
    upper_bound = float(-balance.dead @ u + np.where(bounded, strength.bound, n) @ excess + strength.cohesion @ slip)
    violation = float(excess[~bounded].max(initial=0.0) / max(float(np.abs(rate).max(initial=0.0)), 1e-300))
    return upper_bound, violation


def cone_violation(x: FloatArray, strength: Strength) -> float:
    """Return how far the worst force lies outside its cone: max(|t| - mu n - c, -n, n - bound), at least 0."""
    n, shear = x[:, 0], np.hypot(x[:, 1], x[:, 2])
    if not len(x):
        return 0.0
    return float(max(0.0, (shear - strength.shear(np.maximum(n, 0))).max(), (-n).max(), (n - strength.bound).max()))


def into_cones(x: FloatArray, strength: Strength) -> FloatArray:
    """Return forces (nc, 3) in their cones: the nearest with |t| <= mu n + c and n >= 0, cut off at the bound of n."""
    n, shear = x[:, 0], np.hypot(x[:, 1], x[:, 2])
    mu, c = strength.friction, strength.cohesion
    out = x.copy()
    outside = (shear > mu * n + c) | (n < 0)
    # Foot of the perpendicular on the line |t| = mu n + c, moved along it into n >= 0.
    foot = np.maximum(0.0, (n + mu * (shear - c)) / (1 + mu**2))
    length = np.minimum(np.maximum(mu * foot + c, 0.0), np.where(n < 0, np.maximum(shear, 0.0), np.inf))
    scale = np.divide(length, shear, out=np.zeros_like(shear), where=shear > 0)
    out[outside, 0] = foot[outside]
    out[outside, 1:] *= np.minimum(scale, 1.0)[outside, None]
    crushed = np.flatnonzero(out[:, 0] > strength.bound)
    if len(crushed):
        out[crushed, 0] = strength.bound[crushed]
        kept = np.hypot(out[crushed, 1], out[crushed, 2])
        allowed = strength.shear(out[:, 0])[crushed]
        out[crushed, 1:] *= np.minimum(allowed / np.maximum(kept, 1e-300), 1.0)[:, None]
    return out
