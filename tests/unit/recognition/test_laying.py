"""Stones laid in walls and rings that are given whole: outlines with openings, volumes as meshes, arches, junctions, refusals."""

import math
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import churchpipe as cp
from churchpipe.bond.voussoir import ring_outline
from churchpipe.errors import InputError
from churchpipe.findings import FindingsError
from churchpipe.geometry.prism import prism_of
from churchpipe.match import match_models
from churchpipe.model.assemblage import Assemblage, Polyhedron
from churchpipe.recognition.insets import outline_and_holes
from churchpipe.recognition.panels import fit_panels
from mesh_files import write_dxf_outlines, write_obj, write_stl
from solids import box, standing

COURSE, STONE = 0.25, 0.5


def volumes(*bodies: Polyhedron) -> Assemblage:
    return Assemblage.from_polyhedra(list(bodies), 18e3, block_id=[f"body-{n}" for n in range(len(bodies))])


def on_plate(*bodies: Polyhedron) -> Assemblage:
    plate = box((-50, 50), (-50, 50), (-1, 0))
    return Assemblage.from_polyhedra([plate, *bodies], 18e3, fixed=[0], block_id=["ground", *map(str, range(len(bodies)))])


def fills(stones: Assemblage, whole: float) -> None:
    """The stones have the volume given; where there is ground, none floats or lies in another."""
    assert stones.volume[~stones.fixed].sum() == pytest.approx(whole, rel=1e-9)
    if stones.fixed.any():
        cp.check_soundness(stones, cp.find_contacts(stones))


outlines = st.builds(
    lambda length, height, gable, left: shapely.Polygon(
        [(0, 0), (length, 0), (length, height), (0.5 * length, height + gable), (0, height + left)]
    ),
    st.floats(2.5, 7.0),
    st.floats(1.6, 4.0),
    st.floats(0.4, 2.0),
    st.floats(0.0, 0.3),
)
holes = st.lists(
    st.tuples(st.floats(0.15, 0.85), st.just(0.0) | st.floats(0.1, 0.7), st.floats(0.6, 1.2), st.floats(0.7, 1.2), st.booleans()),
    max_size=3,
)


def hole(outline: shapely.Polygon, at: float, sill: float, width: float, height: float, arched: bool) -> shapely.Polygon:
    _, _, right, top = outline.bounds
    s, t = at * right, sill * 0.6 * top
    square = shapely.box(s - 0.5 * width, t, s + 0.5 * width, t + height)
    round_head: Any = shapely.Point(s, t + height).buffer(0.5 * width, quad_segs=5)
    return square.union(round_head) if arched else square


@settings(deadline=None, max_examples=20)
@given(outline=outlines, openings=holes, thickness=st.floats(0.2, 0.8), turn=st.floats(-3.0, 3.0))
def test_random_outlines_are_filled_exactly(outline, openings, thickness, turn):
    region = outline
    for opening in openings:
        region = region.difference(hole(outline, *opening))
    # What is narrower than a quarter of a stone is refused by the bond.
    assume(region.geom_type == "Polygon" and region.buffer(-0.3).geom_type == "Polygon" and region.buffer(-0.3).area > 1)
    solid = on_plate(standing(region, thickness, turn))
    try:
        building = cp.lay_stones(solid, course=COURSE, stone=STONE)
        stones = cp.derive_blocks(building)
    except InputError as error:
        if "narrower than a quarter of a stone" not in error.problem:
            raise
        return
    fills(stones, region.area * thickness)
    assert len(building.panels[0].openings) == len(region.interiors)


@pytest.mark.parametrize("chords", [27, 60, 13])
@pytest.mark.parametrize("sweep", [math.pi, 1.9])
def test_a_ring_becomes_voussoirs(chords, sweep):
    start = 0.5 * (math.pi - sweep)
    ring = shapely.Polygon(ring_outline((0.0, 1.0), 2.0, 2.5, start, start + sweep, chords))
    stones = cp.derive_blocks(cp.lay_stones(volumes(standing(ring, 0.6)), bond="voussoir", course=0.26))
    count = round(sweep * 2.25 / 0.26)
    assert stones.count == count
    fills(stones, ring.area * 0.6)
    contacts = cp.find_contacts(stones)
    assert len(contacts.area) == count - 1
    # Every joint points to the centre.
    centre = np.array([0.0, 1.0])
    for normal, first in zip(contacts.frame[:, 0], contacts.point_ptr[:-1], strict=True):
        assert abs(normal[[0, 2]] @ (contacts.point[first][[0, 2]] - centre)) < 1e-9


