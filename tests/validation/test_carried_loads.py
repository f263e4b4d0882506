"""Roofs, floors, thrusts and soil on walls: closed forms of elementary statics, by hand, and both models alike.

A wall of thickness b, height h and weight w (all per metre of length) turns about the edge of its base that it is pushed
towards. On its top act p downwards at e from its middle towards that edge, a thrust H outwards and a mass m that is pushed. The
moments about the edge balance at

    alpha (w h / 2 + m h) = w b / 2 + p (b / 2 - e) - H h.
"""

import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import churchpipe as cp
from churchpipe import generators
from churchpipe.compare import safety
from churchpipe.errors import InputError
from churchpipe.generators.wall import wall as free_wall
from churchpipe.loading.placing import place_loads
from churchpipe.loading.wrenches import resultant
from churchpipe.model.carried import Carried
from shell_meshes import grid, shell, wall_points
from solids import box, on_ground

B, H, GAMMA = 0.5, 3.0, 18e3
W = GAMMA * B * H


def by_hand(
    p: float = 0.0, e: float = 0.0, thrust: float = 0.0, mass: float = 0.0, w: float = W, b: float = B, h: float = H
) -> float:
    return (w * b / 2 + p * (b / 2 - e) - thrust * h) / (w * h / 2 + mass * h)


def brick_wall(length: float = 4.0) -> cp.Building:
    """A wall along x, .5 m thick (y from 0) and 3 m high."""
    return free_wall(length=length, brick=(1.0, B, 0.5), courses=6, materials=[cp.Material("default", GAMMA, 2.0)])


def pushed(stones: cp.Assemblage, load: cp.LoadCase, loads: list[Carried], friction: float = 2.0) -> cp.LimitState:
    state = cp.limit_analysis(stones, cp.find_contacts(stones), cp.loaded(load, stones, loads), friction)
    assert state.status == "optimal"
    return state


P, M = 9e3, 4e3
LOADS: list[tuple[dict[str, Any], dict[str, float]]] = [
    ({"dead": P, "mass": 0.0}, {"p": P}),
    ({"dead": P}, {"p": P, "mass": P}),
    ({"dead": P, "mass": 0.0, "thrust": 1e3, "toward": "+y"}, {"p": P, "thrust": 1e3}),
    ({"dead": P, "mass": 0.0, "thrust": -1e3, "toward": "-y"}, {"p": P, "thrust": 1e3}),
    ({"dead": P, "mass": M, "eccentricity": 0.15, "toward": "+y"}, {"p": P, "e": 0.15, "mass": M}),
    ({"dead": P, "mass": M, "eccentricity": 0.15, "toward": "-y"}, {"p": P, "e": -0.15, "mass": M}),
    ({"mass": M}, {"mass": M}),
]


@pytest.mark.parametrize(("given", "said"), LOADS)
def test_a_roof_on_a_wall(given: dict[str, Any], said: dict[str, float]) -> None:
    stones = cp.derive_blocks(brick_wall())
    state = pushed(stones, cp.LoadCase((0, 1, 0)), [cp.LineLoad("wall", **given)])
    assert state.load_factor == pytest.approx(by_hand(**said), rel=1e-6)


def test_a_thrust_that_overturns_the_wall() -> None:
    stones = cp.derive_blocks(brick_wall())
    too_much = cp.LineLoad("wall", thrust=1.01 * W * B / 2 / H, toward="+y")
    state = cp.limit_analysis(stones, cp.find_contacts(stones), cp.loaded(cp.LoadCase((0, 1, 0)), stones, [too_much]), 2.0)
    assert state.status == "unstable"


def two_walls() -> cp.Assemblage:
    """Walls of .5 m and .8 m, 3 m high and 4 m long, with 5 m clear between them."""
    plate = box((-50, 50), (-50, 50), (-1, 0))
    walls = [box((0, 0.5), (0, 4), (0, 3)), box((5.5, 6.3), (0, 4), (0, 3))]
    return cp.Assemblage.from_polyhedra([plate, *walls], GAMMA, [0], panel=["", "west", "east"])


@pytest.mark.parametrize(("way", "thickness", "e"), [((1, 0, 0), 0.5, 0.1), ((-1, 0, 0), 0.5, -0.1)])
def test_a_floor_between_two_walls(way: tuple[int, int, int], thickness: float, e: float) -> None:
    # Each wall takes q x 5 m / 2, .1 m from its middle towards the floor; the thinner one falls first, either way.
    q = 3e3
    stones = two_walls()
    state = pushed(stones, cp.LoadCase(way), [cp.AreaLoad(["west", "east"], dead=q, mass=0.5 * q, bearing=0.1)])
    line = q * 5 / 2
    expected = by_hand(p=line, e=e, mass=0.5 * line, w=GAMMA * thickness * 3, b=thickness)
    assert state.load_factor == pytest.approx(expected, rel=1e-6)


