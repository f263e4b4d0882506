"""Doors and windows under rings of voussoirs, and round windows."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Protocol

import numpy as np

from churchpipe.bond.count import MOST_VOUSSOIRS
from churchpipe.bond.voussoir import ring_outline
from churchpipe.errors import InputError
from churchpipe.generators.fields import coerce_fields
from churchpipe.model.arguments import text, whole
from churchpipe.model.arrays import FloatArray
from churchpipe.model.building import BondRegion, Opening, UnitCell
from churchpipe.model.quantities import Coordinate, Count, Distance, Length

# An opening, or a part of a building, given as a mapping of its fields.
Given = Mapping[str, Any]
Shape = Literal["round", "segmental", "pointed", "circle"]


class InWalls:
    """An opening in one wall or several, at one place or several of each."""

    __slots__ = ()
    wall: str | Sequence[str]
    centre: float | Sequence[float]

    @property
    def walls(self) -> tuple[str, ...]:
        """The walls it is in."""
        return (self.wall,) if isinstance(self.wall, str) else tuple(self.wall)

    @property
    def centres(self) -> tuple[float, ...]:
        """The places of its middle in each wall, m."""
        return tuple(self.centre) if isinstance(self.centre, Sequence) else (float(self.centre),)


@dataclass(frozen=True, slots=True)
class ArchedOpening(InWalls):
    """An opening under a ring of voussoirs, once or several times."""

    name: Annotated[str, "For messages, reports and the names of its parts."]
    wall: Annotated[str | Sequence[str], "Name of the wall, or a list of them."]
    centre: Annotated[
        Coordinate | Sequence[Coordinate],
        "Of its middle: x itself in walls along x, y itself in walls along y, not from the end of the wall as `along_m` is; "
        "along the wall in round ones; one or several.",
    ]
    width: Annotated[Length, "Clear width."]
    springing: Annotated[Length, "Height at which the arch begins; of a circle that of its centre."]
    voussoirs: Annotated[Count, "Number of voussoirs in the whole ring."]
    depth: Annotated[Length, "Depth of the voussoirs."]
    sill: Annotated[Distance, "Height of the sill."] = 0.0
    shape: Annotated[Shape, "Shape of the arch."] = "round"
    rise: Annotated[Length | None, "Rise over the springing, of a segmental or pointed arch."] = None

    def __post_init__(self) -> None:
        where = f"opening {text('opening: name', self.name)}"
        coerce_fields(self, f"{where}: ")
        for key, places in (("wall", self.walls), ("centre", self.centres)):
            if not places:
                raise InputError(f"{where}: {key}", "the opening is nowhere", expected="at least one")
        whole(f"{where}: voussoirs", self.voussoirs, least=8 if self.shape == "circle" else 2, most=MOST_VOUSSOIRS)
        if self.shape in ("pointed", "circle") and self.voussoirs % 2:
            raise InputError(f"{where}: voussoirs", "odd", found=self.voussoirs, expected="an even number: two equal halves")
        if self.shape != "circle" and not self.sill < self.springing:
            raise InputError(
                f"{where}: springing", "not above the sill", found=f"{self.springing:g} m", expected=f"> {self.sill:g} m"
            )
        if (self.rise is not None) != (self.shape in ("segmental", "pointed")):
            raise InputError(
                f"{where}: rise", "given or left out wrongly", found=self.rise, expected="a rise of segmental and pointed arches"
            )
        if self.rise is not None:
            low, high = (0.05 * self.width, 0.5 * self.width) if self.shape == "segmental" else (0.5 * self.width, 3 * self.width)
            if not low <= self.rise <= high:
                raise InputError(
                    f"{where}: rise", "out of range", found=f"{self.rise:g} m", expected=f"{low:g} to {high:g} m for this shape"
                )

    def hole(self, _wall: str, centre: float, name: str, /) -> "Hole":
        """Return it as it is at one of these places, m, in any of its walls."""
        return _hole(self, centre, name)


@dataclass(frozen=True, slots=True)
class Hole:
    """One opening of one wall, in chart coordinates: the opening and the rings around it, or the lintel over it.

    outer: s0, t0, s1, t1 of the rectangle around the opening and its rings or lintel, m.
    """

    opening: Opening
    rings: tuple[BondRegion, ...]
    outer: tuple[float, float, float, float]

    @property
    def around(self) -> str:
        """What is laid around it, for messages."""
        return "voussoirs" if self.opening.rings else "lintel"


class WallOpening(Protocol):
    """An opening in some walls, once or several times: under a ring of voussoirs, or under a lintel."""

    @property
    def name(self) -> str: ...
    @property
    def walls(self) -> tuple[str, ...]: ...
    @property
    def centres(self) -> tuple[float, ...]: ...
    def hole(self, wall: str, centre: float, name: str, /) -> Hole: ...


def holes(openings: Iterable[WallOpening], wall: str) -> list[Hole]:
    """Return all openings of one wall."""
    found = [(opening, centre) for opening in openings if wall in opening.walls for centre in opening.centres]
    names = [f"{o.name}-{1 + o.centres.index(c)}" if len(o.centres) > 1 else o.name for o, c in found]
    return [opening.hole(wall, centre, name) for (opening, centre), name in zip(found, names, strict=True)]


def _hole(opening: ArchedOpening, centre: float, name: str) -> Hole:
    arcs = _arcs(opening, centre)
    rings = tuple(
        BondRegion(
            f"{name}-ring" if len(arcs) == 1 else f"{name}-ring-{number}",
            outline,
            "voussoir",
            UnitCell(a=_mean_width(outline), b=opening.depth),
            centre=middle,
            pieces=len(outline) // 2 - 1,
        )
        for number, (outline, middle) in enumerate(arcs, start=1)
    )
    intrados = np.concatenate([outline[len(outline) // 2 :][::-1][: None if len(arcs) == 1 else -1] for outline, _ in arcs])
    if opening.shape == "pointed":
        intrados = np.concatenate([intrados, arcs[-1][0][len(arcs[-1][0]) // 2][None]])
    if opening.shape != "circle" and opening.sill < opening.springing:
        half = opening.width / 2
        intrados = np.concatenate([[[centre - half, opening.sill], [centre + half, opening.sill]], intrados])
    corner = np.concatenate([intrados, *(outline for outline, _ in arcs)])
    (s0, t0), (s1, t1) = corner.min(axis=0), corner.max(axis=0)
    hole = Opening(name, intrados, "arched", tuple(ring.name for ring in rings))
    return Hole(hole, rings, (float(s0), float(t0), float(s1), float(t1)))


def _arcs(opening: ArchedOpening, centre: float) -> list[tuple[FloatArray, tuple[float, float]]]:
    """Return the outlines of the rings, counter-clockwise from the right springing, with their centres."""
    half, depth, level = opening.width / 2, opening.depth, opening.springing
    match opening.shape:
        case "circle":
            middle, pieces = (centre, level), opening.voussoirs // 2
            return [
                (ring_outline(middle, half, half + depth, start, start + math.pi, pieces), middle) for start in (0.0, math.pi)
            ]
        case "pointed":
            return _pointed(opening, centre)
        case _:
            rise = half if opening.rise is None else opening.rise
            radius = (half**2 + rise**2) / (2 * rise)
            middle = (centre, level + rise - radius)
            start = math.asin(min(1.0, (radius - rise) / radius))
            return [(ring_outline(middle, radius, radius + depth, start, math.pi - start, opening.voussoirs), middle)]


def _pointed(opening: ArchedOpening, centre: float) -> list[tuple[FloatArray, tuple[float, float]]]:
    """Two arcs, each with its centre on the springing line beyond the middle; the last joint of each is upright."""
    half, level, pieces = opening.width / 2, opening.springing, opening.voussoirs // 2
    rise = half if opening.rise is None else opening.rise
    radius = (half**2 + rise**2) / (2 * half)
    outer = radius + opening.depth
    away = radius - half
    stop = math.atan2(rise, away)
    right = ring_outline((centre - away, level), radius, outer, 0.0, stop, pieces)
    # The last corner of the extrados is on the middle line.
    right[pieces] = [centre, level + math.sqrt(outer**2 - away**2)]
    right[pieces + 1] = [centre, level + rise]
    left = right * [-1.0, 1.0] + [2 * centre, 0.0]
    left = np.concatenate([left[: pieces + 1][::-1], left[pieces + 1 :][::-1]])
    return [(right, (centre - away, level)), (left, (centre + away, level))]


def _mean_width(outline: FloatArray) -> float:
    """Return the mean width of the voussoirs of a ring at half its depth, m."""
    count = len(outline) // 2
    middle = 0.5 * (outline[:count] + outline[count:][::-1])
    return float(np.linalg.norm(np.diff(middle, axis=0), axis=1).mean())
