"""Where the lintels of a house end, so that no sliver of masonry is left beside them."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import permutations

from churchpipe.bond.slivers import LEAST_WIDTH
from churchpipe.generators.arched import Hole, WallOpening, holes
from churchpipe.generators.house_openings import FlatOpening
from churchpipe.generators.layout import WallLayout, top_at
from churchpipe.model.building import UnitCell

Stop = tuple[float, float, float]


def between_stops(openings: Sequence[WallOpening], layouts: Sequence[WallLayout], cell: UnitCell) -> tuple[WallOpening, ...]:
    """Return openings whose lintels go on to, or end at, what is beside them in their walls: another wall, an opening, a lintel.

    cell: of the walls.
    """
    stops = {
        layout.name: [*_of_walls(layout, layouts), *_of_openings(holes(openings, layout.name), cell.b)] for layout in layouts
    }
    return tuple(replace(one, stops=stops) if isinstance(one, FlatOpening) else one for one in openings)


def _of_walls(layout: WallLayout, layouts: Sequence[WallLayout]) -> Iterator[Stop]:
    """Yield the ends of a wall, and the faces of those that cross it."""
    yield from ((end, layout.foot, layout.height) for end in layout.span)
    for other in layouts:
        height = top_at(other, layout.at)
        if other.along != layout.along and height > other.foot:
            yield from ((other.at + sign * other.thickness / 2, other.foot, height) for sign in (-1, 1))


def _of_openings(found: Sequence[Hole], stone: float) -> Iterator[Stop]:
    """Yield the jambs of the openings of one wall, the ends of lintels that are given, and the middles of piers that two lintels
    of half a stone of bearing would fill but for a sliver. stone: length, m.
    """
    for hole in found:
        (s0, low), (s1, high) = hole.opening.outline.min(axis=0).tolist(), hole.opening.outline.max(axis=0).tolist()
        yield from ((s0, low, high), (s1, low, high))
        if hole.around == "lintel" and abs(s0 - hole.outer[0] - stone / 2) > 1e-9:
            yield from ((hole.outer[0], high, hole.outer[3]), (hole.outer[2], high, hole.outer[3]))
    for left, right in permutations((hole for hole in found if hole.around == "lintel"), 2):
        stop, start = float(left.opening.outline[:, 0].max()), float(right.opening.outline[:, 0].min())
        low = max(float(hole.opening.outline[:, 1].max()) for hole in (left, right))
        high = min(left.outer[3], right.outer[3])
        if low < high and 0 < start - stop < (1 + LEAST_WIDTH) * stone:
            yield (start + stop) / 2, low, high
