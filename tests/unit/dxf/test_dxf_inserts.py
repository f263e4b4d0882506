"""Inserts as CAD programs make them: mirrored, turned, nested, arrayed, stretched; bodies in every form that is read."""

from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
from ezdxf.acis import api as acis
from ezdxf.math import Vec3
from ezdxf.render import MeshBuilder
from ezdxf.xclip import XClip

from churchpipe.dxf.reader import Drawing, read_drawing
from churchpipe.findings import FindingsError
from dxf_models import BOX_FACES, box, edited

# The wedge over (0, 0), (0.6, 0), (0, 0.3), 0.2 m high, drawn from its first vertex.
WEDGE = np.array([(x, y, z) for z in (0.0, 0.2) for x, y in ((0, 0), (0.6, 0), (0, 0.3))])
WEDGE_VOLUME = 0.6 * 0.3 / 2 * 0.2


def wedge_insert(doc: Any) -> Any:
    return next(i for i in doc.modelspace().query("INSERT") if i.dxf.layer == "CP-BLOCKS")


def turned(points: np.ndarray, degrees: float) -> np.ndarray:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return points @ np.array([(c, s, 0), (-s, c, 0), (0, 0, 1)])


def stone(drawing: Drawing, name: str) -> np.ndarray:
    index = drawing.stones.block_id.tolist().index(name)
    start, end = drawing.stones.block_point_ptr[index : index + 2]
    return drawing.stones.points[start:end]


def test_mirrored_insert_is_the_mirror_image_with_its_faces_outward(tmp_path: Path) -> None:
    def mirror(doc: Any) -> None:
        wedge_insert(doc).dxf.update({"xscale": -1.0, "rotation": 30.0, "insert": (1.0, 2.0, 3.0)})

    drawing = read_drawing(edited(tmp_path / "a.dxf", mirror))
    assert drawing.findings.codes == ()
    np.testing.assert_allclose(stone(drawing, "wedge"), turned(WEDGE * [-1, 1, 1], 30) + np.array([1, 2, 3]), atol=1e-12)
    assert drawing.stones.volume[1] == pytest.approx(WEDGE_VOLUME, rel=1e-12)


def test_mirrored_by_extrusion(tmp_path: Path) -> None:
    # AutoCAD's MIRROR3D turns the extrusion down; object coordinates then have x against the world's.
    def mirror(doc: Any) -> None:
        wedge_insert(doc).dxf.update({"extrusion": (0, 0, -1), "insert": (-1.0, 2.0, -3.0)})

    drawing = read_drawing(edited(tmp_path / "a.dxf", mirror))
    np.testing.assert_allclose(stone(drawing, "wedge"), WEDGE * [-1, 1, -1] + [1, 2, 3], atol=1e-12)


def test_base_point_and_nested_block(tmp_path: Path) -> None:
    def nest(doc: Any) -> None:
        insert = wedge_insert(doc)
        doc.blocks.get(insert.dxf.name).block.dxf.base_point = (0.6, 0, 0)
        outer = doc.blocks.new("WALL")
        inner = outer.add_blockref(insert.dxf.name, (1, 0, 0), dxfattribs={"layer": "0", "rotation": 90})
        inner.add_attrib("ID", "inner", (0, 0))
        inner.add_attrib("MATERIAL", "stone", (0, 0))
        doc.modelspace().add_blockref("WALL", (10, 20, 30), dxfattribs={"layer": "CP-BLOCKS", "rotation": -90}).add_attrib(
            "ID", "south", (0, 0)
        )

    drawing = read_drawing(edited(tmp_path / "a.dxf", nest))
    assert drawing.stones.block_id.tolist() == ["ground", "wedge", "south/inner"]
    np.testing.assert_allclose(stone(drawing, "wedge"), WEDGE - [0.6, 0, 0], atol=1e-12)
    np.testing.assert_allclose(stone(drawing, "south/inner"), WEDGE - [0.6, 0, 0] + [10, 19, 30], atol=1e-12)


