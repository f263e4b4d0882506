"""Assemblage -> DXF -> Assemblage: the same stones to 1e-12 m."""

import gc
import math
from contextlib import suppress

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from churchpipe.dxf.reader import read_drawing, read_dxf
from churchpipe.dxf.recurrence import find_recurrence
from churchpipe.dxf.writer import write_dxf
from churchpipe.findings import FindingsError
from churchpipe.generators import arch, prototype, wall
from churchpipe.generators import box as box_building
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import Elastic, Material
from churchpipe.stones.blocks import derive_blocks
from dxf_models import assert_same, box, prism

BRICK = (0.08, 0.04, 0.03)
S22 = {
    "brick": BRICK,
    "main_wall_bricks": 14,
    "partitions_x": [0.0, 0.52, 1.08],
    "partition_length": 0.84,
    "courses": 21,
    "opening": {"start": 0.12, "width": 0.16, "height_courses": 15, "lintel_bearing": 0.04},
}
BUILDINGS = {
    "wall": lambda: wall(length=0.5, brick=BRICK, courses=6),
    "arch": lambda: arch(mean_radius=1.0, thickness=0.2, width=0.4, voussoirs=27),
    "prototype": lambda: prototype(**S22),
    "box": lambda: box_building(length=1.0, width=0.8, courses=5, brick=BRICK),
}

# A notched prism is not convex; a wedge has no plane of symmetry that a mirror image could hide behind.
OUTLINES = (
    np.array([(0, 0), (1, 0), (1, 1), (0, 1)], dtype=float),
    np.array([(0, 0), (1, 0), (0, 0.7)], dtype=float),
    np.array([(0, 0), (1, 0), (1, 0.4), (0.3, 0.4), (0.3, 1), (0, 1)], dtype=float),
)
NAMES = st.text(st.characters(codec="utf-8", exclude_categories=["C", "Z"], exclude_characters="^"), min_size=1, max_size=12)
LENGTH = st.floats(0.1, 2.0)


@st.composite
def assemblages(draw: st.DrawFn) -> Assemblage:
    """Up to 8 prisms anywhere in a building, turned, mirrored, some of them the same stone again; one is ground."""
    count = draw(st.integers(2, 8))
    solids = []
    for number in range(count):
        if solids and draw(st.booleans()):
            points, faces = solids[0]
            turn = Rotation.from_euler("z", draw(st.floats(-math.pi, math.pi)))
            points = turn.apply(points - points.mean(axis=0))
        else:
            outline = OUTLINES[draw(st.integers(0, 2))] * [draw(LENGTH), draw(LENGTH)]
            points, faces = prism(outline, draw(LENGTH))
            points = Rotation.from_rotvec(draw(st.tuples(*[st.floats(-3, 3)] * 3))).apply(points)
            if draw(st.booleans()):
                points, faces = points * [-1, 1, 1], tuple(face[::-1] for face in faces)
        solids.append((points + np.array([10.0 * number, draw(st.floats(-20, 20)), draw(st.floats(0, 20))]), faces))
    return Assemblage.from_polyhedra(
        solids,
        2e4,
        fixed=[draw(st.integers(0, count - 1))],
        material=draw(st.lists(st.sampled_from(["stone", "brick", "tuff"]), min_size=count, max_size=count)),
        panel=draw(st.lists(st.just("") | NAMES, min_size=count, max_size=count)),
        course=draw(st.lists(st.integers(-1, 60), min_size=count, max_size=count)),
        block_id=draw(st.lists(NAMES, min_size=count, max_size=count, unique=True)),
    )


@pytest.fixture(scope="module")
def drawing(tmp_path_factory: pytest.TempPathFactory):
    return tmp_path_factory.mktemp("dxf") / "drawing.dxf"


