"""Charts, footprints and the solids made of tiles."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from churchpipe.bond.parts import part_names
from churchpipe.bond.tiles import TileSet, tiles_of
from churchpipe.errors import InputError
from churchpipe.geometry.charts import along, check_upright, counted_from, footprint, lift, normals
from churchpipe.geometry.planar import area, polygon, polygons_of
from churchpipe.model.building import BondRegion, CylinderChart, Panel, Part, PlaneChart, UnitCell
from churchpipe.model.polyhedra import solid_properties
from churchpipe.stones.prisms import thicken

WALL = PlaneChart(origin=np.array([1.0, 2.0, 0.5]), s_axis=np.array([0.0, 1.0, 0.0]))
APSE = CylinderChart(centre=np.array([3.0, 0.0, 1.0]), radius=2.0, start=math.pi / 2)


def tile(*corners) -> TileSet:
    return tiles_of(np.array([polygon(corners)], dtype=object), np.zeros(1, dtype=np.int64), "bond")


def volume(chart, thickness, tiles):
    body = thicken(chart, thickness, tiles)
    return solid_properties(body.points, body.face_nodes, body.face_ptr, body.block_face_ptr)


def test_a_plane_lifts_along_its_axes_and_normal():
    place = lift(WALL, np.array([[0.3, 0.7]]), 0.2)
    # s runs along y, t up, so the normal s x t is +x.
    np.testing.assert_allclose(place, [[1.2, 2.3, 1.2]], rtol=1e-15)
    np.testing.assert_allclose(normals(WALL, np.zeros((1, 2))), [[1, 0, 0]])


def test_a_cylinder_measures_s_as_arc_length():
    place = lift(APSE, np.array([[0.0, 0.0], [math.pi, 2.0]]), [0.0, 0.5])
    np.testing.assert_allclose(place, [[3.0, 2.0, 1.0], [0.5, 0.0, 3.0]], atol=1e-15)
    np.testing.assert_allclose(normals(APSE, np.array([[math.pi, 2.0]])), [[-1, 0, 0]], atol=1e-15)


@settings(deadline=None)
@given(st.floats(0.0, 12.0), st.floats(-0.4, 0.4))
def test_plan_points_lead_back_to_s(s, offset):
    for chart in (WALL, APSE):
        place = lift(chart, np.array([[s, 1.0]]), offset)
        assert along(chart, place[:, :2])[0] == pytest.approx(s, abs=1e-9)


def test_the_legs_of_an_apse_run_on_straight():
    chart = CylinderChart(np.zeros(3), 2.0, 0.0, math.pi)
    # The half circle bulges to +y; its ends run on to -y at x = 2 and x = -2.
    place = lift(chart, np.array([[-1.0, 0.5], [2 * math.pi + 1.0, 0.5]]), 0.25)
    np.testing.assert_allclose(place, [[2.25, -1.0, 0.5], [-2.25, -1.0, 0.5]], atol=1e-15)
    np.testing.assert_allclose(along(chart, place[:, :2]), [-1.0, 2 * math.pi + 1.0], rtol=1e-12)
    assert area(footprint(chart, 0.5, -1.0, 0.0)) == pytest.approx(0.5, rel=1e-12)
    with pytest.raises(InputError, match=r"CylinderChart\.sweep: out of range; found 7\.0"):
        CylinderChart(np.zeros(3), 2.0, sweep=7.0)


def test_stones_in_a_part_carry_its_name():
    outline = np.array([[0, 0], [4, 0], [4, 2], [0, 2]], dtype=float)
    bond = BondRegion("bond", outline, "running", UnitCell(0.25, 0.5))
    parts = (Part("left", outline * [0.25, 1.0]), Part("low", outline * [1.0, 0.5]))
    panel = Panel("wall", WALL, outline, 0.4, (bond,), parts=parts)
    places = np.array([[0.5, 1.5], [0.5, 0.5], [1.0, 0.5], [2.0, 0.5], [2.0, 1.5]])
    # On a border, and where parts overlap, the first one listed.
    assert part_names(panel, places).tolist() == ["left", "left", "left", "low", "wall"]


def test_footprints():
    assert area(footprint(WALL, 0.4, 1.0, 3.5)) == pytest.approx(2.5 * 0.4)
    # Four chords of a quarter circle between radii 1.8 and 2.2.
    stations = np.linspace(0.0, math.pi, 5)
    expected = 4 * 0.5 * math.sin(math.pi / 8) * (2.2**2 - 1.8**2)
    assert area(footprint(APSE, 0.4, 0.0, math.pi, stations)) == pytest.approx(expected, rel=1e-12)


def test_a_leaning_wall_is_an_error():
    lean = PlaneChart(np.zeros(3), np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.6, 0.8]))
    with pytest.raises(InputError, match=r"wall apse\.chart: the wall is not upright"):
        check_upright("apse", lean)


def test_a_prism_has_outward_faces_and_its_volume():
    # A non-convex stone: its volume and centroid are those of the L-shape.
    corners = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
    found, centroid = volume(WALL, 0.5, tile(*corners))
    assert found[0] == pytest.approx(3 * 0.5, rel=1e-12)
    np.testing.assert_allclose(centroid[0], [1.0, 2.0 + 5 / 6, 0.5 + 5 / 6], rtol=1e-12)


@settings(deadline=None)
@given(
    width=st.floats(0.1, 2.0),
    height=st.floats(0.1, 2.0),
    lean=st.floats(-0.5, 0.5),
    thickness=st.floats(0.05, 1.0),
)
def test_the_volume_of_a_flat_stone_is_area_times_thickness(width, height, lean, thickness):
    tiles = tile((0, 0), (width, 0), (width + lean, height), (lean, height))
    assert volume(WALL, thickness, tiles)[0][0] == pytest.approx(width * height * thickness, rel=1e-9)


def test_stones_of_a_curved_wall_bend_at_every_joint_of_the_wall():
    # Two courses, joints half a stone apart: each stone of the lower course spans two chords.
    s = math.pi / 4
    boxes = [[0, 0, 2 * s, 1], [2 * s, 0, 4 * s, 1], [0, 1, s, 2], [s, 1, 3 * s, 2], [3 * s, 1, 4 * s, 2]]
    corner = np.array([[[a, b], [c, b], [c, d], [a, d]] for a, b, c, d in boxes]).reshape(-1, 2)
    polygons = polygons_of(corner, 4 * np.arange(6))
    tiles = tiles_of(polygons, np.array([0, 0, 1, 1, 1]), "bond")
    chord = 0.5 * math.sin(s / 2.0) * (2.2**2 - 1.8**2)
    np.testing.assert_allclose(volume(APSE, 0.4, tiles)[0], chord * np.array([2, 2, 1, 2, 1]), rtol=1e-12)


def test_a_sloping_edge_in_a_curved_wall_is_an_error():
    with pytest.raises(InputError, match="a sloping edge; expected upright and level edges"):
        thicken(APSE, 0.4, tile((0, 0), (1, 0), (1, 1), (0, 0.5)))


@pytest.mark.parametrize(
    ("chart", "words"),
    [
        (WALL, "counted from x = 1, y = 2 m towards +y"),
        (replace(WALL, s_axis=(0.6, -0.8, 0.0)), "counted from x = 1, y = 2 m towards (0.6, -0.8)"),
        (APSE, "counted from x = 3, y = 2 m counter-clockwise in plan"),
        (replace(WALL, origin=(4512345.6785, 0, 0), s_axis=(-1, 0, 0)), "counted from x = 4512345.68, y = 0 m towards -x"),
    ],
)
def test_places_along_a_wall_say_where_they_begin(chart: PlaneChart | CylinderChart, words: str) -> None:
    assert counted_from(chart) == words
