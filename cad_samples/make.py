"""Make the drawings of this folder: `python cad_samples/make.py`. The same code makes the same bytes (with the same ezdxf)."""

import io
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import ezdxf

from churchpipe.dxf.writer import write_dxf
from churchpipe.generators import arch, prototype
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import Elastic, Material
from churchpipe.stones.blocks import derive_blocks

HERE = Path(__file__).parent
BOX_FACES = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
Edit = Callable[[Any], None]

# Malena et al. 2019, section 4.1 and Table 1; lengths in m.
BRICK = Material("brick", 28.6e3, 0.7, elastic=Elastic(3.18e9, 0.23, 0.303e9, 0.3, 1e-3))
STONE = Material("stone", 18e3, 0.7)
PROTOTYPES: dict[str, tuple[dict[str, Any], LoadCase]] = {
    "s5": (
        {"main_wall_bricks": 8, "partitions_x": [0.0, 0.6], "partition_length": 0.32},
        LoadCase((0, 1, 0)),
    ),
    "s22": (
        {
            "main_wall_bricks": 14,
            "partitions_x": [0.0, 0.52, 1.08],
            "partition_length": 0.84,
            "opening": {"start": 0.12, "width": 0.16, "height_courses": 15, "lintel_bearing": 0.04},
        },
        LoadCase((0, -1, 0)),
    ),
}


def small_wall() -> Assemblage:
    """Three stones of 0.4 x 0.2 x 0.2 m on a plate: two in the first course, one across their joint."""
    brick = (0.4, 0.2, 0.2)
    boxes = [((-0.2, -0.2, -0.1), (1.2, 0.6, 0.1)), ((0, 0, 0), brick), ((0.4, 0, 0), brick), ((0.2, 0, 0.2), brick)]
    return Assemblage.from_polyhedra(
        [(_corners(origin, size), BOX_FACES) for origin, size in boxes],
        unit_weight=18e3,
        fixed=[0],
        material="stone",
        panel=["", "wall", "wall", "wall"],
        course=[-1, 0, 0, 1],
        block_id=["ground", "left", "right", "top"],
    )


def _corners(origin: tuple[float, ...], size: tuple[float, ...]) -> list[tuple[float, float, float]]:
    (x, y, z), (a, b, c) = origin, size
    plan = [(x, y), (x + a, y), (x + a, y + b), (x, y + b)]
    return [(u, v, z) for u, v in plan] + [(u, v, z + c) for u, v in plan]


def _stones(doc: Any) -> list[Any]:
    return [insert for insert in doc.modelspace().query("INSERT") if insert.dxf.layer == "CP-BLOCKS"]


def _attribute(insert: Any, tag: str, text: str | None) -> None:
    insert.delete_attrib(tag, ignore=True)
    if text is not None:
        insert.add_attrib(tag, text, insert.dxf.insert)


def _brick(doc: Any) -> Any:
    return doc.blocks.get(_stones(doc)[0].dxf.name)


def no_units(doc: Any) -> None:
    doc.header["$INSUNITS"] = 0


def wrong_units(doc: Any) -> None:
    doc.header["$INSUNITS"] = 1
    doc.header.custom_vars.remove("CP_UNITS")


def relabelled_units(doc: Any) -> None:
    doc.header["$INSUNITS"] = 2


def undefined_block(doc: Any) -> None:
    _stones(doc)[1].dxf.name = "CP_Q99"


def decimal_comma(doc: Any) -> None:
    _attribute(_stones(doc)[1], "VOLUME", "0,016")
    next(a for a in _brick(doc).attdefs() if a.dxf.tag == "VOLUME").is_const = False


def decimal_comma_in_block(doc: Any) -> None:
    next(a for a in _brick(doc).attdefs() if a.dxf.tag == "VOLUME").dxf.text = "0,016"


def bad_course(doc: Any) -> None:
    _attribute(_stones(doc)[1], "COURSE", "first")


