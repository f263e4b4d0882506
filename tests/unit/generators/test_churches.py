"""Churches, chapels, towers, apses and arches on piers: laid, checked, named, and their mistakes told with the numbers."""

import math

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from churchpipe.config.case import read_case
from churchpipe.dxf.reader import read_dxf
from churchpipe.dxf.writer import write_dxf
from churchpipe.errors import InputError
from churchpipe.generators import apse, arch_piers, chapel, church, tower
from churchpipe.match import match_models
from churchpipe.model.materials import Material
from churchpipe.resources import pipeline_folder
from churchpipe.shell_mesh.shell import derive_shell
from churchpipe.stones.blocks import derive_blocks
from churchpipe.stones.contacts import find_contacts
from churchpipe.stones.soundness import check_soundness, unsupported_stones
from sound import laid

# Shrinking a failure would lay hundreds of buildings.
PHASES = (Phase.explicit, Phase.generate)
STONE, FILL = Material("default", 18e3, 0.6), Material("fill", 16e3, 0.5)
BOND = {"course": 0.25, "stone_length": 0.5}
NAVE = {"width": 5.0, "length": 8.0, "height": 6.0, "thickness": 0.8}
WALL = {"thickness": 0.8, "ridge": 8.0}
DOOR = {"name": "door", "wall": "facade", "centre": 0.0, "width": 1.4, "springing": 2.0, "voussoirs": 9, "depth": 0.4}
CHOIR_ARCH = {
    "name": "arch",
    "wall": "triumphal_arch",
    "centre": 0.0,
    "width": 2.4,
    "springing": 3.0,
    "voussoirs": 13,
    "depth": 0.5,
}
CHURCH = BOND | {
    "nave": NAVE,
    "facade": WALL,
    "triumphal_arch": WALL,
    "transept": {"width": 12.0, "depth": 3.6, "thickness": 0.8},
    "east": WALL,
    "openings": [DOOR, CHOIR_ARCH],
}
PIERS = BOND | {
    "span": 3.0,
    "springing": 2.5,
    "pier_width": 1.2,
    "thickness": 0.8,
    "height": 5.0,
    "voussoirs": 15,
    "depth": 0.4,
}
CHAPEL = BOND | {"width": 5.0, "length": 6.0, "height": 4.0, "thickness": 0.6}
TOWER = BOND | {"width": 3.0, "depth": 3.2, "height": 8.0, "thickness": 0.6}


def cases(name):
    return pipeline_folder() / "cases" / f"{name}.toml"


def round_trip(stones, path):
    write_dxf(stones, path, materials=[STONE, FILL])
    read, findings = read_dxf(path)
    assert not len(findings)
    order, again = np.argsort(stones.block_id), np.argsort(read.block_id)
    np.testing.assert_allclose(read.centroid[again], stones.centroid[order], atol=1e-12)
    np.testing.assert_allclose(read.volume[again], stones.volume[order], rtol=1e-9)
    free = ~stones.fixed[order]
    for have, want in ((read.panel, stones.panel), (read.material, stones.material), (read.course, stones.course)):
        assert (have[again][free] == want[order][free]).all()


@pytest.fixture(scope="module")
def r14():
    """The sample church R14: building and stones."""
    building = read_case(cases("church")).building()
    return building, derive_blocks(building)


@pytest.fixture(scope="module")
def joints(r14):
    return find_contacts(r14[1])


def test_the_sample_church_has_the_counts_of_the_targets(r14):
    stones = r14[1]
    free = ~stones.fixed
    # Targets, section 6: 5854 stones, 77 694 points, 18 124 kN. The count is ours, so that no change of the bond goes unseen.
    assert free.sum() == 5916 == pytest.approx(5854, rel=0.03)
    assert stones.weight[free].sum() / 1e3 == pytest.approx(18124, abs=1.0)


@pytest.mark.slow("docs/church.md: the church is sound, and the number of its points")
def test_the_sample_church_is_sound(r14, joints):
    stones, contacts = r14[1], joints
    assert len(contacts.point) == pytest.approx(77694, rel=0.03)
    check_soundness(stones, contacts)
    assert not len(unsupported_stones(stones, contacts))


@pytest.mark.slow("docs/church.md: stones, points and weight of the church with one thickness")
def test_with_one_thickness_it_has_them_too():
    stones = derive_blocks(read_case(cases("church_r")).building())
    free = ~stones.fixed
    assert free.sum() == 5978 == pytest.approx(5934, rel=0.03)
    assert len(find_contacts(stones).point) == pytest.approx(74214, rel=0.03)
    assert stones.weight[free].sum() / 1e3 == pytest.approx(15171, abs=1.0)


