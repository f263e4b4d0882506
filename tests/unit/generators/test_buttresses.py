"""Buttresses of walls: what they weigh, how they hold, and what is wrong with them.

Source: by moments a body turns over at (its weight x the distance of its centroid from the toe) / (its weight x its height).
"""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import churchpipe as cp
from churchpipe import generators
from churchpipe.errors import InputError
from sound import laid

T, H, L, W, D = 0.5, 3.0, 4.0, 0.5, 0.75
MATERIAL = cp.Material("default", 18e3, 0.6)


def wall(**changes: object) -> cp.Building:
    """A wall along x with two buttresses on its side towards +y."""
    built = generators.wall(length=L, brick=(1.0, T, 0.25), height=H, joints="bay", materials=(MATERIAL,))
    given = {"wall": "wall", "along": (1.0, 3.0), "toward": "+y", "width": W, "depth": D, **changes}
    return cp.with_buttresses(built, [cp.Buttress(**given)])


def load_factor(building: cp.Building, direction: tuple[float, float, float], *panels: str) -> float:
    """Of walls of one piece each, on a base without mortar, that butt without friction."""
    stones = cp.derive_blocks(building)
    contacts = cp.find_contacts(stones)
    dry = np.isin(contacts.kind, ("base", "butt"))
    friction = np.where(contacts.kind == "butt", 0.0, 5.0)
    state = cp.limit_analysis(stones, contacts, cp.LoadCase(direction, panels=panels or None), friction, np.where(dry, 0.0, 1e8))
    assert state.status == "optimal"
    return state.load_factor


@pytest.mark.parametrize("bonded", [True, False])
def test_they_are_laid_and_weigh_what_they_fill(bonded: bool) -> None:
    building = wall(bonded=bonded)
    stones, contacts = laid(building)
    assert building.macro_elements == ("wall", "wall buttress 1", "wall buttress 2")
    assert stones.volume[~stones.fixed].sum() == pytest.approx(L * T * H + 2 * W * D * H, rel=1e-9)
    own = stones.panel == "wall buttress 2"
    reach = stones.points[np.repeat(own, np.diff(stones.block_point_ptr))]
    assert reach[:, 0].min() == pytest.approx(3.0 - W / 2)
    assert reach[:, 1].max() == pytest.approx(T + D)
    assert ("butt" in contacts.kind) == (not bonded)
    match = cp.match_models(stones, contacts, cp.derive_shell(building, 0.25))
    assert match.passed, [figure.name for figure in match.figures if not figure.passed]


def test_a_bonded_buttress_pulls_with_the_wall_and_a_loose_one_only_pushes() -> None:
    walls, buttress = L * T * H, 2 * W * D * H
    every = (walls + buttress) * H / 2
    # Away from the buttresses the bonded wall lifts them, the other one leaves them where the load pushes it alone.
    assert load_factor(wall(), (0, -1, 0)) == pytest.approx((walls * T / 2 + buttress * (T + D / 2)) / every, rel=1e-5)
    assert load_factor(wall(bonded=False), (0, -1, 0), "wall") == pytest.approx(T / H, rel=1e-5)
    # Towards them the toe is theirs.
    toe = (walls * (D + T / 2) + buttress * D / 2) / every
    assert load_factor(wall(), (0, 1, 0)) == pytest.approx(toe, rel=1e-5)
    assert load_factor(wall(bonded=False), (0, 1, 0)) < toe


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"wall": "nave"}, "buttress of nave: no such wall; found nave; expected wall"),
        (
            {"along": (3.9,)},
            r"found 3.9 m; expected 0.25 to 3.75 m along the wall, counted from x = 0, y = [\d.]+ m towards \+x",
        ),
        ({"toward": "+x"}, r"buttress of wall: toward: it runs along the wall wall"),
        ({"toward": "up"}, "buttress of wall: toward: no side; found up"),
        ({"height": 2.9}, "buttress of wall: height: does not fit the wall; found 2.9 m; expected a whole number of courses"),
        ({"height": 3.25}, "buttress of wall: height: does not fit the wall"),
        ({"depth": 0.0}, "buttress of wall: depth"),
        ({"along": ()}, "buttress of wall: along: nowhere"),
    ],
)
def test_bad_buttresses(changes: dict[str, object], said: str) -> None:
    with pytest.raises(InputError, match=said):
        wall(**changes)


