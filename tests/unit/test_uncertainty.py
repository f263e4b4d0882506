"""Statistics of sampled load factors, against closed forms."""

from typing import Any

import numpy as np
import pytest
from scipy import stats

import churchpipe as cp
from churchpipe.uncertainty import assess_uncertainty


def test_a_block_of_uncertain_width_overturns_at_width_over_height() -> None:
    """A block of width b and height h overturns at b / h: a normal b of mean 0.5 m gives a normal load factor."""
    height = 2.0
    width = cp.SampledParameter(("width",), "normal", mean=0.5, standard_deviation=0.05)
    points = cp.sample_points([width], 256, seed=1)
    found = cp.assess_uncertainty(points, points[:, 0] / height)
    exact = stats.norm(0.25, 0.025)
    assert (found.mean, found.standard_deviation) == pytest.approx((0.25, 0.025), rel=0.01)
    for level, value in found.quantiles.items():
        assert value == pytest.approx(exact.ppf(level), rel=0.01)
    assert found.rank_correlation == pytest.approx([1.0])
    for demand in (0.22, 0.25, 0.27):
        probability, low, high = found.probability(demand)
        assert probability == pytest.approx(exact.cdf(demand), abs=0.01)
        assert low < probability < high
    # The lognormal curve has the median and the dispersion of the logarithms: ln(1 + 0.1^2) for so small a spread.
    assert found.median == pytest.approx(0.25, rel=0.01)
    assert found.dispersion == pytest.approx(0.1, rel=0.03)


def test_the_signs_and_sizes_of_correlations_say_what_matters() -> None:
    parameters = [cp.SampledParameter((name,), "uniform", low=1.0, high=2.0) for name in ("up", "down", "idle")]
    points = cp.sample_points(parameters, 128)
    found = assess_uncertainty(points, points[:, 0] ** 3 / points[:, 1])
    up, down, idle = found.rank_correlation
    assert up > 0.8
    assert -0.6 < down < -0.2
    assert abs(idle) < 0.1
    assert found.explained > 0.95
    # Nothing that only rises or only falls explains this one.
    folded = assess_uncertainty(points, np.abs(points[:, 2] - 1.5))
    assert np.abs(folded.rank_correlation).max() < 0.2
    assert folded.explained < 0.2


def test_what_has_no_load_factor_is_told_apart() -> None:
    points = np.linspace(0, 1, 10)[:, None]
    capacity = np.array([0.0, 0.0, 0.1, 0.2, 0.3, 0.4, np.nan, np.inf, 0.5, 0.6])
    found = assess_uncertainty(points, capacity)
    # Of ten, one has no result; two fall under their own weight, and one has no limit.
    assert (found.count, found.unknown) == (9, 1)
    assert found.probability(0.25)[0] == pytest.approx(4 / 9)
    assert found.quantiles[0.5] == pytest.approx(0.3)
    assert found.mean == np.inf
    assert np.isnan(assess_uncertainty(points, np.full(10, np.nan)).standard_deviation)
    with pytest.raises(cp.InputError, match="as many"):
        assess_uncertainty(points, capacity[:-1])


def test_a_value_that_never_changes_has_no_rank() -> None:
    points = np.column_stack([np.arange(8.0), np.ones(8)])
    found = assess_uncertainty(points, np.full(8, 0.3))
    assert np.isnan(found.rank_correlation).all()
    assert found.probability(0.3)[0] == 0.0
    assert found.probability(0.31)[0] == 1.0
    assert found.dispersion == 0.0


def test_one_sample_says_nothing_of_the_spread() -> None:
    found = assess_uncertainty(np.array([[0.5]]), np.array([0.4]))
    assert (found.mean, found.median) == pytest.approx((0.4, 0.4))
    assert np.isnan([found.standard_deviation, found.dispersion]).all()


@pytest.mark.parametrize("demand", [np.nan, "0.4", None, True])
def test_a_demand_is_a_number(demand: Any) -> None:
    known = assess_uncertainty(np.array([[0.5], [0.6]]), np.array([0.4, 0.5]))
    with pytest.raises(cp.InputError, match="probability: demand"):
        known.probability(demand)


@pytest.mark.parametrize("factor", [-0.1, -np.inf])
def test_load_factors_are_not_negative(factor: float) -> None:
    with pytest.raises(cp.InputError, match="load_factors: out of range; found -"):
        assess_uncertainty(np.array([[0.5], [0.6]]), np.array([0.4, factor]))
