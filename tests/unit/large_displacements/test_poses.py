"""Finite motions of stones."""

import numpy as np
import pytest

from churchpipe.large_displacements.poses import Poses, displaced, rotation_vectors, screw, start_poses
from solids import box, on_ground


def test_a_stone_that_turns_about_an_axis_at_rest_keeps_that_axis() -> None:
    stones = on_ground(box((0, 1), (0, 1), (0, 3)))
    axis, turn = np.array([1.0, 0.3, 0.0]), np.array([0.0, 0.9, 0.0])
    twist = np.zeros((2, 6))
    twist[1] = [*np.cross(turn, stones.centroid[1] - axis), *turn]
    poses = start_poses(stones).moved(twist)
    held = start_poses(stones).arm(np.array([1]), axis[None])
    assert poses.place(np.array([1]), held)[0] == pytest.approx(axis, abs=1e-12)
    assert rotation_vectors(poses.rotation)[1] == pytest.approx(turn, abs=1e-12)
    assert displaced(stones, poses).volume == pytest.approx(stones.volume)


def test_half_a_motion_twice_is_the_motion() -> None:
    rng = np.random.default_rng(0)
    poses = Poses(rng.normal(size=(5, 3)), screw(rng.normal(size=(5, 3)))[0])
    turn = rng.normal(size=(5, 3))
    centre = rng.normal(size=(5, 3))

    def twist(at: Poses, share: float) -> np.ndarray:
        return share * np.hstack([np.cross(turn, at.centroid - centre), turn])

    whole = poses.moved(twist(poses, 1.0))
    half = poses.moved(twist(poses, 0.5))
    again = half.moved(twist(half, 0.5))
    assert again.centroid == pytest.approx(whole.centroid, abs=1e-12)
    assert again.rotation == pytest.approx(whole.rotation, abs=1e-12)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-4, 0.5, 3.1])
def test_rotation_vectors_come_back(angle: float) -> None:
    vector = angle * np.array([[0.6, 0.0, 0.8]])
    assert rotation_vectors(screw(vector)[0]) == pytest.approx(vector, abs=1e-12)
