"""Damage that a parser of drawings reads over: tags that contradict each other, and bytes that are no text."""

from collections.abc import Callable
from pathlib import Path

import ezdxf
import pytest

from churchpipe.dxf.reader import read_drawing
from churchpipe.findings import Findings, FindingsError
from mesh_files import fuzz_wall, write_dxf_outlines

START = b"  0\nLWPOLYLINE\n"


@pytest.fixture
def wall(tmp_path: Path) -> Path:
    """Return a drawing of a wall, each stone an outline."""
    return write_dxf_outlines(fuzz_wall(), tmp_path)


def change(path: Path, edit: Callable[[bytes], bytes]) -> None:
    data = path.read_bytes().replace(b"\r\n", b"\n")
    changed = edit(data)
    assert changed != data
    path.write_bytes(changed)


def findings_of(path: Path) -> Findings:
    try:
        return read_drawing(path, support="base").findings
    except FindingsError as error:
        return error.findings


def second(data: bytes, old: bytes, new: bytes) -> bytes:
    """Replace the second place of `old`."""
    first, middle, rest = data.split(old, 2)
    return first + old + middle + new + rest


def without_the_head(data: bytes) -> bytes:
    """Take out what lies between the marker of the second outline and the first corner of the third."""
    at = data.index(b"AcDbPolyline", data.index(START, data.index(START) + 1))
    third = data.index(b" 10\n", data.index(START, at))
    return data[:at] + b"AcDbPolyline\n" + data[third:]


@pytest.mark.parametrize(
    ("edit", "says"),
    [
        (lambda data: second(data, START, b"  7\nLWPOLYLINE\n"), "two entities run into each other"),
        (without_the_head, "it has 4 corners, and says that there are none"),
        (lambda data: second(data, b"\n 90\n4\n", b"\n 90\n5\n"), "it has 4 corners, and says that there are 5"),
    ],
    ids=["start", "head", "count"],
)
def test_an_outline_is_not_lost_in_the_one_before(wall: Path, edit: Callable[[bytes], bytes], says: str) -> None:
    change(wall, edit)
    findings = findings_of(wall)
    assert findings.errors[0].code == "E03"
    assert says in str(findings)


def test_a_boundary_is_not_lost_in_a_hatch(tmp_path: Path) -> None:
    document = ezdxf.new("R2010", units=6)
    hatch = document.modelspace().add_hatch()
    for x in (0, 2):
        hatch.paths.add_polyline_path([(x, 0), (x + 1, 0), (x + 1, 1), (x, 1)])
    document.saveas(tmp_path / "hatch.dxf")
    change(tmp_path / "hatch.dxf", lambda data: second(data, b"\n 92\n", b"\n  7\n"))
    assert "it has 1 boundaries, and says that there are 2" in str(findings_of(tmp_path / "hatch.dxf"))


def test_a_layout_without_a_name_is_a_finding(wall: Path) -> None:
    # The block record keeps its handle and loses its name.
    change(wall, lambda data: data.replace(b"  2\n*Paper_Space\n", b"  7\n*Paper_Space\n"))
    assert "E03" in findings_of(wall).codes


def test_bytes_that_are_no_text_are_read_as_western_european(wall: Path) -> None:
    change(wall, lambda data: data.replace(b"\nWALL\n", "\nSÜD\n".encode("cp1252")))
    findings = findings_of(wall)
    assert "W46" in findings.codes
    assert "SÜD (12)" in str(findings)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        (b" 11\n1.0\n 21\n0.0\n", b"", "it lacks a coordinate of a corner"),
        (b" 22\n0.5\n", b"", "it lacks a coordinate of a corner"),
        (b" 11\n1.0\n", b" 11\n1e400\n", "a coordinate of a corner is no number"),
    ],
)
def test_a_filled_area_that_lost_a_corner_is_no_smaller_stone(old: bytes, new: bytes, says: str, tmp_path: Path) -> None:
    document = ezdxf.new("R2010", units=6)
    document.modelspace().add_solid([(0, 0), (1, 0), (0, 0.5), (1, 0.5)], dxfattribs={"thickness": 0.25})
    document.saveas(tmp_path / "a.dxf")
    change(tmp_path / "a.dxf", lambda data: data.replace(old, new))
    assert says in str(findings_of(tmp_path / "a.dxf"))
    assert "E03" in findings_of(tmp_path / "a.dxf").codes