def test_array_of_inserts(tmp_path: Path) -> None:
    def array(doc: Any) -> None:
        wedge_insert(doc).dxf.rotation = 90
        wedge_insert(doc).grid((2, 3), (0.5, 1.0))

    drawing = read_drawing(edited(tmp_path / "a.dxf", array))
    assert drawing.findings.codes == ()
    assert drawing.stones.block_id.tolist() == ["ground", *(f"wedge[{i}]" for i in range(6))]
    # Rows and columns turn with the insert: columns are 1.0 apart along y, rows 0.5 apart along -x.
    corners = sorted(tuple(np.round(stone(drawing, f"wedge[{i}]")[0], 9) + 0.0) for i in range(6))
    assert corners == [(x, y, 0.0) for x in (-0.5, 0.0) for y in (0.0, 1.0, 2.0)]


@pytest.mark.parametrize(("columns", "rows"), [(0, 2), (2, 0), (-1, 1), (1, -2), (0, 0)])
def test_a_count_of_members_below_one_is_one(columns: int, rows: int, tmp_path: Path) -> None:
    path = edited(tmp_path / "a.dxf", lambda doc: wedge_insert(doc).grid((55, 77), (0.4, 0.7)))
    text = path.read_text(encoding="utf-8")
    text = text.replace("\n 70\n77\n", f"\n 70\n{columns}\n").replace("\n 71\n55\n", f"\n 71\n{rows}\n")
    path.write_text(text, encoding="utf-8")
    drawing = read_drawing(path)
    assert drawing.findings.codes == ()
    assert drawing.stones.count == 1 + max(columns, 1) * max(rows, 1)


def test_members_that_lie_on_each_other_are_one(tmp_path: Path) -> None:
    drawing = read_drawing(edited(tmp_path / "a.dxf", lambda doc: wedge_insert(doc).grid((1000, 32767), (1.0, 0.0))))
    # A thousand different places of thirty million.
    assert drawing.stones.count == 1 + 1000


@pytest.mark.parametrize("levels", [340, 1200])
def test_blocks_nested_too_deep_are_a_finding(levels: int, tmp_path: Path) -> None:
    def nest(doc: Any) -> None:
        name = wedge_insert(doc).dxf.name
        for level in range(levels):
            doc.blocks.new(f"LEVEL{level}").add_blockref(name, (0, 0, 0))
            name = f"LEVEL{level}"
        wedge_insert(doc).dxf.name = name

    path = edited(tmp_path / "a.dxf", nest)
    with pytest.raises(FindingsError, match=rf"E08 .*nested more than 50 deep, from LEVEL{levels - 1} on down"):
        read_drawing(path)


def test_even_scale_needs_no_warning_and_stretching_one(tmp_path: Path) -> None:
    def scale(*factors: float):
        return lambda doc: wedge_insert(doc).dxf.update(dict(zip(("xscale", "yscale", "zscale"), factors, strict=True)))

    even = read_drawing(edited(tmp_path / "a.dxf", scale(2, 2, -2)))
    assert (even.findings.codes, even.stones.volume[1]) == ((), pytest.approx(8 * WEDGE_VOLUME, rel=1e-12))
    uneven = read_drawing(edited(tmp_path / "b.dxf", scale(1, 2, -3)))
    assert (uneven.findings.codes, uneven.stones.volume[1]) == (("W09",), pytest.approx(6 * WEDGE_VOLUME, rel=1e-12))


def test_a_flattened_insert_is_an_error(tmp_path: Path) -> None:
    path = edited(tmp_path / "a.dxf", lambda doc: wedge_insert(doc).dxf.update({"zscale": 0.5}))
    text = path.read_text(encoding="utf-8")
    assert text.count("\n 43\n0.5\n") == 1
    path.write_text(text.replace("\n 43\n0.5\n", "\n 43\n0.0\n"), encoding="utf-8")
    with pytest.raises(FindingsError, match=r"E10 a\.dxf: INSERT #\w+: the insert has the scale 0"):
        read_drawing(path)