@settings(max_examples=20, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(stones=assemblages(), units=st.sampled_from(["m", "mm"]))
def test_random_polyhedra_come_back(stones: Assemblage, units, drawing) -> None:
    assert_comes_back(stones, units, drawing)


@pytest.mark.slow
@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(stones=assemblages(), units=st.sampled_from(["m", "mm"]))
def test_more_random_polyhedra_come_back(stones: Assemblage, units, drawing) -> None:
    assert_comes_back(stones, units, drawing)


def assert_comes_back(stones: Assemblage, units, drawing) -> None:
    materials = [Material(name, 2e4, 0.6) for name in ("stone", "brick", "tuff")]
    write_dxf(stones, drawing, materials=materials, units=units)
    read, findings = read_dxf(drawing)
    assert findings.codes == ()
    assert_same(read, stones)


@pytest.mark.parametrize(
    ("name", "units"),
    [
        pytest.param(
            name,
            units,
            marks=() if units == "m" or name == "wall" else pytest.mark.slow("docs/dxf.md: every generator comes back"),
        )
        for name in BUILDINGS
        for units in ("m", "mm")
    ],
)
def test_every_generator_comes_back(name: str, units, tmp_path) -> None:
    building = BUILDINGS[name]()
    stones = derive_blocks(building)
    write_dxf(stones, tmp_path / "drawing.dxf", materials=building.materials, units=units)
    read = read_drawing(tmp_path / "drawing.dxf")
    assert read.findings.codes == ()
    assert read.units == units
    assert read.materials == building.materials
    assert_same(read.stones, stones)


def test_materials_and_loads_travel_with_the_drawing(tmp_path) -> None:
    elastic = Elastic(3.18e9, 0.23, 0.303e9, 0.3, 1e-3)
    materials = [Material("tuff é", 28.6e3, 0.7, 12.5e3, elastic), Material("stone", 18e3, 0.6)]
    loads = [LoadCase((0, -1, 0)), LoadCase((1, 2, 0), name="push", panels=["facade", 'the "old" tower'], profile="linear")]
    stones = Assemblage.from_polyhedra(
        [box((0, 0, -1), (1, 1, 1)), box((0, 0, 0), (1, 1, 1)), box((0, 0, 1), (1, 1, 1))],
        [0.0, 28.6e3, 18e3],
        fixed=[0],
        material=["", "tuff é", "stone"],
    )
    write_dxf(stones, tmp_path / "a.dxf", materials=materials, loads=loads)
    read = read_drawing(tmp_path / "a.dxf")
    assert list(read.materials) == materials
    assert [(c.name, c.panels, c.profile) for c in read.loads] == [(c.name, c.panels, c.profile) for c in loads]
    np.testing.assert_allclose([c.direction for c in read.loads], [c.direction for c in loads], rtol=0, atol=1e-15)
    assert_same(read.stones, stones)


def test_unit_weight_comes_from_the_caller_before_the_drawing(tmp_path) -> None:
    stones = derive_blocks(wall(length=0.16, brick=BRICK, courses=2))
    path = tmp_path / "wall.dxf"
    write_dxf(stones, path)
    silent = read_drawing(path)
    assert (silent.unweighted, silent.findings.codes) == (("default",), ("W19",))
    assert set(silent.stones.unit_weight[~silent.stones.fixed]) == {1.0}
    assert read_drawing(path, unit_weight=21e3).unweighted == ()
    write_dxf(stones, path, materials=[Material("default", float(stones.unit_weight[-1]), 0.6)])
    by_name = read_drawing(path, unit_weight={"default": 21e3})
    assert set(by_name.stones.unit_weight[~by_name.stones.fixed]) == {21e3}


def test_s22_is_drawn_with_four_definitions() -> None:
    # Ground plate, brick, half brick and lintel; the bricks of the partitions are those of the main wall turned by 90 degrees.
    recurrence = find_recurrence(derive_blocks(prototype(**S22)))
    assert len(recurrence.shapes) == 4
    assert set(np.abs(recurrence.turn)) == {0.0, 90.0}


@pytest.mark.parametrize("collecting", [True, False])
def test_reading_leaves_the_collection_of_garbage_as_it_was(collecting: bool, tmp_path) -> None:
    path = tmp_path / "wall.dxf"
    write_dxf(derive_blocks(BUILDINGS["wall"]()), path)
    (tmp_path / "no.dxf").write_text("no drawing")
    seen: list[bool] = []
    before = gc.isenabled()
    (gc.enable if collecting else gc.disable)()
    try:
        for file in (path, tmp_path / "no.dxf"):
            with suppress(FindingsError):
                read_dxf(file)
            seen.append(gc.isenabled())
    finally:
        (gc.enable if before else gc.disable)()
    assert seen == [collecting] * 2


@pytest.mark.slow("docs/dxf.md: the size of a drawing of five thousand stones")
def test_five_thousand_stones_make_a_drawing_of_a_few_megabytes(tmp_path) -> None:
    solids = [box((-1, -1, -0.1), (30, 3, 0.1))]
    solids += [box((0.57 * (i % 50) + 0.285 * (i // 50 % 2), 0, 0.275 * (i // 50)), (0.57, 0.9, 0.275)) for i in range(5000)]
    stones = Assemblage.from_polyhedra(solids, 18e3, fixed=[0], material="stone", block_id=[f"S{i}" for i in range(5001)])
    path = tmp_path / "large.dxf"
    write_dxf(stones, path, materials=[Material("stone", 18e3, 0.6)])
    assert path.stat().st_size < 3.5e6
    assert_same(read_dxf(path)[0], stones)
