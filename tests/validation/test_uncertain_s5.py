"""The documented figures of docs/uncertainty.md: S5 with uncertain friction, weight and overlap."""

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.config.case import cases_of
from churchpipe.config.case_file import read_table

CASE = "pipeline/cases/s5_uncertain.toml"


@pytest.mark.slow("docs/uncertainty.md: mean, spread and rank correlations of 100 samples of S5")
def test_the_load_factor_of_s5_hangs_on_friction() -> None:
    case = cp.read_case(CASE)
    assert case.sample is not None
    keys = [parameter.key[0] for parameter in case.sample.parameters]
    points = cp.sample_points(case.sample.parameters, case.sample.number)
    factors: list[float] = []
    for values in points.tolist():
        sample = cases_of(read_table(case.path), case.path, (), dict(zip(keys, values, strict=True)))[0]
        stones = cp.derive_blocks(sample.building())
        state = cp.limit_analysis(stones, cp.find_contacts(stones), sample.loads[0], sample.materials[0].friction)
        factors.append(state.load_factor)
    found = cp.assess_uncertainty(points, np.array(factors))
    assert (found.count, found.unknown) == (100, 0)
    assert found.mean == pytest.approx(0.4401, abs=1e-4)
    assert found.standard_deviation / found.mean == pytest.approx(0.039, abs=5e-4)
    assert [found.quantiles[level] for level in (0.05, 0.95)] == pytest.approx([0.4134, 0.4694], abs=1e-4)
    assert found.rank_correlation == pytest.approx([0.97, 0.01, 0.25], abs=0.01)
    assert found.probability(0.4)[0] == 0.01