def definition(doc: Any) -> Any:
    return doc.blocks.get(wedge_insert(doc).dxf.name)


def faces_as_points(doc: Any) -> None:
    """CP-INTERFACE in place of CP-SOLID: the corners of each face as tagged points."""
    block = definition(doc)
    mesh = block.query("MESH").first
    corners, faces = np.array(mesh.vertices.values).reshape(-1, 3), [tuple(f) for f in mesh.faces]
    block.delete_entity(mesh)
    for number, face in enumerate(faces):
        for corner, node in enumerate(face):
            point = block.add_point(corners[node].tolist(), dxfattribs={"layer": "CP-INTERFACE"})
            point.set_xdata("CHURCHPIPE", [(1000, f"F{number}.{corner}")])


def tags_as_attributes(doc: Any) -> None:
    """Position tags as attribute definitions that lie on their points."""
    block = definition(doc)
    for point in block.query("POINT"):
        tag = point.get_xdata("CHURCHPIPE")[0].value
        point.discard_xdata("CHURCHPIPE")
        block.add_attdef(tag, point.dxf.location, "")


def polyface_body(doc: Any) -> None:
    block = definition(doc)
    mesh = block.query("MESH").first
    builder = MeshBuilder.from_mesh(mesh)
    block.delete_entity(mesh)
    builder.render_polyface(block, dxfattribs={"layer": "CP-SOLID"})


@pytest.mark.parametrize("change", [faces_as_points, tags_as_attributes, polyface_body])
def test_other_ways_to_draw_a_definition(change, tmp_path: Path) -> None:
    drawing = read_drawing(edited(tmp_path / "a.dxf", change))
    assert drawing.findings.codes == ()
    np.testing.assert_allclose(stone(drawing, "wedge"), WEDGE, atol=1e-12)
    assert drawing.stones.volume[1] == pytest.approx(WEDGE_VOLUME, rel=1e-9)


def bare_drawing(path: Path, draw) -> Path:
    document = ezdxf.new("R2010")
    document.header["$INSUNITS"] = 6
    ground = [(-1, -1, 0), (2, -1, 0), (2, 1, 0), (-1, 1, 0)]
    document.layers.add("CP-SUPPORT")
    document.modelspace().add_3dface(ground, dxfattribs={"layer": "CP-SUPPORT"})
    draw(document.modelspace())
    document.saveas(path)
    return path


