"""Loads turn with the points of the stones where they act."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import churchpipe as cp
from churchpipe.generators import vault
from churchpipe.large_displacements.travelling import dead_loads, live_loads
from churchpipe.loading.placing import place_loads
from solids import box


def stones() -> cp.Assemblage:
    solids = [box((-9, 9), (-9, 9), (-1, 0)), box((0, 4), (0, 0.5), (0, 1)), box((0, 4), (0, 0.5), (1, 3))]
    return cp.Assemblage.from_polyhedra(solids, 18e3, fixed=[0], panel=["", "wall", "wall"])


@pytest.mark.parametrize("wrench", [False, True])
def test_moments_of_turned_loads_are_those_of_their_turned_places(wrench: bool) -> None:
    laid = stones()
    loads = [
        cp.LineLoad("wall", dead=5e3, thrust=1e3, toward="+y", eccentricity=0.1, mass=2e3),
        cp.PointLoad("wall", 1.0, height=0.7, dead=3e3, mass=0.0),
    ]
    parts = place_loads(laid, loads)
    own = np.zeros((3, 6))
    if wrench:
        own[2] = [0, 0, -4e3, 400.0, 0, 0]
    load = cp.loaded(cp.LoadCase((1, 0, 0), dead=own if wrench else None), laid, parts)
    turn = Rotation.random(3, random_state=1).as_matrix()
    free = np.array([1, 2])
    for travelling, forces in ((dead_loads(laid, load), parts.dead), (live_loads(laid, load), np.outer(parts.mass, [1, 0, 0]))):
        arm = np.einsum("kij,kj->ki", turn[parts.stone], parts.point - laid.centroid[parts.stone])
        expected = np.zeros((3, 3))
        np.add.at(expected, parts.stone, np.cross(arm, forces))
        if wrench and forces is parts.dead:
            # The line of 4 kN with that moment passes .1 m beside the centroid.
            expected[2] += np.cross(turn[2] @ [0, -0.1, 0], [0, 0, -4e3])
        found = travelling.rows(turn, free, 1.0, 1.0).reshape(-1, 6)
        np.testing.assert_allclose(found[:, 3:], expected[1:], atol=1e-9)


def test_fill_turns_with_the_back_that_it_lies_on() -> None:
    barrel = vault(
        span=1.8, thickness=0.2, courses=9, stone_length=0.5, length=1.0, materials=(cp.Material("default", 18e3, 0.7),)
    )
    arch = cp.derive_blocks(barrel)
    load = cp.with_fill(cp.LoadCase((1, 0, 0)), arch, "vault", 1.1, 15e3, cp.find_contacts(arch))
    for travelling in (dead_loads(arch, load), live_loads(arch, load)):
        assert np.abs(travelling.virial).max() > 10.0
        np.testing.assert_allclose(travelling.moment, 0.0, atol=1e-9 * np.abs(travelling.virial).max())
