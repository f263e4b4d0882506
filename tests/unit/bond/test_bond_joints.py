"""The joint rules "grid" and "bay"."""

import numpy as np
import pytest

from churchpipe.bond.field import Field
from churchpipe.bond.joints import bay_joints, grid_joints
from churchpipe.geometry.planar import polygon

B = 0.57
# A wall 6.5 m long with corners .9 m thick at both ends, as the facade of the sample church: one bay of 4.7 m.
ZONES = np.array([[0.0, 0.9], [5.6, 6.5]])


def field(length, zones=(), lost=()):
    outline = np.array([[0, 0], [length, 0], [length, 1], [0, 1]], dtype=float)
    return Field("wall", polygon(outline), (0.0, length), 0, np.reshape(zones, (-1, 2)), np.reshape(lost, (-1, 4)))


def test_grid_joints_count_from_the_zero_of_s():
    np.testing.assert_allclose(grid_joints(field(0.32), 0.08, 0.04), [0.04, 0.12, 0.20, 0.28], rtol=1e-12)
    np.testing.assert_allclose(grid_joints(field(0.32), 0.08, 0.0), 0.08 * np.arange(5), atol=1e-15)
    np.testing.assert_allclose(grid_joints(field(0.32), 0.08, 0.20), [0.04, 0.12, 0.20, 0.28], rtol=1e-12)


def test_cut_courses_divide_the_clear_bay_into_whole_stones():
    lost = [[s0, 0, s1, 1] for s0, s1 in ZONES]
    joints = np.unique(np.round(bay_joints(field(6.5, ZONES, lost), B, False, 0.5), 12))
    np.testing.assert_allclose(joints, 0.9 + 4.7 / 8 * np.arange(9), atol=1e-9)


def test_through_courses_are_half_a_stone_off_and_divide_the_stretch_over_the_corner():
    joints = np.unique(np.round(bay_joints(field(6.5, ZONES), B, True, 0.5), 12))
    pitch = 4.7 / 8
    inside = 0.9 + pitch * (np.arange(8) + 0.5)
    # The stretch 0 .. .9 + b'/2 = 1.194 m takes two stones.
    expected = np.concatenate([[0.0, inside[0] / 2], inside, [(inside[-1] + 6.5) / 2, 6.5]])
    np.testing.assert_allclose(joints, expected, atol=1e-9)


def test_no_straight_joint_at_the_returns():
    lost = [[s0, 0, s1, 1] for s0, s1 in ZONES]
    cut = bay_joints(field(6.5, ZONES, lost), B, False, 0.5)
    through = bay_joints(field(6.5, ZONES), B, True, 0.5)
    assert np.abs(cut[:, None] - through[None, :]).min() > 0.25 * B


def test_free_ends_get_half_stones():
    # A T-wall: free at s = 0, a zone at the far end.
    zone = [[4.0, 4.9]]
    through = np.sort(bay_joints(field(4.9, zone), B, True, 0.5))
    assert through[0] == pytest.approx(4.0 / 7 / 2)
    cut = np.sort(bay_joints(field(4.9, zone, [[4.0, 0, 4.9, 1]]), B, False, 0.5))
    np.testing.assert_allclose(cut, 4.0 / 7 * np.arange(8), atol=1e-12)


def test_a_zone_that_another_wall_owns_on_a_through_course_gets_no_joints():
    lost = [[4.0, 0, 4.9, 1]]
    joints = bay_joints(field(8.9, [[4.0, 4.9]], lost), B, True, 0.5)
    assert not ((joints > 4.0 - 4.0 / 14 + 1e-9) & (joints < 4.9 + 4.0 / 14 - 1e-9)).any()


def test_a_zone_owned_on_a_cut_course_is_divided_by_itself():
    joints = np.unique(np.round(bay_joints(field(8.9, [[4.0, 4.9]]), B, False, 0.5), 12))
    assert {4.0, 4.45, 4.9} <= set(joints.tolist())


def test_a_junction_takes_a_stone_for_each_begun_length():
    # A wall 1.4 m thick crossing: three stones of .57 m over 1.4 + b', two over .9 + b'.
    for thickness, stones in ((0.9, 2), (1.4, 3), (0.57, 1)):
        joints = np.sort(bay_joints(field(8.0 + thickness, [[4.0, 4.0 + thickness]]), B, True, 0.5))
        inside = joints[(joints > 4.0 - 2 / 7 + 1e-9) & (joints < 4.0 + thickness + 2 / 7 - 1e-9)]
        assert len(inside) == stones - 1


def test_a_wall_that_ends_at_a_junction_is_divided_up_to_there():
    # Above the roof, at t > .5, the wall is 4.9 m long; below it goes on to 8.9 m.
    outline = polygon([[0, 0], [8.9, 0], [8.9, 0.5], [4.9, 0.5], [4.9, 1], [0, 1]])
    tower = Field("wall", outline, (0.0, 8.9), 0, np.array([[4.0, 4.9]]))
    low, high = (np.unique(np.round(bay_joints(tower, B, True, t), 9)) for t in (0.25, 0.75))
    before = 4.0 - 2 / 7
    np.testing.assert_allclose(high[(high > before - 1e-6) & (high < 4.9 + 1e-6)], np.linspace(before, 4.9, 3), atol=1e-9)
    np.testing.assert_allclose(
        low[(low > before - 1e-6) & (low < 4.9 + 2 / 7 + 1e-6)], np.linspace(before, 4.9 + 2 / 7, 3), atol=1e-9
    )


def test_half_a_stone_rounds_up():
    # 520 mm take 6.5 bricks of 80 mm: seven shorter ones, as 7.5 would take eight.
    for length, count in ((0.52, 7), (0.60, 8)):
        assert len(bay_joints(field(length), 0.08, False, 0.5)) == count + 1
