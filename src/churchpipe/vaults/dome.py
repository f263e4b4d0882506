"""Domes, half domes, drums and lanterns: rings of stones about an axis, between upright planes through it."""

import math
from collections.abc import Sequence

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arrays import FloatArray
from churchpipe.model.vault import Section
from churchpipe.vaults.directrix import Directrix, between, circular
from churchpipe.vaults.sweep import Courses, polygon_sides


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
    start: float = 0.0,
    turn: float = 2 * math.pi,
    first: int = 0,
) -> None:
    """Add rings with these sections, (distance from the axis, z) m, one above the other.

    Parameters
    ----------
    sectors: flat sides of a ring, within `turn` rad from `start`. width: sides of one stone. stagger: whether rings of odd number
    are shifted by half a stone; False lays lunes. part: macro-element of each ring, or of all. first: number of the first ring.
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
    sides = polygon_sides(centre, sectors, start, turn)
    parts = [part] * len(sections) if isinstance(part, str) else list(part)
    for ring, (section, own) in enumerate(zip(sections, parts, strict=True), start=first):
        flat = section.stretched(math.cos(half))
        closing = bool((flat.corner[:, 0] < 1e-9).any())
        shift = width // 2 if stagger and ring % 2 else 0
        # The unit cell's length: of a stone at half the ring's height.
        length = width * 2 * slope * 0.5 * float(flat.lower[0] + flat.upper[0])
        for k, side in enumerate(sides):
            place = k + shift
            stone = 0 if closing else (place % sectors if full else place) // width
            courses.add(flat, side, [(0.0, -slope), (0.0, slope)], [stone], course=ring, part=own, length=length)
