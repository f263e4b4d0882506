"""A support under stones without one: it bears them where they stand, and fixes none of them."""

import numpy as np
import pytest

from churchpipe.model.assemblage import Assemblage
from churchpipe.model.loads import LoadCase
from churchpipe.rigid_blocks.limit import limit_analysis
from churchpipe.stones.contacts import find_contacts
from churchpipe.stones.ground import level_supports
from dxf_models import box
from solids import prism as upright


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


@pytest.mark.parametrize(("length", "height", "noise"), [(0.26, 0.065, 1e-3), (0.3, 0.25, 3e-4)])
def test_all_feet_of_a_course_drawn_by_hand_are_supported(length: float, height: float, noise: float) -> None:
    # Corners are a little off, as in a survey.
    chance = np.random.default_rng(5)
    solids = []
    for course in range(2):
        for number in range(6):
            points, faces = box((length * number, 0, height * course), (length, 0.12, height))
            # Outlines move alike on the front and on the back, so that faces stay planar.
            corner = np.unique(points[:, [0, 2]], axis=0, return_inverse=True)[1].ravel()
            solids.append((points + chance.uniform(-noise, noise, (4, 3))[corner] * [1, 0, 1], faces))
    stones = supported(solids)
    contacts = find_contacts(stones)
    fixed = stones.fixed[contacts.blocks]
    base = fixed[:, 0] != fixed[:, 1]
    assert np.unique(contacts.blocks[base][~fixed[base]]).tolist() == [0, 1, 2, 3, 4, 5]
    # A support holds no neighbour from the side, whose foot may be lower.
    assert (np.abs(contacts.frame[base, 0, 2]) > 0.9).all()
    assert contacts.area[base].sum() == pytest.approx(6 * length * 0.12, rel=0.01)


def test_a_foot_that_is_lower_than_that_beside_it_is_not_held_by_its_support() -> None:
    # Two leaves of a wall: upright sides of a support hold the lower one by a strip of .01 mm; the load factor rises by a tenth.
    stones = supported([box((0, 0, 0), (1.0, 0.12, 1.0)), box((0, 0.12, -1e-5), (1.0, 0.12, 1.0 + 1e-5))])
    contacts = find_contacts(stones)
    base = stones.fixed[contacts.blocks].any(axis=1)
    assert base.sum() == 2
    np.testing.assert_allclose(np.abs(contacts.frame[base, 0, 2]), 1.0, rtol=1e-6)


def test_stones_that_stand_on_an_edge_get_none() -> None:
    turn = np.array([(np.sqrt(0.5), 0, -np.sqrt(0.5)), (0, 1, 0), (np.sqrt(0.5), 0, np.sqrt(0.5))])
    points, faces = box((0, 0, 0), (1, 1, 1))
    assert level_supports([(points @ turn, faces)]) == ([], [])


def test_a_chip_at_the_foot_of_a_stone_gets_no_support() -> None:
    # Stones grown into their mortar are cut off at the lowest level, which may leave a face of some millimetres there.
    plates, resting = level_supports([upright([(0, 0), (0.004, 0), (1, 0.002), (1, 1), (0, 1)], 0.5)])
    assert resting == [0]
    assert [points[:, 0].max() for points, _ in plates] == [1.0]
