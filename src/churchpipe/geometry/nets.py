"""Lines in a plane: the areas that they enclose, and outlines without superfluous corners."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import shapely
from scipy.spatial import KDTree

from churchpipe.geometry.places import (
    BENT,
    SPREAD,
    Lines,
    doubtful,
    ends_of,
    forth,
    gathered,
    scatter_of,
    together,
    turns,
    ways_of,
    windows,
)
from churchpipe.geometry.planar import WITHIN, Region
from churchpipe.model.arrays import FloatArray, IntArray

# Lines meet where they are closer than this share of the length of the median line.
SNAP = 1e-3
# Ends that miss a line by more, or run past one, are slips of the hand up to this share of that length; they are told.
SLIP = 0.1
# Cosine of the angle between the directions of two ends that point at each other.
OPPOSITE = -0.99
# Ends that go on to one another are looked at so often, since one that was moved may leave others that met its line.
ROUNDS = 3
# Ends that are as far apart as this many times where lines meet, a hundredth of the median line, have no mortar between them.
MORTAR = 10.0
# An open outline that shares less than this part with all areas is a stone of its own.
HIDDEN = 0.1
# A corner closer to the line through its neighbours than this share of the outline's size is superfluous.
STRAIGHT = 1e-6


@dataclass(frozen=True, slots=True)
class Left:
    """An area that lines enclose and that is no stone.

    line: the line that covers most of its longest side; at (2,): a point in its middle; length: of its longest side; width: twice
    its area over its perimeter; narrow: is it between lines that nearly coincide? Else lines that cross beside no end enclose it.
    """

    line: int
    at: FloatArray
    length: float
    width: float
    narrow: bool


@dataclass(frozen=True, slots=True)
class Net:
    """The areas that lines enclose, and the lines that enclose none.

    meshes: corners (n, 2) of each area, with the index of the line that covers most of its longest side. alone: indices of the
    lines that meet no other, or that close over a place where no area is. loose: indices of the lines with a free end. borders:
    indices of the closed outlines on which lines end. mended: of lines with an end that missed the next line, or ran past it: by
    how much at most; mended_at (2,): and where. doubtful: of lines with a side so short that others near it may have been meant
    to end at either end of it: by how much these miss each other, and the middle (2,) of the side. left: what lines enclose that
    is too small or too narrow for a stone.
    """

    meshes: list[tuple[int, FloatArray]]
    alone: list[int]
    loose: list[int]
    borders: list[int]
    mended: dict[int, float]
    doubtful: dict[int, tuple[float, FloatArray]] = field(default_factory=dict[int, "tuple[float, FloatArray]"])
    mended_at: dict[int, FloatArray] = field(default_factory=dict[int, "FloatArray"])
    left: list[Left] = field(default_factory=list[Left])


def net_of(lines: Sequence[FloatArray], outlines: Sequence[FloatArray]) -> Net:
    """Return what open lines (n, 2) make, with each other and with closed outlines (n, 2); indices count the outlines after the
    lines. Ends may miss a line, or run past one, by up to a tenth of the median line: none is moved farther.
    """
    count = len(lines)
    median = float(np.median([shapely.LineString(line).length for line in lines]))
    reach, slip = SNAP * median, SLIP * median
    meant = lines
    lines = [_within(*one, slip) for one in zip(_reaching(lines, outlines, reach, slip)[0], meant, meant, strict=True)]
    # Beyond its mortar, no end of an outline without one of its sides is of one place with what lies there.
    open_ = _open_outlines(lines, outlines, reach)
    of_net = [k for k in range(count) if k not in open_]
    still = [*outlines, *(lines[k] for k in open_)]
    scatter = scatter_of([meant[k] for k in of_net], [lines[k] for k in of_net], still, reach, slip)
    for _ in range(ROUNDS):
        sides, moved = gathered([lines[k] for k in of_net], still, reach, slip, scatter.spread)
        for k, side in zip(of_net, sides, strict=True):
            lines[k] = _within(side, lines[k], meant[k], slip)
        drawn_on, missed = _reaching(lines, outlines, reach, slip)
        lines = [_within(*one, slip) for one in zip(drawn_on, lines, meant, strict=True)]
        if not missed and moved <= STRAIGHT * median:
            break
    by = [np.linalg.norm(a - b, axis=1) for a, b in zip(lines, meant, strict=True)]
    mended = {k: float(away.max()) for k, away in enumerate(by) if away.max() > STRAIGHT * median}
    drawn = np.array([*map(shapely.LineString, lines)], dtype=np.object_)
    met = _met(lines, outlines, reach)
    others = np.array([k for k in range(count) if k not in met], dtype=np.int64)
    crosses = shapely.STRtree(drawn).query(drawn[others], predicate="crosses")[0]
    crossing = set(others[crosses].tolist())
    net = _meshed(lines, outlines, sorted(met | crossing), reach, slip, scatter.spread)
    # A line that only crosses others, and goes on beyond them, is no side of a stone: an axis, or a dimension.
    beyond = crossing & set(net.loose)
    if beyond:
        net = _meshed(lines, outlines, sorted((met | crossing) - beyond), reach, slip, scatter.spread)
    unused = [k for k in range(count) if k in beyond or k not in met | crossing]
    short = {of_net[k]: one for k, one in doubtful([meant[k] for k in of_net], scatter, slip).items() if of_net[k] not in unused}
    told = {k: max(mended.get(k, 0.0), net.mended.get(k, 0.0)) for k in mended | net.mended}
    at = net.mended_at | {k: meant[k][np.argmax(by[k])] for k, most in mended.items() if most >= net.mended.get(k, 0.0)}
    return replace(net, alone=[*net.alone, *unused], mended=told, mended_at=at, doubtful=short)


def _within(line: FloatArray, before: FloatArray, meant: FloatArray, slip: float) -> FloatArray:
    """Return a line (n, 2) whose points are left where they were before if they are now farther than a slip from where meant."""
    return np.where(np.linalg.norm(line - meant, axis=1, keepdims=True) > slip, before, line)


def _met(lines: Sequence[FloatArray], outlines: Sequence[FloatArray], reach: float) -> set[int]:
    """Return the lines (n, 2) and outlines on which a line ends within the reach, and the lines that do."""
    own = np.repeat(np.arange(len(lines)), 2)
    # Many ends are at one place: it is looked at once.
    places, of_end = np.unique(ends_of(lines), axis=0, return_inverse=True)
    place, line = np.unique(np.stack([of_end.reshape(-1), own], axis=1), axis=0).T
    several = np.bincount(place) > 1
    # Drawn on, since two ends that point at each other meet in the middle.
    longer = _lengthened(lines, outlines, reach)
    at, other = shapely.STRtree(longer).query(shapely.points(places), predicate="dwithin", distance=reach)
    first = line[np.searchsorted(place, np.arange(len(places)))]
    apart = several[at] | (first[at] != other)
    meeting = np.zeros(len(places), dtype=np.bool_)
    meeting[at[apart]] = True
    return set(line[meeting[place]].tolist()) | set(other[apart].tolist())


def _open_outlines(lines: Sequence[FloatArray], outlines: Sequence[FloatArray], reach: float) -> list[int]:
    """Return the lines (n, 2) that turn sharply twice or more and meet no other: outlines that are not closed."""
    bent = np.array([k for k, one in enumerate(lines) if (turns(one) > BENT).sum() > 1], dtype=np.int64)
    drawn = np.array([*map(shapely.LineString, lines), *map(shapely.LinearRing, outlines)], dtype=np.object_)
    line, other = shapely.STRtree(drawn).query(drawn[bent], predicate="dwithin", distance=reach)
    return np.setdiff1d(bent, bent[line[bent[line] != other]]).tolist()


def _reaching(
    lines: Sequence[FloatArray], outlines: Sequence[FloatArray], reach: float, slip: float
) -> tuple[list[FloatArray], dict[int, float]]:
    """Return lines whose straight ends go on to the line that they miss by less than a slip, or to where another end would go
    on to; and by how much they missed it.
    """
    drawn = _lengthened(lines, outlines, reach)
    behind = _short(lines, outlines, reach, slip)
    short, along = list(behind), {(k, last): forth(lines[k], last) for k, last in behind}
    ahead = [shapely.LineString([lines[k][last], lines[k][last] + slip * along[k, last]]) for k, last in short]
    owner = [*range(len(drawn)), *(k for k, _ in short)]
    targets = [*drawn, *ahead]
    tree = shapely.STRtree(targets)
    out, missed = [line.copy() for line in lines], dict[int, float]()
    ends = KDTree(ends_of(lines))
    for (k, last), ray in zip(short, ahead, strict=True):
        end = shapely.Point(lines[k][last])
        # The third nearest is of another line where the line is so short that its own ends come first.
        away, which = map(np.asarray, ends.query(lines[k][last], k=3, distance_upper_bound=slip))
        beside = float(away[which // 2 != k].min())
        tail = shapely.LineString([lines[k][last] - slip * along[k, last], lines[k][last]])
        met = [(o, ray & targets[o]) for o in tree.query(ray, predicate="intersects").tolist() if owner[o] != k]
        # Two ends that point at each other, of sides of two stones in one line, do not meet between them.
        places = [place for o, place in met if o < len(drawn) or place.length == 0]
        gap = min((float(shapely.distance(end, place)) for place in places), default=np.inf)
        # An end that ran past a line, or past where another will end on it, goes on to a third one only if that is nearer.
        coming = [
            tail & targets[o] for o in tree.query(tail, predicate="intersects").tolist() if o >= len(drawn) and owner[o] != k
        ]
        past = [float(shapely.distance(end, place)) for place in coming if place.length == 0]
        # Nor does one go on far past the end of another line beside it, to a line at a small angle with its own.
        if gap < min([behind[k, last], *past, SPREAD * beside]):
            out[k][last] += gap * along[k, last]
            missed[k] = max(gap, missed.get(k, 0.0))
    return _joined(out, outlines, missed, reach, slip)


def _joined(
    lines: list[FloatArray], outlines: Sequence[FloatArray], missed: dict[int, float], reach: float, slip: float
) -> tuple[list[FloatArray], dict[int, float]]:
    """Return lines whose straight ends that still meet nothing, since they pass by the end of another line, are moved to it."""
    ends, ways = ends_of(lines), ways_of(lines)
    tree = KDTree(ends, copy_data=True)
    for (k, last), past in _short(lines, outlines, reach, slip).items():
        # Of these some may have been moved by a slip already.
        near = np.array(sorted(tree.query_ball_point(lines[k][last], 2 * slip)))
        apart = np.linalg.norm(ends[near] - lines[k][last], axis=1)
        # Two ends that point at each other are of sides of two stones in one line, with mortar between them, unless they are
        # much nearer than mortar is wide.
        facing = (ways[near] @ ways[2 * k + last] < OPPOSITE) & (apart > MORTAR * reach)
        # Nor may it come to its own other end: a side may be shorter than a slip.
        side = float(np.linalg.norm(lines[k][0] - lines[k][1]))
        lost = np.linalg.norm(ends[near] - lines[k][1 - last], axis=1) <= min(slip, 0.5 * side)
        apart[facing | lost | (near // 2 == k)] = np.inf
        nearest = int(np.argmin(apart))
        if apart[nearest] <= min(slip, past):
            lines[k][last] = ends[2 * k + last] = ends[near[nearest]]
            missed[k] = max(float(apart[nearest]), missed.get(k, 0.0))
    return lines, missed


def _short(
    lines: Sequence[FloatArray], outlines: Sequence[FloatArray], reach: float, slip: float
) -> dict[tuple[int, int], float]:
    """Return the straight ends (line, 0 or 1) that meet no other line, with how far they ran past one, infinite where none is
    within a slip.
    """
    # Drawn on as in `_meshed`, so that an end is short exactly where it would meet nothing there.
    drawn = _lengthened(lines, outlines, reach)
    tree = shapely.STRtree(drawn)
    ends = [(k, last) for k, line in enumerate(lines) if len(line) == 2 for last in (0, 1)]
    own = np.array([k for k, _ in ends], dtype=np.int64)
    which = np.array([2 * k + last for k, last in ends], dtype=np.int64)
    at, along = ends_of(lines)[which], ways_of(lines)[which]

    def met(chosen: IntArray, back: float, ahead: float) -> tuple[IntArray, IntArray, Lines]:
        """Return which ends meet which other lines from so far back to so far ahead, and its tail."""
        rays = np.stack([at[chosen] - back * along[chosen], at[chosen] + ahead * along[chosen]], axis=1)
        tails: Lines = np.asarray(shapely.linestrings(rays), dtype=np.object_)
        end, other = tree.query(tails, predicate="intersects")
        apart = other != own[chosen[end]]
        return chosen[end[apart]], other[apart], tails[end[apart]]

    # Most ends meet the end of a line exactly, or a line where they are, and many others where many meet.
    short = np.flatnonzero(~together(at, own))
    for near in windows(reach):
        short = np.setdiff1d(short, met(short, near, near)[0])
    end, other, tail = met(short, slip, reach)
    past = np.full(len(ends), np.inf)
    np.minimum.at(past, end, shapely.distance(shapely.points(at[end]), shapely.intersection(tail, drawn[other])))
    return {ends[n]: float(past[n]) for n in short.tolist()}


def _meshed(
    lines: Sequence[FloatArray], outlines: Sequence[FloatArray], chosen: list[int], reach: float, slip: float, spread: float
) -> Net:
    """Return the net of the chosen lines and outlines alone; spread: how far lines that meet miss each other."""
    if not chosen:
        return Net([], [], [], [], {})
    count = len(lines)
    within = [k for k in chosen if k < count]
    sources = _drawn_on([lines[k] for k in within], [outlines[k - count] for k in chosen if k >= count], reach)
    tree = shapely.STRtree(sources)
    found, _, dangles, _ = shapely.polygonize_full(shapely.get_parts(shapely.union_all(sources)))
    meshes: list[tuple[int, FloatArray]] = []
    mended: dict[int, float] = {}
    mended_at: dict[int, FloatArray] = {}
    left: list[Left] = []
    ends = shapely.MultiPoint(ends_of([lines[k] for k in within]))
    shapely.prepare(ends)
    for mesh in shapely.get_parts(found):
        corners = shapely.get_coordinates(mesh.exterior)[:-1]
        side = np.roll(corners, -1, axis=0) - corners
        length = np.linalg.norm(side, axis=1)
        longest = int(np.argmax(length))
        nearest = chosen[int(tree.nearest(shapely.Point(corners[longest] + 0.5 * side[longest])))]
        # A film between two lines that were meant to be one is no stone; a wedge wider than lines miss each other is.
        narrow = mesh.area <= reach * mesh.length and mesh.buffer(-spread).is_empty
        if mesh.length > slip and not narrow:
            meshes.append((nearest, corners))
        elif narrow or not shapely.dwithin(mesh, ends, slip):
            width = 2 * mesh.area / mesh.length
            # Less than that is a matter of rounding.
            if width > STRAIGHT * length[longest]:
                left.append(Left(nearest, shapely.get_coordinates(mesh.centroid)[0], float(length[longest]), width, narrow))
        else:
            # Nor is what lines enclose whose ends were meant to meet in one place.
            mended[nearest], mended_at[nearest] = float(length[longest]), shapely.get_coordinates(mesh.centroid)[0]
    cells = np.array([shapely.Polygon(corners) for _, corners in meshes], dtype=np.object_)
    cell_tree = shapely.STRtree(cells)
    alone: list[int] = []
    for k in chosen:
        # Drawn along its neighbours, an outline that lacks its last side is hidden by theirs: it closes over an empty place. So
        # does an arch over its opening, but it has no corners.
        if k < count and len(lines[k]) > 3 and turns(lines[k]).max() > BENT:
            own = shapely.Polygon(lines[k])
            if own.is_valid and own.area > reach * own.length:
                hidden = shapely.area(shapely.intersection(cells[cell_tree.query(own)], own)).sum()
                if hidden < HIDDEN * own.area:
                    alone.append(k)
    loose: set[int] = set()
    for part in shapely.get_parts(dangles):
        k = chosen[int(tree.nearest(shapely.line_interpolate_point(part, 0.5, normalized=True)))]
        if k >= count or part.length <= 3 * reach:
            continue
        if part.length > slip + reach:
            loose.add(k)
        elif part.length - reach > mended.get(k, 0.0):
            mended[k], mended_at[k] = part.length - reach, shapely.get_coordinates(part)[-1]
    return Net(
        meshes, alone, sorted(loose - set(alone)), [k for k in chosen if k >= count], mended, mended_at=mended_at, left=left
    )


def _drawn_on(lines: Sequence[FloatArray], outlines: Sequence[FloatArray], reach: float) -> Lines:
    """Return lines (n, 2) drawn on at their ends so that they cross what they were meant to end on; then the outlines.

    Of the ends that are exactly at one place only one is drawn on towards each line that passes there: they meet already, and of
    very many each would cross all others.
    """
    at, way = ends_of(lines), ways_of(lines)
    own = np.repeat(np.arange(len(lines)), 2)
    on = (~together(at, own)).astype(np.int64)
    places, of_end = np.unique(at, axis=0, return_inverse=True)
    of_place = np.split(np.argsort(of_end.reshape(-1), kind="stable"), np.cumsum(np.bincount(of_end.reshape(-1)))[:-1])
    # What may be met is drawn on too: an end beside the place by no more than rounding reaches beyond it.
    longer = _lengthened(lines, outlines, reach)
    place, other = shapely.STRtree(longer).query(shapely.points(places), predicate="dwithin", distance=reach)
    for n, k in zip(place.tolist(), other.tolist(), strict=True):
        ends = of_place[n]
        if len(ends) > 1 and k not in own[ends]:
            ahead = shapely.linestrings(np.stack([at[ends], at[ends] + reach * way[ends]], axis=1))
            crossing = shapely.intersection(ahead, longer[k])
            away = np.where(shapely.is_empty(crossing), np.inf, shapely.distance(shapely.points(at[ends]), crossing))
            on[ends[np.argmin(away)]] |= int(np.isfinite(away).any())
    # The place itself stays a corner, at which the others end.
    ahead = (at + reach * way)[:, None]
    drawn = [[*ahead[2 * k][: on[2 * k]], *line, *ahead[2 * k + 1][: on[2 * k + 1]]] for k, line in enumerate(lines)]
    return np.array([*map(shapely.LineString, drawn), *map(shapely.LinearRing, outlines)], dtype=np.object_)


def without_idle_corners(corners: FloatArray) -> FloatArray:
    """Leave out the corners (n, 2) of an outline that repeat, or lie on the straight line between their neighbours."""
    size = float(np.ptp(corners, axis=0).max())
    while len(corners) >= 3:
        before, after = np.roll(corners, 1, axis=0), np.roll(corners, -1, axis=0)
        chord, offset = after - before, corners - before
        length = np.linalg.norm(chord, axis=1)
        off = np.abs(chord[:, 0] * offset[:, 1] - chord[:, 1] * offset[:, 0])
        between = np.einsum("ij,ij->i", offset, chord) * np.einsum("ij,ij->i", corners - after, chord) <= 0
        none = (off <= STRAIGHT * size * length) & between | (np.linalg.norm(offset, axis=1) <= STRAIGHT * size)
        # Two neighbours are never dropped at once: of two corners at one place one must stay.
        none &= ~np.roll(none, 1) | (np.arange(len(none)) == 0)
        none[-1] &= not none[0]
        if not none.any():
            break
        first = int(np.argmax(none))
        corners = np.delete(corners, first, axis=0) if none.sum() == 1 else corners[~none]
    return corners


def outline_flaw(corners: FloatArray) -> str:
    """Return why corners (n, 2) are no outline: it "crosses itself" or "encloses nothing"; "" when they are one."""
    if len(corners) < 3:
        return "encloses nothing"
    polygon = shapely.Polygon(corners)
    if polygon.area <= 1e-9 * polygon.length**2:
        return "encloses nothing" if shapely.is_simple(polygon.exterior) or len(corners) == 3 else "crosses itself"
    return "" if polygon.is_valid else "crosses itself"


def turned_left(corners: FloatArray) -> FloatArray:
    """Return corners (n, 2) counter-clockwise."""
    return corners if shapely.is_ccw(shapely.LinearRing(corners)) else corners[::-1]


def covering(first: Sequence[Region], second: Sequence[Region], *, alike: bool = False) -> list[bool]:
    """Return for each region of the first list whether one of the second covers half of the smaller of the two.

    alike: whether one covers nearly all of the larger of the two.
    """
    if not first or not second:
        return [False] * len(first)
    regions = np.array(second, dtype=object)
    tree = shapely.STRtree(regions)
    share, extreme = (WITHIN, np.maximum) if alike else (0.5, np.minimum)
    out: list[bool] = []
    for own in first:
        near = regions[tree.query(own, predicate="intersects")]
        out.append(bool((shapely.area(shapely.intersection(near, own)) > share * extreme(shapely.area(near), own.area)).any()))
    return out


def farthest(line: FloatArray, other: FloatArray) -> float:
    """Return how far two lines (n, 2) are apart where they are farthest."""
    return float(shapely.hausdorff_distance(shapely.LineString(line), shapely.LineString(other)))


def _lengthened(lines: Sequence[FloatArray], outlines: Sequence[FloatArray], reach: float) -> Lines:
    """Return lines drawn on at both ends, so that they cross what they were meant to end on; then closed outlines."""
    count = np.array([len(line) for line in lines], dtype=np.int64)
    last, way = np.cumsum(count) - 1, reach * ways_of(lines)
    corners = np.concatenate([*lines, np.zeros((0, 2))])
    corners[last - count + 1] += way[::2]
    corners[last] += way[1::2]
    longer = np.asarray(shapely.linestrings(corners, indices=np.repeat(np.arange(len(lines)), count)), dtype=np.object_)
    return np.concatenate([longer, np.array([*map(shapely.LinearRing, outlines)], dtype=np.object_)])
