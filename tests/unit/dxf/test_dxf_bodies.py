"""Which bodies a mesh of a drawing holds."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from ezdxf.filemanagement import new
from ezdxf.math import Vec3
from ezdxf.render.mesh import MeshBuilder, MeshVertexMerger

from churchpipe.dxf.reader import Drawing, read_drawing
from churchpipe.findings import FindingsError
from churchpipe.model.arrays import FloatArray
from churchpipe.stones.contacts import find_contacts
from dxf_models import box, prism


def mesh_of(solids: Sequence[tuple[FloatArray, Sequence[Sequence[int]]]], *, welded: bool = False) -> MeshBuilder:
    mesh = MeshVertexMerger() if welded else MeshBuilder()
    for points, faces in solids:
        mesh.add_mesh(vertices=Vec3.list(points.tolist()), faces=list(faces))
    return mesh


def read(mesh: MeshBuilder, path: Path, *, polyface: bool = False) -> Drawing:
    document = new("R2010", units=6)
    (mesh.render_polyface if polyface else mesh.render_mesh)(document.modelspace())
    document.saveas(path)
    return read_drawing(path, support="base", unit_weight=18e3)


def bricks(apart: float = 0.0) -> list:
    return [box((x * (0.5 + apart), 0, z * (0.3 + apart)), (0.5, 0.4, 0.3)) for z in range(2) for x in range(3)]


@pytest.mark.parametrize(
    ("apart", "welded", "polyface"), [(0, False, False), (0, True, False), (1e-3, False, False), (1e-3, False, True)]
)
def test_each_closed_part_of_a_mesh_is_a_stone(apart: float, welded: bool, polyface: bool, tmp_path: Path) -> None:
    # They were one stone without joints inside, and nothing said so.
    drawing = read(mesh_of(bricks(apart), welded=welded), tmp_path / "wall.dxf", polyface=polyface)
    free = ~drawing.stones.fixed
    assert free.sum() == 6
    assert drawing.stones.volume[free].sum() == pytest.approx(6 * 0.06, rel=1e-9)
    assert {"W42", "W22", "W12"} == set(drawing.findings.codes)
    joints = find_contacts(drawing.stones).blocks
    assert free[joints].all(axis=1).sum() == 7


def test_a_hollow_stone_is_one(tmp_path: Path) -> None:
    outer, (points, faces) = box((0, 0, 0), (1, 1, 1)), box((0.25, 0.25, 0.25), (0.5, 0.5, 0.5))
    hollow = (points, [face[::-1] for face in faces])
    drawing = read(mesh_of([outer, hollow]), tmp_path / "hollow.dxf")
    free = ~drawing.stones.fixed
    assert drawing.stones.volume[free].tolist() == [pytest.approx(1 - 0.125)]
    assert "W42" not in drawing.findings.codes
    assert "1 body within a stone, with faces that look the other way" in str(drawing.findings)


def test_a_body_turned_inside_out_beside_others_is_no_void(tmp_path: Path) -> None:
    """It lies in the box of an L, not in the L: all three were one stone, in silence."""
    corner = prism(np.array([(0, 0), (2, 0), (2, 0.5), (0.5, 0.5), (0.5, 2), (0, 2)]), 1.0)
    points, faces = box((1, 1, 0.25), (0.5, 0.5, 0.5))
    drawing = read(mesh_of([corner, (points, [face[::-1] for face in faces]), box((4, 0, 0), (1, 1, 1))]), tmp_path / "a.dxf")
    assert drawing.stones.volume[~drawing.stones.fixed].tolist() == [pytest.approx(volume) for volume in (1.75, 0.125, 1.0)]


def test_of_several_bodies_one_may_be_hollow(tmp_path: Path) -> None:
    points, faces = box((0.25, 0.25, 0.25), (0.5, 0.5, 0.5))
    solids = [box((0, 0, 0), (1, 1, 1)), (points, [face[::-1] for face in faces]), box((1, 0, 0), (1, 1, 1))]
    drawing = read(mesh_of(solids), tmp_path / "a.dxf")
    assert drawing.stones.volume[~drawing.stones.fixed].tolist() == [pytest.approx(volume) for volume in (0.875, 1.0)]
    assert {"W29", "W42"} <= set(drawing.findings.codes)


def test_an_open_part_leaves_the_mesh_whole_and_is_told(tmp_path: Path) -> None:
    points, faces = box((1, 0, 0), (1, 1, 1))
    mesh = mesh_of([box((0, 0, 0), (1, 1, 1)), (points, faces[:-1])])
    with pytest.raises(FindingsError, match="E10"):
        read(mesh, tmp_path / "open.dxf")


@pytest.mark.parametrize("seed", range(3))
def test_3d_faces_of_stones_that_touch_are_told_apart_in_any_order(seed: int, tmp_path: Path) -> None:
    document = new("R2010", units=6)
    pile = [box((x, 0, 0.3 * z), (1, 1, 0.3)) for x in range(2) for z in range(3)]
    faces = [points[list(face)] for points, around in pile for face in around]
    for number in np.random.default_rng(seed).permutation(len(faces)).tolist():
        document.modelspace().add_3dface(Vec3.list(faces[number].tolist()))
    document.saveas(tmp_path / "pile.dxf")
    for repair in (False, True):
        drawing = read_drawing(tmp_path / "pile.dxf", support="base", repair=repair)
        assert drawing.stones.volume[~drawing.stones.fixed] == pytest.approx([0.3] * 6)
        assert {"W41", "E10"}.isdisjoint(drawing.findings.codes)


@pytest.mark.parametrize("scale", [1.0, 1000.0], ids=["m", "mm"])
@pytest.mark.parametrize("block", [False, True], ids=["space", "block"])
def test_a_repair_joins_corners_of_3d_faces_that_nearly_meet(scale: float, block: bool, tmp_path: Path) -> None:
    document = new("R2010", units=6 if scale == 1 else 4)
    space = document.blocks.new("PILE") if block else document.modelspace()
    noise = np.random.default_rng(0)
    for z in range(2):
        points, around = box((0, 0, 0.25 * z), (0.5, 0.25, 0.25))
        for face in around:
            corners = points[list(face)] + noise.uniform(-1e-6, 1e-6, (len(face), 3))
            space.add_3dface(Vec3.list((scale * corners).tolist()))
    if block:
        document.modelspace().add_blockref("PILE", (0, 0, 0))
    document.saveas(tmp_path / "pile.dxf")
    with pytest.raises(FindingsError, match="Pass --repair to join corners that nearly meet"):
        read_drawing(tmp_path / "pile.dxf", support="base")
    drawing = read_drawing(tmp_path / "pile.dxf", support="base", repair=True)
    assert drawing.stones.volume[~drawing.stones.fixed] == pytest.approx([0.03125] * 2, rel=1e-4)
    said = [finding for finding in drawing.findings.items if finding.code == "W41"]
    assert [finding.found for finding in said] == ["vertices that nearly met were joined, moved by {} at most"] * 2
    assert all(0 < finding.lengths[0] < 2 * np.sqrt(3) * 1e-6 for finding in said)


@pytest.mark.parametrize(("layer", "said"), [("Ground", True), ("SUPPORT", True), ("CP-SUPPORT", False)])
@pytest.mark.parametrize("how", ["solid", "faces", "insert"])
def test_what_lies_on_a_layer_of_ground_is_ground(layer: str, said: bool, how: str, tmp_path: Path) -> None:
    document = new("R2010", units=6)
    space, own = document.modelspace(), {"layer": layer}
    mesh_of([box((0, 0, 0), (1, 1, 2))]).render_mesh(space)
    plate = mesh_of([box((-1, -1, -0.5), (3, 3, 0.5))])
    if how == "solid":
        plate.render_mesh(space, dxfattribs=own)
    elif how == "faces":
        space.add_3dface([(-1, -1, 0), (2, -1, 0), (2, 2, 0), (-1, 2, 0)], dxfattribs=own)
    else:
        plate.render_mesh(document.blocks.new("PLATE"))
        space.add_blockref("PLATE", (0, 0, 0), dxfattribs=own)
    document.saveas(tmp_path / "ground.dxf")
    drawing = read_drawing(tmp_path / "ground.dxf", support="base", unit_weight=18e3)
    assert drawing.stones.fixed.sum() == 1
    assert drawing.stones.weight.sum() == pytest.approx(2 * 18e3)
    assert "W12" not in drawing.findings.codes
    assert ("W43" in drawing.findings.codes) == said


def test_a_joint_on_a_face_cut_into_triangles_is_one(tmp_path: Path) -> None:
    """Where fewer than half of the faces are triangles, a joint in two pieces would resist torsion otherwise than a whole one."""
    ground = mesh_of([box((-1, -1, -0.5), (4, 3, 0.5))])
    document = new("R2010", units=6)
    document.layers.add("GROUND")
    triangles = MeshBuilder()
    triangles.add_mesh(vertices=ground.vertices, faces=[part for f in ground.faces for part in ((*f[:3],), (f[0], *f[2:]))])
    triangles.render_mesh(document.modelspace(), dxfattribs={"layer": "GROUND"})
    for stone in bricks():
        mesh_of([stone]).render_mesh(document.modelspace())
    document.saveas(tmp_path / "wall.dxf")
    stones = read_drawing(tmp_path / "wall.dxf", unit_weight=18e3).stones
    assert np.diff(stones.block_face_ptr).tolist() == [6] * 7
    contacts = find_contacts(stones)
    assert (len(contacts.blocks), len(contacts.point)) == (7 + 3, 4 * (7 + 3))


@pytest.mark.parametrize(
    ("level", "crease", "accepted"), [(0, 0.0, True), (2, 0.0, False), (2, -1.0, True), (2, 1.0, False), (2, 2.0, True)]
)
def test_a_mesh_that_is_shown_smoothed_is_no_stone(level: int, crease: float, accepted: bool, tmp_path: Path) -> None:
    """A cube smoothed is nearly a ball: its faces would give it twice the volume that its owner sees."""
    points, faces = box((0, 0, 0), (0.5, 0.5, 0.5))
    document = new("R2010", units=6)
    mesh = document.modelspace().add_mesh(dxfattribs={"subdivision_levels": level})
    with mesh.edit_data() as data:
        data.vertices, data.faces = Vec3.list(points.tolist()), [list(face) for face in faces]
        sides = {tuple(sorted(side)) for face in faces for side in zip(face, (*face[1:], face[0]), strict=True)}
        data.edges = [(first, last) for first, last in sides]
        data.edge_crease_values = [crease] * len(data.edges)
    document.saveas(tmp_path / "a.dxf")
    if accepted:
        assert read_drawing(tmp_path / "a.dxf", support="base", unit_weight=18e3).stones.volume[0] == pytest.approx(0.125)
    else:
        with pytest.raises(FindingsError, match=r"E21 .*shown smoothed, to level 2"):
            read_drawing(tmp_path / "a.dxf", support="base", unit_weight=18e3)
