"""Houses whose walls get thinner in upper storeys."""

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import churchpipe as cp
from churchpipe import generators
from churchpipe.errors import InputError
from churchpipe.resources import sample_case
from sound import laid

BOND: dict[str, Any] = {"course": 0.3, "stone_length": 0.75, "height": 6.0, "thickness": 0.6}
# Outer faces of 9 x 7 m.
SOUTH = {"name": "south", "start": (0, 0), "end": (9, 0), "toward": "+y"}
NORTH = {"name": "north", "start": (0, 7), "end": (9, 7), "toward": "-y"}
WEST = {"name": "west", "start": (0, 0), "end": (0, 7), "toward": "+x"}
EAST = {"name": "east", "start": (9, 0), "end": (9, 7), "toward": "-x"}
ROOM = [SOUTH, NORTH, WEST, EAST]
INNER = {"name": "inner", "start": (5, 0), "end": (5, 7), "thickness": 0.3}
DOOR = {"name": "door", "wall": "south", "centre": 2.0, "width": 1.2, "height": 2.1}
WINDOW = {"name": "window", "wall": ["south", "north"], "centre": [3.6, 7.0], "width": 0.9, "sill": [0.9, 3.9], "height": 1.2}
TWO = (cp.UnitWeight("default", 18e3), cp.UnitWeight("brick", 15e3))


def storeys(*given: tuple[float, float]) -> dict[str, Any]:
    return {"storeys": [{"above": above, "thickness": thickness} for above, thickness in given]}


def house(walls: list[dict[str, Any]], **given: Any) -> cp.Building:
    return generators.house(**BOND | {"walls": walls} | given)


def volumes(stones: cp.Assemblage) -> dict[str, float]:
    return {name: float(stones.volume[stones.panel == name].sum()) for name in np.unique(stones.panel[~stones.fixed]).tolist()}


def boxes_of(stones: cp.Assemblage) -> np.ndarray:
    """Return the corners of the box around each free stone, in the order of their places."""
    edges = (edge.reduceat(stones.points, stones.block_point_ptr[:-1]) for edge in (np.minimum, np.maximum))
    boxes = np.column_stack([*edges, stones.volume])[~stones.fixed].round(9)
    return boxes[np.lexsort(boxes.T)]


def ring(width: float, depth: float, thickness: float) -> float:
    return width * depth - (width - 2 * thickness) * (depth - 2 * thickness)


def test_with_toward_the_outer_face_stays_flush() -> None:
    building = house([wall | storeys((3.0, 0.45)) for wall in ROOM])
    stones, _ = laid(building)
    assert [panel.thickness for panel in building.panels] == [0.6, 0.45] * 4
    assert float(stones.volume[~stones.fixed].sum()) == pytest.approx(3.0 * (ring(9, 7, 0.6) + ring(9, 7, 0.45)), rel=1e-9)
    for name in ("south", "south storey 2"):
        points = stones.points[np.repeat(stones.panel == name, np.diff(stones.block_point_ptr))]
        lows, highs = points.min(axis=0), points.max(axis=0)
        thickness, z = (0.6, (0.0, 3.0)) if name == "south" else (0.45, (3.0, 6.0))
        np.testing.assert_allclose([lows, highs], [[0.0, 0.0, z[0]], [9.0, thickness, z[1]]], atol=1e-12)


def test_without_it_the_middle_stays() -> None:
    walls = [{key: value for key, value in wall.items() if key != "toward"} for wall in ROOM]
    building = house([*(wall | storeys((3.0, 0.45)) for wall in walls), INNER])
    stones, _ = laid(building)
    inner = 0.3 * (3.0 * (7 - 0.6) + 3.0 * (7 - 0.45))
    rings = 3.0 * (ring(9.6, 7.6, 0.6) + ring(9.45, 7.45, 0.45))
    assert float(stones.volume[~stones.fixed].sum()) == pytest.approx(rings + inner, rel=1e-9)
    # The inner wall keeps its thickness, and steps back with the walls that it ends at.
    panel = next(panel for panel in building.panels if panel.name == "inner")
    expected = [(-0.3, 0), (7.3, 0), (7.3, 3), (7.225, 3), (7.225, 6), (-0.225, 6), (-0.225, 3), (-0.3, 3)]
    np.testing.assert_allclose(panel.outline, expected, atol=1e-12)