def cyclic_blocks(doc: Any) -> None:
    outer, inner = doc.blocks.new("WALL"), doc.blocks.new("LEAF")
    outer.add_blockref("LEAF", (0, 0, 0))
    inner.add_blockref("WALL", (0, 0, 0))
    doc.modelspace().add_blockref("WALL", (0, 0, 1), dxfattribs={"layer": "CP-BLOCKS"})


def skewed_insert(doc: Any) -> None:
    doc.blocks.new("STRETCHED").add_blockref(_brick(doc).name, (0, 0, 0), dxfattribs={"rotation": 30})
    doc.modelspace().add_blockref("STRETCHED", (0, 0, 0.4), dxfattribs={"layer": "CP-BLOCKS", "xscale": 2.0})


def stretched_insert(doc: Any) -> None:
    _stones(doc)[2].dxf.zscale = 1.5


def open_body(doc: Any) -> None:
    with _brick(doc).query("MESH").first.edit_data() as mesh:
        mesh.faces = list(mesh.faces)[:-1]


def warped_face(doc: Any) -> None:
    block = _brick(doc)
    with block.query("MESH").first.edit_data() as mesh:
        mesh.vertices[6] = (0.4, 0.2, 0.21)
    block.query("POINT")[6].dxf.location = (0.4, 0.2, 0.21)


def no_body(doc: Any) -> None:
    block = _brick(doc)
    block.delete_entity(block.query("MESH").first)


def moved_vertex(doc: Any) -> None:
    _brick(doc).query("POINT")[6].dxf.location = (0.4, 0.2, 0.25)


def missing_vertex(doc: Any) -> None:
    block = _brick(doc)
    block.delete_entity(block.query("POINT")[3])


def duplicate_stone(doc: Any) -> None:
    copy = _stones(doc)[1].copy()
    doc.modelspace().add_entity(copy)
    _attribute(copy, "ID", "copy")


def no_support(doc: Any) -> None:
    doc.modelspace().delete_entity(doc.modelspace().query("INSERT").first)


def missing_attributes(doc: Any) -> None:
    for tag in ("ID", "MATERIAL"):
        _attribute(_stones(doc)[0], tag, None)
    block = _brick(doc)
    block.delete_entity(next(a for a in block.attdefs() if a.dxf.tag == "VOLUME"))


def wrong_volume(doc: Any) -> None:
    next(a for a in _brick(doc).attdefs() if a.dxf.tag == "VOLUME").dxf.text = "0.0141"


def shared_id(doc: Any) -> None:
    _attribute(_stones(doc)[2], "ID", "left")


def bad_material(doc: Any) -> None:
    doc.header.custom_vars.replace("CP_MATERIAL_stone", '{"unit_weight_kN_m3": "18,0", "friction": 0.6}')


def no_unit_weight(doc: Any) -> None:
    doc.header.custom_vars.remove("CP_MATERIAL_stone")


def no_stones(doc: Any) -> None:
    for insert in _stones(doc):
        doc.modelspace().delete_entity(insert)


def left_out(doc: Any) -> None:
    doc.layers.add("OLD").freeze()
    _stones(doc)[2].dxf.layer = "OLD"
    doc.layout("Layout1").add_blockref(_brick(doc).name, (0, 0))
    doc.add_xref_def("neighbour.dxf", "NEIGHBOUR")
    doc.modelspace().add_blockref("NEIGHBOUR", (5, 0))
    doc.modelspace().add_line((0, 0), (1, 0))


def newer_schema(doc: Any) -> None:
    doc.header.custom_vars.replace("CP_SCHEMA", "2")


def unreadable_solid(doc: Any) -> None:
    doc.modelspace().add_3dsolid().sat = ["no ACIS data"]


def too_many(doc: Any) -> None:
    doc.blocks.new("ROW").add_blockref(_brick(doc).name, (0, 0, 0)).grid((1000, 1), (1.0, 1.0))
    doc.modelspace().add_blockref("ROW", (0, 0, 1)).grid((1, 1000), (1.0, 1.0))


def many_errors(doc: Any) -> None:
    no_support(doc)
    undefined_block(doc)
    _attribute(_stones(doc)[2], "COURSE", "third")
    decimal_comma_in_block(doc)
    no_units(doc)


