"""Where a curve has come down to nothing, and where a step below zero is none of its equilibria."""

import pytest

from churchpipe.large_displacements.record import vanished


@pytest.mark.parametrize(
    ("load_factor", "misfit", "last"),
    [
        ([0.2, 0.1], 1e-3, 0),
        ([0.2, 0.1, -0.01], 1e-3, 1),
        ([0.2, 0.1, 1e-12], 1e-3, 1),
        # Forces across open gaps: the next step may stand higher again.
        ([0.2, 0.1, -0.01], 2.0, 0),
        ([0.2, 0.1, -0.01, 0.04], 1e-3, 0),
        ([0.2, 0.1, -0.01, -0.02], 2.0, 2),
        ([0.2, 0.1, -0.01, -0.02], 1e-3, 2),
        ([-0.01], 1e-3, 1),
        ([-0.01], 2.0, 0),
    ],
)
def test_two_steps_that_are_no_equilibria_end_a_curve_as_one_that_is(load_factor: list[float], misfit: float, last: int) -> None:
    assert vanished(load_factor, misfit, 1e-8) == last
