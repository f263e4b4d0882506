"""The section of the report and the lines of the terminal about samples."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest

from churchpipe.io.atomic import canonical_json
from churchpipe.io.records import Analysis
from churchpipe.io.sample_study import Sample, SampleStudy, sample_study
from churchpipe.model.checks import SafetyCheck
from churchpipe.model.quantities import as_read, as_written
from churchpipe.report.table import Row
from churchpipe.report.uncertainty import lognormal, uncertainty_lines, uncertainty_section
from records import analysis

PARAMETER = {
    "key": ["material.default.friction"],
    "distribution": "normal",
    "mean": 0.6,
    "standard_deviation": 0.05,
    "low": 0.4,
    "high": None,
}


@pytest.fixture
def study() -> tuple[SampleStudy, list[Row]]:
    """Forty samples of two loads: one whose load factor is the friction, with two mechanisms, and one without any result."""
    friction = np.linspace(0.5, 0.7, 40)
    names = [f"{number:05d}" for number in range(1, 41)]
    asis = [analysis(name=load, load=load, flow="associative", load_factor=0.6) for load in ("+x", "+y")]
    made = {
        name: Sample(
            (
                replace(asis[0], load_factor=mu, mechanism="apse" if mu < 0.55 else "apse, nave"),
                replace(asis[1], load_factor=np.nan, status="not-converged"),
            )
        )
        for name, mu in zip(names[:-1], friction.tolist(), strict=False)
    } | {names[-1]: Sample((), "a door beyond its wall")}
    sample = {
        "settings": {"number": 40, "seed": 0, "method": "sobol", "parameters": [PARAMETER], "demands": [0.55]},
        "names": names,
        "points": {"material.default.friction": friction.tolist()},
    }
    words = canonical_json(as_written(sample_study(sample, made, asis), defaults=False))
    return as_read(SampleStudy, json.loads(words)), [Row(one) for one in asis]


def test_the_section_has_figures_mechanisms_and_what_is_missing(study: tuple[SampleStudy, list[Row]]) -> None:
    section = uncertainty_section(*study)
    assert section is not None
    assert section["parameters"] == [("friction", "normal, mean 0.6, standard deviation 0.05, from 0.4")]
    assert [one.sample for one in section["refused"]] == ["00040"]
    (_, *cells, matters, left_out), (_, *nothing, _, all_left_out) = section["rows"]
    assert cells[0] == "0.6000"
    assert float(cells[1]) == pytest.approx(0.5974, abs=1e-4)
    assert matters == "friction +1.00"
    assert left_out == "1 without a result (refused)"
    assert nothing == ["0.6000", *[""] * 5]
    assert all_left_out == "39 without a result (not-converged); 1 without a result (refused)"
    (shown,) = section["shown"]
    assert [row[:2] for row in shown["mechanisms"]] == [("apse, nave", "74.4 %"), ("apse", "25.6 %")]
    assert shown["spread"].count("<svg") == 2
    assert "rank correlation" in shown["influence"]
    # 10 of 39 frictions are below 0.55.
    assert "probability of 25.6 %" in section["demands"][0][1]


def test_load_factors_that_differ_by_rounding_alone_are_one_column(study: tuple[SampleStudy, list[Row]]) -> None:
    found, rows = study
    same = [
        replace(one, load_factors=tuple((0.25 + 1e-12 * np.arange(len(one.load_factors))).tolist())) for one in found.analyses[:1]
    ]
    section = uncertainty_section(replace(found, analyses=tuple(same)), rows)
    assert section
    histogram = section["shown"][0]["spread"].partition("</svg>")[0]
    ticks = [float(text.replace("\u2212", "-")) for text in re.findall(r">([\u2212\d.e]+)</text>", histogram) if "." in text]
    assert min(ticks) > 0.22
    assert "e\u2212" not in histogram


def test_parameters_of_one_name_are_told_apart_beside_their_bars(study: tuple[SampleStudy, list[Row]]) -> None:
    found, rows = study
    keys = "material.nave masonry.unit_weight_kN_m3", "material.tower masonry.unit_weight_kN_m3"
    values = found.points["material.default.friction"]
    points = {keys[0]: values, keys[1]: values[::-1]}
    one = replace(found.analyses[0], rank_correlation={keys[0]: 1.0, keys[1]: -0.5})
    section = uncertainty_section(replace(found, points=points, analyses=(one,)), rows)
    assert section is not None
    assert section["rows"][0][-2] == "unit weight of nave masonry +1.00, unit weight of tower masonry \u22120.50"
    bars = section["shown"][0]["influence"].partition("</svg>")[0]
    texts = re.findall(r">([^<>]+)</t", bars)
    assert {"nave masonry", "tower masonry"} <= set(texts)
    assert max(map(len, texts)) <= 16


@pytest.mark.parametrize(("count", "said"), [(3, False), (30, False), (100, True)])
def test_what_so_few_samples_show_by_chance_is_no_dependence(
    study: tuple[SampleStudy, list[Row]], count: int, said: bool
) -> None:
    found, rows = study
    # Independent ranks have a correlation beyond 1.645 / sqrt(n - 1) in one of ten cases.
    one = replace(found.analyses[0], count=count, rank_correlation={"material.default.friction": 0.2})
    text = "\n".join(uncertainty_lines(replace(found, analyses=(one,)), rows))
    assert ("it depends on friction +0.20" in text) == said


def test_the_terminal_says_it_in_sentences(study: tuple[SampleStudy, list[Row]]) -> None:
    text = "\n".join(uncertainty_lines(*study))
    assert "39 samples, load factor 0.5974 in the mean" in text
    assert "it depends on friction +1.00" in text
    assert "74 % fall by: apse, nave" in text
    assert ": 0 samples; 39 without a result (not-converged); 1 without a result (refused)." in text
    assert "1 of 40 samples could not be built; the first: a door beyond its wall" in text
    assert uncertainty_section(None, []) is None
    assert uncertainty_lines(None, []) == []


def test_samples_that_fall_under_their_own_weight_or_bear_anything_are_in_the_lognormal_curve() -> None:
    # Of ten samples two fall, with load factors of zero, one bears any load, and seven are spread about their median.
    friction, factors = np.linspace(0.3, 0.75, 10), [0.0, 0.0, *np.exp(np.linspace(-2.0, -1.4, 7)).tolist(), np.nan]
    ends = ["unstable"] * 2 + ["optimal"] * 7 + ["unbounded"]
    asis = analysis(name="+x", load="+x", load_factor=0.2)
    made = {
        f"{number}": Sample((replace(asis, load_factor=factor or np.nan, status=status, mechanism="apse" if factor else "nave"),))
        for number, (factor, status) in enumerate(zip(factors, ends, strict=True))
    }
    sample = {
        "settings": {"number": 10, "seed": 0, "method": "sobol", "parameters": [PARAMETER], "demands": []},
        "names": list(made),
        "points": {"material.default.friction": friction.tolist()},
    }
    study = as_read(SampleStudy, json.loads(canonical_json(as_written(sample_study(sample, made, [asis]), defaults=False))))
    (one,) = study.analyses
    assert one.median == pytest.approx(np.exp(-1.7))
    assert lognormal(one, np.array([0.0, one.median, 1e9])) == pytest.approx([0.2, 0.2 + 0.7 / 2, 0.9])
    section = uncertainty_section(study, [Row(asis)])
    assert section is not None
    # All finite load factors are in the histogram.
    assert "falls under its own weight" in section["shown"][0]["spread"]
    # The one that bears any load is in none of the pictures, and is counted beside them.
    assert section["rows"][0][-1] == "1 with no limit"
    assert "; 1 with no limit." in uncertainty_lines(study, [Row(asis)])[0]


def test_samples_whose_stones_fall_before_anything_pushes_bear_nothing() -> None:
    # Without dilatancy such a state has a load factor below zero, and rounding may make one of zero less than it.
    asis = analysis(name="+x", load="+x", flow="non-associative", load_factor=0.2)
    factors = (-0.05, -1e-12, 0.1, 0.3)
    made = {
        f"{number}": Sample((replace(asis, load_factor=factor, status="converged"),)) for number, factor in enumerate(factors)
    }
    sample = {
        "settings": {"number": 4, "seed": 0, "method": "sobol", "parameters": [PARAMETER], "demands": [0.05]},
        "names": list(made),
        "points": {"material.default.friction": [0.4, 0.45, 0.5, 0.6]},
    }
    (one,) = sample_study(sample, made, [asis]).analyses
    assert one.load_factors == (0.0, 0.0, 0.1, 0.3)
    assert one.demands[0].probability == 0.5
    assert one.median == pytest.approx(np.sqrt(0.1 * 0.3))


def test_the_ground_acceleration_asked_is_that_of_the_case_where_samples_have_others() -> None:
    # What the code asks may be sampled, too.
    def checked(a_g: float, a_g_slv: float) -> Analysis:
        check = SafetyCheck(a_g=a_g, a_g_slv=a_g_slv, zeta_e=a_g_slv / a_g, satisfied=a_g_slv >= a_g)
        return replace(analysis(name="+x", load="+x", load_factor=0.2, flow="associative"), check=check)

    asis, asked = checked(1.5, 1.6), (0.9, 1.2, 1.4, 1.9)
    made = {f"{a_g:g}": Sample((checked(a_g, slv),)) for a_g, slv in zip(asked, (1.2, 1.3, 1.6, 1.8), strict=True)}
    sample = {
        "settings": {"number": 4, "seed": 0, "method": "sobol", "parameters": [PARAMETER], "demands": []},
        "names": list(made),
        "points": {"check.ag_g": list(asked)},
    }
    (one,) = sample_study(sample, made, [asis]).analyses
    assert one.ground_acceleration is not None
    (answer,) = one.ground_acceleration.demands
    assert (answer.demand, answer.probability) == (1.5, 0.5)


def test_samples_that_fall_are_not_all_that_a_load_that_is_no_earthquake_is_asked_about() -> None:
    # Aslant downwards: the code has a check for the one sample that does not stand, and none for those that do.
    fallen = SafetyCheck(a_g=1.0, a_g_slv=0.0, zeta_e=0.0, satisfied=False)
    spared = SafetyCheck(a_g=1.0, message="the load is not horizontal")
    for down, counted in ((-1.0, None), (0.0, 1)):
        asis = replace(analysis(name="aslant", load="aslant", load_factor=0.2), direction=(1.0, 0.0, down), check=spared)
        lost = replace(asis, load_factor=np.nan, status="unstable", check=fallen)
        made = {"1": Sample((lost,)), "2": Sample((asis,)), "3": Sample((replace(asis, load_factor=0.3),))}
        sample = {
            "settings": {"number": 3, "seed": 0, "method": "sobol", "parameters": [PARAMETER], "demands": []},
            "names": list(made),
            "points": {"material.default.friction": [0.4, 0.5, 0.6]},
        }
        (one,) = sample_study(sample, made, [asis]).analyses
        assert (one.ground_acceleration and one.ground_acceleration.count) == counted