@pytest.mark.slow("docs/church.md: elements and nodes of the shell of the church, and that it is one building with its stones")
def test_the_shell_of_the_sample_church_matches_its_stones(r14, joints):
    (building, stones), contacts = r14, joints
    shell = derive_shell(building, element_size=0.2)
    # Targets, section 6: 64 872 facets and 33 062 nodes at .20 m.
    assert len(shell.triangles) == pytest.approx(64872, rel=0.03)
    assert len(shell.points) == pytest.approx(33062, rel=0.03)
    match = match_models(stones, contacts, shell)
    figures = {figure.name: figure for figure in match.figures}
    assert match.passed
    assert max(f.difference for name, f in figures.items() if name.startswith("weight")) < 0.001
    assert figures["height of the centroid"].difference < 0.001
    assert figures["angle between beds, mean"].difference < 0.1
    assert figures["mid-surface backed by stones"].difference < 1e-9
    assert set(stones.panel[~stones.fixed]) == set(shell.panel)


def test_macro_elements_carry_names(r14):
    stones = r14[1]
    tower_stones = np.char.startswith(stones.panel.astype(str), "tower")
    # The left bay of the transept, from the ground up: from the outer face to the inner face of the side wall in x, between
    # the outer faces of triumphal and end wall in y.
    low, high = stones.centroid[tower_stones].min(axis=0), stones.centroid[tower_stones].max(axis=0)
    assert low[0] > -7.0
    assert high[0] < -2.35 + 1e-9
    assert low[1] > 17.3
    assert high[1] < 22.45
    assert high[2] == pytest.approx(17.05 - 0.275 / 2)
    beside = ~tower_stones & (stones.centroid[:, 0] < -2.36) & (stones.centroid[:, 1] > 17.31) & ~stones.fixed
    assert not beside.any()
    assert {"facade", "triumphal_arch", "nave_left", "nave_right", "east", "apse", "chapel_outer"} <= set(stones.panel)


@pytest.mark.slow
def test_a_latin_cross_has_a_choir():
    parts = CHURCH | {
        "choir_arch": WALL,
        "choir": {"length": 3.0},
        "apses": [{"inner_radius": 1.0, "thickness": 0.6, "height": 4.0}],
        "openings": [DOOR, CHOIR_ARCH, CHOIR_ARCH | {"name": "second", "wall": "choir_arch"}],
    }
    stones, contacts = laid(church(**parts, materials=(STONE,)))
    y = stones.centroid[stones.panel == "apse", 1]
    assert y.max() > 8.0 + 3.6 + 3.0 + 0.4 + 1.0
    assert {"choir_arch", "transept_left_front", "transept_right_back", "transept_left_outer"} <= set(stones.panel)
    shell = derive_shell(church(**parts, materials=(STONE,)), element_size=0.4)
    assert match_models(stones, contacts, shell).passed


@pytest.mark.slow
def test_a_tower_may_take_part_of_an_arm():
    # An arm 3.35 m wide beside a nave 5.8 m wide over all; the tower takes 2.6 m of it.
    building = church(**(CHURCH | {"tower": {"height": 9.0, "width": 2.6}}), materials=(STONE,))
    stones, contacts = laid(building)
    inner = stones.centroid[stones.panel == "tower_inner", 0]
    assert inner.mean() == pytest.approx(-6.0 + 2.6 - 0.4, abs=0.05)
    assert match_models(stones, contacts, derive_shell(building, element_size=0.4)).passed


def test_a_round_tower():
    building = tower(**BOND, width=4.0, height=3.0, thickness=0.5, plan="round", materials=(STONE,))
    stones, contacts = laid(building)
    # Mean circumference 3.5 pi m: 22 stones of half a metre in every course, between 44 chords.
    assert (~stones.fixed).sum() == 12 * 22
    ring = 0.5 * 44 * math.sin(2 * math.pi / 44) * (2.0**2 - 1.5**2)
    assert stones.volume[~stones.fixed].sum() == pytest.approx(3.0 * ring, rel=1e-9)
    assert match_models(stones, contacts, derive_shell(building, element_size=0.25)).passed


