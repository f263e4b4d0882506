"""Soil against a wall presses on the free ends of its buttresses as well: the wall bears as much as one without them."""

from pathlib import Path

import numpy as np
import pytest

import churchpipe as cp
from churchpipe import generators, stages
from churchpipe.cli.cases import check_case
from churchpipe.configuring import configure
from churchpipe.errors import InputError
from churchpipe.loading.ends import unpressed_ends
from churchpipe.loading.wrenches import resultant
from churchpipe.model.placed_loads import Applied
from churchpipe.report.applied import load_rows
from churchpipe.run_folder import read_run
from solids import box

LENGTH, THICK, COURSE = 5.0, 0.5, 0.3
MATERIALS = [cp.Material("default", 19e3, 0.6)]
SOIL, TOP, SHARE, MORE = 18e3, 2.1, 1 / 3, 4e3


def building(*buttresses: cp.Buttress) -> cp.Building:
    """A wall of 5 x 2.4 m along x, .5 m thick."""
    wall = generators.wall(length=LENGTH, brick=(0.5, THICK, COURSE), courses=8, materials=MATERIALS)
    return generators.with_buttresses(wall, buttresses)


def buttress(toward: str = "+y", height: float | None = None, *, bonded: bool = True, along: float = 2.0) -> cp.Buttress:
    return cp.Buttress("wall", along=(along,), toward=toward, width=0.5, depth=0.6, height=height, bonded=bonded)


def soil(toward: str = "-y", ends: list[str] | None = None) -> cp.Pressure:
    return cp.Pressure("wall", toward=toward, unit_weight=SOIL, top=TOP, coefficient=SHARE, surcharge=MORE, ends=ends)


def by_hand(sign: float) -> np.ndarray:
    """Force and moment about the origin of the pressure on all of the wall: a triangle and a rectangle over its depth."""
    triangle, rectangle = SHARE * SOIL * TOP**2 / 2 * LENGTH, SHARE * MORE * TOP * LENGTH
    force, about_foot = triangle + rectangle, triangle * TOP / 3 + rectangle * TOP / 2
    return np.array([0, sign * force, 0, -sign * about_foot, 0, sign * force * LENGTH / 2])


def total(stones: cp.Assemblage, load: cp.Pressure) -> np.ndarray:
    carried = cp.loaded(cp.LoadCase((0, 1, 0)), stones, [load]).dead
    assert carried is not None
    return resultant(stones.centroid, carried)


@pytest.mark.parametrize("bonded", [True, False])
@pytest.mark.parametrize("height", [None, 1.2])
@pytest.mark.parametrize(("side", "sign"), [("+y", -1.0), ("-y", 1.0)])
def test_a_wall_with_a_buttress_in_the_soil_bears_all_of_it(side: str, sign: float, height: float | None, bonded: bool) -> None:
    stones = cp.derive_blocks(building(buttress(side, height, bonded=bonded)))
    toward = {"+y": "-y", "-y": "+y"}[side]
    assert total(stones, soil(toward)) == pytest.approx(by_hand(sign), rel=1e-9, abs=1e-5)
    plain = cp.derive_blocks(building())
    assert total(stones, soil(toward)) == pytest.approx(total(plain, soil(toward)), rel=1e-9, abs=1e-5)
    placed = cp.place_loads(stones, [soil(toward)])
    deep = TOP if height is None else height
    end = SHARE * (SOIL * (TOP * deep - deep**2 / 2) + MORE * deep) * 0.5
    outside = np.abs(placed.point[:, 1] - THICK / 2) > THICK / 2 + 0.5
    assert np.abs(placed.dead[outside, 1]).sum() == pytest.approx(end, rel=1e-9)
    assert set(placed.wall[outside]) == {"wall buttress 1"}


