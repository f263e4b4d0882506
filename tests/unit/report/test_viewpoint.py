"""From where a mechanism is seen: from a side where the building does not hide what moves."""

import numpy as np
import pytest

import churchpipe as cp
from churchpipe import generators
from churchpipe.report.motion import viewpoint

STONES = cp.derive_blocks(generators.box(length=6.0, width=5.0, courses=16, brick=(1.0, 0.5, 0.5)))


def one_stone(side: str, motion: tuple[float, float, float]) -> np.ndarray:
    """Return the motion in which a wall loses one stone in the middle of it."""
    wall = np.flatnonzero(STONES.panel == side)
    middle = STONES.centroid[wall].mean(axis=0)
    velocities = np.zeros((STONES.count, 6))
    velocities[wall[np.argmin(np.linalg.norm(STONES.centroid[wall] - middle, axis=1))], :3] = motion
    return velocities


SIDES = {"south": (0, -1), "north": (0, 1), "west": (-1, 0), "east": (1, 0)}
# Out of the wall is the easy one: the other two are hidden from where the stones move to, or move to no side.
MOTIONS = {"outwards": 1.0, "inwards": -1.0, "down": 0.0}


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("side", SIDES)
def test_one_stone_is_seen_from_outside_its_wall(side: str, motion: str) -> None:
    outside = np.array(SIDES[side])
    along = MOTIONS[motion] * outside
    toward = viewpoint(STONES, one_stone(side, (*along, 0.0 if along.any() else -1.0)))
    assert np.linalg.norm(toward) == pytest.approx(1)
    assert toward[:2] @ outside > 0


def test_a_mechanism_of_the_whole_building_faces_the_side_it_moves_to() -> None:
    velocities = np.zeros((STONES.count, 6))
    velocities[~STONES.fixed, 1] = 1.0
    assert viewpoint(STONES, velocities)[1] > 0
    assert viewpoint(STONES, -velocities)[1] < 0


def test_two_sides_that_are_as_good_are_one_for_all_analyses_of_a_load() -> None:
    """A mechanism to +x drifts a little to either side, as two analyses of one load may find it."""
    seen = []
    for drift in (-1e-2, -1e-9, 0.0, 1e-9, 1e-2):
        velocities = np.zeros((STONES.count, 6))
        velocities[~STONES.fixed, :2] = 1.0, drift
        seen.append(viewpoint(STONES, velocities))
    np.testing.assert_allclose(seen, [seen[0]] * len(seen))
    assert seen[0][1] < 0