def test_a_round_window_ring_is_two_halves():
    ring = shapely.Point(0, 2).buffer(1.0, quad_segs=10).difference(shapely.Point(0, 2).buffer(0.7, quad_segs=6))
    building = cp.lay_stones(volumes(standing(ring, 0.3)), bond="voussoir", course=0.25)
    assert len(building.panels[0].regions) == 2
    fills(cp.derive_blocks(building), ring.area * 0.3)


def test_the_shell_of_laid_walls_matches():
    window = shapely.box(1.5, 1.0, 2.5, 2.0)
    region = shapely.Polygon([(0, 0), (5, 0), (5, 3), (2.5, 4.5), (0, 3)]).difference(window)
    building = cp.lay_stones(on_plate(standing(region, 0.4)), course=COURSE, stone=STONE)
    stones = cp.derive_blocks(building)
    match = match_models(stones, cp.find_contacts(stones), cp.derive_shell(building, element_size=0.25))
    assert match.passed, match


@pytest.mark.parametrize("chords", [15, 40])
def test_the_shell_of_a_laid_arch_matches(chords):
    ring = shapely.Polygon(ring_outline((0.0, 0.0), 2.0, 2.5, 0.0, math.pi, chords))
    building = cp.lay_stones(on_plate(standing(ring, 0.6)), bond="voussoir", course=0.47)
    stones = cp.derive_blocks(building)
    contacts = cp.find_contacts(stones)
    for made in (building, fit_panels(stones).building(building.materials)):
        assert match_models(stones, contacts, cp.derive_shell(made, element_size=0.25)).passed


def test_bodies_that_overlap_are_toothed():
    solid = on_plate(box((0, 5), (0, 0.4), (0, 3)), box((0, 0.4), (0, 4), (0, 3)))
    building = cp.lay_stones(solid, course=COURSE, stone=STONE)
    stones = cp.derive_blocks(building)
    fills(stones, (5 * 0.4 + 3.6 * 0.4) * 3)
    assert {panel.runs_through for panel in building.panels} == {0, 1}
    corner = stones.centroid[~stones.fixed]
    inside = (corner[:, 0] < 0.4) & (corner[:, 1] < 0.4)
    assert not inside.any() or np.unique(stones.panel[~stones.fixed][inside]).size == 2
    match = match_models(stones, cp.find_contacts(stones), cp.derive_shell(building, element_size=0.3))
    assert match.passed, match


def test_bodies_that_only_touch_butt():
    solid = on_plate(box((0, 5), (0, 0.4), (0, 3)), box((0, 0.4), (0.4, 4), (0, 3)))
    stones = cp.derive_blocks(cp.lay_stones(solid, course=COURSE, stone=STONE))
    fills(stones, (5 * 0.4 + 3.6 * 0.4) * 3)
    # The plane of the butt joint cuts no stone.
    free = np.flatnonzero(~stones.fixed)
    y = [stones.points[a:b, 1] for a, b in zip(stones.block_point_ptr[free], stones.block_point_ptr[free + 1], strict=True)]
    assert not any(low.min() < 0.4 - 1e-9 and low.max() > 0.4 + 1e-9 for low in y)


def test_a_body_of_two_thicknesses_is_refused_where_it_changes():
    # In plan a wall .4 m thick that is .6 m thick from x = 4 on.
    plan = [(0.0, 0.0), (6.0, 0.0), (6.0, 0.6), (4.0, 0.6), (4.0, 0.4), (0.0, 0.4)]
    flat, faces = prism_of(shapely.Polygon(plan))
    body = (flat * [1, 1, 3], [list(face) for face in faces])
    with pytest.raises(InputError, match=r"thickness is not constant; found 0\.6 m thick at \([46]\.000, 0\.600"):
        cp.lay_stones(volumes(body), course=COURSE, stone=STONE)


