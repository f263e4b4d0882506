"""The stones of a wall as flat polygons, each with the part of the wall's thickness that it fills."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from churchpipe.geometry.planar import Polygons, polygons_of
from churchpipe.geometry.polygons import TOLERANCE, corners, polygon_areas
from churchpipe.model.arrays import (
    BoolArray,
    FloatArray,
    IntArray,
    NameArray,
    pointer_of,
    pointers,
    ragged_indices,
    store,
    store_arrays,
)


@dataclass(frozen=True, slots=True)
class TileSet:
    """Stones in chart coordinates: simple polygons, counter-clockwise, that fill a region of the wall exactly once.

    Fields: corner (nc, 2) m; corner_ptr (nt + 1,): tile i has the corners `corner_ptr[i]:corner_ptr[i + 1]`; course (nt,),
    counted from 0 at t = 0, -1 for voussoirs; region (nt,) name of the bond region; reach (nt, 2): where each begins and ends
    across the wall, in thicknesses from the mid-surface, -1/2 to 1/2 for one that goes through; voussoir (nt,): which are
    voussoirs.
    """

    corner: FloatArray
    corner_ptr: IntArray
    course: IntArray
    region: NameArray
    reach: FloatArray
    voussoir: BoolArray

    def __post_init__(self) -> None:
        count = len(self.course)
        course = np.array(self.course, dtype=np.int64)
        course.setflags(write=False)
        store_arrays(self, corner=(None, 2), region=(count,), reach=(count, 2), voussoir=(count,))
        store(self, corner_ptr=pointers("TileSet.corner_ptr", self.corner_ptr, count, len(self.corner)), course=course)

    @property
    def count(self) -> int:
        """Number of tiles."""
        return len(self.course)

    @property
    def area(self) -> FloatArray:
        """Area of each tile (nt,) m2."""
        return polygon_areas(self.corner, self.corner_ptr)

    @property
    def polygons(self) -> Polygons:
        """The tiles as polygons (nt,)."""
        return polygons_of(self.corner, self.corner_ptr)


def tiles_of(polygons: Polygons, course: IntArray, region: str, *, voussoir: bool = False) -> TileSet:
    """Return the tile set of one region from its polygons, all as thick as the wall and all voussoirs or none."""
    corner, corner_ptr = corners(polygons)
    through = np.tile([-0.5, 0.5], (len(polygons), 1))
    return TileSet(
        corner, corner_ptr, course, np.array([region] * len(polygons), dtype=np.str_), through, np.full(len(polygons), voussoir)
    )


def beside(tiles: TileSet, rectangles: FloatArray) -> BoolArray:
    """Return which tiles (nt,) end at an upright side of one of some rectangles (n, 4): s0, t0, s1, t1, m."""
    low, high = (edge.reduceat(tiles.corner, tiles.corner_ptr[:-1])[:, None] for edge in (np.minimum, np.maximum))
    begin, end = rectangles[:, :2], rectangles[:, 2:]
    meets = (np.abs(high[..., 0] - begin[:, 0]) < TOLERANCE) | (np.abs(low[..., 0] - end[:, 0]) < TOLERANCE)
    level = np.minimum(high[..., 1], end[:, 1]) - np.maximum(low[..., 1], begin[:, 1]) > TOLERANCE
    return np.any(meets & level, axis=1)


def leaves_of(tiles: TileSet, split: BoolArray) -> TileSet:
    """Return the tiles; those marked in split (nt,) become two, which fill one half of the wall's thickness each."""
    twice = np.repeat(np.arange(tiles.count), 1 + split)
    second = np.append(False, twice[1:] == twice[:-1])
    reach = tiles.reach[twice]
    reach[split[twice] & ~second, 1] = reach[second, 0] = 0.0
    return _picked(tiles, twice, reach)


def join(sets: Sequence[TileSet]) -> TileSet:
    """Return one tile set out of several."""
    offsets = np.cumsum([0] + [len(tiles.corner) for tiles in sets])
    return TileSet(
        np.concatenate([tiles.corner for tiles in sets]),
        np.concatenate([[0], *(tiles.corner_ptr[1:] + offset for tiles, offset in zip(sets, offsets[:-1], strict=True))]),
        np.concatenate([tiles.course for tiles in sets]),
        np.concatenate([tiles.region for tiles in sets]),
        np.concatenate([tiles.reach for tiles in sets]),
        np.concatenate([tiles.voussoir for tiles in sets]),
    )


def sorted_by_course(tiles: TileSet) -> TileSet:
    """Return the tiles ordered by course and then by s, voussoirs last. Tiles at the same place keep their order."""
    along = np.where(tiles.voussoir, np.arange(tiles.count), tiles.corner[tiles.corner_ptr[:-1], 0])
    order = np.lexsort((along, tiles.course, tiles.voussoir))
    return _picked(tiles, order, tiles.reach[order])


def _picked(tiles: TileSet, chosen: IntArray, reach: FloatArray) -> TileSet:
    """Return the tiles with these numbers, in this order, with another reach."""
    counts = np.diff(tiles.corner_ptr)[chosen]
    return TileSet(
        tiles.corner[ragged_indices(tiles.corner_ptr[:-1][chosen], counts)],
        pointer_of(counts),
        tiles.course[chosen],
        tiles.region[chosen],
        reach,
        tiles.voussoir[chosen],
    )
