"""Lintels over openings of walls that are given whole: drawn, or laid where asked."""

import re
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
import shapely

import churchpipe as cp
from churchpipe.errors import InputError
from churchpipe.model.building import BondRegion, Panel, PlaneChart, UnitCell
from churchpipe.recognition.lintels import is_lintel
from churchpipe.recognition.overhangs import overhangs
from churchpipe.recognition.panels import fit_panels
from solids import standing

COURSE, STONE, THICKNESS = 0.25, 0.5, 0.4
OPTIONS: dict[str, Any] = {"support": "base", "unit_weight": 18e3, "bond": "running", "course": COURSE, "stone": STONE}


def drawing(tmp_path: Path, *outlines: tuple[str, tuple[float, float, float, float]], **frame: Any) -> Path:
    """A drawing in m of rectangles (left, low, right, top) with their layers."""
    document = ezdxf.new("R2010", units=6)
    for layer, (left, low, right, top) in outlines:
        corners = [(left, low), (right, low), (right, top), (left, top)]
        document.modelspace().add_lwpolyline(corners, close=True, dxfattribs={"layer": layer, **frame})
    path = tmp_path / "wall.dxf"
    document.saveas(path)
    return path


def read(path: Path, **options: Any) -> tuple[cp.Assemblage, str]:
    stones, findings = cp.read_dxf(path, thickness=THICKNESS, **OPTIONS, **options)
    return stones, str(findings)


def boxes_of(stones: cp.Assemblage) -> np.ndarray:
    """Left, low, right, top of each free stone."""
    pointer = stones.block_point_ptr
    spans = [stones.points[pointer[k] : pointer[k + 1]][:, [0, 2]] for k in np.flatnonzero(~stones.fixed)]
    return np.array([[*span.min(axis=0), *span.max(axis=0)] for span in spans])


def has(stones: cp.Assemblage, *box: float) -> bool:
    return bool((np.abs(boxes_of(stones) - box).max(axis=1) < 1e-9).any())


WALL = ("WALL", (0.0, 0.0, 5.0, 3.0))
WINDOW = ("OPENING", (2.0, 1.0, 3.0, 2.0))


@pytest.mark.parametrize(
    "opening",
    [WINDOW, ("OPENING", (2.0, -0.2, 3.0, 2.0)), ("OPENING", (2.0, 1.0, 3.0, 2.25))],
    ids=["window", "door", "drawn up to the top of its lintel"],
)
def test_a_drawn_lintel_is_one_stone_of_its_wall(tmp_path: Path, opening):
    stones, said = read(drawing(tmp_path, WALL, opening, ("LINTEL", (1.7, 2.0, 3.3, 2.25))))
    assert has(stones, 1.7, 2.0, 3.3, 2.25)
    clear = min(opening[1][3], 2.0) - max(opening[1][1], 0.0)
    assert stones.volume[~stones.fixed].sum() == pytest.approx(THICKNESS * (15.0 - clear), rel=1e-9)
    assert set(stones.panel[~stones.fixed]) == {"WALL"}
    assert "1 lintel" in said
    assert "flat head" not in said
    cp.check_soundness(stones, cp.find_contacts(stones))


@pytest.mark.slow
def test_a_shell_stands_over_a_lintel(tmp_path: Path):
    """Without it the shell falls under its own weight (test_laying.py)."""
    stones, _ = read(drawing(tmp_path, WALL, WINDOW, ("LINTEL", (1.7, 2.0, 3.3, 2.25))))
    masonry = cp.Material("default", 18e3, 0.6)
    building = fit_panels(stones).building((masonry,))
    shell = cp.derive_shell(building, element_size=0.3)
    load = cp.LoadCase((1, 0, 0))
    found = cp.shell_limit_analysis(shell, load, [masonry])
    assert found.status == "optimal"
    assert cp.match_models(stones, cp.find_contacts(stones), shell).passed
    sliding = cp.limit_analysis(stones, cp.find_contacts(stones), load, 0.6, flow="non-associative")
    assert sliding.status == "converged"
    assert sliding.load_factor > 0.3