def sheared(along: int, by: int, slope: float) -> tuple[np.ndarray, list[list[int]]]:
    points, faces = box((0, 4), (0, 0.4), (0, 3))
    points[:, by] += slope * points[:, along]
    return points, faces


@pytest.mark.parametrize(
    ("body", "why"),
    [(sheared(2, 1, 0.2), "leans"), (sheared(1, 0, 0.4), "right angles"), (sheared(0, 2, 0.0), "")],
    ids=["leaning", "ends cut at a slant", "a wall"],
)
def test_what_is_no_wall_is_refused(body, why):
    if not why:
        assert cp.lay_stones(volumes(body), course=COURSE, stone=STONE).panels
        return
    with pytest.raises(InputError, match=why) as caught:
        cp.lay_stones(volumes(body), course=COURSE, stone=STONE)
    assert caught.value.where == "body-0"
    assert caught.value.remedy


def in_plan(plan: shapely.Polygon) -> Polyhedron:
    flat, faces = prism_of(plan)
    return flat * [1, 1, 3], [list(face) for face in faces]


def test_what_a_message_says_of_mitred_walls_and_of_walls_at_a_slant_can_be_laid():
    along, turn = shapely.box(0, 0, 6, 0.5), math.radians(37)
    mitred = shapely.Polygon([(0, 0), (6, 0), (6, 0.5), (0.5, 0.5)]), shapely.Polygon([(0, 0), (0.5, 0.5), (0.5, 4), (0, 4)])
    square = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
    ended = shapely.Polygon(np.array([(0, 0), (4, 0), (4, 0.35), (0, 0.35)]) @ square + [2.0, 0.5])
    slanted = shapely.Polygon([*ended.exterior.coords[:3], (2 - 0.35 / math.sin(turn), 0.5)])
    remedy = r"at a corner one wall runs to the far face of the other, at a slant one ends square before the other"
    for refused in (mitred, (along, slanted)):
        with pytest.raises(InputError, match=remedy):
            cp.lay_stones(volumes(*map(in_plan, refused)), course=COURSE, stone=STONE)
    for plans in ((along, shapely.box(0, 0, 0.5, 4)), (along, ended)):
        assert len(cp.lay_stones(volumes(*map(in_plan, plans)), course=COURSE, stone=STONE).panels) == 2


def test_a_curved_wall_is_refused():
    apse = shapely.Polygon(ring_outline((0.0, 0.0), 2.0, 2.5, 0.0, math.pi, 24))
    with pytest.raises(InputError, match=r"it is curved.*Cut it into plane lengths"):
        cp.lay_stones(volumes(in_plan(apse)), course=COURSE, stone=STONE)


def test_a_whole_building_in_one_body_is_refused():
    room = shapely.box(0, 0, 6, 4).difference(shapely.box(0.4, 0.4, 5.6, 3.6))
    # A door, so that the plan has one outline.
    room = room.difference(shapely.box(2, -1, 3, 0.4))
    with pytest.raises(InputError, match=r"several walls in one body; found walls one behind the other.*Cut the building where"):
        cp.lay_stones(volumes(in_plan(room)), course=COURSE, stone=STONE)


def test_two_walls_in_one_place_are_refused():
    solid = volumes(box((0, 5), (0, 0.4), (0, 3)), box((1, 2), (0, 0.4), (1, 2)))
    with pytest.raises(InputError, match=r"body-1: it lies in body-0.*OPENING"):
        cp.lay_stones(solid, course=COURSE, stone=STONE)


def test_a_pointed_wall_is_no_ring():
    with pytest.raises(InputError, match="no ring"):
        cp.lay_stones(volumes(box((0, 5), (0, 0.4), (0, 3))), bond="voussoir", course=COURSE)


REGION = shapely.Polygon([(0, 0), (5, 0), (5, 3), (2.5, 4.2), (0, 3)]).difference(shapely.box(1.5, 1.0, 2.5, 2.0))


