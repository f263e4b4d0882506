# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false
"""Plane regions and polygons. Shapely, whose type stubs leave keywords untyped, is used through this module."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import shapely

from churchpipe.model.arrays import BoolArray, FloatArray, IntArray, pointer_of, ragged_indices

Polygons = npt.NDArray[np.object_]
Polygon = shapely.Polygon
Region = shapely.Polygon | shapely.MultiPolygon
# Grid, m, to which coordinates are rounded where an intersection fails with the exact ones. Boxes overlap if by more than this.
GRID = 1e-9
DOUBTFUL = 1e-6
# A polygon lies in another when this part of it does, and when it is smaller than this part of the other.
WITHIN = 0.99


def polygon(outline: npt.ArrayLike, holes: Sequence[FloatArray] = ()) -> shapely.Polygon:
    """Return the polygon with the given outline (n, 2) and holes (n, 2)."""
    return shapely.Polygon(np.asarray(outline, dtype=np.float64), holes)


def rings(region: shapely.Polygon) -> list[FloatArray]:
    """Return the outline of a polygon and those of its holes (n, 2), each closed: its first point is also its last."""
    return [np.asarray(ring.coords, dtype=np.float64) for ring in (region.exterior, *region.interiors)]


def polygons_of(corner: FloatArray, corner_ptr: IntArray) -> Polygons:
    """Return polygons (n,) from corners (nc, 2) and their pointer array (n + 1,)."""
    counts = np.diff(corner_ptr)
    # Rings are closed: each repeats its first corner, also where its last one is at the same place.
    order = ragged_indices(corner_ptr[:-1], counts + 1)
    order[np.cumsum(counts + 1) - 1] = corner_ptr[:-1]
    ring = shapely.linearrings(corner[order], indices=np.repeat(np.arange(len(counts)), counts + 1))
    return np.atleast_1d(np.asarray(shapely.polygons(ring), dtype=np.object_))


def boxes(rectangles: FloatArray) -> Polygons:
    """Return polygons (n,) from rectangles s0, t0, s1, t1 (n, 4)."""
    return np.asarray(shapely.box(*rectangles.T), dtype=np.object_)


def overlapping(rectangles: FloatArray) -> IntArray:
    """Return the pairs i < j (k, 2) of rectangles s0, t0, s1, t1 (n, 4) that have a point in common."""
    pairs = meeting(rectangles, rectangles)
    return pairs[pairs[:, 0] < pairs[:, 1]]


def meeting(first: FloatArray, second: FloatArray) -> IntArray:
    """Return the pairs (k, 2) of a rectangle s0, t0, s1, t1 of the first (n, 4) and one of the second that have a point in
    common."""
    return np.asarray(shapely.STRtree(boxes(second)).query(boxes(first)), dtype=np.int64).T


def why_invalid(region: Region) -> str:
    """Return what is wrong with a region, or an empty text."""
    if shapely.is_valid(region) and region.area > 0:
        return ""
    return "no area" if shapely.is_valid(region) else str(shapely.is_valid_reason(region))


def area(region: Region) -> float:
    """Return the area of a region."""
    return float(region.area)


def areas(polygons: Polygons) -> FloatArray:
    """Return the areas (n,)."""
    return np.asarray(shapely.area(polygons), dtype=np.float64)


def bounds(polygons: Polygons) -> FloatArray:
    """Return the bounding rectangles s0, t0, s1, t1 (n, 4)."""
    return np.asarray(shapely.bounds(polygons), dtype=np.float64)


def extent(region: shapely.Geometry) -> FloatArray:
    """Return the bounding rectangle s0, t0, s1, t1 (4,)."""
    return np.asarray(shapely.bounds(region), dtype=np.float64)


def total_extent(polygons: Polygons) -> FloatArray:
    """Return the rectangle s0, t0, s1, t1 (4,) that bounds all of the polygons."""
    return np.asarray(shapely.total_bounds(polygons), dtype=np.float64)


def vertices(region: Region) -> FloatArray:
    """Return the corners (n, 2) of a region, those of its holes included."""
    return np.asarray(shapely.get_coordinates(region), dtype=np.float64)


def edges(region: Region) -> FloatArray:
    """Return the edges (n, 2, 2) of a region, `edges_epc`: edge e, end p, coordinate c."""
    point, ring = shapely.get_coordinates(shapely.get_rings(region), return_index=True)
    inside = ring[1:] == ring[:-1]
    return np.stack([point[:-1][inside], point[1:][inside]], axis=1)


def outer_rings(polygons: Polygons) -> tuple[FloatArray, IntArray]:
    """Return the corners (nc, 2) of the outer rings, the closing one left out, and the polygon (nc,) each belongs to."""
    point, owner = shapely.get_coordinates(shapely.get_exterior_ring(polygons), return_index=True)
    closing = np.append(owner[1:] != owner[:-1], True)[: len(owner)]
    return point[~closing], owner[~closing].astype(np.int64)


def has_hole(polygons: Polygons) -> BoolArray:
    """Return which polygons (n,) have a hole."""
    return np.asarray(shapely.get_num_interior_rings(polygons) > 0)


def moved(polygons: Polygons, corner: FloatArray) -> Polygons:
    """Return the polygons with all their ring coordinates, closing points included, replaced in order."""
    return np.asarray(shapely.set_coordinates(polygons.copy(), corner), dtype=np.object_)


def all_coordinates(polygons: Polygons) -> FloatArray:
    """Return all ring coordinates (n, 2), closing points included."""
    return np.asarray(shapely.get_coordinates(polygons), dtype=np.float64)


def coordinates_of(polygons: Polygons) -> tuple[FloatArray, IntArray]:
    """Return all ring coordinates (n, 2), closing points included, and the polygon (n,) each belongs to."""
    point, owner = shapely.get_coordinates(polygons, return_index=True)
    return np.asarray(point, dtype=np.float64), np.asarray(owner, dtype=np.int64)


def centroids(polygons: Polygons) -> FloatArray:
    """Return the centroids (n, 2)."""
    return np.asarray(shapely.get_coordinates(shapely.centroid(polygons)), dtype=np.float64)


def distances(region: Region, points: FloatArray) -> FloatArray:
    """Return how far points (n, 2) are from a region (n,), 0 inside."""
    return np.asarray(shapely.distance(region, shapely.points(points)), dtype=np.float64)


def distances_to(polygons: Polygons, point: FloatArray) -> FloatArray:
    """Return how far a point (2,) is from each polygon (n,), 0 inside."""
    return np.asarray(shapely.distance(polygons, shapely.Point(point)), dtype=np.float64)


def within(first: Region, second: Region, gap: float) -> bool:
    """Return whether two regions are no farther from each other than a gap."""
    return bool(shapely.dwithin(first, second, gap))


def touching(polygons: Polygons, region: Region) -> BoolArray:
    """Return which polygons (n,) have a point in common with the region."""
    return np.asarray(shapely.intersects(polygons, region))


def contains(region: Region, points: FloatArray) -> BoolArray:
    """Return which points (n, 2) lie inside the region, not on its border."""
    return np.asarray(shapely.contains_xy(region, points))


def inner_points(polygons: Polygons) -> FloatArray:
    """Return a point (n, 2) inside each polygon."""
    return np.asarray(shapely.get_coordinates(shapely.point_on_surface(polygons)), dtype=np.float64)


def covered(polygons: Polygons, region: Region) -> BoolArray:
    """Return which polygons (n,) lie wholly in the region."""
    shapely.prepare(region)
    return np.asarray(shapely.covers(region, polygons))


def nested(polygons: Polygons) -> IntArray:
    """Return the pairs inner, outer (k, 2) of polygons (n,) of which the first lies in the second, which is larger."""
    sound = np.asarray(shapely.make_valid(polygons), dtype=np.object_)
    size = areas(sound)
    inner, outer = shapely.STRtree(sound).query(sound, predicate="intersects")
    smaller = size[inner] < WITHIN * size[outer]
    inner, outer = inner[smaller], outer[smaller]
    inside = areas(intersections(sound[inner], sound[outer])) > WITHIN * size[inner]
    return np.stack([inner, outer], axis=1)[inside]


def common_areas(polygons: Polygons, region: Region) -> FloatArray:
    """Return the area (n,) that each polygon has in common with the region."""
    return areas(_overlap(polygons, region))


def intersections(first: Polygons, second: Polygons) -> Polygons:
    """Return what the polygons of two lists (n,) have in common, pair by pair.

    With nearly collinear edges GEOS may return the places where the edges cross and lose the area between them. Where boxes
    overlap and the answer has no area, coordinates are rounded to `GRID` for another try.
    """
    common = _overlap(first, second)
    low = np.maximum(shapely.bounds(first)[:, :2], shapely.bounds(second)[:, :2])
    high = np.minimum(shapely.bounds(first)[:, 2:], shapely.bounds(second)[:, 2:])
    doubtful = (shapely.area(common) == 0) & (high - low > DOUBTFUL).all(axis=1)
    common[doubtful] = shapely.intersection(first[doubtful], second[doubtful], grid_size=GRID)
    return common


def hull_corners(polygons: Polygons, tolerance: FloatArray) -> tuple[FloatArray, IntArray]:
    """Return the corners (k, 2) of the convex hulls of polygons (n,), counter-clockwise, and their pointer array.

    Corners closer than the tolerance (n,) to the line through their neighbours are left out.
    """
    hull = shapely.orient_polygons(shapely.convex_hull(polygons))
    ring = shapely.get_exterior_ring(hull)
    corner, owner = shapely.get_coordinates(ring, return_index=True)
    last = np.append(owner[1:] != owner[:-1], True) if len(owner) else np.zeros(0, dtype=bool)
    corner, owner = corner[~last], owner[~last]
    # Two neighbours are never dropped at once: of two corners that rounding has split one must stay.
    straight = np.ones(len(owner), dtype=bool)
    while straight.any():
        start = np.searchsorted(owner, np.arange(len(polygons)))
        stop = np.searchsorted(owner, np.arange(len(polygons)), side="right")
        position = np.arange(len(owner))
        after = np.where(position + 1 == stop[owner], start[owner], position + 1)
        before = np.where(position == start[owner], stop[owner] - 1, position - 1)
        chord = corner[after] - corner[before]
        offset = corner - corner[before]
        length = np.linalg.norm(chord, axis=1)
        distance = np.abs(chord[:, 0] * offset[:, 1] - chord[:, 1] * offset[:, 0]) / np.where(length > 0, length, 1.0)
        straight = (distance < tolerance[owner]) & (stop - start > 3)[owner]
        straight &= ~straight[before]
        corner, owner = corner[~straight], owner[~straight]
    counts = np.bincount(owner, minlength=len(polygons))
    return corner, pointer_of(counts)


def simple_hulls(polygons: Polygons, tolerance: float) -> Polygons:
    """Return the convex hulls of polygons (n,) without the corners that are less than a tolerance off a straight edge."""
    return np.asarray(shapely.simplify(shapely.normalize(shapely.convex_hull(polygons)), tolerance), dtype=np.object_)


def simplified(region: Region, tolerance: float) -> Region:
    """Return a region without the corners that lie within a tolerance, m, of the line between others (Douglas and Peucker)."""
    return shapely.simplify(region, tolerance)


def outlined(corner: FloatArray, counts: IntArray, rings: IntArray) -> Polygons:
    """Return polygons (n,) from the corners (nc, 2) of their rings, the outer one first; each of the others is a hole.

    counts (nr,): corners of each ring; rings (n,): rings of each polygon. Those that cross themselves are repaired.
    """
    ring = np.asarray(shapely.linearrings(corner, indices=np.repeat(np.arange(len(counts)), counts)), dtype=np.object_)
    found = np.asarray(shapely.polygons(ring, indices=np.repeat(np.arange(len(rings)), rings)), dtype=np.object_)
    bad = ~shapely.is_valid(found)
    found[bad] = shapely.make_valid(found[bad], method="structure", keep_collapsed=False)
    return found


def perimeters(polygons: Polygons) -> FloatArray:
    """Return the lengths (n,) of the borders."""
    return np.asarray(shapely.length(polygons), dtype=np.float64)


def widths(polygons: Polygons) -> FloatArray:
    """Return how wide polygons (n,) are: twice their area over their perimeter."""
    return 2.0 * areas(polygons) / np.maximum(perimeters(polygons), np.finfo(float).tiny)


def pieces_of(regions: Polygons) -> tuple[Polygons, IntArray]:
    """Return the polygons that regions (n,) are made of, and the region (k,) each is a piece of; lines and points are dropped."""
    part, owner = shapely.get_parts(regions, return_index=True)
    # A collection may hold polygons in turn.
    part, inner = shapely.get_parts(part, return_index=True)
    keep = shapely.get_type_id(part) == shapely.GeometryType.POLYGON
    return np.asarray(part[keep], dtype=np.object_), np.asarray(owner[inner[keep]], dtype=np.int64)


def hulls(points: FloatArray, owner: IntArray) -> Polygons:
    """Return the convex hull of the points (n, 2) of each owner (n,), sorted; those without an area are dropped."""
    found = np.asarray(shapely.convex_hull(shapely.multipoints(points, indices=owner)), dtype=np.object_)
    return found[shapely.area(found) > 0]


def clip(polygons: Polygons, region: Region) -> tuple[Polygons, IntArray]:
    """Return the polygons' parts inside the region, and the polygon (n,) each comes from; lines and points are dropped."""
    return pieces_of(_overlap(polygons, region))


