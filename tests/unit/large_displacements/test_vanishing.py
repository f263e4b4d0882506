"""Where a curve has come down to nothing, and where a step below zero is none of its equilibria."""

import numpy as np
import pytest

from churchpipe.large_displacements.record import vanished
from churchpipe.model.block_curve import vanishing


@pytest.mark.parametrize(
    ("load_factor", "misfit", "ends"),
    [
        ([0.2, 0.1], 1e-3, False),
        ([0.2, 0.1, -0.01], 1e-3, True),
        ([0.2, 0.1, 1e-12], 1e-3, True),
        # Forces across open gaps: the next step may stand higher again.
        ([0.2, 0.1, -0.01], 2.0, False),
        ([0.2, 0.1, -0.01, 0.04], 1e-3, False),
        ([0.2, 0.1, -0.01, -0.02], 2.0, True),
        ([0.2, 0.1, -0.01, -0.02], 1e-3, True),
        ([-0.01], 1e-3, True),
        ([-0.01], 2.0, False),
    ],
)
def test_two_steps_that_are_no_equilibria_end_a_curve_as_one_that_is(load_factor: list[float], misfit: float, ends: bool) -> None:
    assert vanished(load_factor, misfit, 1e-8) == ends


@pytest.mark.parametrize(
    ("load_factor", "expected"),
    [
        ([0.2, 0.1, -0.1], 1.5),
        ([0.2, 0.1, -0.1, -0.2], 1.5),
        ([0.2, -0.1, 0.1, -0.1], 2.5),
        ([0.2, 0.1, 1e-12], 2.0),
        ([-0.1, -0.2], 0.0),
    ],
)
def test_the_place_where_it_vanishes_is_before_its_last_steps_below_zero(load_factor: list[float], expected: float) -> None:
    assert vanishing(np.arange(float(len(load_factor))), np.array(load_factor)) == pytest.approx(expected)
