"""Facets: neighbouring faces of a stone, triangles or strips, that together are one nearly plane surface."""

import heapq
import math
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from churchpipe.geometry.clusters import components
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray, pointer_of, ragged_indices
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.polyhedra import face_normals

# Greatest angle between a face of a facet and the facet's plane, rad, and greatest distance of its corners from that plane, as a
# share of the root of its area. Triangles of a warped quadrilateral are within both; two neighbouring sides of a stone are not.
LEAN = math.radians(5.0)
FLATNESS = 0.02
# A triangle no higher than this, m, has no reliable normal. It fills a seam between others.
SLIVER = 1e-5


@dataclass(frozen=True, slots=True)
class Facets:
    """Nearly plane parts of the surfaces of stones.

    Fields: stone (n,); normal (n, 3) outward; centre (n, 3) m, on the plane; area (n,) m2; warp (n,) m, how far its corners are
    from the plane at most; twist (n,) rad, how far its faces lean from it at most; single (n,), True where it is one face;
    corner (nc, 3) m, corner_ptr (nr + 1,): its outlines, the outer one first, counter-clockwise from outside, then the holes;
    ring_ptr (n + 1,): the outlines of each facet; of_face (nf,): the facet of each face.
    """

    stone: IntArray
    normal: FloatArray
    centre: FloatArray
    area: FloatArray
    warp: FloatArray
    twist: FloatArray
    single: BoolArray
    corner: FloatArray
    corner_ptr: IntArray
    ring_ptr: IntArray
    of_face: IntArray

    def __len__(self) -> int:
        return len(self.stone)


@dataclass(frozen=True, slots=True)
class _Edges:
    """Directed edges of faces: from node (n,), face (n,), the next one of the same face, the opposite one of the neighbour."""

    node: IntArray
    face: IntArray
    next: IntArray
    twin: IntArray


def facets_of(stones: Assemblage) -> Facets:
    """Return the facets of all stones.

    Neighbouring faces that make a blunt enough angle are linked. A connected set of them that is plane enough is a facet; of
    others, curved surfaces, facets grow from the largest face until they are no longer plane.
    """
    vector, normal, mean = face_normals(stones.points, stones.face_nodes, stones.face_ptr)
    area = np.linalg.norm(vector, axis=1)
    edges = _edges(stones)
    once = np.flatnonzero(edges.twin > np.arange(len(edges.twin)))
    pair = np.stack([edges.face[once], edges.face[edges.twin[once]]], axis=1)
    length = np.linalg.norm(stones.points[edges.node[edges.next]] - stones.points[edges.node], axis=1)
    longest = np.maximum.reduceat(length, stones.face_ptr[:-1])
    sliver = 2.0 * area < SLIVER * longest
    bend = _angle(normal[pair[:, 0]], normal[pair[:, 1]])
    linked = pair[(bend < 2.0 * LEAN) | sliver[pair].any(axis=1)]
    label = components(len(area), linked)
    if len(linked):
        plane = _planes(stones, label, vector, normal, mean, area, sliver)
        curved = (plane.twist > LEAN) | (plane.warp > FLATNESS * np.sqrt(plane.area))
        label = _grow(stones, label, curved, linked, vector, normal, mean, area, sliver)
    plane = _planes(stones, label, vector, normal, mean, area, sliver)
    of_pair = label[linked]
    smooth = of_pair[(of_pair[:, 0] != of_pair[:, 1]) & ~sliver[linked].any(axis=1)]
    twist = plane.twist.copy()
    for side in (0, 1):
        # A facet cut out of a smooth surface: another cut would give another plane.
        np.maximum.at(twist, smooth[:, side], _angle(plane.normal[smooth[:, 0]], plane.normal[smooth[:, 1]]))
    stone_of_face = np.repeat(np.arange(stones.count), np.diff(stones.block_face_ptr))
    stone = np.zeros(len(twist), dtype=np.int64)
    stone[label] = stone_of_face
    corner, corner_ptr, ring_ptr = _outlines(stones, label, plane.normal, edges)
    single = np.bincount(label, minlength=len(stone)) == 1
    return Facets(stone, plane.normal, plane.centre, plane.area, plane.warp, twist, single, corner, corner_ptr, ring_ptr, label)


@dataclass(frozen=True, slots=True)
class _Plane:
    normal: FloatArray
    centre: FloatArray
    area: FloatArray
    warp: FloatArray
    twist: FloatArray


def _planes(
    stones: Assemblage,
    label: IntArray,
    vector: FloatArray,
    normal: FloatArray,
    mean: FloatArray,
    area: FloatArray,
    sliver: BoolArray,
) -> _Plane:
    """Return the mean plane of each set of faces. It depends on the border of the set alone, not on the triangles inside."""
    count = int(label.max()) + 1
    total = np.stack([np.bincount(label, vector[:, k], minlength=count) for k in range(3)], axis=1)
    size = np.linalg.norm(total, axis=1)
    n = total / np.maximum(size, np.finfo(float).tiny)[:, None]
    weight = np.maximum(area, np.finfo(float).tiny)
    share = weight / np.bincount(label, weight, minlength=count)[label]
    centre = np.zeros((count, 3))
    np.add.at(centre, label, share[:, None] * mean)
    owner = np.repeat(label, np.diff(stones.face_ptr))
    height = np.abs(np.einsum("ij,ij->i", stones.points[stones.face_nodes] - centre[owner], n[owner]))
    warp, twist = np.zeros(count), np.zeros(count)
    np.maximum.at(warp, owner, height)
    np.maximum.at(twist, label[~sliver], _angle(normal[~sliver], n[label[~sliver]]))
    return _Plane(n, centre, size, warp, twist)


