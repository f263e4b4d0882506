"""The gate between the two models: it passes buildings, and stops each kind of wrong one."""

import json
import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from churchpipe.bond.voussoir import ring_outline
from churchpipe.generators import arch, arch_piers, box, dome, prototype, vault, wall
from churchpipe.geometry.locate import facet_at, inside_stones
from churchpipe.match import match_models
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import BondRegion, Opening, UnitCell
from churchpipe.model.quantities import as_written
from churchpipe.recognition.panels import fit_panels
from churchpipe.shell_mesh.shell import derive_shell
from churchpipe.stones.blocks import derive_blocks
from churchpipe.stones.contacts import find_contacts
from models import S5, S22, TILTING_DOOR


def blocks_of(building):
    stones = derive_blocks(building)
    return stones, find_contacts(stones)


def compare(stones_of, shell_of, size=0.04):
    return match_models(*blocks_of(stones_of), derive_shell(shell_of, size))


def failed(match):
    return {figure.name for figure in match.figures if not figure.passed}


def with_wall(building, number, **changes):
    panels = list(building.panels)
    panels[number] = replace(panels[number], **changes)
    return replace(building, panels=tuple(panels))


@pytest.mark.parametrize(
    "size", [pytest.param(0.02, marks=pytest.mark.slow("docs/shell.md: both models are one building")), 0.05]
)
@pytest.mark.parametrize("parameters", [S5, S22, S22 | {"joints": "bay"}, S22 | {"brick": (0.06, 0.04, 0.03)}])
def test_two_models_of_one_prototype_match(parameters, size):
    match = compare(prototype(**parameters), prototype(**parameters), size)
    assert match.passed
    figures = {figure.name: figure for figure in match.figures}
    assert figures["weight"].difference < 1e-9
    assert max(figure.difference for name, figure in figures.items() if name.startswith("weight of")) < 1e-9
    assert figures["stones turned by more than 20 degrees"].shell == 0


def test_mid_planes_of_s22_overlap_by_six_per_mille():
    # By hand: 2.0142 m2 x 40 mm of mid-surfaces on .080064 m3 of stones.
    match = compare(prototype(**S22), prototype(**S22))
    assert match.junction_overlap == pytest.approx(2.0142 * 0.04 / 0.080064 - 1, rel=1e-9)


@pytest.mark.parametrize("size", [0.03, 0.06, 0.12])
def test_elements_longer_than_a_junction_do_not_count_its_ground_twice(size):
    # A junction of walls .04 m thick in a row of elements three times as long.
    match = compare(prototype(**S22), prototype(**S22), size)
    assert match.passed
    (ground,) = (figure for figure in match.figures if figure.name.startswith("supported"))
    assert ground.difference < 0.005


def test_an_arch_and_a_box_match():
    bow = arch(mean_radius=1.0, thickness=0.2, width=0.5, voussoirs=27)
    assert compare(bow, bow, 0.1).passed
    house = box(length=3.0, width=2.5, thickness=0.5, brick=(0.5, 0.5, 0.2), courses=9)
    assert compare(house, house, 0.2).passed


def test_a_dome_whose_stones_all_turn_a_corner_matches():
    """Eight flat sides, each stone over two of them; a closing stone, which turns none, is not there."""
    octagon = {"span": 4.65, "rings": 6, "sides": 8, "oculus": 0.7}
    match = compare(dome(**octagon, thickness=0.25), dome(**octagon, thickness=0.25), 0.4)
    assert match.passed, failed(match)
    assert "thickness" in failed(compare(dome(**octagon, thickness=0.25), dome(**octagon, thickness=0.26), 0.4))


@pytest.mark.parametrize(
    "built",
    [
        partial(dome, span=4.0, rings=6, sides=6, oculus=1.0),
        partial(vault, kind="octagonal", span=4.0, courses=13, stone_length=1.0, shape="pointed", rise=2.8),
        partial(vault, kind="groin", span=4.0, courses=7, stone_length=1.0, shape="pointed", rise=2.8),
    ],
)
def test_a_vault_most_stones_of_which_turn_a_corner_matches(built):
    match = compare(built(thickness=0.3), built(thickness=0.3), 0.8)
    assert match.passed, failed(match)
    assert "thickness" in failed(compare(built(thickness=0.3), built(thickness=0.312), 0.8))


