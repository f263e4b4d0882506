"""Plane regions: what shapely gives and what it loses."""

import numpy as np
import pytest
import shapely

from bad_faces import FIRST, SECOND
from churchpipe.geometry.planar import area, areas, clip, common, common_areas, intersections


def test_common_area_of_faces_with_nearly_collinear_edges_is_not_lost() -> None:
    first, second = (np.array([shapely.Polygon(outline)], dtype=object) for outline in (FIRST, SECOND))
    assert areas(intersections(first, second)).tolist() == pytest.approx([0.5625], rel=1e-7)


def test_polygons_that_touch_have_no_area_in_common() -> None:
    beside = np.array([shapely.box(0, 0, 1, 1)], dtype=object)
    assert areas(intersections(beside, np.array([shapely.box(1, 0, 2, 1)], dtype=object))).tolist() == [0.0]


def test_polygons_beside_each_other_share_nothing() -> None:
    # Corners of both lie on their common edge to 1e-16. GEOS 3.14 returns the second one as a whole.
    one = shapely.Polygon(
        [
            (-1.0628957874269913, 1.7664236595647025),
            (-5.366267189260651, 0.4507509883123868),
            (-4.781523779815178, -1.4618585236136838),
            (-0.4781523779815178, -0.1461858523613684),
        ]
    )
    two = shapely.Polygon(
        [
            (0.0, 0.0),
            (-0.4781523779815177, -0.1461858523613684),
            (-1.0628957874269913, 1.7664236595647025),
            (-0.5847434094454735, 1.9126095119260709),
        ]
    )
    both = np.array([one, two], dtype=np.object_)
    assert areas(intersections(both, both[::-1])) == pytest.approx([0.0, 0.0], abs=1e-12)
    assert area(common(one, two)) == pytest.approx(0.0, abs=1e-12)
    assert common_areas(both, two) == pytest.approx([0.0, 1.0], abs=1e-9)
    assert areas(clip(both, two)[0]).sum() == pytest.approx(1.0, abs=1e-9)