@pytest.mark.parametrize("suffix", [".obj", ".stl", "triangles.obj"])
def test_a_mesh_of_a_wall_is_laid(tmp_path: Path, suffix: str):
    whole = volumes(standing(REGION, 0.4, 0.7))
    path = tmp_path / f"wall{suffix}"
    _ = write_stl(whole, path) if suffix == ".stl" else write_obj(whole, path, triangulated=suffix != ".obj")
    options = {"support": "base", "unit_weight": 18e3, "bond": "running", "course": COURSE, "stone": STONE}
    stones, findings = cp.read_stones(path, units="m", **options)
    assert "W28" in findings.codes
    fills(stones, REGION.area * 0.4)


def test_solids_that_are_walls_have_the_names_of_their_layers(tmp_path: Path):
    document = ezdxf.new("R2010")
    document.header["$INSUNITS"] = 6
    for layer, at in (("Nord", 0.0), ("Süd", 3.0), ("Quer 2", 6.0), ("Quer 2", 9.0), ("0", 12.0), ("GROUND", -9.0)):
        points, faces = box((0, 4), (at, at + 0.4), (0, 2)) if layer != "GROUND" else box((-1, 5), (-1, 14), (-1, 0))
        with document.modelspace().add_mesh(dxfattribs={"layer": layer}).edit_data() as mesh:
            mesh.vertices, mesh.faces = points.tolist(), list(faces)
    path = tmp_path / "walls.dxf"
    document.saveas(path)
    stones, findings = cp.read_dxf(path, unit_weight=18e3, bond="running", course=COURSE, stone=STONE)
    handle = document.modelspace()[4].dxf.handle
    assert set(stones.panel[~stones.fixed]) == {"NORD", "SÜD", "QUER 2-1", "QUER 2-2", handle}
    assert "6 bodies without attributes" in str(findings)


def test_walls_that_meet_at_a_slant_are_said_to_have_no_junction(tmp_path: Path):
    """One wall ends at the other with a corner, one a quarter of its thickness before it; one is far away, one square to it."""
    turn = math.radians(37)
    square = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
    wall = np.array([(0, 0), (4, 0), (4, 0.4), (0, 0.4)])
    plans = [shapely.box(0, 0, 20, 0.5), shapely.box(0, 0.5, 0.4, 4)]
    plans += [shapely.Polygon(wall @ square + [start, 0.5 + apart]) for start, apart in ((2.0, 0.0), (8.0, 0.1), (14.0, 0.3))]
    path = write_obj(volumes(*map(in_plan, plans)), tmp_path / "walls.obj")
    options = {"support": "base", "unit_weight": 18e3, "bond": "running", "course": COURSE, "stone": STONE}
    stones, findings = cp.read_stones(path, units="m", **options)
    joints = cp.find_contacts(stones)
    met = {tuple(sorted(stones.panel[pair])) for pair in joints.blocks if not stones.fixed[pair].any()}
    assert {pair for pair in met if len(set(pair)) == 2} == {("body-0", "body-1")}
    said = [finding.found for finding in findings if "no junction is laid there" in finding.found]
    assert [text.partition(":")[0] for text in said] == [f'"body-0" and "body-{k}" meet at 37 degrees' for k in (2, 3)]


def test_outlines_with_openings_are_laid(tmp_path: Path):
    document = ezdxf.new("R2010")
    document.header["$INSUNITS"] = 4
    space = document.modelspace()
    space.add_lwpolyline([(0, 0), (5000, 0), (5000, 3000), (2500, 4200), (0, 3000)], close=True, dxfattribs={"layer": "FACADE"})
    space.add_lwpolyline([(1500, 1000), (2500, 1000), (2500, 2000), (1500, 2000)], close=True, dxfattribs={"layer": "OPENING"})
    # A door that reaches below the wall, as people draw it.
    space.add_lwpolyline([(3500, -200), (4300, -200), (4300, 2000), (3500, 2000)], close=True, dxfattribs={"layer": "OPENING"})
    path = tmp_path / "wall.dxf"
    document.saveas(path)
    options = {"support": "base", "unit_weight": 18e3, "bond": "running", "course": COURSE, "stone": STONE}
    stones, findings = cp.read_dxf(path, thickness=0.4, **options)
    assert [code for code in findings.codes if code not in ("W12", "W24")] == ["W28"]
    fills(stones, (REGION.area - 0.8 * 2.0) * 0.4)
    assert "openings with a flat head and no lintel (2)" in str(findings)
    assert set(stones.panel[~stones.fixed]) == {"FACADE"}