@pytest.mark.parametrize(("head", "top"), [(2.0, 2.25), (1.9, 2.25), (2.2, 2.5)])
def test_lintels_are_laid_where_asked(tmp_path: Path, head: float, top: float):
    """From the head of the opening to the next bed joint that leaves it half a course at least, and as far beside it as asked."""
    stones, said = read(drawing(tmp_path, WALL, ("OPENING", (2.0, 1.0, 3.0, head))), lintel_bearing=0.3)
    assert has(stones, 1.7, head, 3.3, top)
    assert stones.volume[~stones.fixed].sum() == pytest.approx(THICKNESS * (15.0 - head + 1.0), rel=1e-9)
    assert "1 lintel" in said
    assert "flat head" not in said


def test_a_lintel_ends_where_its_wall_does_and_says_so(tmp_path: Path):
    """Beside an end of the wall, and over a pier that is narrower than two bearings, where two meet in the middle."""
    holes = [("OPENING", (0.2, 1.0, 1.2, 2.0)), ("OPENING", (1.6, 1.0, 2.6, 2.0))]
    stones, said = read(drawing(tmp_path, WALL, *holes), lintel_bearing=0.3)
    assert has(stones, 0.0, 2.0, 1.4, 2.25)
    assert has(stones, 1.4, 2.0, 2.9, 2.25)
    assert "do not bear 0.3 m" in said
    assert "0.2 m on the left and 0.2 m on the right of the opening from 0.2 to 1.2 m" in said
    assert "0.2 m on the left and 0.3 m on the right of the opening from 1.6 to 2.6 m" in said


def test_a_lintel_that_is_drawn_is_not_laid_again(tmp_path: Path):
    other = ("OPENING", (3.6, 1.0, 4.3, 2.0))
    stones, said = read(drawing(tmp_path, WALL, WINDOW, other, ("LINTELS", (1.5, 2.0, 3.2, 2.25))), lintel_bearing=0.2)
    assert has(stones, 1.5, 2.0, 3.2, 2.25)
    assert has(stones, 3.4, 2.0, 4.5, 2.25)
    assert "2 lintels" in said


@pytest.mark.parametrize(
    ("left", "right", "said"),
    [
        (2.0, 3.0, "on neither side"),
        (2.0, 3.3, "only on the right"),
        (1.7, 3.0, "only on the left"),
        (1.7, 3.3, ""),
        (3.5, 4.5, ""),
    ],
)
def test_a_lintel_that_does_not_bear_on_both_sides_is_said(tmp_path: Path, left, right, said):
    _, findings = read(drawing(tmp_path, WALL, WINDOW, ("LINTEL", (left, 2.0, right, 2.25))))
    assert bool(re.search(f"do not rest on the wall on both sides: LINTEL ({said})", findings)) == bool(said)
    assert ("both sides" in findings) == bool(said)


def test_an_opening_without_room_for_its_lintel_is_refused(tmp_path: Path):
    top = ("OPENING", (2.0, 2.0, 3.0, 2.95))
    with pytest.raises(InputError, match="no room for a lintel"):
        read(drawing(tmp_path, WALL, top), lintel_bearing=0.3)
    end = ("OPENING", (0.03, 1.0, 1.0, 2.0))
    with pytest.raises(InputError, match="no room for a lintel"):
        read(drawing(tmp_path, WALL, end), lintel_bearing=0.3)


