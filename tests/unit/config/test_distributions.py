"""[sample]: the distributions against the quantiles of scipy, and the points of a sequence that grows."""

from typing import Any

import numpy as np
import pytest
from scipy import stats

from churchpipe.config.distributions import Method, SampledParameter, quantile, sample_points
from churchpipe.errors import InputError

LEVELS = np.array([0.001, 0.05, 0.5, 0.84, 0.999])
FRICTION = SampledParameter(("friction",), "normal", mean=0.6, standard_deviation=0.05)


def test_the_quantiles_are_those_of_scipy() -> None:
    found = quantile(FRICTION, LEVELS)
    assert found == pytest.approx(stats.norm(0.6, 0.05).ppf(LEVELS))
    found = quantile(SampledParameter(("x",), "uniform", low=2.0, high=5.0), LEVELS)
    assert found == pytest.approx(stats.uniform(2, 3).ppf(LEVELS))
    # Mean and standard deviation are those of the values, not of their logarithms.
    found = quantile(SampledParameter(("x",), "lognormal", mean=20.0, standard_deviation=4.0), LEVELS)
    log_deviation = np.sqrt(np.log(1 + 0.2**2))
    known = stats.lognorm(log_deviation, scale=20 / np.sqrt(1 + 0.2**2))
    assert (known.mean(), known.std()) == pytest.approx((20, 4))
    assert found == pytest.approx(known.ppf(LEVELS))
    found = quantile(SampledParameter(("x",), "beta", mean=0.6, standard_deviation=0.1, low=0.2, high=0.8), LEVELS)
    # Of mean 2/3 and standard deviation 1/6 on (0, 1): a = m (m (1 - m) / v - 1), b = a (1 - m) / m.
    known = stats.beta(14 / 3, 7 / 3, loc=0.2, scale=0.6)
    assert (known.mean(), known.std()) == pytest.approx((0.6, 0.1))
    assert found == pytest.approx(known.ppf(LEVELS))


def test_bounds_cut_the_tails_off() -> None:
    found = quantile(SampledParameter(("x",), "normal", mean=0.6, standard_deviation=0.2, low=0.5, high=0.9), LEVELS)
    assert found == pytest.approx(stats.truncnorm(-0.5, 1.5, loc=0.6, scale=0.2).ppf(LEVELS))
    one_side = quantile(SampledParameter(("x",), "lognormal", mean=1.0, standard_deviation=0.5, high=1.0), LEVELS)
    assert one_side.max() < 1.0


@pytest.mark.parametrize("method", ["sobol", "latin-hypercube"])
def test_more_samples_begin_with_those_there_were(method: Method) -> None:
    weight = SampledParameter(("weight",), "uniform", low=16.0, high=22.0)
    few, many = (sample_points([FRICTION, weight], count, seed=3, method=method) for count in (37, 150))
    assert many.shape == (150, 2)
    assert np.array_equal(few, many[:37])
    assert not np.array_equal(few, sample_points([FRICTION, weight], 37, seed=4, method=method))
    assert many.mean(axis=0) == pytest.approx([0.6, 19.0], rel=5e-3)
    assert many.std(axis=0) == pytest.approx([0.05, 6 / np.sqrt(12)], rel=0.05)
    assert abs(stats.spearmanr(*many.T).statistic) < 0.1


@pytest.mark.parametrize(
    ("values", "field", "words"),
    [
        ({"distribution": "normal", "mean": 0.6}, "standard_deviation", "missing"),
        ({"distribution": "normal", "mean": 0.6, "standard_deviation": -0.1}, "standard_deviation", "out of range"),
        ({"distribution": "lognormal", "mean": -1.0, "standard_deviation": 0.1}, "mean", "out of range"),
        ({"distribution": "uniform", "low": 2.0}, "high", "missing"),
        ({"distribution": "uniform", "low": 2.0, "high": 1.0}, "high", "out of range"),
        ({"distribution": "uniform", "low": 1.0, "high": 2.0, "mean": 1.5}, "mean", "not of a uniform"),
        ({"distribution": "beta", "low": 0.0, "high": 1.0, "mean": 1.5, "standard_deviation": 0.1}, "mean", "out of range"),
        ({"distribution": "beta", "low": 0.0, "high": 1.0, "mean": 0.5, "standard_deviation": 0.5}, "standard_deviation", "wide"),
        ({"distribution": "normal", "mean": 0.0, "standard_deviation": 1.0, "low": 8.0}, "low", "next to nothing"),
    ],
)
def test_parameters_that_contradict_each_other_are_named(values: dict[str, Any], field: str, words: str) -> None:
    with pytest.raises(InputError, match=words) as caught:
        SampledParameter(("x",), **values)
    assert caught.value.where == f"parameter: {field}"


@pytest.mark.parametrize(
    "numbers",
    [
        {"distribution": "lognormal", "mean": 0.6, "standard_deviation": 1e308},
        {"distribution": "lognormal", "mean": 1e-300, "standard_deviation": 1e10, "low": 0.1, "high": 1.0},
        {"distribution": "lognormal", "mean": 0.6, "standard_deviation": 1e-12},
        {"distribution": "normal", "mean": 0.6, "standard_deviation": 1e-20},
        {"distribution": "normal", "mean": 0.6, "standard_deviation": 1e308},
        {"distribution": "beta", "mean": 0.5, "standard_deviation": 1e-200, "low": 0.1, "high": 0.6},
        {"distribution": "beta", "mean": 0.5, "standard_deviation": 1e-9, "low": 0.1, "high": 0.6},
    ],
)
@pytest.mark.filterwarnings("error")
def test_a_spread_that_numbers_cannot_tell_is_refused(numbers: dict[str, Any]) -> None:
    # The samples would all have one value, or none.
    with pytest.raises(InputError, match=r"parameter: standard_deviation: too (small|large) for its mean; found 1e"):
        SampledParameter(("x",), **numbers)


@pytest.mark.filterwarnings("error")
def test_bounds_whose_distance_is_no_number_are_refused() -> None:
    with pytest.raises(InputError, match=r"parameter: high: too far from low; found 1e[+]308"):
        SampledParameter(("x",), "uniform", low=-1e308, high=1e308)
