"""Two-dimensional drawings: outlines of stones in every way that people close them, extruded and stood up."""

import re
from collections.abc import Callable
from itertools import combinations, pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from ezdxf.filemanagement import new

from churchpipe.dxf.reader import Drawing, read_drawing
from churchpipe.findings import Findings, FindingsError
from churchpipe.geometry.nets import without_idle_corners
from churchpipe.stones.contacts import find_contacts
from churchpipe.stones.self_crossing import self_crossing_stones
from churchpipe.stones.soundness import check_soundness

BRICK = [(0.0, 0.0), (250.0, 0.0), (250.0, 65.0), (0.0, 65.0)]
# A filled area of four corners (SOLID, TRACE) has its third corner above the first.
CROSSWISE = [BRICK[k] for k in (0, 1, 3, 2)]


def drawn(path: Path, draw: Callable[[Any], object], *, unit: int = 4, ground: bool = True) -> Path:
    """Write a drawing of outlines, in mm unless said otherwise, on one wide outline of ground."""
    document = new("R2010")
    document.header["$INSUNITS"] = unit
    space = document.modelspace()
    if ground:
        wide = [(-500.0, -100.0), (1500.0, -100.0), (1500.0, 0.0), (-500.0, 0.0)]
        space.add_lwpolyline(wide, close=True, dxfattribs={"layer": "ground"})
    draw(space)
    document.saveas(path)
    return path


def read(path: Path, **options: Any) -> Drawing:
    return read_drawing(path, unit_weight=18e3, **({"thickness": 0.12} | options))


def codes(drawing: Drawing) -> list[str]:
    return [code for code in drawing.findings.codes if code != "W24"]


def findings_of(path: Path, **options: Any) -> Findings:
    with pytest.raises(FindingsError) as caught:
        read(path, **options)
    return caught.value.findings


def _cubic(space: Any) -> None:
    """Add a spline of straight spans between corners at knots of full multiplicity, as programs of illustration write it."""
    corners = np.array([(*point, 0.0) for point in [*BRICK, BRICK[0]]])
    points = [a + share * (b - a) for a, b in pairwise(corners) for share in (0, 1 / 3, 2 / 3)] + [corners[-1]]
    space.add_spline(degree=3).control_points = points
    space.query("SPLINE")[-1].knots = [0.0] * 4 + [float(k) for k in (1, 2, 3) for _ in range(3)] + [4.0] * 4


def _fitted(space: Any) -> None:
    """Add an old polyline with its frame, which is not seen, and the vertices fitted to that."""
    line = space.add_polyline2d([(0, 0), (500, 0), (500, 500)], close=True)
    line.dxf.flags |= line.SPLINE_FIT_VERTICES_ADDED
    for vertex in line.vertices:
        vertex.dxf.flags |= vertex.SPLINE_FRAME_CONTROL_POINT
    for corner in BRICK:
        line.append_vertex(corner, dxfattribs={"flags": 8})


WAYS: dict[str, tuple[Callable[[Any], object], list[str]]] = {
    "by its flag": (lambda space: space.add_lwpolyline(BRICK, close=True), []),
    "first point repeated": (lambda space: space.add_lwpolyline([*BRICK, BRICK[0]]), []),
    "flag and first point repeated": (lambda space: space.add_lwpolyline([*BRICK, BRICK[0]], close=True), []),
    "old polyline": (lambda space: space.add_polyline2d(BRICK, close=True), []),
    "polyline in space": (lambda space: space.add_polyline3d([(x, y, 0) for x, y in BRICK], close=True), []),
    "spline of the first degree": (
        lambda space: space.add_open_spline([(x, y, 0) for x, y in [*BRICK, BRICK[0]]], degree=1),
        [],
    ),
    "spline of the third degree with corners": (lambda space: _cubic(space), []),
    "a spline fitted to an old polyline": (lambda space: _fitted(space), []),
    "clockwise": (lambda space: space.add_lwpolyline(BRICK[::-1], close=True), []),
    "doubled points": (lambda space: space.add_lwpolyline([BRICK[0], *BRICK, BRICK[3]], close=True), []),
    "corners on its sides": (
        lambda space: space.add_lwpolyline([BRICK[0], (99, 0), *BRICK[1:], (0, 40), (0, 20)], close=True),
        [],
    ),
    "ends that nearly meet": (lambda space: space.add_lwpolyline([*BRICK, (0, 2)]), ["W25"]),
    "ends that overrun": (lambda space: space.add_lwpolyline([(-4, 0), *BRICK[1:], (0, -3)]), ["W25"]),
    "a side left out": (lambda space: space.add_lwpolyline(BRICK), ["W25"]),
    "a hatch": (lambda space: space.add_hatch().paths.add_polyline_path(BRICK, is_closed=True), []),
    "a hatch said to be open": (lambda space: space.add_hatch().paths.add_polyline_path(BRICK, is_closed=False), ["W25"]),
    "a hatch of three sides": (
        lambda space: [
            space.add_hatch().paths.add_edge_path() if k == 0 else space[-1].paths[-1].add_line(BRICK[k - 1], BRICK[k])
            for k in range(4)
        ],
        ["W25"],
    ),
    "a hatch of four sides": (
        lambda space: [
            space.add_hatch().paths.add_edge_path() if k == 0 else space[-1].paths[-1].add_line(BRICK[k - 1], BRICK[k % 4])
            for k in range(5)
        ],
        [],
    ),
    "a hatch on its outline": (
        lambda space: (
            space.add_lwpolyline(BRICK, close=True),
            space.add_hatch().paths.add_polyline_path(BRICK, is_closed=True),
        ),
        [],
    ),
    "a polygon with a filling": (lambda space: space.add_mpolygon().paths.add_polyline_path(BRICK, is_closed=True), []),
    "a filled area of four corners": (lambda space: space.add_solid(CROSSWISE), []),
    "the same of old": (lambda space: space.add_trace(CROSSWISE), []),
    "a filled area on its outline": (lambda space: [space.add_lwpolyline(BRICK, close=True), space.add_solid(CROSSWISE)], []),
    "four lines": (lambda space: [space.add_line(a, b) for a, b in zip(BRICK, BRICK[1:] + BRICK[:1], strict=True)], []),
    "its own thickness": (lambda space: space.add_lwpolyline(BRICK, close=True, dxfattribs={"thickness": 120.0}), []),
}


