"""Stones cut into the swept pieces they consist of: plane sections moved along level lines, between upright planes."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from churchpipe.geometry.clusters import clusters
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.polyhedra import face_normals

# Directions, as sines, and volumes, as shares, that differ by less are the same.
SAME = 1e-6
# Corners closer than this, m, are one: coordinates of six decimals and more.
ONE = 2e-6
# Pieces of one stone, at most: a corner stone of a vault over a polygon has two, a wide one near the crown of a dome eight.
_MOST_PIECES = 8


@dataclass(frozen=True, slots=True)
class Piece:
    """A section swept along one direction.

    angle: of the horizontal normal of the direction, rad, 0 <= angle < pi; corner (k, 2) m, the section in (d, z), d along that
    normal from the origin, counter-clockwise; ends (2, 2): the upright planes s = a + c d at its ends, s along the direction, a
    in m; volume m3; lower, upper (2,) m: the middles of its beds, where it closes a dome.
    """

    angle: float
    corner: FloatArray
    ends: FloatArray
    volume: float
    lower: FloatArray | None = None
    upper: FloatArray | None = None


@dataclass(frozen=True, slots=True)
class _Facet:
    """A face of a stone: its normal (3,), and the edges (m, 2, 3) m around it."""

    normal: FloatArray
    edges: FloatArray


def pieces_of(stones: Assemblage, block: int) -> list[tuple[Piece, ...]]:
    """Return every way in which a stone is a union of swept pieces; none if it is no such stone."""
    facets = _facets(stones, block)
    volume = float(stones.volume[block])
    angles = _angles(facets)
    found = [piece for angle in angles if (piece := _piece(facets, angle)) is not None]
    ways = [
        way
        for count in range(1, _MOST_PIECES + 1)
        for way in combinations(found, count)
        if abs(sum(piece.volume for piece in way) - volume) < SAME * volume
    ]
    if ways or len(angles) < 2:
        return ways
    closing = _closing(facets, angles, _axis(facets, stones.centroid[block]))
    return [closing] if abs(sum(piece.volume for piece in closing) - volume) < SAME * volume else []


def across(angle: float) -> tuple[FloatArray, FloatArray]:
    """Return the normal (2,) and the direction (2,) in plan of pieces of this angle, rad."""
    return np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])


def _facets(stones: Assemblage, block: int) -> list[_Facet]:
    """Return the faces of a stone."""
    first, last = stones.block_face_ptr[block : block + 2]
    ptr = stones.face_ptr[first : last + 1]
    nodes = stones.face_nodes[ptr[0] : ptr[-1]]
    _, normal, _ = face_normals(stones.points, nodes, ptr - ptr[0])
    out: list[_Facet] = []
    for face in range(len(normal)):
        own = nodes[ptr[face] - ptr[0] : ptr[face + 1] - ptr[0]]
        out.append(_Facet(normal[face], stones.points[np.stack([own, np.roll(own, -1)], axis=1)]))
    return out


def _angles(facets: Sequence[_Facet]) -> FloatArray:
    """Return the angles, rad, of the normals of all level edges, each once."""
    edge = np.concatenate([facet.edges[:, 1] - facet.edges[:, 0] for facet in facets])
    length = np.linalg.norm(edge, axis=1)
    level = (np.abs(edge[:, 2]) < SAME * length) & (length > ONE)
    angle = (np.arctan2(edge[level, 1], edge[level, 0]) - np.pi / 2) % np.pi
    angle = np.where(angle > np.pi - SAME, angle - np.pi, angle)
    return _means(angle, clusters(angle[:, None], SAME)) if len(angle) else angle


def _means(values: FloatArray, label: IntArray) -> FloatArray:
    return np.asarray(np.bincount(label, values) / np.bincount(label), dtype=np.float64)


def _along(facet: _Facet, angle: float) -> FloatArray:
    """Return the edges (m, 4) of a facet along a direction: d, z, and s of both ends, m; none if the facet is not along it."""
    normal, along = across(angle)
    edge = facet.edges[:, 1] - facet.edges[:, 0]
    length = np.linalg.norm(edge, axis=1)
    own = facet.edges[np.abs(edge[:, :2] @ along) > (1 - SAME) * length]
    if abs(facet.normal[:2] @ along) > SAME or not len(own):
        return np.empty((0, 4))
    if len(own) == 1:
        # The other joint of a triangle is a point.
        apart = np.linalg.norm(facet.edges[:, :1] - own[0], axis=2).min(axis=1) > ONE
        own = np.concatenate([own, np.repeat(facet.edges[apart, :1], 2, axis=1)])
    s = np.sort(own[:, :, :2] @ along, axis=1)
    return np.column_stack([own[:, :, :2].mean(axis=1) @ normal, own[:, :, 2].mean(axis=1), s])


def _piece(facets: Sequence[_Facet], angle: float) -> Piece | None:
    """Return the piece of a stone along one direction, or None if its faces there do not go round a section."""
    found = [rows for facet in facets if len(rows := _along(facet, angle))]
    if len(found) < 3:
        return None
    row = np.concatenate(found)
    label = clusters(row[:, :2], ONE)
    count = label.max() + 1
    corner = np.stack([_means(row[:, axis], label) for axis in (0, 1)], axis=1)
    s = np.full((2, count), np.inf)
    np.minimum.at(s[0], label, row[:, 2])
    np.minimum.at(s[1], label, -row[:, 3])
    s[1] *= -1
    after: dict[int, list[int]] = {number: [] for number in range(count)}
    stop = 0
    for rows in found:
        own = np.unique(label[stop : stop + len(rows)])
        stop += len(rows)
        if len(own) != 2:
            return None
        after[own[0]].append(own[1])
        after[own[1]].append(own[0])
    order = _ring(after)
    if order is None:
        return None
    ends = np.stack([_line(corner[:, 0], s[end]) for end in (0, 1)])
    if np.isnan(ends).any():
        return None
    return _swept(angle, corner[order], ends)


def _swept(angle: float, corner: FloatArray, ends: FloatArray, *joints: FloatArray) -> Piece | None:
    """Return a piece, its section turned counter-clockwise; None where it has no volume."""
    local = corner - corner[0]
    next_ = np.roll(local, -1, axis=0)
    cross = local[:, 0] * next_[:, 1] - local[:, 1] * next_[:, 0]
    if abs(cross.sum()) < ONE**2:
        return None
    centroid = corner[0, 0] + cross @ (local[:, 0] + next_[:, 0]) / (3 * cross.sum())
    length = float((ends[1] - ends[0]) @ np.array([1.0, centroid]))
    return Piece(angle, corner[:: 1 if cross.sum() > 0 else -1], ends, 0.5 * abs(float(cross.sum())) * length, *joints)


def _ring(after: dict[int, list[int]]) -> list[int] | None:
    """Return the corners in the order in which sides join them, None if these are not one ring."""
    if any(len(others) != 2 for others in after.values()):
        return None
    order = [0]
    while len(order) < len(after):
        onward = [other for other in after[order[-1]] if other not in order[-2:]]
        if not onward or onward[0] in order:
            return None
        order.append(onward[0])
    return order if order[0] in after[order[-1]] else None


def _line(d: FloatArray, s: FloatArray) -> FloatArray:
    """Return a and c (2,) of the line s = a + c d through points, not numbers where they lie on none."""
    matrix = np.column_stack([np.ones(len(d)), d])
    if np.ptp(d) < ONE:
        return np.full(2, np.nan)
    found = np.linalg.lstsq(matrix, s, rcond=None)[0]
    return np.asarray(found, dtype=np.float64) if np.abs(matrix @ found - s).max() < 2 * ONE else np.full(2, np.nan)


def _axis(facets: Sequence[_Facet], middle: FloatArray) -> FloatArray:
    """Return a point (3,) m of the axis of a stone that closes a dome: the corner of most faces, or its middle if none is.

    Of a half dome the axis lies in the face that it ends with.
    """
    corner = np.concatenate([facet.edges[:, 0] for facet in facets])
    label = clusters(corner, ONE)
    count = np.bincount(label)
    return corner[np.argmax(label == count.argmax())] if count.max() > 4 else middle


def _closing(facets: Sequence[_Facet], angles: FloatArray, middle: FloatArray) -> tuple[Piece, ...]:
    """Return the sectors of a stone that closes a dome: between its upright axis, its outer faces, and what joins them."""
    return tuple(piece for angle in angles for piece in _sectors(facets, float(angle), middle))


def _sectors(facets: Sequence[_Facet], angle: float, middle: FloatArray) -> Iterator[Piece]:
    normal, along = across(angle)
    axis, place = float(middle[:2] @ normal), float(middle[:2] @ along)
    rows = [_along(facet, angle) for facet in facets]
    outer = [len(row) == 2 and bool(np.prod(row[:, 0] - axis) > ONE**2) for row in rows]
    inner = [row for row, is_outer in zip(rows, outer, strict=True) if len(row) and not is_outer]
    for row in (row for row, is_outer in zip(rows, outer, strict=True) if is_outer):
        low, high = row[np.argsort(row[:, 1])]
        at_axis = [_height(inner, axis, edge) for edge in (low, high)]
        corner = np.array([[axis, at_axis[0]], low[:2], high[:2], [axis, at_axis[1]]])
        ends = np.stack([_line(np.array([axis, low[0]]), np.array([place, s])) for s in low[2:]])
        order = np.argsort(ends @ np.array([1.0, low[0]]))
        joints = corner[1:3].mean(axis=0), corner[[0, 3]].mean(axis=0)
        piece = _swept(angle, corner, ends[order], *joints)
        if piece:
            yield piece


def _height(inner: Sequence[FloatArray], axis: float, edge: FloatArray) -> float:
    """Return z on the axis of the face that goes on inwards from an edge, m."""
    for row in inner:
        beside = (np.abs(row[:, :2] - edge[:2]) < ONE).all(axis=1)
        if beside.any() and len(row) == 2:
            (d0, z0), (d1, z1) = row[:, :2]
            return float(z0 + (z1 - z0) * (axis - d0) / (d1 - d0)) if abs(d1 - d0) > ONE else float("nan")
    return float("nan")