def room() -> cp.Assemblage:
    """Four walls around 4 x 6 m clear."""
    walls = {
        "west": box((-0.5, 0), (-0.5, 6.5), (0, 3)),
        "east": box((4, 4.5), (-0.5, 6.5), (0, 3)),
        "south": box((0, 4), (-0.5, 0), (0, 3)),
        "north": box((0, 4), (6, 6.5), (0, 3)),
    }
    plate = box((-50, 50), (-50, 50), (-1, 0))
    return cp.Assemblage.from_polyhedra([plate, *walls.values()], GAMMA, [0], panel=["", *walls])


def test_a_floor_of_two_ways() -> None:
    # Triangles of 4 x 2 / 2 m2 on the short walls, trapezia of (6 + 2) / 2 x 2 m2 on the long ones, all symmetric.
    found = place_loads(room(), [cp.AreaLoad(["west", "east", "south", "north"], dead=1e3)])
    weight = {name: float(found.weight[found.wall == name].sum()) for name in ("west", "east", "south", "north")}
    assert weight == pytest.approx({"west": 8e3, "east": 8e3, "south": 4e3, "north": 4e3}, rel=1e-9)
    assert found.weight @ found.point / found.weight.sum() == pytest.approx([2, 3, 3], rel=1e-9)


def test_water_behind_a_wall() -> None:
    # gamma h^2 / 2 per metre at h / 3, over the lower 2 m alone.
    stones = cp.derive_blocks(brick_wall())
    found = place_loads(stones, [cp.Pressure("wall", toward="+y", unit_weight=10e3, top=2.0)])
    total = np.concatenate([found.dead.sum(axis=0), np.cross(found.point, found.dead).sum(axis=0)])
    force = 10e3 * 2**2 / 2 * 4
    assert total == pytest.approx([0, force, 0, -force * 2 / 3, 0, force * 2], rel=1e-9, abs=1e-6)
    state = pushed(stones, cp.LoadCase((0, 1, 0)), [cp.Pressure("wall", toward="+y", unit_weight=10e3, top=1.0)])
    assert state.load_factor == pytest.approx((W * B / 2 - 10e3 / 6) / (W * H / 2), rel=1e-6)


@pytest.mark.parametrize("name", ["west", "south", "middle"])
def test_water_presses_on_stones_of_other_walls_that_show_in_the_face(name: str) -> None:
    # Every other course of a toothed corner, and of a partition that is toothed in, shows an end of a stone of the other wall.
    materials = [cp.Material("default", GAMMA, 0.6)]
    if name == "middle":
        building = generators.prototype(
            brick=(0.4, 0.2, 0.3),
            partitions_x=(0.0, 1.2, 2.4),
            partition_length=1.0,
            courses=4,
            main_wall_length=2.6,
            materials=materials,
        )
        wall, toward, length = "main", (0, 1, 0), 2.6
    else:
        building = generators.box(length=2.4, width=2.0, courses=4, brick=(0.4, 0.2, 0.3), materials=materials)
        wall = name
        toward, length = {"west": ((1, 0, 0), 2.0), "south": ((0, 1, 0), 2.4)}[name]
    stones = cp.derive_blocks(building)
    found = place_loads(stones, [cp.Pressure(wall, toward=toward, unit_weight=10e3, top=1.0, surcharge=2e3)])
    force = (10e3 / 2 + 2e3) * length
    moment = (10e3 / 6 + 2e3 / 2) * length
    along = found.point[:, 1 if name == "west" else 0]
    assert found.dead.sum(axis=0) == pytest.approx(force * np.array(toward), rel=1e-9, abs=1e-6)
    assert np.linalg.norm(found.dead, axis=1) @ found.point[:, 2] == pytest.approx(moment, rel=1e-9)
    assert np.linalg.norm(found.dead, axis=1) @ along == pytest.approx(force * length / 2, rel=1e-9)


@pytest.mark.parametrize(("wall", "toward", "clear"), [("west", "-x", 1.6), ("south", "-y", 2.0)])
def test_water_in_a_room_presses_between_its_corners(wall: str, toward: str, clear: float) -> None:
    materials = [cp.Material("default", GAMMA, 0.6)]
    stones = cp.derive_blocks(generators.box(length=2.4, width=2.0, courses=4, brick=(0.4, 0.2, 0.3), materials=materials))
    found = place_loads(stones, [cp.Pressure(wall, toward=toward, unit_weight=10e3, top=1.0)])
    assert np.abs(found.dead).sum() == pytest.approx(10e3 / 2 * clear, rel=1e-9)


