"""Pressure on the face of a wall whose joints are drawn with little care."""

import numpy as np
import pytest

import churchpipe as cp
from solids import box


@pytest.mark.parametrize("gap", [0.0, 0.5e-3, 2e-3])
def test_soil_does_not_press_where_another_wall_lies_against_the_face(gap):
    solids = [box((0.0, 4.0), (0.0, 0.4), (0.3 * k, 0.3 * k + 0.3)) for k in range(6)]
    solids += [box((1.5, 2.0), (0.4 + gap, 2.4), (0.3 * k, 0.3 * k + 0.3)) for k in range(6)]
    ground = box((-1.0, 5.0), (-1.0, 4.0), (-0.5, 0.0))
    stones = cp.Assemblage.from_polyhedra([ground, *solids], 19e3, fixed=[0], panel=["", *["wall"] * 6, *["cross"] * 6])
    placed = cp.place_loads(stones, [cp.Pressure("wall", toward="-y", unit_weight=10e3, top=1.8)])
    # A triangle of pressure over the height, on 4 m less the half metre of the other wall.
    np.testing.assert_allclose(placed.dead.sum(axis=0), [0.0, -10e3 * 1.8**2 / 2 * 3.5, 0.0], atol=1e-6)


def test_soil_presses_in_a_cavity_however_large_the_stone_beside_it_is():
    wall, other = box((0.0, 10.0), (0.0, 0.8), (0.0, 6.0)), box((0.0, 10.0), (0.82, 1.2), (0.0, 6.0))
    ground = box((-1.0, 11.0), (-1.0, 4.0), (-0.5, 0.0))
    stones = cp.Assemblage.from_polyhedra([ground, wall, other], 19e3, fixed=[0], panel=["", "wall", "other"])
    placed = cp.place_loads(stones, [cp.Pressure("wall", toward="-y", unit_weight=10e3, top=6.0)])
    np.testing.assert_allclose(placed.dead.sum(axis=0), [0.0, -10e3 * 6.0**2 / 2 * 10.0, 0.0], atol=1e-6)