@pytest.mark.parametrize(
    ("lintel", "room"),
    [((1.75, 2.1, 3.25, 2.35), "0.1 m above"), ((2.1, 2.0, 2.9, 2.25), "0 m above")],
    ids=["above the head", "narrower than the opening"],
)
def test_a_drawn_lintel_that_leaves_no_room_for_one_is_named(tmp_path: Path, lintel, room: str):
    with pytest.raises(
        InputError, match=rf"{room} the opening .*, beside the lintel LINTEL: .* Draw the lintel LINTEL on the head"
    ):
        read(drawing(tmp_path, WALL, WINDOW, ("LINTEL", lintel)), lintel_bearing=0.25)


def test_lintels_that_hardly_are_any_are_said(tmp_path: Path):
    _, said = read(drawing(tmp_path, WALL, WINDOW, ("LINTEL", (1.75, 2.0, 3.25, 2.003))))
    assert "lower, or borne by less, than a fiftieth of their length: LINTEL, 3 mm high and 1.5 m long, bears 250 mm" in said
    _, said = read(drawing(tmp_path, WALL, WINDOW), lintel_bearing=0.001)
    assert "lintel-1, 250 mm high and 1 m long, bears 1 mm at one end" in said
    _, said = read(drawing(tmp_path, WALL, WINDOW), lintel_bearing=0.03)
    assert "lintels borne by less than 50 mm, or" in said
    assert "bears 30 mm at one end" in said
    _, said = read(drawing(tmp_path, WALL, WINDOW), lintel_bearing=0.1)
    assert "fiftieth" not in said


def test_a_lintel_reaches_to_the_top_of_its_wall(tmp_path: Path):
    stones, _ = read(drawing(tmp_path, WALL, ("OPENING", (2.0, 1.0, 3.0, 2.8))), lintel_bearing=0.3)
    assert has(stones, 1.7, 2.8, 3.3, 3.0)


def test_lintels_keep_clear_of_crossing_walls(tmp_path: Path):
    """A room of three walls in space: the window of the front stands .2 m from the cross wall behind it."""
    document = ezdxf.new("R2010", units=6)
    space = document.modelspace()

    def front(layer: str, left: float, low: float, right: float, top: float, depth: float = 0.5) -> None:
        frame = {"layer": layer, "extrusion": (0, -1, 0), "elevation": 0.0, "thickness": -depth}
        space.add_lwpolyline([(left, low), (right, low), (right, top), (left, top)], close=True, dxfattribs=frame)

    def side(layer: str, x: float) -> None:
        frame = {"layer": layer, "extrusion": (1, 0, 0), "elevation": x, "thickness": 0.5}
        space.add_lwpolyline([(0, 0), (4, 0), (4, 3), (0, 3)], close=True, dxfattribs=frame)

    front("FRONT", 0.0, 0.0, 6.0, 3.0)
    side("CROSS", 2.0)
    front("OPENING", 2.7, 1.0, 3.6, 2.0, 0.0)
    document.saveas(tmp_path / "room.dxf")
    stones, findings = cp.read_dxf(tmp_path / "room.dxf", lintel_bearing=0.3, **OPTIONS)
    lintel = np.flatnonzero(np.abs(boxes_of(stones) - (2.5, 2.0, 3.9, 2.25)).max(axis=1) < 1e-9)
    assert len(lintel) == 1
    assert "0.2 m on the left and 0.3 m on the right" in str(findings)
    cp.check_soundness(stones, cp.find_contacts(stones))
    front("OPENING", 4.0, 1.0, 4.9, 2.0, 0.0)
    side("OTHER", 4.9)
    document.saveas(tmp_path / "room.dxf")
    remedy = "Move the opening away from the wall that crosses, or draw its lintel, on a layer LINTEL, into that wall"
    with pytest.raises(InputError, match=f"0 m on the right .*, beside a wall that crosses: .* {remedy}"):
        cp.read_dxf(tmp_path / "room.dxf", lintel_bearing=0.3, **OPTIONS)