@pytest.mark.parametrize(("pattern", "thickness"), [("running", 0.45), ("stack", 0.3), ("header-stretcher", 0.35)])
def test_water_in_a_room_presses_beside_what_lies_against_a_stone(pattern: str, thickness: float) -> None:
    # Where stones are not as long as the wall is thick, walls that cross lie against parts of faces.
    materials = [cp.Material("default", GAMMA, 0.6)]
    brick = (0.5, thickness / 2 if pattern == "header-stretcher" else thickness, 0.2)
    stones = cp.derive_blocks(
        generators.box(length=4.0, width=3.0, courses=6, brick=brick, pattern=pattern, joints="grid", materials=materials)
    )
    for wall, toward, clear in (("west", "-x", 3.0 - 2 * thickness), ("south", "-y", 4.0 - 2 * thickness)):
        found = place_loads(stones, [cp.Pressure(wall, toward=toward, unit_weight=10e3, top=1.0)])
        across = found.point[:, 1 if wall == "west" else 0]
        assert np.abs(found.dead).sum() == pytest.approx(10e3 / 2 * clear, rel=1e-9)
        assert across.min() > thickness
        assert across.max() < clear + thickness


def test_the_load_factor_stays_base_shear_over_what_is_pushed() -> None:
    # At any profile the push adds up to the weight of the pushed stones and masses, at the height of each where it is linear.
    stones = cp.derive_blocks(brick_wall())
    for profile in ("uniform", "linear"):
        load = cp.loaded(cp.LoadCase((0, 1, 0), profile=profile), stones, [cp.LineLoad("wall", dead=P)])
        own = cp.LoadCase((0, 1, 0), profile=profile)
        free = ~stones.fixed
        height = stones.centroid[free, 2]
        weight = stones.weight[free]
        share = height * weight.sum() / (height @ weight) if profile == "linear" else np.ones(len(height))
        push = (share * weight).sum() + load.live[:, 1].sum()
        assert push == pytest.approx(weight.sum() + 4 * P, rel=1e-9)
        assert own.live is None
    every = np.append(share * weight + load.live[free, 1], 0.0)
    assert every.sum() == pytest.approx(weight.sum() + 4 * P)


@pytest.mark.parametrize("size", [0.5, 0.25])
def test_both_models_carry_the_same(size: float) -> None:
    building = brick_wall()
    stones, shell = cp.derive_blocks(building), cp.derive_shell(building, element_size=size)
    loads: list[Carried] = [
        cp.LineLoad("wall", dead=P, thrust=500.0, toward="+y", eccentricity=0.1),
        cp.LineLoad("wall", begin=0.3, end=1.7, height=1.5, dead=2e3, toward="+y", eccentricity=-0.25),
        cp.PointLoad("wall", 2.9, dead=5e3, mass=0.0),
        cp.Pressure("wall", toward="-y", unit_weight=5e3, top=1.2),
    ]
    load = cp.LoadCase((0, 1, 0))
    placed = place_loads(stones, loads)
    of_stones, of_shell = cp.loaded(load, stones, placed), cp.shell_loaded(load, shell, stones, placed)
    for part in ("dead", "live"):
        sums = [resultant(model.centroid, getattr(case, part)) for model, case in ((stones, of_stones), (shell, of_shell))]
        np.testing.assert_allclose(sums[1], sums[0], rtol=1e-9, atol=1e-9 * np.abs(sums[0]).max())
    figures = [
        figure for figure in cp.match_models(stones, cp.find_contacts(stones), shell, placed).figures if "loads" in figure.name
    ]
    assert [figure.name for figure in figures] == ["loads carried: dead", "loads carried: masses"]
    assert all(figure.passed and figure.tolerance == 1e-9 for figure in figures)
    # Several cases of one mesh are compared each.
    twice = cp.match_models(stones, cp.find_contacts(stones), shell, [placed, place_loads(stones, loads[:1])]).figures
    assert [figure.name for figure in twice[-2:]] == ["loads carried: dead, case 2", "loads carried: masses, case 2"]


def shell_of_wall(rows: int, length: float = 2.0) -> cp.ShellModel:
    """The mid-surface of `brick_wall` as a regular mesh."""
    points, triangles = grid(round(rows * length / H), rows, length, H)
    middle = wall_points(points) + np.array([0.0, B / 2, 0.0])
    return shell(middle, triangles, thickness=B, cell=(0.5, 1.0), surface_weight=GAMMA * B, supported=lambda p: p[:, 2] < 1e-9)


@pytest.mark.parametrize("rows", [4, 8])
def test_the_shell_under_a_roof_has_the_closed_form(rows: int) -> None:
    stones = cp.derive_blocks(brick_wall(2.0))
    roof = [cp.LineLoad("wall", dead=P, mass=M, thrust=500.0, toward="+y", eccentricity=0.1)]
    expected = by_hand(p=P, e=0.1, thrust=500.0, mass=M)
    assert pushed(stones, cp.LoadCase((0, 1, 0)), roof).load_factor == pytest.approx(expected, rel=1e-6)
    mesh = shell_of_wall(rows)
    load = cp.shell_loaded(cp.LoadCase((0, 1, 0)), mesh, stones, roof)
    state = cp.shell_limit_analysis(mesh, load, [cp.Material("default", GAMMA, 0.6)], membrane="CST")
    assert state.load_factor == pytest.approx(expected, rel=1e-6)


