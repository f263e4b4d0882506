"""Plane regions: what shapely gives and what it loses."""

import numpy as np
import pytest
import shapely

from bad_faces import FIRST, SECOND
from churchpipe.geometry.planar import areas, intersections


def test_common_area_of_faces_with_nearly_collinear_edges_is_not_lost() -> None:
    first, second = (np.array([shapely.Polygon(outline)], dtype=object) for outline in (FIRST, SECOND))
    assert areas(intersections(first, second)).tolist() == pytest.approx([0.5625], rel=1e-7)


def test_polygons_that_touch_have_no_area_in_common() -> None:
    beside = np.array([shapely.box(0, 0, 1, 1)], dtype=object)
    assert areas(intersections(beside, np.array([shapely.box(1, 0, 2, 1)], dtype=object))).tolist() == [0.0]
