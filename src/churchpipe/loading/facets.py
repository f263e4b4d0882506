"""Lines of load to the facets of a shell: which parts of a line lie on which facet, and what acts on its corners and mid-sides.

A line of load on the edge of an element acts on the nodes of that edge alone. Spread over the facet as a wrench instead, it would
pull at the facet's third corner, and a wall without cohesion, which can bear no pull, would come down at its free end.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from churchpipe.geometry.locate import NEIGHBOURS, facet_at, heights_over_edges
from churchpipe.loading.lines import lines_of, main_walls, shares_within
from churchpipe.model.arrays import FloatArray, IntArray, NameArray
from churchpipe.model.placed_loads import PlacedLoads
from churchpipe.model.shell import ShellModel

# A load bears on what lies below its point: of the facets that meet there, on the one at a point so much lower, m. At the eaves a
# gable goes on above them with a sliver, which would bear the roof on its free edge.
_BELOW = 1e-3
# A place outside of all facets by more than this, m, as over the outer half of a corner, is not on one.
_OUTSIDE = 2 * _BELOW
# Lengths below this share of a line or of a facet are rounding.
_ONE = 1e-9
# A wall runs along a line if its normal meets it at less than this cosine.
_ALONG = 0.3
# Gauss's rule of three points: exact where the density of a line is quadratic, and the motion under it.
_GAUSS, _WEIGHTS = np.polynomial.legendre.leggauss(3)


@dataclass(frozen=True, slots=True)
class Pieces:
    """k pieces of placed loads, each at one point of a facet or a beam.

    part (k,): which load; share (k,): of it, of one part 1 in sum; point (k, 3) m; body (k,): facet, or nt and the number of a
    beam. line, place (k,): which line of load a piece is on, -1 for none, and where along it, m. shape (k, 9): how much of the
    force acts on the facet's corners, and on its mid-sides beyond the mean of their ends (side k from corner k to corner k + 1),
    and how much of its moment on the rotations of its sides; all zero where it acts on the facet as a whole. arm (k, 3) m: from
    the middle of the facet's thickness to the point.
    """

    part: IntArray
    share: FloatArray
    point: FloatArray
    body: IntArray
    line: IntArray
    place: FloatArray
    shape: FloatArray
    arm: FloatArray

    def forces(self, force: FloatArray) -> FloatArray:
        """Return the force (k, 3) N of each piece, of forces (n, 3) N of the parts; of lines what lies beyond the facets is
        borne by the rest of the line, where that can be."""
        amount = np.linalg.norm(force, axis=1)[self.part]
        within = (self.line < 0) | np.asarray(self.shape.any(axis=1))
        return shares_within(self.share, amount, self.place, self.line, within)[:, None] * force[self.part]


def pieces_of(part: IntArray, point: FloatArray, body: IntArray) -> Pieces:
    """Return whole parts (n,) of loads as pieces at points (n, 3) m of bodies (n,)."""
    n = len(part)
    return Pieces(part, np.ones(n), point, body, np.full(n, -1), np.zeros(n), np.zeros((n, 9)), np.zeros((n, 3)))


def bodies_of(shell: ShellModel, point: FloatArray, wall: NameArray) -> IntArray:
    """Return the facet (n,) nearest to each point (n, 3) m, among those of its wall, or of all where the shell lacks that; of a
    beam, nt and its number."""
    out = np.zeros(len(point), dtype=np.int64)
    for number, name in enumerate(shell.beams.name.tolist()):
        out[wall == name] = len(shell.triangles) + number
    for name, mine in _by_panel(shell, wall):
        out[mine] = facet_at(shell, point[mine] - np.array([0.0, 0.0, _BELOW]), name)[0]
    return out


def pieces_on(shell: ShellModel, placed: PlacedLoads) -> Pieces:
    """Return placed loads piece by piece: lines cut where they pass from facet to facet, other loads as they are."""
    line = np.flatnonzero(placed.reach.any(axis=1) & ~np.isin(placed.wall, shell.beams.name))
    alone = np.setdiff1d(np.arange(len(placed.stone)), line)
    whole = pieces_of(alone, placed.point[alone], bodies_of(shell, placed.foot[alone], placed.wall[alone]))
    if not len(line):
        return whole
    cut = _cut(shell, placed, line)
    return Pieces(*(np.concatenate([getattr(part, name) for part in (whole, cut)]) for name in Pieces.__slots__))


def _cut(shell: ShellModel, placed: PlacedLoads, chosen: IntArray) -> Pieces:
    """Return the parts of lines among the loads, piece by piece, three points each."""
    foot, reach = placed.foot[chosen], placed.reach[chosen]
    line, place = lines_of(placed, chosen)
    wall = _walls_under(shell, placed, chosen, line)
    # From -1 to 1 along each part the density is (1 + 3 lean s) / 2 of the whole.
    # Of parts that act higher up only the weight is a line: along itself it may be shifted (`placing`).
    way = placed.point[chosen] - placed.rise[chosen][:, None] * np.array([0.0, 0.0, 1.0]) - foot
    lean = np.einsum("nc,nc->n", way, reach) / (reach**2).sum(axis=1)
    owner, begin, end = _stretches(shell, foot, reach, wall)
    body = _facets_of(shell, foot[owner] + (0.5 * (begin + end))[:, None] * reach[owner], wall[owner])
    way = (0.5 * (begin + end)[:, None] + 0.5 * (end - begin)[:, None] * _GAUSS).ravel()
    weight = (0.5 * (end - begin)[:, None] * _WEIGHTS).ravel()
    owner, body = np.repeat(owner, len(_GAUSS)), np.repeat(body, len(_GAUSS))
    point = foot[owner] + way[:, None] * reach[owner]
    share = 0.5 * (1 + 3 * lean[owner] * way) * weight
    shape = _shapes(shell, point, body)
    within = np.asarray(shape.any(axis=1))
    size = np.linalg.norm(reach, axis=1)
    # What lies outside is borne by the wall of its stone, if the rest of the line cannot.
    outside = np.flatnonzero(~within)
    body[outside] = bodies_of(shell, point[outside], placed.wall[chosen][owner[outside]])
    normal = shell.axes[body, 2]
    arm = np.einsum("kc,kc->k", point - shell.centroid[body], normal)[:, None] * normal
    return Pieces(chosen[owner], share, point, body, line[owner], place[owner] + way * size[owner], shape, arm)


def _walls_under(shell: ShellModel, placed: PlacedLoads, chosen: IntArray, line: IntArray) -> NameArray:
    """Return the wall whose facets bear each part (n,) of a line: that of its stone, if it runs along the line and reaches so
    far, else the one that most of the line lies on. At a corner the stones of both walls take turns."""
    foot, reach, own = placed.foot[chosen], placed.reach[chosen], placed.wall[chosen]
    size = np.linalg.norm(reach, axis=1)
    facet = bodies_of(shell, foot, own)
    across = np.abs(np.einsum("nc,nc->n", shell.axes[facet, 2], reach)) > _ALONG * size
    beyond = heights_over_edges(shell, foot, facet[:, None])[:, 0].min(axis=1) < -_OUTSIDE
    return np.where(across | beyond, main_walls(line, size, own), own)


def _facets_of(shell: ShellModel, middle: FloatArray, wall: NameArray) -> IntArray:
    """Return the facet (k,) that each stretch lies on, by its middle (k, 3) m; along an edge the one below."""
    below, here = bodies_of(shell, middle, wall), bodies_of(shell, middle + np.array([0.0, 0.0, _BELOW]), wall)
    out = heights_over_edges(shell, middle, below[:, None])[:, 0].min(axis=1) < -_ONE * np.sqrt(shell.area[below])
    return np.where(out, here, below)


def _stretches(
    shell: ShellModel, foot: FloatArray, reach: FloatArray, wall: NameArray
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Return the line (k,), and where on it (k,), -1 to 1, each stretch of it begins and ends that lies on one facet."""
    # No stretch is longer than the facet it begins on, so that those it meets are among the nearest.
    size = np.sqrt(shell.area[bodies_of(shell, foot, wall)])
    count = np.ceil(2 * np.linalg.norm(reach, axis=1) / size).astype(np.int64)
    owner = np.repeat(np.arange(len(foot)), count)
    step = np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)
    begin, end = (2 * (step + k) / count[owner] - 1 for k in (0, 1))
    first, last = (foot[owner] + way[:, None] * reach[owner] for way in (begin, end))
    cuts, crossed = _crossings(shell, first, last, wall[owner])
    place = np.concatenate([begin, end, begin[crossed] + cuts * (end - begin)[crossed]])
    of = np.concatenate([owner, owner, owner[crossed]])
    order = np.lexsort((place, of))
    of, place = of[order], place[order]
    kept = (of[1:] == of[:-1]) & (np.diff(place) > _ONE)
    return of[:-1][kept], place[:-1][kept], place[1:][kept]


