"""Curves divided into chords where the lines beside them have corners, so that both sides of a curved joint are divided alike."""

from collections.abc import Sequence

import numpy as np
import shapely

from churchpipe.model.arrays import BoolArray, FloatArray

# Corners of other lines divide a curve from a distance of this share of the size of its outline: across a joint of mortar.
REACH = 0.1
# Divisions nearer to each other than this share of that size are one: the corners of two stones on both sides of a joint.
APART = 0.06
# A line ends on a curve when it ends within this share of the size of the curve; a side of two points also when it crosses it, or
# would, drawn on by this share of its own length.
ON, ON_AHEAD = 1e-3, 0.1
# Between two lines that end on it a curve is drawn with chords that leave it by at most this share of the length between them.
SAG, MOST_CHORDS = 0.01, 64
# A curve turns by less than this at a point of it (rad); where it turns by more it has a corner.
SMOOTH = np.radians(30.0)


def divided(lines: Sequence[FloatArray], curves: Sequence[FloatArray | None], closed: Sequence[bool]) -> list[FloatArray]:
    """Return lines with corners added on their curves, opposite the corners of the other lines.

    A curve of a net, on which lines end, has corners at their ends and no others but those that it needs to be followed between
    them: with corners of its own choice the voussoirs between two arcs would be cut off, and the lines would miss its chords.

    So has a curve on which the sharp corners of a closed outline with curves lie: two curves on each other get the same chords.
    With chords of their own they would enclose films, each a stone where one of them belongs to a net.

    Two rings of an arch seldom have their joints at one place. The chords of one ring would lean against those of the other, by
    up to half the angle of a voussoir, and faces that lean are no joint.

    Parameters
    ----------
    lines: corners (n, 2) of each line, those on its curves among them, without the first one repeated.
    curves: the same lines drawn finely (m, 2), the first point repeated where they are closed; None for lines without curves.
    closed: whether each line is said to be closed.
    """
    bent = [k for k, curve in enumerate(curves) if curve is not None]
    if not bent:
        return list(lines)
    owner = np.repeat(np.arange(len(lines)), [len(line) for line in lines])
    corner = np.concatenate(lines)
    tree = shapely.STRtree([shapely.Point(point) for point in corner])
    sides = [shapely.LineString(_drawn_on(line)) for line, ring in zip(lines, closed, strict=True) if len(line) == 2 and not ring]
    side_tree = shapely.STRtree(sides)
    ends = np.concatenate([_ends(line, curve, ring) for line, curve, ring in zip(lines, curves, closed, strict=True)])
    out = list(lines)
    for k in bent:
        fine = np.asarray(curves[k])
        curve = shapely.LineString(fine)
        size = float(np.ptp(lines[k], axis=0).max())
        met = tree.query(curve, predicate="dwithin", distance=ON * size)
        met = corner[met[ends[met] & (owner[met] != k)]]
        across = [sides[number] for number in side_tree.query(curve, predicate="intersects").tolist()]
        crossings = shapely.get_coordinates(shapely.intersection(curve, np.array(across, dtype=object))) if across else met[:0]
        bound = _met(fine, curve, np.concatenate([met, crossings]), ON * size)
        if bound is not None:
            out[k] = bound
            continue
        near = tree.query(curve, predicate="dwithin", distance=REACH * size)
        own = shapely.line_locate_point(curve, shapely.points(lines[k]))
        beside = shapely.points(corner[near[owner[near] != k]])
        places = _clusters(np.atleast_1d(shapely.line_locate_point(curve, beside)), APART * size)
        end = curve.length if curve.is_closed else np.inf
        away = np.abs(places[:, None] - np.concatenate([own, own + end, own - end])[None, :]).min(axis=1, initial=np.inf)
        added = places[away > APART * size]
        order = np.argsort(np.concatenate([own, added]), kind="stable")
        out[k] = np.concatenate([lines[k], shapely.get_coordinates(shapely.line_interpolate_point(curve, added))])[order]
    return out


def _drawn_on(side: FloatArray) -> FloatArray:
    """Return a side (2, 2) drawn on at both ends."""
    along = ON_AHEAD * (side[1] - side[0])
    return np.stack([side[0] - along, side[1] + along])


