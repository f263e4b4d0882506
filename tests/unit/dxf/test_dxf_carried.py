"""Ties and line loads travel with a drawing, and what is wrong with theirs is a finding."""

from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
from ezdxf.math import Vec3

import churchpipe as cp
from churchpipe.config.case import read_case
from churchpipe.config.imported import imported_case
from churchpipe.config.shell_table import ShellTable
from churchpipe.dxf.carried import words
from churchpipe.dxf.reader import read_drawing
from churchpipe.dxf.reading import AS_DRAWN
from churchpipe.findings import FindingsError
from command_line import call
from solids import box

WALLS = {"west": box((0, 0.5), (0, 4), (0, 3)), "east": box((4, 4.5), (0, 4), (0, 3))}
PLATE = box((-9, 9), (-9, 9), (-1, 0))
STONES = cp.Assemblage.from_polyhedra([PLATE, *WALLS.values()], 2e4, [0], panel=["", *WALLS])
BARS = [
    cp.TieBar(
        "through", ("west", 2.0, 2.5), ("east", 2.0, 2.5), area=4e-4, steel_strength=235e6, plate=(0.3, 0.3), pretension=1e4
    ),
    cp.TieBar("between", (0.5, 1.0, 2.0), (4.0, 1.0, 2.0), area=1e-4, steel_strength=200e6, ultimate_strain=0.05),
]
LOADS = [
    cp.LineLoad("west", begin=0.5, end=3.5, dead=9e3, thrust=500.0, toward="-x", eccentricity=0.1, mass=4e3, name="roof"),
    cp.LineLoad(between=((4.25, 0.5, 3.0), (4.25, 3.5, 3.0)), dead=2e3),
]


def drawn(folder: Path, units: str = "m") -> Path:
    cp.write_dxf(STONES, folder / "walls.dxf", ties=BARS, line_loads=LOADS, units=units)
    return folder / "walls.dxf"


@pytest.mark.parametrize("units", ["m", "mm"])
def test_ties_and_line_loads_make_the_round_trip(tmp_path: Path, units: str) -> None:
    found = read_drawing(drawn(tmp_path, units), unit_weight=2e4)
    assert [words(bar) for bar in found.ties] == [words(bar) for bar in BARS]
    assert [words(load) for load in found.line_loads] == [words(load) for load in LOADS]
    ours, theirs = cp.place_ties(STONES, BARS), cp.place_ties(found.stones, found.ties)
    assert [tie.strength for tie in theirs] == pytest.approx([tie.strength for tie in ours], rel=1e-12)
    placed = [cp.place_loads(stones, loads) for stones, loads in ((STONES, LOADS), (found.stones, found.line_loads))]
    np.testing.assert_allclose(placed[1].dead, placed[0].dead, rtol=1e-12)
    np.testing.assert_allclose(placed[1].point, placed[0].point, atol=1e-12)


def test_a_line_that_is_moved_moves_its_tie(tmp_path: Path) -> None:
    document = ezdxf.readfile(drawn(tmp_path))
    inserts: Any = document.modelspace().query("INSERT[layer=='CP-TIES']")
    insert = next(one for one in inserts if one.get_attrib_text("NAME") == "between")
    insert.dxf.insert = insert.dxf.insert + Vec3(0, 0.5, 0)
    document.saveas(tmp_path / "moved.dxf")
    moved = read_drawing(tmp_path / "moved.dxf", unit_weight=2e4).ties[1]
    assert moved.start.at == pytest.approx((0.5, 1.5, 2.0))
    assert moved.end.at == pytest.approx((4.0, 1.5, 2.0))


def test_each_member_of_an_array_is_a_tie(tmp_path: Path) -> None:
    document = ezdxf.readfile(drawn(tmp_path))
    inserts: Any = document.modelspace().query("INSERT[layer=='CP-TIES']")
    insert = next(one for one in inserts if one.get_attrib_text("NAME") == "between")
    insert.dxf.row_count, insert.dxf.row_spacing = 3, 0.5
    document.saveas(tmp_path / "array.dxf")
    ties = read_drawing(tmp_path / "array.dxf", unit_weight=2e4).ties[1:]
    assert [tie.name for tie in ties] == ["between[0]", "between[1]", "between[2]"]
    assert [tie.start.at for tie in ties] == [pytest.approx((0.5, y, 2.0)) for y in (1.0, 1.5, 2.0)]
    assert [tie.end.at for tie in ties] == [pytest.approx((4.0, y, 2.0)) for y in (1.0, 1.5, 2.0)]


