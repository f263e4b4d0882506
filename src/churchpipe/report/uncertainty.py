"""What samples say of a building whose parameters are not known exactly: figures and rows of the report's section."""

import math
from collections.abc import Mapping, Sequence
from textwrap import fill
from typing import Any

import numpy as np

from churchpipe.io.sample_study import Asked, Mechanism, SampledAnalysis, SampleStudy
from churchpipe.model.arrays import FloatArray
from churchpipe.model.quantities import GRAVITY
from churchpipe.model.swept import heading, setting
from churchpipe.report import colours
from churchpipe.report.plots import new_panels, svg_of_panels
from churchpipe.report.table import Row, figure, minus
from churchpipe.wording import counted

# Scatter plots of the parameters that matter most.
_SHOWN = 3
# Load factors closer than this share of them are one; the histogram then reaches so far around it.
_SAME, _AROUND = 1e-6, 0.1
# Parameters whose rank correlation is below this share matter little; nor is one told that n independent samples exceed by chance
# in one of ten cases, _CHANCE / sqrt(n - 1).
_NOISE, _CHANCE = 0.1, 1.645
# Letters of a line beside the bars.
_LETTERS = 16
_FALLEN = "falls under its own weight"
_HEADINGS = ("as it is", "mean", "CoV", "5 %", "median", "95 %")


def uncertainty_section(study: SampleStudy | None, rows: Sequence[Row]) -> dict[str, Any] | None:
    """Return what the section shows, or None of a case without [sample]: parameters, refused samples, and of each analysis its
    figures, plots and mechanisms."""
    if study is None:
        return None
    label = _labels(rows)
    analyses = [one for one in study.analyses if one.count]
    return {
        "number": study.number,
        "method": {"sobol": "a Sobol sequence", "latin-hypercube": "Latin hypercubes"}[study.method],
        "seed": study.seed,
        "parameters": [(", ".join(map(heading, table["key"])), _distribution(table)) for table in study.parameters],
        "refused": study.refused,
        "headings": ["Analysis", *_HEADINGS, "depends on", ""],
        "rows": [[label[one.name], *_row(one), _matters(one), "; ".join(_left_out(one))] for one in study.analyses],
        "demands": [(label[one.name], _asked(*asked)) for one in analyses for asked in _demands(one)],
        "shown": [
            {
                "label": label[one.name],
                "spread": _spread_svg(one),
                "influence": _influence_svg(one, study.points),
                "explained": None if math.isnan(one.explained) else one.explained,
                "mechanisms": [_mechanism(kind) for kind in one.mechanisms],
            }
            for one in analyses
        ],
    }


def uncertainty_lines(study: SampleStudy | None, rows: Sequence[Row]) -> list[str]:
    """Return the same for a terminal: a sentence or two an analysis, and one for what could not be built."""
    if study is None:
        return []
    label, lines = _labels(rows), list[str]()
    for one in study.analyses:
        row = dict(zip(_HEADINGS, _row(one), strict=True))
        words = f"{label[one.name]}: {counted(one.count, 'sample')}"
        if one.count:
            spread = f", CoV {row['CoV']}" if row["CoV"] else ""
            words += f", load factor {row['mean']} in the mean{spread}, 90 % of them from {row['5 %']} to {row['95 %']}"
        depends = [f"it depends on {_matters(one)} (rank correlation)"] if _matters(one) else []
        lines.append("; ".join([words, *depends, *_left_out(one)]) + ".")
        kinds = one.mechanisms[:3] if len(one.mechanisms) > 1 else ()
        lines += [f"  {100 * kind.share:.0f} % fall by: {kind.moves} (mean {figure(kind.mean, 4)})" for kind in kinds]
        lines += [f"  {_asked(*asked)}" for asked in _demands(one)]
    refused = study.refused
    if refused:
        lines.append(f"{len(refused)} of {counted(study.number, 'sample')} could not be built; the first: {refused[0].message}")
    return lines