def test_a_storey_as_thick_as_the_one_below_changes_no_stone() -> None:
    openings = [DOOR, WINDOW]
    walls = [SOUTH, NORTH, WEST | {"ridge": 8.1}, EAST, INNER]
    plain, contacts = laid(house(walls, openings=openings))
    thick = [wall | storeys((3.0, wall.get("thickness", 0.6))) for wall in walls]
    stones, joints = laid(house(thick, openings=openings))
    np.testing.assert_allclose(boxes_of(stones), boxes_of(plain), atol=1e-9)
    assert joints.area.sum() == pytest.approx(contacts.area.sum(), rel=1e-9)


def test_bed_joints_between_storeys_have_the_area_that_they_share() -> None:
    stones, contacts = laid(house([wall | storeys((3.0, 0.45)) for wall in ROOM]))
    pair = np.sort(np.char.count(stones.panel[contacts.blocks], "storey"), axis=1)
    between = (pair == [0, 1]).all(axis=1)
    np.testing.assert_allclose(np.abs(contacts.frame[between, 0, 2]), 1.0, atol=1e-12)
    assert contacts.area[between].sum() == pytest.approx(ring(9, 7, 0.45), rel=1e-9)


@pytest.mark.parametrize("joints", ["bay", "grid"])
def test_corners_and_junctions_are_toothed_on_every_storey(joints: str) -> None:
    walls = [wall | storeys((3.0, 0.45)) for wall in ROOM]
    stones, _ = laid(house([*walls, INNER | storeys((3.0, 0.2))], joints=joints))
    low = np.minimum.reduceat(stones.points, stones.block_point_ptr[:-1])
    high = np.maximum.reduceat(stones.points, stones.block_point_ptr[:-1])
    for first, second, place in (("south", "west", (0.21, 0.21)), ("north", "east", (8.8, 6.8)), ("south", "inner", (5.0, 0.21))):
        across = ~stones.fixed & (low[:, :2] < place).all(axis=1) & (high[:, :2] > place).all(axis=1)
        found = [set(stones.panel[across & (stones.course == course)].tolist()) for course in range(20)]
        assert found == [{first}, {second}] * 5 + [{f"{first} storey 2"}, {f"{second} storey 2"}] * 5
        # Stones reach beyond the corner, into the wall that they belong to; multiples of a stone may end at it.
        assert joints == "grid" or (np.ptp(np.stack([low, high]), axis=0)[across, :2].max(axis=1) > 0.6).all()


def test_storeys_of_unlike_heights_where_walls_meet() -> None:
    walls = [SOUTH | storeys((3.0, 0.45)), NORTH | storeys((2.4, 0.5), (4.5, 0.3)), WEST | storeys((3.6, 0.4)), EAST]
    stones, _ = laid(house([*walls, INNER | {"height": 4.5} | storeys((3.3, 0.2))]))
    thickness = [((0.0, 3.0, 0.6), (3.0, 6.0, 0.45)), ((0.0, 2.4, 0.6), (2.4, 4.5, 0.5), (4.5, 6.0, 0.3))]
    thickness += [((0.0, 3.6, 0.6), (3.6, 6.0, 0.4)), ((0.0, 6.0, 0.6),), ((0.0, 3.3, 0.3), (3.3, 4.5, 0.2))]
    levels = sorted({0.0, *(top for wall in thickness for _, top, _ in wall)})
    expected = 0.0
    for low, high in pairwise(levels):
        south, north, west, east, inner = (
            next((thick for foot, top, thick in wall if foot <= low < top), 0.0) for wall in thickness
        )
        clear = 7 - south - north
        expected += (high - low) * (9 * 7 - (9 - west - east) * clear + inner * clear)
    assert float(stones.volume[~stones.fixed].sum()) == pytest.approx(expected, rel=1e-9)


