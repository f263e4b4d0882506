"""Which stones a fall takes out: those that nothing holds, and none that stands beside them."""

import numpy as np
import pytest

import churchpipe as cp
from solids import box


@pytest.mark.parametrize("step", [None, 0.005])
def test_a_plank_that_spans_a_gap_does_not_fall_with_one_beside_it(step: float | None) -> None:
    # The left ground moves away from the right one. Of both planks the ends slide alike: half as fast as the ground.
    grounds = [box((-2, 0), (-1, 1), (-0.3, 0)), box((0, 2), (-1, 1), (-0.3, 0))]
    heavy = box((-0.9, -0.4), (-0.3, 0.3), (0, 1.2))
    planks = [box((-0.09, 0.09), (-0.28, -0.13), (0, 0.13)), box((-0.06, 0.12), (-0.08, 0.07), (0, 0.13))]
    stones = cp.Assemblage.from_polyhedra([*grounds, heavy, *planks], 20e3, fixed=[0, 1])
    path = cp.settlement_path(stones, cp.find_contacts(stones), [0], (-1, 0, 0), 0.62, furthest=0.3, step=step)
    assert [fallen.stones.tolist() for fallen in path.fallen] == [[4], [3]]
    for fallen in path.fallen:
        after = fallen.step + 1
        middle = path.position[after, fallen.stones, 0]
        on_left, on_right = -path.movement[after] - (middle - 0.09), middle + 0.09
        # What lies on an edge by no more than 3 mm, an eighth of the reach of a contact, lies on nothing.
        assert np.minimum(on_left, on_right) < 0.0035
