"""The [sample] of a case: parameters with a distribution, and the points that are drawn of them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal, get_args

import numpy as np
from pydantic import BeforeValidator, Field

from churchpipe.config.tables import listed as listed_keys
from churchpipe.errors import InputError
from churchpipe.model.arguments import finite, listed, one_of, text, whole
from churchpipe.model.arrays import FloatArray, store
from churchpipe.model.quantities import MOST_COUNTED, Quantity

Method = Literal["sobol", "latin-hypercube"]
Kind = Literal["normal", "lognormal", "uniform", "beta"]
_Keys = Annotated[
    tuple[str, ...],
    Field(min_length=1),
    BeforeValidator(listed_keys, json_schema_input_type=list[str] | str),
    "Dotted key of the case, or several that have one value.",
]
# Fewer lie between the bounds of a distribution than this share: they are a mistake.
_LEAST = 1e-3
# Samples of one Latin hypercube; the next ones are another hypercube, so that a longer sequence begins with the shorter one.
HYPERCUBE = 20
# Where it is looked whether values differ, and by which share they have to.
_QUANTILE, _DIFFER = 1e-3, 1e-9
# Nearer to the ends of a distribution than this nothing is drawn.
_END = 1e-12
_NEEDED: dict[Kind, tuple[str, ...]] = {
    "normal": ("mean", "standard_deviation"),
    "lognormal": ("mean", "standard_deviation"),
    "uniform": ("low", "high"),
    "beta": ("mean", "standard_deviation", "low", "high"),
}


@dataclass(frozen=True, slots=True)
class SampledParameter:
    """A parameter that is not known exactly. Its numbers are in the unit of its key.

    Raises
    ------
    InputError: no key, numbers that the distribution needs or has not, or that contradict each other.
    """

    key: _Keys
    distribution: Annotated[Kind, "How its values are distributed."]
    mean: Annotated[float | None, Quantity(), "Of the values, before they are cut off; not of a uniform distribution."] = None
    standard_deviation: Annotated[
        float | None, Quantity(), "Likewise; of a lognormal one of the values too, not of their logarithms."
    ] = None
    low: Annotated[float | None, Quantity(), "No value is below; a normal or lognormal distribution may do without."] = None
    high: Annotated[float | None, Quantity(), "No value is above."] = None

    def __post_init__(self) -> None:
        store(self, key=tuple(text("parameter: key", key) for key in listed("parameter: key", self.key, str)))
        if not self.key:
            raise InputError("parameter: key", "nothing varies", expected="a key of the case, or several")
        one_of("parameter: distribution", self.distribution, *get_args(Kind))
        for name in ("mean", "standard_deviation", "low", "high"):
            if getattr(self, name) is not None:
                finite(f"parameter: {name}", getattr(self, name))
        for name in _NEEDED[self.distribution]:
            if getattr(self, name) is None:
                raise InputError(f"parameter: {name}", "missing", expected=f"a number, for a {self.distribution} distribution")
        if self.distribution == "uniform":
            for name in ("mean", "standard_deviation"):
                if getattr(self, name) is not None:
                    raise InputError(f"parameter: {name}", "not of a uniform distribution", expected="low and high alone")
        low, high = self.bounds
        if not low < high:
            raise InputError("parameter: high", "out of range", found=high, expected=f"> {low:g}, the lowest value")
        if self.distribution in ("uniform", "beta") and math.isinf(high - low):
            raise InputError("parameter: high", "too far from low", found=high, expected="bounds whose distance is a number")
        if self.standard_deviation is not None and not self.standard_deviation > 0:
            raise InputError("parameter: standard_deviation", "out of range", found=self.standard_deviation, expected="> 0")
        if self.mean is None or self.standard_deviation is None:
            return
        if self.distribution == "lognormal" and not self.mean > 0:
            raise InputError("parameter: mean", "out of range", found=self.mean, expected="> 0, for a lognormal distribution")
        if self.distribution == "beta":
            if not low < self.mean < high:
                raise InputError("parameter: mean", "out of range", found=self.mean, expected=f"between {low:g} and {high:g}")
            widest = math.sqrt((self.mean - low) * (high - self.mean))
            if not self.standard_deviation < widest:
                found, expected = self.standard_deviation, f"< {widest:g}, with this mean and these bounds"
                raise InputError(
                    "parameter: standard_deviation", "too wide for a beta distribution", found=found, expected=expected
                )
        if not _can_be_drawn(self):
            size, found = "small" if self.standard_deviation < abs(self.mean) else "large", f"{self.standard_deviation:g}"
            expected = "values that differ from each other in nine digits"
            raise InputError("parameter: standard_deviation", f"too {size} for its mean", found=found, expected=expected)
        if self.distribution == "beta":
            return
        below, above = _shape(self).cdf([low, high])
        if above - below < _LEAST:
            field = "low" if self.low is not None and self.low > self.mean else "high"
            found = f"{above - below:.2g} of the distribution lies within"
            raise InputError(f"parameter: {field}", "leaves next to nothing", found=found, expected=f"at least {_LEAST:g}")

    @property
    def bounds(self) -> tuple[float, float]:
        """The lowest and the highest value."""
        return -math.inf if self.low is None else self.low, math.inf if self.high is None else self.high


@dataclass(frozen=True, slots=True)
class SampleSettings:
    """Parameters that are not known exactly: the case is analysed at many of their values, drawn at random."""

    number: Annotated[int, Quantity("", 1, high=10_000), "Samples. More of them later add to those that there are."]
    parameters: Annotated[tuple[SampledParameter, ...], Field(min_length=1), "What varies, each independent of the others."]
    seed: Annotated[int, Quantity("", 0), "Another one draws other values."] = 0
    method: Annotated[Method, "Quasi-random points, which fill their space evenly, or Latin hypercubes of 20 samples each."] = (
        "sobol"
    )
    demands: Annotated[
        tuple[Annotated[float, Quantity("", 0.0, above=True)], ...],
        "Load factors asked of the building: how probable is it that it bears less?",
    ] = ()

    def __post_init__(self) -> None:
        keys = [key for parameter in self.parameters for key in parameter.key]
        for key in keys:
            if keys.count(key) > 1:
                raise InputError("sample: parameters", "two distributions for one key", found=key, expected="one a key")


def quantile(parameter: SampledParameter, level: FloatArray) -> FloatArray:
    """Return the values (n,) that are not exceeded with probabilities (n,)."""
    shape = _shape(parameter)
    below, above = shape.cdf(parameter.bounds)
    return np.clip(shape.ppf(below + level * (above - below)), *parameter.bounds)


def sample_points(parameters: Sequence[SampledParameter], number: int, *, seed: int = 0, method: Method = "sobol") -> FloatArray:
    """Return values (number, np) of parameters, in the units of their keys; those of a larger number begin with them.

    Parameters
    ----------
    parameters
        What varies, np parameters, each independent of the others.
    number
        Samples.
    seed
        Another one draws other values.
    method
        "sobol", a scrambled Sobol sequence, or "latin-hypercube", one hypercube of 20 samples after the other.

    Raises
    ------
    InputError: nothing that varies, arguments of the wrong kind or out of range.
    """
    from scipy.stats import qmc

    parameters = listed("sample_points: parameters", parameters, SampledParameter)
    if not parameters:
        raise InputError("sample_points: parameters", "nothing varies", expected="one SampledParameter or more")
    number = whole("sample_points: number", number, least=1, most=MOST_COUNTED)
    seed = whole("sample_points: seed", seed, least=0)
    one_of("sample_points: method", method, *get_args(Method))
    if method == "sobol":
        sequence = qmc.Sobol(len(parameters), rng=np.random.default_rng(seed))
        levels = sequence.random_base2(max(number - 1, 1).bit_length())
    else:
        blocks = range(-(-number // HYPERCUBE))
        cubes = [qmc.LatinHypercube(len(parameters), rng=np.random.default_rng([seed, block])) for block in blocks]
        levels = np.concatenate([cube.random(HYPERCUBE) for cube in cubes])
    levels = np.clip(levels[:number], _END, 1 - _END)
    return np.column_stack([quantile(parameter, level) for parameter, level in zip(parameters, levels.T, strict=True)])


def _can_be_drawn(parameter: SampledParameter) -> bool:
    """Return whether the values of a parameter, without what cuts them off, are numbers that differ."""
    with np.errstate(all="ignore"):
        try:
            low, high = _shape(parameter).ppf([_QUANTILE, 1 - _QUANTILE])
        except OverflowError:
            return False
        return bool(np.isfinite(high - low) and high - low > _DIFFER * max(abs(low), abs(high)))


def _shape(parameter: SampledParameter) -> Any:
    """Return the distribution without its bounds, as scipy has it."""
    # Loading it takes longer than reading a case.
    from scipy import stats

    (low, high), mean, deviation = parameter.bounds, parameter.mean, parameter.standard_deviation
    if mean is None or deviation is None:
        return stats.uniform(low, high - low)
    if parameter.distribution == "normal":
        return stats.norm(mean, deviation)
    if parameter.distribution == "lognormal":
        spread = 1 + (deviation / mean) ** 2
        return stats.lognorm(math.sqrt(math.log(spread)), scale=mean / math.sqrt(spread))
    share = (mean - low) / (high - low)
    strength = share * (1 - share) * ((high - low) / deviation) ** 2 - 1
    return stats.beta(share * strength, (1 - share) * strength, loc=low, scale=high - low)
