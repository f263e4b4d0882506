"""Tiles cover their region exactly once, whatever the bond, the openings and the slope of the top."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from churchpipe.bond.field import Field
from churchpipe.bond.running import RunningBond
from churchpipe.bond.stack import StackBond
from churchpipe.bond.tiles import TileSet
from churchpipe.errors import InputError
from churchpipe.geometry.planar import less, polygon
from churchpipe.model.building import UnitCell

CELL = UnitCell(a=0.275, b=0.57)
LENGTHS = st.floats(0.5, 7.0)
OFFSETS = st.floats(-1.0, 1.0)
RULES = st.sampled_from(["grid", "bay"])


def rectangle(s0, t0, s1, t1):
    return np.array([[s0, t0], [s1, t0], [s1, t1], [s0, t1]], dtype=float)


def assert_tiling(tiles: TileSet, region, cell: UnitCell) -> None:
    polygons = tiles.polygons
    assert shapely.is_valid(polygons).all()
    assert tiles.area.min() > 0
    assert tiles.area.sum() == pytest.approx(region.area, rel=1e-12)
    first, second = shapely.STRtree(polygons).query(polygons, predicate="intersects")
    pair = first < second
    overlap = shapely.area(shapely.intersection(polygons[first[pair]], polygons[second[pair]]))
    assert overlap.max(initial=0.0) < 1e-12 * cell.a * cell.b
    assert shapely.area(shapely.difference(shapely.union_all(polygons), region)) < 1e-12 * region.area


def assert_no_slivers(tiles: TileSet, cell: UnitCell) -> None:
    low_s, low_t, high_s, high_t = shapely.bounds(tiles.polygons).T
    assert (high_s - low_s).min() >= cell.b / 4 - 2e-9
    assert (high_t - low_t).min() >= 0.3 * cell.a - 2e-9
    alone = np.bincount(tiles.course)[tiles.course] == 1
    assert tiles.area[~alone].min(initial=1.0) >= (0.3 - 1e-6) * cell.a * cell.b


@settings(deadline=None)
@given(length=LENGTHS, courses=st.integers(1, 8), rule=RULES, through=OFFSETS, cut=OFFSETS)
def test_running_bond_covers_a_wall(length, courses, rule, through, cut):
    wall = polygon(rectangle(0, 0, length, courses * CELL.a))
    tiles = RunningBond(CELL, rule, through, cut).tiles(Field("wall", wall, (0.0, length)))
    assert_tiling(tiles, wall, CELL)
    assert_no_slivers(tiles, CELL)


@settings(deadline=None)
@given(length=LENGTHS, courses=st.integers(1, 8), rule=RULES, offset=OFFSETS)
def test_stack_bond_covers_a_wall(length, courses, rule, offset):
    wall = polygon(rectangle(0, 0, length, courses * CELL.a))
    tiles = StackBond(CELL, rule, offset).tiles(Field("wall", wall, (0.0, length)))
    assert_tiling(tiles, wall, CELL)
    assert_no_slivers(tiles, CELL)
    for course in range(1, courses):
        joints = [np.unique(np.round(shapely.bounds(tiles.polygons[tiles.course == c])[:, 0], 9)) for c in (0, course)]
        np.testing.assert_array_equal(*joints)


@pytest.mark.slow
@settings(deadline=None)
@given(
    left=st.floats(0.6, 3.0),
    right=st.floats(0.6, 3.0),
    width=st.floats(0.6, 2.0),
    sill=st.just(0.0) | st.floats(0.001, 1.5),
    height=st.floats(0.3, 1.5),
    rise=st.floats(0.5, 3.0),
    rule=RULES,
)
def test_openings_and_gables_leave_no_gap_and_no_sliver(left, right, width, sill, height, rise, rule):
    length, eaves = left + width + right, 12 * CELL.a
    gable = [[0, 0], [length, 0], [length, eaves], [length / 2, eaves + rise], [0, eaves]]
    wall = less(polygon(gable), [polygon(rectangle(left, sill, left + width, sill + height))])
    tiles = RunningBond(CELL, rule, 0.0, CELL.b / 2).tiles(Field("gable", wall, (0.0, length)))
    assert_tiling(tiles, wall, CELL)
    assert_no_slivers(tiles, CELL)


@pytest.mark.parametrize("shift", [0.0, 1e-10, -1e-10])
def test_joints_within_rounding_of_an_opening_fall_on_it(shift):
    wall = less(polygon(rectangle(0, 0, 4 * 0.08, 0.06)), [polygon(rectangle(0.08 * 3 + shift, 0, 0.3, 0.03))])
    tiles = RunningBond(UnitCell(0.03, 0.08), "grid", 0.0, 0.04).tiles(Field("wall", wall, (0.0, 0.32)))
    s = np.unique(tiles.corner[:, 0])
    assert np.diff(s).min() > 0.01
    assert tiles.count == 3 + 1 + 5


def test_corners_are_lean_and_counter_clockwise():
    wall = less(polygon(rectangle(0, 0, 0.4, 0.06)), [polygon(rectangle(0.1, 0.0, 0.2, 0.02))])
    tiles = RunningBond(UnitCell(0.03, 0.08), "grid", 0.0, 0.04).tiles(Field("wall", wall, (0.0, 0.4)))
    assert (tiles.area > 0).all()
    for i in range(tiles.count):
        ring = tiles.corner[tiles.corner_ptr[i] : tiles.corner_ptr[i + 1]]
        before, after = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
        assert (np.abs(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]) > 1e-6).all()


def test_an_opening_inside_one_stone_is_an_error():
    wall = less(polygon(rectangle(0, 0, 0.4, 0.03)), [polygon(rectangle(0.02, 0.01, 0.06, 0.02))])
    with pytest.raises(InputError, match="an opening lies inside one stone; found near 0 m along the wall and 0 m up"):
        RunningBond(UnitCell(0.03, 0.08), "grid", 0.0, 0.04).tiles(Field("wall", wall, (0.0, 0.4)))


def test_masonry_below_the_first_course_is_an_error():
    wall = polygon(rectangle(0, -0.03, 0.4, 0.03))
    with pytest.raises(InputError, match="below the first course"):
        RunningBond(UnitCell(0.03, 0.08), "grid", 0.0, 0.04).tiles(Field("wall", wall, (0.0, 0.4)))


def test_bed_joints_are_level():
    points = np.array([[0.0, 0.0], [1.0, 2.0]])
    for bond in (RunningBond(CELL, "grid", 0.0, 0.285), StackBond(CELL, "grid", 0.0)):
        np.testing.assert_array_equal(bond.bed_direction(points), [[1.0, 0.0], [1.0, 0.0]])
        assert bond.cell is CELL
