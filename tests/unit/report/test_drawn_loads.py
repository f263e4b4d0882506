"""Loads and ties on the dimensioned drawings."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

import churchpipe as cp
from churchpipe.generators import wall
from churchpipe.loading.placing import place_loads
from churchpipe.model.placed_loads import Applied
from churchpipe.report import colours
from churchpipe.report.applied import load_rows
from churchpipe.report.drawings import ELEVATIONS, PLAN, View, drawings_svg
from churchpipe.report.drawn_loads import DrawnLoads, draw_loads, drawn_loads, key_to_loads
from records import analysis
from solids import box

MATERIALS = (cp.Material("default", 18e3, 0.6),)
FRONT, RIGHT = ELEVATIONS[:2]


def one_wall() -> cp.Assemblage:
    """4 m along x, .25 m thick, 2.4 m high."""
    return cp.derive_blocks(wall(length=4.0, brick=(0.4, 0.25, 0.2), courses=12, materials=MATERIALS))


def two_walls() -> cp.Assemblage:
    """Walls of 4 m along y, 3 m high, 5 m apart."""
    plate = box((-50, 50), (-50, 50), (-1, 0))
    walls = [box((0, 0.5), (0, 4), (0, 3)), box((5.5, 6), (0, 4), (0, 3))]
    return cp.Assemblage.from_polyhedra([plate, *walls], 18e3, [0], panel=["", "west", "east"])


def on_wall(stones: cp.Assemblage, **given: float) -> DrawnLoads:
    return drawn_loads(stones, [Applied(place_loads(stones, [cp.LineLoad("wall", name="roof", toward="+y", **given)]))])


def test_arrows_point_the_way_of_their_force_and_end_where_it_acts() -> None:
    stones = one_wall()
    drawn = on_wall(stones, dead=6e3, thrust=2e3)
    assert drawn.names == ("line load roof",)
    assert (drawn.number == 0).all()
    # 3 kN down for each kN towards +y, on the top of the wall, all along it.
    assert drawn.arrow[:, 1] / drawn.arrow[:, 2] == pytest.approx(np.full(len(drawn.at), -1 / 3))
    assert drawn.at[:, 2] == pytest.approx(np.full(len(drawn.at), 2.4))
    assert 3 < np.ptp(drawn.at[:, 0]) < 4
    assert np.linalg.norm(drawn.arrow, axis=1).max() == pytest.approx(0.09 * stones.size)


def test_what_acts_in_one_place_is_one_arrow() -> None:
    stones = one_wall()
    load = place_loads(stones, [cp.LineLoad("wall", dead=6e3)])
    drawn = drawn_loads(stones, [Applied(load)])
    cells = {tuple(cell) for cell in np.floor(load.point / (0.05 * stones.size)).tolist()}
    assert len(drawn.at) == len(cells) < len(load.load)


def shapes(drawn: DrawnLoads, view: View = FRONT, cut: float | None = None) -> tuple[int, int, list[str]]:
    """Numbers of arrows and of dots, and the words, that a view shows."""
    axes = Figure().subplots()
    turned = np.array([view.across, view.up, view.toward], dtype=float)
    draw_loads(axes, drawn, turned, cut)
    arrows = sum(len(np.asarray(found.get_offsets())) for found in axes.collections)
    dots = sum(len(np.atleast_1d(line.get_xdata())) for line in axes.lines if line.get_color() == colours.LOAD)
    return arrows, dots, [text.get_text() for text in axes.texts]


def test_a_force_along_the_line_of_sight_and_a_mass_are_dots() -> None:
    stones = one_wall()
    drawn = on_wall(stones, dead=6e3)
    count = len(drawn.at)
    assert shapes(drawn) == (count, 0, ["1"])
    assert shapes(drawn, PLAN) == (0, count, ["1"])
    mass = on_wall(stones, mass=3e3)
    assert not mass.arrow.any()
    assert shapes(mass) == (0, count, ["1"])
    # A section that looks at the wall from the right sees what lies beyond it.
    beyond, _, _ = shapes(drawn, RIGHT, 2.0)
    assert 0 < beyond < count


def test_ties_of_a_variant_are_dashed_and_the_key_says_so() -> None:
    stones = two_walls()
    bar = cp.TieBar("bar", start=("west", 2.0, 2.0), end=("east", 2.0, 2.0), area=1e-4, steel_strength=235e6)
    other = cp.TieBar("other", start=("west", 3.0, 2.0), end=("east", 3.0, 2.0), area=1e-4, steel_strength=235e6)
    loads = place_loads(stones, [cp.AreaLoad(["west", "east"], dead=1.5e3, name="<b>floor")])
    asis, changed = (Applied(loads, tuple(cp.place_ties(stones, bars))) for bars in ([bar], [bar, other]))
    drawn = drawn_loads(stones, [asis, changed])
    assert drawn.added == (False, True)
    assert drawn.ties[0, :, 0] == pytest.approx([0.0, 6.0])
    (alone,) = drawn_loads(stones, [asis]).added
    assert not alone
    said = " ".join(key_to_loads(drawn, beams=False))
    assert "1 area load <b>floor" in said
    assert "dashed" in said
    assert "dashed" not in " ".join(key_to_loads(drawn_loads(stones, [asis]), beams=True))
    drawings = dict(drawings_svg(stones, drawn))
    assert all(colours.TIE in drawing and colours.LOAD in drawing for drawing in drawings.values())
    bare = dict(drawings_svg(stones, drawn_loads(stones, [])))
    assert not any(colours.TIE in drawing or colours.LOAD in drawing for drawing in bare.values())
    assert key_to_loads(drawn_loads(stones, []), beams=False) == []


def test_loads_that_are_others_in_a_variant_are_told() -> None:
    # A floor with 1 and with 3 kN/m2.
    stones = two_walls()
    light, heavy = (Applied(place_loads(stones, [cp.AreaLoad(["west", "east"], dead=d, name="floor")])) for d in (1e3, 3e3))
    analyses = [
        analysis(name="a"),
        analysis(name="b", load="+y"),
        analysis(name="c", variant="archive"),
        analysis(name="d", swept={"area_loads.floor.dead_kN_m2": 3.0}),
    ]
    rows = load_rows({"a": light, "b": light, "c": heavy, "d": heavy}, analyses)
    assert [row[0] for row in rows] == ["area load floor", "area load floor, archive"]
    presses = [float(row[2]) for row in rows]
    assert presses[1] == pytest.approx(3 * presses[0], abs=0.2)
    assert load_rows({"a": light, "d": heavy}, analyses)[1][0] == "area load floor, dead of floor 3.0 kN/m\u00b2"


def test_a_model_of_one_brick_has_figures(tmp_path: Path) -> None:
    stones = cp.derive_blocks(wall(length=0.08, brick=(0.08, 0.04, 0.015), courses=1, materials=MATERIALS))
    loads = [cp.LineLoad("wall", dead=0.4)]
    ((_, _, presses, level, mass),) = load_rows({"a": Applied(place_loads(stones, loads))})
    assert (presses, level, mass) == ("3.2e\u221205", "0.0", "3.2e\u221205")
    drawings = dict(drawings_svg(stones, drawn_loads(stones, [])))
    assert "0.015 m" in drawings["Elevation from \u2212y"]
    assert "Plan, cut 0.0075 m above the foot" in drawings
    contacts, load = cp.find_contacts(stones), cp.loaded(cp.LoadCase((0, 1, 0)), stones, loads)
    state = cp.limit_analysis(stones, contacts, load, 0.6)
    cp.write_report(tmp_path / "r.html", stones, contacts, [(load, state)], materials=MATERIALS, loads=loads)
    text = (tmp_path / "r.html").read_text(encoding="utf-8")
    assert "0.08 \u00d7 0.04 \u00d7 0.015 m" in text
    assert "0.000864 kN" in text


def test_ring_beams_are_shaded() -> None:
    building = wall(length=4.0, brick=(0.4, 0.25, 0.2), courses=12, materials=MATERIALS)
    beams = (cp.RingBeam(("wall",), height=0.2),)
    bare, beamed = (cp.derive_blocks(replace(building, ring_beams=given)) for given in ((), beams))
    none = drawn_loads(bare, [])
    assert not any(colours.BEAM in drawing for _, drawing in drawings_svg(bare, none))
    assert all(colours.BEAM in drawing for title, drawing in drawings_svg(beamed, none) if title.startswith("Elevation"))