@pytest.mark.parametrize("bonded", [True, False])
def test_a_buttress_on_the_other_side_changes_nothing(bonded: bool) -> None:
    stones = cp.derive_blocks(building(buttress("-y", bonded=bonded)))
    assert total(stones, soil("-y")) == pytest.approx(by_hand(-1.0), rel=1e-9, abs=1e-5)
    placed = cp.place_loads(stones, [soil("-y")])
    face = cp.place_loads(cp.derive_blocks(building()), [soil("-y")]).point[0, 1]
    np.testing.assert_allclose(placed.point[:, 1], face, atol=1e-9)


@pytest.mark.parametrize("bonded", [True, False])
def test_the_shell_bears_what_the_stones_do(bonded: bool) -> None:
    with_one = building(buttress(bonded=bonded))
    stones, shell = cp.derive_blocks(with_one), cp.derive_shell(with_one, 0.25)
    carried = cp.shell_loaded(cp.LoadCase((0, 1, 0)), shell, stones, [soil()]).dead
    assert carried is not None
    on_shell = resultant(shell.body_centroid, carried)
    assert on_shell == pytest.approx(total(stones, soil()), rel=1e-9, abs=1e-5)
    on_buttress = np.flatnonzero(shell.panel == "wall buttress 1")
    end = SHARE * (SOIL * TOP**2 / 2 + MORE * TOP) * 0.5
    assert -carried[on_buttress, 1].sum() >= end * (1 - 1e-9)


def test_a_buttress_that_steps_back_bears_the_soil_once() -> None:
    # Two courses .8 m deep below two .4 m deep, each of two stones, one behind the other.
    parts = [box((0.0, 3.0), (0.0, 0.5), (0.3 * k, 0.3 * k + 0.3)) for k in range(4)]
    for course, deep in enumerate((0.8, 0.8, 0.4, 0.4)):
        level = (0.3 * course, 0.3 * course + 0.3)
        parts += [box((1.0, 1.5), (0.5, 0.5 + deep / 2), level), box((1.0, 1.5), (0.5 + deep / 2, 0.5 + deep), level)]
    ground = box((-1.0, 4.0), (-1.0, 3.0), (-0.5, 0.0))
    panel = ["", *["wall"] * 4, *["wall buttress 1"] * 8]
    stones = cp.Assemblage.from_polyhedra([ground, *parts], 19e3, fixed=[0], panel=panel)
    placed = cp.place_loads(stones, [cp.Pressure("wall", toward="-y", unit_weight=10e3, top=1.2)])
    assert placed.dead[:, 1].sum() == pytest.approx(-10e3 * 1.2**2 / 2 * 3.0, rel=1e-9)


def room(*more: tuple[str, tuple[np.ndarray, list[list[int]]]]) -> cp.Assemblage:
    """A wall of 4 m with a wall "cross" of 2 m square to it on the side +y, and more."""
    solids = [("wall", box((0.0, 4.0), (0.0, 0.4), (0.0, 1.8))), ("cross", box((1.5, 2.0), (0.4, 2.4), (0.0, 1.8))), *more]
    ground = box((-1.0, 5.0), (-1.0, 4.0), (-0.5, 0.0))
    names = [name for name, _ in solids]
    return cp.Assemblage.from_polyhedra([ground, *(solid for _, solid in solids)], 19e3, fixed=[0], panel=["", *names])


def test_a_wall_that_is_named_bears_soil_on_its_end() -> None:
    water = cp.Pressure("wall", toward="-y", unit_weight=10e3, top=1.8, ends=["cross"])
    placed = cp.place_loads(room(), [water])
    assert placed.dead[:, 1].sum() == pytest.approx(-10e3 * 1.8**2 / 2 * 4.0, rel=1e-9)
    assert placed.dead[placed.wall == "cross", 1].sum() == pytest.approx(-10e3 * 1.8**2 / 2 * 0.5, rel=1e-9)
    assert unpressed_ends(room(), water) == []


def test_no_end_bears_soil_where_the_case_says_so() -> None:
    stones = cp.derive_blocks(building(buttress()))
    assert total(stones, soil(ends=[]))[1] == pytest.approx(by_hand(-1.0)[1] * 4.5 / 5, rel=1e-9)