def _labels(rows: Sequence[Row]) -> dict[str, str]:
    """Return what to call each analysis, by name; its friction may be among what varies."""
    return {
        row.record.name: ", ".join(
            [
                *([row.variant] if row.variant else []),
                *(["shell"] if row.of_shell else []),
                row.kind,
                f"load {row.load}",
                *(setting(key, value) for key, value in row.record.swept.items()),
            ]
        )
        for row in rows
    }


def _distribution(table: Mapping[str, Any]) -> str:
    named = (("mean", "mean"), ("standard deviation", "standard_deviation"), ("from", "low"), ("to", "high"))
    return ", ".join(
        [table["distribution"], *(f"{words} {minus(f'{table[key]:g}')}" for words, key in named if table[key] is not None)]
    )


def _unlimited(value: float) -> float:
    """Return a number of the summary, which has none for what has no limit."""
    return math.inf if math.isnan(value) else value


def _row(one: SampledAnalysis) -> list[str]:
    if not one.count:
        return [figure(one.as_it_is, 4), *[""] * 5]
    mean, spread = one.mean, one.standard_deviation
    share = "" if not mean or math.isnan(spread) else f"{100 * spread / mean:.1f} %"
    quantiles = (figure(_unlimited(one.quantiles[level]), 4) for level in ("0.05", "0.5", "0.95"))
    return [figure(one.as_it_is, 4), figure(_unlimited(mean), 4), share, *quantiles]


def _left_out(one: SampledAnalysis) -> list[str]:
    """Return how many samples the mechanisms, the histogram and the points lack, in words."""
    # The summary has no number for what has no limit.
    unlimited = one.count - int(np.isfinite(np.array(one.load_factors)).sum())
    lost = [f"{count} without a result ({status})" for status, count in one.without_result.items()]
    return ([f"{unlimited} with no limit"] if unlimited else []) + lost


def _ranked(one: SampledAnalysis) -> list[tuple[str, float]]:
    """Return the parameters and their rank correlations, the strongest first."""
    known = [(key, value) for key, value in one.rank_correlation.items() if not math.isnan(value)]
    return sorted(known, key=lambda item: -abs(item[1]))


def _matters(one: SampledAnalysis) -> str:
    least = max(_NOISE, _CHANCE / math.sqrt(max(one.count - 1, 1)))
    found = [(key, value) for key, value in _ranked(one) if abs(value) >= least]
    return ", ".join(f"{heading(key).partition(',')[0]} {minus(f'{value:+z.2f}')}" for key, value in found)


def _demands(one: SampledAnalysis) -> list[tuple[str, Asked]]:
    """Return the demands on an analysis as words, and the answers."""
    found = [(f"the load factor {figure(asked.demand, 4)}", asked) for asked in one.demands]
    ground = one.ground_acceleration.demands if one.ground_acceleration else ()
    return found + [(f"the ground acceleration {figure(asked.demand / GRAVITY, 3)} g", asked) for asked in ground]


def _asked(words: str, answer: Asked) -> str:
    low, high = (f"{100 * value:.1f}" for value in (answer.low, answer.high))
    return f"with a probability of {100 * answer.probability:.1f} % it bears less than {words} (90 % band: {low} to {high} %)"


def _mechanism(kind: Mechanism) -> tuple[str, str, str, str]:
    span = f"{figure(kind.low, 4)} to {figure(kind.high, 4)}"
    return kind.moves or "the only wall", f"{100 * kind.share:.1f} %", figure(kind.mean, 4), span


def _by_mechanism(one: SampledAnalysis) -> list[tuple[str, Any, Any]]:
    """Return name, colour and samples of each mechanism, the most frequent first, where a load factor is finite; last those that
    fall under their own weight."""
    names, values = one.mechanism_of, np.array(one.load_factors)
    kinds = [kind.moves for kind in one.mechanisms] or [""]
    colour = (colours.PANELS[number % len(colours.PANELS)] for number in range(len(kinds)))
    chosen = [np.array([name == kind for name in names]) & np.isfinite(values) & (values > 0) for kind in kinds]
    fallen = [(_FALLEN, colours.ALARM, values == 0)] if (values == 0).any() else []
    return [*zip(kinds, colour, chosen, strict=True), *fallen]


