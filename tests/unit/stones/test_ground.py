"""A support under stones without one: it bears them where they stand, and fixes none of them."""

import numpy as np
import pytest

from churchpipe.model.assemblage import Assemblage
from churchpipe.model.loads import LoadCase
from churchpipe.rigid_blocks.limit import limit_analysis
from churchpipe.stones.contacts import find_contacts
from churchpipe.stones.ground import level_supports
from dxf_models import box


def supported(solids: list) -> Assemblage:
    plates, resting = level_supports(solids)
    assert resting
    return Assemblage.from_polyhedra([*solids, *plates], 18e3, fixed=range(len(solids), len(solids) + len(plates)))


def test_a_wall_of_eight_courses_overturns_about_its_own_foot() -> None:
    # 2.00 m high, .5 m thick: pushed across it overturns at b / h = .25, not at .5 / 1.75 with its first course fixed.
    stones = supported([box((0, 0, 0.25 * course), (1.0, 0.5, 0.25)) for course in range(8)])
    state = limit_analysis(stones, find_contacts(stones), LoadCase((0, 1, 0)), friction=0.7)
    assert stones.count == 9
    assert state.load_factor == pytest.approx(0.5 / 2.0, rel=1e-6)


def test_feet_that_are_not_quite_level_each_get_a_block() -> None:
    solids = [box((0, 0, 0), (0.4, 0.4, 1.0)), box((2, 0, 2e-4), (0.4, 0.4, 1.0 - 2e-4)), box((0, 0, 1.0), (2.4, 0.4, 0.3))]
    stones = supported(solids)
    contacts = find_contacts(stones)
    assert stones.fixed.tolist() == [False, False, False, True, True]
    assert sorted(map(sorted, contacts.blocks.tolist())) == [[0, 2], [0, 3], [1, 2], [1, 4]]
    np.testing.assert_allclose(contacts.area, 0.16, rtol=1e-9)


def test_stones_that_stand_on_an_edge_get_none() -> None:
    turn = np.array([(np.sqrt(0.5), 0, -np.sqrt(0.5)), (0, 1, 0), (np.sqrt(0.5), 0, np.sqrt(0.5))])
    points, faces = box((0, 0, 0), (1, 1, 1))
    assert level_supports([(points @ turn, faces)]) == ([], [])
