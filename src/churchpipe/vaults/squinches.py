"""From a square room to an octagon: one course whose slabs lie across the corners."""

import math

from churchpipe.vaults.directrix import block
from churchpipe.vaults.sweep import Courses, polygon_sides


def add_squinches(
    courses: Courses,
    half: float,
    reach: float,
    levels: tuple[float, float],
    *,
    centre: tuple[float, float],
    part: tuple[str, str],
) -> None:
    """Add a level course on the walls of a square room that leaves a regular octagon open, with slabs across the corners.

    Parameters
    ----------
    half: half the width of the room, m. reach: distance of the course's outer face from the middle, m, at most sqrt(2) half.
    levels: z of its beds, m. part: macro-elements of the slabs, and of the stones on the walls between, numbered.
    """
    # Slabs and stones meet in the upright planes of the octagon's sloping sides, x + y = sqrt(2) half.
    line, edge = math.sqrt(2) * half, math.sqrt(2) * reach
    wall, slab = block(half, reach, *levels), block(half, edge, *levels)
    for number, side in enumerate(polygon_sides(centre, 4, -math.pi / 4)):
        courses.add(
            wall, side, [(-line, 1.0), (line, -1.0)], [number], course=0, part=f"{part[1]}_{number + 1}", length=2 * (line - half)
        )
    for number, side in enumerate(polygon_sides(centre, 4)):
        courses.add(
            slab, side, [(-edge, 1.0), (edge, -1.0)], [number], course=0, part=f"{part[0]}_{number + 1}", length=2 * (edge - half)
        )
