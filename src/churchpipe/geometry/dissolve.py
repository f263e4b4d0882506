"""Coplanar faces of solids merged into one, so that a triangulated stone gets the faces it was drawn with."""

import numpy as np

from churchpipe.geometry.clusters import components
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray, pointer_of, ragged_indices
from churchpipe.model.polyhedra import FLATNESS, LEAST_WARP, face_normals

# Corners this close to the line between their neighbours, m and as a part of its length, are no corners.
STRAIGHT = 1e-9


def dissolve(points: FloatArray, face_nodes: IntArray, face_ptr: IntArray) -> tuple[IntArray, IntArray, IntArray]:
    """Merge neighbouring faces that lie in one plane, of many closed bodies at once.

    points (n, 3) m; face_nodes, face_ptr: outward faces as in `Assemblage`, no vertex shared by two bodies. Faces whose union
    has a hole, touches itself or closes stay apart. Corners on a straight edge between two faces are left out. Triangles that
    look the other way, as a fan of a face that is not convex has them, are taken off those that they lie on.

    Returns
    -------
    Nodes and pointers of the merged faces, and the face that each began with (m,), rising.
    """
    count = len(face_ptr) - 1
    owner = np.repeat(np.arange(count), np.diff(face_ptr))
    following = np.arange(len(face_nodes)) + 1
    following[face_ptr[1:] - 1] = face_ptr[:-1]
    twin = _twins(face_nodes, face_nodes[following])
    group = _flat_groups(points, face_nodes, face_ptr, owner, twin)
    starts, sizes, after = _outlines(group[owner], following, twin)
    walk, pointer = _walk(starts, sizes, after)
    unsound = _unsound(group, owner[starts], np.repeat(np.arange(len(starts)), sizes), face_nodes[walk])
    if unsound.any():
        group = np.where(unsound[group], count + np.arange(count), group)
        starts, sizes, after = _outlines(group[owner], following, twin)
        walk, pointer = _walk(starts, sizes, after)
    nodes, pointer = _without_straight_corners(points, face_nodes[walk], pointer)
    return nodes, pointer, owner[starts]


def _twins(start: IntArray, stop: IntArray) -> IntArray:
    """Return for each half-edge the one that runs back."""
    base = int(start.max(initial=0)) + 1
    order = np.argsort(start * base + stop)
    return order[np.searchsorted((start * base + stop)[order], stop * base + start)]


def _flat_groups(points: FloatArray, nodes: IntArray, face_ptr: IntArray, owner: IntArray, twin: IntArray) -> IntArray:
    """Return for each face its group: neighbours in one plane that all corners of the group lie in."""
    count, sizes = len(face_ptr) - 1, np.diff(face_ptr)
    area, normal, mean = face_normals(points, nodes, face_ptr)
    extent = np.zeros(count)
    np.maximum.at(extent, owner, np.linalg.norm(points[nodes] - mean[owner], axis=1))
    has_area = np.linalg.norm(area, axis=1) > STRAIGHT * extent**2
    first, second = owner, owner[twin]
    # Each half-edge with the corners of the face behind it: how far they are from the plane of its own face.
    corner = points[nodes[ragged_indices(face_ptr[second], sizes[second])]]
    pair = np.repeat(np.arange(len(first)), sizes[second])
    height = np.zeros(len(first))
    np.maximum.at(height, pair, np.abs(np.einsum("ij,ij->i", corner - mean[first[pair]], normal[first[pair]])))
    near = height <= FLATNESS * (extent[first] + extent[second]) + LEAST_WARP
    linked = has_area[first] & has_area[second] & near & near[twin]
    # A face without area belongs to what lies along its longest edge.
    length = np.linalg.norm(points[nodes[twin]] - points[nodes], axis=1)
    longest = np.zeros(count)
    np.maximum.at(longest, owner, length)
    linked |= has_area[first] & ~has_area[second] & near & (length == longest[second])
    group = components(count, np.stack([first[linked], second[linked]], axis=1))
    return _in_plane(points[nodes], owner, area, group)