def simple_parts(polygons: Polygons) -> tuple[Polygons, IntArray]:
    """Return the polygons, those whose outline touches itself as several that do not, and which (n,) each was part of."""
    if shapely.is_valid(polygons).all():
        return polygons, np.arange(len(polygons))
    return pieces_of(np.asarray(shapely.make_valid(polygons), dtype=np.object_))


def common(first: Region, second: Region) -> Region:
    """Return what two regions have in common; lines and points are dropped."""
    return _areal(_overlap(np.array([first], dtype=np.object_), second)[0])


def widened(region: Region, margin: float) -> Region:
    """Return a region drawn on by a margin all round, its corners kept sharp."""
    return _areal(shapely.buffer(region, margin, join_style="mitre")) if margin else region


def mapped(region: Region, matrix: FloatArray, shift: FloatArray) -> Region:
    """Return a region with each point p moved to `matrix` (2, 2) p + `shift` (2,)."""
    return shapely.transform(region, lambda points: points @ matrix.T + shift)


def hull(points: FloatArray) -> Region:
    """Return the convex hull of points (n, 2) that are not on a line."""
    return _areal(shapely.convex_hull(shapely.MultiPoint(points)))


def pieces(region: shapely.Geometry) -> list[shapely.Polygon]:
    """Return the connected pieces of a region."""
    return [part for part in shapely.get_parts(region) if isinstance(part, shapely.Polygon)]


