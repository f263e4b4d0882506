"""Clusters of points that are close to each other."""

import tracemalloc

import numpy as np
import pytest

from churchpipe.geometry.clusters import clusters


@pytest.mark.parametrize("seed", range(4))
def test_clusters_are_those_of_all_pairs_in_the_order_of_their_first_points(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.integers(0, 5, (60, 2)) + 0.1 * rng.integers(-1, 2, (60, 2))
    found = clusters(points, 0.25)
    expected = np.full(len(points), -1)
    for number, _ in enumerate(points):
        if expected[number] < 0:
            expected[number] = expected.max() + 1
            near, before = expected == expected[number], 0
            while near.sum() > before:
                before = near.sum()
                near = (np.linalg.norm(points[:, None] - points[near][None], axis=2) <= 0.25).any(axis=1)
            expected[near] = expected[number]
    assert found.tolist() == expected.tolist()


def test_many_points_at_one_place_take_no_more_room_than_they_fill() -> None:
    """As the normals of all stones of a wall are: 20000 stones have some 200 million pairs of them."""
    points = np.repeat([[1.0, 0.0], [0.0, 1.0], [1.0, 1e-9]], 4000, axis=0)
    tracemalloc.start()
    found = clusters(points)
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert np.unique(found, return_index=True)[1].tolist() == [0, 4000]
    assert most < 20 * points.nbytes
