"""Stones that are drawn a little too large: what lies in two of them counts twice in their weight, and a finding says so."""

from pathlib import Path

import ezdxf
import pytest
import shapely

import churchpipe as cp
from churchpipe.dxf.reading import Reading
from churchpipe.importing import check_drawing, import_drawing
from churchpipe.stones.account import joint_account, joint_lines
from churchpipe.stones.counted_twice import counted_twice, shared_volumes
from solids import box

THICK, WEIGHT = 0.3, 18e3


def outlines(grown: float) -> list[shapely.Polygon]:
    """A wall of 3 x 2 m in running bond of .5 x .25 m, each outline larger by so much on each side."""
    found: list[shapely.Polygon] = []
    for course in range(8):
        start = -0.25 * (course % 2)
        for number in range(7):
            low, high = max(start + 0.5 * number, 0.0), min(start + 0.5 * number + 0.5, 3.0)
            if high > low:
                edges = (low - grown, 0.25 * course - grown, high + grown, 0.25 * course + 0.25 + grown)
                found.append(shapely.box(*edges))
    return found


def drawing(path: Path, grown: float, units: int = 6, metre: float = 1.0) -> Path:
    document = ezdxf.new(units=units)  # pyright: ignore[reportPrivateImportUsage]
    for outline in outlines(grown):
        corners = [(metre * x, metre * y) for x, y in list(outline.exterior.coords)[:-1]]
        document.modelspace().add_lwpolyline(corners, close=True)
    document.saveas(path)
    return path


READING = Reading(thickness=THICK, support="base")


@pytest.mark.parametrize(("units", "metre"), [(6, 1.0), (4, 1000.0)])
def test_outlines_too_large_by_a_millimetre_are_a_finding(tmp_path: Path, units: int, metre: float) -> None:
    read, contacts = check_drawing(drawing(tmp_path / "wall.dxf", 1e-3, units, metre), READING, WEIGHT)
    drawn = outlines(1e-3)
    twice = THICK * (sum(outline.area for outline in drawn) - shapely.union_all(drawn).area)
    # Where three stones lie in each other, each two of them count.
    assert shared_volumes(read.stones, contacts).sum() == pytest.approx(twice, rel=0.01)
    [finding] = [finding for finding in read.findings if finding.code == "W49"]
    share = twice / (THICK * sum(outline.area for outline in drawn))
    assert share == pytest.approx(0.0106, abs=5e-5)
    assert f"{1e2 * share:.2g} % of the volume of the stones" in finding.what
    assert finding.what.startswith("128 pairs of stones lie in each other, by up to 2 mm: ")
    assert "counts twice in their weight" in finding.what
    # The place is in the drawing's own plane, on the joint of the two stones that are named.
    assert finding.position is not None
    x, y, z = finding.position
    assert z == pytest.approx(0.0, abs=THICK)
    around = shapely.Point(x, y).buffer(1e-9)
    assert sum(outline.buffer(1e-6).intersects(around) for outline in drawn) >= 2
    [line] = [line for line in joint_lines(*joint_account(read.stones, contacts)) if "lie in each other" in line]
    shared = shared_volumes(read.stones, contacts).sum()
    assert line == (
        "Joints of stones that lie in each other: 128, up to 2 mm where deepest. What they share, "
        f"{shared:.3g} m3 or 1.1 % of the volume of the stones, counts twice in their weight."
    )


def test_the_import_lists_it(tmp_path: Path) -> None:
    found = import_drawing(drawing(tmp_path / "wall.dxf", 1e-3), tmp_path / "case", READING, unit_weight=WEIGHT, friction=0.6)
    assert "W49" in found.findings.codes
    assert "W49" in (tmp_path / "case" / "findings.json").read_text()


@pytest.mark.parametrize("grown", [0.0, 5e-5])
def test_what_rounding_makes_is_none(tmp_path: Path, grown: float) -> None:
    read, contacts = check_drawing(drawing(tmp_path / "wall.dxf", grown), READING, WEIGHT)
    assert "W49" not in read.findings.codes
    assert not any("counts twice" in line for line in joint_lines(*joint_account(read.stones, contacts)))


def test_solids_that_lean_into_each_other_share_a_wedge() -> None:
    # A block with its foot 8 mm deep in the one below at one end, and 4 mm above it at the other: a wedge of two thirds of it.
    points, faces = box((0.0, 1.0), (0.0, 0.5), (1.0, 1.5))
    points = points.copy()
    foot = points[:, 2] == 1.0
    points[foot, 2] += -0.008 + 0.012 * points[foot, 0]
    ground, below = box((-1.0, 2.0), (-1.0, 2.0), (-0.5, 0.0)), box((0.0, 1.0), (0.0, 0.5), (0.0, 1.0))
    stones = cp.Assemblage.from_polyhedra([ground, below, (points, faces)], WEIGHT, fixed=[0])
    contacts = cp.find_contacts(stones, overlap=0.01, contact_gap=0.01, contact_angle=0.1)
    assert shared_volumes(stones, contacts).sum() == pytest.approx(0.5 * 0.008 * (2 / 3) * 0.5, rel=0.01)
    twice = counted_twice(stones, contacts)
    assert twice is not None
    assert twice.stones == ("B1", "B2")
    assert twice.depth == pytest.approx(0.008, rel=0.01)