def test_an_opening_is_cut_out_of_the_wall_that_it_is_drawn_in(tmp_path: Path):
    """Two walls in space: the door is in the front one alone, and the window, drawn on the inner face, in the one behind."""

    def upright(left: float, right: float, low: float, top: float, y: float, layer: str) -> None:
        frame = {"layer": layer, "extrusion": (0, -1, 0), "elevation": -y, "thickness": 0.5 if layer != "OPENING" else 0.0}
        corners = [(left, low), (right, low), (right, top), (left, top)]
        space.add_lwpolyline(corners, close=True, dxfattribs=frame)

    document = ezdxf.new("R2010", units=6)
    space = document.modelspace()
    upright(0, 6, 0, 3, 0.5, "FRONT")
    upright(0, 6, 0, 3, 5.0, "BACK")
    upright(1, 2, 0, 2, 0.0, "OPENING")
    upright(3, 4, 1, 2, 4.5, "OPENING")
    # In no wall, and before and behind both: no wall has it.
    upright(4, 5, 1, 2, 2.5, "OPENING")
    document.saveas(tmp_path / "room.dxf")
    options = {"support": "base", "unit_weight": 18e3, "bond": "running", "course": COURSE, "stone": STONE}
    stones, findings = cp.read_dxf(tmp_path / "room.dxf", **options)
    for wall, clear in (("FRONT", 18.0 - 2.0), ("BACK", 18.0 - 1.0)):
        assert stones.volume[stones.panel == wall].sum() == pytest.approx(0.5 * clear)
    assert "left out: 1 outlines of openings in no wall" in str(findings)


def test_a_shell_needs_cohesion_over_a_flat_head(tmp_path: Path):
    # Stress in a continuum is symmetric: shear dies out towards the free edge over the opening, and the layer there hangs.
    document = ezdxf.new("R2010", units=6)
    space = document.modelspace()
    space.add_lwpolyline([(0, 0), (3, 0), (3, 2.4), (0, 2.4)], close=True)
    space.add_lwpolyline([(1, 0), (2, 0), (2, 1.2), (1, 1.2)], close=True, dxfattribs={"layer": "OPENING"})
    document.saveas(tmp_path / "wall.dxf")
    options = {"support": "base", "unit_weight": 18e3, "bond": "running", "course": 0.2, "stone": 0.4, "thickness": 0.4}
    stones, findings = cp.read_dxf(tmp_path / "wall.dxf", **options)
    assert "No shell stands over it without cohesion" in str(findings)
    load = cp.LoadCase((1, 0, 0))
    state = cp.limit_analysis(stones, cp.find_contacts(stones), load, friction=0.6)
    # Computed with this code.
    assert state.load_factor == pytest.approx(0.4386, abs=1e-4)
    for cohesion, status in ((0.0, "unstable"), (10e3, "optimal")):
        masonry = cp.Material("default", 18e3, 0.6, cohesion)
        shell = cp.derive_shell(fit_panels(stones).building((masonry,)), element_size=0.3)
        assert cp.shell_limit_analysis(shell, load, [masonry]).status == status


def arc(left: float, right: float, level: float, rise: float, depth: float) -> list[tuple[float, float, float]]:
    """A segmental arch as a polyline with bulges: intrados from left to right, then the extrados back."""
    half = 0.5 * (right - left)
    radius = (half**2 + rise**2) / (2 * rise)
    x, y = 0.5 * (left + right), level + rise - radius
    angle = math.asin(half / radius)
    a, b = (radius + depth) * math.sin(angle), y + (radius + depth) * math.cos(angle)
    bulge = math.tan(angle / 2)
    return [(left, level, -bulge), (right, level, 0.0), (x + a, b, bulge), (x - a, b, 0.0)]


