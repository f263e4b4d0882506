"""Walls two stones thick: stones fill them once, joints of neighbouring courses keep apart, headers tie the leaves."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from churchpipe.dxf.reader import read_dxf
from churchpipe.dxf.writer import write_dxf
from churchpipe.errors import InputError
from churchpipe.generators import apse, box, chapel, tower, wall
from churchpipe.homogenised_shell.limit import shell_limit_analysis
from churchpipe.homogenised_shell.stiffness import wall_stiffness
from churchpipe.match import match_models
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import Elastic, Material
from churchpipe.recognition.panels import fit_panels
from churchpipe.shell_mesh.shell import derive_shell
from churchpipe.stones.blocks import derive_blocks
from churchpipe.stones.contacts import find_contacts
from sound import laid

PHASES = (Phase.explicit, Phase.generate)
STONE = Material("default", 18e3, 0.6)
# A wall of six stretchers; brickwork's proportions: two leaves as deep as half a stretcher.
WALL = {"length": 3.0, "brick": (0.5, 0.25, 0.2), "courses": 6, "pattern": "header-stretcher", "joints": "bay"}
TOWER = {"course": 0.25, "stone_length": 0.5, "width": 3.0, "depth": 3.2, "height": 4.0, "thickness": 0.6}


def unyielding(building):
    """The building with walls that do not yield: a shell has no strength for this bond, but a mid-surface."""
    panels = tuple(
        replace(panel, regions=tuple(replace(region, yields=False) for region in panel.regions)) for panel in building.panels
    )
    return replace(building, panels=panels)


def reach(stones):
    """Lowest and highest corner of each stone (nb, 2, 3)."""
    pairs = zip(stones.block_point_ptr[:-1], stones.block_point_ptr[1:], strict=True)
    return np.array([[stones.points[i:j].min(axis=0), stones.points[i:j].max(axis=0)] for i, j in pairs])


def in_course(stones, course):
    """Stones of a wall along x in one course as rows x0, x1, y0, y1, in millimetres."""
    low, high = reach(stones)[stones.course == course].transpose(1, 0, 2)
    rows = np.round(1e3 * np.stack([low[:, 0], high[:, 0], low[:, 1], high[:, 1]], axis=1)).astype(int)
    return rows[np.lexsort((rows[:, 2], rows[:, 0]))].tolist()


def test_english_bond_stone_by_stone():
    stones, contacts = laid(wall(**WALL))
    halves = [(0, 250), (250, 500)]
    ends = [0, 250, 750, 1250, 1750, 2250, 2750, 3000]
    assert in_course(stones, 0) == [[a, b, *half] for a, b in itertools.pairwise(ends) for half in halves]
    ends = [0, *range(375, 2626, 250), 3000]
    assert in_course(stones, 1) == [[a, b, 0, 500] for a, b in itertools.pairwise(ends)]
    # Stretcher courses: 7 joints between the leaves, 6 across each leaf; header courses: 10 head joints; each of the 5 beds:
    # every interval between joints of either course, in both leaves.
    between = np.abs(contacts.frame[:, 0, 1]) > 0.5
    assert between.sum() == 3 * 7
    np.testing.assert_allclose(contacts.area[between], np.tile([0.05, *[0.1] * 5, 0.05], 3))
    assert (contacts.kind == "head").sum() == 3 * (7 + 2 * 6) + 3 * 10
    assert (contacts.kind == "bed").sum() == 5 * 2 * (1 + 6 + 10)
    assert (contacts.kind == "base").sum() == 14


def test_flemish_bond_stone_by_stone():
    # Length (1 + 3/2 x 2) b: two periods and a stretcher, stretchers at both ends of even courses, headers of odd ones.
    stones, _ = laid(wall(**(WALL | {"length": 2.0, "headers": "flemish"})))
    joints = [0, 500, 750, 1250, 1500, 2000]
    spans = [(a, b) for a, b in itertools.pairwise(joints)]
    leaves = [[*spans[k], *half] for k in (0, 2, 4) for half in ((0, 250), (250, 500))]
    assert in_course(stones, 0) == sorted(leaves + [[*spans[k], 0, 500] for k in (1, 3)])
    joints = [0, 375, 875, 1125, 1625, 2000]
    spans = [(a, b) for a, b in itertools.pairwise(joints)]
    leaves = [[*spans[k], *half] for k in (1, 3) for half in ((0, 250), (250, 500))]
    assert in_course(stones, 1) == sorted(leaves + [[*spans[k], 0, 500] for k in (0, 2, 4)])


@pytest.mark.parametrize("joints", ["grid", "bay"])
def test_without_headers_there_are_two_walls(joints):
    stones, contacts = laid(wall(**(WALL | {"headers": "none", "joints": joints})))
    low, high = reach(stones)[~stones.fixed].transpose(1, 0, 2)
    assert np.allclose((high - low)[:, 1], 0.25)
    between = np.abs(contacts.frame[:, 0, 1]) > 0.5
    assert contacts.area[between].sum() == pytest.approx(3.0 * 1.2)


@settings(max_examples=12, deadline=None, derandomize=True, phases=PHASES)
@given(
    length=st.floats(1.2, 6.0),
    stone=st.floats(0.3, 0.8),
    depth=st.floats(0.26, 0.95),
    headers=st.sampled_from(["english", "flemish"]),
    rule=st.sampled_from(["grid", "bay"]),
)
def test_vertical_joints_keep_apart(length, stone, depth, headers, rule):
    brick = (stone, depth * stone, 0.2)
    stones, _ = laid(wall(**(WALL | {"length": length, "brick": brick, "courses": 4, "headers": headers, "joints": rule})))
    box_of = reach(stones)
    joints = [np.unique(np.round(box_of[stones.course == course][:, :, 0], 9)) for course in range(4)]
    # A quarter of a stone, which the even division of a bay makes shorter by a third at most.
    for below, above in itertools.pairwise(joints):
        inner = above[(above > 1e-6) & (above < length - 1e-6)]
        apart = np.abs(inner[:, None] - below[(below > 1e-6) & (below < length - 1e-6)])
        assert apart.min(initial=np.inf) > stone / 6 - 1e-9
    # The joint between the leaves never runs through two courses: a header lies over each, but at the end of a grid.
    mid = depth * stone
    low, high = box_of[~stones.fixed].transpose(1, 0, 2)
    course = stones.course[~stones.fixed]
    header = (low[:, 1] < mid - 1e-9) & (high[:, 1] > mid + 1e-9)
    tied = high[:, 0] < length - 1e-9 if rule == "grid" else np.ones(len(high), dtype=bool)
    for i in np.flatnonzero(~header & (course < 3) & tied):
        over = header & (course == course[i] + 1) & (low[:, 0] < high[i, 0] - 1e-9) & (high[:, 0] > low[i, 0] + 1e-9)
        assert over.any()


@settings(max_examples=8, deadline=None, derandomize=True, phases=PHASES)
@given(
    length=st.floats(3.5, 5.0),
    width=st.floats(2.6, 5.0),
    stone=st.floats(0.35, 0.7),
    depth=st.floats(0.26, 0.95),
    headers=st.sampled_from(["english", "flemish", "none"]),
    rule=st.sampled_from(["grid", "bay"]),
)
def test_any_box_is_filled_once_and_bonded(length, width, stone, depth, headers, rule):
    t = 2 * min(depth * stone, 0.5)
    window = {"start": 1.5, "width": 0.5, "sill_courses": 1, "height_courses": 2, "lintel_bearing": 0.1}
    building = box(
        length=length,
        width=width,
        courses=5,
        brick=(stone, t / 2, 0.2),
        pattern="header-stretcher",
        headers=headers,
        joints=rule,
        openings_x=[window],
    )
    stones, _ = laid(building)
    plan = length * width - (length - 2 * t) * (width - 2 * t)
    assert stones.volume[~stones.fixed].sum() == pytest.approx(plan * 1.0 - 2 * t * 0.5 * 0.4, rel=1e-9)


def test_a_corner_stays_bonded():
    # No joint of the wall that runs through lies over a face of the other, nor over the joint between that one's leaves.
    stones, _ = laid(box(length=4.0, width=3.4, courses=2, brick=(0.5, 0.25, 0.2), pattern="header-stretcher", joints="bay"))
    box_of = reach(stones)
    south = box_of[(stones.panel == "south") & (stones.course == 0)]
    inner = np.unique(np.round(south[:, 1, 0], 9))
    assert np.abs(inner[:, None] - [0.25, 0.5]).min() > 0.12


@pytest.mark.parametrize("headers", ["english", "flemish"])
def test_round_trip_through_a_drawing(tmp_path, headers):
    stones, contacts = laid(wall(**(WALL | {"headers": headers}), materials=(STONE,)))
    write_dxf(stones, tmp_path / "wall.dxf", materials=[STONE])
    read, findings = read_dxf(tmp_path / "wall.dxf")
    assert not len(findings)
    order, again = np.argsort(stones.block_id), np.argsort(read.block_id)
    np.testing.assert_allclose(read.centroid[again], stones.centroid[order], atol=1e-12)
    np.testing.assert_allclose(read.volume[again], stones.volume[order], rtol=1e-9)
    assert len(find_contacts(read).point) == len(contacts.point)


@pytest.mark.parametrize("headers", ["english", "flemish", "none"])
def test_the_gate_sees_through_both_leaves(headers):
    building = wall(**(WALL | {"headers": headers}), materials=(STONE,))
    stones, contacts = laid(building)
    shell = derive_shell(unyielding(building), element_size=0.3)
    match = match_models(stones, contacts, shell)
    assert match.passed, [figure for figure in match.figures if not figure.passed]
    thicker = replace(shell, thickness=1.1 * shell.thickness)
    figure = next(f for f in match_models(stones, contacts, thicker).figures if f.name == "thickness")
    assert not figure.passed


@pytest.mark.parametrize("headers", ["english", "flemish", "none"])
@pytest.mark.parametrize("named", [True, False])
def test_no_panel_is_fitted_to_leaves(headers, named):
    stones = derive_blocks(wall(**(WALL | {"headers": headers})))
    if not named:
        stones = replace(stones, panel=np.full_like(stones.panel, ""))
    with pytest.raises(InputError, match="they lie behind one another, as in header-and-stretcher bond"):
        fit_panels(stones)


@pytest.mark.slow
def test_the_shell_takes_its_strength_and_stiffness_from_the_stones():
    shell = derive_shell(wall(**WALL), element_size=0.3)
    assert shell.bonds.tolist() == ["english"]
    elastic = Elastic(10e9, 0.2, 1e9, 0.2, 0.01)
    for bond in ("english", "flemish", "leaves", "stack"):
        assert np.linalg.eigvalsh(wall_stiffness(bond, 0.2, 0.5, 0.5, elastic)).min() > 0
    with pytest.raises(InputError, match="planes: the planes are those of running bond; found paper, and a wall in"):
        shell_limit_analysis(shell, LoadCase((0, 1, 0)), [Material("default", 18e3, 0.6)], planes="paper")


def test_walls_of_a_tower_have_bonds_of_their_own():
    bonds = [
        {"wall": ["front", "left"], "pattern": "header-stretcher", "headers": "flemish", "stone_length": 0.45},
        {"wall": "back", "pattern": "stack"},
    ]
    building = tower(**TOWER, bonds=bonds, materials=(STONE,))
    found = {p.name: (p.regions[0].pattern, p.regions[0].cell.b) for p in building.panels}
    assert found == {
        "front": ("header-stretcher", 0.45),
        "left": ("header-stretcher", 0.45),
        "back": ("stack", 0.5),
        "right": ("running", 0.5),
    }
    stones, _ = laid(building)
    whole = derive_blocks(tower(**TOWER))
    assert stones.volume[~stones.fixed].sum() == pytest.approx(whole.volume[~whole.fixed].sum(), rel=1e-12)


def test_a_thick_chapel_with_door_and_window():
    door = {"name": "door", "wall": "facade", "centre": 0.0, "width": 1.2, "springing": 2.0, "voussoirs": 9, "depth": 0.4}
    side = door | {"name": "w", "wall": ["nave_left", "nave_right"], "centre": 2.5, "width": 0.6, "sill": 1.5, "voussoirs": 7}
    walls = ["facade", "east", "nave_left", "nave_right"]
    building = chapel(
        course=0.25,
        stone_length=0.5,
        width=5.0,
        length=6.0,
        height=4.0,
        thickness=0.8,
        ridge=5.5,
        openings=[door, side],
        bonds=[{"wall": walls, "pattern": "header-stretcher"}],
        materials=(STONE,),
    )
    stones, contacts = laid(building)
    assert match_models(stones, contacts, derive_shell(unyielding(building), element_size=0.4)).passed


MISTAKES = [
    (
        wall,
        WALL | {"thickness": 0.25},
        r"wall\.thickness: header-stretcher bond is two stones thick; found 0\.25 m for .*expected 0\.5 m",
    ),
    (wall, WALL | {"pattern": "stack", "headers": "flemish"}, r"wall\.headers: stack bond has none; found flemish"),
    (wall, WALL | {"headers": "dutch"}, r"wall\.headers: unknown value; found dutch"),
    (
        wall,
        WALL | {"brick": (0.5, 0.1, 0.2)},
        r"wall wall, bond: .*thinner than its headers are wide; found 0\.2 m thick, headers 0\.25",
    ),
    (
        wall,
        WALL | {"brick": (0.5, 0.6, 0.2)},
        r"its leaves are deeper than the stretchers are long; found 1\.2 m thick, .* 0\.5 m long",
    ),
    (
        tower,
        TOWER | {"plan": "round", "depth": None, "bonds": [{"wall": "round", "pattern": "header-stretcher"}]},
        r"wall round, bond: a curved wall cannot be laid in header-stretcher bond; found mid-radius 1\.2 m",
    ),
    (
        tower,
        TOWER | {"bonds": [{"wall": "frond", "pattern": "stack"}]},
        r'tower: bonds: no such wall; found "frond"; expected front',
    ),
    (tower, TOWER | {"bonds": [{"wall": ["front", "front"], "pattern": "stack"}]}, r"two bonds of one wall; found front"),
    (tower, TOWER | {"bonds": [{"wall": "front", "patern": "stack"}]}, r"tower\.bonds\.0\.patern: unknown key"),
    (apse, {"bonds": [{"wall": "apse"}]}, r"apse\.bonds\.0\.pattern: missing"),
]
APSE = {
    "course": 0.25,
    "stone_length": 0.5,
    "inner_radius": 1.2,
    "thickness": 0.6,
    "height": 3.0,
    "wall_length": 5.0,
    "wall_thickness": 0.8,
    "wall_height": 4.0,
}


@pytest.mark.parametrize(("build", "parameters", "said"), MISTAKES)
def test_what_does_not_go_is_told_with_the_numbers(build, parameters, said):
    with pytest.raises(InputError, match=said):
        derive_blocks(build(**((APSE | parameters) if build is apse else parameters)))