@pytest.mark.parametrize(
    ("along", "height", "stands"), [(0.75, 3.0, True), (1.2, 3.0, False), (2.0, 3.0, False), (2.0, 1.0, True)]
)
def test_a_buttress_stands_in_no_opening(along: float, height: float, stands: bool) -> None:
    window = {"start": 1.25, "width": 1.5, "height_courses": 4, "sill_courses": 4, "lintel_bearing": 0.25}
    built = generators.wall(length=L, brick=(1.0, T, 0.25), height=H, joints="bay", openings=(window,), materials=(MATERIAL,))
    buttress = cp.Buttress("wall", (along,), "+y", W, D, height)
    if stands:
        stones, _ = laid(cp.with_buttresses(built, [buttress]))
        assert stones.volume[~stones.fixed].sum() == pytest.approx(L * T * H - 1.5 * T + W * D * height, rel=1e-9)
    else:
        with pytest.raises(InputError, match=rf"buttress of wall: along: in the opening .* of the wall wall; found {along:g} m"):
            cp.with_buttresses(built, [buttress])


CASE = """
name = "propped"
[source]
generator = "wall"
length_m = 4.0
brick_mm = [1000, 500, 250]
courses = 12
[material.default]
unit_weight_kN_m3 = 18.0
friction = 0.6
[[load]]
direction = [0, 1, 0]
[[buttresses]]
wall = "wall"
along_m = [1.0, 3.0]
toward = "+y"
width_m = 0.5
depth_m = 0.75
bonded = false
"""


def test_buttresses_of_a_case(tmp_path: Path) -> None:
    path = tmp_path / "propped.toml"
    path.write_text(CASE)
    building = cp.read_case(path).building()
    assert building.macro_elements == ("wall", "wall buttress 1", "wall buttress 2")
    assert [junction.walls for junction in building.junctions] == [("wall", "wall buttress 1"), ("wall", "wall buttress 2")]
    for given, wrong, said in (
        ('wall = "wall"', 'wall = "nave"', "line 13, buttresses.0: buttress of nave: no such wall"),
        ("along_m = [1.0, 3.0]", "along_m = [9.0]", "line 13, buttresses.0: buttress of wall: along: beyond the wall"),
        (
            "along_m = [1.0, 3.0]",
            "along_m = [3.0, 1.0, 1.2]",
            r"line 13, \S+ buttress of wall: along: two in one place; found middles 0\.2 m",
        ),
        ("width_m = 0.5", "width_m = -0.5", "line 17, buttresses.0.width_m: wrong value"),
    ):
        path.write_text(CASE.replace(given, wrong))
        with pytest.raises(InputError, match=rf"propped\.toml: {said}"):
            cp.read_case(path).building()


def test_two_tables_of_buttresses_on_one_wall_have_names_of_their_own() -> None:
    other = {"wall": "wall", "along": (2.0,), "toward": "-y", "width": W, "depth": D}
    with pytest.raises(InputError, match=r"buttress of wall: name: not the only ones of their name; found wall buttress 1"):
        cp.with_buttresses(wall(), [cp.Buttress(**other)])
    named = cp.with_buttresses(wall(), [cp.Buttress(**other, name="south")])
    assert named.macro_elements[-1] == "south buttress 1"
    with pytest.raises(InputError, match=r"buttress of wall: width: wider than the wall wall; found 600 m; expected at most 4 m"):
        wall(width=600.0)


def test_a_buttress_that_stands_partly_in_a_crossing_wall_is_refused() -> None:
    size: dict[str, Any] = {"course": 0.5, "stone_length": 1.0, "width": 6.0, "length": 10.0, "height": 4.0, "thickness": 0.8}
    corner: dict[str, Any] = {"wall": "nave_left", "toward": "-x", "depth": 0.8}
    said = r"along: stands partly in the wall facade; found 0\.6 m; expected .* 0\.9 m from its middle or more"
    with pytest.raises(InputError, match=said):
        generators.with_buttresses(generators.chapel(**size), [cp.Buttress(along=(0.6,), width=1.0, **corner)])
    # In line with the facade, and as wide as it is thick, it lengthens it.
    assert (
        cp.derive_blocks(
            generators.with_buttresses(generators.chapel(**size), [cp.Buttress(along=(0.4,), width=0.8, **corner)])
        ).count
        > 1
    )


@pytest.mark.parametrize(("along", "width"), [(3.0, W), (3.4, W), (2.6, 0.4)])
def test_two_tables_of_buttresses_in_one_place_are_named_by_the_second(along: float, width: float, tmp_path: Path) -> None:
    table = (
        CASE.partition("[[buttresses]]")[2]
        .replace("[1.0, 3.0]", f"[2.0, {along}]")
        .replace("width_m = 0.5", f"width_m = {width}")
    )
    path = tmp_path / "propped.toml"
    path.write_text(f'{CASE}\n[[buttresses]]{table}name = "second"\n')
    said = (
        r"line 21, buttresses\.1: buttress of wall: along: stands where wall buttress 2 stands; "
        rf"found {along:g} m; expected a place clear of it, {(width + W) / 2:g} m from its middle or more"
    )
    with pytest.raises(InputError, match=said):
        cp.read_case(path).building()
    path.write_text(path.read_text().replace(f"[2.0, {along}]", "[2.0]"))
    assert "second buttress 1" in cp.read_case(path).building().macro_elements
