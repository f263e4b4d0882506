"""Stones too small to lay join a neighbour."""

import numpy as np
import pytest

from churchpipe.bond.field import Field
from churchpipe.bond.running import RunningBond
from churchpipe.errors import InputError
from churchpipe.geometry.planar import bounds, less, polygon
from churchpipe.model.building import UnitCell

CELL = UnitCell(a=0.03, b=0.08)


def rectangle(s0, t0, s1, t1):
    return polygon(np.array([[s0, t0], [s1, t0], [s1, t1], [s0, t1]], dtype=float))


def lay(solid, length, cell=CELL):
    return RunningBond(cell, "grid", 0.0, cell.b / 2).tiles(Field("wall", solid, (0.0, length)))


def widths(tiles, course):
    box = bounds(tiles.polygons[tiles.course == course])
    return np.sort(box[:, 2] - box[:, 0])


def test_a_short_end_joins_its_neighbour_of_the_same_course():
    tiles = lay(rectangle(0, 0, 4.1 * 0.08, 0.06), 4.1 * 0.08)
    np.testing.assert_allclose(widths(tiles, 0), [0.08, 0.08, 0.08, 0.088], rtol=1e-12)
    np.testing.assert_allclose(widths(tiles, 1), [0.04, 0.048, 0.08, 0.08, 0.08], rtol=1e-12)


@pytest.mark.parametrize(("end", "count"), [(0.20, 2), (0.25, 2), (0.29, 2), (0.31, 3)])
def test_ends_of_less_than_three_tenths_of_a_stone_join(end, count):
    # From b/4 on they are wide enough, but smaller than .3 a b.
    assert lay(rectangle(0, 0, (2 + end) * 0.08, 0.03), (2 + end) * 0.08).count == count


def test_a_thin_plate_over_an_opening_joins_a_higher_stone():
    # The opening's head is .1 a below a course line: the plate over it cannot be a stone of its own.
    solid = less(rectangle(0, 0, 0.4, 0.12), [rectangle(0.08, 0, 0.32, 0.057)])
    tiles = lay(solid, 0.4)
    box = bounds(tiles.polygons)
    assert (box[:, 3] - box[:, 1]).min() >= 0.3 * 0.03
    assert tiles.area.sum() == pytest.approx(0.4 * 0.12 - 0.24 * 0.057, rel=1e-12)


def test_a_low_top_course_joins_the_course_below_stone_by_stone():
    tiles = lay(rectangle(0, 0, 0.32, 0.036), 0.32)
    assert tiles.count == 4
    assert set(tiles.course.tolist()) == {0}


def test_a_pier_of_one_stone_stays():
    # .28 b: smaller than .3 a b, but a course of it has nothing to join, and two courses in one stone would be worse.
    tiles = lay(rectangle(0, 0, 0.28 * 0.08, 0.09), 0.28 * 0.08)
    assert tiles.count == 3


def test_a_pier_narrower_than_a_quarter_stone_is_an_error():
    with pytest.raises(
        InputError,
        match=r"narrower than a quarter of a stone; found 0\.015 x 0\.03 m, 0\.?\d* m along the wall.*at least 0\.02 x",
    ):
        lay(rectangle(0, 0, 0.015, 0.09), 0.015)


def test_a_wall_too_low_for_any_stone_is_an_error():
    with pytest.raises(InputError, match="no neighbour to be merged into"):
        lay(rectangle(0, 0, 0.08, 0.006), 0.08)


@pytest.mark.parametrize("below", [0.0, 2e-16, 4e-10])
def test_a_crown_that_touches_a_course_line_but_for_rounding_parts_the_stones_beside_it(below):
    # The other corner at that height is what the course line snaps to; the neck over the crown has no thickness.
    crown = 0.06 - below
    solid = less(rectangle(0, 0, 0.4, 0.09), [polygon([[0.1, 0], [0.3, 0], [0.24, crown]]), rectangle(0.35, 0.03, 0.4, 0.06)])
    tiles = lay(solid, 0.4)
    box = bounds(tiles.polygons[tiles.course == 1])
    assert ((box[:, 2] < 0.24 + 1e-9) | (box[:, 0] > 0.24 - 1e-9)).all()
    assert tiles.area.sum() == pytest.approx(0.4 * 0.09 - 0.1 * crown - 0.05 * 0.03, rel=1e-9)