BAD: list[tuple[Callable[[], Carried], str | None]] = [
    (lambda: cp.LineLoad("north", dead=1.0), "line load north: no such wall; found north; expected wall"),
    (lambda: cp.LineLoad("wall"), "line load wall: no load"),
    (lambda: cp.LineLoad("wall", dead=-1.0), "line load wall: dead: out of range; found -1.0"),
    (lambda: cp.LineLoad("wall", dead=1.0, mass=-1.0), "line load wall: mass: out of range"),
    (lambda: cp.LineLoad("wall", thrust=1.0), "line load wall: a thrust without a direction"),
    (lambda: cp.LineLoad("wall", dead=1.0, eccentricity=0.1), "an eccentricity without a direction"),
    (lambda: cp.LineLoad("wall", thrust=1.0, toward="+x"), None),
    (lambda: cp.LineLoad("wall", dead=1.0, eccentricity=0.1, toward="+x"), "toward: it runs along the wall wall"),
    (
        lambda: cp.LineLoad("wall", dead=1.0, eccentricity=0.3, toward="+y"),
        "eccentricity: beside the wall wall; found 0.3 m; expected at most half its thickness",
    ),
    (lambda: cp.LineLoad("wall", dead=1.0, end=4.5), "beyond the wall wall; found from 0 m to 4.5 m"),
    (lambda: cp.LineLoad("wall", dead=1.0, begin=2.0, end=1.0), "no length"),
    (lambda: cp.LineLoad("wall", dead=1.0, height=3.2), "no stone under it"),
    (lambda: cp.LineLoad(dead=1.0), "line load: no place"),
    (lambda: cp.LineLoad("wall", between=((0, 0, 0), (1, 0, 0)), dead=1.0), "two places"),
    (lambda: cp.PointLoad("wall", dead=1.0), "no place on the wall"),
    (
        lambda: cp.PointLoad("wall", 5.0, dead=1.0),
        "beyond the wall wall; found 5 m; expected within 0 and 4 m along it: along its longer side in plan, +x from (0, ",
    ),
    (lambda: cp.PointLoad(at=(9, 9, 3), dead=1.0), "no stone under it"),
    (lambda: cp.AreaLoad(["wall"], dead=1.0), "not two walls or four"),
    (lambda: cp.AreaLoad(["wall", "north"], dead=1.0), "no such wall; found north"),
    (lambda: cp.Pressure("wall", toward="+y", unit_weight=-1.0, top=1.0), "unit_weight: out of range"),
    (lambda: cp.Pressure("wall", toward="+y", unit_weight=1.0, top=-1.0), "no face of the wall wall below"),
    (lambda: cp.Pressure("wall", toward="up", unit_weight=1.0, top=1.0), "toward: unknown direction; found up"),
]


@pytest.mark.parametrize(("make", "said"), BAD)
def test_bad_loads(make: Any, said: str | None) -> None:
    stones = cp.derive_blocks(brick_wall())
    if said is None:
        place_loads(stones, [make()])
        return
    with pytest.raises(InputError, match=re.escape(said)):
        place_loads(stones, [make()])


@pytest.mark.parametrize(("length", "way", "at"), [(6.0, "+y from (0, 0)", (0.0, 1.0)), (2.0, "+x from (-2.3, 1)", (-1.3, 1.0))])
def test_a_place_on_a_vault_is_measured_along_its_longer_side(length: float, way: str, at: tuple[float, float]) -> None:
    stones = cp.derive_blocks(generators.vault(span=4.0, thickness=0.3, courses=9, stone_length=0.5, length=length))
    placed = place_loads(stones, [cp.PointLoad("vault", 1.0, dead=1e3)])
    assert placed.point[:, :2] == pytest.approx(np.array([at] * len(placed.stone)), abs=1e-6)
    with pytest.raises(InputError, match="beyond the wall vault.* along its longer side in plan, " + re.escape(way)):
        place_loads(stones, [cp.PointLoad("vault", 9.0, dead=1e3)])


def test_a_load_over_an_opening() -> None:
    building = free_wall(
        length=4.0,
        brick=(1.0, B, 0.5),
        courses=6,
        materials=[cp.Material("default", GAMMA, 2.0)],
        openings=[{"start": 1.0, "width": 1.0, "sill_courses": 2, "height_courses": 2, "lintel_bearing": 0.5}],
    )
    stones = cp.derive_blocks(building)
    with pytest.raises(InputError, match=r"line load wall: no stone under it; found nothing at \[1\.5, 0\.25, 1\.5\] m"):
        place_loads(stones, [cp.LineLoad("wall", height=1.5, dead=1.0)])
    over = place_loads(stones, [cp.LineLoad("wall", dead=1.0)])
    assert over.weight.sum() == pytest.approx(4.0)


