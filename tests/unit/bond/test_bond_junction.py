"""Who owns the junctions of walls: corners, T and crossings; toothed, butt and of unequal height."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from churchpipe.bond.junction import wall_junctions
from churchpipe.bond.walls import lay_wall, wall_region
from churchpipe.errors import InputError
from churchpipe.model.building import Opening, UnitCell
from crossing_walls import along_x, along_y, junctions, owned, wall


@pytest.mark.parametrize(
    ("second", "zone_x", "zone_y"),
    [
        (along_y(), (0.0, 0.5), (0.0, 0.5)),
        (along_y(left=4.5), (4.5, 5.0), (0.0, 0.5)),
        (along_y(left=2.0), (2.0, 2.5), (0.0, 0.5)),
        (along_y(left=2.0, start=-1.5), (2.0, 2.5), (1.5, 2.0)),
    ],
    ids=["left corner", "right corner", "T", "cross"],
)
def test_toothed_walls_take_turns(second, zone_x, zone_y):
    x, y = junctions(along_x(), second)
    np.testing.assert_allclose(x.zones, [zone_x], atol=1e-12)
    np.testing.assert_allclose(y.zones, [zone_y], atol=1e-12)
    assert owned(x, zone_x) == [0.25, 0.75]
    assert owned(y, zone_y) == [0.0, 0.5]


@pytest.mark.parametrize(("first", "second", "loser"), [(None, 1, 1), (0, None, 0), (0, 0, 1), (1, 1, 1), (None, None, 1)])
def test_butt_walls_lose_every_course(first, second, loser):
    found = junctions(along_x(parity=first), along_y(left=2.0, parity=second))
    assert owned(found[loser], found[loser].zones[0]) == [0.0, 0.25, 0.5, 0.75]
    assert not len(found[1 - loser].ceded)


def test_where_only_one_wall_stands_it_owns_the_junction():
    x, y = junctions(along_x(height=0.75), along_y(left=2.0, height=1.5))
    assert owned(x, (2.0, 2.5)) == [0.25]
    assert owned(y, (0.0, 0.5)) == [0.0, 0.5]


def test_a_wall_that_ends_within_a_course_leaves_the_rest_to_the_other():
    x, y = junctions(along_x(height=0.6), along_y(left=2.0, height=1.0))
    np.testing.assert_allclose(y.ceded[:, [1, 3]], [[0.0, 0.25], [0.5, 0.6]], atol=1e-12)
    np.testing.assert_allclose(x.ceded[:, [1, 3]], [[0.25, 0.5]], atol=1e-12)


def test_an_opening_in_the_junction_leaves_it_to_the_wall_that_is_whole():
    hole = Opening("door", np.array([[1.8, 0.0], [2.2, 0.0], [2.2, 0.5], [1.8, 0.5]]))
    x, y = junctions(along_x(openings=(hole,)), along_y(left=2.0))
    assert owned(x, (2.0, 2.5)) == [0.0, 0.25, 0.75]
    assert owned(y, (0.0, 0.5)) == [0.5]


def test_three_walls_in_one_junction_cover_it_once():
    walls = [along_x(), along_y(left=2.0), wall("z", (2.25, -2.0), (0.0, 1.0), 2.5, parity=1)]
    solids = [wall_region(panel) for panel in walls]
    found = wall_junctions(walls, solids)
    tiles = [lay_wall(*item) for item in zip(walls, solids, found, strict=True)]
    zone = 2.0, 2.5
    for course in range(4):
        share = [shapely.area(shapely.union_all(t.polygons[t.course == course])) for t in tiles]
        clear = 4.5 + 3.5 + 2.0
        assert sum(share) == pytest.approx((clear + 0.5) * 0.25, rel=1e-12), zone


def test_butt_walls_may_have_courses_of_their_own():
    x, y = junctions(along_x(parity=None), along_y(left=2.0, cell=UnitCell(0.2, 0.7)))
    assert not len(x.ceded)
    assert shapely.area(shapely.union_all(shapely.box(*y.ceded.T))) == pytest.approx(0.5)


def test_toothed_walls_with_unequal_courses_are_an_error():
    with pytest.raises(InputError, match=r"the courses of toothed walls do not line up; found courses of 0\.25 and 0\.2 m"):
        junctions(along_x(), along_y(cell=UnitCell(0.2, 0.7)))


def test_what_a_wall_fills_of_one_junction_says_nothing_of_another_one_above_it():
    # Two walls lie on each other along x. Of the junction with the lower one y fills the two lowest courses, as drawn.
    y = replace(along_y(height=2.0), filled=np.array([[0.0, 0.0, 0.5, 0.5]]))
    below = along_x()
    above = replace(below, name="above", outline=below.outline + np.array([0.0, 1.0]))
    first, second, _ = junctions(below, above, y)
    assert owned(first, (0.0, 0.5)) == [0.0, 0.25]
    assert owned(second, (0.0, 0.5)) == [1.25, 1.75]


def test_walls_filled_elsewhere_are_still_refused_where_their_courses_do_not_line_up():
    y = replace(along_y(cell=UnitCell(0.2, 0.7)), filled=np.array([[3.0, 0.0, 3.5, 0.5]]))
    with pytest.raises(InputError, match="the courses of toothed walls do not line up"):
        junctions(along_x(), y)


def test_walls_that_cross_at_a_slant_are_an_error():
    slant = wall("s", (2.0, -1.0), (0.6, 0.8), 4.0, parity=1)
    with pytest.raises(InputError, match=r"do not cross squarely, .*; found walls at 53\.13 degrees.* Draw them at right angles"):
        junctions(along_x(), slant)


def test_an_outline_that_stops_within_the_other_wall_is_an_error():
    with pytest.raises(InputError, match=r"do not cross squarely.*Extend the outline to the far face"):
        junctions(along_x(), along_y(left=2.0, start=0.25))


def test_walls_that_miss_each_other_as_rounded_ones_do_are_told_so():
    slant = wall("s", (2.0, -1.0), (np.sin(0.002), np.cos(0.002)), 4.0, parity=1)
    rounded = "Export the drawing with more digits, or with its walls along x and y. If nothing was rounded: "
    for other, by, else_ in ((along_y(left=2.0, start=0.002), "2", "Extend the outline"), (slant, "1", "Draw them at right")):
        with pytest.raises(InputError, match=rf"m2 in plan whose corners miss faces by {by} mm, as those of rounded") as error:
            junctions(along_x(), other)
        assert error.value.remedy.startswith(rounded + else_)
    # What is off by more was drawn so.
    with pytest.raises(InputError) as error:
        junctions(along_x(), along_y(left=2.0, start=0.02))
    assert "rounded" not in str(error.value)


def test_walls_that_touch_have_no_junction():
    x, y = junctions(along_x(), along_y(left=2.0, start=0.5))
    assert not len(x.zones)
    assert not len(y.ceded)


def test_slopes_of_both_walls_in_one_junction_are_an_error():
    slope = np.array([[0, 0], [5, 0], [5, 1.0], [0, 2.0]], dtype=float)
    x, y = along_x(), along_y(left=2.0)
    x, y = replace(x, outline=slope), replace(y, outline=np.array([[0, 0], [4, 0], [4, 1], [0, 1.6]], dtype=float))
    with pytest.raises(InputError, match="neither wall fills it"):
        junctions(x, y)
