"""Interfaces between stones: every pair of opposite coplanar faces that overlap."""

import numpy as np
import shapely

from churchpipe.errors import InputError
from churchpipe.geometry.planar import intersections
from churchpipe.model.arguments import check_kind, finite
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray, ragged_indices
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.model.polyhedra import face_normals

# Faces count as parallel within this angle (rad); an overlap smaller than this share of the smaller face is no contact.
ANGLE_TOLERANCE = 1e-5
AREA_TOLERANCE = 1e-6
# Coordinates are rounded: a joint as wide as the gap asked for is up to this much wider, m.
ROUNDING = 1e-9
# A face no wider than this, m, has no plane of its own: its corners lie on a line.
NARROW = 1e-9


def find_contacts(stones: Assemblage, gap_tolerance: float = 1e-6) -> Contacts:
    """Return the interfaces of an assemblage and their contact points.

    Faces are bucketed by plane; in each bucket a tree of bounding boxes proposes pairs, whose polygons are intersected
    all at once. A pair of stones may share several interfaces. The contact points are the vertices of the overlap, those
    on a straight edge left out; the points of a non-convex overlap are those of its convex hull, which carries the same forces.
    Stones that overlap or float are not looked for: `check_soundness` does.

    Parameters
    ----------
    stones: the assemblage. gap_tolerance: largest distance between two faces in contact, m.
    """
    check_kind("find_contacts: stones", stones, Assemblage)
    if not finite("find_contacts: gap_tolerance", gap_tolerance) > 0:
        raise InputError("find_contacts: gap_tolerance", "out of range", found=gap_tolerance, expected="> 0 m")
    area_vector, normal, mean = face_normals(stones.points, stones.face_nodes, stones.face_ptr)
    block = np.repeat(np.arange(stones.count), np.diff(stones.block_face_ptr))
    centre = 0.5 * (stones.points.min(axis=0) + stones.points.max(axis=0))
    bucket, axes, front = _planes(normal, mean - centre, gap_tolerance, stones.size)
    flat = _project(stones, axes, centre)
    polygon = _face_polygons(flat, stones.face_ptr)
    wide = np.flatnonzero(_width(stones, area_vector) > NARROW)
    first, second = (wide[face] for face in _pairs(polygon[wide], bucket[wide], front[wide], block[wide]))
    apart = (
        np.abs(np.einsum("ij,ij->i", mean[second] - mean[first], normal[first])) > gap_tolerance + ANGLE_TOLERANCE * stones.size
    )
    first, second = first[~apart], second[~apart]
    overlap = intersections(polygon[first], polygon[second])
    part, pair = shapely.get_parts(overlap, return_index=True)
    face_area = np.linalg.norm(area_vector, axis=1)
    smallest = AREA_TOLERANCE * np.minimum(face_area[first], face_area[second])[pair]
    keep = (shapely.get_type_id(part) == shapely.GeometryType.POLYGON) & (shapely.area(part) > smallest)
    part = part[keep]
    corner, corner_ptr = _hull_corners(part, gap_tolerance)
    first, second = first[pair[keep]], second[pair[keep]]
    area = np.asarray(shapely.area(part), dtype=np.float64)
    return _lift(stones, corner, corner_ptr, area, axes[first], first, second, block, normal, mean, centre, gap_tolerance)


def _width(stones: Assemblage, area_vector: FloatArray) -> FloatArray:
    """Return how wide each face is (nf,) m, across its longest edge."""
    successor = np.arange(len(stones.face_nodes)) + 1
    successor[stones.face_ptr[1:] - 1] = stones.face_ptr[:-1]
    corner = stones.points[stones.face_nodes]
    longest = np.maximum.reduceat(np.linalg.norm(corner[successor] - corner, axis=1), stones.face_ptr[:-1])
    return 2.0 * np.linalg.norm(area_vector, axis=1) / np.maximum(longest, np.finfo(float).tiny)


