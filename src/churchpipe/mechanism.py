"""What moves in a collapse mechanism, and how much of each named part."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from churchpipe.model.arrays import BoolArray, FloatArray, IntArray, NameArray, ragged_indices
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.quantities import Quantity

# A stone slower than this share of the mechanism's speed stands still: solvers leave such a dust of velocities.
STILL = 1e-3
# A macro-element takes part in a mechanism when it has this share of the motion.
TAKES_PART = 0.05
# What stones that stand in no wall are called, as those of a drawing may.
UNNAMED = "unnamed"


@dataclass(frozen=True, slots=True)
class Part:
    """A macro-element in a mechanism.

    weight: all of it. moving: the share of it that moves. displacement: its mean displacement along the load, weighed by
    weight, over the largest one among the parts. motion: its share of the whole motion, weight x speed.
    """

    name: str
    weight: Annotated[float, Quantity("_kN")]
    moving: float
    displacement: float
    motion: float


def parts(
    panel: NameArray, weight: FloatArray, velocity: FloatArray, moving: BoolArray, direction: FloatArray
) -> tuple[Part, ...]:
    """Return the macro-elements of a mechanism, those with most of the motion first.

    Parameters
    ----------
    panel: names (n,) of the parts that the bodies belong to. weight: (n,) N, 0 for ground, whose parts are left out.
    velocity: (n, 3) of the bodies at their centroids. moving: (n,) whether each takes part. direction: (3,) of the load.
    """
    weighty = weight > 0
    names, part = np.unique(panel[weighty], return_inverse=True)
    weight, velocity, moving = weight[weighty], velocity[weighty], moving[weighty]

    def total(values: FloatArray) -> FloatArray:
        return np.bincount(part, weight * values, len(names)).astype(float)

    own = total(np.ones(len(weight)))
    mean = total(np.where(moving, velocity @ direction, 0.0)) / own
    motion = total(np.where(moving, np.linalg.norm(velocity, axis=1), 0.0))
    largest, whole = float(np.abs(mean).max(initial=0.0)), float(motion.sum())
    columns = (own, total(moving.astype(float)) / own, mean / (largest or 1.0), motion / (whole or 1.0))
    found = [Part(str(name) or UNNAMED, *map(float, values)) for name, *values in zip(names, *columns, strict=True)]
    return tuple(sorted(found, key=lambda one: -one.motion))


def mechanism_name(found: Sequence[Part]) -> str:
    """Return what tells a mechanism from others: the names of the macro-elements that take part in it."""
    return ", ".join(sorted(part.name for part in found if part.motion >= TAKES_PART))


def stone_of_point(stones: Assemblage) -> IntArray:
    """Return the stone (nv,) that each point belongs to."""
    return np.repeat(np.arange(stones.count, dtype=np.int64), np.diff(stones.block_point_ptr))


def stone_speed(stones: Assemblage, velocities: FloatArray) -> FloatArray:
    """Return the speed (nb,) of the fastest vertex of each stone; velocities (nb, 6): translation of the centroid, rotation."""
    speed, moving = np.zeros(stones.count), np.flatnonzero(velocities.any(axis=1))
    if not len(moving):
        return speed
    # On a path most stones of a building are held, and this is asked for many times a step.
    first, count = stones.block_point_ptr[moving], np.diff(stones.block_point_ptr)[moving]
    owner = np.repeat(moving, count)
    arm = stones.points[ragged_indices(first, count)] - stones.centroid[owner]
    velocity = velocities[owner, :3] + np.cross(velocities[owner, 3:], arm)
    speed[moving] = np.maximum.reduceat(np.linalg.norm(velocity, axis=1), np.append(0, np.cumsum(count)[:-1]))
    return speed


def reference_speed(speed: FloatArray) -> float:
    """Return the speed that stands for the mechanism: most moving stones are slower, and none is more than 4 times faster."""
    fastest = float(speed.max(initial=0.0))
    if fastest == 0.0:
        return 0.0
    return max(float(np.percentile(speed[speed > STILL * fastest], 98)), fastest / 4)


def start_height(stones: Assemblage, moving: BoolArray) -> float:
    """Return the height, m, of the lowest corner of the moving stones (nb,) above that of all free ones; NaN where none moves."""
    lowest = np.minimum.reduceat(stones.points[:, 2], stones.block_point_ptr[:-1])
    return float(lowest[moving].min() - lowest[~stones.fixed].min()) if moving.any() else float("nan")


def moving_stones(speed: FloatArray) -> BoolArray:
    """Return True (nb,) for the stones, or facets, that take part in the mechanism."""
    return speed > STILL * max(reference_speed(speed), np.finfo(float).tiny)
