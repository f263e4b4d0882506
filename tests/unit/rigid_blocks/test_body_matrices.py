"""Matrices of rigid bodies against the forces and rates of their points."""

import numpy as np

from churchpipe.model.loads import LoadCase
from churchpipe.rigid_blocks.contact_newton import ContactSystem, multiply
from churchpipe.rigid_blocks.equilibrium import equilibrium
from churchpipe.rigid_blocks.limit import point_strength
from churchpipe.rigid_blocks.settings import CentralSettings
from models import random_building


def test_products_are_those_point_by_point() -> None:
    stones, contacts, friction, _ = random_building(3)
    balance = equilibrium(stones, contacts, LoadCase((1, 0, 0)))
    system = ContactSystem(balance, point_strength(contacts, friction, 0.0, balance.force), CentralSettings())
    rng = np.random.default_rng(0)
    blocks, y = rng.normal(size=(3, 3, system.points)), rng.normal(size=len(balance.dead))

    def by_points(blocks: np.ndarray) -> np.ndarray:
        return system.couple(multiply(blocks, system.rates(y)))

    matrix = system.matrix(blocks)
    np.testing.assert_allclose(matrix.times(y), by_points(blocks), rtol=0, atol=1e-12 * np.abs(by_points(blocks)).max())
    swapped = by_points(blocks.transpose(1, 0, 2))
    np.testing.assert_allclose(matrix.transposed_times(y), swapped, rtol=0, atol=1e-12 * np.abs(swapped).max())
    even = blocks + blocks.transpose(1, 0, 2)
    same = system.matrices.symmetric(system.assembled(even))
    np.testing.assert_allclose(same.times(y), by_points(even), rtol=0, atol=1e-12 * np.abs(by_points(even)).max())