def test_a_thick_drum_does_not_make_up_for_a_thin_dome():
    sizes = {"rings": 8, "sides": 6, "oculus": 1.0, "drum_height": 0.9, "drum_course": 0.3, "drum_thickness": 0.4}
    building = dome(span=4.0, thickness=0.3, **sizes)
    shell = derive_shell(building, 0.8)
    volume, drum = shell.area * shell.thickness, shell.panel == "drum"
    rest = 1 - 0.06 * volume[drum].sum() / volume[~drum].sum()
    wrong = replace(shell, thickness=shell.thickness * np.where(drum, 1.06, rest))
    assert wrong.area @ wrong.thickness == pytest.approx(volume.sum(), rel=1e-12)
    assert match_models(*blocks_of(building), shell).passed
    assert "thickness" in failed(match_models(*blocks_of(building), wrong))


@pytest.mark.parametrize("corner", ["round", "alternate"])
def test_stones_of_a_skewback_that_end_in_an_edge_are_as_thick_as_its_facets(corner):
    # They are triangles in section, with their centroid a sixth of the thickness off the mid-surface: taken for stones of two
    # leaves, they were a third thicker than the facet.
    sizes = {"kind": "pavilion", "span": 2.4, "thickness": 0.3, "shape": "segmental", "rise": 0.84}
    building = vault(courses=9, stone_length=0.6, corner=corner, **sizes)
    match = compare(building, building, 0.8)
    assert match.passed, failed(match)


@pytest.mark.parametrize("corner", ["round", "alternate", "mitre"])
def test_skewbacks_of_a_groin_vault_bear_on_all_of_their_base(corner):
    # They taper from one wall to the other, so that facets carry two thirds of what their thickness would.
    building = vault(
        kind="groin", span=4.0, thickness=0.3, courses=13, stone_length=0.4, shape="segmental", rise=1.2, corner=corner
    )
    match = compare(building, building, 0.8)
    assert match.passed, failed(match)
    wide = vault(kind="groin", span=4.0, thickness=0.33, courses=13, stone_length=0.4, shape="segmental", rise=1.2, corner=corner)
    assert "supported length x thickness" in failed(compare(building, wide, 0.8))


def test_rings_narrower_than_their_voussoirs_are_long_match():
    # The joints between two rings are larger than the beds.
    narrow = {"span": 5.0, "thickness": 0.5, "courses": 15, "length": 2.3}
    rings = vault(**narrow, stone_length=0.22, laid="rings")
    match = compare(rings, rings, 1.0)
    assert match.passed, failed(match)
    shell = derive_shell(rings, 1.0)
    turned = np.stack([shell.axes[:, 1], -shell.axes[:, 0], shell.axes[:, 2]], axis=1)
    assert "angle between beds, mean" in failed(match_models(*blocks_of(rings), replace(shell, axes=turned)))


def test_match_json_holds_every_figure():
    match = compare(prototype(**S5), prototype(**S5))
    stored = json.loads(json.dumps(as_written(match)))
    assert stored["passed"] is True
    assert stored["junction_overlap"] == pytest.approx(0, abs=1e-9)
    assert {"name", "stones", "shell", "unit", "difference", "tolerance", "passed"} == set(stored["figures"][0])
    weight = stored["figures"][0]
    assert (weight["name"], weight["unit"]) == ("weight", "N")
    assert weight["stones"] == pytest.approx(864.864, rel=1e-9)


def test_another_thickness_fails():
    plain = {"length": 1.0, "brick": (0.2, 0.1, 0.05), "courses": 10}
    names = failed(compare(wall(**plain), wall(**plain, thickness=0.105), 0.1))
    assert {"weight", "weight of wall", "volume", "thickness", "supported length x thickness"} <= names
    building = prototype(**S22)
    light = replace(building, materials=(replace(building.materials[0], unit_weight=27e3),))
    assert {"weight", "volume"} <= failed(compare(building, light))


def test_a_missing_opening_fails_either_way():
    building = prototype(**S22)
    closed = with_wall(building, 2, openings=())
    names = failed(compare(building, closed))
    assert {"weight of partition-2", "mid-surface backed by stones", "supported length x thickness"} <= names
    assert {"weight of partition-2", "stones on a mid-surface"} <= failed(compare(closed, building))


