"""From buildings to stones: the counts and weights of S22 and S5, volumes, names, shared corners."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from churchpipe.bond.voussoir import ring_outline
from churchpipe.errors import InputError
from churchpipe.generators import box, chapel, prototype, wall, with_buttresses
from churchpipe.model.building import BondRegion, Building, CylinderChart, Opening, Panel, PlaneChart, Support, UnitCell
from churchpipe.model.buttress import Buttress
from churchpipe.model.materials import Material
from churchpipe.stones.blocks import derive_blocks
from churchpipe.stones.contacts import find_contacts
from churchpipe.stones.soundness import floating_stones, overlapping_stones
from models import S5, S22

MATERIAL = Material("default", 18e3, 0.6)
CELL = UnitCell(a=0.275, b=0.57)


def free(stones):
    return int((~stones.fixed).sum())


@pytest.mark.parametrize(
    ("parameters", "stones", "points", "weight"),
    [
        (S5, 326, 3684, 864.864),
        (S5 | {"first_course": "partitions"}, 325, 3676, 864.864),
        (S22, 869, 9660, 2289.8304),
    ],
    ids=["S5", "S5, parity swapped", "S22"],
)
def test_the_prototypes_come_out_stone_by_stone(parameters, stones, points, weight):
    found = derive_blocks(prototype(**parameters))
    assert free(found) == stones
    assert found.weight.sum() == pytest.approx(weight, rel=1e-9)
    assert len(find_contacts(found).point) == points


@pytest.mark.parametrize("b", [0.04, 0.06])
@pytest.mark.parametrize("base", [S5, S22], ids=["S5", "S22"])
@pytest.mark.parametrize("joints", ["grid", "bay"])
def test_other_bricks_fill_the_same_walls(b, base, joints):
    stones = derive_blocks(prototype(**(base | {"brick": (b, 0.04, 0.03), "joints": joints})))
    expected = derive_blocks(prototype(**base))
    assert stones.volume.sum() == pytest.approx(expected.volume.sum(), rel=1e-12)
    width = np.array([np.ptp(stones.points[i:j], axis=0).max() for i, j in _point_ranges(stones)])[~stones.fixed]
    assert width.min() >= b / 4
    assert not len(overlapping_stones(stones))
    assert not len(floating_stones(stones, find_contacts(stones)))


def test_a_header_no_longer_than_the_wall_is_thick_keeps_the_corner_bonded():
    # With b = 40 through joints lie at 20 + 40 k: no stone ends at the inner face of the corner on every course.
    stones = derive_blocks(prototype(**(S5 | {"brick": (0.04, 0.04, 0.03)})))
    corner = (stones.centroid[:, 0] < 0.06) & (stones.centroid[:, 1] < 0.06) & ~stones.fixed
    reach = np.array([stones.points[i:j].max(axis=0) for i, j in _point_ranges(stones)])
    for course in range(21):
        ends = reach[corner & (stones.course == course)][:, :2]
        assert (np.abs(ends - 0.04) > 1e-9).any(axis=1).any(), course


def test_a_free_wall_of_four_bricks():
    stones = derive_blocks(wall(length=0.32, brick=(0.08, 0.04, 0.03), courses=5))
    assert free(stones) == 3 * 4 + 2 * 5
    assert stones.volume[~stones.fixed].sum() == pytest.approx(0.32 * 0.04 * 0.15, rel=1e-12)


def test_names_panels_and_courses():
    stones = derive_blocks(prototype(**S22))
    assert stones.block_id[0] == "ground"
    assert stones.fixed.tolist() == [True] + [False] * 869
    third = stones.block_id == "main-03-007"
    # Course 3 is cut: six stones from 40 to 520, then 560..600 behind the second partition, 600..680 is number 7.
    np.testing.assert_allclose(stones.centroid[third][0], [0.64, 0.02, 0.105], rtol=1e-12)
    assert stones.panel[third][0] == "main"
    assert stones.course[third][0] == 3
    assert set(stones.panel) == {"ground", "main", "partition-1", "partition-2", "partition-3"}
    lintel = np.flatnonzero(np.isclose(stones.volume, 0.24 * 0.04 * 0.03))
    assert stones.course[lintel].tolist() == [15, 15, 15]


def test_corners_are_shared_to_the_last_digit():
    stones = derive_blocks(prototype(**S22))
    points = stones.points[stones.block_point_ptr[1] :]
    for axis in range(3):
        assert np.diff(np.unique(points[:, axis])).min() > 0.01


def test_the_ground_plate_reaches_well_beyond_the_plan():
    stones = derive_blocks(replace(wall(length=2.0, brick=(0.4, 0.2, 0.1), courses=10), ground=0.0))
    plate = stones.points[:8]
    assert plate[:, 2].max() == 0.0
    assert plate[:, 0].min() < -1.0
    assert plate[:, 0].max() > 3.0
    assert stones.weight[0] == 0.0


def test_supports_are_fixed_stones_and_ground_may_be_absent():
    body = Support(
        "pier",
        np.array([[x, y, z] for z in (-1.0, 0.0) for x, y in ((0, 0), (1, 0), (1, 0.2), (0, 0.2))]),
        ((3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
    )
    stones = derive_blocks(replace(wall(length=1.0, brick=(0.4, 0.2, 0.1), courses=2), ground=None, supports=(body,)))
    assert stones.block_id[stones.fixed].tolist() == ["pier"]
    assert stones.panel[0] == "pier"
    assert stones.volume[0] == pytest.approx(0.2)
    assert not len(floating_stones(stones, find_contacts(stones)))


@settings(max_examples=25, deadline=None)
@given(
    length=st.floats(2.2, 6.0),
    width=st.floats(2.2, 6.0),
    thickness=st.floats(0.3, 0.9),
    brick=st.floats(0.25, 0.8),
    courses=st.integers(1, 6),
    joints=st.sampled_from(["grid", "bay"]),
)
def test_any_box_is_filled_once(length, width, thickness, brick, courses, joints):
    building = box(length=length, width=width, thickness=thickness, brick=(brick, thickness, 0.2), courses=courses, joints=joints)
    stones = derive_blocks(building)
    plan = length * width - (length - 2 * thickness) * (width - 2 * thickness)
    assert stones.volume[~stones.fixed].sum() == pytest.approx(plan * 0.2 * courses, rel=1e-9)
    assert not len(overlapping_stones(stones))
    assert not len(floating_stones(stones, find_contacts(stones)))


def _church() -> Building:
    """A gabled front with an arched door and a round window, toothed into two lower side walls."""
    length, eaves, ridge, t = 6.5, 3.3, 6.0, 0.9
    door_ring = ring_outline((3.25, 1.1), 0.6, 1.05, 0.0, math.pi, 9)
    door = np.concatenate([[[2.65, 0.0], [3.85, 0.0]], door_ring[:9:-1]])
    halves = [ring_outline((3.25, 3.6), 0.5, 0.85, start, start + math.pi, 7) for start in (0.0, math.pi)]
    window = np.concatenate([half[:7:-1][:-1] for half in halves])
    gable = np.array([[0, 0], [length, 0], [length, eaves], [length / 2, ridge], [0, eaves]])
    rings = (
        BondRegion("door-ring", door_ring, "voussoir", UnitCell(0.3, 0.45), centre=(3.25, 1.1), pieces=9),
        BondRegion("upper-ring", halves[0], "voussoir", UnitCell(0.3, 0.35), centre=(3.25, 3.6), pieces=7),
        BondRegion("lower-ring", halves[1], "voussoir", UnitCell(0.3, 0.35), centre=(3.25, 3.6), pieces=7),
    )
    front = Panel(
        "front",
        PlaneChart(np.array([0.0, t / 2, 0.0]), np.array([1.0, 0.0, 0.0])),
        gable,
        t,
        (BondRegion("bond", gable, "running", CELL, joints="bay"), *rings),
        openings=(Opening("door", door), Opening("window", window)),
        runs_through=0,
    )
    side = np.array([[0, 0], [5, 0], [5, eaves], [0, eaves]])
    sides = [
        Panel(
            name,
            PlaneChart(np.array([x, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])),
            side,
            t,
            (BondRegion("bond", side, "running", CELL, joints="bay"),),
            runs_through=1,
        )
        for name, x in (("left", t / 2), ("right", length - t / 2))
    ]
    return Building("church", (front, *sides), (MATERIAL,))


def test_gables_arches_and_round_windows_are_laid():
    stones = derive_blocks(_church())
    half_door = 0.5 * 9 * 0.6**2 * math.sin(math.pi / 9)
    window = 0.5 * 14 * 0.5**2 * math.sin(math.pi / 7)
    front = 6.5 * 3.3 + 0.5 * 6.5 * 2.7 - 1.2 * 1.1 - half_door - window
    assert stones.volume[~stones.fixed].sum() == pytest.approx(0.9 * (front + 2 * 4.1 * 3.3), rel=1e-9)
    assert (stones.course == -1).sum() == 1 + 9 + 14
    assert "front-door-ring-008" in stones.block_id
    assert stones.volume[~stones.fixed].min() > 0.25 * 0.9 * CELL.a * CELL.b
    contacts = find_contacts(stones)
    assert not len(overlapping_stones(stones))
    assert not len(floating_stones(stones, contacts))


def test_rings_that_overlap_are_an_error():
    church = _church()
    front = church.panels[0]
    lower = ring_outline((3.25, 2.0), 0.6, 1.05, 0.0, math.pi, 9)
    clash = (*front.regions, BondRegion("clash", lower, "voussoir", UnitCell(0.3, 0.45), centre=(3.25, 2.0), pieces=9))
    with pytest.raises(InputError, match=r"wall front, lower-ring: the ring touches a junction .*another ring.*m up"):
        derive_blocks(replace(church, panels=(replace(front, regions=clash), *church.panels[1:])))


def test_what_cuts_a_ring_is_said_with_its_place():
    """The buttress stands from y = 3.1 to 3.9, .5 m off the end of the wall; the ring of the window ends at y = 3.2."""
    window = {"name": "window", "wall": "nave_left", "centre": 2.5, "width": 0.7, "springing": 2.4, "voussoirs": 7, "depth": 0.35}
    nave = chapel(course=0.4, stone_length=0.8, width=6.0, length=9.0, height=4.0, thickness=1.0, openings=[window])
    building = with_buttresses(nave, [Buttress("nave_left", [4.0], toward="-x", width=0.8, depth=1.0)])
    with pytest.raises(
        InputError,
        match=r"away, from 3\.1 to 3\.2 m along the wall and from 2.4 to .* m up, counted from x = -2\.5, y = 0 m towards \+y",
    ):
        derive_blocks(building)


def test_a_lintel_that_reaches_into_a_junction_is_an_error():
    # On course 0 the main wall owns the corner y < .04, where this lintel would bear; on course 15 the partition does.
    door = {"start": 0.06, "width": 0.1, "height_courses": 14, "lintel_bearing": 0.04}
    with pytest.raises(InputError, match="wall partition-1, lintel-1: an opening, a junction or the end of the wall cuts"):
        derive_blocks(prototype(**(S5 | {"opening": door})))
    assert derive_blocks(prototype(**(S5 | {"opening": door | {"height_courses": 15}}))).count > 300


def test_masonry_below_the_ground_is_an_error():
    with pytest.raises(InputError, match=r"masonry below the ground; found z = 0 m; expected z >= 0\.1 m"):
        derive_blocks(replace(wall(length=1.0, brick=(0.2, 0.1, 0.05), courses=4), ground=0.1))


def test_a_building_without_walls_is_an_error():
    with pytest.raises(InputError, match="no walls"):
        derive_blocks(Building("none", (), (MATERIAL,)))


def test_a_part_of_a_wall_without_a_bond_is_an_error():
    building = wall(length=1.0, brick=(0.2, 0.1, 0.05), courses=4)
    panel = building.panels[0]
    half = replace(panel.regions[0], outline=np.array([[0, 0], [0.5, 0], [0.5, 0.2], [0, 0.2]]))
    with pytest.raises(
        InputError, match=r"the stones do not fill the walls exactly; found 0\.01 m3 of stones; expected 0\.02 m3"
    ):
        derive_blocks(replace(building, panels=(replace(panel, regions=(half,)),)))


@pytest.mark.parametrize(
    ("outline", "flaw"), [([[0, 0], [1, 1], [1, 0], [0, 1]], "Self-intersection"), ([[0, 0], [1, 0], [2, 0]], "")]
)
def test_outlines_that_are_no_polygons_are_an_error(outline, flaw):
    building = wall(length=1.0, brick=(0.2, 0.1, 0.05), courses=4)
    with pytest.raises(InputError, match=f"wall wall: outline of wall: not a simple polygon; found .*{flaw}"):
        derive_blocks(replace(building, panels=(replace(building.panels[0], outline=np.array(outline, dtype=float)),)))


@pytest.mark.parametrize("turn", [math.pi, 2 * math.pi], ids=["apse", "round tower"])
def test_curved_walls_fit_face_to_face(turn):
    length = 1.7 * turn
    outline = np.array([[0, 0], [length, 0], [length, 2.75], [0, 2.75]])
    bond = BondRegion("bond", outline, "running", UnitCell(0.275, length / 10))
    window = Opening("window", np.array([[1.9, 0.55], [2.4, 0.55], [2.4, 1.1], [1.9, 1.1]]))
    panel = Panel("apse", CylinderChart(np.zeros(3), 1.7), outline, 0.9, (bond,), openings=(window,))
    stones = derive_blocks(Building("apse", (panel,), (MATERIAL,)))
    contacts = find_contacts(stones)
    assert not len(overlapping_stones(stones))
    assert not len(floating_stones(stones, contacts))
    # Neighbours in a course meet in one upright radial face; around the tower the first stone meets the last.
    lowest = np.flatnonzero((stones.course == 0) & ~stones.fixed)
    heads = (contacts.kind == "head") & np.isin(contacts.blocks, lowest).all(axis=1)
    assert heads.sum() == len(lowest) - (turn < 2 * math.pi)
    np.testing.assert_allclose(contacts.area[heads], 0.9 * 0.275, rtol=1e-9)


@pytest.mark.parametrize(("joints", "through"), [("grid", 0.0), ("bay", 0.0)])
def test_a_round_tower_has_no_seam(joints, through):
    length = 1.7 * 2 * math.pi
    outline = np.array([[0, 0], [length, 0], [length, 2.2], [0, 2.2]])
    bond = BondRegion("bond", outline, "running", UnitCell(0.275, length / 16), joints=joints, through_offset=through)
    # A window across the seam, off the joints: its jambs break the curve where the whole courses have no joint.
    windows = (
        Opening("left", np.array([[0, 0.55], [0.3, 0.55], [0.3, 1.1], [0, 1.1]])),
        Opening("right", np.array([[length - 0.4, 0.55], [length, 0.55], [length, 1.1], [length - 0.4, 1.1]])),
    )
    panel = Panel("tower", CylinderChart(np.zeros(3), 1.7), outline, 0.9, (bond,), openings=windows)
    stones = derive_blocks(Building("tower", (panel,), (MATERIAL,)))
    contacts = find_contacts(stones)
    assert not len(overlapping_stones(stones))
    assert not len(floating_stones(stones, contacts))
    # Sixteen stones in every whole course, half a stone off from one to the next: no joint above another.
    for course in (0, 1, 4, 5, 6, 7):
        assert (stones.course[~stones.fixed] == course).sum() == 16
    heads = contacts.kind == "head"
    angle = np.arctan2(*contacts.point[contacts.point_ptr[:-1][heads]].T[1::-1]) % (2 * math.pi / 16)
    upper = stones.course[contacts.blocks[heads, 0]]
    even, odd = angle[upper == 0], angle[upper == 1]
    turned = np.abs(even[:, None] - odd[None])
    assert np.minimum(turned, 2 * math.pi / 16 - turned).min() == pytest.approx(math.pi / 16, abs=1e-6)


def _point_ranges(stones):
    return list(zip(stones.block_point_ptr[:-1], stones.block_point_ptr[1:], strict=True))