def test_exploded_stones_that_touch_stay_apart_and_turn_outward(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        for left in (0.0, 0.4):
            corners, faces = box((left, 0, 0), (0.4, 0.2, 0.2))
            for number, face in enumerate(faces):
                # Every other face is drawn clockwise, as happens in exploded drawings.
                space.add_3dface([tuple(corners[node]) for node in (face if number % 2 else face[::-1])])

    drawing = read_drawing(bare_drawing(tmp_path / "a.dxf", draw))
    free = ~drawing.stones.fixed
    np.testing.assert_allclose(drawing.stones.volume[free], [0.016, 0.016], rtol=1e-12)
    np.testing.assert_allclose(drawing.stones.centroid[free], [(0.2, 0.1, 0.1), (0.6, 0.1, 0.1)], atol=1e-12)


def test_planar_acis_solid(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        builder = MeshBuilder()
        corners, faces = box((0, 0, 0), (0.5, 0.4, 0.3))
        builder.add_mesh(vertices=[Vec3(c) for c in corners], faces=[list(f) for f in faces])
        acis.export_dxf(space.add_3dsolid(), [acis.body_from_mesh(builder)])

    drawing = read_drawing(bare_drawing(tmp_path / "a.dxf", draw))
    assert set(drawing.findings.codes) == {"W19", "W22"}
    assert drawing.stones.volume[~drawing.stones.fixed] == pytest.approx(0.06, rel=1e-9)


def test_a_patch_of_ground_is_a_plate_below_it_however_it_was_drawn(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        with space.add_mesh().edit_data() as mesh:
            corners, faces = box((0, 0, 0), (0.4, 0.2, 0.2))
            mesh.vertices, mesh.faces = corners.tolist(), [list(f) for f in faces]
        down = [(3, -1, 0.5), (3, 1, 0.5), (5, 1, 0.5), (5, -1, 0.5)]
        space.add_3dface(down, dxfattribs={"layer": "CP-SUPPORT"})

    stones = read_drawing(bare_drawing(tmp_path / "a.dxf", draw)).stones
    tops = [
        stones.points[stones.block_point_ptr[i] : stones.block_point_ptr[i + 1], 2].max() for i in np.flatnonzero(stones.fixed)
    ]
    assert tops == [0.0, 0.5]
    assert (stones.volume[stones.fixed] > 0).all()


def test_hidden_stones_are_left_out_and_counted(tmp_path: Path) -> None:
    def hide(doc: Any) -> None:
        plain = doc.blocks.new("PLAIN")
        box_mesh().render_mesh(plain)
        for layer, copies, block in (("OFF", 2, "PLAIN"), ("FROZEN", 3, wedge_insert(doc).dxf.name)):
            doc.layers.add(layer)
            for _ in range(copies):
                doc.modelspace().add_blockref(block, (9, 9, 9), dxfattribs={"layer": layer})
        doc.layers.get("OFF").off()
        doc.layers.get("FROZEN").freeze()

    drawing = read_drawing(edited(tmp_path / "a.dxf", hide))
    assert drawing.stones.count == 2
    assert "left out: 5 hidden" in str(drawing.findings)


def box_mesh(x: float = 0.0) -> MeshBuilder:
    mesh = MeshBuilder()
    points, faces = box((x, 0.0, 0.0), (0.2, 0.2, 0.2))
    mesh.add_mesh(vertices=Vec3.list(points.tolist()), faces=list(faces))
    return mesh


@pytest.mark.parametrize("nested", [False, True], ids=["alone", "nested"])
@pytest.mark.parametrize("layer", ["SHOWN", "DARK", "0"])
@pytest.mark.parametrize("insert", ["SHOWN", "OFF", "FROZEN"])
def test_a_layer_that_is_off_hides_what_lies_on_it_and_a_frozen_one_inserts_with_all_they_hold(
    insert: str, layer: str, nested: bool, tmp_path: Path
) -> None:
    # As AutoCAD shows them: what lies on layer 0 in a block takes the layer of the insert.
    document = ezdxf.new("R2010", units=6)
    for name in ("SHOWN", "OFF", "FROZEN", "DARK"):
        document.layers.add(name)
    for name in ("OFF", "DARK"):
        document.layers.get(name).off()
    document.layers.get("FROZEN").freeze()
    box_mesh().render_mesh(document.blocks.new("STONE"), dxfattribs={"layer": layer})
    document.blocks.new("OUTER").add_blockref("STONE", (0, 0, 0))
    space = document.modelspace()
    space.add_blockref("OUTER" if nested else "STONE", (0, 0, 0), dxfattribs={"layer": insert})
    box_mesh(1.0).render_mesh(space)
    document.saveas(tmp_path / "layers.dxf")
    drawing = read_drawing(tmp_path / "layers.dxf", support="base", unit_weight=18e3)
    seen = insert != "FROZEN" and layer != "DARK" and (insert == "SHOWN" or layer == "SHOWN")
    assert (~drawing.stones.fixed).sum() == 1 + seen
    assert ("left out: 1 hidden" in str(drawing.findings)) == (not seen)


@pytest.mark.parametrize(("layer", "count"), [("CP-BLOCKS", 2), ("CP-SOLID", 1)])
def test_the_body_of_a_labelled_stone_is_seen_by_its_own_layer(layer: str, count: int, tmp_path: Path) -> None:
    def hide(doc: Any) -> None:
        box_mesh().render_mesh(doc.modelspace())
        doc.layers.get(layer).off()

    assert (~read_drawing(edited(tmp_path / "a.dxf", hide), support="base").stones.fixed).sum() == count


def test_a_labelled_body_that_is_hidden_hides_no_insert_beside_it_in_its_block(tmp_path: Path) -> None:
    document = ezdxf.new("R2010", units=6)
    for name in ("SHOWN", "DARK"):
        document.layers.add(name)
    document.layers.get("DARK").off()
    box_mesh().render_mesh(document.blocks.new("INNER"))
    outer = document.blocks.new("OUTER")
    box_mesh(1.0).render_mesh(outer, dxfattribs={"layer": "DARK"})
    outer.add_blockref("INNER", (3, 0, 0), dxfattribs={"layer": "SHOWN"})
    document.modelspace().add_blockref("OUTER", (0, 0, 0)).add_attrib("PANEL", "wall")
    document.saveas(tmp_path / "layers.dxf")
    drawing = read_drawing(tmp_path / "layers.dxf", support="base", unit_weight=18e3)
    assert (~drawing.stones.fixed).sum() == 1
    assert drawing.stones.points[:, 0].max() > 3
    assert "left out: 1 hidden" in str(drawing.findings)


def test_faces_of_a_plain_box_are_found_whatever_their_order(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        corners, _ = box((0, 0, 0), (0.4, 0.2, 0.2))
        with space.add_mesh().edit_data() as mesh:
            mesh.vertices, mesh.faces = corners.tolist(), [list(f)[::-1] for f in reversed(BOX_FACES)]

    drawing = read_drawing(bare_drawing(tmp_path / "a.dxf", draw), unit_weight=18e3)
    assert drawing.unweighted == ()
    assert drawing.stones.volume[~drawing.stones.fixed] == pytest.approx(0.016, rel=1e-12)


@pytest.mark.parametrize("scale", [1.0, 4.0, -4.0])
def test_a_face_just_flat_enough_in_its_block_is_split_where_an_insert_stretches_it(scale: float, tmp_path: Path) -> None:
    points, faces = box((0.0, 0.0, 0.0), (0.2, 0.2, 0.2))
    points[6, 2] += 3e-6
    document = ezdxf.new("R2010", units=6)
    mesh = MeshBuilder()
    mesh.add_mesh(vertices=Vec3.list(points.tolist()), faces=list(faces))
    mesh.render_mesh(document.blocks.new("STONE"))
    place = {"xscale": scale, "yscale": abs(scale), "zscale": abs(scale)}
    document.modelspace().add_blockref("STONE", (0, 0, 0), dxfattribs=place)
    document.saveas(tmp_path / "stone.dxf")
    drawing = read_drawing(tmp_path / "stone.dxf", support="base", unit_weight=18e3)
    # It was refused as not planar, in an insert alone.
    assert ("W10" in drawing.findings.codes) == (abs(scale) > 1)
    assert drawing.stones.volume[0] == pytest.approx(0.008 * abs(scale) ** 3, rel=1e-4)


@pytest.mark.parametrize("shown", [True, False])
def test_a_clipped_insert_is_read_whole_and_told(shown: bool, tmp_path: Path) -> None:
    def clip(doc: Any) -> None:
        clipped = XClip(wedge_insert(doc))
        clipped.set_block_clipping_path([(-1.0, -1.0), (0.1, 0.1)])
        if shown:
            clipped.disable_clipping()

    drawing = read_drawing(edited(tmp_path / "a.dxf", clip))
    assert drawing.findings.codes == (() if shown else ("W30",))
    assert drawing.stones.volume[1] == pytest.approx(WEDGE_VOLUME, rel=1e-12)