def solids_only(doc: Any) -> None:
    """A drawing of another program: bare meshes, polyface meshes and 3D faces, ground as one 3D face, no attributes."""
    space = doc.modelspace()
    for entity in list(space):
        space.delete_entity(entity)
    doc.header.custom_vars.clear()
    boxes = [_corners((x, 0, z), (0.4, 0.2, 0.2)) for x, z in ((0, 0), (0.4, 0), (0.2, 0.2))]
    with space.add_mesh().edit_data() as mesh:
        mesh.vertices, mesh.faces = list(boxes[0]), list(BOX_FACES)
    _mesh_builder(boxes[1]).render_polyface(space)
    for face in BOX_FACES:
        space.add_3dface([boxes[2][node] for node in face])
    space.add_3dface([(-1, -1, 0), (2, -1, 0), (2, 1, 0), (-1, 1, 0)], dxfattribs={"layer": "CP-SUPPORT"})


def open_solid(doc: Any) -> None:
    solids_only(doc)
    space = doc.modelspace()
    space.delete_entity(space.query("3DFACE")[2])


def _mesh_builder(corners: list[tuple[float, float, float]]) -> Any:
    builder = ezdxf.render.MeshBuilder()
    builder.add_mesh(vertices=[ezdxf.math.Vec3(c) for c in corners], faces=[list(face) for face in BOX_FACES])
    return builder


EDITS: tuple[Edit, ...] = (
    no_units,
    wrong_units,
    relabelled_units,
    undefined_block,
    decimal_comma,
    decimal_comma_in_block,
    bad_course,
    cyclic_blocks,
    skewed_insert,
    stretched_insert,
    open_body,
    warped_face,
    no_body,
    moved_vertex,
    missing_vertex,
    duplicate_stone,
    no_support,
    missing_attributes,
    wrong_volume,
    shared_id,
    bad_material,
    no_unit_weight,
    no_stones,
    left_out,
    newer_schema,
    unreadable_solid,
    too_many,
    many_errors,
    solids_only,
    open_solid,
)


def main() -> None:
    ezdxf.options.write_fixed_meta_data_for_testing = True
    for name, (parameters, load) in PROTOTYPES.items():
        building = prototype(name=name, materials=(BRICK,), brick=(0.08, 0.04, 0.03), courses=21, **parameters)
        write_dxf(derive_blocks(building), HERE / f"{name}.dxf", materials=[BRICK], loads=[load], units="mm")
    ring = arch(name="arch", materials=(STONE,), mean_radius=1.0, thickness=0.2, width=0.4, voussoirs=27)
    write_dxf(derive_blocks(ring), HERE / "arch.dxf", materials=[STONE], loads=[LoadCase((1, 0, 0))])
    damaged = HERE / "damaged"
    damaged.mkdir(exist_ok=True)
    base = HERE / "sound.dxf"
    write_dxf(small_wall(), base, materials=[Material("stone", 18e3, 0.6)], loads=[LoadCase((1, 0, 0))])
    text = base.read_text(encoding="utf-8")
    for edit in EDITS:
        doc = ezdxf.read(io.StringIO(text))
        edit(doc)
        doc.saveas(damaged / f"{edit.__name__}.dxf")
    middle = text.index("ENTITIES") + 2000
    (damaged / "truncated.dxf").write_text(text[:middle], encoding="utf-8")
    (damaged / "comma_coordinate.dxf").write_text(text.replace("\n 10\n0.4\n", "\n 10\n0,4\n"), encoding="utf-8")
    inserts = re.findall(r"INSERT\n  5\n\w+\n", text)
    (damaged / "double_handle.dxf").write_text(text.replace(inserts[2], inserts[1]), encoding="utf-8")
    (damaged / "empty.dxf").write_bytes(b"")
    (damaged / "not_dxf.dxf").write_text("Stones of the south wall, see the other sheet.\n", encoding="utf-8")
    (damaged / "dwg.dxf").write_bytes(b"AC1032" + bytes(58))


if __name__ == "__main__":
    main()