def test_an_opening_in_the_wrong_place_fails():
    building, moved = prototype(**S22), prototype(**S22 | {"opening": TILTING_DOOR | {"start": 0.4}})
    assert {"mid-surface backed by stones", "stones on a mid-surface"} <= failed(compare(building, moved))


def test_a_small_window_is_not_lost():
    big = box(length=6.0, width=5.0, thickness=0.5, brick=(0.5, 0.5, 0.2), courses=20)
    window = Opening("window", np.array([[2.0, 2.0], [2.5, 2.0], [2.5, 2.6], [2.0, 2.6]]))
    assert "mid-surface backed by stones" in failed(compare(with_wall(big, 0, openings=(window,)), big, 0.2))


def test_a_turned_course_over_the_doors_fails():
    building = prototype(**S22)
    course = np.array([[0.08, 0.45], [0.32, 0.45], [0.32, 0.48], [0.08, 0.48]])
    upright = BondRegion("turned", course, "voussoir", UnitCell(0.03, 0.08), centre=(0.2, -1e3), pieces=1)
    turned = with_wall(building, 1, regions=(building.panels[1].regions[0], upright))
    assert failed(compare(building, turned)) == {"stones turned by more than 20 degrees"}
    sheet = derive_shell(building, 0.04)
    all_turned = replace(sheet, axes=np.stack([sheet.axes[:, 1], -sheet.axes[:, 0], sheet.axes[:, 2]], axis=1))
    match = match_models(*blocks_of(building), all_turned)
    assert {"angle between beds, mean", "stones turned by more than 20 degrees"} == failed(match)
    assert {f.name: f for f in match.figures}["angle between beds, mean"].shell == pytest.approx(90)


STEEP = {"shape": "pointed", "rise": 4.2, "voussoirs": 12, "height": 6.75}


def arch_on_piers(**ring):
    size = {"course": 0.25, "stone_length": 0.5, "span": 3.0, "springing": 1.25, "pier_width": 1.25, "thickness": 0.5}
    return arch_piers(**size, depth=0.45, **ring)


@pytest.mark.parametrize("ring", [STEEP, STEEP | {"voussoirs": 4}, {"voussoirs": 3, "height": 3.75}], ids=["12", "4", "3"])
def test_a_bed_may_have_any_direction_between_the_joints_of_its_voussoir(ring):
    building = arch_on_piers(**ring)
    assert not failed(compare(building, building, 0.2))


def test_level_beds_in_a_ring_on_piers_fail():
    building = arch_on_piers(**STEEP)
    (panel,) = building.panels
    openings = tuple(replace(opening, rings=()) for opening in panel.openings)
    regions = tuple(replace(region, pattern="running") for region in panel.regions)
    level = with_wall(building, 0, openings=openings, regions=regions)
    assert "stones turned by more than 20 degrees" in failed(compare(building, level, 0.2))


def test_level_beds_in_an_arch_fail():
    bow = arch(mean_radius=1.0, thickness=0.2, width=0.5, voussoirs=27)
    flat = replace(bow.panels[0].regions[0], pattern="running")
    assert failed(compare(bow, with_wall(bow, 0, regions=(flat,)), 0.1)) >= {"angle between beds, mean"}


def test_a_wall_that_only_one_model_has_fails():
    building = prototype(**S22)
    two = replace(building, panels=building.panels[:-1])
    assert {"weight", "weight of partition-3", "stones on a mid-surface"} <= failed(compare(building, two))
    assert {"weight of partition-3", "mid-surface backed by stones"} <= failed(compare(two, building))


def test_points_in_stones_by_the_winding_number():
    # An L-shaped stone beside a cube, and the ground, which does not count.
    corner = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
    ell = ([(x, y, z) for z in (0, 1) for x, y in corner], [list(range(5, -1, -1)), list(range(6, 12))])
    ell[1].extend([k, (k + 1) % 6, 6 + (k + 1) % 6, 6 + k] for k in range(6))
    box_faces = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]

    def cuboid(x, y, z, side):
        corners = [(x, y), (x + side, y), (x + side, y + side), (x, y + side)]
        return [(a, b, c) for c in (z, z + side) for a, b in corners], box_faces

    stones = Assemblage.from_polyhedra([ell, cuboid(2, 0, 0, 1), cuboid(-5, -5, -10, 10)], 1.0, fixed=[2])
    points = np.array([[0.3, 0.4, 0.5], [1.6, 1.7, 0.5], [0.4, 1.7, 0.9], [2.5, 0.45, 0.2], [0.1, 0.2, -1], [2.5, 0.5, 1.01]])
    np.testing.assert_array_equal(inside_stones(stones, points), [True, False, True, True, False, False])


