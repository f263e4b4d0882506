"""The stones of a wall as flat polygons."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from churchpipe.bond.planar import Polygons, polygons_of
from churchpipe.bond.polygons import corners, polygon_areas
from churchpipe.model.arrays import FloatArray, IntArray, NameArray, floats, names, pointers, ragged_indices, store


@dataclass(frozen=True, slots=True)
class TileSet:
    """Stones in chart coordinates: simple polygons, counter-clockwise, that cover a region exactly once.

    Fields: corner (nc, 2) m; corner_ptr (nt + 1,): tile i has the corners `corner_ptr[i]:corner_ptr[i + 1]`; course (nt,),
    counted from 0 at t = 0, -1 for voussoirs; region (nt,) name of the bond region.
    """

    corner: FloatArray
    corner_ptr: IntArray
    course: IntArray
    region: NameArray

    def __post_init__(self) -> None:
        count = len(self.course)
        course = np.array(self.course, dtype=np.int64)
        course.setflags(write=False)
        store(
            self,
            corner=floats("TileSet.corner", self.corner, (None, 2)),
            corner_ptr=pointers("TileSet.corner_ptr", self.corner_ptr, count, len(self.corner)),
            course=course,
            region=names("TileSet.region", self.region, (count,)),
        )

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


def tiles_of(polygons: Polygons, course: IntArray, region: str) -> TileSet:
    """Return the tile set of one region from its polygons."""
    corner, corner_ptr = corners(polygons)
    return TileSet(corner, corner_ptr, course, np.array([region] * len(polygons), dtype=np.str_))


def join(sets: Sequence[TileSet]) -> TileSet:
    """Return one tile set out of several."""
    offsets = np.cumsum([0] + [len(tiles.corner) for tiles in sets])
    return TileSet(
        np.concatenate([tiles.corner for tiles in sets]),
        np.concatenate([[0], *(tiles.corner_ptr[1:] + offset for tiles, offset in zip(sets, offsets[:-1], strict=True))]),
        np.concatenate([tiles.course for tiles in sets]),
        np.concatenate([tiles.region for tiles in sets]),
    )


def sorted_by_course(tiles: TileSet) -> TileSet:
    """Return the tiles course by course and along s; those without a course come last, in the order they have."""
    loose = tiles.course < 0
    along = np.where(loose, np.arange(tiles.count), tiles.corner[tiles.corner_ptr[:-1], 0])
    order = np.lexsort((along, tiles.course, loose))
    counts = np.diff(tiles.corner_ptr)[order]
    return TileSet(
        tiles.corner[ragged_indices(tiles.corner_ptr[:-1][order], counts)],
        np.concatenate(([0], np.cumsum(counts))),
        tiles.course[order],
        tiles.region[order],
    )
