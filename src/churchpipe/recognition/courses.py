"""Course heights and stone lengths of drawn walls."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from churchpipe.geometry.planar import Polygons, areas, bounds
from churchpipe.model.arrays import BoolArray, FloatArray
from churchpipe.model.building import UnitCell

# A front that fills this share of the rectangle around it is a rectangle, but for the rounding of its corners.
_WHOLE = 0.95
# Sizes that differ by less than this share are one, drawn with little care.
_ALIKE = 0.02


@dataclass(frozen=True, slots=True)
class Courses:
    """Courses of a wall: their height and the length of its stones, m, by how much these stones differ in height, m, how many
    courses there are, and the volume of the wall, m3."""

    height: float
    length: float
    spread: float
    count: float
    volume: float


def courses_of(elevations: Polygons, volume: FloatArray) -> Courses:
    """Return the courses of a wall from the fronts (n,) of its stones and their volume (n,), m3: sizes with most volume."""
    low_s, low_t, high_s, high_t = bounds(elevations).T
    height, length = high_t - low_t, high_s - low_s
    # A stone that the slope of a gable cuts is lower than its course, if only by a hair.
    whole = areas(elevations) > _WHOLE * length * height
    weight = np.where(whole, volume, 0.0) if whole.any() else volume
    most = _most_common(height, weight)
    a = float(np.average(height[most], weights=weight[most]))
    long = _most_common(length, weight)
    b = float(np.average(length[long], weights=weight[long]))
    spread = float(np.ptp(height[most & (weight > 0)]))
    return Courses(a, b, spread, float(high_t.max() - low_t.min()) / a, float(volume.sum()))


def unit_cells(walls: Sequence[Courses]) -> list[UnitCell]:
    """Return the unit cells of walls, to the micrometre.

    Courses that are drawn alike but for rounded coordinates have one height, so that they line up where walls meet: over the
    height of the wall they then come apart by no more than stones of one wall differ.
    """
    height = np.array([wall.height for wall in walls])
    order = np.argsort(height)
    group = np.zeros(len(walls), dtype=np.int64)
    for one, other in pairwise(order):
        group[other] = group[one] + (not _line_up(walls[one], walls[other]))
    volume = np.array([wall.volume for wall in walls])
    mean = np.bincount(group, height * volume) / np.bincount(group, volume)
    return [UnitCell(round(float(a), 6), round(wall.length, 6)) for a, wall in zip(mean[group], walls, strict=True)]


def _line_up(one: Courses, other: Courses) -> bool:
    """Return whether courses come apart, up to the top, by no more than stones of one wall differ in height."""
    return abs(one.height - other.height) * max(one.count, other.count) <= max(one.spread, other.spread)


def _most_common(values: FloatArray, weights: FloatArray) -> BoolArray:
    """Return which values belong to those alike that have most weight together."""
    order = np.argsort(values)
    group = np.empty(len(values), dtype=np.int64)
    group[order] = np.concatenate([[0], np.cumsum(np.diff(values[order]) > _ALIKE * values[order][:-1])])
    return group == np.argmax(np.bincount(group, weights))