@pytest.mark.parametrize("rise", [0.2, 0.5])
def test_an_arch_drawn_in_a_wall_takes_its_place(tmp_path: Path, rise: float):
    document = ezdxf.new("R2010")
    document.header["$INSUNITS"] = 6
    space = document.modelspace()
    space.add_lwpolyline([(0, 0), (5, 0), (5, 3.5), (0, 3.5)], close=True, dxfattribs={"layer": "FACADE"})
    ring = arc(2.0, 3.0, 2.0, rise, 0.25)
    space.add_lwpolyline(ring, close=True, format="xyb", dxfattribs={"layer": "ARCH"})
    door = [(2.0, -0.1, 0.0), (3.0, -0.1, 0.0), (3.0, 2.0, -ring[0][2]), (2.0, 2.0, 0.0)]
    space.add_lwpolyline(door, close=True, format="xyb", dxfattribs={"layer": "OPENING"})
    path = tmp_path / "door.dxf"
    document.saveas(path)
    options = {"support": "base", "unit_weight": 18e3, "bond": "running", "course": COURSE, "stone": STONE}
    stones, findings = cp.read_dxf(path, thickness=0.4, **options)
    said = next(finding.found for finding in findings if finding.code == "W28")
    voussoirs = np.flatnonzero(np.char.find(stones.block_id, "ARCH-ring") >= 0)
    assert f"{len(voussoirs)} voussoirs" in said
    cp.check_soundness(stones, cp.find_contacts(stones))
    # The segment below the arch is open. Its chords leave the arc by a hundredth of the size of the ring, 1.5 m, at most.
    radius = (0.25 + rise**2) / (2 * rise)
    angle = math.asin(0.5 / radius)
    segment = radius**2 * (angle - math.sin(angle) * math.cos(angle))
    free = stones.volume[~stones.fixed].sum() / 0.4
    assert free == pytest.approx(17.5 - 2.0 - segment, abs=0.01 * 1.5 * 2 * radius * angle)


def test_a_corner_that_an_overlay_left_in_three_pieces_is_kept():
    # A rounding apart, each of the three looks like a corner on the straight side between the other two.
    crown = [(0.5 + n * 1e-16 * 4, 1.2) for n in (1, 0, -1)]
    outer, holes = outline_and_holes(shapely.Polygon([(0, 0), (1, 0), (1, 1), *crown, (0, 1)]))
    assert not holes
    np.testing.assert_allclose(outer, [(0, 0), (1, 0), (1, 1), (0.5, 1.2), (0, 1)], atol=1e-9)


def test_every_body_that_is_no_wall_is_named(tmp_path: Path):
    leaning, slanted = sheared(2, 1, 0.2), sheared(1, 0, 0.4)
    slanted[0][:, 0] += 6
    path = write_obj(volumes(box((-5, -1), (0, 0.4), (0, 3)), leaning, slanted), tmp_path / "a.obj")
    with pytest.raises(FindingsError) as caught:
        cp.read_stones(path, units="m", support="base", bond="running", course=COURSE, stone=STONE)
    errors = caught.value.findings.errors
    assert [finding.code for finding in errors] == ["E28", "E28"]
    assert all(finding.remedy and finding.position for finding in errors)


@pytest.mark.parametrize(("course", "said"), [(0.25, ""), (0.3, ", the top one of 0.2 m"), (1.9, ", the top one of 2 m")])
def test_the_height_of_a_top_course_that_is_no_whole_one_is_said(course: float, said: str, tmp_path: Path):
    wall = write_dxf_outlines(on_plate(box((0, 3), (0, 0.3), (0, 2))), tmp_path)
    _, findings = cp.read_dxf(wall, unit_weight=18e3, bond="running", course=course, stone=STONE)
    assert f"courses of {course:g} m{said}, about 0.5 m long" in str(findings)


def test_stones_of_an_arch_are_to_be_drawn_as_a_ring_where_stones_are_laid():
    angles = np.linspace(0.0, np.pi, 8)
    inner, outer = (radius * np.stack([np.cos(angles), np.sin(angles)], axis=1) for radius in (0.6, 0.9))
    first = shapely.Polygon([inner[0], outer[0], outer[1], inner[1]])
    with pytest.raises(InputError, match=r"it leans; .* a stone of an arch, draw the whole ring as one outline"):
        cp.lay_stones(volumes(standing(first, 0.3)), course=COURSE, stone=STONE)
