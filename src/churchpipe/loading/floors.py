"""What each wall bears of a floor: half of a span of one way, or what lies nearest to it of one of two ways."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from churchpipe.errors import InputError
from churchpipe.geometry.walls import WallLine
from churchpipe.loading.bearing import CLOSE
from churchpipe.model.arrays import FloatArray
from churchpipe.model.carried import AreaLoad

# Sine of the angle between walls that count as parallel, or as at right angles.
_PARALLEL = 1e-3


@dataclass(frozen=True, slots=True)
class FloorLine:
    """What a wall bears: begin, end m along it; aside m from its middle; width: tributary m at a distance from `begin`, linear
    between the breaks."""

    wall: WallLine
    begin: float
    end: float
    aside: float
    width: Callable[[float], float]
    breaks: tuple[float, ...] = ()


@dataclass(frozen=True, slots=True)
class _Pair:
    """Two parallel walls that face each other: their inner faces lie at low < high, m along the first one's normal."""

    walls: tuple[WallLine, WallLine]
    low: float
    high: float

    @property
    def span(self) -> float:
        return self.high - self.low


def floor_lines(load: AreaLoad, walls: Sequence[WallLine]) -> list[FloorLine]:
    """Return the line loads of a floor.

    Raises
    ------
    InputError: walls that are not parallel, do not face each other or stand around no rectangle; a bearing beside its wall.
    """
    for wall in walls:
        if load.bearing > wall.thickness / 2 + CLOSE:
            expected = f"at most half its thickness, {wall.thickness / 2:.6g} m"
            raise InputError(
                f"{load.called}: bearing", f"beside the wall {wall.name}", found=f"{load.bearing:g} m", expected=expected
            )
    first = walls[0].axis
    along = [wall for wall in walls if abs(_cross(wall.axis, first)) < _PARALLEL]
    across = [wall for wall in walls if abs(float(wall.axis @ first)) < _PARALLEL]
    if (len(along), len(across)) not in ((2, 0), (2, 2)):
        expected = "two parallel walls" if len(walls) == 2 else "two pairs of parallel walls at right angles"
        raise InputError(f"{load.called}: walls", "not around a floor", found=", ".join(load.walls), expected=expected)
    pair = _facing(load, along)
    if not across:
        return _one_way(load, pair)
    return _two_ways(load, pair, _facing(load, across))


def _one_way(load: AreaLoad, pair: _Pair) -> list[FloorLine]:
    starts = [float(wall.origin @ pair.walls[0].axis) for wall in pair.walls]
    reach = [start + wall.length for start, wall in zip(starts, pair.walls, strict=True)]
    begin = max(starts) if load.begin is None else starts[0] + load.begin
    end = min(reach) if load.end is None else starts[0] + load.end
    if begin < max(starts) - CLOSE or end > min(reach) + CLOSE or end - begin <= CLOSE:
        common = f"{max(starts) - starts[0]:.6g} to {min(reach) - starts[0]:.6g} m along {pair.walls[0].name}"
        raise InputError(
            load.called,
            "its walls do not face each other there",
            found=f"{begin - starts[0]:.6g} to {end - starts[0]:.6g} m",
            expected=f"within {common}",
        )
    return [
        FloorLine(wall, begin - start, end - start, load.bearing * side, lambda _: pair.span / 2)
        for wall, start, side in zip(pair.walls, starts, _inward(pair), strict=True)
    ]


def _two_ways(load: AreaLoad, along: _Pair, across: _Pair) -> list[FloorLine]:
    out: list[FloorLine] = []
    for pair, other in ((along, across), (across, along)):
        half = min(along.span, across.span) / 2
        # The other pair's normal runs along these walls, this way or that.
        turned = float(np.sign(other.walls[0].normal @ pair.walls[0].axis))
        low, high = sorted((turned * other.low, turned * other.high))
        length = high - low

        def width(place: float, length: float = length, half: float = half) -> float:
            return max(0.0, min(place, length - place, half))

        for wall, side in zip(pair.walls, _inward(pair), strict=True):
            start = float(wall.origin @ pair.walls[0].axis)
            if low - start < -CLOSE or high - start > wall.length + CLOSE:
                raise InputError(load.called, f"the wall {wall.name} ends before the floor does", expected="walls all around it")
            breaks = (half, length - half)
            out.append(FloorLine(wall, low - start, high - start, load.bearing * side, width, breaks))
    return out


def _facing(load: AreaLoad, walls: Sequence[WallLine]) -> _Pair:
    one, two = sorted(walls, key=lambda wall: float(wall.origin @ walls[0].normal))
    low = float(one.origin @ walls[0].normal) + one.thickness / 2
    high = float(two.origin @ walls[0].normal) - two.thickness / 2
    if high - low <= CLOSE:
        raise InputError(load.called, "no floor between its walls", found=f"{high - low:.6g} m clear", expected="> 0")
    return _Pair((walls[0], walls[1]), low, high)


def _inward(pair: _Pair) -> list[float]:
    """Return for each wall the side, 1 or -1, on which the floor lies."""
    middle = 0.5 * (pair.low + pair.high)
    normal = pair.walls[0].normal
    return [float(np.sign((middle - wall.origin @ normal) * (wall.normal @ normal))) for wall in pair.walls]


def _cross(first: FloatArray, second: FloatArray) -> float:
    return float(first[0] * second[1] - first[1] * second[0])
