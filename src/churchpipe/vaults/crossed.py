"""Groin vaults and cloister vaults: webs that meet in mitres, in valleys or in ridges."""

import math
from collections.abc import Hashable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Literal

import numpy as np

from churchpipe.model.arrays import FloatArray
from churchpipe.model.vault import Section, Side
from churchpipe.vaults.sweep import Courses, polygon_sides

# Which corner stones run round the mitre: those of all courses, of every other course, of none.
Corner = Literal["round", "alternate", "mitre"]
# A head joint keeps off the skew end of its web by this share of a stone.
_CLEAR = 0.4


def runs_round(corner: Corner, course: int) -> bool:
    """Return whether the corner stones of a course lie on both sides of the mitre."""
    return corner == "round" or (corner == "alternate" and course % 2 == 0)


def add_cloister(
    courses: Courses,
    sections: Sequence[Section],
    *,
    centre: tuple[float, float],
    sides: int,
    stone_length: float,
    part: str,
    corner: Corner = "round",
    stagger: bool = True,
    key: bool = True,
) -> None:
    """Add a vault over a regular polygon, whose webs meet in ridges seen from below: a pavilion of four sides, an octagon.

    Parameters
    ----------
    sections: from the springing to the crown, d measured from the axis to the middle of a side, m, of which the
    first is square to x. key: whether the last one is the stone that closes the vault.
    """
    slope = math.tan(math.pi / sides)
    around = polygon_sides(centre, sides, -math.pi / sides)
    for course, section in enumerate(sections):
        closing = key and course == len(sections) - 1
        odd = bool(course % 2) and stagger
        least = float(section.corner[:, 0].min()) * slope - _CLEAR * stone_length
        half = stone_length * (np.arange(int(max(least, 0.0) / stone_length) + 2) + (0.5 if odd else 0.0))
        half = half[half < least - 1e-9]
        cuts = np.unique(np.concatenate([-half, half])) if not closing else np.empty(0)
        stations = np.array([(0.0, -slope), *((s, 0.0) for s in cuts), (0.0, slope)])
        last = len(cuts)
        for k, side in enumerate(around):
            stones: list[Hashable] = [("web", k, piece) for piece in range(last + 1)]
            if runs_round(corner, course):
                # The first piece of a side and the last one of the side before it are one stone.
                stones[last] = ("corner", (k + 1) % sides) if last else "ring"
                stones[0] = ("corner", k) if last else "ring"
            if closing:
                stones = ["key"]
            courses.add(section, side, stations, stones, course=course, part=part, length=stone_length)


def add_groin(
    courses: Courses,
    webs: tuple[Sequence[Section], Sequence[Section]],
    *,
    centre: tuple[float, float],
    borders: tuple[float, float],
    ratio: float,
    stone_length: float,
    part: str,
    corner: Corner = "round",
    stagger: bool = True,
    key: bool = True,
) -> None:
    """Add two barrels that meet in groins: one along y, with d across it along x, and one along x.

    Parameters
    ----------
    webs: sections of both from the springing upwards, their joints at the same heights. key: whether the last one is half a key,
    up to d = 0. borders: where they end, m from the centre along y and along x. ratio: span of the second over that of the
    first; the groins lie in the upright planes s = d ratio.
    """
    last = len(webs[0]) - 1
    for octant in _octants(centre):
        slope, border = (1 / ratio if octant.swap else ratio), borders[octant.swap]
        for course, section in enumerate(webs[octant.swap]):
            cuts = _heads(section, slope, border, stone_length, odd=bool(course % 2) and stagger)
            stations = np.array([(0.0, slope), *((s, 0.0) for s in cuts), (border, 0.0)])
            stones = _stones(octant, key and course == last, runs_round(corner, course), len(cuts))
            courses.add(section, octant.side, stations, stones, course=course, part=part, length=stone_length)


def add_wall_arches(
    courses: Courses,
    ends: tuple[Sequence[Section], Sequence[Section]],
    *,
    centre: tuple[float, float],
    borders: tuple[float, float],
    width: float,
    part: str,
) -> None:
    """Add arches of a width, m, before the ends of the two barrels of a groin vault; sections and borders as in `add_groin`, the
    last section half a key."""
    last = len(ends[0]) - 1
    for octant in _octants(centre):
        border = borders[octant.swap]
        for course, section in enumerate(ends[octant.swap]):
            stone = ("key", octant.swap, octant.arm) if course == last else (octant.swap, octant.signs)
            courses.add(
                section, octant.side, [(border, 0.0), (border + width, 0.0)], [stone], course=course, part=part, length=2 * width
            )


def add_ribs(
    courses: Courses,
    ribs: tuple[Sequence[Section], Sequence[Section]],
    *,
    centre: tuple[float, float],
    ratio: float,
    width: float,
    part: str,
) -> None:
    """Add ribs of a width, m, below the groins of a groin vault, each stone round the groin as its corner stones are.

    Parameters
    ----------
    ribs: sections below the soffits of both webs, the last one half a key, as deep as the rib. ratio: as in `add_groin`.
    """
    last = len(ribs[0]) - 1
    for octant in _octants(centre):
        slope = 1 / ratio if octant.swap else ratio
        stations = [(0.0, slope), (0.5 * width * math.hypot(1, slope), slope)]
        for course, section in enumerate(ribs[octant.swap]):
            stone = "boss" if course == last else octant.signs
            courses.add(section, octant.side, stations, [stone], course=course, part=part, length=width)


@dataclass(frozen=True, slots=True)
class _Octant:
    """Half of one arm of a groin vault: of the barrel along y or, swapped, of that along x."""

    swap: bool
    signs: tuple[float, float]
    side: Side

    @property
    def arm(self) -> float:
        """On which side of the middle its arm lies."""
        return self.signs[0] if self.swap else self.signs[1]


def _octants(centre: tuple[float, float]) -> Iterator[_Octant]:
    for swap, sx, sy in product((False, True), (1.0, -1.0), (1.0, -1.0)):
        normal, along = ((0.0, sy), (sx, 0.0)) if swap else ((sx, 0.0), (0.0, sy))
        yield _Octant(swap, (sx, sy), Side(np.array(centre), np.array(normal), np.array(along)))


def _stones(octant: _Octant, key: bool, rounded: bool, cuts: int) -> list[Hashable]:
    if key:
        # The middle is one boss in the form of a cross; further out both halves of a web's key are one stone.
        return ["boss", *(("key", octant.swap, octant.arm, piece) for piece in range(cuts))]
    stones: list[Hashable] = [(octant.swap, octant.signs, piece) for piece in range(cuts + 1)]
    if rounded:
        stones[0] = ("corner", octant.signs)
    return stones


def _heads(section: Section, slope: float, border: float, stone: float, *, odd: bool) -> FloatArray:
    """Return s of the head joints, m, counted from the border, in order along the side."""
    place = border - stone * (np.arange(int(border / stone) + 2, dtype=np.float64) + (0.5 if odd else 0.0))
    reach = float(section.corner[:, 0].max()) * slope + _CLEAR * stone
    return place[(place > reach + 1e-9) & (place < border - _CLEAR * stone + 1e-9)][::-1]
