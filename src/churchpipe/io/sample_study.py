"""The record of what the samples of a case say, declared once: see `churchpipe.uncertainty`."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated, Any, Literal

import numpy as np

from churchpipe.code_check import is_horizontal
from churchpipe.io.records import Analysis
from churchpipe.model.arrays import FloatArray
from churchpipe.model.checks import SafetyCheck
from churchpipe.model.names import ContactModel, Model, Planes
from churchpipe.model.quantities import Quantity
from churchpipe.uncertainty import Uncertainty, assess_uncertainty, band


@dataclass(frozen=True, slots=True)
class Sample:
    """The analyses of a sample, by the names of those of the building as it is; message: why it could not be built, or ""."""

    analyses: tuple[Analysis, ...]
    message: str = ""


@dataclass(frozen=True, slots=True)
class Refused:
    """A sample that could not be built, and why."""

    sample: str
    message: str


@dataclass(frozen=True, slots=True)
class Asked:
    """The probability that a structure bears less than a demand, with the limits of its band."""

    demand: float
    probability: float
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class Fragility:
    """The same as a curve, from below the least to above the greatest capacity."""

    demand: tuple[float, ...]
    probability: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Spread:
    """How samples spread: the figures of an `Uncertainty`, and the probabilities of the demands on it."""

    count: int
    mean: float
    standard_deviation: float
    quantiles: dict[str, float]
    median: float
    dispersion: float
    fragility: Fragility
    demands: tuple[Asked, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class GroundSpread(Spread):
    """How the ground acceleration spreads that the samples withstand."""

    capacity: Annotated[tuple[float, ...], Quantity("_m_s2")]


@dataclass(frozen=True, slots=True)
class Mechanism:
    """One way in which samples fall, by what moves: how many, which share, and their load factors."""

    moves: str
    count: int
    share: float
    mean: float
    low: float
    high: float


@dataclass(frozen=True, slots=True, kw_only=True)
class SampledAnalysis(Spread):
    """An analysis and its samples.

    as_it_is: load factor of the building as it is. load_factors, mechanism_of: of the samples, in their order.
    without_result: how many ended otherwise, by status.
    """

    name: str
    variant: str | None
    model: Model
    flow: str | None = None
    method: str | None = None
    planes: Planes | None = None
    contact_model: ContactModel | None = None
    load: str
    swept: dict[str, Any] = field(default_factory=dict)
    as_it_is: float
    load_factors: tuple[float, ...]
    explained: float
    rank_correlation: dict[str, float]
    without_result: dict[str, int]
    mechanism_of: tuple[str, ...]
    mechanisms: tuple[Mechanism, ...]
    ground_acceleration: GroundSpread | None = None


@dataclass(frozen=True, slots=True)
class SampleStudy:
    """The samples of a case: how they were drawn, the values of each parameter, and what they say of each analysis."""

    number: int
    seed: int
    method: Literal["sobol", "latin-hypercube"]
    parameters: tuple[dict[str, Any], ...]
    points: dict[str, tuple[float, ...]]
    refused: tuple[Refused, ...]
    analyses: tuple[SampledAnalysis, ...]


def sample_study(sample: Mapping[str, Any], made: Mapping[str, Sample], analyses: Sequence[Analysis]) -> SampleStudy:
    """Return what samples say of each analysis.

    Parameters
    ----------
    sample: of the plan, with "settings", "names" and "points".
    made: the samples by their names.
    analyses: of the building as it is.
    """
    settings, names, points = sample["settings"], sample["names"], sample["points"]
    records = {name: {record.name: record for record in made[name].analyses} for name in names}
    place = np.array(list(points.values()), dtype=float).T
    return SampleStudy(
        **{key: settings[key] for key in ("number", "seed", "method")},
        parameters=tuple(settings["parameters"]),
        points={key: tuple(values) for key, values in points.items()},
        refused=tuple(Refused(name, made[name].message) for name in names if made[name].message),
        analyses=tuple(
            _sampled(one, [records[name].get(one.name) for name in names], place, list(points), settings["demands"])
            for one in analyses
        ),
    )


def sampled_records(sample: Mapping[str, Any], made: Mapping[str, Sample]) -> list[Analysis]:
    """Return the records of all samples for a table: with the sample's name and its values before what is swept."""
    drawn = [dict(zip(sample["points"], values, strict=True)) for values in zip(*sample["points"].values(), strict=True)]
    return [
        replace(record, swept={"sample": name, **values, **record.swept})
        for name, values in zip(sample["names"], drawn, strict=True)
        for record in made[name].analyses
    ]


