"""In which stone a point lies, and on which facet of a shell."""

import numpy as np
import shapely

from churchpipe.geometry.planar import polygons_of
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray, pointer_of, ragged_indices
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.polyhedra import face_normals
from churchpipe.model.shell import ShellModel

# A point at this share of a stone's size from its surface touches it.
TOUCHING = 1e-6
# Number of points treated at once. It bounds the memory.
CHUNK = 20_000
# Faces of a straight stone without a notch.
PRISM = 6
# Facets looked at for each point.
NEIGHBOURS = 16


def inside_stones(stones: Assemblage, points: FloatArray) -> BoolArray:
    """Return which points (n, 3) m lie in a free stone.

    The winding numbers of the surfaces of all free stones add up to one inside a stone, and to zero outside.
    """
    free = np.flatnonzero(~stones.fixed)
    count = np.diff(stones.block_point_ptr)[free]
    owned = stones.points[ragged_indices(stones.block_point_ptr[free], count)]
    start = np.cumsum(count) - count
    low, high = np.minimum.reduceat(owned, start), np.maximum.reduceat(owned, start)
    triangles, pointer = _surface_triangles(stones, free)
    # Projected along a slanting direction, walls along x and walls along y both have a large area, so the tree of boxes separates
    # their stones well.
    slant = np.array([np.cos(0.6), np.sin(0.6)])
    tree = shapely.STRtree(shapely.box(low[:, :2] @ slant, low[:, 2], high[:, :2] @ slant, high[:, 2]))
    inside = np.zeros(len(points), dtype=np.bool_)
    for first in range(0, len(points), CHUNK):
        part = points[first : first + CHUNK]
        point, stone = tree.query(shapely.points(part[:, :2] @ slant, part[:, 2]))
        near = ((part[point] >= low[stone]) & (part[point] <= high[stone])).all(axis=1)
        point, stone = point[near], stone[near]
        sides = pointer[stone + 1] - pointer[stone]
        owner = np.repeat(point, sides)
        angle = solid_angles(triangles[ragged_indices(pointer[stone], sides)] - part[owner][:, None])
        winding = np.bincount(owner, angle, minlength=len(part)) / (4 * np.pi)
        inside[first : first + CHUNK] = winding > 0.5
    return inside


def stones_at(stones: Assemblage, point: FloatArray) -> IntArray:
    """Return the stones (n,) that contain a point (3,) m, or that it touches to a millionth of their size."""
    low, high = (edge.reduceat(stones.points, stones.block_point_ptr[:-1], axis=0) for edge in (np.minimum, np.maximum))
    reach = TOUCHING * np.linalg.norm(high - low, axis=1)
    near = np.flatnonzero(((point >= low - reach[:, None]) & (point <= high + reach[:, None])).all(axis=1))
    return near[[_holds_or_touches(stones, int(stone), point, float(reach[stone])) for stone in near]]


def _holds_or_touches(stones: Assemblage, stone: int, point: FloatArray, reach: float) -> bool:
    triangles = _surface_triangles(stones, np.array([stone]))[0] - point
    if abs(solid_angles(triangles).sum()) > 2 * np.pi:
        return True
    for face in range(*stones.block_face_ptr[stone : stone + 2]):
        corners = stones.points[stones.face_nodes[stones.face_ptr[face] : stones.face_ptr[face + 1]]] - point
        _, (normal,), _ = face_normals(corners, np.arange(len(corners)), np.array([0, len(corners)]))
        across = np.linalg.svd(normal[None])[2][1:]
        if abs(corners[0] @ normal) <= reach and shapely.Polygon(corners @ across.T).distance(shapely.Point(0, 0)) <= reach:
            return True
    return False


def interior_points(stones: Assemblage) -> FloatArray:
    """Return a point (nb, 3) m inside each stone: the centroid, or a point near it if a notch of the stone contains that."""
    out = _beside_notches(stones)
    for stone in np.flatnonzero((np.diff(stones.block_face_ptr) > PRISM) & ~stones.fixed):
        out[stone] = _inside(stones, int(stone), out[stone])
    return out