def test_two_leaves_share_what_stands_between_them() -> None:
    stones = on_ground(box((0, 0.3), (0, 1), (0, 1)), box((0.3, 0.6), (0, 1), (0, 1)))
    found = place_loads(
        stones, [cp.PointLoad(at=(0.3, 0.5, 1.0), dead=2.0), cp.LineLoad(between=((0.1, 0, 1), (0.1, 1, 1)), dead=1.0)]
    )
    shares = [float(found.weight[found.stone == stone].sum()) for stone in (1, 2)]
    assert shares == pytest.approx([2.0, 1.0])


def test_a_push_of_nothing_but_a_live_force() -> None:
    # A level force F at the top: F h = w b / 2.
    stones = on_ground(box((0, 1), (0, 1), (0, 2)))
    live = np.zeros((2, 6))
    live[1] = [1.0, 0, 0, 0, 1.0, 0]
    state = cp.limit_analysis(stones, cp.find_contacts(stones), cp.loaded(cp.LoadCase(live=live), stones, []), 2.0)
    assert state.load_factor == pytest.approx(36e3 * 0.5 / 2, rel=1e-6)


def test_the_check_counts_the_masses() -> None:
    # A block b x h of weight P that turns about its toe with a mass Q on its top: P moves by h / 2, Q by h.
    stones = on_ground(box((0, 1), (0, 1), (0, 2)))
    placed = place_loads(stones, [cp.PointLoad(at=(0.5, 0.5, 2.0), dead=9e3)])
    load = cp.LoadCase((1, 0, 0))
    state = cp.limit_analysis(stones, cp.find_contacts(stones), cp.loaded(load, stones, placed), 2.0)
    assert state.load_factor == pytest.approx((36 * 0.5 + 9 * 0.5) / (36 * 1 + 9 * 2), rel=1e-6)
    check = safety(stones, state, load, None, placed)
    share = (36 * 1 + 9 * 2) ** 2 / ((36 + 9) * (36 * 1 + 9 * 4))
    assert check.alpha0 == pytest.approx(state.load_factor, rel=1e-6)
    assert check.moving_weight == pytest.approx(45e3)
    assert check.mass_fraction == pytest.approx(share, rel=1e-6)


def test_a_ring_beam_holds_a_wall_together() -> None:
    # Two piers side by side, of which a load pushes one: alone it turns at b / h, under one beam it takes the other along.
    plate = box((-50, 50), (-50, 50), (-1, 0))
    piers = [box((x, x + 1), (0, 0.5), (0, 3)) for x in (0, 1)]
    stones = cp.Assemblage.from_polyhedra([plate, *piers], GAMMA, [0], panel=["", "wall", "wall"])
    push = np.zeros((3, 6))
    push[1, 1] = 1.0
    alone = cp.limit_analysis(stones, cp.find_contacts(stones), cp.LoadCase(live=push), 2.0)
    assert alone.load_factor >= GAMMA * 0.5 * 3 * 0.25 / 1.5 * (1 - 1e-6)
    beamed = cp.with_ring_beams(stones, ["wall"], height=0.25, unit_weight=24e3)
    assert beamed.count == 4
    assert beamed.weight[3] == pytest.approx(24e3 * 0.25 * 0.5 * 2)
    assert beamed.panel[3] == "beam on wall"
    contacts = cp.find_contacts(beamed)
    # Pushed all alike they turn as one body about their toes.
    pier, beam = GAMMA * 0.5 * 3, 24e3 * 0.25 * 0.5 * 2
    alike = cp.limit_analysis(beamed, contacts, cp.LoadCase((0, 1, 0)), 2.0)
    assert alike.load_factor == pytest.approx((2 * pier + beam) * 0.25 / (2 * pier * 1.5 + beam * 3.125), rel=1e-6)
    # One pushed at h / 2 by a live force takes the other along by what friction allows, at most all of it.
    live = np.zeros((4, 6))
    live[1, 1] = 1.0
    state = cp.limit_analysis(beamed, contacts, cp.LoadCase(live=live), 1e3)
    assert state.status == "optimal"
    assert state.load_factor > pier * 0.25 / 1.5
    assert state.load_factor <= (2 * pier * 0.25 + beam * 0.25) / 1.5 * (1 + 1e-6)


def test_a_ring_beam_needs_a_wall() -> None:
    stones = cp.derive_blocks(brick_wall())
    with pytest.raises(InputError, match="ring beam on roof: no such wall"):
        cp.with_ring_beams(stones, ["roof"], height=0.3)
    with pytest.raises(InputError, match=r"ring beam on wall: width: out of range; found 0\.7"):
        cp.with_ring_beams(stones, ["wall"], height=0.3, width=0.7)