def test_a_wall_whose_end_bears_nothing_is_asked_about() -> None:
    water = cp.Pressure("wall", toward="-y", unit_weight=10e3, top=1.8)
    [asked] = unpressed_ends(room(), water)
    assert asked == (
        "Pressure wall acts on the face of the wall wall that looks to +y, and not on the far end of cross, which stands in what "
        'presses: its width bears nothing. Is it meant? ends = ["cross"] makes it press there, too, and ends = [] says that it '
        "does not."
    )
    with pytest.warns(cp.DoubtfulValue, match="and not on the far end of cross"):
        cp.place_loads(room(), [water])
    assert unpressed_ends(room(), cp.Pressure("wall", toward="-y", unit_weight=10e3, top=1.8, ends=[])) == []
    # On the other side nothing stands, a beam on top closes nothing, and a wall across the far end closes a room.
    assert unpressed_ends(room(), cp.Pressure("wall", toward="+y", unit_weight=10e3, top=1.8)) == []
    assert unpressed_ends(room(("beam", box((1.5, 2.0), (0.0, 2.4), (1.8, 2.0)))), water) == [asked]
    assert unpressed_ends(room(("far", box((0.0, 4.0), (2.4, 2.8), (0.0, 1.8)))), water) == []
    assert unpressed_ends(cp.derive_blocks(building(buttress())), soil()) == []
    box_of_walls = generators.box(length=2.4, width=2.0, courses=4, brick=(0.4, 0.2, 0.3), materials=MATERIALS)
    for wall, toward in (("west", "-x"), ("west", "+x"), ("south", "-y"), ("south", "+y")):
        pressed = cp.Pressure(wall, toward=toward, unit_weight=10e3, top=1.0)
        assert unpressed_ends(cp.derive_blocks(box_of_walls), pressed) == []


def test_a_wall_that_does_not_stand_in_the_soil_has_no_end_there() -> None:
    said = "pressure wall: ends: it does not stand against the face of the wall wall; found nave; expected cross"
    with pytest.raises(InputError, match=said):
        cp.place_loads(room(), [cp.Pressure("wall", toward="-y", unit_weight=10e3, top=1.8, ends=["nave"])])


PARTITIONS = """
name = "s"
[source]
generator = "prototype"
brick_mm = [400, 200, 300]
partitions_x_mm = [1200]
partition_length_mm = 1000
courses = 4
main_wall_length_mm = 2600
[material.default]
unit_weight_kN_m3 = 19
friction = 0.6
[[load]]
direction = [0, 1, 0]
[[pressures]]
name = "terrace"
wall = "main"
toward = [0, -1, 0]
unit_weight_kN_m3 = 18
coefficient = 0.33
top_m = 1.0
"""


def test_a_run_asks_about_walls_in_the_soil(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case = tmp_path / "case.toml"
    case.write_text(PARTITIONS)
    check_case(case, [])
    said = " ".join(capsys.readouterr().err.split())
    assert "Pressure terrace acts on the face of the wall main that looks to +y, and not on the far end of partition-1" in said
    out = tmp_path / "run"
    configure(case, out)
    geometry = out / "geometry" / "base"
    stages.source(geometry / "settings.json", geometry / "building.json")
    stages.blocks(geometry / "building.json", geometry / "assemblage.npz", geometry / "stones.dxf", geometry / "stones.vtu")
    stages.contacts(geometry / "tolerances.json", geometry / "assemblage.npz", geometry / "contacts.npz")
    [asked] = read_run(out / "plan.json").end_questions()
    assert asked.startswith("Pressure terrace acts on the face of the wall main")
    case.write_text(PARTITIONS + 'ends = ["partition-1"]\n')
    check_case(case, [])
    assert "terrace" not in capsys.readouterr().err


def test_the_report_says_on_which_faces_soil_presses() -> None:
    stones = cp.derive_blocks(building(buttress(bonded=False)))
    ((_, bears, *_),) = load_rows({"a": Applied(cp.place_loads(stones, [soil()]))})
    assert bears == "wall, wall buttress 1: faces that look to +y"
