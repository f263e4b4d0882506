"""Stones to a drawing: one block definition for each recurrent stone, one insert with short attributes for each stone."""

import io
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal, cast

import numpy as np
from ezdxf import filemanagement

from churchpipe.dxf import schema
from churchpipe.dxf.carried import Drawn, inserts_of
from churchpipe.dxf.properties import encode_loads, encode_materials
from churchpipe.dxf.recurrence import Recurrence, Shape, find_recurrence
from churchpipe.errors import InputError
from churchpipe.model.arguments import check_kind, describe, listed, path_of
from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.carried import LineLoad
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import Material
from churchpipe.model.tie_bars import TieBar


def write_dxf(
    assemblage: Assemblage,
    path: str | os.PathLike[str],
    *,
    materials: Sequence[Material] = (),
    loads: Sequence[LoadCase] = (),
    ties: Sequence[TieBar] = (),
    line_loads: Sequence[LineLoad] = (),
    units: Literal["m", "mm"] = "m",
) -> None:
    """Write an assemblage as a drawing (churchpipe DXF 1, AutoCAD R2010).

    `read_drawing` gives back the same stones in the same order to 1e-12 m, the materials and the loads. A drawing says what
    stones are made of; their unit weight travels with `materials`, without them it is lost.

    Parameters
    ----------
    assemblage
        The stones.
    path
        The drawing to write; a folder of it that is missing is made.
    materials
        Unit weight and strength of what the stones are made of.
    loads
        Load cases that travel with the drawing.
    ties, line_loads
        Bars and loads along walls, drawn as lines on layers of their own.
    units
        Length unit of the drawing.

    Raises
    ------
    InputError
        A path with another ending, a name that a drawing cannot hold, a unit weight that contradicts its material, a file
        that cannot be written.
    """
    check_kind("write_dxf: assemblage", assemblage, Assemblage, remedy="derive_blocks(building) makes one.")
    path = path_of("write_dxf: path", path)
    if path.suffix.lower() not in ("", ".dxf"):
        raise InputError("write_dxf: path", "not the name of a drawing", found=path.name, expected="a name that ends in .dxf")
    materials, loads = listed("write_dxf: materials", materials, Material), listed("write_dxf: loads", loads, LoadCase)
    if not isinstance(cast("object", units), str) or units not in ("m", "mm"):
        raise InputError("units", "not a unit drawings are written in", found=describe(units), expected='"m" or "mm"')
    _check_weights(assemblage, materials)
    names = [load.name for load in loads]
    if len(set(names)) != len(names):
        raise InputError("loads", "names are not unique", found=names)
    drawn = inserts_of(assemblage, listed("write_dxf: ties", ties, TieBar), listed("write_dxf: line_loads", line_loads, LineLoad))
    properties = [*encode_materials(materials), *encode_loads(loads)]
    document = _new_document(units, properties)
    recurrence = find_recurrence(assemblage)
    scale = 1.0 / schema.metres(units)
    optional = [schema.PANEL_NAME] if (assemblage.panel != "").any() else []
    optional += [schema.COURSE] if assemblage.coursed.any() else []
    optional += [schema.BUTTS] if assemblage.butts.any() else []
    for number, shape in enumerate(recurrence.shapes):
        _add_definition(document, f"{schema.BLOCK_PREFIX}{number + 1}", shape, scale, optional)
    for number, one in enumerate(drawn):
        _add_line(document, f"{schema.LINE_PREFIX}{number + 1}", one, scale)
    _save(document, _inserts(document, assemblage, recurrence, scale), path)


def _check_weights(stones: Assemblage, materials: Sequence[Material]) -> None:
    names = [material.name for material in materials]
    if len(set(names)) != len(names):
        raise InputError("materials", "names are not unique", found=names)
    for material in materials:
        own = stones.unit_weight[~stones.fixed & (stones.material == material.name)]
        off = own[np.abs(own - material.unit_weight) > 1e-9 * material.unit_weight]
        if len(off):
            raise InputError(
                f"material {material.name}: unit_weight",
                "contradicts the stones made of it",
                found=f"{off[0]:g} N/m3 in a stone",
                expected=f"{material.unit_weight:g} N/m3",
                remedy="A drawing stores one unit weight a material: give these stones a material of their own.",
            )


def _new_document(units: str, properties: Sequence[tuple[str, str]]) -> Any:
    document: Any = filemanagement.new(schema.DXF_VERSION)
    document.header["$INSUNITS"] = schema.UNITS[units][0]
    document.header["$MEASUREMENT"] = 1
    document.appids.add(schema.APPID)
    for layer, colour in schema.LAYERS.items():
        document.layers.add(layer, color=colour)
    store = document.header.custom_vars
    for tag, value in ((schema.SCHEMA_PROPERTY, str(schema.VERSION)), (schema.UNITS_PROPERTY, units), *properties):
        store.append(tag, value)
    return document


