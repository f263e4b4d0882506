"""From which height to which one the zones of a wall hold."""

import numpy as np

from churchpipe.bond.zones import bands_of, merged


def test_intervals_that_overlap_or_touch_are_one() -> None:
    np.testing.assert_allclose(merged(np.array([[2.0, 3.0], [0.0, 0.5], [0.4, 1.0], [3.0, 3.5]])), [[0.0, 1.0], [2.0, 3.5]])
    assert merged([]).shape == (0, 2)


def test_one_band_where_no_wall_gets_thinner() -> None:
    # A wall beside a lower one, and one that begins above another of the same faces.
    crossed = np.array([[0.0, 0.0, 0.5, 6.0], [4.0, 0.0, 4.4, 3.0], [4.0, 3.0, 4.4, 6.0]])
    (band,) = bands_of(crossed)
    assert (band.low, band.high) == (-np.inf, np.inf)
    np.testing.assert_allclose(band.zones, [[0.0, 0.5], [4.0, 4.4]])
    (bare,) = bands_of(np.empty((0, 4)))
    assert bare.zones.shape == (0, 2)


def test_faces_move_where_a_wall_gets_thinner() -> None:
    # The lower part of the second wall ends at 3 m, and its upper part at 5 m holds above, too.
    crossed = np.array([[0.0, 0.0, 0.5, 6.0], [4.0, 0.0, 4.6, 3.0], [4.0, 3.0, 4.4, 5.0]])
    below, above = bands_of(crossed)
    assert (below.low, below.high, above.low, above.high) == (-np.inf, 3.0, 3.0, np.inf)
    np.testing.assert_allclose(below.zones, [[0.0, 0.5], [4.0, 4.6]])
    np.testing.assert_allclose(above.zones, [[0.0, 0.5], [4.0, 4.4]])


def test_walls_side_by_side_at_one_height_are_one_zone() -> None:
    (band,) = bands_of(np.array([[0.0, 0.0, 0.5, 6.0], [0.3, 2.0, 0.9, 5.0]]))
    np.testing.assert_allclose(band.zones, [[0.0, 0.9]])
