"""Damaged drawings: the small sample wall with one thing wrong, and the codes that answer it."""

import io
import re
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import ezdxf
from ezdxf.math import Vec3
from ezdxf.render.mesh import MeshBuilder

from dxf_models import BOX_FACES, box

SAMPLES = Path(__file__).parents[1] / "cad_samples"
Edit = Callable[[Any], None]

# Name of a damage -> the codes that answer it.
DAMAGES: dict[str, set[str]] = {
    "truncated": {"E03"},
    "comma_coordinate": {"E03"},
    "double_handle": {"E03"},
    "empty": {"E01"},
    "not_dxf": {"E01"},
    "dwg": {"E02"},
}
_EDITS: dict[str, Edit] = {}


def damage(*codes: str) -> Callable[[Edit], Edit]:
    """Register an edit of the sound drawing as a damage."""

    def register(edit: Edit) -> Edit:
        DAMAGES[edit.__name__] = set(codes)
        _EDITS[edit.__name__] = edit
        return edit

    return register


def write_damaged(folder: Path) -> None:
    """Write each damaged drawing as NAME.dxf."""
    text = sound_text()
    for name, edit in _EDITS.items():
        doc = ezdxf.read(io.StringIO(text))
        edit(doc)
        doc.saveas(folder / f"{name}.dxf")
    middle = text.index("ENTITIES") + 2000
    (folder / "truncated.dxf").write_text(text[:middle], encoding="utf-8")
    (folder / "comma_coordinate.dxf").write_text(text.replace("\n 10\n0.4\n", "\n 10\n0,4\n"), encoding="utf-8")
    inserts = re.findall(r"INSERT\n  5\n\w+\n", text)
    (folder / "double_handle.dxf").write_text(text.replace(inserts[2], inserts[1]), encoding="utf-8")
    (folder / "empty.dxf").write_bytes(b"")
    (folder / "not_dxf.dxf").write_text("Stones of the south wall, see the other sheet.\n", encoding="utf-8")
    (folder / "dwg.dxf").write_bytes(b"AC1032" + bytes(58))


@cache
def sound_text() -> str:
    """Return the drawing that all of them start from."""
    return (SAMPLES / "sound.dxf").read_text(encoding="utf-8")


def _stones(doc: Any) -> list[Any]:
    return [insert for insert in doc.modelspace().query("INSERT") if insert.dxf.layer == "CP-BLOCKS"]


def _attribute(insert: Any, tag: str, text: str | None) -> None:
    insert.delete_attrib(tag, ignore=True)
    if text is not None:
        insert.add_attrib(tag, text, insert.dxf.insert)


def _brick(doc: Any) -> Any:
    return doc.blocks.get(_stones(doc)[0].dxf.name)


@damage("E04")
def no_units(doc: Any) -> None:
    """$INSUNITS is 0."""
    doc.header["$INSUNITS"] = 0


@damage("E05")
def wrong_units(doc: Any) -> None:
    """Drawn in metres, flagged as inches."""
    doc.header["$INSUNITS"] = 1
    doc.header.custom_vars.remove("CP_UNITS")


@damage("E05")
def relabelled_units(doc: Any) -> None:
    """$INSUNITS was changed after the drawing was written."""
    doc.header["$INSUNITS"] = 2


@damage("E06")
def undefined_block(doc: Any) -> None:
    """The definition of an insert is missing."""
    _stones(doc)[1].dxf.name = "CP_Q99"


@damage("E07")
def decimal_comma(doc: Any) -> None:
    """Attribute VOLUME of an insert is "0,016"."""
    _attribute(_stones(doc)[1], "VOLUME", "0,016")
    next(a for a in _brick(doc).attdefs() if a.dxf.tag == "VOLUME").is_const = False


@damage("E07")
def decimal_comma_in_block(doc: Any) -> None:
    """The same in the definition."""
    next(a for a in _brick(doc).attdefs() if a.dxf.tag == "VOLUME").dxf.text = "0,016"


