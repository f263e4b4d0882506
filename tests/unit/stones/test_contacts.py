"""Contact detection: every interface once, whatever the orientation, order or shape of the stones."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from churchpipe.errors import InputError
from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.stones.contacts import find_contacts
from solids import box, moved, on_ground, prism


def running_wall(courses: int, bricks: int) -> Assemblage:
    stones = []
    for c in range(courses):
        shift = 0.5 * (c % 2)
        stones += [box((i + shift, i + 1 + shift), (0, 0.5), (0.4 * c, 0.4 * c + 0.4)) for i in range(bricks)]
    return on_ground(*stones)


def test_running_bond_counts_and_kinds() -> None:
    contacts = find_contacts(running_wall(3, 4))
    kinds, counts = np.unique(contacts.kind, return_counts=True)
    # Per course 3 head joints; between courses 4 whole bricks lie on 7 halves; 4 bricks on the ground.
    assert dict(zip(kinds.tolist(), counts.tolist(), strict=True)) == {"base": 4, "bed": 14, "head": 9}
    assert (contacts.points_per_interface == 4).all()
    assert contacts.area[contacts.kind == "bed"] == pytest.approx(0.25)


def test_normal_points_from_the_first_stone_to_the_second() -> None:
    stones = running_wall(4, 3)
    contacts = find_contacts(stones)
    middle = np.add.reduceat(contacts.point, contacts.point_ptr[:-1]) / contacts.points_per_interface[:, None]
    for side, sign in ((0, -1), (1, 1)):
        reach = np.einsum("ij,ij->i", stones.centroid[contacts.blocks[:, side]] - middle, contacts.frame[:, 0])
        assert (sign * reach > 0).all()


@settings(max_examples=25, deadline=None)
@given(
    angles=st.tuples(*[st.floats(-3.2, 3.2)] * 3),
    shift=st.tuples(*[st.floats(-500, 500)] * 3),
    scale=st.floats(0.05, 20),
)
def test_contacts_are_the_same_in_any_frame(angles: tuple[float, ...], shift: tuple[float, ...], scale: float) -> None:
    stones = running_wall(4, 4)
    here = find_contacts(stones)
    turn: FloatArray = Rotation.from_euler("xyz", angles).as_matrix()
    there = find_contacts(moved(stones, turn, np.array(shift), scale))
    assert {tuple(sorted(pair)) for pair in here.blocks.tolist()} == {tuple(sorted(pair)) for pair in there.blocks.tolist()}
    assert len(here.point) == len(there.point)
    assert there.area.sum() == pytest.approx(here.area.sum() * scale**2, rel=1e-6)


@settings(max_examples=50, deadline=None)
@given(
    left=st.floats(-0.9, 0.9),
    width=st.floats(0.2, 2.0),
    depth=st.floats(0.2, 2.0),
)
def test_area_of_two_overlapping_rectangles(left: float, width: float, depth: float) -> None:
    lower, upper = box((0, 1), (0, 1), (0, 1)), box((left, left + width), (0, depth), (1, 2))
    overlap = max(0.0, min(1, left + width) - max(0, left)) * min(1, depth)
    contacts = find_contacts(Assemblage.from_polyhedra([lower, upper], 1.0, fixed=[0]))
    if overlap < 1e-5:
        assert len(contacts.blocks) <= 1
    else:
        assert contacts.area.tolist() == pytest.approx([overlap], rel=1e-9)


def test_several_interfaces_between_one_pair() -> None:
    # A table on a block: two feet, two interfaces.
    table = prism([(0, 1), (0.3, 1), (0.3, 1.2), (0.7, 1.2), (0.7, 1), (1, 1), (1, 1.5), (0, 1.5)], 1.0)
    contacts = find_contacts(on_ground(box((0, 1), (0, 1), (0, 1)), table))
    feet = (contacts.blocks == [1, 2]).all(axis=1) | (contacts.blocks == [2, 1]).all(axis=1)
    assert contacts.area[feet].tolist() == pytest.approx([0.3, 0.3])


def test_non_convex_overlap_becomes_its_hull_and_straight_corners_go() -> None:
    # An L-shaped foot of one stone on the flat top of another: six corners, five on the hull, whose area is .82.
    ell = np.array([(0, 0), (1, 0), (1, 0.4), (0.4, 0.4), (0.4, 1), (0, 1)], dtype=float)
    points = np.vstack([np.column_stack([ell, np.full(6, z)]) for z in (1.0, 2.0)])
    faces = [list(range(5, -1, -1)), list(range(6, 12)), *[[i, (i + 1) % 6, (i + 1) % 6 + 6, i + 6] for i in range(6)]]
    contacts = find_contacts(on_ground(box((0, 2), (0, 2), (0, 1)), (points, faces)))
    assert contacts.points_per_interface[contacts.kind == "bed"].tolist() == [5]
    assert contacts.area[contacts.kind == "bed"].tolist() == pytest.approx([0.64])


def test_gap_tolerance_decides() -> None:
    stones = on_ground(box((0, 1), (0, 1), (0, 1)), box((0, 1), (0, 1), (1.004, 2)))
    assert len(find_contacts(stones).blocks) == 1
    assert len(find_contacts(stones, gap_tolerance=0.005).blocks) == 2


def test_touching_along_an_edge_is_no_contact() -> None:
    assert len(find_contacts(on_ground(box((0, 1), (0, 1), (0, 1)), box((1, 2), (0, 1), (1, 2)))).blocks) == 1


def test_faces_on_the_same_side_are_no_contact() -> None:
    # Two stones on the ground, one in front of the other: their bottoms are coplanar but look the same way.
    contacts = find_contacts(on_ground(box((0, 1), (0, 1), (0, 1)), box((3, 4), (0, 1), (0, 1))))
    assert sorted(contacts.kind.tolist()) == ["base", "base"]


def test_tolerance_must_be_positive() -> None:
    with pytest.raises(InputError, match="gap_tolerance"):
        find_contacts(running_wall(1, 2), gap_tolerance=0.0)


def test_a_gap_equal_to_the_joint_finds_all_joints() -> None:
    # .005 wide as drawn, some joints 1e-15 more as computed.
    stones = on_ground(*[box((0, 1), (0, 1), (0.105 * i + 0.005, 0.105 * i + 0.105)) for i in range(20)])
    assert len(find_contacts(stones, gap_tolerance=0.005).blocks) == 20


def test_a_face_without_area_is_left_out() -> None:
    # The middle of an edge is drawn on one side of it only; a triangle without area closes the solid.
    points, _ = box((0, 1), (0, 1), (0, 1))
    points = np.vstack([points, [1.0, 0.5, 1.0]])
    faces = [[0, 1, 3, 2], [4, 6, 7, 8, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3], [5, 8, 7]]
    assert len(find_contacts(on_ground((points, faces), box((1, 2), (0, 1), (0, 1)))).blocks) == 3
