"""How far a cell can be loaded in one direction."""

import numpy as np
import pytest

from churchpipe.errors import InputError
from churchpipe.homogenised_shell.cell_limit import cell_limit
from churchpipe.homogenised_shell.rigid_cell import rigid_cell
from hand_cell import running_limit

CLOSING = rigid_cell("running", 0.03, 0.08, 0.04).closing
COMPRESSION = np.array([-1.0, -1.0, 0, 0, 0, 0])


def test_compression_is_unbounded_and_tension_is_none() -> None:
    assert running_limit(0.03, 0.08, 0.04, 0.7, COMPRESSION, base=COMPRESSION).factor == np.inf
    assert running_limit(0.03, 0.08, 0.04, 0.7, -COMPRESSION, base=COMPRESSION).factor == pytest.approx(1, rel=1e-6)
    outside = running_limit(0.03, 0.08, 0.04, 0.7, [0, 0, 1, 0, 0, 0], base=-COMPRESSION)
    assert outside.outcome == "infeasible"
    assert np.isnan(outside.factor)


def test_cohesion_moves_the_apex() -> None:
    h, friction, cohesion = 0.04, 0.7, 3e4
    apex = h * cohesion / friction
    direction = np.array([0.3, 0.4, 0.5, 0.2 * h, -0.1 * h, 0.3 * h])
    with_cohesion = running_limit(0.03, 0.08, h, friction, direction, cohesion=cohesion)
    without = running_limit(0.03, 0.08, h, friction, direction, base=apex * COMPRESSION)
    assert with_cohesion.factor == pytest.approx(without.factor, rel=1e-6)
    assert running_limit(0.03, 0.08, h, friction, [0, 1, 0, 0, 0, 0], cohesion=cohesion).factor == pytest.approx(apex, rel=1e-6)


@pytest.mark.parametrize(
    ("changes", "where"),
    [
        ({"h": np.nan}, "h"),
        ({"friction": 0.0}, "friction"),
        ({"cohesion": -1.0}, "cohesion"),
        ({"direction": [0] * 6}, "direction"),
    ],
)
def test_values_out_of_range_are_named(changes: dict, where: str) -> None:
    with pytest.raises(InputError) as error:
        cell_limit(CLOSING, **({"h": 0.04, "friction": 0.7, "direction": COMPRESSION} | changes))
    assert error.value.where == where
