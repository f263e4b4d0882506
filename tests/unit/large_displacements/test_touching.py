"""Contacts of stones wherever they are."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bad_faces import FIRST, SECOND
from churchpipe.generators import wall
from churchpipe.large_displacements.moving_model import moving_model
from churchpipe.large_displacements.path_state import state_at
from churchpipe.large_displacements.poses import Poses, displaced, start_poses
from churchpipe.large_displacements.renewal import first_joints, renewed
from churchpipe.large_displacements.touching import touching
from churchpipe.large_displacements.travelling import live_loads
from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.loads import LoadCase
from churchpipe.rigid_blocks.equilibrium import equilibrium
from churchpipe.stones.blocks import derive_blocks
from churchpipe.stones.contacts import find_contacts
from solids import box, on_ground, prism


def moved(stones: Assemblage, twist: FloatArray) -> Assemblage:
    motion = np.zeros((stones.count, 6))
    motion[1] = twist
    return displaced(stones, start_poses(stones).moved(motion))


def found(stones: Assemblage, reach: float = 0.05) -> tuple[FloatArray, FloatArray, FloatArray]:
    contacts, gap, *_ = touching(stones, np.zeros(stones.count, dtype=bool), reach, reach, 0.1 * reach)
    return contacts.point, gap, contacts.frame[contacts.interface_of_point, 0]


def test_as_drawn_they_are_the_contacts_of_the_drawing() -> None:
    stones = derive_blocks(wall(length=2.4, height=1.2, thickness=0.4, brick=(0.6, 0.4, 0.3)))
    contacts = find_contacts(stones)
    point, gap, _ = found(stones)
    order, other = (np.lexsort(np.round(p, 6).T) for p in (point, contacts.point))
    assert point[order] == pytest.approx(contacts.point[other], abs=1e-9)
    assert np.abs(gap).max() < 1e-9


def test_no_joint_is_lost_whichever_way_the_stones_are_turned() -> None:
    # Two stones of an apse, one beside the other, whose edges are nearly collinear: of some two turns in a hundred GEOS gives the
    # crossings of the edges alone, and not the half of a face that both stones have in common.
    lower, upper = (np.array(outline) for outline in (FIRST, SECOND))
    for angle in np.linspace(0.0, 2 * np.pi, 150):
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        (points, faces), (beside, others) = prism(lower @ turn.T, 1.0), prism(upper @ turn.T, 1.0)
        stones = Assemblage.from_polyhedra([(points, faces), (beside - np.array([0.0, 1.0, 0.0]), others)], 18e3)
        contacts, *_ = touching(stones, np.zeros(2, dtype=bool), 0.01, 0.01, 1e-3)
        assert contacts.area.sum() == pytest.approx(0.5625, rel=1e-6), angle


@given(st.floats(0.001, 0.2))
@settings(max_examples=20, deadline=None)
def test_edge_on_a_plane_presses_along_the_planes_normal(angle: float) -> None:
    stones = on_ground(box((0, 1), (0, 1), (0, 2)))
    turn = np.array([0, angle, 0])
    tilted = moved(stones, np.array([*np.cross(turn, stones.centroid[1] - [1, 0, 0]), *turn]))
    point, gap, normal = found(tilted, reach=0.5)
    hinge = np.abs(gap) < 1e-9
    assert hinge.sum() == 2
    assert point[hinge][:, [0, 2]] == pytest.approx(np.array([[1.0, 0.0], [1.0, 0.0]]), abs=1e-9)
    assert normal[hinge] == pytest.approx(np.array([[0, 0, 1.0]] * 2), abs=1e-9)
    assert gap[~hinge] == pytest.approx(np.sin(angle), rel=1e-2)


@pytest.mark.parametrize(("lift", "points"), [(0.04, 4), (0.06, 0), (-0.04, 4), (-0.06, 0)])
def test_reach_and_depth(lift: float, points: int) -> None:
    stones = moved(on_ground(box((0, 1), (0, 1), (0, 2))), np.array([0, 0, lift, 0, 0, 0]))
    _, gap, _ = found(stones)
    assert len(gap) == points
    assert gap == pytest.approx(lift)


def test_what_a_drawing_leaves_open_counts_as_closed_and_goes_with_the_stones() -> None:
    stones = on_ground(box((0, 1), (0, 1), (0.002, 1)), box((0, 1), (0, 1), (1, 2)))
    contacts = find_contacts(stones, 0.003)
    poses = start_poses(stones)
    joints = first_joints(contacts, stones, poses, 0.05)
    assert joints.at(poses)[1] == pytest.approx(0.0, abs=1e-12)
    twist = np.zeros((3, 6))
    twist[1:, 0] = 0.1
    slid = poses.moved(twist)
    again = renewed(joints, displaced(stones, slid), slid, np.zeros(3, dtype=bool), 0.05, 0.0)
    assert len(again.first) == 8
    assert again.at(slid)[1] == pytest.approx(0.0, abs=1e-9)


def test_stones_that_came_to_bear_on_each_other_on_the_way_still_do_where_a_path_goes_on() -> None:
    """They may have sunk deeper into each other than stones that were not seen to touch."""
    stones = on_ground(box((0, 1), (0, 1), (0, 1)), box((1.05, 2.05), (0, 1), (0, 1)))
    contacts, load = find_contacts(stones), LoadCase((1, 0, 0))
    model = moving_model(
        stones, contacts, load, live_loads(stones, load), 0.6, equilibrium(stones, contacts, load), ~stones.fixed, 0.05, "auto"
    )

    def nearer(by: float) -> Poses:
        twist = np.zeros((3, 6))
        twist[1, 0] = by
        return start_poses(stones).moved(twist)

    touch, sunk = nearer(0.05), nearer(0.05 + 0.75 * model.reach)
    pairs = [state_at(model, way, ()).joints.pair.tolist() for way in ([sunk], [touch, sunk])]
    assert [[1, 2] in pair or [2, 1] in pair for pair in pairs] == [False, True]
