"""Houses of straight walls along x and y, each with its own doors and windows."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import churchpipe as cp
from churchpipe import generators
from churchpipe.errors import InputError
from churchpipe.resources import sample_case
from sound import laid

COURSE, STONE, THICK = 0.25, 0.5, 0.5
BOND: dict[str, Any] = {"course": COURSE, "stone_length": STONE, "height": 3.0, "thickness": THICK}
# Over all 6 x 5 m: the lines are its outer faces.
SOUTH = {"name": "south", "start": (0, 0), "end": (6, 0), "toward": "+y"}
NORTH = {"name": "north", "start": (0, 5), "end": (6, 5), "toward": "-y"}
WEST = {"name": "west", "start": (0, 0), "end": (0, 5), "toward": "+x"}
EAST = {"name": "east", "start": (6, 0), "end": (6, 5), "toward": "-x"}
ROOM = [SOUTH, NORTH, WEST, EAST]
INNER = {"name": "inner", "start": (3.5, 0), "end": (3.5, 5), "thickness": 0.3}
SPINE = {"name": "spine", "start": (0, 2.5), "end": (6, 2.5), "thickness": 0.4}
DOOR = {"name": "door", "wall": "south", "centre": 2.0, "width": 1.0, "height": 2.0}
ARCHED = DOOR | {"shape": "segmental", "height": 2.1, "rise": 0.2, "voussoirs": 7, "depth": 0.3}
TWO = (cp.UnitWeight("default", 18e3), cp.UnitWeight("oak", 7e3))


def house(*walls: dict[str, Any], openings: Any = (), **given: Any) -> cp.Building:
    return generators.house(**BOND | {"walls": [*ROOM, *walls], "openings": openings} | given)


def volume_of(stones: cp.Assemblage, wall: str | None = None) -> float:
    return float(stones.volume[~stones.fixed & ((stones.panel == wall) if wall else True)].sum())


@pytest.mark.parametrize("door", [{}, {"lintel_bearing": 0.3}])
def test_four_walls_are_the_box(door: dict[str, Any]) -> None:
    # The same room from the other generator, with the same openings in opposite walls, stone by stone.
    opening = {"start": 1.5, "width": 1.0, "height_courses": 8, "lintel_bearing": 0.25} | door
    box = generators.box(
        length=6.0, width=5.0, courses=12, brick=(STONE, THICK, COURSE), joints="bay", openings_x=[opening], openings_y=[opening]
    )
    both = [DOOR | {"wall": ["south", "north"]} | door, DOOR | {"name": "side", "wall": ["west", "east"]} | door]
    stones, contacts = laid(house(openings=both))
    expected, joints = laid(box)
    np.testing.assert_allclose(stones.points, expected.points, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(stones.block_id[stones.course < 8], expected.block_id[expected.course < 8])
    assert len(contacts.area) == len(joints.area)


def test_the_volume_is_that_of_the_walls() -> None:
    openings = [
        DOOR | {"centre": 2.5},
        {"name": "window", "wall": ["south", "north"], "centre": [1.15, 4.85], "width": 0.7, "sill": [0.75], "height": 1.0},
        {"name": "way", "wall": "inner", "centre": 1.5, "width": 0.7, "height": 2.0},
    ]
    stones, _ = laid(house(INNER, SPINE, openings=openings))
    ring = (6 * 5 - 5 * 4) * 3.0
    inner = (4 * 0.3 + 5 * 0.4 - 0.3 * 0.4) * 3.0
    holes = (1.0 * 2.0 + 4 * 0.7 * 1.0) * THICK + 0.7 * 2.0 * 0.3
    assert volume_of(stones) == pytest.approx(ring + inner - holes, rel=1e-9)


def test_openings_are_where_they_are_asked_for() -> None:
    windows = {
        "name": "window",
        "wall": ["south", "east"],
        "centre": [1.3, 3.5],
        "width": 0.8,
        "sill": [0.75, 3.75],
        "height": 1.5,
    }
    oculus = {
        "name": "eye",
        "wall": "north",
        "centre": 3.0,
        "width": 0.6,
        "sill": 5.0,
        "shape": "circle",
        "voussoirs": 10,
        "depth": 0.2,
    }
    arch = ARCHED | {"wall": "west", "centre": 2.5}
    building = house(openings=[windows, oculus, arch], height=6.5)
    found = {
        (panel.name, opening.name): np.concatenate([opening.outline.min(axis=0), opening.outline.max(axis=0)]).round(9).tolist()
        for panel in building.panels
        for opening in panel.openings
    }
    storeys = [(0.75, 2.25), (3.75, 5.25)]
    expected = {
        (wall, f"window-{storey}-{place}"): [centre - 0.4, low, centre + 0.4, high]
        for wall in ("south", "east")
        for storey, (low, high) in enumerate(storeys, start=1)
        for place, centre in enumerate((1.3, 3.5), start=1)
    }
    # The height of an arched door is that of its crown; of a circle the sill is its lowest point.
    expected |= {("north", "eye"): [2.7, 5.0, 3.3, 5.6], ("west", "door"): [2.0, 0.0, 3.0, 2.1]}
    assert found.keys() == expected.keys()
    for key, box in expected.items():
        # Rings are polygons: only their joints are on the circle.
        np.testing.assert_allclose(found[key], box, atol=0.016 if key[1] in ("eye", "door") else 1e-9)
    laid(building)


def test_a_lintel_is_one_stone_of_its_own_material_on_both_bearings() -> None:
    lintel = {"lintel_bearing": 0.3, "lintel_height": 0.5, "lintel_material": "oak"}
    stones, _ = laid(house(openings=[DOOR | lintel], materials=TWO))
    (found,) = np.flatnonzero(stones.material == "oak")
    corner = stones.points[slice(*stones.block_point_ptr[found : found + 2])]
    np.testing.assert_allclose([corner.min(axis=0), corner.max(axis=0)], [[1.2, 0.0, 2.0], [2.8, THICK, 2.5]], atol=1e-12)
    # Without a word about it there is one, of half a stone on either side and one course high.
    (region,) = house(openings=[DOOR]).panels[0].regions[1:]
    np.testing.assert_allclose([region.outline.min(axis=0), region.outline.max(axis=0)], [[1.25, 2.0], [2.75, 2.25]])
    assert not region.yields


@pytest.mark.parametrize(("centre", "bearing"), [(1.2, 0.2), (1.3, 0.3), (1.375, 0.25), (1.5, 0.25)])
def test_a_lintel_goes_on_to_a_wall_beside_it_where_a_sliver_would_be_left(centre: float, bearing: float) -> None:
    # The face of the corner is at 0.5 m, and no stone may be narrower than 0.125 m.
    building = house(openings=[DOOR | {"centre": centre}])
    (region,) = building.panels[0].regions[1:]
    assert centre - 0.5 - region.outline[:, 0].min() == pytest.approx(bearing)
    assert region.outline[:, 0].max() - centre - 0.5 == pytest.approx(0.25)
    laid(building)


@pytest.mark.parametrize(("pier", "bearings"), [(0.4, 0.2), (0.6, 0.3), (0.7, 0.25)])
def test_lintels_meet_over_a_pier_where_a_sliver_would_be_left(pier: float, bearings: float) -> None:
    pair = [DOOR | {"centre": 2.0}, DOOR | {"name": "other", "centre": 3.0 + pier}]
    building = house(openings=pair)
    first, second = building.panels[0].regions[1:]
    assert first.outline[:, 0].max() == pytest.approx(2.5 + bearings)
    assert second.outline[:, 0].min() == pytest.approx(2.5 + pier - bearings)
    laid(building)


def test_ends_on_the_outer_face_the_centreline_or_the_inner_face_make_one_house() -> None:
    expected = laid(house(INNER))[0]
    lines = [
        {"name": "south", "start": (0.25, 0.25), "end": (5.75, 0.25)},
        {"name": "north", "start": (5.5, 4.75), "end": (0.5, 4.75)},
        WEST | {"start": (0, 0.5), "end": (0, 4.5)},
        {"name": "east", "start": (5.5, 5.0), "end": (5.5, 0.1), "toward": "+x"},
        INNER | {"start": (3.65, 0.5), "end": (3.65, 4.6), "toward": "-x"},
    ]
    stones, _ = laid(generators.house(**BOND, walls=lines))
    np.testing.assert_allclose(stones.points, expected.points, rtol=0, atol=1e-9)


@pytest.mark.parametrize("first_course", ["x", "y"])
def test_corners_and_junctions_are_toothed(first_course: str) -> None:
    building = house(INNER, SPINE, first_course=first_course)
    through = {panel.name: panel.runs_through for panel in building.panels}
    assert through["south"] == through["spine"] == (0 if first_course == "x" else 1)
    assert through["west"] == through["inner"] == (1 if first_course == "x" else 0)
    stones, contacts = laid(building)
    # On each course one wall has a stone across the middle of each corner, T and X: in turn, the one and the other.
    places = {
        ("south", "west"): (0.25, 0.25),
        ("north", "east"): (5.75, 4.75),
        ("south", "inner"): (3.5, 0.25),
        ("spine", "west"): (0.25, 2.5),
        ("spine", "inner"): (3.5, 2.5),
    }
    low = np.minimum.reduceat(stones.points, stones.block_point_ptr[:-1])
    high = np.maximum.reduceat(stones.points, stones.block_point_ptr[:-1])
    for (first, second), place in places.items():
        across = ~stones.fixed & (low[:, :2] < place).all(axis=1) & (high[:, :2] > place).all(axis=1)
        walls = [set(stones.panel[across & (stones.course == course)]) for course in range(12)]
        turns = [{first}, {second}] if first_course == "x" else [{second}, {first}]
        assert walls == turns * 6
        # Each of these stones reaches beyond the junction: it bonds the walls, and lies on stones of both.
        both = {first, second}
        joined = np.sort(stones.panel[contacts.blocks], axis=1) == sorted(both)
        assert joined.all(axis=1).sum() > 12


def test_walls_of_unlike_thickness_height_and_material_with_gables() -> None:
    walls = [
        SOUTH,
        NORTH,
        WEST | {"ridge": 4.6},
        EAST | {"ridge": 4.6, "thickness": 0.7},
        INNER | {"height": 2.5, "material": "oak"},
    ]
    building = generators.house(**BOND, walls=walls, materials=TWO)
    stones, _ = laid(building)
    assert {panel.name: panel.thickness for panel in building.panels}["east"] == 0.7
    gable = 5 * (3.0 + 4.6) / 2
    long = (6 - 0.5 - 0.7) * 0.5 * 3.0
    assert volume_of(stones) == pytest.approx(gable * (0.5 + 0.7) + 2 * long + 4 * 0.3 * 2.5, rel=1e-9)
    assert set(stones.material[stones.panel == "inner"]) == {"oak"}
    free = stones.points[np.repeat(~stones.fixed, np.diff(stones.block_point_ptr))]
    # Lines are outer faces: with a thicker wall the house is as large as it was.
    np.testing.assert_allclose(np.ptp(free, axis=0), [6.0, 5.0, 4.6], atol=1e-9)


def test_a_bond_and_a_junction_of_its_own() -> None:
    given = {"bonds": [{"wall": "inner", "pattern": "stack"}], "junctions": [{"walls": ["south", "inner"]}]}
    building = house(INNER, **given)
    assert {panel.name: panel.regions[0].pattern for panel in building.panels}["inner"] == "stack"
    stones, contacts = laid(building)
    pair = np.sort(stones.panel[contacts.blocks], axis=1) == ["inner", "south"]
    # A butt joint: no stone of the inner wall reaches into the facade.
    assert stones.butts[contacts.blocks[pair.all(axis=1)]].any(axis=1).all()


@pytest.mark.parametrize(
    "number", [1, pytest.param(3, marks=pytest.mark.slow("docs/house.md: random houses, sound, and one building in both models"))]
)
@pytest.mark.parametrize("joints", ["bay", pytest.param("grid", marks=pytest.mark.slow)])
def test_random_houses_are_sound_and_match(joints: str, number: int) -> None:
    rng = np.random.default_rng(list(joints.encode()))
    count = 0
    while count < number:
        width, depth = rng.uniform(7, 11), rng.uniform(6, 9)
        at, spine = rng.uniform(3, width - 3), rng.uniform(2.5, depth - 2.5)
        thick = {"thickness": float(rng.uniform(0.3, 0.7))}
        walls = [
            {"name": "south", "start": (0, 0), "end": (width, 0), "toward": "+y"} | thick,
            {"name": "north", "start": (0, depth), "end": (width, depth), "toward": "-y"},
            {"name": "west", "start": (0, 0), "end": (0, depth), "toward": "+x", "ridge": 7.0},
            {"name": "east", "start": (width, 0), "end": (width, depth), "toward": "-x", "ridge": 7.0} | thick,
            {"name": "spine", "start": (0, spine), "end": (at, spine), "thickness": 0.3},
            {"name": "cross", "start": (at, 0), "end": (at, depth), "thickness": 0.4, "height": 4.0},
        ]
        windows = {"centre": [rng.uniform(1, 2), rng.uniform(width - 2, width - 1)], "width": rng.uniform(0.7, 1.1)}
        openings = [
            {"name": "w", "wall": ["south", "north"], "sill": [0.75, 3.25], "height": 1.25} | windows,
            {"name": "d", "wall": "spine", "centre": at / 2, "width": 0.9, "height": 2.0},
        ]
        try:
            building = generators.house(**BOND | {"height": 5.5}, walls=walls, openings=openings, joints=joints)
            cp.derive_blocks(building)
        except InputError:
            continue  # Named, as a joint or window that leaves a sliver is.
        stones, contacts = laid(building)
        match = cp.match_models(stones, contacts, cp.derive_shell(building, 1.0))
        assert match.passed, [figure for figure in match.figures if not figure.passed]
        count += 1


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"walls": []}, r"house\.walls: no walls"),
        ({"walls": [{"name": "a", "start": (0, 0)}]}, r"house\.walls\.0\.end: missing"),
        ({"walls": [SOUTH, SOUTH]}, r"house\.walls\.1\.name: two walls of one name; found south"),
        (
            {"walls": [SOUTH | {"end": (6, 1)}]},
            r"wall south: end: neither along x nor along y; found from \(0, 0\) to \(6, 1\) m",
        ),
        ({"walls": [SOUTH | {"end": (0, 0)}]}, r"wall south: end: no length"),
        ({"walls": [SOUTH | {"end": (6, 0, 0)}]}, r"wall south: end: no place in plan"),
        ({"walls": [SOUTH | {"toward": "-x"}]}, r'wall south: toward: along the wall, .* x; found -x; expected "\+y" or "-y"'),
        ({"walls": [SOUTH | {"thickness": 0}]}, r"wall south: thickness: out of range"),
        ({"walls": [SOUTH | {"height": 3.1}]}, r"wall south: height: not a whole number of courses"),
        ({"height": 3.1}, r"house\.height: not a whole number of courses; found 3\.1 m, 12\.4 courses"),
        ({"walls": [*ROOM, INNER | {"ridge": 3.0}]}, r"wall inner: ridge: not above the eaves; found 3 m; expected > 3 m"),
        (
            {"walls": [*ROOM, INNER | {"start": (3.5, 0.6)}]},
            r"wall inner: end: all but meets the wall south; found 0\.1 m; .* Let it end between 0 and 0\.5 m",
        ),
        (
            {"walls": [*ROOM, INNER | {"start": (3.5, -0.1)}]},
            r"wall inner: end: goes on beyond the wall south by less than a quarter of a stone; found 0\.1 m",
        ),
        (
            {"walls": [*ROOM, INNER | {"end": (3.5, 0.4)}]},
            r"wall inner: end: no longer than the wall south is thick; found 0\.4 m; expected > 0\.5 m",
        ),
        ({"walls": [*ROOM, SOUTH | {"name": "twin", "start": (1, 0.2), "end": (4, 0.2)}]}, r"south and twin: lie in one another"),
        (
            {"walls": [NORTH, INNER, SOUTH | {"end": (3.5, 0)}, SOUTH | {"name": "more", "start": (3.5, 0)}]},
            r"walls south and more: lie in one another; .* Give two walls in one line along x as one wall",
        ),
        (
            {"walls": [SOUTH | {"end": (3, 0)}, SOUTH | {"name": "more", "start": (3, 0)}]},
            r"walls south and more: meet end to end, without a bond",
        ),
        ({"openings": [DOOR | {"wall": "attic"}]}, r'house: opening door: no such wall; found "attic"; expected south, north'),
        ({"openings": [DOOR | {"wall": []}]}, r"opening door: wall: the opening is nowhere"),
        ({"openings": [DOOR | {"sill": []}]}, r"opening door: sill: the opening is nowhere"),
        ({"openings": [DOOR | {"sill": 0.1}]}, r"opening door: sill: not a whole number of courses"),
        ({"openings": [DOOR | {"height": 2.1}]}, r"opening door: sill \+ height: not a whole number of courses; found 2\.1 m"),
        ({"openings": [DOOR | {"lintel_height": 0.2}]}, r"opening door: lintel_height: not a whole number of courses"),
        ({"openings": [DOOR | {"lintel_bearing": 0}]}, r"opening door: lintel_bearing: out of range"),
        (
            {"openings": [DOOR | {"lintel_material": "oak"}]},
            r"wall south: door-lintel\.material: unknown material; found oak; .* or add the material oak",
        ),
        ({"openings": [DOOR, DOOR | {"centre": 5.0}]}, r"openings\.1\.name: two openings of one name in a wall; found door"),
        ({"openings": [DOOR | {"height": None}]}, r"opening door: height: given or left out wrongly"),
        ({"openings": [DOOR | {"voussoirs": 7}]}, r"opening door: voussoirs: a flat head has a lintel and no voussoirs"),
        ({"openings": [ARCHED | {"lintel_height": 0.25}]}, r"opening door: lintel_height: an arch has voussoirs and no lintel"),
        ({"openings": [ARCHED | {"depth": None}]}, r"opening door: depth: missing"),
        ({"openings": [ARCHED | {"height": 0.2}]}, r"opening door: height: no higher than its arch; found 0\.2 m"),
        ({"openings": [ARCHED | {"rise": None}]}, r"opening door: rise: given or left out wrongly"),
        (
            {"openings": [DOOR | {"centre": 0.6}]},
            r"wall south: opening door: reaches beyond an end of its wall; .* with its lintel",
        ),
        ({"openings": [DOOR | {"height": 3.0}]}, r"wall south: opening door: reaches beyond the top .* with its lintel"),
        (
            {"openings": [DOOR | {"centre": 3.5}], "walls": [*ROOM, INNER]},
            r"wall south: opening door: reaches into the wall inner; found 2\.75 to 4\.25 m with its lintel; .* bearing shorter",
        ),
        (
            {"openings": [DOOR, DOOR | {"name": "other", "centre": 3.2}]},
            r"wall south: openings door and other: overlap with their lintels",
        ),
        ({"openings": [DOOR, ARCHED | {"name": "other", "centre": 2.5}]}, r"overlap with their lintel or voussoirs"),
        ({"bonds": [{"wall": "attic", "pattern": "stack"}]}, r'house: bonds: no such wall; found "attic"'),
        ({"junctions": [{"walls": ["south", "north"]}]}, r"junction of south and north: the walls do not meet"),
    ],
)
def test_what_does_not_fit_is_named(given: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        cp.derive_blocks(generators.house(**BOND | {"walls": ROOM} | given))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("end_m = [9.0, 0.0]", "end_m = [9.0, 1.0]", r"line \d+, source\.walls\.0: wall south: end: neither along x nor along y"),
        ('wall = "south"\ncentre', 'wall = "attic"\ncentre', r"line \d+, source\.openings\.0: house: opening door: no such wall"),
        (
            "start_m = [5.0, 0.0]",
            "start_m = [5.0, 0.6]",
            r"line \d+, source\.walls\.4: wall inner: end: all but meets the wall south",
        ),
        ("# height_m = 3.0", 'material = "brick"', r"line \d+, source\.walls\.4: wall inner\.material: unknown material"),
    ],
)
def test_a_case_names_the_line_of_the_wall_or_opening(old: str, new: str, said: str, tmp_path: Path) -> None:
    text = sample_case("house")
    assert old in text
    path = tmp_path / "case.toml"
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(InputError, match=said) as caught:
        cp.read_case(path).building()
    line = int(str(caught.value).split("line ")[1].split(",")[0])
    named = next(name for name in ("inner", "door", "south") if name in said)
    assert f'name = "{named}"' in text.splitlines()[line]


def test_a_house_keeps_its_outer_size_as_its_walls_grow() -> None:
    grown = house(thickness=0.7)
    assert [panel.thickness for panel in grown.panels] == [0.7] * 4
    stones = cp.derive_blocks(grown)
    free = stones.points[np.repeat(~stones.fixed, np.diff(stones.block_point_ptr))]
    np.testing.assert_allclose(np.ptp(free, axis=0), [6.0, 5.0, 3.0], atol=1e-9)