@damage("E07")
def bad_course(doc: Any) -> None:
    """Attribute COURSE is a word."""
    _attribute(_stones(doc)[1], "COURSE", "first")


@damage("E08")
def cyclic_blocks(doc: Any) -> None:
    """Two blocks contain each other."""
    outer, inner = doc.blocks.new("WALL"), doc.blocks.new("LEAF")
    outer.add_blockref("LEAF", (0, 0, 0))
    inner.add_blockref("WALL", (0, 0, 0))
    doc.modelspace().add_blockref("WALL", (0, 0, 1), dxfattribs={"layer": "CP-BLOCKS"})


@damage("E09", "W09")
def skewed_insert(doc: Any) -> None:
    """A turned stone in a block stretched along x."""
    doc.blocks.new("STRETCHED").add_blockref(_brick(doc).name, (0, 0, 0), dxfattribs={"rotation": 30})
    doc.modelspace().add_blockref("STRETCHED", (0, 0, 0.4), dxfattribs={"layer": "CP-BLOCKS", "xscale": 2.0})


@damage("W09")
def stretched_insert(doc: Any) -> None:
    """A stone inserted 1.5 times as high."""
    _stones(doc)[2].dxf.zscale = 1.5


@damage("E10")
def open_body(doc: Any) -> None:
    """A face of the body is missing."""
    with _brick(doc).query("MESH").first.edit_data() as mesh:
        mesh.faces = list(mesh.faces)[:-1]


@damage("E10")
def doubled_face(doc: Any) -> None:
    """A face of the body is given twice."""
    with _brick(doc).query("MESH").first.edit_data() as mesh:
        mesh.faces = [*mesh.faces, mesh.faces[0]]


@damage("W10")
def warped_face(doc: Any) -> None:
    """A face is not planar."""
    block = _brick(doc)
    with block.query("MESH").first.edit_data() as mesh:
        mesh.vertices[6] = (0.4, 0.2, 0.21)
    block.query("POINT")[6].dxf.location = (0.4, 0.2, 0.21)


@damage("E10")
def no_body(doc: Any) -> None:
    """A definition without faces."""
    block = _brick(doc)
    block.delete_entity(block.query("MESH").first)


@damage("E10")
def moved_vertex(doc: Any) -> None:
    """A vertex point is not on its corner."""
    _brick(doc).query("POINT")[6].dxf.location = (0.4, 0.2, 0.25)


@damage("E10")
def far_vertex(doc: Any) -> None:
    """A vertex point is where no building is."""
    _brick(doc).query("POINT")[6].dxf.location = (1e308, 0.2, 0.25)


@damage("E10")
def missing_vertex(doc: Any) -> None:
    """Position tag V3 is missing."""
    block = _brick(doc)
    block.delete_entity(block.query("POINT")[3])


@damage("E11")
def duplicate_stone(doc: Any) -> None:
    """A stone copied onto itself."""
    copy = _stones(doc)[1].copy()
    doc.modelspace().add_entity(copy)
    _attribute(copy, "ID", "copy")


@damage("E12")
def no_support(doc: Any) -> None:
    """No ground."""
    doc.modelspace().delete_entity(doc.modelspace().query("INSERT").first)


@damage("W13", "W19")
def missing_attributes(doc: Any) -> None:
    """No ID, MATERIAL and VOLUME."""
    for tag in ("ID", "MATERIAL"):
        _attribute(_stones(doc)[0], tag, None)
    block = _brick(doc)
    block.delete_entity(next(a for a in block.attdefs() if a.dxf.tag == "VOLUME"))


@damage("W14")
def wrong_volume(doc: Any) -> None:
    """Attribute VOLUME contradicts the faces."""
    next(a for a in _brick(doc).attdefs() if a.dxf.tag == "VOLUME").dxf.text = "0.0141"


@damage("W15")
def shared_id(doc: Any) -> None:
    """Two stones with one ID."""
    _attribute(_stones(doc)[2], "ID", "left")