def test_one_beam_along_two_walls_is_one_body() -> None:
    # The same two piers as two walls end to end: by moments they turn as one body about their toes.
    plate = box((-50, 50), (-50, 50), (-1, 0))
    piers = [box((x, x + 1), (0, 0.5), (0, 3)) for x in (0, 1)]
    stones = cp.Assemblage.from_polyhedra([plate, *piers], GAMMA, [0], panel=["", "west", "east"])
    beamed = cp.with_ring_beams(stones, ["west", "east"], height=0.25, unit_weight=24e3, closed=True)
    assert beamed.count == 4
    pier, beam = GAMMA * 0.5 * 3, 24e3 * 0.25 * 0.5 * 2
    alike = cp.limit_analysis(beamed, cp.find_contacts(beamed), cp.LoadCase((0, 1, 0)), 2.0)
    assert alike.load_factor == pytest.approx((2 * pier + beam) * 0.25 / (2 * pier * 1.5 + beam * 3.125), rel=1e-6)


def test_a_closed_ring_beam_goes_all_around() -> None:
    stones = room()
    walls = ["west", "south", "east", "north"]
    beamed = cp.with_ring_beams(stones, walls, height=0.2, unit_weight=24e3, closed=True)
    assert beamed.count == stones.count + 1
    # Outer 5 x 7 m less the clear 4 x 6 m.
    assert beamed.volume[-1] == pytest.approx((5 * 7 - 4 * 6) * 0.2, rel=1e-9)
    contacts = cp.find_contacts(beamed)
    below = set(contacts.blocks[(contacts.blocks == beamed.count - 1).any(axis=1)].ravel().tolist()) - {beamed.count - 1}
    assert {str(beamed.panel[stone]) for stone in below} == set(walls)
    cp.check_soundness(beamed, contacts)
    # Each wall bears on the beam over its whole top.
    bears = (contacts.blocks == beamed.count - 1).any(axis=1)
    assert contacts.area[bears].sum() == pytest.approx(5 * 7 - 4 * 6, rel=1e-6)
    with pytest.raises(InputError, match=r"ring beam west east: its walls do not meet; found 2 parts"):
        cp.with_ring_beams(stones, ["west", "east"], height=0.2, closed=True)


def test_a_closed_ring_beam_holds_a_wall_that_falls_outwards() -> None:
    # Separate beams let the west wall fall by itself; one body has to slide on all four walls.
    load = cp.LoadCase((-1, 0, 0), panels=("west",))
    found = []
    for closed in (False, True):
        stones = cp.with_ring_beams(room(), ["west", "south", "east", "north"], height=0.2, closed=closed)
        state = cp.limit_analysis(stones, cp.find_contacts(stones), load, 0.6)
        assert state.status == "optimal"
        found.append(state.load_factor)
    assert found[1] > 1.1 * found[0]


def test_a_rigid_floor_ties_two_walls_by_friction_or_by_its_anchors() -> None:
    # Two walls 0.5 m thick, 3 m high, 6 m long under a plate; pushed outwards at mid-height, the west one turns about its toe.
    plate, walls = box((-50, 50), (-50, 50), (-1, 0)), [box((x, x + 0.5), (0, 6), (0, 3)) for x in (0, 4)]
    stones = cp.Assemblage.from_polyhedra([plate, *walls], GAMMA, [0], panel=["", "west", "east"])
    floored = cp.with_ring_beams(stones, ["west", "east"], height=0.2, unit_weight=25e3, slab=True)
    assert floored.volume[-1] == pytest.approx(4.5 * 6 * 0.2)
    contacts = cp.find_contacts(floored)
    wall, floor = GAMMA * 0.5 * 3 * 6, 25e3 * 4.5 * 6 * 0.2
    live = np.zeros((floored.count, 6))
    live[1, 0] = -wall
    kind = np.where((contacts.blocks == 3).any(axis=1), 0.2, 2.0)
    state = cp.limit_analysis(floored, contacts, cp.LoadCase(live=live), kind)
    # By moments about the toe: the wall, half of the plate on its inner edge, and its friction, 0.2 of that, at the top; at most.
    bare = (wall * 0.25) / (wall * 1.5)
    most = (wall * 0.25 + 0.5 * floor * 0.5 + 0.2 * 0.5 * floor * 3) / (wall * 1.5)
    assert bare < state.load_factor <= most * (1 + 1e-6)
    # Anchored to both, it takes the other wall along.
    anchored = [cp.JointGroup(name, between=("beam west east", name), cohesion=1e4) for name in ("west", "east")]
    strength = cp.joint_strength(floored, contacts, [cp.Material("default", GAMMA, 0.2)], anchored)
    held = cp.limit_analysis(floored, contacts, cp.LoadCase(live=live), kind, strength[1])
    assert held.load_factor > 1.2 * state.load_factor