def _cluster(label: IntArray, value: FloatArray, tolerance: float) -> IntArray:
    """Split groups of equal label where the sorted values leave a gap wider than the tolerance."""
    order = np.lexsort((value, label))
    step = (np.diff(label[order]) != 0) | (np.diff(value[order]) > tolerance)
    out = np.empty(len(label), dtype=np.int64)
    out[order] = np.concatenate(([0], np.cumsum(step)))
    return out


def _planes(normal: FloatArray, mean: FloatArray, gap: float, size: float) -> tuple[IntArray, FloatArray, BoolArray]:
    """Return for each face its bucket of (nearly) coplanar faces, that bucket's axes (nf, 3, 3) and the side it looks to."""
    # Opposite normals meet in one half-space; its pole is the one of many that no normal comes near to lying across,
    # so that rounding never sends two parallel faces to different sides.
    poles = np.random.default_rng(0).normal(size=(64, 3))
    margin = np.abs(np.unique(np.round(normal, 9), axis=0) @ (poles / np.linalg.norm(poles, axis=1, keepdims=True)).T).min(axis=0)
    sign = np.where(normal @ poles[np.argmax(margin)] > 0, 1.0, -1.0)
    folded = normal * sign[:, None]
    label = np.zeros(len(normal), dtype=np.int64)
    for column in range(3):
        label = _cluster(label, folded[:, column], ANGLE_TOLERANCE)
    representative = folded[np.unique(label, return_index=True)[1]][label]
    offset = np.einsum("ij,ij->i", mean, representative)
    label = _cluster(label, offset, gap + ANGLE_TOLERANCE * size)
    n = folded[np.unique(label, return_index=True)[1]][label]
    return label, _frames(n), sign > 0


def _frames(n: FloatArray) -> FloatArray:
    """Return right-handed frames (k, 3, 3), rows n, t1, t2; t1 is horizontal where n is not vertical."""
    helper = np.where(np.abs(n[:, 2:]) > 0.9, [1.0, 0.0, 0.0], [0.0, 0.0, 1.0])
    t1 = np.cross(helper, n)
    t1 /= np.maximum(np.linalg.norm(t1, axis=1, keepdims=True), np.finfo(float).tiny)
    return np.stack([n, t1, np.cross(n, t1)], axis=1).astype(np.float64)


def _project(stones: Assemblage, axes: FloatArray, centre: FloatArray) -> FloatArray:
    face_of = np.repeat(np.arange(len(axes)), np.diff(stones.face_ptr))
    return np.einsum("ic,iac->ia", stones.points[stones.face_nodes] - centre, axes[face_of][:, 1:])


def _face_polygons(flat: FloatArray, face_ptr: IntArray) -> np.ndarray:
    counts = np.diff(face_ptr)
    # Rings are closed: each face repeats its first corner.
    order = ragged_indices(face_ptr[:-1], counts + 1)
    order[np.cumsum(counts + 1) - 1] = face_ptr[:-1]
    rings = shapely.linearrings(flat[order], indices=np.repeat(np.arange(len(counts)), counts + 1))
    return np.asarray(shapely.polygons(rings))


def _pairs(polygon: np.ndarray, bucket: IntArray, front: BoolArray, block: IntArray) -> tuple[IntArray, IntArray]:
    """Return pairs (first, second) of faces of different stones in one bucket that face each other, boxes overlapping."""
    # One tree serves all buckets: each bucket is moved to a place of its own along a line.
    bounds = shapely.bounds(polygon)
    reach = 2.0 * np.abs(bounds).max() + 1.0
    shift = bucket * (2.0 * reach)
    boxes = shapely.box(bounds[:, 0] + shift, bounds[:, 1], bounds[:, 2] + shift, bounds[:, 3])
    out, into = np.flatnonzero(front), np.flatnonzero(~front)
    if not len(out) or not len(into):
        return out[:0], into[:0]
    found = shapely.STRtree(boxes[into]).query(boxes[out])
    first, second = out[found[0]], into[found[1]]
    keep = (bucket[first] == bucket[second]) & (block[first] != block[second])
    return first[keep], second[keep]