def test_the_walls_along_y_may_run_through_first():
    stones = derive_blocks(tower(**TOWER))
    turned = derive_blocks(tower(**TOWER, first_course="y"))
    assert (stones.panel[stones.course == 0] == "front").sum() == (turned.panel[turned.course == 1] == "front").sum()
    assert stones.volume[~stones.fixed].sum() == pytest.approx(turned.volume[~turned.fixed].sum(), rel=1e-12)


def test_an_apse_is_toothed_into_its_wall():
    parameters = BOND | {
        "inner_radius": 1.2,
        "thickness": 0.6,
        "height": 3.0,
        "wall_length": 5.0,
        "wall_thickness": 0.8,
        "wall_height": 4.0,
    }
    stones, contacts = laid(apse(**parameters))
    # On odd courses the legs of the apse reach the inner face of the wall, y = -.8, on even ones the wall's outer face, 0.
    reach = [stones.points[slice(*stones.block_point_ptr[i : i + 2]), 1].min() for i in np.flatnonzero(stones.panel == "apse")]
    lowest = {
        course: min(r for r, c in zip(reach, stones.course[stones.panel == "apse"], strict=True) if c == course)
        for course in (0, 1)
    }
    assert lowest[0] == pytest.approx(0.0, abs=1e-9)
    assert lowest[1] == pytest.approx(-0.8, abs=1e-9)
    beds = (contacts.kind == "bed") & (stones.panel[contacts.blocks] == ["apse", "wall"]).all(axis=1)
    assert beds.sum() > 10


def test_backfill_weighs_what_its_material_weighs():
    stones, _ = laid(arch_piers(**PIERS, backfill="fill", materials=(STONE, FILL)))
    of_fill = stones.material == "fill"
    # A rectangle 3.8 x 2.5 m less the half polygon of the extrados, radius 1.9 m, 15 sides.
    area = 3.8 * 2.5 - 0.5 * 15 * 1.9**2 * math.sin(math.pi / 15)
    assert stones.weight[of_fill].sum() == pytest.approx(16e3 * 0.8 * area, rel=1e-9)
    building = arch_piers(**PIERS, backfill="fill", materials=(STONE, FILL))
    shell = derive_shell(building, element_size=0.2)
    assert shell.weight[shell.material == "fill"].sum() == pytest.approx(16e3 * 0.8 * area, rel=1e-6)


@pytest.mark.parametrize(
    ("shape", "rise", "opening"),
    [
        ("round", None, lambda: 0.5 * 8 * 0.5**2 * math.sin(math.pi / 8)),
        # Rise .3 over a span of 1: radius (.25 + .09)/.6, half angle asin(.5/r).
        ("segmental", 0.3, lambda: _segment(0.34 / 0.6, 8)),
        # Two arcs of radius (.25 + .64)/1 = .89 m about the far side of the middle, four chords each.
        ("pointed", 0.8, lambda: _lancet(0.89, 0.39, 4)),
    ],
)
def test_arches_of_all_shapes_leave_the_right_hole(shape, rise, opening):
    given_opening = {"name": "w", "wall": "front", "centre": 0.0, "width": 1.0, "springing": 1.5, "voussoirs": 8, "depth": 0.3}
    given_opening |= {"shape": shape} | ({} if rise is None else {"rise": rise})
    whole, _ = laid(tower(**TOWER))
    pierced, _ = laid(tower(**TOWER, openings=[given_opening]))
    hole = 1.0 * 1.5 + opening()
    assert whole.volume[1:].sum() - pierced.volume[1:].sum() == pytest.approx(0.6 * hole, rel=1e-9)
    assert (pierced.course == -1).sum() == 1 + 8


def _segment(radius, pieces):
    """Area between the chord of 1 m and the polygon of `pieces` chords over it."""
    half = math.asin(0.5 / radius)
    return 0.5 * radius**2 * (pieces * math.sin(2 * half / pieces) - math.sin(2 * half))


def _lancet(radius, away, pieces):
    """Twice the area between the middle axis, the springing line and `pieces` chords about a centre `away` beyond the axis."""
    turn = math.acos(away / radius)
    return 2 * (0.5 * radius**2 * pieces * math.sin(turn / pieces) - 0.5 * away * radius * math.sin(turn))