def test_fill_weighs_what_lies_above_each_stone() -> None:
    # Beside each other a stone 1 m high, one 2 m high, and one whose top slopes from 2 m down to 1 m.
    wedge = (
        np.array([[2, 0, 0], [3, 0, 0], [3, 1, 0], [2, 1, 0], [2, 0, 2], [3, 0, 1], [3, 1, 1], [2, 1, 2]], dtype=float),
        [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]],
    )
    solids = [box((0, 1), (0, 1), (0, 1)), box((1, 2), (0, 1), (0, 2)), wedge]
    plate = box((-50, 50), (-50, 50), (-1, 0))
    stones = cp.Assemblage.from_polyhedra([plate, *solids], GAMMA, [0], panel=["", "low", "high", "slope"])
    found = place_loads(stones, [cp.Fill(on=("low", "high", "slope"), unit_weight=16e3, top=2.5, mass=8e3)])
    weight = {name: float(found.weight[found.wall == name].sum()) for name in ("low", "high", "slope")}
    assert weight == pytest.approx({"low": 16e3 * 1.5, "high": 16e3 * 0.5, "slope": 16e3 * 1.0}, rel=1e-12)
    assert found.mass.sum() == pytest.approx(0.5 * found.weight.sum(), rel=1e-12)
    # The column over the slope is a trapezium, 0.5 m deep at one side and 1.5 m at the other.
    mine = found.wall == "slope"
    assert found.weight[mine] @ found.point[mine, 0] / found.weight[mine].sum() == pytest.approx(2 + (0.5 / 2 + 1 / 3), rel=1e-12)
    # A surface at 1.5 m reaches the low stone and half of the slope alone.
    low = place_loads(stones, [cp.Fill(on=("low", "high", "slope"), unit_weight=16e3, top=1.5)])
    assert low.weight.sum() == pytest.approx(16e3 * (0.5 + 0.5 * 0.5 * 0.5), rel=1e-12)
    with pytest.raises(InputError, match="fill vault: on: no such vault; found vault; expected high, low, slope"):
        place_loads(stones, [cp.Fill(on=("vault",), unit_weight=16e3, top=2.5)])
    with pytest.raises(InputError, match="fill low: nothing that it could lie on"):
        place_loads(stones, [cp.Fill(on=("low",), unit_weight=16e3, top=0.5)])


def test_fill_on_a_barrel_comes_to_the_same_in_both_models() -> None:
    building = generators.vault(
        span=4.0, thickness=0.3, courses=15, length=2.0, stone_length=1.0, materials=(cp.Material("default", GAMMA, 0.6),)
    )
    stones, shell = cp.derive_blocks(building), cp.derive_shell(building, 1.0)
    crown = stones.points[~np.repeat(stones.fixed, np.diff(stones.block_point_ptr)), 2].max()
    placed = place_loads(stones, [cp.Fill(on=("vault",), unit_weight=16e3, top=crown + 0.1)])
    # The column over a chord of the extrados, which has the outer radius at its corners.
    angle = np.linspace(0, np.pi, 16)
    x, z = 2.3 * np.cos(angle), 2.3 * np.sin(angle)
    z += crown - z.max()
    area = sum(0.5 * abs(x[i + 1] - x[i]) * (2 * (crown + 0.1) - z[i] - z[i + 1]) for i in range(15))
    assert placed.weight.sum() == pytest.approx(16e3 * area * 2.0, rel=1e-6)
    figures = [f for f in cp.match_models(stones, cp.find_contacts(stones), shell, placed).figures if "loads" in f.name]
    assert len(figures) == 2
    assert all(figure.passed for figure in figures)


FLOOR = 3e3


@pytest.mark.parametrize(
    ("held", "tension", "together"),
    [
        ({"friction": 0.05}, 0.05 * FLOOR * 2.5, False),
        ({"fixing": 500.0}, 500.0, False),
        ({"friction": 0.05, "fixing": 500.0}, 0.05 * FLOOR * 2.5 + 500.0, False),
        ({"friction": 0.4}, np.nan, True),
    ],
)
def test_a_flexible_floor_holds_its_walls_by_its_bearings(held: dict[str, float], tension: float, together: bool) -> None:
    # Pushed to -x the thinner wall falls outwards, held with `tension` N a metre; strong joists pull the other wall along.
    stones, line = two_walls(), FLOOR * 2.5
    floor = cp.Diaphragm(["west", "east"], spacing=0.9, dead=FLOOR, bearing=0.1, name="floor", **held)
    joists = cp.place_ties(stones, [floor])
    assert [tie.name for tie in joists] == ["floor 1", "floor 2", "floor 3", "floor 4"]
    load = cp.loaded(cp.LoadCase((-1, 0, 0)), stones, [floor])
    state = cp.limit_analysis(stones, cp.find_contacts(stones), load, 2.0, ties=joists)
    falling = {"p": line, "e": -0.1, "mass": line, "w": GAMMA * 0.5 * 3, "b": 0.5}
    other = {"p": line, "e": 0.1, "mass": line, "w": GAMMA * 0.8 * 3, "b": 0.8}
    if together:
        masses = [one["w"] * 1.5 + line * 3 for one in (falling, other)]
        expected = sum(mass * by_hand(**one) for mass, one in zip(masses, (falling, other), strict=True)) / sum(masses)
    else:
        expected = by_hand(thrust=-tension, **falling)
        assert [tie.strength for tie in joists] == pytest.approx([tension] * 4)
    assert state.load_factor == pytest.approx(expected, rel=1e-6)
    assert state.upper_bound == pytest.approx(state.lower_bound, rel=1e-6)


