"""Walls at an angle to the axes, as files round them, meet as the same walls along x and y do."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

import churchpipe as cp
from churchpipe.geometry.prism import prism_of
from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage, Polyhedron
from churchpipe.model.building import PlaneChart
from churchpipe.recognition.laying import LaidBond, Volume, joined, laid_panel
from churchpipe.recognition.squaring import squared
from mesh_files import write_obj, write_stl
from solids import box

THICKNESS = 0.5
OPTIONS: dict[str, Any] = {"bond": "running", "course": 0.25, "stone": 0.5, "support": "base", "unit_weight": 20e3}
PUSH = cp.LoadCase((0, 1, 0))


def elevation(outline: shapely.Polygon, across: float = 0.0) -> Polyhedron:
    """A wall along x that looks along y, THICKNESS deep."""
    flat, faces = prism_of(outline)
    points = np.stack([flat[:, 0], across + THICKNESS * flat[:, 2], flat[:, 1]], axis=1)
    return points, [list(face)[::-1] for face in faces]


def house(short: float = 0.0) -> Assemblage:
    """A wall with a door and a lintel up to its end, and two walls across it, the first of which ends `short` of its far face."""
    wall = shapely.box(0, 0, 6, 3).difference(shapely.box(2, 0, 3.25, 2))
    across = box((0, THICKNESS), (short, 4), (0, 3)), box((5.5, 5.5 + THICKNESS), (0, 4), (0, 3))
    bodies = [elevation(wall), elevation(shapely.box(0, 2, 3.5, 2.25)), *across]
    return Assemblage.from_polyhedra(bodies, 20e3, block_id=["wall", "lintel", "west", "east"])


def placed(points: FloatArray, degrees: float, at: tuple[float, float]) -> FloatArray:
    turn = np.radians(degrees)
    x, y, z = points.T
    return np.stack([np.cos(turn) * x - np.sin(turn) * y + at[0], np.sin(turn) * x + np.cos(turn) * y + at[1], z], axis=1)


TURNED = pytest.mark.slow("docs/drawings.md: walls at any angle")


@pytest.mark.parametrize(
    ("degrees", "at", "digits", "scale"),
    [
        pytest.param(33.0, (12.0, -7.0), ".6f", 1.0, marks=TURNED),
        pytest.param(33.0, (12.0, -7.0), ".3f", 1e3, marks=TURNED),
        (71.3, (0.2, 0.1), ".3f", 1.0),
        (117.0, (450_000.0, 5_100_000.0), ".4f", 1.0),
    ],
    ids=["m, six decimals", "mm, three decimals", "m, three decimals", "on the map"],
)
def test_turned_walls_are_those_along_the_axes(tmp_path: Path, degrees, at, digits, scale):
    exact, _ = cp.read_stones(write_obj(house(), tmp_path / "exact.obj"), units="m", **OPTIONS)
    assert exact.count == 1 + (~exact.fixed).sum()
    path = write_obj(house(), tmp_path / "turned.obj", digits=digits, bend=lambda points: scale * placed(points, degrees, at))
    found, findings = cp.read_stones(path, units="mm" if scale > 1 else "m", **OPTIONS)
    assert found.count == exact.count
    assert found.volume[~found.fixed].sum() == pytest.approx(exact.volume[~exact.fixed].sum(), rel=1e-3)
    ours, theirs = cp.find_contacts(exact), cp.find_contacts(found)
    # Where reveals are off by half a millimetre, joints that end on them may be as wide as that.
    assert len(theirs.blocks) == pytest.approx(len(ours.blocks), abs=2 if digits == ".3f" and scale == 1.0 else 0)
    cp.check_soundness(found, theirs)
    turn = np.radians(degrees)
    along = cp.LoadCase((-np.sin(turn), np.cos(turn), 0))
    expected = cp.limit_analysis(exact, ours, PUSH, 0.6).load_factor
    assert cp.limit_analysis(found, theirs, along, 0.6).load_factor == pytest.approx(expected, rel=2e-3)
    # Rounding to a millimetre moves walls by what is worth saying, to a thousandth of one it does not.
    assert ("to meet other walls" in str(findings)) == (digits == ".3f" and scale == 1.0)


def test_walls_of_a_binary_mesh_meet(tmp_path: Path):
    """Of a binary STL, whose numbers have seven digits, at an angle."""
    bodies = [
        (placed(points, 33.0, (12.0, -7.0)), faces)
        for points, faces in (elevation(shapely.box(0, 0, 6, 3)), box((0, 0.5), (0, 4), (0, 3)))
    ]
    path = write_stl(Assemblage.from_polyhedra(bodies, 20e3), tmp_path / "walls.stl", binary=True)
    stones, _ = cp.read_stones(path, units="m", **OPTIONS)
    assert stones.volume[~stones.fixed].sum() == pytest.approx(3 * 0.5 * (6 + 3.5), rel=1e-6)


@pytest.mark.parametrize("short", [0.002, -0.002])
def test_a_wall_that_ends_nearly_on_a_face_is_moved_and_that_is_said(tmp_path: Path, short):
    stones, findings = cp.read_stones(write_obj(house(short), tmp_path / "a.obj"), units="m", **OPTIONS)
    exact, _ = cp.read_stones(write_obj(house(), tmp_path / "b.obj"), units="m", **OPTIONS)
    assert '"west": moved by 2 mm at most' in str(findings)
    assert stones.volume.sum() == pytest.approx(exact.volume.sum(), rel=1e-9)
    assert stones.count == exact.count


def test_what_is_further_away_stays(tmp_path: Path):
    with pytest.raises(cp.InputError, match=r"junction of wall and west: the walls do not cross squarely"):
        cp.read_stones(write_obj(house(0.01), tmp_path / "a.obj"), units="m", **OPTIONS)


def test_no_side_falls_onto_another():
    """Two sides within reach of one face: the nearer one goes there, and the opening keeps a width."""
    wall = shapely.box(0, 0, 6, 3).difference(shapely.box(0.501, 1, 0.5022, 2))
    bond = LaidBond("running", 0.25, 0.5)
    bodies = [elevation(wall), box((0, THICKNESS), (0, 4), (0, 3))]
    panels = [laid_panel(Volume(str(n), "default", *body), 0.0, bond) for n, body in enumerate(bodies)]
    (first, second), moved = squared(panels)
    assert moved == {"0": pytest.approx(0.001)}
    assert sorted(set(np.round(first.openings[0].outline[:, 0], 9))) == [0.5, 0.5022]
    assert second is panels[1]
    assert len(joined([second])) == 1


def test_walls_as_large_as_each_other_are_squared():
    """Of two walls of one size, as in a square house, the second goes by the first."""
    bond = LaidBond("running", 0.25, 0.5)
    flat, faces = box((0, 6), (0, THICKNESS), (0, 3))
    bodies = [(flat, faces), (placed(flat, 90.003, (THICKNESS, 0.0)), faces)]
    panels = [laid_panel(Volume(str(n), "default", *body), 0.0, bond) for n, body in enumerate(bodies)]
    (first, second), moved = squared(panels)
    assert isinstance(first.chart, PlaneChart)
    assert isinstance(second.chart, PlaneChart)
    assert first.chart.s_axis @ second.chart.s_axis == 0
    # Its ends move by half its length, and along it by what half its thickness turned out of the face.
    assert moved["1"] == pytest.approx((3 + 0.5 * THICKNESS) * np.radians(0.003), rel=0.01)