def test_openings_gables_and_materials_of_each_storey() -> None:
    walls = [
        SOUTH | {"storeys": [{"above": 3.0, "thickness": 0.45, "material": "brick"}]},
        NORTH | storeys((3.0, 0.45)),
        WEST | {"ridge": 8.1} | storeys((3.0, 0.45)),
        EAST | {"ridge": 8.1} | storeys((3.0, 0.45)),
    ]
    arch = {"name": "arch", "wall": "west", "centre": 3.5, "width": 1.2, "sill": 3.3, "height": 1.8}
    arch |= {"shape": "segmental", "rise": 0.2, "voussoirs": 7, "depth": 0.3}
    building = house(walls, openings=[DOOR, WINDOW, arch], materials=TWO)
    stones, _ = laid(building)
    found = {panel.name: sorted(opening.name for opening in panel.openings) for panel in building.panels}
    assert found["south"] == ["door", "window-1-1", "window-1-2"]
    assert found["south storey 2"] == ["window-2-1", "window-2-2"]
    assert (found["west"], found["west storey 2"]) == ([], ["arch"])
    assert set(stones.material[stones.panel == "south storey 2"]) == {"brick"}
    assert set(stones.material[stones.panel != "south storey 2"]) == {"default"}
    (below, above) = (panel for panel in building.panels if panel.name.startswith("west"))
    assert (below.outline[:, 1].max(), above.outline[:, 1].min(), above.outline[:, 1].max()) == (3.0, 3.0, 8.1)


def test_bonds_and_junctions_hold_for_all_storeys() -> None:
    walls = [*(wall | storeys((3.0, 0.45)) for wall in ROOM), INNER]
    bonds = [{"wall": "south", "pattern": "stack"}, {"wall": "north storey 2", "pattern": "stack"}]
    building = house(walls, bonds=bonds, junctions=[{"walls": ["south", "inner"]}, {"walls": ["west", "south storey 2"]}])
    stacked = {panel.name for panel in building.panels if panel.regions[0].pattern == "stack"}
    assert stacked == {"south", "south storey 2", "north storey 2"}
    assert {junction.walls for junction in building.junctions} == {
        ("south", "inner"),
        ("south storey 2", "inner"),
        ("west storey 2", "south storey 2"),
    }
    stones, contacts = laid(building)
    joined = stones.panel[contacts.blocks]
    for wall in ("south", "south storey 2"):
        pair = (np.sort(joined, axis=1) == sorted((wall, "inner"))).all(axis=1) & (np.abs(contacts.frame[:, 0, 2]) < 0.5)
        assert stones.butts[contacts.blocks[pair]].any(axis=1).all()