def _crossings(shell: ShellModel, begin: FloatArray, end: FloatArray, wall: NameArray) -> tuple[FloatArray, IntArray]:
    """Return where (k,), 0 to 1 of their way, stretches pass over an edge of a facet of their wall, and which do (k,)."""
    from scipy.spatial import cKDTree

    cuts, crossed = [np.zeros(0)], [np.zeros(0, dtype=np.int64)]
    for name, mine in _by_panel(shell, wall):
        members = np.flatnonzero(shell.panel == name) if name is not None else np.arange(len(shell.panel))
        near = cKDTree(shell.centroid[members]).query(0.5 * (begin + end)[mine], k=min(NEIGHBOURS, len(members)))[1]
        facets = members[near.reshape(len(mine), -1)]
        first, last = (heights_over_edges(shell, place[mine], facets) for place in (begin, end))
        stretch, facet, edge = np.nonzero((first > 0) != (last > 0))
        before, after = first[stretch, facet], last[stretch, facet]
        row = np.arange(len(edge))
        way = before[row, edge] / (before[row, edge] - after[row, edge])
        on = (before + way[:, None] * (after - before)).min(axis=1) > -_OUTSIDE
        cuts.append(way[on])
        crossed.append(mine[stretch[on]])
    return np.concatenate(cuts), np.concatenate(crossed)