def test_a_lintel_drawn_on_the_face_of_a_wall_is_as_deep_as_the_wall(tmp_path: Path):
    document = ezdxf.new("R2010", units=6)
    space = document.modelspace()
    for layer, thickness, (left, low, right, top) in (
        ("FRONT", 0.5, (0.0, 0.0, 5.0, 3.0)),
        ("OPENING", 0.0, (2.0, 1.0, 3.0, 2.0)),
        ("LINTEL", 0.0, (1.8, 2.0, 3.2, 2.25)),
    ):
        frame = {"layer": layer, "extrusion": (0, -1, 0), "elevation": -1.0, "thickness": thickness}
        space.add_lwpolyline([(left, low), (right, low), (right, top), (left, top)], close=True, dxfattribs=frame)
    document.saveas(tmp_path / "wall.dxf")
    stones, _ = cp.read_dxf(tmp_path / "wall.dxf", **OPTIONS)
    assert has(stones, 1.8, 2.0, 3.2, 2.25)
    assert stones.volume[~stones.fixed].sum() == pytest.approx(0.5 * 14.0, rel=1e-9)


@pytest.mark.parametrize(
    ("lintel", "by"), [((-0.3, 2.0, 3.3, 2.25), "0.3 m"), ((1.7, 2.0, 5.02, 2.25), "0.02 m"), ((1.7, 2.0, 3.3, 3.1), "0.1 m")]
)
def test_a_lintel_that_reaches_beyond_its_wall_is_said(tmp_path: Path, lintel, by):
    stones, said = read(drawing(tmp_path, WALL, WINDOW, ("LINTEL", lintel)))
    assert f'"WALL": lintels that reach beyond the ends or the top of their wall: LINTEL by {by}' in said
    assert has(stones, *lintel)


def test_what_was_laid_is_said_of_each_wall(tmp_path: Path):
    """Equal findings are one line, and these are not quite equal."""
    _, said = read(drawing(tmp_path, WALL, ("OTHER", (6.0, 0.0, 9.0, 2.0))))
    assert '"WALL": laid' in said
    assert '"OTHER": laid' in said
    assert "; 2.4 m3" in said


def test_a_lintel_thinner_than_its_wall_is_refused(tmp_path: Path):
    document = ezdxf.new("R2010", units=6)
    space = document.modelspace()
    for layer, depth, (left, low, right, top) in (("FRONT", 0.5, WALL[1]), ("LINTEL", 0.25, (1.8, 2.0, 3.2, 2.25))):
        frame = {"layer": layer, "thickness": depth}
        space.add_lwpolyline([(left, low), (right, low), (right, top), (left, top)], close=True, dxfattribs=frame)
    document.saveas(tmp_path / "wall.dxf")
    with pytest.raises(InputError, match="a lintel not as thick as its wall"):
        cp.read_dxf(tmp_path / "wall.dxf", **OPTIONS)


def test_a_lintel_in_no_wall_is_said(tmp_path: Path):
    """It is one stone, and its support lies elsewhere: what is wrong is that it was drawn beside its wall."""
    _, said = read(drawing(tmp_path, WALL, WINDOW, ("LINTEL", (7.0, 0.0, 8.6, 0.25))))
    assert '"LINTEL": a lintel that neither lies in a wall nor touches one in its plane' in said
    assert "stands alone" not in read(drawing(tmp_path, WALL, WINDOW, ("LINTEL", (1.7, 2.0, 3.3, 2.25))))[1]


def test_over_a_curved_head_no_lintel_is_promised(tmp_path: Path):
    turn = np.linspace(0, np.pi, 17)
    arched = [(2.0, 1.0), (3.0, 1.0), *zip(2.5 + 0.5 * np.cos(turn), 2.0 + 0.5 * np.sin(turn), strict=True)]
    path = drawing(tmp_path, WALL)
    document = ezdxf.readfile(path)
    document.modelspace().add_lwpolyline(arched, close=True, dxfattribs={"layer": "OPENING"})
    document.saveas(path)
    _, said = read(path, lintel_bearing=0.25)
    assert "openings with a curved head and no arch (1)" in said
    assert "--lintel-bearing" not in said
    assert "--lintel-bearing lays lintels" in read(drawing(tmp_path, WALL, WINDOW))[1]


