"""Barrels: courses along one straight side, or rings of voussoirs side by side."""

from collections.abc import Sequence

import numpy as np

from churchpipe.model.arrays import FloatArray
from churchpipe.model.vault import Section, Side
from churchpipe.vaults.sweep import Courses


def add_barrel(
    courses: Courses,
    sections: Sequence[Section],
    side: Side,
    span: tuple[float, float],
    stone_length: float,
    *,
    part: str,
    numbers: Sequence[int] | None = None,
    stagger: bool = True,
) -> None:
    """Add courses along a side, from s = span[0] to span[1], m.

    Parameters
    ----------
    numbers: the course that each section belongs to, by default one after the other. Sections of one course that share a joint
    are one stone: the two halves of a pointed key. stagger: whether the head joints of odd courses lie half a stone further.
    """
    for number, section in zip(range(len(sections)) if numbers is None else numbers, sections, strict=True):
        cuts = np.concatenate(
            [span[:1], span[0] + heads(span[1] - span[0], stone_length, odd=stagger and number % 2 == 1), span[1:]]
        )
        stations = np.stack([cuts, np.zeros(len(cuts))], axis=1)
        courses.add(section, side, stations, range(len(cuts) - 1), course=number, part=part, length=stone_length)


def add_arches(
    courses: Courses, halves: Sequence[Section], side: Side, cuts: FloatArray, *, part: str, stagger: bool = True
) -> None:
    """Add arches side by side, between the upright planes s = cuts (rings + 1,) m.

    Parameters
    ----------
    halves: an even number of sections, halves of voussoirs, so that all rings have the same surface. stagger: whether the
    voussoirs of odd rings lie half a voussoir further.
    """
    for number, section in enumerate(halves):
        stones = [(ring, (number + (ring % 2 if stagger else 0)) // 2) for ring in range(len(cuts) - 1)]
        stations = np.stack([cuts, np.zeros(len(cuts))], axis=1)
        courses.add(section, side, stations, stones, course=-1, part=part, length=float(np.diff(cuts).mean()))


def heads(length: float, stone: float, *, odd: bool) -> FloatArray:
    """Return where the inner head joints of a course lie, m from its start: at multiples of a stone or, on odd courses, half a
    stone before them; none is nearer to an end than a quarter of a stone."""
    place = stone * (np.arange(int(np.ceil(length / stone)) + 2, dtype=np.float64) - (0.5 if odd else 0.0))
    return place[(place > 0.25 * stone * (1 - 1e-9)) & (place < length - 0.25 * stone * (1 - 1e-9))]