def test_a_flexible_floor_does_not_push_its_walls_apart() -> None:
    stones = two_walls()
    floor = cp.Diaphragm(["west", "east"], spacing=0.9, dead=FLOOR, bearing=0.1, friction=0.4)
    push = cp.loaded(cp.LoadCase((1, 0, 0)), stones, [floor])
    held = cp.limit_analysis(stones, cp.find_contacts(stones), push, 2.0, ties=cp.place_ties(stones, [floor]))
    alone = pushed(stones, cp.LoadCase((1, 0, 0)), [cp.AreaLoad(["west", "east"], dead=FLOOR, bearing=0.1)])
    assert held.load_factor == pytest.approx(alone.load_factor, rel=1e-6)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"walls": ["west"]}, "not two walls"),
        ({"walls": ["west", "east", "south", "north"]}, "not two walls"),
        ({"friction": 0.0}, "nothing holds its joists"),
        ({"spacing": 0.0}, "spacing"),
        ({"dead": 0.0}, "no load"),
        ({"friction": -0.1}, "friction"),
        ({"joist": (0.1, 0.0)}, "joist"),
        ({"bearing_length": -1.0}, "bearing_length"),
    ],
)
def test_floors_that_are_none(given: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words) as raised:
        cp.Diaphragm(**({"walls": ["west", "east"], "spacing": 1.0, "dead": 1e3, "friction": 0.3} | given))
    assert "diaphragm" in str(raised.value)


def test_a_floor_on_a_wall_that_is_not_there() -> None:
    floor = cp.Diaphragm(["west", "south"], spacing=1.0, dead=1e3, friction=0.3)
    with pytest.raises(InputError, match="diaphragm west south: no such wall; found south"):
        cp.place_ties(two_walls(), [floor])


def test_soil_that_an_earthquake_shakes() -> None:
    """The coefficient of Mononobe and Okabe, friction 30 degrees, smooth wall, for the acceleration of the load factor itself.

    K = cos^2(phi - t) / (cos^2 t (1 + sqrt(sin phi sin(phi - t) / cos t))^2) with tan t = alpha; on a wall of .8 x 2.4 m at
    22 kN/m3, 1.8 m of soil at 18 kN/m3. With the static coefficient, 1/3, the load factor is a quarter too high.
    """
    thick, high, soil, phi = 0.8, 2.4, 1.8, np.pi / 6
    stones = cp.Assemblage.from_polyhedra(
        [box((-9, 9), (-9, 9), (-1, 0)), box((0, 2), (0, thick), (0, high))], 22e3, [0], panel=["", "wall"]
    )
    contacts = cp.find_contacts(stones)

    def shaken(alpha: float) -> float:
        turn = np.arctan(alpha)
        root = np.sqrt(np.sin(phi) * np.sin(phi - turn) / np.cos(turn))
        return float(np.cos(phi - turn) ** 2 / (np.cos(turn) * (1 + root)) ** 2)

    def load_factor(coefficient: float) -> float:
        pressed = cp.Pressure("wall", toward=(0, -1, 0), unit_weight=18e3, top=soil, coefficient=coefficient)
        state = cp.limit_analysis(stones, contacts, cp.loaded(cp.LoadCase((0, -1, 0)), stones, [pressed]), 2.0)
        weight = 22e3 * thick * high
        by_hand = (weight * thick / 2 - coefficient * 18e3 * soil**3 / 6) / (weight * high / 2)
        assert state.load_factor == pytest.approx(by_hand, rel=1e-6)
        return state.load_factor

    found = static = load_factor(shaken(0.0))
    for _ in range(30):
        found = 0.5 * (found + load_factor(shaken(found)))
    assert static == pytest.approx(0.2183, abs=5e-5)
    assert found == pytest.approx(0.1767, abs=5e-5)
    assert shaken(found) == pytest.approx(0.454, abs=5e-4)
