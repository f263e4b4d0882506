"""Loads on walls to forces at points of stones: once for a building, whichever model takes them."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from churchpipe.errors import InputError
from churchpipe.geometry.walls import WallLine, points_of, wall_line
from churchpipe.loading.bearing import CLOSE, bearing_stones, pressed_length
from churchpipe.loading.ends import unpressed_ends
from churchpipe.loading.floors import floor_lines
from churchpipe.loading.pressure import fill_weights, pressure_forces
from churchpipe.model.arguments import check_kind, describe
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage, checked_sequence
from churchpipe.model.carried import AreaLoad, Carried, LineLoad, PointLoad, Pressure
from churchpipe.model.doubts import doubt
from churchpipe.model.fill import Fill
from churchpipe.model.placed_loads import PlacedLoads

# Parts that the share of one stone is cut into: facets of a shell may be smaller than stones.
PARTS = 4
# A point load spreads along the wall, inside its stone, by at most so many times the stone's thickness: at 45 degrees to each
# side over that depth. A macro-element, one stone as long as its wall, would spread it over all of the wall.
_SPREAD = 2.0


@dataclass(frozen=True, slots=True)
class _Part:
    point: FloatArray
    stone: int
    dead: FloatArray
    mass: float
    foot: FloatArray | None = None
    reach: FloatArray | None = None
    rise: float = 0.0


def place_loads(stones: Assemblage, loads: Iterable[Carried | Fill]) -> PlacedLoads:
    """Return loads at the stones that bear them.

    A line on top of a wall bears on the highest stones under it, one at a height on the stones there (at a bed joint on those
    below), each by its length; stones of other walls in the line count too, such as those of a toothed corner.

    Parameters
    ----------
    stones
        With the names of their walls as `panel`.
    loads
        `LineLoad`, `PointLoad`, `AreaLoad`, `Pressure` or `Fill`.

    Returns
    -------
    PlacedLoads
        Small parts of them, each at a point of a stone.

    Raises
    ------
    InputError
        A wall that is not there or is not straight, a load beside its wall, or with no stone under it.
    """
    check_kind("place_loads: stones", stones, Assemblage)
    given = list(checked_sequence("place_loads: loads", loads, "loads"))
    parts = [
        (load.called, part) for number, load in enumerate(given) for part in _parts(stones, load, f"place_loads: loads[{number}]")
    ]
    doubt(text for load in given if isinstance(load, Pressure) for text in unpressed_ends(stones, load))
    stone = np.array([part.stone for _, part in parts], dtype=np.int64)
    return PlacedLoads(
        point=np.array([part.point for _, part in parts]).reshape(-1, 3),
        stone=stone,
        wall=stones.panel[stone],
        load=np.array([name for name, _ in parts], dtype=np.str_),
        dead=np.array([part.dead for _, part in parts]).reshape(-1, 3),
        mass=np.array([part.mass for _, part in parts], dtype=np.float64),
        foot=np.array([part.point if part.foot is None else part.foot for _, part in parts]).reshape(-1, 3),
        reach=np.array([np.zeros(3) if part.reach is None else part.reach for _, part in parts]).reshape(-1, 3),
        rise=np.array([part.rise for _, part in parts], dtype=np.float64),
    )


def _parts(stones: Assemblage, load: Any, where: str) -> list[_Part]:
    match load:
        case LineLoad():
            return _raised(_line(stones, load), load.rise)
        case PointLoad():
            return _raised(_point(stones, load), load.rise)
        case AreaLoad():
            return _area(stones, load)
        case Pressure():
            wall = wall_line(stones, load.wall, load.called)
            return [_Part(point, stone, force, 0.0) for point, stone, force in pressure_forces(stones, wall, load)]
        case Fill():
            return [_column(load, *part) for part in fill_weights(stones, load)]
        case _:
            found, expected = describe(load), "a LineLoad, PointLoad, AreaLoad, Pressure or Fill"
            raise InputError(where, "wrong kind", found=found, expected=expected)


def _raised(parts: list[_Part], rise: float) -> list[_Part]:
    """Return parts of which weight and mass act so far above the wall, m, and a thrust on it.

    The mass is no line of load: what it pushes turns the facet of a shell that it stands on about all axes.
    """
    if not rise:
        return parts
    up, found = np.array([0.0, 0.0, rise]), list[_Part]()
    for part in parts:
        foot = part.point if part.foot is None else part.foot
        thrust = part.dead * np.array([1.0, 1.0, 0.0])
        found += [
            replace(part, dead=thrust, mass=0.0),
            replace(part, point=part.point + up, dead=part.dead - thrust, mass=0.0, foot=foot, rise=rise),
            replace(part, point=part.point + up, dead=0 * thrust, foot=part.point, reach=None, rise=rise),
        ]
    return [part for part in found if part.mass or part.dead.any()]


def _column(load: Fill, foot: FloatArray, stone: int, weight: float) -> _Part:
    """Return a part of fill: its mass lies half way up between the stone and the surface."""
    # The mean depth of a part, weighed by depth, is that of its foot: half of it is the mean over the volume.
    middle = np.append(foot[:2], 0.5 * (foot[2] + load.top))
    return _Part(middle, stone, np.array([0.0, 0.0, -weight]), weight * load.pushed / load.unit_weight, foot)


def _line(stones: Assemblage, load: LineLoad) -> list[_Part]:
    if load.between is not None:
        ends = np.array(load.between)
        (first, last), height = ends[:, :2], float(ends[:, 2].max())
        if abs(float(np.ptp(ends[:, 2]))) > CLOSE or np.linalg.norm(last - first) <= CLOSE:
            found = ends.tolist()
            raise InputError(f"{load.called}: between", "not a level line", found=found, expected="two points at one height")
        on_top = _touches_tops(stones, height)
    else:
        wall = wall_line(stones, load.wall or "", load.called)
        begin, end = load.begin or 0.0, wall.length if load.end is None else load.end
        _check_within(load.called, wall, begin, end)
        aside = _aside(load.called, wall, load.eccentricity, load.toward)
        first, last = wall.at(begin, aside), wall.at(end, aside)
        height, on_top = (wall.top, True) if load.height is None else (load.height, False)
    dead = _force(load.dead, load.thrust, load.toward)
    return _along(stones, load.called, first, last, height, on_top, dead, load.pushed, lambda _: 1.0)


def _touches_tops(stones: Assemblage, height: float) -> bool:
    tops = stones.points[np.repeat(~stones.fixed, np.diff(stones.block_point_ptr)), 2]
    return bool(height >= tops.max(initial=-np.inf) - CLOSE)


def _along(
    stones: Assemblage,
    where: str,
    first: FloatArray,
    last: FloatArray,
    height: float,
    on_top: bool,
    dead: FloatArray,
    mass: float,
    intensity: Callable[[float], float],
    breaks: Sequence[float] = (),
) -> list[_Part]:
    """Return the parts of a line load; dead (3,) N/m and mass N/m times an intensity that is linear between the breaks."""
    length = float(np.linalg.norm(last - first))
    axis = (last - first) / length
    found = bearing_stones(stones, first, last, height, on_top=on_top, where=where)
    parts: list[_Part] = []
    bearings: list[list[Any]] = [part.tolist() for part in (found.start, found.end, found.stone, found.share, found.z)]
    for start, end, stone, share, z in zip(*bearings, strict=True):
        inner = np.array([b for b in breaks if start < b < end], dtype=np.float64)
        stops = np.unique(np.concatenate([np.linspace(float(start), float(end), PARTS + 1), inner]))
        for a, b in zip(stops[:-1].tolist(), stops[1:].tolist(), strict=True):
            low, high = intensity(a), intensity(b)
            amount = 0.5 * (low + high) * (b - a) * share
            if not amount:
                continue
            slope = (z[1] - z[0]) / (end - start)
            centre, middle = a + (b - a) * (low + 2 * high) / (3 * (low + high)), 0.5 * (a + b)
            point, foot = (np.append(first + way * axis, z[0] + slope * (way - start)) for way in (centre, middle))
            reach = 0.5 * (b - a) * np.append(axis, slope)
            parts.append(_Part(point, int(stone), amount * dead, amount * mass, foot, reach))
    return parts


def _point(stones: Assemblage, load: PointLoad) -> list[_Part]:
    if load.at is not None:
        place, height, on_top = np.array(load.at[:2]), load.at[2], _touches_tops(stones, load.at[2])
        axis = None
    else:
        wall = wall_line(stones, load.wall or "", load.called)
        along = load.along or 0.0
        _check_within(load.called, wall, along, along)
        place = wall.at(along, _aside(load.called, wall, load.eccentricity, load.toward))
        height, on_top = (wall.top, True) if load.height is None else (load.height, False)
        axis = wall.axis
    found = bearing_stones(stones, place, place, height, on_top=on_top, where=load.called)
    dead = _force(load.dead, load.thrust, load.toward)
    middle, reach = _pressed(stones, found.stone, place, axis)
    parts: list[_Part] = []
    for stone, share, z in zip(found.stone, found.share, found.z, strict=True):
        point = np.append(place, z[0])
        mass = float(share) * load.pushed
        parts.append(_Part(point, int(stone), share * dead, mass, point + middle, reach))
    return parts


def _pressed(stones: Assemblage, bearing: IntArray, place: FloatArray, axis: FloatArray | None) -> tuple[FloatArray, FloatArray]:
    """Return the way (3,) m from a place (2,) m to the middle of what stones press on there, and from that to its end: along a
    wall's axis (2,), or that of the wall they belong to. Zero where this is not straight."""
    if axis is None:
        try:
            axis = wall_line(stones, str(stones.panel[bearing[0]]), "").axis
        except InputError:
            return np.zeros(3), np.zeros(3)
    plan = points_of(stones, bearing)[:, :2]
    most = _SPREAD * float(np.ptp(plan @ np.array([-axis[1], axis[0]])))
    middle, half = pressed_length(plan @ axis, float(place @ axis), most)
    way = np.append(axis, 0.0)
    return middle * way, half * way


