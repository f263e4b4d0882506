"""Products of columns in tiles, beside those of numpy."""

import numpy as np
import pytest

from churchpipe.conic.tiles import COLUMNS, padded, subtract_products


@pytest.mark.parametrize("fresh", [True, False])
@pytest.mark.parametrize("length", [1, 2, 7, 16])
@pytest.mark.parametrize(("first", "end"), [(0, 1), (0, 4), (0, 5), (3, 11), (4, 16), (2, 31)])
def test_tiles_subtract_the_products_of_columns(first: int, end: int, length: int, fresh: bool) -> None:
    random = np.random.default_rng(end)
    line, across, j, to = 45, 40, 36, 2
    a, out = random.normal(size=(length, line)), random.normal(size=(to + COLUMNS + 1, across))
    expected = out.copy()
    rows, columns = slice(first, end), slice(to, to + COLUMNS)
    products = a[:, j : j + COLUMNS].T @ a[:, rows]
    expected[columns, rows] = -products if fresh else expected[columns, rows] - products
    subtract_products(a.ravel(), out.ravel(), first, end, j, to, line, length, across, fresh)
    np.testing.assert_allclose(out[columns, rows], expected[columns, rows], rtol=0, atol=1e-13)
    # Nothing else is written but up to three rows beyond the last.
    assert np.array_equal(out[:to], expected[:to])
    assert np.array_equal(out[to + COLUMNS :], expected[to + COLUMNS :])
    assert np.array_equal(out[columns, :first], expected[columns, :first])
    assert np.array_equal(out[columns, end + 3 :], expected[columns, end + 3 :])


def test_whole_tiles_hold_at_least_what_is_asked_for() -> None:
    assert [padded(size) for size in (0, 1, 4, 5, 8)] == [0, 4, 4, 8, 8]