BASE = {church: CHURCH, tower: TOWER, arch_piers: PIERS, chapel: CHAPEL}
FRONT = DOOR | {"wall": "front"}
BESIDE = DOOR | {"name": "w", "sill": 2.0, "springing": 3.0}
SHALLOW = {"width": 8.0, "depth": 3.6, "thickness": 0.8}
HUGE = {"inner_radius": 2.5, "thickness": 0.6, "height": 4.0}
# What is built, what is changed, what must be said.
MISTAKES = [
    (church, {"openings": [DOOR | {"width": 6.0}]}, r"wall facade: opening door: wider than its wall; found -3\.4 to 3\.4 m"),
    (church, {"openings": [DOOR | {"width": 4.0}]}, r"door: reaches into the wall nave_left; .*clear of -2\.9 to -2\.1 m"),
    (church, {"openings": [DOOR | {"springing": 7.5}]}, r"door: reaches beyond the top .*z = 0 to 8\.583 m"),
    (church, {"openings": [DOOR, BESIDE]}, r"openings door and w: overlap with their voussoirs"),
    (church, {"openings": [DOOR | {"wall": "fasade"}]}, r'door: no such wall; found "fasade"; expected facade, '),
    (church, {"openings": [DOOR | {"heigth": 1.0}]}, r"church\.openings\.0\.heigth: unknown key"),
    (church, {"tower": {"height": 9.0, "width": 4.0}}, r"the tower is wider than .* found 4 m; expected <= 2\.6 m"),
    (church, {"tower": {"height": 9.1}}, r"church\.tower\.height: not a whole number of courses; .*expected 9 m"),
    (church, {"transept": SHALLOW}, r"church\.transept\.width: no room in its arms; found 8 m over all, 0\.3 m clear"),
    (church, {"tower": {"height": 9.0}, "chapel": {"height": 5.0, "side": "left"}}, r"the tower stands there; found left"),
    (church, {"transept": None, "tower": {"height": 9.0}}, r"church\.tower: needs the transept of the church"),
    (church, {"apses": [HUGE]}, r"church\.apse: its wall meets the wall nave_left; found x = -3\.1 to -2\.5 m"),
    (church, {"east": {"thickness": 0.8, "ridge": 5.0}}, r"church\.east\.ridge: below the eaves; found 5 m; expected >= 6 m"),
    (church, {"nave": NAVE | {"length": 0.9}}, r"church\.nave\.length: no room inside; found 0\.1 m clear; expected >= 0\.5 m"),
    (church, {"nave": NAVE | {"widht": 1.0}}, r"church\.nave\.widht: unknown key"),
    (tower, {"width": 1.5}, r"tower\.width: no room inside; found 0\.3 m clear"),
    (tower, {"plan": "round"}, r"tower\.plan: a round tower has no depth of its own"),
    (tower, {"plan": "round", "depth": None, "openings": [FRONT]}, r'opening door: no such wall; found "front"; expected round'),
    (tower, {"openings": [FRONT | {"shape": "segmental"}]}, r"opening door: rise: given or left out wrongly"),
    (tower, {"openings": [FRONT | {"sill": 2.5}]}, r"opening door: springing: not above the sill"),
    (arch_piers, {"pier_width": 0.5}, r"the arch does not fit on its piers; found 0\.5 m for voussoirs 0\.4 m deep"),
    (arch_piers, {"height": 4.0}, r"opening arch: reaches beyond the top .* expected within 0 to 4 m"),
    (chapel, {"length": 1.0}, r"chapel\.length: no room inside; found -0\.2 m clear; expected >= 0\.5 m"),
    (chapel, {"width": 0.4}, r"chapel\.width: no room inside; found -0\.8 m clear; expected >= 0\.5 m"),
]


@pytest.mark.parametrize(("build", "changes", "said"), MISTAKES)
def test_clashes_are_told_with_the_numbers(build, changes, said):
    with pytest.raises(InputError, match=said):
        build(**(BASE[build] | changes))


COURSES = st.integers(0, 4)