def _area(stones: Assemblage, load: AreaLoad) -> list[_Part]:
    walls = [wall_line(stones, name, load.called) for name in load.walls]
    parts: list[_Part] = []
    for line in floor_lines(load, walls):
        wall = line.wall
        first, last = (wall.at(along, line.aside) for along in (line.begin, line.end))
        height, on_top = (wall.top, True) if load.height is None else (load.height, False)
        dead = np.array([0.0, 0.0, -load.dead])
        where = f"{load.called}, wall {wall.name}"
        parts += _along(stones, where, first, last, height, on_top, dead, load.pushed, line.width, line.breaks)
    return parts


def _force(dead: float, thrust: float, toward: FloatArray | None) -> FloatArray:
    push = np.zeros(3) if toward is None else thrust * toward
    return np.asarray(push - np.array([0.0, 0.0, dead]))


def _check_within(where: str, wall: WallLine, begin: float, end: float) -> None:
    if min(begin, end) < -CLOSE or max(begin, end) > wall.length + CLOSE:
        found = f"{begin:g} m" if begin == end else f"from {begin:g} m to {end:g} m"
        expected = f"within 0 and {wall.length:.6g} m along it: {wall.way}"
        raise InputError(where, f"beyond the wall {wall.name}", found=found, expected=expected)


def _aside(where: str, wall: WallLine, eccentricity: float, toward: FloatArray | None) -> float:
    if abs(eccentricity) > wall.thickness / 2 + CLOSE:
        expected = f"at most half its thickness, {wall.thickness / 2:.6g} m"
        raise InputError(f"{where}: eccentricity", f"beside the wall {wall.name}", found=f"{eccentricity:g} m", expected=expected)
    return eccentricity * wall.side(where, toward) if eccentricity and toward is not None else 0.0