_SAME = ("name", "variant", "model", "flow", "method", "planes", "contact_model", "load", "swept")


def _sampled(
    asis: Analysis, records: Sequence[Analysis | None], points: FloatArray, keys: Sequence[str], demands: Sequence[float]
) -> SampledAnalysis:
    factors = np.array([_capacity(record, record.load_factor if record else np.nan) for record in records])
    known = assess_uncertainty(points, factors)
    lost = [record.status if record else "refused" for record, f in zip(records, factors, strict=True) if np.isnan(f)]
    checks = [record.check if record and record.check else SafetyCheck() for record in records]
    made = [check.a_g for check in checks if check.satisfied is not None]
    ground = None
    # A sample that falls under its own weight has a check whatever the load, and those that stand have none under a load that is
    # no earthquake: the fallen ones would be taken for all.
    if made and is_horizontal(asis.direction):
        # What the code asks may be sampled, too: the question is of what it asks in the case.
        site = asis.check.a_g if asis.check and np.isfinite(asis.check.a_g) else made[0]
        capacity = [_capacity(record, check.a_g_slv) for record, check in zip(records, checks, strict=True)]
        of_ground = assess_uncertainty(points, np.array(capacity))
        ground = GroundSpread(**_figures(of_ground, [site]), capacity=tuple(capacity))
    return SampledAnalysis(
        **{key: getattr(asis, key) for key in _SAME},
        as_it_is=asis.load_factor,
        load_factors=tuple(factors.tolist()),
        **_figures(known, demands),
        explained=known.explained,
        rank_correlation=dict(zip(keys, known.rank_correlation.tolist(), strict=True)),
        without_result=Counter(lost),
        mechanism_of=tuple(record.mechanism if record else "" for record in records),
        mechanisms=_mechanisms(records, factors),
        ground_acceleration=ground,
    )


def _capacity(record: Analysis | None, value: float) -> float:
    """Return what a sample bears: 0 where it falls under its own weight, infinite where nothing is too much, NaN if not known."""
    match record.status if record else "":
        case "unstable":
            return 0.0
        case "unbounded":
            return np.inf
        case "optimal" | "converged":
            # Below zero stones fall before anything pushes.
            return max(value, 0.0)
    return np.nan


def _figures(known: Uncertainty, demands: Sequence[float]) -> dict[str, Any]:
    """Return the fields of a `Spread`."""
    finite = known.capacity[np.isfinite(known.capacity)]
    demand: FloatArray = np.linspace(0.9 * float(finite.min()), 1.1 * float(finite.max()), 41) if len(finite) else np.zeros(0)
    below = np.searchsorted(known.capacity, demand, side="left")
    curve = (demand, below / max(known.count, 1), *band(below, known.count))
    return {
        **{key: getattr(known, key) for key in ("count", "mean", "standard_deviation", "median", "dispersion")},
        "quantiles": {f"{level:g}": value for level, value in known.quantiles.items()},
        "fragility": Fragility(*(tuple(values.tolist()) for values in curve)),
        "demands": tuple(Asked(demand, *known.probability(demand)) for demand in demands),
    }


def _mechanisms(records: Sequence[Analysis | None], factors: FloatArray) -> tuple[Mechanism, ...]:
    """Return the mechanisms that were found, by what moves in them, the most frequent first."""
    kinds: dict[str, list[float]] = {}
    for record, factor in zip(records, factors.tolist(), strict=True):
        if record and np.isfinite(factor) and factor > 0 and record.method not in ("curve", "pushover"):
            kinds.setdefault(record.mechanism, []).append(factor)
    total = sum(map(len, kinds.values()))
    ordered = sorted(kinds.items(), key=lambda kind: (-len(kind[1]), kind[0]))
    return tuple(Mechanism(name, len(own), len(own) / total, float(np.mean(own)), min(own), max(own)) for name, own in ordered)
