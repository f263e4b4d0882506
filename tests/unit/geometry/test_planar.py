"""Plane regions: what shapely gives and what it loses."""

import numpy as np
import pytest
import shapely

from churchpipe.geometry.planar import areas, intersections

# Two faces of an apse turned about the vertical by 5.588816891696628 rad. GEOS 3.14 answers with the two places where edges
# cross; half of the first face is common to both.
FIRST = [
    (-1.5592832587423306, -0.8864887373824326),
    (-0.8496620855484598, -0.0404439752488418),
    (-1.5392203310425099, 0.5379239232994508),
    (-2.2488415042363807, -0.3081208388341401),
]
SECOND = [
    (-0.8805042666960708, -0.0772155187123326),
    (-1.2821486406879405, -0.5560754114165338),
    (-1.9717068861819906, 0.0222924871317587),
    (-1.5700625121901208, 0.50115237983596),
]


def test_common_area_of_faces_with_nearly_collinear_edges_is_not_lost() -> None:
    first, second = (np.array([shapely.Polygon(outline)], dtype=object) for outline in (FIRST, SECOND))
    assert areas(intersections(first, second)).tolist() == pytest.approx([0.5625], rel=1e-7)


def test_polygons_that_touch_have_no_area_in_common() -> None:
    beside = np.array([shapely.box(0, 0, 1, 1)], dtype=object)
    assert areas(intersections(beside, np.array([shapely.box(1, 0, 2, 1)], dtype=object))).tolist() == [0.0]