def _in_plane(corner: FloatArray, owner: IntArray, area: FloatArray, group: IntArray) -> IntArray:
    """Divide groups whose corners do not lie in one plane."""
    count, member = int(group.max(initial=-1)) + 1, group[owner]
    total, mean, extent, warp = np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count), np.zeros(count)
    np.add.at(total, group, area)
    np.add.at(mean, member, corner)
    mean /= np.bincount(member, minlength=count)[:, None]
    total /= np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-300)
    reach = corner - mean[member]
    np.maximum.at(extent, member, np.linalg.norm(reach, axis=1))
    np.maximum.at(warp, member, np.abs(np.einsum("ij,ij->i", reach, total[member])))
    apart = warp > FLATNESS * extent + LEAST_WARP
    return np.where(apart[group], count + np.arange(len(group)), group)


def _outlines(group: IntArray, following: IntArray, twin: IntArray) -> tuple[IntArray, IntArray, IntArray]:
    """Return the first half-edge and the length of each outline of the groups, and the next one of each half-edge on one."""
    border = np.flatnonzero(group != group[twin])
    on_border = np.zeros(len(group), dtype=bool)
    on_border[border] = True
    after = following.copy()
    inner = border[~on_border[after[border]]]
    while len(inner):
        after[inner] = following[twin[after[inner]]]
        inner = inner[~on_border[after[inner]]]
    ring = components(len(group), np.stack([border, after[border]], axis=1))[border]
    _, first, sizes = np.unique(ring, return_index=True, return_counts=True)
    order = np.argsort(first)
    return border[first[order]], sizes[order], after


def _walk(starts: IntArray, sizes: IntArray, after: IntArray) -> tuple[IntArray, IntArray]:
    """Return the half-edges along each outline, one outline after the other, and the pointers to them."""
    pointer = pointer_of(sizes)
    walk = np.empty(pointer[-1], dtype=np.int64)
    place, half, left = pointer[:-1], starts, sizes
    while len(place):
        walk[place] = half
        more = left > 1
        place, half, left = place[more] + 1, after[half[more]], left[more] - 1
    return walk, pointer


def _unsound(group: IntArray, face: IntArray, ring: IntArray, node: IntArray) -> BoolArray:
    """Return for each group whether it has no outline, as all faces of a film have together, more than one, or one that passes
    a vertex twice.
    """
    out = np.bincount(group[face], minlength=int(group.max(initial=-1)) + 1) != 1
    order = np.lexsort((node, ring))
    twice = (np.diff(node[order]) == 0) & (np.diff(ring[order]) == 0)
    out[group[face[ring[order[1:]][twice]]]] = True
    return out


def _without_straight_corners(points: FloatArray, nodes: IntArray, pointer: IntArray) -> tuple[IntArray, IntArray]:
    """Leave out the corners that two faces share and that lie straight between their neighbours."""
    owner = np.repeat(np.arange(len(pointer) - 1), np.diff(pointer))
    after, before = np.roll(nodes, -1), np.roll(nodes, 1)
    after[pointer[1:] - 1], before[pointer[:-1]] = nodes[pointer[:-1]], nodes[pointer[1:] - 1]
    chord, offset = points[after] - points[before], points[nodes] - points[before]
    length = np.maximum(np.linalg.norm(chord, axis=1), 1e-300)
    along = np.einsum("ij,ij->i", chord, offset)
    distance = np.linalg.norm(np.cross(chord, offset), axis=1) / length
    straight = (distance <= STRAIGHT * (1 + length)) & (along > 0) & (along < length**2)
    total = np.bincount(nodes, minlength=len(points))
    needless = (np.bincount(nodes[straight], minlength=len(points)) == total) & (total == 2)
    keep = ~needless[nodes]
    # A face of which fewer than three corners would stay keeps them all, and so do its neighbours.
    poor = np.bincount(owner[keep], minlength=len(pointer) - 1) < 3
    needless[nodes[poor[owner]]] = False
    keep = ~needless[nodes]
    return nodes[keep], pointer_of(np.bincount(owner[keep], minlength=len(pointer) - 1))
