"""Points with a Coulomb-type cone, |t| <= limit + slope n and 0 <= n <= bound: closed forms for all of them at once."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numba
import numpy as np

from churchpipe.conic.interior_point.cones import Cone, Scaling
from churchpipe.conic.interior_point.nonnegative import Nonnegative, NonnegativeScaling
from churchpipe.conic.interior_point.second_order import SecondOrder, SecondOrderScaling
from churchpipe.model.arrays import BoolArray, FloatArray


@dataclass(frozen=True, slots=True)
class CoulombCompliance:
    """Compliances as n = normal (f_n + lean f_u), u = along f_u + lean n, v = across f_v, with u, v along and across `direction`.

    In this form a rounding error of n moves the force along the surface of its cone. As a matrix S, whose entries are as large
    as 1e10, it would move it out of the cone too, where the compliance is as small as 1e-10.
    All (count,), direction (2, count) of unit length.
    """

    normal: FloatArray
    lean: FloatArray
    along: FloatArray
    across: FloatArray
    direction: FloatArray

    @property
    def matrix(self) -> FloatArray:
        """S_ijk, (3, 3, count)."""
        u, v = self.direction
        tilt = self.normal * self.lean
        along = self.along + tilt * self.lean
        out = np.empty((3, 3, len(u)))
        out[0, 0] = self.normal
        out[0, 1] = out[1, 0] = tilt * u
        out[0, 2] = out[2, 0] = tilt * v
        out[1, 1] = along * u * u + self.across * v * v
        out[2, 2] = along * v * v + self.across * u * u
        out[1, 2] = out[2, 1] = (along - self.across) * u * v
        return out

    def apply(self, force: FloatArray) -> FloatArray:
        """Return S force."""
        out = np.empty_like(force)
        _comply(self.normal, self.lean, self.along, self.across, self.direction, force, out)
        return out


class CoulombPoints:
    """x = (n, t1, t2) at each point; limit, slope, linear, curvature, bound (count,); linear and curvature are the cost of n.

    Points without shear resistance keep t = 0, points with a bound of zero n = 0, points with neither limit nor slope >= 0
    x = 0: `active` (3, count) says which components are free. n >= 0 is a row of its own where limit or slope <= 0 make it
    one (the point is `guarded` (count,)), n <= bound where the bound is finite.
    """

    dimension = 3

    def __init__(
        self, limit: FloatArray, slope: FloatArray, linear: FloatArray, curvature: FloatArray, bound: FloatArray | None = None
    ) -> None:
        self.count = len(limit)
        self._bound = np.full(self.count, np.inf) if bound is None else bound
        closed = self._bound == 0
        slope = np.where(closed, 0.0, slope)
        sheared = (limit > 0) | (slope > 0)
        guarded = ((limit > 0) | (slope == 0)) & ~closed
        self.active: BoolArray = np.stack([(sheared | guarded) & ~closed, sheared, sheared])
        self._sheared, self._guarded = np.flatnonzero(sheared), np.flatnonzero(guarded)
        self._bounded = np.flatnonzero(np.isfinite(self._bound) & self.active[0])
        self._all_sheared, self.guarded = bool(sheared.all()), guarded
        self.limit, self.slope = limit, slope
        self._curvature = np.where(self.active[0], curvature, 0.0)
        self.curved = bool(self._curvature.any())
        self.linear = np.zeros((3, self.count))
        self.linear[0] = np.where(self.active[0], linear, 0.0)
        self.bounded = len(self._bounded) > 0
        cones: list[Cone] = []
        right: list[FloatArray] = []
        if len(self._sheared):
            cones.append(SecondOrder(3, 1, len(self._sheared)))
            right += [limit[self._sheared], np.zeros(2 * len(self._sheared))]
        if len(self._guarded):
            cones.append(Nonnegative(1, len(self._guarded)))
            right.append(np.zeros(len(self._guarded)))
        if len(self._bounded):
            cones.append(Nonnegative(1, len(self._bounded)))
            right.append(self._bound[self._bounded])
        self.cones = tuple(cones)
        self.right = np.concatenate(right) if right else np.zeros(0)
        # Where the rows of the guards and those of the bounds begin, after three rows for each cone.
        self._guards = 3 * len(self._sheared)
        self._bounds = self._guards + len(self._guarded)

    def quadratic(self, x: FloatArray) -> FloatArray:
        """Return Q x."""
        out = np.zeros_like(x)
        out[0] = self._curvature * x[0]
        return out

    def apply(self, x: FloatArray) -> FloatArray:
        """Return G x."""
        cone = self._take(x)
        axis = self._take(self.slope) * cone[0]
        return -np.concatenate([axis, cone[1], cone[2], x[0, self._guarded], -x[0, self._bounded]])

    def transpose(self, z: FloatArray) -> FloatArray:
        """Return G^T z."""
        cone = z[: self._guards].reshape(3, -1)
        out = np.zeros((3, self.count))
        self._put(out, -cone)
        out[0] *= self.slope
        out[0, self._guarded] -= z[self._guards : self._bounds]
        out[0, self._bounded] += z[self._bounds :]
        return out

    def overlap(self, pull: FloatArray) -> float:
        """Return how fast a point closes that cannot, over the fastest rate; pull (3, count): the rates, cost of n included."""
        fixed = self._guarded[~np.isfinite(self._bound[self._guarded])]
        return float(-pull[0, fixed].min(initial=0.0)) / max(float(np.abs(pull).max(initial=0.0)), 1e-300)

    def compliance(self, scalings: Sequence[Scaling]) -> "CoulombCompliance":
        """Return the compliances in closed form."""
        # A component that is not free is held by a stiffness of its own.
        stiffness = np.where(self.active[0], self._curvature, 1.0)
        rows = [scaling for scaling in scalings if isinstance(scaling, NonnegativeScaling)]
        points = [chosen for chosen in (self._guarded, self._bounded) if len(chosen)]
        for scaling, chosen in zip(rows, points, strict=True):
            stiffness[chosen] += 1.0 / scaling.factor[0] ** 2
        first = scalings[0] if scalings else None
        if isinstance(first, SecondOrderScaling) and self._all_sheared:
            return self._held(_cone_compliance(first, self.slope, stiffness))
        normal = np.zeros(self.count)
        alone = self.active[0] & ~self.active[1]
        normal[alone] = 1.0 / stiffness[alone]
        zero = np.zeros(self.count)
        out = CoulombCompliance(normal, zero, zero, zero, np.stack([zero, zero]))
        if isinstance(first, SecondOrderScaling):
            cone = _cone_compliance(first, self.slope[self._sheared], stiffness[self._sheared])
            parts = [values.copy() for values in (out.normal, out.lean, out.along, out.across, out.direction)]
            new = (cone.normal, cone.lean, cone.along, cone.across, cone.direction)
            for whole, part in zip(parts, new, strict=True):
                whole[..., self._sheared] = part
            out = CoulombCompliance(*parts)
        return self._held(out)

    def balanced(self, force: FloatArray, rough: Callable[[], FloatArray]) -> FloatArray:
        """Return z with its shear rows, and the guard n >= 0 or else the axis of the cone, taken from the force."""
        pull = self._take(force)
        slope = self._take(self.slope)
        if not len(self._guarded) and not len(self._bounded):
            return -np.concatenate([pull[0] / slope, pull[1], pull[2]])
        near = rough()
        push = force[0].copy()
        push[self._bounded] -= near[self._bounds :]
        axis = -self._take(push) / np.where(slope > 0, slope, 1.0)
        kept = self.guarded[self._sheared] | ~self.active[0, self._sheared]
        axis[kept] = near[: self._guards].reshape(3, -1)[0, kept]
        push[slice(None) if self._all_sheared else self._sheared] += slope * axis
        return np.concatenate([axis, -pull[1], -pull[2], -push[self._guarded], near[self._bounds :]])

    def interior(self, size: FloatArray) -> FloatArray:
        """Return compression `size` (count,), less where the cone is shorter, without shear."""
        out = np.zeros((3, self.count))
        out[0] = np.where(self.active[0], np.minimum(size, 0.5 * self._reach()), 0.0)
        return out

    def inside(self, x: FloatArray) -> FloatArray:
        """Return x (3, count) with rounding errors outside the cones removed."""
        out = np.where(self.active, x, 0.0)
        out[0] = np.minimum(np.maximum(out[0], 0.0), self._reach())
        reach = np.maximum(self.limit + self.slope * out[0], 0.0)
        shear = np.hypot(out[1], out[2])
        out[1:] *= np.divide(reach, shear, out=np.ones_like(shear), where=shear > reach)
        return out

    def _reach(self) -> FloatArray:
        """Return the largest n (count,) that bound and cone allow."""
        with np.errstate(divide="ignore"):
            apex = np.where(self.slope < 0, -self.limit / np.minimum(self.slope, -1e-300), np.inf)
        return np.minimum(apex, self._bound)

    def _held(self, compliance: CoulombCompliance) -> CoulombCompliance:
        """Return the compliances without n where the bound of a point with shear resistance is zero."""
        if self.active[0, self._sheared].all():
            return compliance
        return replace(compliance, normal=np.where(self.active[0], compliance.normal, 0.0))

    def _take(self, values: FloatArray) -> FloatArray:
        return values if self._all_sheared else np.take(values, self._sheared, axis=-1)

    def _put(self, out: FloatArray, cone: FloatArray) -> None:
        out[:, slice(None) if self._all_sheared else self._sheared] = cone


def _cone_compliance(scaling: SecondOrderScaling, slope: FloatArray, stiffness: FloatArray) -> CoulombCompliance:
    """Return the compliances of points with shear; stiffness (count,): what resists n besides the cone.

    In the directions (n, along w_1) the stiffness Q + G^T W^-2 G is a 2 x 2 block with determinant
    (a (2 r^2 + 1) + slope^2) / eta^4, r = |w_1|, a = eta^2 stiffness; across w_1 it is 1 / eta^2. Nothing cancels.
    """
    w0, w1 = scaling.w[0, 0], scaling.w[1:, 0]
    square = scaling.eta[0] ** 2
    length = np.sqrt(w1[0] ** 2 + w1[1] ** 2)
    stretch = 1.0 + 2.0 * length**2
    still = length == 0.0
    direction = np.where(still, np.array([[1.0], [0.0]]), w1) / np.where(still, 1.0, length)
    return CoulombCompliance(
        normal=square * stretch / (square * stiffness * stretch + slope**2),
        lean=2.0 * slope * w0 * length / stretch,
        along=square / stretch,
        across=square,
        direction=direction,
    )


@numba.njit(cache=True, error_model="numpy")
def _comply(
    normal: FloatArray,
    lean: FloatArray,
    along: FloatArray,
    across: FloatArray,
    direction: FloatArray,
    force: FloatArray,
    out: FloatArray,
) -> None:
    for k in range(force.shape[1]):
        u, v = direction[0, k], direction[1, k]
        push = force[1, k] * u + force[2, k] * v
        side = across[k] * (force[2, k] * u - force[1, k] * v)
        out[0, k] = normal[k] * (force[0, k] + lean[k] * push)
        slide = along[k] * push + lean[k] * out[0, k]
        out[1, k] = slide * u - side * v
        out[2, k] = slide * v + side * u
