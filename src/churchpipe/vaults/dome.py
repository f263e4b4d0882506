"""Domes, half domes, drums and lanterns: rings of stones about an axis, between upright planes through it."""

import math
from collections.abc import Sequence

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arrays import FloatArray
from churchpipe.model.vault import Section
from churchpipe.vaults.directrix import Directrix, between, circular
from churchpipe.vaults.sweep import Courses, polygon_sides

# Stones of a whole ring, at least: wider ones would be bowed too much.
_LEAST_STONES = 8


def meridian(inner: float, thickness: float, latitudes: FloatArray) -> list[Section]:
    """Return the sections of a spherical dome's rings, (distance from the axis, z) m, joints at latitudes (m + 1,) rad."""
    return circular(inner, thickness, latitudes).sections


def cap(directrix: Directrix, crown: tuple[float, float]) -> Section:
    """Return the section of the stone that closes a dome above its last joint, z of its lower and upper face at the axis, m."""
    lower = directrix.joints[-1]
    return between(lower, np.array([[0.0, crown[0]], [0.0, crown[1]]]))


def add_rings(
    courses: Courses,
    sections: Sequence[Section],
    *,
    centre: tuple[float, float],
    sectors: int,
    width: int,
    part: str | Sequence[str],
    stagger: bool = True,
    turn: float = 2 * math.pi,
    shortest: float = 0.0,
    where: str = "dome",
) -> None:
    """Add rings with these sections, (distance from the axis, z) m, one above the other.

    Parameters
    ----------
    sectors: flat sides of a ring, within `turn` rad from x on. width: sides of one stone. stagger: whether rings of odd number
    are shifted by half a stone; False lays lunes. part: macro-element of each ring, or of all. shortest: length, m, below which
    stones double their width, as in `stone_widths`. where: the parameters, for messages.
    """
    if sectors % width:
        raise InputError("dome", "stones do not go round", found=f"{sectors} sides, {width} a stone", expected="a whole number")
    if stagger and width % 2:
        raise InputError(
            "dome",
            "stones cannot be staggered",
            found=f"{width} sides a stone",
            expected="an even number",
            remedy="Take lunes, or stones two sides wide.",
        )
    full = abs(turn - 2 * math.pi) < 1e-12
    half = turn / sectors / 2
    slope = math.tan(half)
    around = polygon_sides(centre, sectors, turn=turn)
    parts = [part] * len(sections) if isinstance(part, str) else list(part)
    flat = [section.stretched(math.cos(half)) for section in sections]
    closing = [bool((section.corner[:, 0] < 1e-9).any()) for section in flat]
    # One side of a stone at half the ring's height: the unit cell has the length of a stone there.
    side_length = [slope * float(section.lower[0] + section.upper[0]) for section in flat]
    widths = [width] * len(sections)
    if shortest > 0:
        if not stagger:
            raise InputError(f"{where}.shortest_stone", "lunes keep their joints to the crown", expected="staggered rings")
        rings = side_length[: closing.index(True)] if any(closing) else side_length
        most = sectors // (_LEAST_STONES if full else _LEAST_STONES // 2)
        widths = stone_widths(f"{where}.shortest_stone", rings, sectors, width, most, shortest)
        widths += [widths[-1]] * (len(sections) - len(rings))
    for ring, (section, own, wide) in enumerate(zip(flat, parts, widths, strict=True)):
        shift = wide // 2 if stagger and ring % 2 else 0
        for k, side in enumerate(around):
            place = k + shift
            stone = 0 if closing[ring] else (place % sectors if full else place) // wide
            length = wide * side_length[ring]
            courses.add(section, side, [(0.0, -slope), (0.0, slope)], [stone], course=ring, part=own, length=length)


def stone_widths(where: str, side_length: Sequence[float], sectors: int, width: int, most: int, shortest: float) -> list[int]:
    """Return how many sides a stone of each ring covers: twice as many from where stones would be shorter than `shortest`, m.

    Rings of odd number are shifted by half a stone. Only a ring that is not shifted may have wider stones than the one below: so
    no head lies over a head. Where the next ring would be too short, this one is wider already.

    Parameters
    ----------
    side_length: of one side in each ring, m. most: sides of a stone, at most.

    Raises
    ------
    InputError: stones of the first two rings that are shorter.
    """
    least = width * min(side_length[:2])
    if least < shortest:
        raise InputError(where, "longer than the stones at the springing", found=f"{shortest:g} m", expected=f"<= {least:.4g} m")
    found = [width]
    for ring in range(1, len(side_length)):
        wide = found[-1]
        short = wide * min(side_length[ring : ring + 2]) < shortest
        fits = ring % 2 == 0 and 2 * wide <= most and sectors % (2 * wide) == 0
        found.append(2 * wide if short and fits else wide)
    return found
