"""Ends of lines that were meant to meet in one place are moved to one point."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeAlias

import numpy as np
import shapely
from scipy.spatial import KDTree

from churchpipe.model.arrays import BoolArray, FloatArray, IntArray

Lines: TypeAlias = np.ndarray[tuple[int], np.dtype[np.object_]]

# Ends are of one place where their lines meet each other within this many times the miss of all ends but a few.
SPREAD = 4.0
# Share of the ends whose miss counts for that: the others are single slips of the hand.
USUAL = 0.95
# A line that turns by less than this (rad) at a point goes on there: other lines may end beside the point.
BENT = np.radians(30.0)
# What an end meets is looked for within this power of a sixteenth of the reach first, then within the next one, up to the reach.
WINDOWS = 2
# Pairs of ends looked at together.
PAIRS = 4096
# Weight of the middle of the ends of a place against that of the lines that end there.
WEAK = 1e-3


@dataclass(frozen=True, slots=True)
class Scatter:
    """How well lines meet. miss: of their first and last ends in turn, how far they miss the next line, infinite where that is
    farther than a slip; spread: how far the meetings of lines in one place are apart at most."""

    miss: FloatArray
    spread: float


def scatter_of(
    lines: Sequence[FloatArray], mended: Sequence[FloatArray], outlines: Sequence[FloatArray], reach: float, slip: float
) -> Scatter:
    """Return how well lines (n, 2) meet each other and closed outlines; mended: the lines drawn on to what they were short of.

    Ends that only ran past their places, or fell short of them, still meet in one point: these have no spread.
    """
    if not lines:
        return Scatter(np.zeros(0), reach)
    at, own = ends_of(lines), np.repeat(np.arange(len(lines)), 2)
    ends, drawn = _points(at), _drawn(lines, outlines)
    tree, miss = shapely.STRtree(drawn), np.where(together(at, own), 0.0, np.inf)
    # Only the nearest counts, and where many ends are of one place each of them is near all others.
    for near in (*windows(reach), slip):
        loose = np.flatnonzero(np.isinf(miss))
        end, other = tree.query(ends[loose], predicate="dwithin", distance=near)
        apart = own[loose[end]] != other
        end, other = loose[end[apart]], other[apart]
        np.minimum.at(miss, end, shapely.distance(ends[end], drawn[other]))
    all_ = _members(mended, outlines, reach, slip)
    # Of ends alone: corners of one outline may be as near each other as its chords are short.
    met, most = all_.met[all_.ways.any(axis=1)], min(max(reach, SPREAD * _usual(miss)), slip)
    near = np.asarray(KDTree(all_.met).query(met, k=2, distance_upper_bound=most)[0])[:, 1]
    return Scatter(miss, min(max(reach, SPREAD * _usual(near)), most))


def gathered(
    lines: Sequence[FloatArray], outlines: Sequence[FloatArray], reach: float, slip: float, spread: float
) -> tuple[list[FloatArray], float]:
    """Return open lines (n, 2) whose ends, and sharp corners, are moved to one point where they are of one place; and how far
    one was moved at most. The sides between two places stay straight.

    outlines: closed lines (n, 2), which stay where they are. reach: lines meet within it. slip: farther from a line no end was
    meant to meet it. spread: how far the meetings of lines in one place are apart at most.
    """
    if not lines:
        return [], 0.0
    all_ = _members(lines, outlines, reach, slip)
    groups = _grouped(all_, lines, spread)
    out, moved = [line.copy() for line in lines], 0.0
    if not groups:
        return out, moved
    points = _on_lines_through(np.array([_point(all_, group) for group in groups]), groups, all_, lines, outlines, spread)
    for group, point in zip(groups, points, strict=True):
        for member in group[~all_.fixed[group]].tolist():
            moved = max(moved, float(np.linalg.norm(point - all_.at[member])))
            out[all_.own[member]][all_.place[member]] = point
    # A side whose ends were put onto one point stays as it was.
    kept = [bool((np.diff(line, axis=0) != 0).any(axis=1).all()) for line in out]
    return [line if sound else old for line, sound, old in zip(out, kept, lines, strict=True)], moved


def doubtful(lines: Sequence[FloatArray], scatter: Scatter, slip: float) -> dict[int, tuple[float, FloatArray]]:
    """Return the lines (n, 2) with a side so short that lines near it, which miss each other, may have been meant to meet at
    either end of it; by how much those miss each other; and the middle (2,) of the side where that is most."""
    tree = KDTree(ends_of(lines))
    out: dict[int, tuple[float, FloatArray]] = {}
    for k, line in enumerate(lines):
        marks = _corners(line)
        for first, last in pairwise(marks):
            length = float(np.linalg.norm(np.diff(line[first : last + 1], axis=0), axis=1).sum())
            if length < slip:
                near = {n for corner in line[[first, last]] for n in tree.query_ball_point(corner, slip)}
                miss = max((float(scatter.miss[n]) for n in near if np.isfinite(scatter.miss[n])), default=0.0)
                if length < max(2 * scatter.spread, SPREAD * miss):
                    most = max(scatter.spread, miss)
                    if k not in out or most > out[k][0]:
                        out[k] = most, 0.5 * (line[first] + line[last])
    return out


def forth(line: FloatArray, end: int) -> FloatArray:
    """Return the direction (2,) in which a line (n, 2) goes on at its first (0) or its last end (-1, or 1 of two points)."""
    side = line[0] - line[1] if end == 0 else line[-1] - line[-2]
    return side / np.linalg.norm(side)


def ends_of(lines: Sequence[FloatArray]) -> FloatArray:
    """Return the first and the last point of each line (n, 2) in turn (2 lines, 2)."""
    return np.concatenate([np.zeros((0, 2)), *(line[[0, -1]] for line in lines)])


def ways_of(lines: Sequence[FloatArray]) -> FloatArray:
    """Return the directions in which lines (n, 2) go on at their first and last ends in turn (2 lines, 2)."""
    side = ends_of(lines) - np.concatenate([np.zeros((0, 2)), *(line[[1, -2]] for line in lines)])
    return side / np.linalg.norm(side, axis=1, keepdims=True)


def windows(reach: float) -> list[float]:
    """Return how far from an end what it meets is looked for, in turn, up to the reach: where many meet, most need no more."""
    return [reach * 16.0**-power for power in range(WINDOWS, -1, -1)]


def together(ends: FloatArray, own: IntArray) -> BoolArray:
    """Return which ends (n, 2) of lines `own` are exactly where an end of another line is."""
    place = np.unique(ends, axis=0, return_inverse=True)[1].reshape(-1)
    lines_of = np.unique(np.stack([place, own], axis=1), axis=0)[:, 0]
    return np.bincount(lines_of)[place] > 1


def turns(line: FloatArray) -> FloatArray:
    """Return the angles (n - 2,) by which a line (n, 2) turns at its points, rad."""
    side = np.diff(line, axis=0)
    cross = side[:-1, 0] * side[1:, 1] - side[:-1, 1] * side[1:, 0]
    return np.abs(np.arctan2(cross, np.einsum("nc,nc->n", side[:-1], side[1:])))


def _usual(distances: FloatArray) -> float:
    """Return a distance that all but a few of the finite ones are below, and all but one of very few; 0 of none."""
    finite = distances[np.isfinite(distances)]
    return float(np.quantile(finite, USUAL, method="lower")) if len(finite) else 0.0


def _drawn(lines: Sequence[FloatArray], outlines: Sequence[FloatArray]) -> Lines:
    return np.array([*map(shapely.LineString, lines), *map(shapely.LinearRing, outlines)], dtype=np.object_)


def _points(at: FloatArray) -> Lines:
    return np.asarray(shapely.points(at), dtype=np.object_)


@dataclass(frozen=True, slots=True)
class _Members:
    """What may be of one place with others: ends and sharp corners of open lines, and corners of closed ones.

    at: where it is (n, 2); met: where an end meets the line next to it, else `at`; ways: the direction of an end, zero of a
    corner; own: its line; place: its point there; fixed: is it a corner of a closed outline?
    """

    at: FloatArray
    met: FloatArray
    ways: FloatArray
    own: IntArray
    place: IntArray
    fixed: BoolArray


def _members(lines: Sequence[FloatArray], outlines: Sequence[FloatArray], reach: float, slip: float) -> _Members:
    found: list[tuple[int, int, FloatArray, FloatArray]] = []
    for k, line in enumerate(lines):
        first, *inner, last = _corners(line)
        found += [(k, end, line[end], forth(line, -1 if end else 0)) for end in (first, last)]
        found += [(k, corner, line[corner], np.zeros(2)) for corner in inner]
    for k, outline in enumerate(outlines, start=len(lines)):
        found += [(k, n, corner, np.zeros(2)) for n, corner in enumerate(outline)]
    own, place, at, ways = map(np.array, zip(*found, strict=True))
    met, ends = at.copy(), ways.any(axis=1)
    met[ends] = _meetings(at[ends], ways[ends], own[ends], _drawn(lines, outlines), reach, slip)
    return _Members(at, met, ways, own, place, own >= len(lines))


def _corners(line: FloatArray) -> list[int]:
    """Return the points of a line (n, 2) that lines may end at: its ends, and where it turns sharply."""
    inner = np.flatnonzero(turns(line) > BENT) + 1 if len(line) > 2 else []
    return [0, *map(int, inner), len(line) - 1]


def _meetings(at: FloatArray, ways: FloatArray, own: IntArray, drawn: Lines, reach: float, slip: float) -> FloatArray:
    """Return where the ends at (n, 2) of lines `own` meet the line that is next to them; the end itself where they meet none.

    An end that ran past its place is drawn too far, but not beside it: so it is its crossing that says where the place is.
    """
    # Not so far back that it reaches the other end.
    back = np.minimum(slip, 0.5 * shapely.length(drawn[own]))[:, None]
    ends, tree, out = _points(at), shapely.STRtree(drawn), at.copy()
    # Most ends of a drawing that was made with a snap meet others exactly: they are where their places are.
    loose = np.flatnonzero(~together(at, own))
    # Only the nearest counts, and where many ends are of one place each of them meets all others.
    for near in (*windows(reach), slip):
        tails: Lines = np.asarray(
            shapely.linestrings(np.stack([at - np.minimum(near, back) * ways, at + min(near, reach) * ways], axis=1)[loose])
        )
        end, other = tree.query(tails, predicate="intersects")
        apart = own[loose[end]] != other
        there: Lines = np.asarray(shapely.intersection(tails[end[apart]], drawn[other[apart]]), dtype=np.object_)
        end = loose[end[apart]]
        order = np.lexsort([shapely.distance(ends[end], there), end])
        end, first = np.unique(end[order], return_index=True)
        out[end] = shapely.get_coordinates(shapely.get_point(shapely.shortest_line(ends[end], there[order][first]), 1))
        loose = np.setdiff1d(loose, end)
    return out


def _grouped(all_: _Members, lines: Sequence[FloatArray], spread: float) -> list[IntArray]:
    """Return the members of each place that more than one are of; the nearest ones are put together first.

    Never both ends of a side: so a line that is shorter than the spread stays a side of its stones.
    """
    # Lines that meet at a small angle may cross far from their ends: then these say where the place is.
    far = np.flatnonzero(np.linalg.norm(all_.met - all_.at, axis=1) > spread)
    where, member_of = np.concatenate([all_.met, all_.at[far]]), np.append(np.arange(len(all_.at)), far)
    pairs = KDTree(where).query_pairs(spread, output_type="ndarray")
    apart = np.linalg.norm(where[pairs[:, 0]] - where[pairs[:, 1]], axis=1)
    pairs = member_of[pairs[np.argsort(apart, kind="stable")]]
    group = {member: [member] for member in np.unique(pairs).tolist()}
    sides = {member: _sides(int(all_.own[member]), int(all_.place[member]), lines) for member in group}
    head = np.arange(len(all_.at))
    # Of very many members of one place most pairs are together before their turn comes.
    for part in np.array_split(pairs, len(pairs) // PAIRS + 1):
        for first, second in part[head[part[:, 0]] != head[part[:, 1]]].tolist():
            a, b = int(head[first]), int(head[second])
            if a == b or not sides[a].isdisjoint(sides[b]):
                continue
            a, b = (a, b) if len(group[a]) >= len(group[b]) else (b, a)
            group[a] += group[b]
            sides[a] |= sides.pop(b)
            head[group.pop(b)] = a
    return [np.array(sorted(members)) for members in group.values() if len(members) > 1]


def _sides(k: int, n: int, lines: Sequence[FloatArray]) -> set[tuple[int, int]]:
    """Return the sides of line k at its point n; of an outline, of which all corners stay, one for all."""
    if k >= len(lines):
        return {(-1, 0)}
    return {(k, side) for side in (n - 1, n) if 0 <= side < len(lines[k]) - 1}


def _point(all_: _Members, group: IntArray) -> FloatArray:
    """Return the corner of an outline that the members of a place are at, else the point next to their lines.

    Along its line an end may be drawn anywhere, beside it not; where all lines go one way, the middle of their ends counts.
    """
    if all_.fixed[group].any():
        return all_.at[group[all_.fixed[group]][0]]
    met, ways = all_.met[group], all_.ways[group]
    if (met == met[0]).all():
        return met[0]
    across = np.eye(2) - np.einsum("ni,nj->nij", ways, ways)
    middle = met.mean(axis=0)
    off = np.einsum("nij,nj->i", across, met - middle)
    return middle + np.linalg.solve(across.sum(axis=0) + WEAK * len(met) * np.eye(2), off)


def _on_lines_through(
    points: FloatArray,
    groups: list[IntArray],
    all_: _Members,
    lines: Sequence[FloatArray],
    outlines: Sequence[FloatArray],
    spread: float,
) -> FloatArray:
    """Return the points (n, 2) of places put onto lines that run through them, which stay straight."""
    drawn = _drawn(lines, outlines)
    ends = KDTree(ends_of(lines))
    through: dict[int, list[int]] = {}
    there, near = shapely.STRtree(drawn).query(shapely.points(points), predicate="dwithin", distance=spread)
    order = np.argsort(there, kind="stable")
    first = np.searchsorted(there[order], np.arange(1, len(points)))
    for n, by in enumerate(np.split(near[order], first)):
        own = set(all_.own[groups[n]].tolist())
        if own.issuperset(by.tolist()):
            continue
        beside = {end // 2 for end in ends.query_ball_point(points[n], spread)}
        # Where a short side begins, the line that it ends on may be near, but does not run through.
        far = np.concatenate([lines[k][[0, -1]] for k in sorted(own) if k < len(lines)] or [np.zeros((0, 2))])
        afar = shapely.points(far[np.linalg.norm(far - points[n], axis=1) > spread])
        found = [k for k in by.tolist() if k not in own | beside]
        if found := [k for k in found if (shapely.distance(afar, drawn[k]) > spread).all()]:
            through[n] = found
    out = points.copy()
    for n, found in through.items():
        point = shapely.Point(points[n])
        nearest = min(found, key=lambda k: float(shapely.distance(point, drawn[k])))
        crossings = [drawn[nearest] & drawn[k] for k in found if k != nearest]
        here = [place for place in crossings if place.length == 0 and float(shapely.distance(point, place)) <= spread]
        out[n] = shapely.get_coordinates(shapely.shortest_line(point, here[0] if here else drawn[nearest]))[-1]
    return out