@damage("E16", "W19")
def bad_material(doc: Any) -> None:
    """The stored material has a decimal comma."""
    doc.header.custom_vars.replace("CP_MATERIAL_stone", '{"unit_weight_kN_m3": "18,0", "friction": 0.6}')


@damage("W19")
def no_unit_weight(doc: Any) -> None:
    """The material is not stored."""
    doc.header.custom_vars.remove("CP_MATERIAL_stone")


@damage("E17")
def no_stones(doc: Any) -> None:
    """Nothing but ground."""
    for insert in _stones(doc):
        doc.modelspace().delete_entity(insert)


@damage("W18")
def left_out(doc: Any) -> None:
    """Stones on a frozen layer, in paper space and in an external reference, and a line."""
    doc.layers.add("OLD").freeze()
    _stones(doc)[2].dxf.layer = "OLD"
    doc.layout("Layout1").add_blockref(_brick(doc).name, (0, 0))
    doc.add_xref_def("neighbour.dxf", "NEIGHBOUR")
    doc.modelspace().add_blockref("NEIGHBOUR", (5, 0))
    doc.modelspace().add_line((0, 0), (1, 0))


@damage("E20")
def newer_schema(doc: Any) -> None:
    """Written by a later version."""
    doc.header.custom_vars.replace("CP_SCHEMA", "2")


@damage("E21")
def unreadable_solid(doc: Any) -> None:
    """A 3DSOLID whose data are nonsense."""
    doc.modelspace().add_3dsolid().sat = ["no ACIS data"]


@damage("E23")
def too_many(doc: Any) -> None:
    """Arrays of arrays ask for a million stones."""
    doc.blocks.new("ROW").add_blockref(_brick(doc).name, (0, 0, 0)).grid((1000, 1), (1.0, 1.0))
    doc.modelspace().add_blockref("ROW", (0, 0, 1)).grid((1, 1000), (1.0, 1.0))


@damage("E04", "E06", "E07", "E12")
def many_errors(doc: Any) -> None:
    """No units, an undefined block, a decimal comma, a course that is a word, no support."""
    no_support(doc)
    undefined_block(doc)
    _attribute(_stones(doc)[2], "COURSE", "third")
    decimal_comma_in_block(doc)
    no_units(doc)


@damage("W19", "W22")
def solids_only(doc: Any) -> None:
    """Bare mesh, polyface mesh and 3D faces; ground is one 3D face: sound, but nameless."""
    space = doc.modelspace()
    for entity in list(space):
        space.delete_entity(entity)
    doc.header.custom_vars.clear()
    boxes = [_corners((x, 0, z)) for x, z in ((0, 0), (0.4, 0), (0.2, 0.2))]
    with space.add_mesh().edit_data() as mesh:
        mesh.vertices, mesh.faces = list(boxes[0]), list(BOX_FACES)
    _mesh_builder(boxes[1]).render_polyface(space)
    for face in BOX_FACES:
        space.add_3dface([boxes[2][node] for node in face])
    space.add_3dface([(-1, -1, 0), (2, -1, 0), (2, 1, 0), (-1, 1, 0)], dxfattribs={"layer": "CP-SUPPORT"})


@damage("E10", "W19", "W22")
def open_solid(doc: Any) -> None:
    """An exploded stone lacks a face."""
    solids_only(doc)
    space = doc.modelspace()
    space.delete_entity(space.query("3DFACE")[2])


def _mesh_builder(corners: list[tuple[float, float, float]]) -> Any:
    builder = MeshBuilder()
    builder.add_mesh(vertices=[Vec3(c) for c in corners], faces=[list(face) for face in BOX_FACES])
    return builder


def _corners(origin: tuple[float, float, float]) -> list[tuple[float, float, float]]:
    return [tuple(corner) for corner in box(origin, (0.4, 0.2, 0.2))[0].tolist()]
