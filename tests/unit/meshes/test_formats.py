"""Every format: the stones that were written come back, and their load factor."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.findings import FindingsError
from churchpipe.model.assemblage import Assemblage
from mesh_files import METRES, WRITERS, solids, write_3dec, write_3mf, write_obj, write_ply, write_stl
from solids import box, prism

GROUND = box((-1, 2), (-1, 1), (-0.5, 0))
# Sizes that have an exact binary form, for formats that hold 32 bits.
BRICKS = [
    box((x + 0.125 * (z % 2), x + 0.25 + 0.125 * (z % 2)), (0, 0.125), (0.125 * z, 0.125 * z + 0.125))
    for z in range(4)
    for x in (0, 0.25, 0.5)
]
# Formats that hold no names have no ground.
NAMELESS = ("ply", "ply-binary", "stl-binary")


def wall(*, ground: bool = True) -> Assemblage:
    solids = [GROUND, *BRICKS] if ground else BRICKS
    return Assemblage.from_polyhedra(solids, 18e3, fixed=[0] if ground else [])


def arch() -> Assemblage:
    """Seven voussoirs over a half circle on two fixed blocks, no coordinate of them a round number."""
    angle = np.linspace(0.1, np.pi - 0.1, 8)
    outlines = [[(r * np.cos(a), r * np.sin(a)) for r, a in ((1.0, s), (1.3, s), (1.3, t), (1.0, t))] for s, t in pairwise(angle)]
    feet = []
    for a in (angle[0], angle[-1]):
        inner, outer = (np.cos(a), np.sin(a)), (1.3 * np.cos(a), 1.3 * np.sin(a))
        feet.append([inner, outer, (outer[0], -0.2), (inner[0], -0.2)])
    return Assemblage.from_polyhedra([prism(o, 0.3) for o in [*outlines, *feet]], 18e3, fixed=[7, 8])


def load_factor(stones: Assemblage) -> float:
    contacts = cp.find_contacts(stones)
    cp.check_soundness(stones, contacts)
    state = cp.limit_analysis(stones, contacts, cp.LoadCase(direction=(1, 0, 0)), friction=0.6)
    assert state.status == "optimal"
    return state.load_factor


@pytest.mark.parametrize("name", WRITERS)
def test_what_was_written_comes_back(name: str, tmp_path: Path) -> None:
    stones = wall(ground=name not in NAMELESS)
    path = WRITERS[name](stones, tmp_path)
    read, findings = cp.read_stones(path, unit_weight=18e3, support="base" if name in NAMELESS else "drawn")
    assert {code[0] for code in findings.codes} <= {"W"}
    assert set(findings.codes) <= {"W12", "W43", "W45"}
    free = ~read.fixed
    assert free.sum() == 12
    # Triangles are faces again.
    assert np.diff(read.block_face_ptr).tolist() == [6] * read.count
    order = np.lexsort(read.centroid[free].round(6).T)
    written = stones.centroid[~stones.fixed]
    np.testing.assert_allclose(read.centroid[free][order], written[np.lexsort(written.round(6).T)], atol=1e-12)
    np.testing.assert_allclose(read.volume[free], 0.25 * 0.125**2, rtol=1e-12)
    assert load_factor(read) == pytest.approx(load_factor(wall()), rel=1e-6)


@pytest.mark.parametrize("name", [name for name in WRITERS if name not in NAMELESS])
def test_an_arch_has_the_load_factor_of_the_one_that_was_written(name: str, tmp_path: Path) -> None:
    stones = arch()
    read, _ = cp.read_stones(WRITERS[name](stones, tmp_path), unit_weight=18e3)
    assert read.count == 9
    if name == "glb":
        # The format holds 32 bits: the coordinates are off by 1e-8 m.
        np.testing.assert_allclose(np.sort(read.volume), np.sort(stones.volume), rtol=1e-6)
    else:
        np.testing.assert_allclose(np.sort(read.volume), np.sort(stones.volume), rtol=1e-12)
    assert load_factor(read) == pytest.approx(load_factor(stones), rel=1e-6)


def test_names_materials_and_ground_are_kept(tmp_path: Path) -> None:
    read, findings = cp.read_stones(write_obj(wall(), tmp_path / "wall.obj"), unit_weight=18e3)
    assert read.block_id.tolist()[:3] == ["ground-0", "B1", "B2"]
    assert set(read.material) == {"stone"}
    assert read.fixed.tolist() == [True] + [False] * 12
    assert "obj/W43 wall.obj: 1 bodies are ground by their names: ground-0." in str(findings)


@pytest.mark.parametrize("unit", METRES)
def test_a_3mf_is_read_in_the_unit_that_it_says(unit: str, tmp_path: Path) -> None:
    stones = wall()
    read, _ = cp.read_stones(write_3mf(stones, tmp_path / "wall.3mf", unit=unit), unit_weight=18e3)
    np.testing.assert_allclose(read.volume, stones.volume, rtol=1e-6)


def test_a_3mf_in_a_unit_of_its_own_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FindingsError, match="its unit is 'cubit'"):
        cp.read_stones(write_3mf(wall(), tmp_path / "wall.3mf", unit="cubit"))


def test_units_scale_and_the_axis_that_points_up(tmp_path: Path) -> None:
    stones = wall()
    lying = [(points[:, [0, 2, 1]] * [1000, 1000, -1000], faces) for _, points, faces, _ in solids(stones)]
    path = write_obj(Assemblage.from_polyhedra(lying, 1.0, fixed=[0]), tmp_path / "lying.obj")
    with pytest.raises(FindingsError, match=r"obj/E04 lying.obj: the file says no unit; .*--units mm"):
        cp.read_stones(path)
    read, _ = cp.read_stones(path, units="mm", up="y", unit_weight=18e3)
    np.testing.assert_allclose(read.centroid, stones.centroid, atol=1e-9)
    doubled, _ = cp.read_stones(path, units="mm", up="y", scale=2.0, unit_weight=18e3)
    np.testing.assert_allclose(doubled.volume, 8 * stones.volume, rtol=1e-9)


def test_a_file_in_another_format_is_named_with_those_that_are_read(tmp_path: Path) -> None:
    path = tmp_path / "wall.skp"
    path.write_bytes(b"\xff\xfe\xff")
    with pytest.raises(FindingsError, match=r'import/E01 wall.skp: a file that ends in ".skp": expected one of DXF, OBJ, STL'):
        cp.read_stones(path)


def test_stones_that_touch_in_one_soup_are_told_apart_by_the_order_of_their_facets(tmp_path: Path) -> None:
    read, _ = cp.read_stones(write_stl(wall(ground=False), tmp_path / "wall.stl", binary=True), support="base", unit_weight=1.0)
    assert (~read.fixed).sum() == 12


@pytest.mark.parametrize("cut", [0.3, 0.7, 0.99])
@pytest.mark.parametrize("write", [write_stl, write_ply, write_3dec, write_obj])
def test_a_truncated_file_is_never_a_smaller_wall(write: object, cut: float, tmp_path: Path) -> None:
    path = write(wall(ground=False), tmp_path / f"wall.{write.__name__[6:].replace('3dec', '3ddat')}")  # type: ignore[operator]
    data = path.read_bytes()
    path.write_bytes(data[: int(cut * len(data))])
    with pytest.raises(FindingsError):
        cp.read_stones(path, support="base")