def _add_definition(document: Any, name: str, shape: Shape, scale: float, optional: Sequence[str]) -> None:
    points = shape.points * scale
    stone = Assemblage.from_polyhedra([(points, shape.faces)], unit_weight=1.0)
    block = document.blocks.new(name)
    with block.add_mesh(dxfattribs={"layer": schema.SOLID}).edit_data() as data:
        data.vertices = points.tolist()
        data.faces = [list(face) for face in shape.faces]
    tagged = [(schema.VERTEX, f"V{i}", point) for i, point in enumerate(points)]
    tagged.append((schema.CENTROID, schema.CENTROID_TAG, stone.centroid[0]))
    for layer, tag, place in tagged:
        block.add_point(place.tolist(), dxfattribs={"layer": layer}).set_xdata(schema.APPID, [(1000, tag)])
    height = 0.1 * float(np.ptp(points, axis=0).max())
    constant = {schema.VOLUME: f"{stone.volume[0]:.12g}", schema.NFACES: str(len(shape.faces))}
    variable = dict.fromkeys((schema.ID, schema.MATERIAL, *optional), "")
    for tag, text in {**constant, **variable}.items():
        attribute = block.add_attdef(tag, stone.centroid[0].tolist(), text, height=height, dxfattribs={"layer": schema.BLOCKS})
        attribute.is_const = tag in constant
        attribute.is_invisible = True


def _add_line(document: Any, name: str, one: Drawn, scale: float) -> None:
    """Add a tie or a line load: a block with its line, inserted where it begins, its attributes beside it."""
    assert one.ends is not None
    first, last = one.ends * scale
    block = document.blocks.new(name)
    block.add_line((0.0, 0.0, 0.0), (last - first).tolist(), dxfattribs={"layer": one.layer})
    insert = document.modelspace().add_blockref(name, first.tolist(), dxfattribs={"layer": one.layer})
    for tag, text in one.texts.items():
        block.add_attdef(tag, (0.0, 0.0, 0.0), text="", dxfattribs={"layer": one.layer}).is_invisible = True
        insert.add_attrib(tag, text, first.tolist(), dxfattribs={"layer": one.layer}).is_invisible = True


def _inserts(document: Any, stones: Assemblage, recurrence: Recurrence, scale: float) -> str:
    """Return the inserts of all stones as DXF text: building them as entities of ezdxf would take ten times longer."""
    owner, handles = document.modelspace().layout_key, document.entitydb.handles
    place: FloatArray = recurrence.place * scale
    parts: list[str] = []
    for index, (x, y, z) in enumerate(place.tolist()):
        layer = schema.SUPPORT if stones.fixed[index] else schema.BLOCKS
        common = f"330\n{owner}\n100\nAcDbEntity\n  8\n{layer}\n"
        where = f" 10\n{x}\n 20\n{y}\n 30\n{z}\n"
        turn = f" 50\n{float(recurrence.turn[index])}\n" if recurrence.turn[index] else ""
        handle, end = handles.next(), handles.next()
        name = f"{schema.BLOCK_PREFIX}{recurrence.shape[index] + 1}"
        parts.append(f"  0\nINSERT\n  5\n{handle}\n{common}100\nAcDbBlockReference\n 66\n1\n  2\n{name}\n{where}{turn}")
        texts = {schema.ID: str(stones.block_id[index]), schema.MATERIAL: str(stones.material[index])}
        if stones.panel[index]:
            texts[schema.PANEL_NAME] = str(stones.panel[index])
        if stones.course[index] >= 0:
            texts[schema.COURSE] = str(stones.course[index])
        if stones.butts[index]:
            texts[schema.BUTTS] = "1"
        for tag, text in texts.items():
            text = schema.check_text(f"stone {stones.block_id[index]}: {tag}", text)
            parts.append(f"  0\nATTRIB\n  5\n{handles.next()}\n{common}100\nAcDbText\n{where} 40\n2.5\n  1\n{text}\n")
            parts.append(f"100\nAcDbAttribute\n  2\n{tag}\n 70\n1\n")
        parts.append(f"  0\nSEQEND\n  5\n{end}\n330\n{handle}\n100\nAcDbEntity\n  8\n{layer}\n")
    return "".join(parts)


def _save(document: Any, inserts: str, path: Path) -> None:
    """Write under a temporary name and rename, so that a killed run leaves no half of a drawing; folders are made as needed."""
    # The system's own tests take any name; those of Path raise on one that is too long.
    if os.path.exists(path) and not os.path.isfile(path):
        raise InputError(str(path), "the drawing cannot be written", found="a folder or a device", expected="the name of a file")
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            with temporary.open("w", encoding="utf-8", errors="dxfreplace", newline="\n") as stream:
                text = io.StringIO()
                document.write(text)
                before, entities, after = text.getvalue().partition("\n  2\nENTITIES\n")
                stream.writelines((before, entities, inserts, after))
            temporary.replace(path)
        finally:
            temporary.unlink(missing_ok=True)
    except OSError as error:
        raise InputError(
            str(path), "the drawing cannot be written", found=error.strerror or str(error), remedy="Choose another place."
        ) from error