def test_the_facet_at_a_point():
    shell = derive_shell(prototype(**S5), 0.1)
    middle = shell.points[shell.triangles].mean(axis=1)
    for name in ("main", "partition-1"):
        own = np.flatnonzero(shell.panel == name)
        facet, outside = facet_at(shell, middle[own] + 0.015 * shell.axes[own, 2], name)
        np.testing.assert_array_equal(facet, own)
        assert (outside == 0).all()
    _, outside = facet_at(shell, np.array([[0.3, 0.02, 0.65]]), "main")
    assert outside[0] == pytest.approx(0.02, rel=1e-9)


@pytest.mark.parametrize("half_angle", [0.5, 1.0, math.pi / 2])
def test_an_arch_of_two_voussoirs_matches(half_angle):
    # Of a semicircle the two joints of each voussoir are at right angles.
    bow = arch(mean_radius=2.0, thickness=0.4, width=0.6, voussoirs=2, half_angle=half_angle)
    stones = derive_blocks(bow)
    fitted = fit_panels(stones)
    assert [region.pieces for region in fitted.panels[0].regions] == [2]
    for building in (bow, fitted.building(bow.materials)):
        shell = derive_shell(building, element_size=0.2)
        assert match_models(replace(stones, panel=fitted.panel), find_contacts(stones), shell).passed


def test_stones_beside_a_ring_are_not_taken_for_voussoirs():
    ring = ring_outline((1.5, 0.8), 0.4, 0.7, 0.0, math.pi, 9)
    house = box(length=3.0, width=2.5, thickness=0.5, brick=(0.5, 0.5, 0.2), courses=12)
    front = house.panels[0]
    door = np.concatenate([[[1.1, 0.0], [1.9, 0.0]], ring[:9:-1]])
    arched = with_wall(
        house,
        0,
        openings=(Opening("door", door),),
        regions=(*front.regions, BondRegion("ring", ring, "voussoir", UnitCell(0.19, 0.3), centre=(1.5, 0.8), pieces=9)),
    )
    assert compare(arched, arched, 0.2).passed


@pytest.mark.parametrize(("long", "high"), [(0.8, 0.4), (0.6, 0.4), (0.4, 0.4)])
def test_a_wall_drawn_without_courses_matches_however_short_its_stones_are(long, high):
    # Of a stone of the lowest or uppermost course the heads are as large as the bed shared with the next course, or larger.
    laid = wall(length=8 * long, courses=5, brick=(long, 0.5, high))
    stones, contacts = blocks_of(laid)
    drawn = replace(stones, course=np.full(stones.count, -1))
    match = match_models(drawn, contacts, derive_shell(laid, 0.6))
    assert match.passed
    assert {figure.name: figure.shell for figure in match.figures}["angle between beds, mean"] == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize(
    "ring",
    [{"shape": "pointed", "rise": 2.2, "voussoirs": 16, "height": 4.5}, {"voussoirs": 15, "height": 3.75}],
    ids=["pointed", "round"],
)
def test_an_arch_drawn_on_a_layer_of_its_own_matches_with_the_stones_that_it_cuts(ring):
    stones, contacts = blocks_of(arch_on_piers(**ring))
    layer = np.where(stones.coursed, stones.panel, "ring")
    drawn = replace(stones, panel=np.where(stones.fixed, stones.panel, layer), course=np.full(stones.count, -1))
    fitted = fit_panels(drawn)
    (panel,) = fitted.panels
    arcs = [region for region in panel.regions if region.pattern == "voussoir"]
    assert len(arcs) == len(panel.parts) == (2 if "shape" in ring else 1)
    shell = derive_shell(fitted.building(), 0.3)
    assert set(shell.panel.tolist()) == {"arch", "ring"}
    assert not failed(match_models(fitted.stones, contacts, shell))