def _angle(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the angle (n,) rad between unit vectors (n, 3), exact for small ones."""
    return 2.0 * np.arcsin(np.clip(0.5 * np.linalg.norm(a - b, axis=1), 0.0, 1.0))


def _edges(stones: Assemblage) -> _Edges:
    node, pointer = stones.face_nodes, stones.face_ptr
    following = np.arange(len(node)) + 1
    following[pointer[1:] - 1] = pointer[:-1]
    face = np.repeat(np.arange(len(pointer) - 1), np.diff(pointer))
    key, turned = node * len(stones.points) + node[following], node[following] * len(stones.points) + node
    order, other = np.argsort(key), np.argsort(turned)
    # Solids are closed: each edge has its opposite, so both sorted lists are the same.
    twin = np.empty(len(node), dtype=np.int64)
    twin[order] = other
    return _Edges(node, face, following, twin)


def _grow(
    stones: Assemblage,
    label: IntArray,
    curved: BoolArray,
    linked: IntArray,
    vector: FloatArray,
    normal: FloatArray,
    mean: FloatArray,
    area: FloatArray,
    sliver: BoolArray,
) -> IntArray:
    """Return the labels with curved sets cut into facets. Each facet starts from the largest face left over and takes its
    neighbours in.
    """
    faces = np.flatnonzero(curved[label])
    if not len(faces):
        return label
    links = np.concatenate([linked, linked[:, ::-1]])
    links = links[curved[label[links[:, 0]]]]
    links = links[np.argsort(links[:, 0], kind="stable")]
    start = np.searchsorted(links[:, 0], np.arange(len(label) + 1))
    corners = {int(f): stones.points[stones.face_nodes[stones.face_ptr[f] : stones.face_ptr[f + 1]]] for f in faces}
    out, fresh = label.copy(), int(label.max()) + 1
    free = set(corners)
    for seed in faces[np.argsort(-area[faces], kind="stable")].tolist():
        if seed not in free:
            continue
        total, moment, size = np.zeros(3), np.zeros(3), 0.0
        heap = [(-area[seed], seed)]
        while heap:
            face = heapq.heappop(heap)[1]
            if face not in free:
                continue
            if face != seed:
                plane = total / np.linalg.norm(total)
                flat = np.abs((corners[face] - moment / size) @ plane).max() <= FLATNESS * np.sqrt(size + area[face])
                leans = not sliver[face] and normal[face] @ normal[seed] < np.cos(LEAN)
                if leans or not flat:
                    continue
            free.discard(face)
            out[face] = fresh
            weight = max(float(area[face]), np.finfo(float).tiny)
            total, moment, size = total + vector[face], moment + weight * mean[face], size + weight
            for neighbour in links[start[face] : start[face + 1], 1].tolist():
                if neighbour in free:
                    heapq.heappush(heap, (-area[neighbour], neighbour))
        fresh += 1
    return np.unique(out, return_inverse=True)[1].astype(np.int64)


def _outlines(stones: Assemblage, label: IntArray, normal: FloatArray, edges: _Edges) -> tuple[FloatArray, IntArray, IntArray]:
    """Return the rings around each set of faces: corners, their pointer array, and the pointer array of the sets' rings."""
    border = label[edges.face] != label[edges.face[edges.twin]]
    kept = np.flatnonzero(border)
    after = edges.next[kept]
    while (inner := ~border[after]).any():
        after[inner] = edges.next[edges.twin[after[inner]]]
    number = np.cumsum(border) - 1
    follower = number[after]
    count = len(kept)
    graph = sp.coo_matrix((np.ones(count, dtype=np.int8), (np.arange(count), follower)), shape=(count, count))
    rings, labels = connected_components(graph, directed=False)
    ring = labels.astype(np.int64)
    position = _positions(ring, follower, rings)
    order = np.lexsort((position, ring))
    corner = stones.points[edges.node[kept[order]]]
    sizes = np.bincount(ring, minlength=rings)
    pointer = pointer_of(sizes)
    owner = np.zeros(rings, dtype=np.int64)
    owner[ring] = label[edges.face[kept]]
    ring_of = ring[order]
    local = corner - corner[pointer[ring_of]]
    step = np.arange(count) + 1
    step[pointer[1:] - 1] = pointer[:-1]
    twice = np.einsum("ij,ij->i", np.cross(local, local[step]), normal[owner[ring_of]])
    signed = np.bincount(ring_of, twice, minlength=rings)
    rank = np.lexsort((-signed, owner))
    chosen = ragged_indices(pointer[:-1][rank], sizes[rank])
    ring_ptr = np.searchsorted(owner[rank], np.arange(len(normal) + 1))
    return corner[chosen], pointer_of(sizes[rank]), ring_ptr


def _positions(ring: IntArray, follower: IntArray, rings: int) -> IntArray:
    """Return the position of each edge in its ring, by pointer doubling."""
    leader = np.full(rings, len(ring), dtype=np.int64)
    np.minimum.at(leader, ring, np.arange(len(ring)))
    ahead, steps = follower.copy(), np.ones(len(ring), dtype=np.int64)
    ahead[leader], steps[leader] = leader, 0
    while (ahead != leader[ring]).any():
        steps = steps + steps[ahead]
        ahead = ahead[ahead]
    return np.bincount(ring, minlength=rings)[ring] - np.where(steps == 0, np.bincount(ring, minlength=rings)[ring], steps)


def perimeters(facets: Facets) -> FloatArray:
    """Return the length of the outlines of each facet (n,) m."""
    after = np.arange(len(facets.corner)) + 1
    after[facets.corner_ptr[1:] - 1] = facets.corner_ptr[:-1]
    length = np.linalg.norm(facets.corner[after] - facets.corner, axis=1)
    return np.add.reduceat(length, facets.corner_ptr[facets.ring_ptr[:-1]])
