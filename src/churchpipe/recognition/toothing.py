"""Which wall fills each part of a junction of drawn walls where a count of courses cannot tell, and how often they take turns."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from churchpipe.errors import InputError
from churchpipe.geometry.charts import base_level
from churchpipe.geometry.planar import area, bounds, boxes, common_areas
from churchpipe.model.arrays import BoolArray, FloatArray
from churchpipe.model.building import Panel
from churchpipe.recognition.stone_walls import StoneWall
from churchpipe.recognition.wall_parts import TOUCH, junction_spans

# Walls are toothed where the one or the other begins to fill their junction on this share of its courses or more. Where they
# take turns less often the shell, in which they are one, would overrate their bond.
_TOOTHED = 2 / 3
# A count of courses is wrong where it gives more than this share of a junction to the wall that does not fill it.
_WRONG = 0.02
# Walls are bonded too seldom for the shell where they take turns at this share of the beds of their junction or at fewer. Bonding
# stones on every third course make it two thirds, and three quarters in a wall of five courses.
_SELDOM = 0.75
# Beds of two walls whose heights differ by less than this share of a course are one.
_LEVEL = 0.05
# Stones beside a junction are those no further from it than this share of its width.
_BESIDE = 0.1


@dataclass(frozen=True, slots=True)
class SeldomBonded:
    """Two walls whose stones bond them more rarely than course by course in turn.

    walls: their names. beds: how many beds their junction has, turns: at how many of them the other wall begins to fill it.
    """

    walls: tuple[str, str]
    beds: int
    turns: int

    def error(self) -> InputError:
        """Return the refusal of a shell, in which these walls would be toothed."""
        return InputError(
            f"junction of {' and '.join(self.walls)}",
            f"stones bond these walls too seldom for the shell (they take turns at {self.turns} of {self.beds} beds), in which "
            "they would be toothed course by course: it would overrate the junction",
            remedy="Run the rigid blocks, which take it as it is, or draw the walls toothed if they are.",
        )


def toothed(panels: Sequence[Panel], walls: Sequence[StoneWall]) -> list[Panel]:
    """Return panels that say which parts of their junctions they fill, where `runs_through` does not say it rightly.

    A panel counts courses of one height, and runs through its junctions on even or on odd ones. Courses of a drawing may be of
    unlike height, or a wall may be first at one end and second at the other. Walls with few bonding stones are left as they are:
    `seldom_bonded` finds them.

    Parameters
    ----------
    panels: fitted to the walls, in their order. walls: the stones of each.
    """
    filled: list[list[FloatArray]] = [[panel.filled] for panel in panels]
    for pair, spans in _meeting(walls):
        courses = [_courses(walls[k], *span) for k, span in zip(pair, spans, strict=True)]
        bands = [_merged(own) for own in courses]
        if sum(map(len, bands)) < _TOOTHED * sum(map(len, courses)):
            continue
        if all(map(len, bands)) and _is_wrong(panels[pair[0]], panels[pair[1]], bands):
            for k, own, span in zip(pair, bands, spans, strict=True):
                t = own - base_level(panels[k].chart)
                start, stop = np.broadcast_to(span, (len(t), 2)).T
                filled[k].append(np.stack([start, t[:, 0], stop, t[:, 1]], axis=1))
    return [replace(panel, filled=np.concatenate(own)) for panel, own in zip(panels, filled, strict=True)]


def seldom_bonded(panels: Sequence[Panel], walls: Sequence[StoneWall]) -> tuple[SeldomBonded, ...]:
    """Return the pairs of walls that are bonded, but more rarely than walls that are toothed.

    The beds of a junction are those of the wall that has fewer of them there. Walls that only butt are not among them: each ends
    where the other begins, in the shell too, where nothing then joins them. Weights do not tell how walls are bonded: of long
    walls the stones of a junction are a small part.

    Parameters
    ----------
    panels: fitted to the walls, in their order. walls: the stones of each.
    """
    found: list[SeldomBonded] = []
    for pair, spans in _meeting(walls):
        near = _LEVEL * min(panels[k].regions[0].cell.a for k in pair)
        beds, turns = _turns([walls[k] for k in pair], spans, near)
        if 0 < turns <= _SELDOM * beds:
            found.append(SeldomBonded((walls[pair[0]].name, walls[pair[1]].name), beds, turns))
    return tuple(found)


def _meeting(walls: Sequence[StoneWall]) -> Iterator[tuple[tuple[int, int], list[tuple[float, float]]]]:
    """Yield the numbers of walls that meet in one place, and from which s to which, m, their junction lies in either."""
    for first, second in combinations(range(len(walls)), 2):
        spans = [junction_spans(walls[k], [walls[other]]) for k, other in ((first, second), (second, first))]
        # Where a curved wall meets another one twice, which of its two spans is which is not known.
        if all(len(found) == 1 for found in spans):
            yield (first, second), [found[0] for found in spans]


def _turns(walls: Sequence[StoneWall], spans: Sequence[tuple[float, float]], near: float) -> tuple[int, int]:
    """Return how many beds a junction has between its courses, and at how many the other wall begins to fill it; near: m."""
    beds = [_beds(wall, *span, near) for wall, span in zip(walls, spans, strict=True)]
    if not all(map(len, beds)):
        return 0, 0
    levels = _apart(np.concatenate(beds), near)
    levels = levels[(levels > max(own[0] for own in beds) - near) & (levels < min(own[-1] for own in beds) + near)]
    share = np.stack([_filled(wall, *span, levels) for wall, span in zip(walls, spans, strict=True)])
    owner = np.where(share.max(axis=0) > 0.5, share.argmax(axis=0), -1)
    inner = levels[1:-1][(owner[1:] >= 0) & (owner[:-1] >= 0)]
    possible = min(int((np.abs(inner[:, None] - own).min(axis=1) < near).sum()) for own in beds)
    return possible, int((np.diff(owner[owner >= 0]) != 0).sum())


def _beds(wall: StoneWall, start: float, stop: float, near: float) -> FloatArray:
    """Return z (n,) m where the stones of a wall begin and end that lie in a junction or beside it."""
    box, beside = bounds(wall.elevations), _BESIDE * (stop - start)
    own = (box[:, 0] < stop + beside) & (box[:, 2] > start - beside)
    return _apart(box[own][:, [1, 3]].ravel(), near) + base_level(wall.chart)


def _apart(values: FloatArray, near: float) -> FloatArray:
    """Return sorted values without those that are nearer than this to the one before."""
    ordered = np.sort(values)
    return ordered[np.append(True, np.diff(ordered) > near)] if len(ordered) else ordered


def _filled(wall: StoneWall, start: float, stop: float, levels: FloatArray) -> FloatArray:
    """Return which share of each band (n,) between z levels (n + 1,) of a junction the stones of a wall fill."""
    t = levels - base_level(wall.chart)
    band = boxes(np.stack([np.full(len(t) - 1, start), t[:-1], np.full(len(t) - 1, stop), t[1:]], axis=1))
    return np.array([common_areas(wall.elevations, one).sum() / area(one) for one in band])


def _courses(wall: StoneWall, start: float, stop: float) -> FloatArray:
    """Return z (n, 2) m of the courses of a wall whose stones fill it from one place s to another."""
    box = bounds(wall.elevations)
    own = (box[:, 0] < stop - TOUCH) & (box[:, 2] > start + TOUCH)
    levels = np.unique(box[own][:, [1, 3]])
    low, high = levels[:-1], levels[1:]
    band = boxes(np.stack([np.full(len(low), start), low, np.full(len(low), stop), high], axis=1))
    full = [common_areas(wall.elevations[own], one).sum() > 0.5 * area(one) for one in band]
    found = np.stack([low, high], axis=1)[(high - low > TOUCH) & np.array(full, dtype=np.bool_)]
    return found + base_level(wall.chart)


def _merged(courses: FloatArray) -> FloatArray:
    """Return z (n, 2) m of the runs of courses (m, 2) that lie on each other."""
    if not len(courses):
        return courses
    apart = courses[1:, 0] - courses[:-1, 1] > TOUCH
    return np.stack([courses[np.append(True, apart), 0], courses[np.append(apart, True), 1]], axis=1)


def _is_wrong(first: Panel, second: Panel, bands: Sequence[FloatArray]) -> bool:
    """Return whether a count of courses gives too much of a junction to the wall that does not fill it; bands: z (n, 2) m that
    each wall fills."""
    a, base = first.regions[0].cell.a, base_level(first.chart)
    ends = np.concatenate([own.ravel() for own in bands])
    lines = base + a * np.arange(np.floor((ends.min() - base) / a), np.ceil((ends.max() - base) / a) + 1)
    levels = np.unique(np.concatenate([ends, lines]))
    middle, height = 0.5 * (levels[1:] + levels[:-1]), np.diff(levels)
    one, other = (_within(middle, own) for own in bands)
    course = np.floor((middle - base) / a).astype(np.int64) % 2
    rank = [np.where(course == p.runs_through, 1, 2) if p.runs_through is not None else 0 * course for p in (first, second)]
    told = one != other
    wrong = told & ((rank[0] <= rank[1]) != one)
    return bool(height[wrong].sum() > _WRONG * height[told].sum())


def _within(middle: FloatArray, bands: FloatArray) -> BoolArray:
    inside: BoolArray = (bands[:, 0] < middle[:, None]) & (middle[:, None] < bands[:, 1])
    return np.any(inside, axis=1)
