"""A load pressed down anywhere on the back of a structure."""

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.errors import InputError
from churchpipe.generators import vault
from solids import box

# A corbel: 3 m by 1 m by .5 m, 1 m of it on a pier.
CORBEL = cp.Assemblage.from_polyhedra([box((0, 1.6), (0, 1), (0, 1)), box((0, 3), (0, 1), (1, 1.5))], 20e3, fixed=[0])


def test_a_corbel_tips_about_the_edge_of_its_pier() -> None:
    # Weight 30 kN with its middle .1 m behind the edge at x = 1.6 m; the load 1 m before it: 3 kN.
    load = cp.load_from_above(CORBEL, (2.6, 0.5), force=1e3)
    state = cp.limit_analysis(CORBEL, cp.find_contacts(CORBEL), load, friction=0.7)
    assert state.load_factor == pytest.approx(3.0, rel=1e-6)


def test_a_load_acts_where_the_back_of_a_vault_is() -> None:
    stones = cp.derive_blocks(vault(span=1.8, thickness=0.2, courses=27, stone_length=2.0, length=1.0))
    contacts = cp.find_contacts(stones)
    factors = {}
    for x in (-0.55, 0.55):
        load = cp.load_from_above(stones, (x, 0.5), force=1e3)
        (stone,) = np.flatnonzero(load.live[:, 2])
        corner = stones.points[slice(*stones.block_point_ptr[stone : stone + 2]), 0]
        assert corner.min() <= x <= corner.max()
        # The load is at the place asked for: its moment about y at the origin is x times the force.
        assert stones.centroid[stone, 0] * 1e3 + load.live[stone, 4] == pytest.approx(1e3 * x, abs=1e-6)
        factors[x] = cp.limit_analysis(stones, contacts, load, friction=0.7).load_factor
    # The vault is symmetrical.
    assert factors[-0.55] == pytest.approx(factors[0.55], rel=1e-6)


def test_no_stone_there() -> None:
    with pytest.raises(InputError, match=r"load_from_above: place: no stone lies there; found \[5\.0, 0\.5\]"):
        cp.load_from_above(CORBEL, (5.0, 0.5))