def _hull_corners(polygon: np.ndarray, tolerance: float) -> tuple[FloatArray, IntArray]:
    """Return the corners of the convex hulls (k, 2), counter-clockwise, and their pointer array."""
    hull = shapely.orient_polygons(shapely.convex_hull(polygon))
    ring = shapely.get_exterior_ring(hull)
    corner, owner = shapely.get_coordinates(ring, return_index=True)
    last = np.append(owner[1:] != owner[:-1], True) if len(owner) else np.zeros(0, dtype=bool)
    corner, owner = corner[~last], owner[~last]
    # Corners closer than the tolerance to the line through their neighbours are dropped, never two neighbours at once:
    # of two corners that rounding has split one must stay.
    straight = np.ones(len(owner), dtype=bool)
    while straight.any():
        start = np.searchsorted(owner, np.arange(len(polygon)))
        stop = np.searchsorted(owner, np.arange(len(polygon)), side="right")
        position = np.arange(len(owner))
        after = np.where(position + 1 == stop[owner], start[owner], position + 1)
        before = np.where(position == start[owner], stop[owner] - 1, position - 1)
        chord = corner[after] - corner[before]
        offset = corner - corner[before]
        length = np.linalg.norm(chord, axis=1)
        distance = np.abs(chord[:, 0] * offset[:, 1] - chord[:, 1] * offset[:, 0]) / np.where(length > 0, length, 1.0)
        straight = (distance < tolerance) & (stop - start > 3)[owner]
        straight &= ~straight[before]
        corner, owner = corner[~straight], owner[~straight]
    counts = np.bincount(owner, minlength=len(polygon))
    return corner, np.concatenate(([0], np.cumsum(counts)))


def _lift(
    stones: Assemblage,
    corner: FloatArray,
    corner_ptr: IntArray,
    area: FloatArray,
    axes: FloatArray,
    first: IntArray,
    second: IntArray,
    block: IntArray,
    normal: FloatArray,
    mean: FloatArray,
    centre: FloatArray,
    gap_tolerance: float,
) -> Contacts:
    """Bring overlap polygons back to space, halfway between the two faces, and drop those whose faces are too far apart."""
    owner = np.repeat(np.arange(len(first)), np.diff(corner_ptr))
    n = axes[:, 0]
    middle = np.zeros((len(first), 2))
    np.add.at(middle, owner, corner)
    middle /= np.maximum(np.diff(corner_ptr), 1)[:, None]
    place = centre + np.einsum("ia,iac->ic", middle, axes[:, 1:])
    height_first = np.einsum("ij,ij->i", mean[first] - place, normal[first]) / np.einsum("ij,ij->i", n, normal[first])
    height_second = np.einsum("ij,ij->i", mean[second] - place, normal[second]) / np.einsum("ij,ij->i", n, normal[second])
    keep = np.abs(height_second - height_first) <= gap_tolerance + ROUNDING
    height = 0.5 * (height_first + height_second)
    point = centre + np.einsum("ia,iac->ic", corner, axes[owner][:, 1:]) + (height[:, None] * n)[owner]
    blocks = np.stack([block[first], block[second]], axis=1)[keep]
    order = np.lexsort((blocks[:, 1], blocks[:, 0]))
    chosen = np.flatnonzero(keep)[order]
    counts = np.diff(corner_ptr)[chosen]
    return Contacts(
        blocks=blocks[order],
        frame=axes[chosen],
        area=area[chosen],
        point=point[ragged_indices(corner_ptr[:-1][chosen], counts)],
        point_ptr=np.concatenate(([0], np.cumsum(counts))),
        kind=_kinds(stones, blocks[order], n[chosen]),
    )


def _kinds(stones: Assemblage, blocks: IntArray, n: FloatArray) -> np.ndarray:
    upward = np.abs(n[:, 2])
    kind = np.select([upward > 1 - 1e-6, upward < 1e-6], ["bed", "head"], "radial")
    panels = stones.panel[blocks]
    kind = np.where((panels[:, 0] != panels[:, 1]) & (kind == "head"), "junction", kind)
    return np.where(stones.fixed[blocks].any(axis=1), "base", kind)
