"""The displacement that a curve is drawn against."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from churchpipe.errors import InputError
from churchpipe.large_displacements.poses import Poses, rotation_vectors
from churchpipe.large_displacements.supports import SupportMovement
from churchpipe.large_displacements.travelling import live_loads
from churchpipe.model.arrays import BoolArray, FloatArray, floats
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.loads import LoadCase
from churchpipe.model.stone_path import FallenStones

# A control point that goes less than this share of the stone that goes furthest stands still.
_STILL = 0.01


@dataclass(frozen=True, slots=True)
class MeanDisplacement:
    """The mean displacement of points of the stones along the forces that act there, weighed by these.

    force (nb, 3) N; virial (nb, i, j) Nm as in `TravellingLoads`: zeros for the centroids.
    """

    force: FloatArray
    virial: FloatArray

    def between(self, before: Poses, after: Poses, standing: BoolArray) -> float:
        """Return how far it has gone between poses, m; standing (nb,): stones that have not fallen."""
        force = np.where(standing[:, None], self.force, 0.0)
        total = float(np.linalg.norm(force, axis=1).sum())
        virial = np.where(standing[:, None, None], self.virial, 0.0)
        turned = np.einsum("kji,kij->", after.rotation - before.rotation, virial)
        return float((force * (after.centroid - before.centroid)).sum() + turned) / total


@dataclass(frozen=True, slots=True)
class ControlPoint:
    """The displacement along a direction (3,) of a point of one stone; arm (3,) m from its centroid, as drawn."""

    stone: int
    arm: FloatArray
    direction: FloatArray

    def between(self, before: Poses, after: Poses, standing: BoolArray) -> float:
        """Return how far it has gone between poses, m; a stone that has fallen (standing (nb,) False) goes no further."""
        if not standing[self.stone]:
            return 0.0
        one = np.array([self.stone])
        return float((after.place(one, self.arm[None]) - before.place(one, self.arm[None]))[0] @ self.direction)


@dataclass(frozen=True, slots=True)
class SupportTravel:
    """How far a support has moved along its prescribed movement, m, or turned about its axis, rad."""

    support: SupportMovement

    def between(self, before: Poses, after: Poses, _: BoolArray) -> float:
        """Return how far it has gone between poses."""
        one = self.support.stones[:1]
        if self.support.about is None:
            return float((after.centroid[one] - before.centroid[one])[0] @ self.support.direction)
        turn = np.einsum("kij,klj->kil", after.rotation[one], before.rotation[one])
        return float(rotation_vectors(turn)[0] @ self.support.direction)


Control = MeanDisplacement | ControlPoint | SupportTravel


def control_of(stones: Assemblage, load: LoadCase, control: npt.ArrayLike | None) -> Control:
    """Return what the curve of a load case is drawn against: a point (3,) m of the drawing, or, None, the mean of what is pushed.

    Raises
    ------
    InputError: a point beside the free stones, a load without forces.
    """
    where = "block_pushover: control"
    if control is None:
        live = live_loads(stones, load)
        if not live.force.any():
            raise InputError(where, "nothing is pushed by a force", expected="a control point (x, y, z) m")
        # A push is measured at the centroids of the stones. A load that grows acts beside them, where it may go the other way.
        virial = live.virial * (0.0 if load.direction.any() else 1.0)
        return MeanDisplacement(live.force, virial)
    if not load.direction.any():
        raise InputError(where, "the load has no direction to measure a point along", found=control, expected="None")
    point = floats(where, control, (3,))
    owner = np.repeat(np.arange(stones.count), np.diff(stones.block_point_ptr))
    free = np.flatnonzero(~stones.fixed[owner])
    low, high = stones.points[free].min(axis=0), stones.points[free].max(axis=0)
    if ((point < low - 1e-6) | (point > high + 1e-6)).any():
        raise InputError(
            where,
            "a point outside the free stones",
            found=point.tolist(),
            expected=f"a point between {low.round(4).tolist()} and {high.round(4).tolist()} m",
        )
    stone = int(owner[free[np.argmin(np.linalg.norm(stones.points[free] - point, axis=1))]])
    return ControlPoint(stone, point - stones.centroid[stone], load.direction)


def furthest_move(before: Poses, after: Poses) -> float:
    """Return how far the centroid that goes furthest has gone between poses, m."""
    return float(np.linalg.norm(after.centroid - before.centroid, axis=1).max(initial=0.0))


def control_said(control: Control, gone: Sequence[float], largest: Sequence[float], fallen: Sequence[FallenStones]) -> list[str]:
    """Return what is to be said of the point that a curve is drawn against: where it tells little of the motion, or falls.

    gone (ns,) m: its displacement; largest (ns,) m: of the stone that goes furthest.
    """
    if not isinstance(control, ControlPoint):
        return []
    said: list[str] = []
    reach, furthest = max(map(abs, gone), default=0.0), max(largest, default=0.0)
    if reach < _STILL * furthest:
        said.append(
            f"the control point goes {1e3 * reach:.2g} mm along the load where a stone goes {1e3 * furthest:.3g} mm, "
            "so that the displacements of the curve say nothing of this mechanism"
        )
    for part in fallen:
        if control.stone in part.stones:
            place = f"{1e3 * part.displacement:.3g} mm"
            said.append(f"the control point falls with its stone at {place}, where the displacements of the curve stand still")
    return said
