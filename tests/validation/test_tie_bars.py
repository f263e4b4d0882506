"""Ties as bars with plates: what their strength is, which stones they pull on, closed forms, and which of several helps most."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import churchpipe as cp
from churchpipe import stages
from churchpipe.configuring import configure
from churchpipe.errors import InputError
from churchpipe.generators.wall import wall as free_wall
from churchpipe.geometry.punching import punched_edge
from churchpipe.io.records import Analysis, read_record
from churchpipe.loading.plates import plate_on
from churchpipe.loading.ties import place_ties
from churchpipe.model.quantities import as_written
from shell_meshes import grid, joined_walls, shell, wall_points
from solids import box

STEEL = {"area": 4e-4, "steel_strength": 235e6}


def two_walls() -> cp.Assemblage:
    """Walls of 1 m and .5 m, 4 m high and 2 m long, 3 m apart, named west and east."""
    plate = box((-50, 50), (-50, 50), (-1, 0))
    walls = [box((0, 1), (0, 2), (0, 4)), box((4, 4.5), (0, 2), (0, 4))]
    return cp.Assemblage.from_polyhedra([plate, *walls], 18e3, [0], panel=["", "west", "east"])


def between(strength: float, **options: Any) -> cp.TieBar:
    return cp.TieBar("rod", ("west", 0.5, 3.5), ("east", 0.5, 3.5), area=strength / 235e6, steel_strength=235e6, **options)


def test_what_governs_the_strength() -> None:
    # Yield 94 kN; bearing .2 x .3 x 1 MPa = 60 kN; punching at the thinner wall 2 (.2 + .3 + 1) .5 x .03 MPa = 45 kN.
    options: dict[str, Any] = {"plate": (0.2, 0.3)}
    expected = [
        ({}, 94e3, "yield of the steel"),
        ({"bearing_strength": 1e6}, 60e3, "bearing under the plates"),
        ({"bearing_strength": 1e6, "punching_strength": 0.03e6}, 45e3, "punching of the wall at its end"),
    ]
    for more, strength, governs in expected:
        bar = cp.TieBar("rod", ("west", 1.0, 2.0), ("east", 1.0, 2.0), **STEEL, **options, **more)
        (tie,) = place_ties(two_walls(), [bar])
        assert tie.strength == pytest.approx(strength, rel=1e-12)
        assert tie.governs == governs
        # Through both walls, from far face to far face.
        assert tie.start == pytest.approx([0, 1.0, 2.0])
        assert tie.end == pytest.approx([4.5, 1.0, 2.0])
        assert tie.stiffness == pytest.approx(210e9 * 4e-4 / 4.5)


@pytest.mark.parametrize(
    ("along", "height", "edge"),
    [
        # At the top of the wall and its end: the plate's pyramid is .7 x .8 m half way through. What is left of it, up to both.
        (0.5, 3.5, 0.85 + 0.9),
        # At the top alone, which cuts its upper side off; and .3 m above that side, where breaking out to it is shorter.
        (1.0, 3.75, 0.7 + 2 * 0.65),
        (1.0, 3.3, 0.7 + 2 * 1.1),
        # .5 m above it, where it is not.
        (1.0, 3.1, 3.0),
    ],
)
def test_a_plate_punches_out_to_a_near_edge(along: float, height: float, edge: float) -> None:
    places = ("west", along, height), ("east", along, height)
    bar = cp.TieBar("rod", *places, **STEEL, plate=(0.2, 0.3), punching_strength=0.03e6)
    (tie,) = place_ties(two_walls(), [bar])
    assert tie.strength == pytest.approx(edge * 0.5 * 0.03e6, rel=1e-6)
    near = " near its edge" if edge < 3 else ""
    assert tie.governs == f"punching of the wall at its end{near}"


def test_a_plate_punches_out_to_an_opening() -> None:
    # Courses of .5 m, a window from 1 to 2 m along and up. The pyramid of the plate beside it is .7 x .7 m half way through, with
    # a side .2 m from the window: it loses this side of .7 m, and gains twice .2 m. Joints are no edges, nor is that between the
    # two leaves of a wall, in the very middle of which the section would lie.
    window = {"start": 1.0, "width": 1.0, "height_courses": 2, "sill_courses": 2, "lintel_bearing": 0.5}
    stones = cp.derive_blocks(
        free_wall(length=4.0, brick=(1.0, 0.5, 0.5), courses=6, openings=[window], materials=[cp.Material("default", 18e3, 0.6)])
    )
    outward = np.array([0.0, -1.0, 0.0])
    assert punched_edge(stones, np.array([2.55, 0.0, 1.5]), outward, (0.2, 0.2), 0.5) == pytest.approx(0.7 + 2 * 0.9, rel=1e-6)
    assert punched_edge(stones, np.array([3.0, 0.0, 1.5]), outward, (0.2, 0.2), 0.5) == pytest.approx(2.8, rel=1e-6)
    leaves = cp.derive_blocks(free_wall(length=4.0, brick=(1.0, 0.5, 0.5), courses=6, pattern="header-stretcher", headers="none"))
    assert punched_edge(leaves, np.array([2.0, 0.0, 1.5]), outward, (0.2, 0.2), 1.0) == pytest.approx(4.8, rel=1e-6)


def test_the_plate_below_the_eaves_of_the_manual() -> None:
    wall = cp.Assemblage.from_polyhedra([box((-9, 9), (-9, 9), (-1, 0)), box((-4, 4), (0, 0.6), (0, 5))], 18e3, [0])
    outward = np.array([0.0, -1.0, 0.0])
    assert punched_edge(wall, np.array([0.0, 0.0, 2.5]), outward, (0.3, 0.3), 0.6) == pytest.approx(3.6, rel=1e-6)
    assert punched_edge(wall, np.array([0.0, 0.0, 4.7]), outward, (0.3, 0.3), 0.6) == pytest.approx(2.4, rel=1e-6)


def test_two_walls_tied_through() -> None:
    # T/W1 .02 at 3.5 m: the thinner wall turns at (W2 .25 + T 3.5) / (2 W2), and away from it the other at .25 + T 3.5 / (2 W1).
    stones = two_walls()
    weight = 8 * 18e3
    contacts = cp.find_contacts(stones)
    ties = place_ties(stones, [between(0.02 * weight, plate=(0.2, 0.2))])
    state = cp.limit_analysis(stones, contacts, cp.LoadCase((1, 0, 0)), 2.0, ties=ties)
    assert state.status == "optimal"
    assert state.load_factor == pytest.approx(0.125 + 0.02 * 3.5 / (2 * 0.5), rel=1e-6)
    assert state.tie_forces == pytest.approx([0.02 * weight], rel=1e-6)


def test_a_plate_presses_on_the_stones_under_it() -> None:
    # Centred on the bed at 1 m, at the head joint x = 1.5 of the course below it; three stones, by area.
    stones = cp.derive_blocks(
        free_wall(length=4.0, brick=(1.0, 0.5, 0.5), courses=6, materials=[cp.Material("default", 18e3, 0.6)])
    )
    anchor = plate_on(stones, "t", np.array([1.5, 0.0, 1.0]), np.array([0.0, -1.0, 0.0]), (0.2, 0.2))
    assert sorted(anchor.share.tolist()) == pytest.approx([0.25, 0.25, 0.5])
    assert anchor.share @ anchor.point == pytest.approx([1.5, 0.0, 1.0])


def test_a_tie_along_a_wall() -> None:
    stones = cp.derive_blocks(
        free_wall(length=4.0, brick=(1.0, 0.5, 0.5), courses=6, materials=[cp.Material("default", 18e3, 0.3)])
    )
    bar = cp.TieBar("chain", ("wall", 0.0, 2.75), ("wall", 4.0, 2.75), **STEEL, plate=(0.2, 0.2), punching_strength=1.0)
    (tie,) = place_ties(stones, [bar])
    assert tie.start == pytest.approx([0, 0.25, 2.75])
    assert tie.end == pytest.approx([4, 0.25, 2.75])
    # It presses on the ends of the wall, which has nothing to punch through.
    assert tie.governs == "yield of the steel"


def test_ranking_of_ties() -> None:
    # Three free walls in a row, pushed along +x: the thinnest falls first, and only ties that hold it help.
    plate = box((-50, 50), (-50, 50), (-1, 0))
    walls = [box((x, x + t), (0, 2), (0, 4)) for x, t in ((0, 1.0), (4, 0.8), (8, 0.5))]
    stones = cp.Assemblage.from_polyhedra([plate, *walls], 18e3, [0], panel=["", "a", "b", "c"])
    contacts, load = cp.find_contacts(stones), cp.LoadCase((1, 0, 0))
    candidates = place_ties(
        stones,
        [
            cp.TieBar(name, (one, 1.0, z), (two, 1.0, z), area=700 / 235e6, steel_strength=235e6)
            for name, one, two, z in (("ab high", "a", "b", 3.5), ("bc low", "b", "c", 2.0), ("bc high", "b", "c", 3.5))
        ],
    )
    state = cp.limit_analysis(stones, contacts, load, 2.0)
    ranked = cp.rank_ties(state, candidates, stones, contacts, load, 2.0, verify=2)
    assert [one.tie.name for one in ranked] == ["bc high", "bc low", "ab high"]
    weight = 0.5 * 2 * 4 * 18e3
    # The thin wall alone: alpha (W h/2) = W b/2 + T z.
    for one, z in zip(ranked, (3.5, 2.0), strict=False):
        assert one.rate == pytest.approx(z / (2 * weight), rel=1e-6)
        assert one.load_factor == pytest.approx(0.125 + 700 * z / (2 * weight), rel=1e-6)
        assert one.most == pytest.approx(one.load_factor, rel=1e-6)
    assert ranked[2].rate * weight == pytest.approx(0, abs=1e-6)
    assert np.isnan(ranked[2].load_factor)


def test_without_dilatancy_the_rate_of_a_tie_bounds_nothing() -> None:
    # The upper of two blocks slides off the lower one at its friction mu. A tie that slopes down to the lower one holds with the
    # level part of its tension, and presses with the upright one, which the rate of a motion without dilatancy does not know.
    blocks = [box((-50, 50), (-50, 50), (-1, 0)), box((0, 3), (0, 2), (0, 1)), box((0, 3), (0, 2), (1, 1.5))]
    stones = cp.Assemblage.from_polyhedra(blocks, 18e3, [0], panel=["", "low", "up"])
    contacts, load = cp.find_contacts(stones), cp.LoadCase((1, 0, 0), panels=("up",))
    strength = 0.2 * stones.weight[2]
    tie = cp.Tie("slant", (0.5, 1, 0.5), (2.5, 1, 1.25), strength=strength)
    level, down = np.array([2, 0.75]) / np.hypot(2, 0.75)
    ranked = {}
    for flow in ("associative", "non-associative"):
        state = cp.limit_analysis(stones, contacts, load, 0.4, flow=flow)
        (ranked[flow],) = cp.rank_ties(state, [tie], stones, contacts, load, 0.4, flow=flow)
        assert ranked[flow].load_factor == pytest.approx(0.4 + 0.2 * (level + 0.4 * down), rel=1e-4)
    proved, sliding = ranked["associative"], ranked["non-associative"]
    assert proved.most == pytest.approx(proved.load_factor, rel=1e-6)
    assert sliding.rate * strength == pytest.approx(0.2 * level, rel=1e-4)
    assert np.isnan(sliding.most)


BAD: list[tuple[Any, str]] = [
    (lambda: cp.TieBar("t", ("north", 0, 1), (0, 0, 0), **STEEL), "tie t: start: no such wall; found north"),
    (lambda: cp.TieBar("t", ("west", 0.5, 3.5), ("east", 2.5, 3.5), **STEEL), "tie t: end: beyond the wall east; found 2.5 m"),
    (lambda: cp.TieBar("t", ("west", 0.5, 3.5), ("east", 0.5, 4.5), **STEEL), "tie t: end: above the wall east; found 4.5 m"),
    (lambda: cp.TieBar("t", (0.5, 0.5, 2), (9, 0.5, 2), **STEEL), "tie t: end: no stone at the anchor; found"),
    (lambda: cp.TieBar("t", (0.2, 0.5, 2), (0.5, 0.5, 2), **STEEL), "tie t: both ends on one stone"),
    (lambda: cp.TieBar("t", (0.5, 0.5, 2), (0.5, 0.5, 2), **STEEL), "tie t: no length"),
    (lambda: cp.TieBar("t", ("west", 0.05, 2), ("east", 0.05, 2), **STEEL, plate=(0.2, 0.2)), "its plate overhangs .*75 %"),
    (
        lambda: cp.TieBar("t", (0.5, 0.5, 2), (4.5, 0.5, 2), **STEEL, plate=(0.2, 0.2)),
        "tie t: start: its plate is not on masonry",
    ),
    (lambda: cp.TieBar("t", (0, 0, 0), (1, 0, 0), area=-1.0, steel_strength=1.0), "tie t: area: out of range; found -1.0"),
    (lambda: cp.TieBar("t", (0, 0, 0), (1, 0, 0), **STEEL, bearing_strength=1e6), "tie t: no plate"),
    (lambda: between(1e3, pretension=2e3), "tie rod: pretension: out of range"),
]


@pytest.mark.parametrize(("make", "said"), BAD)
def test_bad_bars(make: Any, said: str) -> None:
    with pytest.raises(InputError, match=said):
        place_ties(two_walls(), [make()])


def wall_and_post(rows: int, strength: float, **bar: Any) -> tuple[cp.ShellModel, cp.Tie]:
    """The shell of a wall of .5 x 3 m, 2 m long, and of a post that stays where it is, and the tie between them at 2.5 m."""
    thickness, height, length, z = 0.5, 3.0, 2.0, 2.5
    weight = 18e3 * thickness * height * length
    points, triangles = grid(round(rows * length / height), rows, length, height)
    wall = wall_points(points)
    post_points, post_triangles = grid(1, 2, length, height)
    post = wall_points(post_points) + np.array([0.0, -3.0, 0.0])
    nodes = np.concatenate([wall, post])
    # The post is held at all of its nodes.
    model = shell(
        nodes,
        np.concatenate([triangles, post_triangles + len(wall)]),
        thickness=thickness,
        cell=(0.5, 1.0),
        surface_weight=18e3 * thickness,
        supported=lambda p: (p[:, 2] < 1e-9) | (p[:, 1] < -1),
    )
    model = replace(model, surface_weight=np.where(np.arange(len(model.triangles)) < len(triangles), 18e3 * thickness, 0.0))
    bar = {key: value * weight if key == "pretension" else value for key, value in bar.items()}
    return model, cp.Tie("rod", start=(1.0, -3.0, z), end=(1.0, 0.0, z), strength=strength * weight, **bar)


def tied_shell(rows: int, strength: float) -> tuple[float, cp.ShellLimitState]:
    """The load factor of the wall and its tie by hand, b / h + 2 T z / (W h), and as a shell."""
    model, tie = wall_and_post(rows, strength)
    state = cp.shell_limit_analysis(
        model, cp.LoadCase((0, 1, 0)), [cp.Material("default", 18e3, 0.6)], membrane="CST", ties=[tie]
    )
    assert state.status == "optimal"
    assert state.tie_forces == pytest.approx([tie.strength], rel=1e-9)
    return 0.5 / 3.0 + 2 * strength * 2.5 / 3.0, state


ELASTIC = cp.Elastic(3.18e9, 0.23, 0.303e9, 0.3, 1e-2)


def test_the_capacity_curve_of_a_tied_shell_reaches_its_limit_load() -> None:
    # Ductile: neither stiffness nor pretension changes the plateau, which is that of the limit analysis.
    _, limit = tied_shell(4, 0.02)
    brick = cp.Material("default", 18e3, 0.6, elastic=ELASTIC)
    curves = []
    for bar in ({"stiffness": 2e6}, {"stiffness": 2e7}, {"stiffness": 2e6, "pretension": 0.01}):
        model, tie = wall_and_post(4, 0.02, **bar)
        curve = cp.pushover(model, cp.LoadCase((0, 1, 0)), [brick], membrane="CST", ties=[tie])
        assert curve.status == "converged", curve.message
        assert curve.plateau == pytest.approx(limit.load_factor, rel=5e-3)
        tension = curve.tie_forces[:, 0]
        assert tension[0] == pytest.approx(tie.pretension)
        assert tension[-1] == pytest.approx(tie.strength, rel=1e-3)
        assert (np.diff(tension) > -1e-4 * tie.strength).all()
        curves.append((tension / tie.strength, curve.load_factor))
    # A stiffer bar has taken more at the same load, and so has one that was drawn before.
    share = [float(np.interp(0.15, factor, taken)) for taken, factor in curves]
    assert share[0] < share[1]
    assert share[0] < share[2]


def test_a_bar_that_breaks_leaves_the_wall_to_itself() -> None:
    brick = cp.Material("default", 18e3, 0.6, elastic=ELASTIC)
    model, tie = wall_and_post(4, 0.02, stiffness=2e6, ultimate=0.0006)
    curve = cp.pushover(model, cp.LoadCase((0, 1, 0)), [brick], membrane="CST", ties=[tie])
    bare = cp.pushover(model, cp.LoadCase((0, 1, 0)), [brick], membrane="CST")
    assert curve.tie_forces[-1, 0] == 0.0
    assert curve.load_factor[-1] == pytest.approx(bare.load_factor[-1], rel=5e-3)
    assert curve.plateau > 1.05 * bare.plateau


def test_a_capacity_curve_needs_the_stiffness_of_its_ties() -> None:
    model, tie = wall_and_post(4, 0.02)
    with pytest.raises(InputError, match="tie rod: stiffness: a capacity curve needs it"):
        cp.pushover(model, cp.LoadCase((0, 1, 0)), [cp.Material("default", 18e3, 0.6, elastic=ELASTIC)], ties=[tie])


@pytest.mark.parametrize("rows", [4, 8])
def test_a_tied_shell_has_the_closed_form(rows: int) -> None:
    # alpha = b / h + 2 T z / (W h), less what the wall bends between tie and corners: T small.
    expected, state = tied_shell(rows, 0.02)
    assert state.load_factor == pytest.approx(expected, rel=1e-6)


def held_shell(strength: float, thrust: float, rows: int = 4) -> cp.ShellLimitState:
    """The shell of a wall and its tie, under a thrust of a share of its weight, which acts always."""
    model, tie = wall_and_post(rows, strength)
    dead = np.zeros((len(model.triangles), 6))
    dead[:, 1] = thrust * model.weight
    load = cp.LoadCase((0, 1, 0), dead=dead)
    return cp.shell_limit_analysis(model, load, [cp.Material("default", 18e3, 0.6)], membrane="CST", ties=[tie])


def test_a_shell_stands_by_a_tie_that_would_pull_it_down_with_its_whole_strength() -> None:
    """By hand it stands with tensions T: b / h - thrust + 2 T z / (W h) >= 0 >= -b / h - thrust + 2 T z / (W h), that is .044 to
    .244 of the weight. Pulled with .28 of it, or with nothing, it falls."""
    weak, strong = held_shell(0.06, 0.24), held_shell(0.28, 0.24)
    assert held_shell(0.0, 0.24).status == "unstable"
    assert (weak.status, strong.status) == ("optimal", "optimal")
    # More strength never makes it weaker, and the tension is one that the wall bears.
    assert strong.load_factor >= weak.load_factor - 1e-6
    assert strong.tie_forces[0] >= weak.tie_forces[0] - 1e-6


@pytest.mark.parametrize("strength", [500.0, 5e3, pytest.param(20e3, marks=pytest.mark.slow)])
def test_more_strength_than_serves_adds_nothing_to_a_tied_shell(strength: float) -> None:
    # Pushed along -y a wall leans out, and pulls another one after it by the tie: a tension in between serves best.
    flat, triangles = grid(2, 2, 2.0, 3.0)
    front, back = wall_points(flat), wall_points(flat) + np.array([0.0, 4.0, 0.0])
    model = shell(*joined_walls([(front, triangles), (back, triangles)]), cell=(0.5, 1.0), supported=lambda p: p[:, 2] < 1e-9)
    thickness = np.where(model.points[model.triangles].mean(axis=1)[:, 1] < 2.0, 0.5, 0.8)
    model = replace(model, thickness=thickness, surface_weight=18e3 * thickness)

    def factor(strength: float) -> cp.ShellLimitState:
        tie = cp.Tie("rod", (1.0, 0.25, 2.6), (1.0, 3.6, 2.6), strength=strength)
        return cp.shell_limit_analysis(model, cp.LoadCase((0, -1, 0)), [cp.Material("default", 18e3, 0.6)], ties=[tie])

    state = factor(strength)
    assert state.status == "optimal"
    added = (factor(strength + 20).load_factor - factor(strength - 20).load_factor) / 40
    assert state.tie_sensitivity[0] * 5e3 == pytest.approx(added * 5e3, abs=1e-4)
    assert (state.tie_forces[0] < 0.5 * strength) == (strength > 500.0)
    assert (state.tie_sensitivity[0] * 5e3 > 0.1) == (strength == 500.0)


def test_what_a_tie_without_any_strength_would_add_is_told() -> None:
    dry, push = [cp.Material("default", 18e3, 0.6)], cp.LoadCase((0, 1, 0))

    def tied(*strengths: float) -> cp.ShellLimitState:
        model = wall_and_post(4, 0.0)[0]
        ties = [replace(wall_and_post(4, share)[1], name=f"t{number}") for number, share in enumerate(strengths)]
        return cp.shell_limit_analysis(model, push, dry, membrane="CST", ties=ties)

    none, beside, weak = tied(0.0), tied(0.02, 0.0), tied(1e-3)
    assert weak.tie_sensitivity[0] > 1e-6
    assert none.tie_sensitivity == pytest.approx(weak.tie_sensitivity, rel=1e-6)
    assert beside.tie_sensitivity == pytest.approx(2 * [*weak.tie_sensitivity], rel=1e-6)
    assert beside.tie_forces[1] == 0.0


def test_a_shell_that_no_tension_holds_does_not_stand() -> None:
    # By hand T >= .344 W, which would have to bend the wall between tie and corners; a tie of .3 W does not hold it.
    state = held_shell(0.3, 0.74)
    assert state.status == "unstable"
    assert state.tie_forces == pytest.approx([0.0])


TIED = """
name = "tied"
[source]
dxf = "block.dxf"
[material.default]
unit_weight_kN_m3 = 18.0
friction = 2.0
[[load]]
direction = [1, 0, 0]
[[ties]]
name = "rod"
start = { at_m = [-2.0, 0.5, 3.5] }
end = { at_m = [0.0, 0.5, 3.5] }
area_mm2 = 18
steel_strength_MPa = 200
"""


def test_a_tied_block_through_a_case(tmp_path: Path) -> None:
    # A block of 1 x 4 m, 72 kN, tied at 3.5 m with 0.05 of its weight to a post that stays: b / h + 2 T z / (W h) = .3375.
    solids = [box((-9, 9), (-9, 9), (-1, 0)), box((0, 1), (0, 1), (0, 4)), box((-3, -2), (0, 1), (0, 4))]
    cp.write_dxf(cp.Assemblage.from_polyhedra(solids, 18e3, fixed=[0, 2]), tmp_path / "block.dxf")
    (tmp_path / "case.toml").write_text(TIED)
    run = tmp_path / "run"
    configure(tmp_path / "case.toml", run)
    base, made = (
        run / "geometry/base",
        [run / name for name in ("stones.npz", "stones.vtu", "contacts.npz", "state.npz", "r.json")],
    )
    stages.drawing(base / "settings.json", tmp_path / "block.dxf", *made[:2])
    stages.contacts(base / "tolerances.json", made[0], made[2])
    stages.rigid(run / "rigid/+x_associative/settings.json", made[0], *made[2:])
    record = as_written(read_record(made[4], Analysis), defaults=False)
    assert record["load_factor"] == pytest.approx(0.3375, rel=1e-6)
    (rod,) = record["tie_forces"]
    assert rod["tension_kN"] == pytest.approx(3.6, rel=1e-6)
    assert rod["yielded"]
    assert "gains" not in record  # one wall alone


def test_a_bar_along_a_wall_stays_in_it() -> None:
    building = free_wall(
        length=4.0,
        brick=(1.0, 0.5, 0.5),
        courses=6,
        materials=[cp.Material("default", 18e3, 0.6)],
        openings=[{"start": 1.0, "width": 1.0, "sill_courses": 2, "height_courses": 2, "lintel_bearing": 0.5}],
    )
    stones = cp.derive_blocks(building)

    def chain(height: float) -> cp.TieBar:
        return cp.TieBar("chain", start=("wall", 0.0, height), end=("wall", 4.0, height), **STEEL)

    assert place_ties(stones, [chain(2.75)])[0].length == pytest.approx(4.0)
    with pytest.raises(
        InputError, match=r"tie chain: it leaves the masonry of the wall wall; found an opening at \[1\.\d+, 0\.25, 1\.5\]"
    ):
        place_ties(stones, [chain(1.5)])
    with pytest.raises(InputError, match=r"tie chain: start: below the wall wall; found -0\.2 m; expected at least 0 m"):
        place_ties(stones, [chain(-0.2)])
    # Its ends given as points, it may cross the opening in the open.
    ends = {"start": (0.0, 0.25, 1.25), "end": (4.0, 0.25, 1.25)}
    assert place_ties(stones, [cp.TieBar("chain", **ends, **STEEL)])[0].length == pytest.approx(4.0)