def _shapes(shell: ShellModel, point: FloatArray, body: IntArray) -> FloatArray:
    """Return the shape functions (k, 9) of facets at points (k, 3) m seen along their normals, zero where these lie outside: of
    the linear displacement of corners, of the quadratic one of mid-sides, and of the linear rotation that sides have in
    their middles."""
    height = heights_over_edges(shell, point, body[:, None])[:, 0]
    corner = shell.points[shell.triangles[body]]
    side = np.linalg.norm(np.roll(corner, -1, axis=1) - corner, axis=2)
    # Over its height the distance from an edge is the barycentric coordinate of the corner across.
    across = height * side / (2 * shell.area[body])[:, None]
    corners = np.maximum(np.roll(across, 2, axis=1), 0.0)
    corners /= corners.sum(axis=1, keepdims=True)
    shape = np.concatenate([corners, 4 * corners * np.roll(corners, -1, axis=1), 1 - 2 * np.roll(corners, 1, axis=1)], axis=1)
    return np.where(height.min(axis=1)[:, None] < -_OUTSIDE, 0.0, shape)


def _by_panel(shell: ShellModel, wall: NameArray) -> Iterator[tuple[str | None, IntArray]]:
    """Yield the panels that places (n,) of these walls lie in, None for all of them, and which places those are."""
    on_beam, known = np.isin(wall, shell.beams.name), np.isin(wall, shell.panel)
    for name in np.unique(wall[known & ~on_beam]).tolist():
        yield name, np.flatnonzero(wall == name)
    if (rest := np.flatnonzero(~known & ~on_beam)).size:
        yield None, rest
