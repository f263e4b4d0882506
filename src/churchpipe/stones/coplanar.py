"""Exact joints: opposite faces of different stones in one plane."""

import numpy as np

from churchpipe.geometry.planar import Polygons, areas, bounds, hull_corners, intersections, meeting, pieces_of, polygons_of
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray, pointer_of, ragged_indices
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.polyhedra import face_normals
from churchpipe.stones.interfaces import Interfaces, frames

# Faces count as parallel within this angle (rad); an overlap smaller than this share of the smaller face is no contact.
ANGLE_TOLERANCE = 1e-5
AREA_TOLERANCE = 1e-6
# Added to the gap asked for, m, because rounded coordinates make a joint up to this much wider.
ROUNDING = 1e-9
# A face no wider than this, m, has no plane of its own, because its corners are nearly on a line.
NARROW = 1e-9


def coplanar_interfaces(stones: Assemblage, faces: BoolArray, gap: float) -> Interfaces:
    """Return the interfaces of faces that lie in one plane, to within the gap, m, and `ANGLE_TOLERANCE`.

    Faces are grouped by plane. In each group a tree of bounding boxes proposes pairs of faces, whose polygons are intersected
    all at once. faces (nf,): those to examine.
    """
    area_vector, normal, mean = face_normals(stones.points, stones.face_nodes, stones.face_ptr)
    block = np.repeat(np.arange(stones.count), np.diff(stones.block_face_ptr))
    centre = 0.5 * (stones.points.min(axis=0) + stones.points.max(axis=0))
    bucket, axes, front = _planes(normal, mean - centre, gap, stones.size)
    polygon = polygons_of(_project(stones, axes, centre), stones.face_ptr)
    wide = np.flatnonzero(faces & (_width(stones, area_vector) > NARROW))
    first, second = (wide[face] for face in _pairs(polygon[wide], bucket[wide], front[wide], block[wide]))
    apart = np.abs(np.einsum("ij,ij->i", mean[second] - mean[first], normal[first])) > gap + ANGLE_TOLERANCE * stones.size
    first, second = first[~apart], second[~apart]
    part, pair = pieces_of(intersections(polygon[first], polygon[second]))
    face_area = np.linalg.norm(area_vector, axis=1)
    smallest = AREA_TOLERANCE * np.minimum(face_area[first], face_area[second])[pair]
    keep = areas(part) > smallest
    first, second, part = first[pair[keep]], second[pair[keep]], part[keep]
    corner, corner_ptr = hull_corners(part, np.full(len(part), gap))
    return _lift(corner, corner_ptr, areas(part), axes[first], first, second, normal, mean, centre, gap)


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
    """Return for each face its group of (nearly) coplanar faces, the group's axes (nf, 3, 3), and to which side it faces."""
    # Normals are turned into one half-space, so that opposite faces have equal normals. Of many half-spaces the one is taken
    # whose border is farthest from all normals: rounding then never puts two parallel faces on different sides of it.
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
    return label, frames(n), sign > 0


def _project(stones: Assemblage, axes: FloatArray, centre: FloatArray) -> FloatArray:
    face_of = np.repeat(np.arange(len(axes)), np.diff(stones.face_ptr))
    return np.einsum("ic,iac->ia", stones.points[stones.face_nodes] - centre, axes[face_of][:, 1:])


def _pairs(polygon: Polygons, bucket: IntArray, front: BoolArray, block: IntArray) -> tuple[IntArray, IntArray]:
    """Return pairs (first, second) of faces of different stones in one group that face each other and whose boxes overlap."""
    out, into = np.flatnonzero(front), np.flatnonzero(~front)
    if not len(out) or not len(into):
        return out[:0], into[:0]
    # One tree of boxes serves all groups, because each group is moved to a place of its own along a line.
    boxes = bounds(polygon)
    boxes[:, [0, 2]] += (bucket * (2.0 * (2.0 * np.abs(boxes).max() + 1.0)))[:, None]
    found = meeting(boxes[out], boxes[into])
    first, second = out[found[:, 0]], into[found[:, 1]]
    keep = (bucket[first] == bucket[second]) & (block[first] != block[second])
    return first[keep], second[keep]


def _lift(
    corner: FloatArray,
    corner_ptr: IntArray,
    area: FloatArray,
    axes: FloatArray,
    first: IntArray,
    second: IntArray,
    normal: FloatArray,
    mean: FloatArray,
    centre: FloatArray,
    gap: float,
) -> Interfaces:
    """Bring overlap polygons back to space, halfway between the two faces, and drop those whose faces are too far apart."""
    owner = np.repeat(np.arange(len(first)), np.diff(corner_ptr))
    n = axes[:, 0]
    middle = np.zeros((len(first), 2))
    np.add.at(middle, owner, corner)
    middle /= np.maximum(np.diff(corner_ptr), 1)[:, None]
    place = centre + np.einsum("ia,iac->ic", middle, axes[:, 1:])
    height_first = np.einsum("ij,ij->i", mean[first] - place, normal[first]) / np.einsum("ij,ij->i", n, normal[first])
    height_second = np.einsum("ij,ij->i", mean[second] - place, normal[second]) / np.einsum("ij,ij->i", n, normal[second])
    apart = height_second - height_first
    keep = np.flatnonzero(np.abs(apart) <= gap + ROUNDING)
    height = 0.5 * (height_first + height_second)
    point = centre + np.einsum("ia,iac->ic", corner, axes[owner][:, 1:]) + (height[:, None] * n)[owner]
    counts = np.diff(corner_ptr)[keep]
    return Interfaces(
        side=np.stack([first, second], axis=1)[keep],
        exact=np.ones(len(keep), dtype=bool),
        frame=axes[keep],
        area=area[keep],
        gap=np.stack([apart, apart], axis=1)[keep],
        angle=np.linalg.norm(normal[first] + normal[second], axis=1)[keep],
        point=point[ragged_indices(corner_ptr[:-1][keep], counts)],
        point_ptr=pointer_of(counts),
    )
