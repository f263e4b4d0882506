"""The joists of a flexible floor, as ties between its walls."""

import numpy as np

from churchpipe.errors import InputError
from churchpipe.geometry.walls import wall_line
from churchpipe.loading.bearing import bearing_stones
from churchpipe.loading.floors import FloorLine, floor_lines
from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.diaphragm import Diaphragm
from churchpipe.model.ties import Anchor, Tie

# A floor with more is refused: each is a tie of the analysis.
MOST_JOISTS = 500
# How what governs the strength of a joist ends.
AT_BEARINGS = "at its bearings"


def joists_of(stones: Assemblage, floor: Diaphragm) -> list[Tie]:
    """Return the joists of a floor, each in the middle of its strip.

    A joist bears dead x half its span x the width of its strip at each end, and holds friction x that + its fixing.

    Raises
    ------
    InputError: as `place_loads` of an area load.
    """
    lines = floor_lines(floor, [wall_line(stones, name, floor.called) for name in floor.walls])
    length = lines[0].end - lines[0].begin
    count = max(1, round(length / floor.spacing))
    if count > MOST_JOISTS:
        expected = f"at most {MOST_JOISTS} joists"
        remedy = "Look whether the spacing is in another unit, or take several joists as one."
        raise InputError(f"{floor.called}: spacing", "too many joists", found=f"{count:,}", expected=expected, remedy=remedy)
    strength = floor.friction * floor.dead * lines[0].width(0.0) * length / count + floor.fixing
    width, height = floor.joist
    held_by = "friction and fixing" if floor.friction and floor.fixing else "fixing" if floor.fixing else "friction"
    ties: list[Tie] = []
    for number in range(count):
        share = (number + 0.5) / count
        ends = [_end(stones, floor, line, line.begin + share * length) for line in lines]
        (start, first), (end, last) = ends
        ties.append(
            Tie(
                f"{floor.name or ' '.join(floor.walls)} {number + 1}",
                start,
                end,
                strength=strength,
                anchors=(first, last),
                stiffness=floor.modulus * width * height / float(np.linalg.norm(end - start)),
                ultimate=np.inf if floor.bearing_length is None else floor.bearing_length,
                governs=f"{held_by} {AT_BEARINGS}",
                seated=True,
            )
        )
    return ties


def _end(stones: Assemblage, floor: Diaphragm, line: FloorLine, along: float) -> tuple[FloatArray, Anchor]:
    """Return where a joist bears on a wall (3,) m, and the stones there."""
    place = line.wall.at(along, line.aside)
    height, on_top = (line.wall.top, True) if floor.height is None else (floor.height, False)
    where = f"{floor.called}, wall {line.wall.name}"
    found = bearing_stones(stones, place, place, height, on_top=on_top, where=where)
    point = np.column_stack([np.tile(place, (len(found.stone), 1)), found.z[:, 0]])
    return point.mean(axis=0), Anchor(found.stone, point, found.share, stones.panel[found.stone])