def test_a_ring_that_a_lintel_cuts_is_refused_at_its_wall(tmp_path: Path):
    turn = np.linspace(0, np.pi, 17)
    arc = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    path = drawing(tmp_path, WALL, ("LINTEL", (1.7, 2.0, 3.3, 2.25)))
    document = ezdxf.readfile(path)
    ring = np.concatenate([(2.5, 1.5) + 0.8 * arc, (2.5, 1.5) + 0.5 * arc[::-1]])
    document.modelspace().add_lwpolyline(ring.tolist(), close=True, dxfattribs={"layer": "RING"})
    document.saveas(path)
    with pytest.raises(InputError, match=r"LWPOLYLINE #.* at .* in wall WALL, RING-ring: .*, a lintel, another ring"):
        read(path)


def test_the_word_wall_is_not_the_name_of_a_wall_without_a_layer(tmp_path: Path):
    # The wall on layer 0, which is called "wall", is 8 m away; the ring of the other is cut.
    path = drawing(tmp_path, ("0", (8.0, 0.0, 12.0, 2.5)), WALL, ("LINTEL", (1.7, 2.0, 3.3, 2.25)))
    document = ezdxf.readfile(path)
    turn = np.linspace(0, np.pi, 17)
    arc = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    ring = np.concatenate([(2.5, 1.5) + 0.8 * arc, (2.5, 1.5) + 0.5 * arc[::-1]])
    document.modelspace().add_lwpolyline(ring.tolist(), close=True, dxfattribs={"layer": "RING"})
    document.saveas(path)
    with pytest.raises(InputError, match=r"at \(0\.00, 0\.00, 0\.00\) m: no stones can be laid in wall WALL, RING-ring"):
        read(path)


def test_two_lintels_in_one_place_are_refused(tmp_path: Path):
    lintels = [("LINTEL", (1.7, 2.0, 3.3, 2.25)), ("LINTEL", (1.6, 2.1, 3.2, 2.4))]
    with pytest.raises(InputError, match="lies in another lintel"):
        read(drawing(tmp_path, WALL, WINDOW, *lintels))


def test_lintels_of_bodies_are_known_by_their_names():
    region = shapely.box(0, 0, 5, 3).difference(shapely.box(2, 1, 3, 2)).difference(shapely.box(1.7, 2, 3.3, 2.25))
    bodies = [standing(region, THICKNESS), standing(shapely.box(1.7, 2, 3.3, 2.25), THICKNESS)]
    stones = cp.Assemblage.from_polyhedra(bodies, 18e3, block_id=["wall", "Lintel.001"])
    laid = cp.derive_blocks(cp.lay_stones(stones, course=COURSE, stone=STONE))
    assert has(laid, 1.7, 2.0, 3.3, 2.25)
    assert laid.volume[~laid.fixed].sum() == pytest.approx(THICKNESS * 14.0, rel=1e-9)


@pytest.mark.parametrize(
    ("name", "means"), [("LINTEL", 1), ("lintels-2", 1), ("a.obj/Lintel.001", 1), ("lintelled", 0), ("WALL", 0)]
)
def test_names_of_lintels(name: str, means: bool):
    assert is_lintel(name) == bool(means)


