"""Runs of courses along a path, collected into a vault."""

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from churchpipe.model.arrays import FloatArray
from churchpipe.model.vault import Run, Section, Side, Vault


@dataclass(slots=True)
class Courses:
    """Courses of a vault while it is laid. A stone is known by any key: segments of one key are one stone."""

    runs: list[Run] = field(default_factory=list[Run])
    numbers: dict[Hashable, int] = field(default_factory=dict[Hashable, int])

    def add(
        self,
        section: Section,
        side: Side,
        stations: Sequence[Sequence[float]] | FloatArray,
        stones: Sequence[Hashable],
        *,
        course: int,
        part: str,
        length: float,
    ) -> None:
        """Add the course with this section along one side: stations (m + 1, 2), a and c, and the stone of each segment (m,)."""
        number = [self.numbers.setdefault((part, course, stone), len(self.numbers)) for stone in stones]
        self.runs.append(Run(section, side, np.array(stations, dtype=float), np.array(number), course, part, length))

    def vault(
        self,
        name: str,
        material: str,
        beds: Literal["path", "section"] = "path",
        *,
        shell: Literal["facets", "bodies", "none"] = "facets",
    ) -> Vault:
        """Return the vault."""
        return Vault(name, tuple(self.runs), material, beds, shell)


def polygon_sides(centre: tuple[float, float], sides: int, start: float = 0.0, turn: float = 2 * np.pi) -> list[Side]:
    """Return the sides of a regular polygon about a centre, m, counter-clockwise; corners at start + k turn / sides."""
    middle = start + turn / sides * (np.arange(sides) + 0.5)
    return [Side(np.array(centre), np.array([np.cos(a), np.sin(a)]), np.array([-np.sin(a), np.cos(a)])) for a in middle]