def test_a_line_turns_with_its_insert_and_its_direction_does_not(tmp_path: Path) -> None:
    document = ezdxf.readfile(drawn(tmp_path))
    inserts: Any = document.modelspace().query("INSERT[layer=='CP-LOADS']")
    between = next(one for one in inserts if one.get_attrib_text("NAME") != "roof")
    between.add_attrib("THRUST_KN_M", "1")
    between.add_attrib("TOWARD", "[1, 0, 0]")
    between.rotate_z(np.pi / 2)
    document.saveas(tmp_path / "turned.dxf")
    (_, turned) = read_drawing(tmp_path / "turned.dxf", unit_weight=2e4).line_loads
    np.testing.assert_allclose(np.array(turned.between), [(-0.5, 4.25, 3.0), (-3.5, 4.25, 3.0)], atol=1e-12)
    assert np.asarray(turned.toward).tolist() == [1, 0, 0]


@pytest.mark.parametrize(
    ("layer", "tag", "text", "said"),
    [
        ("CP-TIES", "AREA_MM2", "four", "attribute AREA_MM2 = 'four' is no number"),
        ("CP-TIES", "AREA_MM2", "-4", "attribute AREA_MM2 = '-4': out of range; expected > 0 mm2"),
        ("CP-TIES", "PLATE_MM", "[300, 0]", "attribute PLATE_MM = '[300, 0]': out of range; expected > 0 mm"),
        ("CP-TIES", "START", '{"wall": "west"}', "no place"),
        ("CP-LOADS", "DEAD_KN_M", "Infinity", "attribute DEAD_KN_M = 'Infinity' is no number"),
        ("CP-LOADS", "TOWARD", "[0, 0, 0]", "toward"),
    ],
)
def test_what_is_wrong_with_an_attribute_is_a_finding(tmp_path: Path, layer: str, tag: str, text: str, said: str) -> None:
    document = ezdxf.readfile(drawn(tmp_path))
    insert: Any = document.modelspace().query(f"INSERT[layer=='{layer}']")[0]
    insert.get_attrib(tag).dxf.text = text
    document.saveas(tmp_path / "wrong.dxf")
    with pytest.raises(FindingsError) as caught:
        read_drawing(tmp_path / "wrong.dxf", unit_weight=2e4)
    (error,) = caught.value.findings.errors
    assert error.code == "E07"
    assert said in str(error)


def test_an_imported_case_has_the_ties_and_loads_of_its_drawing(tmp_path: Path) -> None:
    drawing = read_drawing(drawn(tmp_path), unit_weight=2e4)
    text, _ = imported_case(
        tmp_path / "walls.dxf",
        drawing,
        AS_DRAWN,
        unit_weight=2e4,
        friction=0.6,
        loads=[cp.LoadCase((1, 0, 0))],
        tolerances={},
        shell=ShellTable({}, ""),
    )
    (tmp_path / "case.toml").write_text(text)
    carries = read_case(tmp_path / "case.toml").carries
    assert [words(bar) for bar in carries.ties] == [words(bar) for bar in BARS]
    assert [words(load) for load in carries.line_loads] == [words(load) for load in LOADS]


@pytest.mark.parametrize(("wall", "stands"), [("west", True), ("nave", False)])
def test_an_import_tells_of_a_drawn_load_on_a_wall_that_is_not_there(
    wall: str, stands: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    document = ezdxf.readfile(drawn(tmp_path))
    inserts: Any = document.modelspace().query("INSERT[layer=='CP-LOADS']")
    next(one for one in inserts if one.get_attrib_text("NAME") == "roof").get_attrib("WALL").dxf.text = wall
    document.saveas(tmp_path / "other.dxf")
    options = ["--unit-weight-kN-m3", "20", "--friction", "0.6", "--load=+y"]
    code, _, told = call(capsys, "import", tmp_path / "other.dxf", "-o", tmp_path / "made", *options)
    assert code == 0
    assert ("To be corrected first: " in told and "no such wall; found nave; expected east, west" in told) != stands