def less(region: Region, holes: "Sequence[Region] | Polygons") -> Region:
    """Return the region without the others."""
    return _areal(shapely.difference(region, shapely.union_all(list(holes))))


def united(regions: "Sequence[Region] | Polygons", grid: float | None = None) -> Region:
    """Return the union of regions, their coordinates rounded to a grid, m, if one is given."""
    return _areal(shapely.union_all(list(regions), grid_size=grid))


def triangles_of(region: Region) -> FloatArray:
    """Return the triangles (k, 3, 2) of a region, which may have holes, made of its own corners."""
    found = shapely.get_parts(shapely.constrained_delaunay_triangles(region))
    return shapely.get_coordinates(found).reshape(-1, 4, 2)[:, :3]


def shared_edges(polygons: Polygons, other: shapely.Polygon) -> FloatArray:
    """Return the length (n,) of the edge that each polygon shares with another one beside it."""
    return np.asarray(shapely.length(shapely.intersection(polygons, other)), dtype=np.float64)


def level_section(region: Region, t: float) -> FloatArray:
    """Return the intervals s0, s1 (n, 2) of a region along the level line at t."""
    low, _, high, _ = extent(region)
    line = shapely.LineString([(low - 1.0, t), (high + 1.0, t)])
    spans = shapely.bounds(shapely.get_parts(shapely.intersection(line, region))).reshape(-1, 4)[:, [0, 2]]
    return spans[spans[:, 1] > spans[:, 0]]


def _overlap(first: Polygons, second: "Polygons | Region") -> Polygons:
    """Return what polygons (n,) have in common with others (n,), or with one.

    GEOS returns one of two polygons as a whole where they share nothing but an edge, and corners of both lie on it to 1e-16. An
    answer that does not lie in both is sought again with coordinates rounded to `GRID`.
    """
    found = np.asarray(shapely.intersection(first, second), dtype=np.object_)
    others = np.broadcast_to(np.asarray(second, dtype=np.object_), found.shape)
    part, owner = shapely.get_parts(found, return_index=True)
    wide = shapely.area(part) > 0
    place, owner = shapely.get_coordinates(shapely.point_on_surface(part[wide])), owner[wide]
    inside = shapely.intersects_xy(first[owner], *place.T) & shapely.intersects_xy(others[owner], *place.T)
    wrong = np.unique(owner[~inside])
    found[wrong] = shapely.intersection(first[wrong], others[wrong], grid_size=GRID)
    return found


def _areal(geometry: shapely.Geometry) -> Region:
    parts = pieces(geometry)
    return parts[0] if len(parts) == 1 else shapely.MultiPolygon(parts)
