"""From the load factors of many samples to what is known of a building whose parameters are not known exactly."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arguments import finite
from churchpipe.model.arrays import FloatArray, floats

LEVELS = (0.05, 0.16, 0.5, 0.84, 0.95)
# Of the band about an estimated probability.
CONFIDENCE = 0.9
# Load factors that differ less than this share of the largest are of one rank: solvers certify no more.
_ALIKE = 1e-5


@dataclass(frozen=True, slots=True, eq=False)
class Uncertainty:
    """Load factors of samples, and what they say.

    capacity: (n,) ascending; infinite where no load is too large, 0 where the structure does not bear its own weight.
    unknown: samples without a load factor, which are left out of all figures.
    mean, standard_deviation: of the load factors, NaN where there are none; one alone has no standard deviation. quantiles: by
        level.
    median, dispersion: of the lognormal fragility curve, exp of the mean and the standard deviation of the logarithms of the load
        factors above 0; NaN where there are none, and the dispersion where there is but one.
    rank_correlation: (np,) of Spearman, of each parameter with the load factor; NaN where one of both does not vary.
    explained: share of the variance of the ranks that a linear combination of the parameters' ranks accounts for; below some 0.7
        parameters act together, or not in one direction only.
    """

    capacity: FloatArray
    unknown: int
    mean: float
    standard_deviation: float
    quantiles: dict[float, float]
    median: float
    dispersion: float
    rank_correlation: FloatArray
    explained: float

    @property
    def count(self) -> int:
        """Samples with a load factor."""
        return len(self.capacity)

    def probability(self, demand: float) -> tuple[float, float, float]:
        """Return the probability that a structure bears less than a demand, and the limits of its band: see `band`.

        Raises
        ------
        InputError: a demand that is no finite number.
        """
        demand = finite("probability: demand", demand)
        below = int(np.searchsorted(self.capacity, demand, side="left"))
        low, high = band(np.array([below]), self.count)
        return below / self.count if self.count else np.nan, float(low[0]), float(high[0])


def band(below: Any, count: int) -> tuple[FloatArray, FloatArray]:
    """Return the limits (n,) of probabilities that `below` (n,) of `count` samples estimate, each with 5 % beyond it.

    Clopper and Pearson (1934): exact for independent samples; those of Sobol or a Latin hypercube spread less.
    """
    from scipy.stats import beta

    tail = (1 - CONFIDENCE) / 2
    below = np.asarray(below, dtype=float)
    low = np.where(below > 0, beta.ppf(tail, np.maximum(below, 0.5), count - below + 1), 0.0)
    high = np.where(below < count, beta.ppf(1 - tail, below + 1, np.maximum(count - below, 0.5)), 1.0)
    return low, high


def assess_uncertainty(points: FloatArray, load_factors: FloatArray) -> Uncertainty:
    """Return what the load factors of samples say.

    Parameters
    ----------
    points
        Values (n, np) of the parameters of each sample, such as `sample_points` gives.
    load_factors
        Those of the samples (n,): NaN where there is no result, 0 where the weight is not borne.

    Raises
    ------
    InputError: not as many load factors as points, points that are not finite numbers, load factors below 0.
    """
    points = floats("assess_uncertainty: points", points, (None, None))
    factors = floats("assess_uncertainty: load_factors", load_factors, (None,), finite=False)
    if len(factors) != len(points):
        found, expected = f"{factors.shape} and {points.shape}", "as many as points (n, np)"
        raise InputError("assess_uncertainty: load_factors", "wrong shape", found=found, expected=expected)
    if (factors < 0).any():
        found = f"{factors[factors < 0][0]:g}"
        raise InputError("assess_uncertainty: load_factors", "out of range", found=found, expected="numbers >= 0, or NaN")
    known = ~np.isnan(factors)
    points, factors = points[known], factors[known]
    unlimited = np.isinf(factors).any()
    spread = np.nan if unlimited or len(factors) < 2 else 0.0 if np.ptp(factors) == 0 else float(factors.std(ddof=1))
    logarithms = np.log(factors[(factors > 0) & np.isfinite(factors)])
    correlation, explained = _ranks(points, factors)
    quantiles = np.quantile(factors, LEVELS, method="inverted_cdf" if unlimited else "linear") if len(factors) else [np.nan] * 5
    return Uncertainty(
        np.sort(factors),
        int((~known).sum()),
        float(factors.mean()) if len(factors) else np.nan,
        spread,
        dict(zip(LEVELS, map(float, quantiles), strict=True)),
        float(np.exp(logarithms.mean())) if len(logarithms) else np.nan,
        float(logarithms.std(ddof=1)) if len(logarithms) > 1 else np.nan,
        correlation,
        explained,
    )


def _ranks(points: FloatArray, factors: FloatArray) -> tuple[FloatArray, float]:
    """Return Spearman's correlation (np,) of each parameter, and the share of the ranks' variance that all of them explain."""
    from scipy.stats import rankdata

    size = np.abs(factors[np.isfinite(factors)]).max(initial=0.0) or 1.0
    rounded = np.round(factors / (size * _ALIKE))
    ranks = (
        np.column_stack([rankdata(column) for column in (*points.T, rounded)])
        if len(factors)
        else np.empty((0, points.shape[1] + 1))
    )
    ranks = ranks - ranks.mean(axis=0) if len(ranks) else ranks
    own, answer = ranks[:, :-1], ranks[:, -1]
    length = np.linalg.norm(own, axis=0) * np.linalg.norm(answer)
    correlation = np.full(points.shape[1], np.nan)
    np.divide(answer @ own, length, out=correlation, where=length > 0)
    total = float(answer @ answer)
    if total == 0 or len(factors) <= points.shape[1] + 1:
        return correlation, np.nan
    rest = answer - own @ np.linalg.lstsq(own, answer, rcond=None)[0]
    return correlation, 1 - float(rest @ rest) / total
