"""What polygons have in common, pair by pair: as GEOS finds it, and where GEOS loses it."""

import numpy as np
import pytest
import shapely

from bad_faces import FIRST, SECOND
from churchpipe.geometry.overlaps import Outlines, Overlaps, overlaps
from churchpipe.model.arrays import FloatArray

TOLERANCE = 1e-9


def outlines(*rings: FloatArray) -> Outlines:
    return Outlines(np.concatenate(rings), np.append(0, np.cumsum([len(ring) for ring in rings])))


def of_pair(one: FloatArray, other: FloatArray, tolerance: float = TOLERANCE) -> Overlaps:
    return overlaps(outlines(one), outlines(other), tolerance)


def square(low: float, high: float) -> FloatArray:
    return np.array([[low, low], [high, low], [high, high], [low, high]])


def random_hull(random: np.random.Generator, corners: int) -> FloatArray:
    """Return a convex outline, which runs one way or the other."""
    points = random.normal(size=(corners, 2)) + random.uniform(-1, 1, 2)
    ring = shapely.get_coordinates(shapely.convex_hull(shapely.MultiPoint(points)))[:-1]
    return ring[:: random.choice([-1, 1])]


def test_random_convex_polygons_overlap_as_geos_finds() -> None:
    random = np.random.default_rng(20)
    ones, others = ([random_hull(random, int(random.integers(3, 12))) for _ in range(500)] for _ in range(2))
    found = overlaps(outlines(*ones), outlines(*others), TOLERANCE)
    expected = [
        shapely.intersection(shapely.Polygon(one), shapely.Polygon(other)) for one, other in zip(ones, others, strict=True)
    ]
    assert found.area == pytest.approx(shapely.area(expected), abs=1e-12)
    assert found.perimeter == pytest.approx(shapely.length(expected), abs=1e-9)
    assert 0 < (found.area == 0).sum() < 400
    for k in np.flatnonzero(found.area > 1e-6):
        corner = found.hull.of(np.array([k])).corner
        ring = shapely.get_coordinates(shapely.normalize(expected[k]))[:-1]
        assert corner == pytest.approx(ring, abs=1e-9)


def test_area_between_nearly_collinear_edges_is_not_lost() -> None:
    found = of_pair(np.array(FIRST), np.array(SECOND))
    assert found.area.tolist() == pytest.approx([0.5625], rel=1e-7)


def test_polygons_side_by_side_have_nothing_in_common() -> None:
    assert of_pair(square(0.0, 1.0), square(0.0, 1.0) + np.array([1.0, 0.0])).area.tolist() == [0.0]
    apart = of_pair(square(0.0, 1.0), square(2.0, 3.0))
    assert (apart.area.tolist(), len(apart.hull.corner), apart.hull.start.tolist()) == ([0.0], 0, [0, 0])


def test_corners_that_rounding_has_split_and_those_on_an_edge_are_left_out() -> None:
    split = np.array([[0.0, 0.0], [0.5, 1e-12], [1.0, 0.0], [1.0, 1e-12], [1.0, 1.0], [0.0, 1.0]])
    found = of_pair(split, square(-1.0, 2.0), tolerance=1e-6)
    assert found.hull.corner == pytest.approx(np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]]), abs=1e-9)


def test_a_concave_polygon_beside_convex_ones_is_not_taken_for_its_hull() -> None:
    corner_piece = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]])
    found = overlaps(
        outlines(square(0.0, 1.0), corner_piece, square(0.0, 1.0)),
        outlines(square(0.0, 1.0), square(0.0, 2.0), square(0.5, 2.0)),
        TOLERANCE,
    )
    assert found.area.tolist() == pytest.approx([1.0, 3.0, 0.25])
    assert found.perimeter.tolist() == pytest.approx([4.0, 8.0, 2.0])
    # Its hull bears all the same: what carries a convex joint are its corners.
    assert len(found.hull.of(np.array([1])).corner) == 5
    assert np.diff(found.hull.start).tolist() == [4, 5, 4]