@pytest.mark.parametrize("number", [1, pytest.param(4, marks=pytest.mark.slow("docs/house.md: random houses, their volume"))])
@pytest.mark.parametrize("joints", ["bay", "grid"])
def test_random_houses_have_the_volume_of_their_walls(joints: str, number: int) -> None:
    rng = np.random.default_rng(list(joints.encode()))
    count = 0
    while count < number:
        width, depth, at = rng.uniform(7, 11), rng.uniform(6, 9), rng.uniform(3, 4)
        flush = rng.random() < 0.5

        def wall(name: str, start: Any, end: Any, toward: str, flush: bool = flush) -> dict[str, Any]:
            thick, above = rng.uniform(0.4, 0.7), float(rng.integers(8, 12)) * 0.3
            given = {"name": name, "start": start, "end": end, "thickness": thick}
            return given | storeys((above, 0.8 * thick)) | ({"toward": toward} if flush else {})

        walls = [
            wall("south", (0, 0), (width, 0), "+y"),
            wall("north", (0, depth), (width, depth), "-y"),
            wall("west", (0, 0), (0, depth), "+x") | {"ridge": 7.5},
            wall("east", (width, 0), (width, depth), "-x") | {"ridge": 7.5},
            wall("cross", (at, 0), (at, depth), "+x"),
        ]
        window = {"name": "w", "wall": ["south", "north"], "centre": width - 2, "width": 0.9, "sill": [0.6, 4.2], "height": 1.2}
        try:
            building = house(walls, openings=[window], joints=joints)
            cp.derive_blocks(building)
        except InputError as error:
            if "sliver" in error.problem or "narrower than a quarter" in error.problem:
                continue  # Named, as a window that leaves one beside a corner is.
            raise
        laid(building)
        count += 1


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (storeys((6.0, 0.45)), r"wall south: storeys\.0\.above: not within its wall; found 6 m; expected > 0 m and < 6 m"),
        (storeys((6.6, 0.45)), r"wall south: storeys\.0\.above: not within its wall; found 6\.6 m"),
        (storeys((3.0, 0.45), (3.0, 0.3)), r"wall south: storeys\.1\.above: not above the storey below; .* expected > 3 m"),
        (storeys((0.0, 0.45)), r"above: out of range"),
        (
            storeys((3.0, 0.7)),
            r"wall south: storeys\.0\.thickness: thicker than what .*; found 0\.7 m above 3 m; .* 0\.6 m",
        ),
        (storeys((3.0, 0.4), (4.5, 0.5)), r"wall south: storeys\.1\.thickness: thicker than what it stands on; .* corbels"),
        (storeys((3.0, 0.0)), r"thickness: out of range"),
        (storeys((3.1, 0.45)), r"wall south: storeys\.0\.above: not a whole number of courses; found 3\.1 m.* expected 3 m"),
        ({"storeys": [{"above": 3.0}]}, r"wall south: storeys\.0\.thickness: missing"),
        ({"storeys": [{"from": 3.0}]}, r"wall south: storeys\.0\.from: unknown key; expected above, thickness, material"),
        ({"storeys": 3.0}, r"wall south: storeys: not a list"),
        (
            {"storeys": [{"above": 3.0, "thickness": 0.45, "material": "tuff"}]},
            r"wall south storey 2\.material: unknown material; found tuff",
        ),
    ],
)
def test_storeys_that_cannot_be_are_named(given: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        house([SOUTH | given, NORTH, WEST, EAST])


def test_an_opening_may_touch_a_storey_and_not_cross_it() -> None:
    walls = [SOUTH | storeys((3.0, 0.45)), NORTH, WEST, EAST]
    laid(house(walls, openings=[DOOR | {"height": 2.7}, DOOR | {"name": "above", "sill": 3.0}]))
    said = (
        r"wall south: opening door: reaches across 3 m, where a storey of the wall begins; "
        r"found z = 1.2 to 3\.6 m with its lintel; expected at most 3 m, or from there on"
    )
    with pytest.raises(InputError, match=said):
        house(walls, openings=[DOOR | {"sill": 1.2}])
    # A wall of one thickness has its opening beside walls that get thinner there.
    laid(
        house(
            [*walls, INNER],
            openings=[{"name": "stair", "wall": "inner", "centre": 3.5, "width": 0.9, "sill": 1.5, "height": 3.0}],
        )
    )


def test_a_wall_may_not_be_called_as_a_storey_is() -> None:
    with pytest.raises(InputError, match=r"house\.walls\.4\.name: two walls of one name; found south storey 2"):
        house([SOUTH | storeys((3.0, 0.45)), NORTH, WEST, EAST, INNER | {"name": "south storey 2"}])


def test_a_case_has_storeys_and_names_the_line_of_one_that_cannot_be(tmp_path: Path) -> None:
    text = sample_case("house").replace('toward = "+y"', 'toward = "+y"\nstoreys = [{ above_m = 3.0, thickness_m = 0.35 }]', 1)
    path = tmp_path / "case.toml"
    path.write_text(text, encoding="utf-8")
    case = cp.read_case(path)
    building = case.building()
    assert not case.loose_ends()
    assert {panel.name: panel.thickness for panel in building.panels}["south storey 2"] == 0.35
    assert "south storey 2" in building.macro_elements
    path.write_text(text.replace("above_m = 3.0", "above_m = 3.1"), encoding="utf-8")
    with pytest.raises(
        InputError, match=r"line \d+, source\.walls\.0: wall south: storeys\.0\.above: not a whole number of courses"
    ):
        cp.read_case(path).building()