def _beside_notches(stones: Assemblage) -> FloatArray:
    """Return the centroids (nb, 3) m; of stones whose front, the face with the most corners, is notched there, a place beside."""
    _, normal, _ = face_normals(stones.points, stones.face_nodes, stones.face_ptr)
    corners = np.diff(stones.face_ptr)
    block = np.repeat(np.arange(stones.count), np.diff(stones.block_face_ptr))
    order = np.lexsort((corners, block))
    face = order[stones.block_face_ptr[1:] - 1]
    notched = np.flatnonzero((corners[face] > 4) & (np.abs(normal[face, 2]) < 0.5) & ~stones.fixed)
    out = stones.centroid.copy()
    if not len(notched):
        return out
    face = face[notched]
    across = np.cross([0.0, 0.0, 1.0], normal[face])
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    owner = np.repeat(np.arange(len(face)), corners[face])
    reach = stones.points[stones.face_nodes[ragged_indices(stones.face_ptr[face], corners[face])]] - out[notched][owner]
    flat = np.stack([np.einsum("nc,nc->n", reach, across[owner]), reach[:, 2]], axis=1)
    front = polygons_of(flat, pointer_of(corners[face]))
    outside = ~shapely.contains_xy(front, 0.0, 0.0)
    aside = shapely.get_coordinates(shapely.point_on_surface(front[outside]))
    out[notched[outside]] += aside[:, :1] * across[outside] + aside[:, 1:] * np.array([0.0, 0.0, 1.0])
    return out


def _inside(stones: Assemblage, stone: int, place: FloatArray) -> FloatArray:
    """Return a place (3,) m if it lies inside a stone, else one behind a large upright face of it: a bent front is notched."""
    triangles, _ = _surface_triangles(stones, np.array([stone]))

    def holds(point: FloatArray) -> bool:
        return bool(solid_angles(triangles - point).sum() > 2 * np.pi)

    if holds(place):
        return place
    area_vector, normal, mean = face_normals(
        triangles.reshape(-1, 3), np.arange(3 * len(triangles)), 3 * np.arange(len(triangles) + 1)
    )
    size = np.where(np.abs(normal[:, 2]) < 0.5, np.linalg.norm(area_vector, axis=1), 0.0)
    for side in np.argsort(-size):
        if holds(under := mean[side] - 0.1 * np.sqrt(size[side]) * normal[side]):
            return under
    return place


def facet_at(shell: ShellModel, points: FloatArray, panel: str | None) -> tuple[IntArray, FloatArray]:
    """Return for points (n, 3) m the facet of a panel, or of all (None), that each lies over, seen along the facet's normal.

    Also returned is how far outside of that facet the point lies, m; 0 inside.
    """
    # Who draws a picture needs this module, and SciPy takes as long to load as the picture.
    from scipy.spatial import cKDTree

    members = np.arange(len(shell.panel)) if panel is None else np.flatnonzero(shell.panel == panel)
    near = cKDTree(shell.centroid[members]).query(points, k=min(NEIGHBOURS, len(members)))[1].reshape(len(points), -1)
    height = heights_over_edges(shell, points, members[near]).min(axis=2)
    best = np.argmax(height, axis=1)
    row = np.arange(len(points))
    return members[near[row, best]], np.maximum(-height[row, best], 0.0)


def heights_over_edges(shell: ShellModel, points: FloatArray, facets: IntArray) -> FloatArray:
    """Return how far (n, k, e) m points (n, 3) m lie inwards of edge e, from corner e to corner e + 1, of facets (n, k), seen
    along their normals: all three are positive inside."""
    corner = shell.points[shell.triangles[facets]]
    after = np.roll(corner, -1, axis=2)
    normal = shell.axes[facets, 2]
    turn = np.sign(np.einsum("nkc,nkc->nk", np.cross(after[:, :, 0] - corner[:, :, 0], after[:, :, 1] - corner[:, :, 1]), normal))
    inward = np.cross(normal[:, :, None], after - corner) * turn[:, :, None, None]
    inward /= np.linalg.norm(inward, axis=3, keepdims=True)
    return np.einsum("nkec,nkec->nke", points[:, None, None] - corner, inward)


def _surface_triangles(stones: Assemblage, blocks: IntArray) -> tuple[FloatArray, IntArray]:
    """Return the faces of some stones as fans of triangles (n, 3, 3) m and the pointer array of the stones."""
    faces = np.diff(stones.block_face_ptr)[blocks]
    face = ragged_indices(stones.block_face_ptr[blocks], faces)
    fans = np.diff(stones.face_ptr)[face] - 2
    start = np.repeat(stones.face_ptr[face], fans)
    step = ragged_indices(np.ones(len(face), dtype=np.int64), fans)
    nodes = stones.face_nodes[np.stack([start, start + step, start + step + 1], axis=1)]
    per_stone = np.add.reduceat(fans, np.cumsum(faces) - faces)
    return stones.points[nodes], pointer_of(per_stone)


def solid_angles(triangles: FloatArray) -> FloatArray:
    """Return the signed solid angles (n,) of triangles (n, 3, 3) seen from the origin (Van Oosterom & Strackee 1983)."""
    a, b, c = np.moveaxis(triangles, 1, 0)
    la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))

    def dot(p: FloatArray, q: FloatArray) -> FloatArray:
        return np.einsum("ij,ij->i", p, q)

    return 2 * np.arctan2(dot(a, np.cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb)
