"""Blocks of a matrix B S B^T against its factors one after another."""

import numpy as np

from churchpipe.conic.block_matrix import BlockMatrix, BlockPattern
from churchpipe.conic.interior_point.wrenches import WrenchCoupling
from churchpipe.model.loads import LoadCase
from churchpipe.rigid_blocks.equilibrium import equilibrium
from models import facade


def test_products_are_those_of_the_three_factors():
    stones, contacts = facade("small")
    coupling = WrenchCoupling(equilibrium(stones, contacts, LoadCase((1, 0, 0))).wrenches)
    random = np.random.default_rng(5)
    inner, y = random.normal(size=(3, 3, coupling.count)), random.normal(size=coupling.rows)
    spread = coupling.spread(y).reshape(3, -1)
    whole = coupling.couple(np.einsum("ijk,jk->ik", inner, spread).ravel())
    transposed = coupling.couple(np.einsum("jik,jk->ik", inner, spread).ravel())
    blocks = BlockMatrix(BlockPattern(coupling), inner)
    assert np.abs(blocks.times(y) - whole).max() < 1e-12 * np.abs(whole).max()
    assert np.abs(blocks.transposed_times(y) - transposed).max() < 1e-12 * np.abs(transposed).max()
