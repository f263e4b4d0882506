"""Stones too small to lay, merged into a neighbour."""

from dataclasses import dataclass

import numpy as np

from churchpipe.errors import InputError
from churchpipe.geometry.charts import ALONG
from churchpipe.geometry.planar import Polygons, areas, bounds, has_hole, polygons_of, shared_edges, united
from churchpipe.geometry.polygons import TOLERANCE, corners
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.building import UnitCell

# Smallest stone, as shares of the course height a and the stone length b: width / b, height / a, area / (a b).
LEAST_WIDTH, LEAST_HEIGHT, LEAST_AREA = 0.25, 0.3, 0.3


@dataclass(frozen=True, slots=True)
class _Flaws:
    narrow: BoolArray
    low: BoolArray
    small: BoolArray
    whole: BoolArray

    @property
    def any(self) -> BoolArray:
        return self.narrow | self.low | self.small


def merge_slivers(polygons: Polygons, course: IntArray, cell: UnitCell, where: str) -> tuple[Polygons, IntArray]:
    """Return the tiles with every sliver merged into a neighbour, and their courses.

    A sliver is narrower than b/4, lower than 0.3 a or smaller than 0.3 a b, with a the course height and b the stone length. It
    is merged with the neighbour with which it shares the longest edge; a neighbour in its own course comes first if the sum is
    large enough. A stone alone in its course between two ends or openings stays unless it is narrower than b/4.

    Raises
    ------
    InputError: a sliver without a neighbour that it can be merged with.
    """
    polygons, course = polygons.copy(), course.copy()
    flaws = _flaws(polygons, cell)
    alone = np.zeros(len(polygons), dtype=np.bool_)
    while (flaws.any & ~alone).any():
        waiting = np.flatnonzero(flaws.any & ~alone)
        sliver = int(waiting[np.argmin(areas(polygons[waiting]))])
        neighbours, shared = _neighbours(polygons, sliver)
        beside = course[neighbours] == course[sliver]
        if flaws.whole[sliver] and not beside.any():
            if flaws.narrow[sliver]:
                raise _error(polygons[[sliver]], cell, where, "the masonry is narrower than a quarter of a stone")
            alone[sliver] = True
            continue
        # A thin plate is no better for being longer: it takes a neighbour beside it only if that one is high enough.
        useful = beside & ~(flaws.low[neighbours] & flaws.low[sliver])
        takers = neighbours[np.lexsort((neighbours, -shared, ~useful))]
        unions = np.array([united(polygons[[sliver, taker]]) for taker in takers], dtype=np.object_)
        simple = np.flatnonzero(~has_hole(unions))
        if not len(simple):
            raise _error(polygons[[sliver]], cell, where, "a sliver has no neighbour to be merged into")
        taker = takers[simple[0]]
        larger = sliver if areas(polygons[[sliver]]) > areas(polygons[[taker]]) else taker
        course[taker] = course[larger]
        polygons[taker] = polygons_of(*corners(unions[simple[:1]]))[0]
        kept = np.arange(len(polygons)) != sliver
        polygons, course, alone = polygons[kept], course[kept], alone[kept]
        flaws = _flaws(polygons, cell)
    return polygons, course


def _flaws(polygons: Polygons, cell: UnitCell) -> _Flaws:
    low_s, low_t, high_s, high_t = bounds(polygons).T
    width, height, area = high_s - low_s, high_t - low_t, areas(polygons)
    return _Flaws(
        narrow=width < LEAST_WIDTH * cell.b - TOLERANCE,
        low=height < LEAST_HEIGHT * cell.a - TOLERANCE,
        small=area < (LEAST_AREA - TOLERANCE) * cell.a * cell.b,
        whole=area > (1 - 1e-6) * width * np.maximum(height, cell.a),
    )


def _neighbours(polygons: Polygons, index: int) -> tuple[IntArray, FloatArray]:
    """Return the tiles that share an edge with one tile, and the length they share, m."""
    low_s, low_t, high_s, high_t = bounds(polygons).T
    near = (
        (low_s <= high_s[index] + TOLERANCE)
        & (high_s >= low_s[index] - TOLERANCE)
        & (low_t <= high_t[index] + TOLERANCE)
        & (high_t >= low_t[index] - TOLERANCE)
    )
    near[index] = False
    found = np.flatnonzero(near)
    shared = shared_edges(polygons[found], polygons[index])
    edge = shared > TOLERANCE
    return found[edge], shared[edge]


def _error(sliver: Polygons, cell: UnitCell, where: str, problem: str) -> InputError:
    low_s, low_t, high_s, high_t = bounds(sliver)[0]
    return InputError(
        where,
        problem,
        found=f"{high_s - low_s:.4g} x {high_t - low_t:.4g} m, {low_s:.4g} {ALONG} and {low_t:.4g} m up",
        expected=f"at least {LEAST_WIDTH * cell.b:.4g} x {LEAST_HEIGHT * cell.a:.4g} m",
        remedy="Move openings, ends of lintels or joints, or use shorter stones.",
    )