def _ends(line: FloatArray, curve: FloatArray | None, closed: bool) -> BoolArray:
    """Return which corners (n,) of a line were drawn: all of a straight one; of one with curves (m, 2) its ends where it is not
    closed, and else where it turns sharply.
    """
    if curve is None:
        return np.ones(len(line), dtype=np.bool_)
    if not closed:
        return np.isin(np.arange(len(line)), [0, len(line) - 1])
    sharp = curve[_turns(curve, closed=True) > SMOOTH]
    return (np.abs(line[:, None] - sharp[None]).max(axis=2) <= ON**2 * np.ptp(line, axis=0).max()).any(axis=1)


def _met(fine: FloatArray, curve: shapely.LineString, met: FloatArray, near: float) -> FloatArray | None:
    """Return the corners (n, 2) of a curve on which others end, None where none does.

    fine (m, 2): the curve; met (p, 2): corners of other lines on it. The first corner of a closed curve is not repeated.
    """
    whole = float(curve.length)
    sharp = np.flatnonzero(_turns(fine, curve.is_closed) > SMOOTH)
    own = fine[sharp] if curve.is_closed else fine[np.union1d(sharp, [0, len(fine) - 1])]
    points = np.concatenate([own, met])
    along = np.concatenate([_own_places(fine, own), np.atleast_1d(shapely.line_locate_point(curve, shapely.points(met)))])
    kept = list(range(len(own)))
    for k in range(len(own), len(points)):
        apart = np.abs(along[kept] - along[k])
        apart = np.minimum(apart, whole - apart) if curve.is_closed else apart
        if apart.min(initial=np.inf) > near:
            kept.append(k)
    if len(kept) == len(own) and not len(met):
        return None
    order = np.array(kept)[np.argsort(along[kept], kind="stable")]
    begin = along[order]
    end = np.append(begin[1:], begin[0] + whole)
    parts = zip(points[order], begin.tolist(), end.tolist(), strict=True)
    last = None if curve.is_closed else -1
    pieces = [np.concatenate([point[None], _between(curve, a, b)]) for point, a, b in list(parts)[:last]]
    return np.concatenate(pieces if curve.is_closed else [*pieces, points[order[-1:]]])


def _own_places(fine: FloatArray, own: FloatArray) -> FloatArray:
    """Return how far along a curve (m, 2) points of it (n, 2) lie."""
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(fine, axis=0), axis=1))])
    first = [int(np.argmin(np.linalg.norm(fine - point, axis=1))) for point in own]
    if len(own) and len(first) > 1 and not np.array_equal(fine[0], fine[-1]):
        first[-1] = len(fine) - 1
    return along[first]


def _turns(fine: FloatArray, closed: bool) -> FloatArray:
    """Return the angle (m,), rad, by which a curve (m, 2) turns at each of its points, 0 at the ends of an open one."""
    side = np.diff(fine, axis=0)
    heading = np.arctan2(side[:, 1], side[:, 0])
    turn = np.zeros(len(fine))
    turn[1:-1] = np.diff(heading)
    if closed:
        turn[0] = heading[0] - heading[-1]
    return np.abs((turn + np.pi) % (2 * np.pi) - np.pi)


def _between(curve: shapely.LineString, begin: float, end: float) -> FloatArray:
    """Return the corners (n, 2) between two places on a curve, the places themselves left out."""
    whole = float(curve.length)
    dense = shapely.get_coordinates(shapely.line_interpolate_point(curve, np.linspace(begin, end, 4 * MOST_CHORDS + 1) % whole))
    dense[-1] = shapely.get_coordinates(shapely.line_interpolate_point(curve, end if end <= whole else end - whole))[0]
    for count in (1, 2, 4, 8, 16, 32, MOST_CHORDS):
        chords = dense[:: 4 * MOST_CHORDS // count]
        if shapely.hausdorff_distance(shapely.LineString(chords), shapely.LineString(dense)) <= SAG * (end - begin):
            break
    return chords[1:-1]


def _clusters(places: FloatArray, apart: float) -> FloatArray:
    """Return the means of groups of numbers whose neighbours are no farther apart than that.

    A group that is longer itself, as of the corners of a curve drawn with small chords, is cut into equal lengths no longer than
    that: one mean would leave the curve beside it undivided.
    """
    if not len(places):
        return places
    ordered = np.sort(places)
    chain = np.split(ordered, np.flatnonzero(np.diff(ordered) > apart) + 1)
    means: list[float] = []
    for own in chain:
        span = float(own[-1] - own[0])
        parts = max(int(np.ceil(span / apart)), 1)
        number = np.minimum((parts * (own - own[0]) / span).astype(np.int64), parts - 1) if span > 0 else np.zeros(len(own), int)
        means += [float(own[number == part].mean()) for part in np.unique(number)]
    return np.array(means)