@pytest.mark.slow("docs/church.md: churches of any size are sound")
@settings(max_examples=3, deadline=None, derandomize=True, phases=PHASES)
@given(
    width=st.floats(4.5, 6.5),
    length=st.floats(5.0, 8.0),
    arm=st.floats(2.6, 3.5),
    thick=st.sampled_from([0.6, 0.8, 0.95]),
    eaves=COURSES,
    rise=st.floats(0.0, 3.0),
    raised=COURSES,
    stone=st.floats(0.42, 0.6),
    first=st.sampled_from(["x", "y"]),
    apses=st.booleans(),
)
def test_any_church_is_sound(tmp_path_factory, width, length, arm, thick, eaves, rise, raised, stone, first, apses):
    height = 0.25 * (20 + eaves)
    wall = {"thickness": thick, "ridge": height + rise if rise > 0.5 else None}
    building = church(
        course=0.25,
        stone_length=stone,
        nave={"width": width, "length": length, "height": height, "thickness": thick},
        facade=wall,
        triumphal_arch=wall | {"thickness": thick + 0.2},
        transept={"width": width + thick + 2 * arm, "depth": 3.6, "thickness": thick},
        east=wall,
        tower={"height": height + 0.25 * (8 + raised)},
        chapel={"height": height - 0.25 * raised - 0.5},
        apses=[{"inner_radius": 0.9, "thickness": 0.5, "height": 3.5}] if apses else [],
        openings=[DOOR | {"width": 1.2, "depth": 0.35}, CHOIR_ARCH | {"width": 1.8, "depth": 0.4, "sill": 0.0}],
        first_course=first,
        materials=(STONE,),
    )
    stones, contacts = laid(building)
    match = match_models(stones, contacts, derive_shell(building, element_size=0.5))
    assert match.passed, [figure for figure in match.figures if not figure.passed]
    round_trip(stones, tmp_path_factory.mktemp("dxf") / "church.dxf")


@pytest.mark.slow("docs/church.md: towers of any size are sound")
@settings(max_examples=5, deadline=None, derandomize=True, phases=PHASES)
@given(
    width=st.floats(2.6, 4.0),
    depth=st.floats(2.6, 4.0),
    thick=st.floats(0.4, 0.8),
    courses=st.integers(16, 24),
    stone=st.floats(0.4, 0.6),
    shape=st.sampled_from([("round", None), ("segmental", 0.2), ("pointed", 0.5)]),
    joints=st.sampled_from(["bay", "grid"]),
)
def test_any_tower_is_sound(tmp_path_factory, width, depth, thick, courses, stone, shape, joints):
    window = {
        "name": "w",
        "wall": ["front", "right"],
        "centre": 0.0,
        "width": 0.6,
        "sill": 1.5,
        "springing": 2.25,
        "voussoirs": 6,
    }
    window |= {"depth": 0.2, "shape": shape[0]} | ({} if shape[1] is None else {"rise": shape[1]})
    parameters = {"width": width, "depth": depth, "thickness": thick, "height": 0.25 * courses, "stone_length": stone}
    building = tower(**parameters, course=0.25, openings=[window], joints=joints, materials=(STONE,))
    stones, contacts = laid(building)
    assert match_models(stones, contacts, derive_shell(building, element_size=0.4)).passed
    round_trip(stones, tmp_path_factory.mktemp("dxf") / "tower.dxf")


def test_an_arch_on_thin_wedges_of_backfill_is_sound(tmp_path):
    # The lowest wedges of the backfill, two courses high, are half as large as the box around them.
    check_arch(tmp_path, 3.9915048473123855, 0.5132076197358473, 7, 0.77, "round", "fill")


@pytest.mark.slow("docs/church.md: arches of any size are sound")
@settings(max_examples=5, deadline=None, derandomize=True, phases=PHASES)
@given(
    span=st.floats(1.5, 4.0),
    depth=st.floats(0.25, 0.6),
    half_voussoirs=st.integers(4, 10),
    beside=st.floats(0.3, 0.9),
    shape=st.sampled_from(["round", "segmental", "pointed"]),
    backfill=st.sampled_from([None, "fill"]),
)
def test_any_arch_is_sound(tmp_path_factory, span, depth, half_voussoirs, beside, shape, backfill):
    check_arch(tmp_path_factory.mktemp("dxf"), span, depth, half_voussoirs, beside, shape, backfill)


def check_arch(folder, span, depth, half_voussoirs, beside, shape, backfill):
    rise = {"round": None, "segmental": 0.3 * span, "pointed": 0.8 * span}[shape]
    crown = 2.0 + (span / 2 if rise is None else rise) + depth * 1.5
    building = arch_piers(
        **BOND,
        span=span,
        springing=2.0,
        pier_width=depth + beside,
        thickness=0.6,
        height=0.25 * math.ceil(crown / 0.25 + 1.0),
        voussoirs=2 * half_voussoirs,
        depth=depth,
        shape=shape,
        rise=rise,
        backfill=backfill,
        materials=(STONE, FILL),
    )
    stones, contacts = laid(building)
    assert match_models(stones, contacts, derive_shell(building, element_size=0.3)).passed
    round_trip(stones, folder / "arch.dxf")
