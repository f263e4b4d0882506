"""Contact detection: every interface once, whatever the orientation, order or shape of the stones."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from churchpipe.config.case import read_case
from churchpipe.errors import InputError
from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import TOUCHING, ContactTolerances, NearMisses
from churchpipe.stones.blocks import derive_blocks
from churchpipe.stones.contacts import find_contacts
from churchpipe.stones.coplanar import coplanar_interfaces
from churchpipe.stones.interfaces import contacts_of
from churchpipe.stones.soundness import check_soundness
from imprecise import corner, dome, joined_pairs, noisy, rounded, tilted, triangulated, turned_wall, voussoir_arch
from solids import box, moved, on_ground, prism

CASES = Path(__file__).parents[3] / "pipeline" / "cases"


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


def test_the_contact_gap_decides() -> None:
    stones = on_ground(box((0, 1), (0, 1), (0, 1)), box((0, 1), (0, 1), (1.004, 2)))
    assert len(find_contacts(stones, contact_gap=0.003).blocks) == 1
    assert len(find_contacts(stones, contact_gap=0.005).blocks) == 2
    # A hairline for stones a metre thick: joined, and told.
    proposed = find_contacts(stones)
    assert proposed.gap.max(axis=1).tolist() == pytest.approx([0.0, 0.004])
    assert proposed.tolerances.given == ()


def test_touching_along_an_edge_is_no_contact() -> None:
    assert len(find_contacts(on_ground(box((0, 1), (0, 1), (0, 1)), box((1, 2), (0, 1), (1, 2)))).blocks) == 1


def test_faces_on_the_same_side_are_no_contact() -> None:
    # Two stones on the ground, one in front of the other: their bottoms are coplanar but look the same way.
    contacts = find_contacts(on_ground(box((0, 1), (0, 1), (0, 1)), box((3, 4), (0, 1), (0, 1))))
    assert sorted(contacts.kind.tolist()) == ["base", "base"]


def test_tolerance_must_be_positive() -> None:
    with pytest.raises(InputError, match="contact_gap"):
        find_contacts(running_wall(1, 2), contact_gap=0.0)


def test_a_gap_equal_to_the_joint_finds_all_joints() -> None:
    # .005 wide as drawn, some joints 1e-15 more as computed.
    stones = on_ground(*[box((0, 1), (0, 1), (0.105 * i + 0.005, 0.105 * i + 0.105)) for i in range(20)])
    assert len(find_contacts(stones, contact_gap=0.005).blocks) == 20


def test_a_face_without_area_is_left_out() -> None:
    # The middle of an edge is drawn on one side of it only; a triangle without area closes the solid.
    points, _ = box((0, 1), (0, 1), (0, 1))
    points = np.vstack([points, [1.0, 0.5, 1.0]])
    faces = [[0, 1, 3, 2], [4, 6, 7, 8, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3], [5, 8, 7]]
    assert len(find_contacts(on_ground((points, faces), box((1, 2), (0, 1), (0, 1)))).blocks) == 3


@pytest.mark.filterwarnings("error")
def test_a_face_whose_corners_are_one_point_is_left_out() -> None:
    # A corner chipped by a thousand-millionth of a metre, written with six decimals.
    points, _ = box((0, 1), (0, 1), (0, 1))
    points = np.round(np.vstack([points[:7], points[7] - 1e-9 * np.eye(3)]), 6)
    faces = [[0, 1, 3, 2], [4, 6, 9, 8, 5], [0, 4, 5, 1], [2, 3, 7, 9, 6], [0, 2, 6, 4], [1, 5, 8, 7, 3], [7, 8, 9]]
    assert len(find_contacts(on_ground((points, faces), box((0, 1), (0, 1), (1, 2)))).blocks) == 2


@pytest.mark.parametrize(
    "name",
    [
        "s22",
        "apse_window",
        *(pytest.param(name, marks=pytest.mark.slow("docs/contacts.md: exact stones")) for name in ("church", "round_tower")),
    ],
)
def test_exact_stones_give_the_joints_in_one_plane_to_the_last_bit(name: str) -> None:
    stones = derive_blocks(read_case(CASES / f"{name}.toml").building())
    faces = np.ones(len(stones.face_ptr) - 1, dtype=np.bool_)
    strict = coplanar_interfaces(stones, faces, TOUCHING)
    owner = np.repeat(np.arange(stones.count), np.diff(stones.block_face_ptr))
    expected = contacts_of(stones, owner, strict, NearMisses(), ContactTolerances())
    found = find_contacts(stones)
    for field in ("blocks", "frame", "area", "point", "point_ptr", "kind"):
        assert np.array_equal(getattr(found, field), getattr(expected, field)), field
    assert not len(found.near_misses)


ASSEMBLIES = {"arch": voussoir_arch(), "wall": turned_wall(), "corner": corner(), "dome": dome()}
IMPRECISE = {
    "triangles": triangulated,
    "noise": lambda stones: noisy(stones, 2e-4, seed=100),
    "tilt": lambda stones: tilted(stones, np.radians(0.3), seed=100),
    "rounded": lambda stones: rounded(stones, 3),
}


@pytest.mark.parametrize("change", IMPRECISE)
@pytest.mark.parametrize("name", ASSEMBLIES)
def test_imprecise_stones_have_the_joints_of_the_exact_ones(name: str, change: str) -> None:
    exact, found = find_contacts(ASSEMBLIES[name]), find_contacts(IMPRECISE[change](ASSEMBLIES[name]))
    assert joined_pairs(found.blocks.tolist()) == joined_pairs(exact.blocks.tolist())
    assert len(exact.point) <= len(found.point) <= 1.01 * len(exact.point)
    assert found.area.sum() == pytest.approx(exact.area.sum(), rel=0.02)
    assert not len(found.near_misses)


@pytest.mark.parametrize(("gap", "joints", "near"), [(1e-5, 146, 0), (1e-3, 146, 0), (0.01, 98, 48), (0.02, 98, 48)])
def test_open_head_joints_are_closed_or_told(gap: float, joints: int, near: int) -> None:
    found = find_contacts(corner(head_gap=gap))
    assert (len(found.blocks), len(found.near_misses)) == (joints, near)
    assert found.near_misses.gap.max(initial=0.0) == pytest.approx(gap if near else 0.0)
    asked_for = find_contacts(corner(head_gap=gap), contact_gap=gap)
    assert (len(asked_for.blocks), len(asked_for.near_misses)) == (146, 0)
    assert asked_for.tolerances.given == ("contact_gap",)


def test_beds_open_by_rounding_are_joints() -> None:
    # Seven digits of a bridge: beds open by 1.95e-6 m.
    stones = on_ground(box((0, 1), (0, 1), (0, 1)), box((0, 1), (0, 1), (1 + 1.95e-6, 2)))
    assert len(find_contacts(stones).blocks) == 2


def test_a_hairline_over_a_small_part_of_a_bed_is_closed() -> None:
    # The stone on the right bears on its neighbour, and by a twentieth of a face on the stone .05 mm below it.
    rounding = 5e-5
    below = box((0, 2), (0, 1), (0, 1)), box((2.05, 4), (0, 1), (0, 1 + rounding))
    stones = on_ground(*below, box((0, 1.9), (0, 1), (1, 2)), box((1.9, 4), (0, 1), (1 + rounding, 2)))
    found = find_contacts(stones)
    assert found.blocks.tolist() == [[0, 1], [0, 2], [1, 3], [1, 4], [2, 4], [3, 4]]
    assert found.area[3] == pytest.approx(0.1)


def test_one_bed_that_leans_keeps_its_joints() -> None:
    stones = on_ground(box((0, 1), (0, 1), (0, 1)), prism([(0, 1), (1, 1 + math.tan(math.radians(0.3))), (1, 2), (0, 2)], 1.0))
    found = find_contacts(stones)
    assert found.blocks.tolist() == [[0, 1], [1, 2]]
    assert found.angle.max() == pytest.approx(math.radians(0.3))


def test_wedges_that_touch_at_an_edge_and_gape_are_near_misses_unless_asked_for() -> None:
    # Blocks .25 m thick: 1.5 degrees over .5 m open 13 mm, past twice the widest proposal of 5 mm.
    rise = 0.5 * math.tan(math.radians(1.5))
    wedge = prism([(0, 0.25), (0.5, 0.25 + rise), (0.5, 0.5), (0, 0.5)], 0.25)
    stones = on_ground(box((0, 0.5), (0, 0.25), (0, 0.25)), wedge)
    found = find_contacts(stones)
    assert found.blocks.tolist() == [[0, 1]]
    assert found.near_misses.stones.tolist() == [[1, 2]]
    assert find_contacts(stones, contact_gap=1e-3).blocks.tolist() == [[0, 1], [1, 2]]


def test_what_a_nearer_stone_hides_is_no_joint() -> None:
    # A tile 5 mm thick lies on half of a block; another block stands on it.
    tile = box((0, 0.25), (0, 0.25), (0.25, 0.255))
    stones = on_ground(box((0, 0.5), (0, 0.25), (0, 0.25)), tile, box((0, 0.5), (0, 0.25), (0.255, 0.5)))
    found = find_contacts(stones, contact_gap=0.012)
    behind = (found.blocks == [1, 3]).all(axis=1)
    assert found.area[behind].tolist() == pytest.approx([0.25 * 0.25])
    assert np.abs(found.point[found.point_ptr[:-1][behind][0] :][:4, 0]).min() == pytest.approx(0.25)


def test_a_stone_that_lies_on_a_fold_beside_a_wedge_is_joined_to_both() -> None:
    # The top of the lowest stone falls by 4 degrees from x = 2 on; a wedge levels the rest, and a stone lies on both.
    slope = math.tan(math.radians(4.0))
    base = prism([(0, -0.5), (2.3, -0.5), (2.3, -0.3 * slope), (2, 0), (0, 0)], 1.0)
    wedge = prism([(0, 0), (2, 0), (0, 2 * slope)], 1.0)
    top = prism([(0, 2 * slope), (2.3, -0.3 * slope), (2.3, 0.6), (0, 0.6)], 1.0)
    found = find_contacts(triangulated(Assemblage.from_polyhedra([base, wedge, top], 18e3, fixed=[0])))
    assert found.blocks.tolist() == [[0, 1], [0, 2], [1, 2]]
    assert found.area == pytest.approx([2.0, 0.3 / math.cos(math.atan(slope)), 2.0 / math.cos(math.atan(slope))], rel=0.01)


@pytest.mark.parametrize(("below", "above"), [(20, 20), (20, 29), (24, 31)])
def test_a_curved_joint_meshed_differently_on_both_sides(below: int, above: int) -> None:
    def arc(pieces: int) -> list[tuple[float, float]]:
        return [(math.cos(a), math.sin(a)) for a in np.linspace(0.25 * math.pi, 0.75 * math.pi, pieces + 1)]

    side = math.sqrt(0.5)
    lower, upper = (
        prism([*arc(below), (-side, 0.2), (side, 0.2)], 0.5),
        prism([*arc(above)[::-1], (side, 1.4), (-side, 1.4)], 0.5),
    )
    found = find_contacts(triangulated(Assemblage.from_polyhedra([lower, upper], 18e3, fixed=[0])))
    assert found.area.sum() == pytest.approx(0.5 * math.pi * 0.5, rel=0.005)
    assert not len(found.near_misses)


def test_a_contact_gap_wider_than_the_stones_finds_no_near_misses_through_them() -> None:
    stones = on_ground(box((0, 1), (0, 1), (0, 2)), box((0, 1), (0, 1), (2, 4)))
    contacts = find_contacts(stones, contact_gap=100.0)
    assert len(contacts.blocks) == 2
    assert len(contacts.near_misses) == 0


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    ("place", "changed"),
    [
        # A corner that rounding put on the diagonal of a bed cut into triangles: one of them has no area.
        ((0.5, 0.5, 1.0), {4: [[0, 2, 6], [0, 6, 8], [8, 6, 4], [0, 8, 4]]}),
        # A corner in the middle of an edge: the first three corners of the bed lie in one line.
        ((0.0, 0.5, 1.0), {4: [[0, 8, 2, 6, 4]], 0: [[0, 1, 3, 2, 8]]}),
    ],
)
def test_corners_in_one_line_change_no_joint(place: tuple[float, float, float], changed: dict[int, list[list[int]]]) -> None:
    points, faces = box((0, 1), (0, 1), (1, 2))
    made = [face for number, one in enumerate(faces) for face in changed.get(number, [one])]
    stones = on_ground(box((0, 1), (0, 1), (0, 1)), (np.vstack([points, place]), made))
    contacts = find_contacts(stones)
    assert [float(contacts.area[contacts.blocks[:, 0] == first].sum()) for first in (0, 1)] == pytest.approx([1.0, 1.0])
    check_soundness(stones, contacts)