@pytest.mark.parametrize("way", WAYS)
def test_an_outline_is_a_stone_however_it_is_closed(way: str, tmp_path: Path) -> None:
    draw, expected = WAYS[way]
    drawing = read(drawn(tmp_path / "a.dxf", draw))
    assert codes(drawing) == expected
    assert drawing.stones.fixed.tolist() == [True, False]
    assert drawing.stones.panel.tolist() == ["", "wall"]
    assert drawing.stones.volume[1] == pytest.approx(0.250 * 0.065 * 0.120, rel=1e-9)
    low, high = (getattr(drawing.stones.points[-8:], side)(axis=0) for side in ("min", "max"))
    np.testing.assert_allclose(high - low, (0.25, 0.12, 0.065), atol=1e-9)
    assert low[2] == pytest.approx(0.0, abs=1e-12)
    assert "the drawing's x-y is taken for the elevation x-z" in str(drawing.findings)


def test_elevation_places_a_wall_behind_and_thickness_goes_before_what_is_passed(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        space.add_lwpolyline(BRICK, close=True, dxfattribs={"elevation": 300.0, "thickness": 200.0, "layer": "BACK"})

    stones = read(drawn(tmp_path / "a.dxf", draw)).stones
    assert stones.panel.tolist() == ["", "BACK"]
    assert stones.volume[1] == pytest.approx(0.25 * 0.065 * 0.2)
    np.testing.assert_allclose((stones.points[-8:, 1].min(), stones.points[-8:, 1].max()), (-0.5, -0.3), atol=1e-12)


def test_a_plan_stays_lying(tmp_path: Path) -> None:
    drawing = read(
        drawn(tmp_path / "a.dxf", lambda space: space.add_lwpolyline(BRICK, close=True), ground=False), plane="xy", support="base"
    )
    np.testing.assert_allclose(np.ptp(drawing.stones.points[:8], axis=0), (0.25, 0.065, 0.12), atol=1e-12)
    assert "elevation" not in str(drawing.findings)


def test_a_wall_drawn_upright_in_space_stays_where_it_is(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        space.add_lwpolyline(BRICK, close=True, dxfattribs={"extrusion": (0, -1, 0), "elevation": 40.0})

    stones = read(drawn(tmp_path / "a.dxf", draw, ground=False), support="base").stones
    np.testing.assert_allclose(stones.points[:8].min(axis=0), (0, -0.16, 0), atol=1e-12)
    np.testing.assert_allclose(stones.points[:8].max(axis=0), (0.25, -0.04, 0.065), atol=1e-12)


@pytest.mark.parametrize(("seed", "joint", "unit", "metre"), [(1, 0.01, 6, 1.0), (2, 0.015, 5, 100.0), (3, 0.02, 2, 1 / 0.3048)])
def test_rubble_with_mortar_keeps_every_joint(seed: int, joint: float, unit: int, metre: float, tmp_path: Path) -> None:
    # Cells around points by chance, less half a joint all round; in metres, centimetres and feet. Their common edges are counted
    # before the mortar is left out.
    chance = np.random.default_rng(seed)
    grid = np.stack(np.meshgrid(np.arange(0.1, 1.4, 0.2), np.arange(0.08, 1.0, 0.16)), -1).reshape(-1, 2)
    wall = shapely.box(0, 0, 1.4, 0.96)
    points = shapely.MultiPoint(grid + chance.uniform(-0.05, 0.05, grid.shape))
    cells = [cell & wall for cell in shapely.get_parts(shapely.voronoi_polygons(points, extend_to=wall))]
    common = [(i, j, float((cells[i] & cells[j]).length)) for i, j in combinations(range(len(cells)), 2)]

    def draw(space: Any) -> None:
        for cell in cells:
            corners = shapely.get_coordinates(cell.buffer(-0.5 * joint, join_style="mitre"))[:-1]
            space.add_lwpolyline((metre * corners).tolist(), close=True)

    path = drawn(tmp_path / "rubble.dxf", draw, unit=unit, ground=False)
    stones = read(path, joint=joint, support="base").stones
    blocks = find_contacts(stones).blocks
    order = {name: number for number, name in enumerate(stones.block_id[~stones.fixed])}
    assert len(order) == len(cells)
    pairs = stones.block_id[blocks[~stones.fixed[blocks].any(axis=1)]]
    found = {tuple(sorted((order[first], order[second]))) for first, second in pairs}
    assert {(i, j) for i, j, length in common if length > 1.2 * joint} <= found
    assert found <= {(i, j) for i, j, length in common if length > 0}


FRAME = [(0.0, 0.0), (400.0, 0.0), (400.0, 400.0), (0.0, 400.0)]
HOLE = [(150.0, 100.0), (250.0, 100.0), (250.0, 300.0), (150.0, 300.0)]
PLUG = [(150.0, 100.0), (250.0, 100.0), (250.0, 200.0), (150.0, 200.0)]


def hatched(space: Any, *boundaries: list[tuple[float, float]], flags: tuple[int, ...] = (1, 16, 0), style: int = 0) -> None:
    """One hatch with boundaries as AutoCAD marks them: 1 external, 16 outermost, 0 further in, 8 about a text."""
    hatch = space.add_hatch(dxfattribs={"hatch_style": style})
    for corners, flag in zip(boundaries, flags, strict=False):
        hatch.paths.add_polyline_path(corners, is_closed=True, flags=flag)


def outlined(space: Any, *boundaries: list[tuple[float, float]], layer: str = "0") -> None:
    for corners in boundaries:
        space.add_lwpolyline(corners, close=True, dxfattribs={"layer": layer})


IN_HOLE = [(190.0, 100.0), (210.0, 100.0), (210.0, 300.0), (190.0, 300.0)]
# What is drawn: areas of the stones (m2), joints of these with each other and the ground, findings.
NESTS: dict[str, tuple[Callable[[Any], object], list[float], int, list[str]]] = {
    "an island of a hatch": (lambda s: hatched(s, FRAME, HOLE), [0.14], 1, ["W29"]),
    "unmarked, the island first": (lambda s: hatched(s, HOLE, FRAME, flags=(0, 0)), [0.14], 1, ["W29"]),
    "a hatch on its outer outline": (lambda s: (outlined(s, FRAME), hatched(s, FRAME, HOLE)), [0.14], 1, ["W29"]),
    "an island in an island": (lambda s: hatched(s, FRAME, HOLE, IN_HOLE), [0.14, 0.004], 3, ["W29"]),
    "a stone in the island": (lambda s: (hatched(s, FRAME, HOLE), outlined(s, PLUG)), [0.14, 0.01], 4, ["W29"]),
    "a hatched stone that fills it": (lambda s: (hatched(s, FRAME, HOLE), hatched(s, HOLE)), [0.14, 0.02], 5, ["W29"]),
    "a text in a hatch": (lambda s: hatched(s, FRAME, HOLE, flags=(1, 8)), [0.16], 1, []),
    "a hatch that ignores islands": (lambda s: hatched(s, FRAME, HOLE, style=2), [0.16], 1, []),
    "a void on its layer": (lambda s: (outlined(s, FRAME), outlined(s, HOLE, layer="OPENING")), [0.14], 1, ["W29"]),
    "a window between stones": (
        lambda s: (outlined(s, FRAME), outlined(s, [(x + 300, y) for x, y in HOLE], layer="OPENING")),
        [0.16],
        1,
        ["W18"],
    ),
}


@pytest.mark.parametrize("name", NESTS)
def test_voids_of_stones_are_cut_out_and_told(name: str, tmp_path: Path) -> None:
    draw, areas, joints, expected = NESTS[name]
    drawing = read(drawn(tmp_path / "a.dxf", draw))
    stones = drawing.stones
    assert codes(drawing) == expected
    np.testing.assert_allclose(np.sort(stones.volume[~stones.fixed])[::-1], 0.12 * np.array(areas), rtol=1e-9)
    contacts = find_contacts(stones)
    assert len(contacts.blocks) == joints
    check_soundness(stones, contacts)


def test_a_void_is_cut_out_of_the_stone_that_it_is_drawn_in(tmp_path: Path) -> None:
    """Two stones in space, one 4 m behind the other; the void is drawn on the inner face of the one behind."""

    def draw(space: Any) -> None:
        sizes = ((1.5, 1.2, 0.5, 0.5, "A"), (1.8, 1.0, 5.0, 0.5, "B"), (0.5, 0.4, 4.5, 0.0, "OPENING"))
        for width, height, y, thickness, layer in sizes:
            frame = {"layer": layer, "extrusion": (0, -1, 0), "elevation": -1000 * y, "thickness": 1000 * thickness}
            corners = [(0.1, 0.1), (0.1 + width, 0.1), (0.1 + width, 0.1 + height), (0.1, 0.1 + height)]
            shift = 0.3 if layer == "OPENING" else 0.0
            space.add_lwpolyline([(1000 * (u + shift), 1000 * (v + shift)) for u, v in corners], close=True, dxfattribs=frame)

    drawing = read(drawn(tmp_path / "a.dxf", draw, ground=False), support="base")
    stones = drawing.stones
    volumes = {name: float(stones.volume[stones.panel == name].sum()) for name in ("A", "B")}
    assert volumes == pytest.approx({"A": 0.5 * 1.8, "B": 0.5 * (1.8 - 0.2)})


def test_a_stone_in_a_void_meets_it_across_the_mortar(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        hatched(space, FRAME, HOLE)
        outlined(space, [(160, 110), (240, 110), (240, 290), (160, 290)])

    stones = read(drawn(tmp_path / "a.dxf", draw), joint=0.01).stones
    np.testing.assert_allclose(stones.volume[1:].sum(), 0.16 * 0.12, rtol=1e-9)
    assert len(find_contacts(stones).blocks) == 5


@pytest.mark.parametrize("mortar", [False, True])
def test_whether_the_border_of_a_void_is_a_stone_is_asked(mortar: bool, tmp_path: Path) -> None:
    """A stone with a hole looks like the mortar around a stone: nothing but the person tells them apart."""

    def draw(space: Any) -> None:
        hatched(space, FRAME, HOLE)
        outlined(space, *([HOLE] if mortar else [FRAME, HOLE]))

    text = str(findings_of(drawn(tmp_path / "a.dxf", draw)))
    assert "E29 a.dxf: LWPOLYLINE #" in text
    assert "the outline is the border of a void in a hatch, of a stone or of mortar; its layer is 0" in text
    assert "Put it on a layer OPENING if it is a void, hatch it if it is a stone" in text


def test_the_contour_of_a_wall_is_named_once(tmp_path: Path) -> None:
    bricks = [[(x + 250 * i, y + 65 * row) for x, y in BRICK] for row in range(3) for i in range(2)]
    contour = [(0.0, 0.0), (500.0, 0.0), (500.0, 195.0), (0.0, 195.0)]
    text = str(findings_of(drawn(tmp_path / "a.dxf", lambda space: outlined(space, *bricks, contour))))
    assert "E29 a.dxf: LWPOLYLINE #" in text
    assert "6 outlines lie inside this one, whose layer is 0; theirs: 0 (6)" in text


def test_an_outline_in_another_is_asked_about(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        for outline, layer in ((FRAME, "WALL"), (HOLE, "WINDOWS")):
            space.add_lwpolyline(outline, close=True, dxfattribs={"layer": layer})

    text = str(findings_of(drawn(tmp_path / "a.dxf", draw)))
    assert "E29 a.dxf: LWPOLYLINE #" in text
    assert re.search("the outline, on layer WINDOWS, lies inside that of LWPOLYLINE #.*, on layer WALL", text)
    assert "OPENING" in text


@pytest.mark.parametrize("height", ["230\nnan", "230\ninf", "23\n2"])
def test_an_outline_in_no_plane_is_named(height: str, tmp_path: Path) -> None:
    """The third number of a direction is none, or is lost with its group code, so that nothing is left of (0, 0, 1)."""
    path = drawn(tmp_path / "no_plane.dxf", lambda space: space.add_hatch().paths.add_polyline_path(BRICK))
    before, hatch = path.read_text().replace("\r\n", "\n").split("\nHATCH\n")
    assert "\n230\n1.0\n" in hatch
    path.write_text("\nHATCH\n".join((before, hatch.replace("\n230\n1.0\n", f"\n{height}\n"))))
    findings = findings_of(path)
    assert "E03" in findings.codes
    assert any("the direction of its extrusion" in finding.found for finding in findings)


def test_a_depth_beyond_all_numbers_is_named(tmp_path: Path) -> None:
    path = drawn(tmp_path / "wall.dxf", lambda space: space.add_lwpolyline(BRICK, close=True, dxfattribs={"thickness": 1e308}))
    assert "E10" in findings_of(path).codes


@pytest.mark.parametrize("scale", [1.0, 1e10])
def test_corners_beyond_all_numbers_are_named(scale: float, tmp_path: Path) -> None:
    def wall(space: Any) -> None:
        block = space.doc.blocks.new("B")
        block.add_polyline3d([(0, 0, 0), (1, 0, 0), (1, 0, 1e308), (0, 0, 1)], close=True)
        space.add_blockref("B", (0, 0), dxfattribs={"xscale": scale, "yscale": scale, "zscale": scale})

    assert "E10" in findings_of(drawn(tmp_path / "wall.dxf", wall)).codes


@pytest.mark.parametrize("number", range(12))
def test_an_outline_among_others_is_kept_without_its_last_side(number: int, tmp_path: Path) -> None:
    # Its sides lie on those of its neighbours, and the one left out may be on the free face of the wall.
    bricks = [[(x + 250 * i + 125 * (row % 2), y + 65 * row) for x, y in BRICK] for row in range(4) for i in range(3)]

    def draw(space: Any) -> None:
        for k, corners in enumerate(bricks):
            space.add_lwpolyline(corners, close=k != number)

    drawing = read(drawn(tmp_path / "wall.dxf", draw))
    free = ~drawing.stones.fixed
    assert int(free.sum()) == 12
    assert float(drawing.stones.volume[free].sum()) == pytest.approx(12 * 0.25 * 0.065 * 0.12)


def test_a_net_of_lines_makes_a_stone_of_each_mesh(tmp_path: Path) -> None:
    # An outline 1000 x 195 with two beds and a head joint a course; lines end on it, or a little short.
    def draw(space: Any) -> None:
        space.add_lwpolyline([(0, 0), (1000, 0), (1000, 195), (0, 195)], close=True)
        for line in ([(0, 65), (1000, 65)], [(0, 130), (1000, 130)], [(500, 0), (500, 65)], [(250, 65), (250, 130)]):
            space.add_line(*line)
        space.add_line((700, 130.0), (700, 194.99))
        space.add_line((3000, 0), (3000, 500))

    drawing = read(drawn(tmp_path / "a.dxf", draw))
    assert codes(drawing) == ["W18"]
    assert "1 lines that close nothing" in str(drawing.findings)
    stones = drawing.stones
    assert int((~stones.fixed).sum()) == 6
    assert stones.volume[~stones.fixed].sum() == pytest.approx(1.0 * 0.195 * 0.12, rel=1e-9)


@pytest.mark.parametrize("upright", [False, True])
def test_what_lines_enclose_that_is_no_stone_is_told_where_it_is(upright: bool, tmp_path: Path) -> None:
    # Three lines across a frame of 4 m x 3 m pass .1 m from one point; a fourth line nearly coincides with the right side.
    frame = [[(0, 0), (4, 0)], [(4, 0), (4, 3)], [(4, 3), (0, 3)], [(0, 3), (0, 0)]]
    across = [[(0, 0.5), (4, 2.5)], [(0, 2.5), (4, 0.5)], [(2.1, 0), (2.1, 3)], [(3.994, 0), (4, 3)]]

    def draw(space: Any) -> None:
        for ends in [*frame, *across]:
            # Upright, the frame is in the plane y = 7 m, with z up.
            out = {"extrusion": (0, -1, 0) if upright else (0, 0, 1)}
            space.add_line(*([(x, 7, y) if upright else (x, y, 0) for x, y in ends]), dxfattribs=out)

    path = drawn(tmp_path / "net.dxf", draw, unit=6, ground=False)
    told = [finding for finding in read(path, support="base").findings if finding.code == "W25"]
    (small,) = (finding for finding in told if "crosses others" in finding.found)
    # The diagonals cut the film into three.
    films = [finding for finding in told if "taken for one" in finding.found]
    assert len(told) == 1 + len(films) == 4
    place = (2.0667, 7.0, 1.5) if upright else (2.0667, 1.5, 0.0)
    assert small.position == pytest.approx(place, abs=1e-4)
    np.testing.assert_allclose(small.lengths, [0.1118, 0.0309], atol=1e-4)
    assert sum(film.lengths[0] for film in films) == pytest.approx(3.0, abs=1e-2)
    assert all(film.position is not None and 3.994 < film.position[0] < 4 for film in films)


def test_curved_sides_are_chords_and_told(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        space.add_lwpolyline([(0, 0, 0.05), (250, 0, 0), (250, 65, 0), (0, 65, 0)], format="xyb", close=True)

    drawing = read(drawn(tmp_path / "a.dxf", draw, ground=False), plane="xy", support="base")
    assert codes(drawing) == ["W27", "W12"]
    # The bulge b = .05 of a chord c bellies out by b c / 2 and adds nearly 2/3 of that along the chord.
    assert drawing.stones.volume[0] == pytest.approx((0.25 * 0.065 + 2 / 3 * 0.05 * 0.25 / 2 * 0.25) * 0.12, rel=0.02)


@pytest.mark.parametrize("over", [0.0, 2.0, 10.0, 20.0, -2.0, -5.0])
def test_lines_of_a_net_may_run_past_each_other_or_stop_short(over: float, tmp_path: Path) -> None:
    """Beds over the whole wall, head joints a course high; an axis that goes on far beyond the wall is no joint."""

    def draw(space: Any) -> None:
        for row in range(6):
            space.add_line((-over, row * 200), (2000 + over, row * 200))
        for row in range(5):
            for x in np.unique([0, *range(0 if row % 2 else 250, 2001, 500), 2000]):
                space.add_line((x, row * 200 - over), (x, row * 200 + 200 + over))
        space.add_line((1100, -300), (1100, 1400))

    drawing = read(drawn(tmp_path / "a.dxf", draw, ground=False), support="base")
    assert set(codes(drawing)) == {"W12", "W18"} | ({"W25"} if over else set())
    assert "1 lines that close nothing" in str(drawing.findings)
    assert ("if it was not meant to meet that line" in str(drawing.findings)) == bool(over)
    stones = drawing.stones
    assert int((~stones.fixed).sum()) == 3 * 5 + 2 * 4
    assert stones.volume[~stones.fixed].sum() == pytest.approx(2.0 * 1.0 * 0.12, rel=1e-9)


@pytest.mark.parametrize("first", range(4))
def test_a_corner_drawn_at_the_start_and_at_the_end_is_kept(first: int) -> None:
    # A rounding apart, each of the two looks like a corner on the side that begins at the other.
    corners = np.roll(np.array(BRICK), first, axis=0)
    closed = np.concatenate([corners, corners[:1] + 1e-12])
    np.testing.assert_allclose(np.sort(without_idle_corners(closed), axis=0), np.sort(corners, axis=0), atol=1e-9)


def bulged_ring(space: Any, radius: float, depth: float, joints: list[float], mortar: float) -> None:
    """Voussoirs (mm) between joints at these angles, intrados and extrados as bulges, with mortar between them."""
    for start, stop in pairwise(joints):
        inner, outer = ([(r, a) for a in (start + mortar / 2 / r, stop - mortar / 2 / r)] for r in (radius, radius + depth))
        corners = [*inner[::-1], *outer]
        bulges = [-np.tan((inner[1][1] - inner[0][1]) / 4), 0, np.tan((outer[1][1] - outer[0][1]) / 4), 0]
        points = [(r * np.cos(a), r * np.sin(a), b) for (r, a), b in zip(corners, bulges, strict=True)]
        space.add_lwpolyline(points, format="xyb", close=True)


@pytest.mark.parametrize(
    ("first", "second", "mortar"),
    [(21, 21.3, 10.0), (21, 21.3, 0.0), (11, 11.3, 10.0), (11, 11.3, 0.0), (13, 17, 12.0), (21, 21, 10.0), (7, 7.5, 0.0)],
)
def test_rings_of_an_arch_meet_wherever_their_joints_are(first: int, second: float, mortar: float, tmp_path: Path) -> None:
    """Of curved voussoirs whose joints are staggered no chord leans against the one beside it. 21.3: shifted by .3 of a stone."""
    shift = second % 1
    lower = np.linspace(0, np.pi, first + 1).tolist()
    upper = [0.0, *((np.arange(0 if shift else 1, int(second)) + shift) * np.pi / int(second)).tolist(), np.pi]

    def draw(space: Any) -> None:
        bulged_ring(space, 1000, 200, lower, mortar)
        bulged_ring(space, 1200 + mortar, 200, upper, mortar)

    options = {"joint": mortar / 1000} if mortar else {}
    stones = read(drawn(tmp_path / "a.dxf", draw, ground=False), support="base", **options).stones
    contacts = find_contacts(stones)
    free = contacts.blocks[~stones.fixed[contacts.blocks].any(axis=1)]
    beside = sum(min(b, d) - max(a, c) > 1e-3 for a, b in pairwise(lower) for c, d in pairwise(upper))
    assert len(np.unique(np.sort(free), axis=0)) == len(lower) - 2 + len(upper) - 2 + beside
    assert not len(contacts.near_misses.gap)


@pytest.mark.parametrize("shift", [0.3, 0.5])
def test_loose_arcs_beside_closed_outlines_enclose_no_slivers(shift: float, tmp_path: Path) -> None:
    """The lower ring is loose arcs and joints, the upper one closed outlines: unlike chords of one curve enclosed films, each
    a stone that no drawing has."""
    lower = np.linspace(0, np.pi, 10)
    upper = [0.0, *((np.arange(9) + shift) * np.pi / 9).tolist(), np.pi]

    def draw(space: Any) -> None:
        for start, stop in pairwise(np.degrees(lower).tolist()):
            for radius in (1000, 1200):
                space.add_arc((0, 0), radius, start, stop)
        for a in lower:
            space.add_line((1000 * np.cos(a), 1000 * np.sin(a)), (1200 * np.cos(a), 1200 * np.sin(a)))
        bulged_ring(space, 1200, 200, upper, 0.0)

    stones = read(drawn(tmp_path / "a.dxf", draw, ground=False), support="base").stones
    contacts = find_contacts(stones)
    free = contacts.blocks[~stones.fixed[contacts.blocks].any(axis=1)]
    beside = sum(min(b, d) - max(a, c) > 1e-3 for a, b in pairwise(lower.tolist()) for c, d in pairwise(upper))
    assert (~stones.fixed).sum() == 9 + 10
    assert len(np.unique(np.sort(free), axis=0)) == 8 + 9 + beside


@pytest.mark.parametrize("count", [7, 9, 15])
@pytest.mark.parametrize("overrun", [0.0, 5.0, -5.0])
def test_an_arch_of_two_arcs_and_radial_lines(overrun: float, count: int, tmp_path: Path) -> None:
    """The lower arc closes over an empty place, but the room under it is no stone. The arcs have corners where the lines end."""

    def draw(space: Any) -> None:
        for radius in (1000, 1300):
            space.add_arc((0, 0), radius, 0, 180)
        for number, angle in enumerate(np.linspace(0, np.pi, count + 1)):
            past = overrun if 0 < number < count else 0.0
            ends = [(r * np.cos(angle), r * np.sin(angle)) for r in (1000 - past, 1300 + past)]
            space.add_line(*ends)

    drawing = read(drawn(tmp_path / "a.dxf", draw, ground=False), support="base")
    stones = drawing.stones
    contacts = find_contacts(stones)
    free = contacts.blocks[~stones.fixed[contacts.blocks].any(axis=1)]
    assert (int((~stones.fixed).sum()), len(free)) == (count, count - 1)
    assert stones.volume[~stones.fixed] == pytest.approx([0.5 * np.pi * (1.3**2 - 1) * 0.12 / count] * count, rel=0.01)
    assert contacts.area[~stones.fixed[contacts.blocks].any(axis=1)] == pytest.approx([0.3 * 0.12] * (count - 1), rel=2e-3)
    # Lines that end on the arcs miss nothing; those that overrun, or fall short, are told.
    assert set(codes(drawing)) == {"W12", "W27"} | ({"W25"} if overrun else set())
    away = [finding.lengths[0] for finding in drawing.findings if finding.code == "W27"]
    assert len(away) == 2
    assert max(away) < 0.01 * 1.3 * np.pi / count


def test_a_wheel_of_two_circles_and_spokes_has_stones_alike(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        for radius in (900, 1200):
            space.add_circle((0, 0), radius)
        for angle in np.arange(14) * 2 * np.pi / 14 + 0.1:
            space.add_line(*((r * np.cos(angle), r * np.sin(angle)) for r in (900, 1200)))

    stones = read(drawn(tmp_path / "a.dxf", draw, ground=False), support="base").stones
    assert stones.volume[~stones.fixed][:-1].max() > 0.25  # the round in the middle is an area of the net too
    ring = np.sort(stones.volume[~stones.fixed])[:-1]
    assert ring == pytest.approx([np.pi * (1.2**2 - 0.9**2) * 0.12 / 14] * 14, rel=0.01)


@pytest.mark.parametrize(
    ("points", "what"),
    [
        ([(0, 0), (250, 65), (250, 0), (0, 65)], "crosses itself"),
        ([(0, 0), (250, 0), (100, 0)], "encloses nothing"),
    ],
)
def test_outlines_that_are_none_are_errors_with_their_place(points: list, what: str, tmp_path: Path) -> None:
    text = str(findings_of(drawn(tmp_path / "a.dxf", lambda space: space.add_lwpolyline(points, close=True))))
    assert f"m: the outline {what}" in text


def test_arrowheads_of_a_dimension_that_was_exploded_are_left_out(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        space.add_lwpolyline(BRICK, close=True)
        space.add_line((0, 100), (250, 100))
        for tip, way in ((0, 1), (250, -1)):
            space.add_solid([(tip, 100), (tip + 10 * way, 103), (tip + 10 * way, 97)])

    drawing = read(drawn(tmp_path / "a.dxf", draw))
    assert (~drawing.stones.fixed).sum() == 1
    assert "2 SOLID of three corners, as arrowheads are" in str(drawing.findings)


def test_points_are_passed_over_and_texts_and_dimensions_counted(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        space.add_lwpolyline(BRICK, close=True)
        space.add_point((0, 0))
        space.add_point((250, 0))
        space.add_text("Elevation A").set_placement((0, -200))
        space.add_linear_dim(base=(0, -150), p1=(0, 0), p2=(250, 0)).render()

    drawing = read(drawn(tmp_path / "a.dxf", draw))
    assert codes(drawing) == ["W18"]
    assert "left out: 1 DIMENSION (no solid), 1 TEXT (no solid)" in str(drawing.findings), "a point is never a stone"
    assert drawing.stones.fixed.tolist() == [True, False]


def test_what_is_missing_is_asked_for(tmp_path: Path) -> None:
    path = drawn(tmp_path / "a.dxf", lambda space: space.add_lwpolyline(BRICK, close=True))
    assert "E24 a.dxf: LWPOLYLINE" in (text := str(findings_of(path, thickness=None)))
    assert "--thickness 0.12m" in text
    assert "the lowest stones are" in str(
        findings_of(drawn(tmp_path / "b.dxf", lambda s: s.add_lwpolyline(BRICK, close=True), ground=False))
    )


@pytest.mark.parametrize(("given", "said"), [(0.12, False), (0.09, True), (None, False)])
def test_a_thickness_that_outlines_do_not_take_is_told(given: float | None, said: bool, tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        space.add_lwpolyline(BRICK, close=True, dxfattribs={"thickness": -120.0})

    path = drawn(tmp_path / "a.dxf", draw, ground=False)
    words = "; 1 of them has a DXF thickness of its own, 0.12 m, which goes before the one given"
    assert (words in str(read(path, thickness=given, support="base").findings)) == said


def test_lines_beside_solids_stay_left_out(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        with space.add_mesh().edit_data() as mesh:
            mesh.vertices = [(x, y, z) for z in (0, 500) for x, y in ((0, 0), (400, 0), (400, 200), (0, 200))]
            mesh.faces = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
        space.add_lwpolyline(BRICK, close=True)

    drawing = read(drawn(tmp_path / "a.dxf", draw), thickness=None, support="base")
    assert "left out: 2 LWPOLYLINE (no solid)" in str(drawing.findings)
    assert drawing.stones.count == 2


def course(space: Any, gap: float, unit: float = 1.0) -> None:
    for left, low in ((0, 0), (250 + gap, 0), (130, 65 + gap)):
        space.add_lwpolyline(
            [(unit * (x + left), unit * (y + low)) for x, y in BRICK], close=True, dxfattribs={"layer": "FACADE"}
        )


def test_joints_left_open_are_named_with_their_width(tmp_path: Path) -> None:
    text = str(findings_of(drawn(tmp_path / "a.dxf", lambda space: course(space, 10.0))))
    assert "E26 a.dxf: 3 gaps between the stones, 0.01 m: expected" in text
    assert "Pass --joint 10mm" in text


def springing(space: Any) -> None:
    """The block beside the springing of an arch, its curved side in many chords, and two straight voussoirs; cm."""
    arc = np.pi / 32 * np.arange(1, 3)
    side = [(300 - 95.4987, 150.5), *zip(300 - 95.5 * np.cos(arc), 150 + 95.5 * np.sin(arc), strict=True), (300 - 92.3038, 174.5)]
    space.add_lwpolyline([(200.5, 174.5), (200.5, 150.5), *side], close=True)
    for first in (0.0, np.pi / 9):
        last = first + np.pi / 9
        ends = (60, first + 0.5 / 60), (95, first + 0.5 / 95), (95, last - 0.5 / 95), (60, last - 0.5 / 60)
        space.add_lwpolyline([(300 - r * np.cos(angle), 150 + r * np.sin(angle)) for r, angle in ends], close=True)


def test_a_joint_too_wide_to_be_closed_is_told(tmp_path: Path) -> None:
    # Three bricks on the ground with mortar of 10 mm; the second head joint is 17 mm wide.
    def draw(space: Any) -> None:
        for left in (0, 260, 527):
            space.add_lwpolyline([(left, 10), (left + 250, 10), (left + 250, 75), (left, 75)], close=True)

    drawing = read(drawn(tmp_path / "wall.dxf", draw), joint=0.01)
    told = [finding for finding in drawing.findings if finding.code == "W26" and "stays open" in finding.found]
    (gap,) = told
    assert gap.lengths[0] == pytest.approx(0.017)
    assert gap.handle
    assert len(find_contacts(drawing.stones).area) == 4


def test_a_stone_that_crosses_itself_once_it_is_grown_is_not_blamed_on_the_drawing(tmp_path: Path) -> None:
    path = drawn(tmp_path / "a.dxf", springing, unit=5, ground=False)
    options = {"thickness": 0.6, "joint": 0.01, "support": "base"}
    found = findings_of(path, **options)
    (error,) = found.errors
    # The stone is named by its place in the drawing, and the remedy is one.
    assert error.place == "LWPOLYLINE #2F at (2.005, 1.745, 0.00) m"
    assert f"E26 a.dxf: {error.place}: grown into its mortar, the surface of this stone crosses itself" in str(found)
    assert "Pass --joint-mode keep" in error.remedy
    kept = read(path, **options, joint_mode="keep")
    assert not self_crossing_stones(kept.stones)


def test_stones_grow_until_they_meet_in_the_middle_of_the_joint(tmp_path: Path) -> None:
    path = drawn(tmp_path / "a.dxf", lambda space: course(space, 10.0))
    drawing = read(path, joint=0.010)
    assert codes(drawing) == ["W26"]
    assert len(find_contacts(drawing.stones).blocks) == 2 + 1 + 2
    # Each lower brick gains 5 mm of bed and of head, the upper one 5 mm of bed.
    grown = [0.255 * 0.070 * 0.12, 0.255 * 0.070 * 0.12, 0.250 * 0.070 * 0.12]
    np.testing.assert_allclose(drawing.stones.volume[1:], grown, rtol=1e-9)
    assert "3 joints of 0.01 m; stones 0.00585 m3, with their mortar 0.006384 m3" in str(drawing.findings)
    light = read(path, joint=0.010, mortar="ignored").stones
    np.testing.assert_allclose(light.weight[1:], 18e3 * 0.250 * 0.065 * 0.12, rtol=1e-9)


def test_stones_kept_as_drawn_may_carry_the_weight_of_their_mortar(tmp_path: Path) -> None:
    path = drawn(tmp_path / "a.dxf", lambda space: course(space, 10.0))
    kept = read(path, joint=0.010, joint_mode="keep").stones
    np.testing.assert_allclose(kept.volume[1:], 0.250 * 0.065 * 0.12, rtol=1e-9)
    np.testing.assert_allclose(kept.weight, read(path, joint=0.010).stones.weight, rtol=1e-9)


@pytest.mark.parametrize("turn", [0.0, 30.0, 90.0, 200.0])
def test_polylines_in_an_upright_plane_are_stones_where_they_are_drawn(turn: float, tmp_path: Path) -> None:
    x, y = np.cos(np.radians(turn)), np.sin(np.radians(turn))

    def wall(space: Any) -> None:
        for z in range(3):
            for k in range(3):
                corners = [(0.5 * (k + a), 0.25 * (z + b)) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
                space.add_polyline3d([(s * x, s * y, t) for s, t in (corners if k else corners[::-1])], close=True)

    stones = read(drawn(tmp_path / "a.dxf", wall, unit=6, ground=False), support="base").stones
    free = stones.points[: stones.block_point_ptr[9]]
    assert stones.volume[:9] == pytest.approx(0.5 * 0.25 * 0.12)
    assert (np.ptp(free @ [x, y, 0]), free[:, 2].max()) == pytest.approx((1.5, 0.75))
    assert np.ptp(free @ [-y, x, 0]) == pytest.approx(0.12)
    assert len(find_contacts(stones).blocks) == 2 * 3 + 3 * 2 + 3


def test_an_insert_stretches_the_thickness_of_outlines_along_their_own_plane(tmp_path: Path) -> None:
    """A wall along x and one along y, 250 mm thick in their block, which is drawn twice as deep and half as long."""

    def draw(space: Any) -> None:
        block = space.doc.blocks.new("WALLS")
        # The axes of a plane that looks along y: x, and z upwards.
        for extrusion, along in (((0, -1, 0), 0.0), ((1, 0, 0), 2000.0)):
            corners = [(along, 0), (along + 1000, 0), (along + 1000, 500), (along, 500)]
            block.add_lwpolyline(corners, close=True, dxfattribs={"extrusion": extrusion, "thickness": 250})
        space.add_blockref("WALLS", (0, 0), dxfattribs={"xscale": 0.5, "yscale": 2.0, "zscale": -1.5})

    stones = read(drawn(tmp_path / "a.dxf", draw, ground=False), support="base", plane="xy").stones
    free = np.flatnonzero(~stones.fixed)
    sizes = [np.ptp(stones.points[slice(*stones.block_point_ptr[k : k + 2])], axis=0) for k in free]
    np.testing.assert_allclose(sizes, [(0.5, 0.5, 0.75), (0.125, 2.0, 0.75)], atol=1e-12)


def test_a_ring_beside_stones_cut_along_a_fine_polyline_is_divided_as_finely(tmp_path: Path) -> None:
    """Spandrels with a corner every 12 mm: one mean of all these corners left the voussoirs with chords of 170 mm, to which
    neighbouring facets grew by so unlike lengths that spandrels crossed themselves."""

    def arch(space: Any) -> None:
        bulged_ring(space, 600, 350, np.linspace(0, np.pi, 10).tolist(), 10)
        outside = shapely.box(-1000, 0, 1000, 1200) - shapely.Point(0, 0).buffer(960, 128)
        for low in range(0, 1200, 250):
            for part in shapely.get_parts(outside & shapely.box(-1000, low + 5, 1000, min(low + 245, 1195))):
                space.add_lwpolyline([*part.exterior.coords][:-1], close=True)

    stones = read(drawn(tmp_path / "a.dxf", arch, ground=False), joint=0.010, support="base").stones
    contacts = find_contacts(stones)
    check_soundness(stones, contacts)
    # The drawing encloses the wall without its margins, less half a circle.
    assert stones.volume[~stones.fixed].sum() == pytest.approx(0.12 * (2.0 * 1.195 - 0.5 * np.pi * 0.6**2 - 0.01), rel=5e-3)


def test_inches_that_are_metres_are_told_by_the_size_of_the_outlines(tmp_path: Path) -> None:
    path = drawn(tmp_path / "a.dxf", lambda space: course(space, 10.0, 1e-3), unit=1, ground=False)
    text = str(findings_of(path, joint=0.010, support="base"))
    assert "E05" in text
    assert "--units m (127 mm)" in text
    drawing = read(path, units="m", joint=0.010, support="base")
    assert codes(drawing) == ["W04", "W26", "W12"]


def test_inches_that_are_millimetres_are_told_by_the_size_of_the_outlines(tmp_path: Path) -> None:
    path = drawn(tmp_path / "a.dxf", lambda space: course(space, 10.0), unit=1, ground=False)
    text = str(findings_of(path, joint=10.0, support="base"))
    assert "E05" in text
    assert "--units mm (127 mm)" in text


def test_walls_taken_for_stones_are_no_drawing_in_a_smaller_unit_alone(tmp_path: Path) -> None:
    """A facade in centimetres: as a stone it would be 650 mm large in millimetres, and the whole building a tenth as large."""

    def draw(space: Any) -> None:
        space.add_lwpolyline([(0, 0), (900, 0), (900, 500), (0, 500)], close=True)

    path = drawn(tmp_path / "a.dxf", draw, unit=5, ground=False)
    text = str(findings_of(path, thickness=0.6, support="base"))
    assert "E05" in text
    assert "pass --bond instead, which lays stones in them" in text
    laid = read(path, thickness=0.6, support="base", bond="running", course=0.25, stone=0.5)
    assert "1 outline was taken for a whole wall, on the layers 0 (1)" in str(laid.findings)
    # Bricks in millimetres in a file that says metres are no walls in any case.
    path = drawn(tmp_path / "b.dxf", lambda space: course(space, 10.0), unit=6, ground=False)
    assert "--bond" not in str(findings_of(path, joint=10.0, support="base"))


@pytest.mark.parametrize("slip", [0.01, 0.5])
def test_a_copy_that_slipped_is_a_duplicate(slip: float, tmp_path: Path) -> None:
    # mm; of two bricks in a row the first is there twice.
    def draw(space: Any) -> None:
        space.add_lwpolyline(BRICK, close=True)
        space.add_lwpolyline([(x + slip, y - 0.3 * slip) for x, y in BRICK], close=True)
        space.add_lwpolyline([(x + 250, y) for x, y in BRICK], close=True)

    path = drawn(tmp_path / "wall.dxf", draw)
    (error,) = findings_of(path).errors
    assert error.code == "E11"
    assert error.lengths[0] == pytest.approx(slip * 1e-3)
    drawing = read(path, repair=True)
    assert drawing.stones.count == 3
    assert drawing.stones.volume.sum() == pytest.approx((2 * 0.1 + 2 * 0.25 * 0.065) * 0.12)


def test_duplicates_are_listed_and_dropped_on_request(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        course(space, 10.0)
        course(space, 10.0)

    path = drawn(tmp_path / "a.dxf", draw)
    assert "3 times: LWPOLYLINE" in str(findings_of(path, joint=0.010))
    drawing = read(path, joint=0.010, repair=True)
    assert codes(drawing) == ["W11", "W26"]
    assert drawing.stones.count == 4


@pytest.mark.parametrize("number", ["nan", "inf", "-inf", "1e400", "1e300"])
@pytest.mark.parametrize("kind", ["outline", "hatch", "line"])
def test_an_outline_with_a_coordinate_that_is_no_number_is_named(kind: str, number: str, tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        if kind == "outline":
            space.add_lwpolyline([(x + 0.125, y) for x, y in BRICK], close=True)
        elif kind == "line":
            space.add_line((0.125, 0), (9, 9))
        else:
            paths = space.add_hatch().paths
            paths.add_polyline_path([(x + 0.125, y) for x, y in BRICK], is_closed=True)
            paths.add_polyline_path([(x / 2 + 20, y / 2 + 20) for x, y in BRICK], is_closed=True)
        space.add_lwpolyline([(x, y + 65) for x, y in BRICK], close=True)

    path = drawn(tmp_path / "a.dxf", draw)
    path.write_text(path.read_text().replace("\n0.125\n", f"\n{number}\n", 1))
    found = next(finding for finding in findings_of(path) if finding.severity == "error")
    assert found.code in ("E10", "E03")
    assert found.entity == {"outline": "LWPOLYLINE", "hatch": "HATCH", "line": "LINE"}[kind]


def test_outlines_on_paper_are_counted(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        space.doc.layout("Layout1").add_lwpolyline(BRICK, close=True)
        space.doc.layout("Layout1").add_line((0, 0), (1, 1))

    for stones in (False, True):
        path = drawn(tmp_path / "a.dxf", lambda space: (draw(space), stones and space.add_lwpolyline(BRICK, close=True)))  # noqa: B023
        said = str(read(path).findings if stones else findings_of(path))
        assert "left out: 2 in paper space." in said


def test_openings_that_take_a_whole_wall_and_openings_in_no_wall_are_told(tmp_path: Path) -> None:
    def box(space: Any, x: float, y: float, right: float, top: float, layer: str = "0") -> None:
        space.add_lwpolyline([(x, y), (right, y), (right, top), (x, top)], close=True, dxfattribs={"layer": layer})

    def walls(space: Any, reach: float) -> None:
        box(space, 0, 0, 4000, 3000)
        box(space, 1000, -100, reach, 2000, "OPENING")
        box(space, 9000, 0, 9500, 900, "OPENING")

    laid = {"thickness": 0.4, "support": "base", "bond": "running", "course": 0.25, "stone": 0.5}
    drawing = read(drawn(tmp_path / "a.dxf", lambda space: walls(space, 2000), ground=False), **laid)
    assert drawing.stones.volume[~drawing.stones.fixed].sum() == pytest.approx((4 * 3 - 1 * 2) * 0.4)
    assert "left out: 1 outlines of openings in no wall." in str(drawing.findings)

    def taken(space: Any) -> None:
        walls(space, 2000)
        box(space, 5000, 0, 6000, 3000)
        box(space, 4900, -100, 6100, 3100, "OPENING")

    found = findings_of(drawn(tmp_path / "b.dxf", taken, ground=False), **laid)
    assert "openings take all of the wall" in str(found)


def test_a_polygon_mesh_is_left_out_and_counted(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        space.add_lwpolyline(BRICK, close=True)
        space.add_polymesh((4, 4))

    drawing = read(drawn(tmp_path / "a.dxf", draw))
    assert "left out: 1 polygon meshes (explode them to 3D faces)" in str(drawing.findings)