def lognormal(one: SampledAnalysis, demand: FloatArray) -> FloatArray:
    """Return the probability (n,) that a sample bears less than demands (n,), its load factor lognormal where it has one above 0;
    some may not bear their own weight, and some any load.
    """
    from scipy.stats import norm

    values = np.array(one.load_factors)
    nothing, limited = int((values == 0).sum()), int((np.isfinite(values) & (values > 0)).sum())
    logarithm = np.log(np.maximum(demand / one.median, np.finfo(float).tiny))
    return np.asarray((nothing + limited * norm.cdf(logarithm / one.dispersion)) / one.count)


def _spread_svg(one: SampledAnalysis) -> str:
    """Return an SVG: load factors by mechanism, and the fragility curve with its band."""
    left, right = new_panels(2, (4.7, 3.2))
    kinds, values = _by_mechanism(one), np.array(one.load_factors)
    groups = [values[chosen] for _, _, chosen in kinds]
    words = [name or "" for name, _, _ in kinds]
    spread = np.concatenate(groups)
    low, high = (float(spread.min()), float(spread.max())) if len(spread) else (0.0, 1.0)
    if high - low < _SAME * high:
        # Load factors that differ by rounding alone are one column, not a distribution.
        low, high = (1 - _AROUND) * low, (1 + _AROUND) * high
    shape = {"bins": min(30, 8 + one.count // 10), "range": (low, high), "stacked": True}
    left.hist(groups, color=[colour for _, colour, _ in kinds], label=words, **shape)
    if not math.isnan(one.as_it_is):
        left.axvline(one.as_it_is, color=colours.INK, lw=1, ls="--", label="as it is")
    left.set_axisbelow(True)
    # Room for the legend.
    left.set_ylim(top=1.3 * left.get_ylim()[1])
    left.set_xlabel("load factor")
    left.set_ylabel("samples")
    if any(words) and len(words) <= 8:
        left.legend(fontsize=7, frameon=False)
    curve = one.fragility
    right.fill_between(curve.demand, curve.low, curve.high, color=colours.PUSH, alpha=0.15, lw=0, label="90 % band")
    right.plot(curve.demand, curve.probability, color=colours.PUSH, lw=1.6, label="samples")
    if one.dispersion > 0:
        smooth = np.linspace(curve.demand[0], curve.demand[-1], 200)
        right.plot(smooth, lognormal(one, smooth), color=colours.ALARM, lw=1, ls="--", label="lognormal")
    for asked in one.demands:
        right.plot(asked.demand, asked.probability, "o", ms=4, color=colours.INK)
    right.set_xlabel("load factor asked")
    right.set_ylabel("probability of collapse")
    right.legend(fontsize=7, frameon=False, loc="upper left")
    return svg_of_panels(left, right)


def _influence_svg(one: SampledAnalysis, points: dict[str, tuple[float, ...]]) -> str:
    """Return an SVG: rank correlations, and load factor against the parameters that matter most; "" where nothing varies."""
    ranked = _ranked(one)
    if not ranked:
        return ""
    shown = ranked[:_SHOWN]
    bars, *scatters = new_panels(1 + len(shown), (3.6, 2.9))
    names = [fill(heading(key).partition(",")[0], _LETTERS, break_long_words=False) for key, _ in ranked]
    bars.barh(
        range(len(ranked)), [value for _, value in ranked], color=[colours.PUSH if v >= 0 else colours.ALARM for _, v in ranked]
    )
    bars.set_axisbelow(True)
    bars.set_yticks(range(len(ranked)), names)
    bars.invert_yaxis()
    bars.set_xlim(-1, 1)
    bars.axvline(0, color=colours.INK, lw=0.8)
    bars.set_xlabel("rank correlation")
    bars.set_xticks((-1.0, -0.5, 0.0, 0.5, 1.0))
    values = np.array(one.load_factors)
    for axis, (key, _) in zip(scatters, shown, strict=True):
        for _, colour, chosen in _by_mechanism(one):
            axis.plot(np.array(points[key])[chosen], values[chosen], "o", ms=2.6, color=colour)
        axis.set_xlabel(heading(key))
        axis.set_ylabel("load factor")
    return svg_of_panels(bars, *scatters)