@pytest.mark.parametrize(
    "seed",
    [
        4,
        5,
        9,
        *(
            pytest.param(seed, marks=pytest.mark.slow("docs/drawings.md: walls with lintels"))
            for seed in (0, 1, 2, 3, 6, 7, 8, 10, 11)
        ),
    ],
)
def test_random_walls_with_lintels_are_filled_exactly(tmp_path: Path, seed: int):
    rng = np.random.default_rng(seed)
    length, top = float(rng.uniform(4, 9)), float(rng.uniform(2.6, 4.0))
    holes, clear, at = [], 0.0, float(rng.uniform(0.5, 1.0))
    while at < length - 1.8:
        width, sill = float(rng.uniform(0.5, 1.2)), float(rng.choice([-0.1, 0.6, 0.9]))
        head = float(rng.uniform(1.6, top - 0.45))
        holes.append(("OPENING", (at, sill, at + width, head)))
        clear += width * (head - max(sill, 0.0))
        at += width + float(rng.uniform(0.45, 1.2))
    stones, said = read(drawing(tmp_path, ("WALL", (0.0, 0.0, length, top)), *holes), lintel_bearing=0.25)
    assert f"{len(holes)} lintel" in said
    assert stones.volume[~stones.fixed].sum() == pytest.approx(THICKNESS * (length * top - clear), rel=1e-9)
    cp.check_soundness(stones, cp.find_contacts(stones))
    found = boxes_of(stones)
    for _, (left, _, right, head) in holes:
        over = (np.abs(found[:, 1] - head) < 1e-9) & (found[:, 0] < left - 0.06) & (found[:, 2] > right + 0.06)
        assert over.sum() == 1


@pytest.mark.parametrize("bearing", [{}, {"lintel_bearing": 0.25}])
@pytest.mark.parametrize(
    ("openings", "place"),
    [
        ([(1.0, -0.1, 2.0, 1.5), (2.0, -0.1, 3.0, 2.0)], "from 1 to 2 m along the wall, 1.5 m high"),
        ([(1.0, 0.5, 2.0, 2.0), (2.0, 0.5, 3.0, 1.5)], "from 2 to 3 m along the wall, 1.5 m high"),
        ([(4.0, 1.0, 5.1, 2.0)], "from 4 to 5 m along the wall, 2 m high"),
        ([(-0.1, -0.1, 1.0, 2.0)], "from 0 to 1 m along the wall, 2 m high"),
    ],
    ids=["L on the left", "L on the right", "window at the end", "door at the beginning"],
)
def test_masonry_with_a_free_end_is_said(tmp_path: Path, openings, place: str, bearing):
    """No lintel can bear on both sides of it, so none is laid, whatever is asked."""
    _, said = read(drawing(tmp_path, WALL, *(("OPENING", box) for box in openings)), **bearing)
    assert said.count("held on one side only") == 1
    assert place in said


def test_masonry_with_something_below_its_free_end_is_not_said(tmp_path: Path):
    """The end of an opening at the end of its wall stands on a support, in another drawing on a wall that crosses."""
    wall, opening = WALL, ("OPENING", (4.0, -0.1, 5.1, 2.0))
    _, said = read(drawing(tmp_path, wall, opening, ("SUPPORT", (4.5, 1.5, 5.0, 2.0)), ("SUPPORT", (0.0, -0.5, 4.0, 0.0))))
    assert "held on one side only" not in said


def test_the_free_end_of_a_wall_may_stand_on_a_crossing_wall():
    """Of two walls that cross at their ends, one has its opening up to the inner face of the other."""
    cell = UnitCell(a=COURSE, b=STONE)

    def wall(name: str, origin: tuple[float, float, float], axis: tuple[float, float, float], outline: list) -> Panel:
        chart = PlaneChart(origin, axis, (0.0, 0.0, 1.0))
        return Panel(name, chart, np.array(outline), THICKNESS, (BondRegion("bond", np.array(outline), "running", cell),))

    notched = [(0.0, 0.0), (4.0, 0.0), (4.0, 2.0), (5.0, 2.0), (5.0, 3.0), (0.0, 3.0)]
    one = wall("one", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), notched)
    other = wall("other", (4.8, -0.2, 0.0), (0.0, 1.0, 0.0), [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)])
    assert [str(found) for found in overhangs(one)] == ["from 4 to 5 m along the wall, 2 m high"]
    assert overhangs(one, [one, other]) == []
