"""Rhino 3DM: meshes, and the render meshes of solids; block instances followed, layers as materials."""

import re
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from churchpipe.findings import Finding
from churchpipe.meshes.source import Body, Face, Source, left_out, read_bytes, refused
from churchpipe.model.arrays import FloatArray, IntArray

UNITS = {"Millimeters": "mm", "Centimeters": "cm", "Decimeters": "dm", "Meters": "m", "Kilometers": "km"}
UNITS |= {"Dekameters": "dam", "Hectometers": "hm", "Microns": "um"}
UNITS |= {"Inches": "in", "Feet": "ft", "Yards": "yd", "Miles": "mi", "Mils": "mil"}
DEEPEST = 50
FIRST_LAYER = "Default"
# The chunks of a file: a type of 4 bytes, then a length of 4, since version 50 of 8 bytes.
HEADER, WIDE_SINCE, SHORT = 32, 50, 0x80000000
OBJECT_TABLE, OBJECT_RECORD, END_OF_TABLE, END_OF_FILE = 0x10000013, 0x20008070, 0xFFFFFFFF, 0x00007FFF
MESH_REMEDY = "Shade the view before you save, or turn it into a mesh with the command Mesh."


def read_3dm(path: Path) -> Source:
    """Read a 3DM: each mesh, solid and extrusion is a body by its name, its material the name of its layer.

    A body of a block without a name, or the only one of its block, has the name of the instance; one on no layer but the one that
    Rhino begins with has the layer of the instance. Of other objects on that layer the colour tells more, where it is their own.
    """
    import rhino3dm

    announced = _announced(read_bytes(path, "3dm"))
    model: Any = rhino3dm.File3dm.Read(str(path)) if announced is not None else None
    if model is None or len(model.Objects) != announced:
        held = f": {len(model.Objects)} of {announced} objects can be read" if model is not None else ", truncated or no 3DM"
        raise refused(path, "3dm", "E03", f"the file is damaged{held}", remedy="Open it in Rhino, audit it and save it again.")
    unit = UNITS.get(str(model.Settings.ModelUnitSystem).rpartition(".")[2])
    source = Source([], "3dm", unit=unit)
    others: Counter[str] = Counter()
    _Walk(source, model, others).visit([item for item in model.Objects if not _in_definition(item)], np.eye(4), 0)
    source.findings += left_out(others)
    return source


def _announced(data: bytes) -> int | None:
    """Return how many objects a file holds by its table of contents, None when its chunks do not fit together.

    The library that reads it runs for ever on some damaged files, and leaves out objects of others without a word.
    """
    begin = re.match(rb"3D Geometry File Format +(\d+)", data[:HEADER])
    if begin is None:
        return None
    wide = 8 if int(begin[1]) >= WIDE_SINCE else 4
    count, position = 0, HEADER
    while position + 4 + wide <= len(data):
        kind = int.from_bytes(data[position : position + 4], "little")
        size = int.from_bytes(data[position + 4 : position + 4 + wide], "little")
        body = position + 4 + wide
        if kind == END_OF_FILE:
            return count if int.from_bytes(data[body : body + wide], "little") == len(data) else None
        if kind == OBJECT_TABLE:
            found = _records(data[body : body + size], wide)
            if found is None:
                return None
            count += found
        # The comment that begins a file and short chunks hold their value where others hold a length.
        position = body + (0 if kind & SHORT else size)
    return None


def _records(table: bytes, wide: int) -> int | None:
    """Return the number of object records in a table, None when it does not end as it should."""
    count, position = 0, 0
    while position + 4 + wide <= len(table):
        kind = int.from_bytes(table[position : position + 4], "little")
        if kind == END_OF_TABLE:
            return count
        if kind != OBJECT_RECORD:
            return None
        position += 4 + wide + int.from_bytes(table[position + 4 : position + 4 + wide], "little")
        count += 1
    return None


@dataclass(frozen=True, slots=True)
class _Instance:
    """The instance of a block that a walk is in: its name and its layer, "" without; sole: whether its block is one object."""

    name: str = ""
    layer: str = ""
    sole: bool = False


_NONE = _Instance()


class _Walk:
    """A walk through the objects of a model, down into block definitions."""

    def __init__(self, source: Source, model: Any, others: Counter[str]) -> None:
        self._source, self._model, self._others = source, model, others
        self._by_id = {str(item.Attributes.Id): item for item in model.Objects}
        self._layers = {layer.Index: layer for layer in model.Layers}
        self._parents = {str(layer.Id): layer for layer in model.Layers}

    def visit(self, items: list[Any], matrix: FloatArray, depth: int, within: _Instance = _NONE) -> None:
        for item in items:
            layer = self._layers.get(item.Attributes.LayerIndex)
            kind = type(item.Geometry).__name__
            if not item.Attributes.Visible or self._hidden(layer):
                self._others["hidden objects"] += 1
            elif kind == "InstanceReference":
                self._follow(item, self._layer(layer, within), matrix, depth, within)
            else:
                self._add(item, kind, self._layer(layer, within) or "default", matrix, within)

    def _hidden(self, layer: Any) -> bool:
        """Return whether a layer is off, or one that it lies in."""
        passed = 0
        while layer is not None and layer.Visible and passed < DEEPEST:
            layer, passed = self._parents.get(str(layer.ParentLayerId)), passed + 1
        return layer is not None and not layer.Visible

    @staticmethod
    def _layer(layer: Any, within: _Instance) -> str:
        """Return the name of an object's own layer, or of that of its instance where it lies on none of its own."""
        own = layer.Name if layer is not None else ""
        return within.layer if own in ("", FIRST_LAYER) and within.layer else own

    def _follow(self, item: Any, layer: str, matrix: FloatArray, depth: int, within: _Instance) -> None:
        reference = item.Geometry
        definition = self._model.InstanceDefinitions.FindId(reference.ParentIdefId)
        if definition is None or depth >= DEEPEST:
            found = "an instance of a block that is not defined" if definition is None else "blocks nested too deep"
            self._source.findings.append(Finding("E06", found, "its definition", "Insert the block again, or explode it."))
            return
        inner = [self._by_id[str(key)] for key in definition.GetObjectIds() if str(key) in self._by_id]
        move = np.array([[getattr(reference.Xform, f"M{i}{j}") for j in range(4)] for i in range(4)])
        name = within.name if within.sole and within.name else item.Attributes.Name or within.name
        self.visit(inner, matrix @ move, depth + 1, _Instance(name, layer, len(inner) == 1))

    def _add(self, item: Any, kind: str, layer: str, matrix: FloatArray, within: _Instance) -> None:
        name = within.name if within.sole and within.name else item.Attributes.Name or within.name
        meshes = _meshes(item.Geometry, kind)
        if meshes is None:
            self._others[kind] += 1
            return
        label = name or str(item.Attributes.Id)[:8]
        if not meshes:
            found = f'a solid without a mesh: "{label}"'
            self._source.findings.append(Finding("E21", found, "its render mesh", MESH_REMEDY, kind, "", label))
            return
        points: list[FloatArray] = []
        faces: list[Face] = []
        for mesh in meshes:
            offset = sum(map(len, points))
            corners = [mesh.Vertices.Point3dAt(index) for index in range(len(mesh.Vertices))]
            points.append(np.array([(p.X, p.Y, p.Z) for p in corners], dtype=np.float64).reshape(-1, 3))
            for index in range(len(mesh.Faces)):
                a, b, c, d = mesh.Faces[index]
                faces.append((a + offset, b + offset, c + offset) if c == d else (a + offset, b + offset, c + offset, d + offset))
        placed = np.concatenate(points) @ matrix[:3, :3].T + matrix[:3, 3]
        material = "default" if layer == FIRST_LAYER else layer
        self._source.bodies.append(Body(placed, faces, kind, label, material, colours=_colours(item.Attributes, len(faces))))


def _meshes(geometry: Any, kind: str) -> list[Any] | None:
    """Return the meshes of an object, none where a solid has no render mesh; None for what is no solid."""
    import rhino3dm

    if kind == "Mesh":
        return [geometry]
    if kind == "Brep":
        found = [geometry.Faces[index].GetMesh(rhino3dm.MeshType.Any) for index in range(len(geometry.Faces))]
        return found if all(mesh is not None and len(mesh.Faces) for mesh in found) else []
    if kind == "Extrusion":
        mesh = geometry.GetMesh(rhino3dm.MeshType.Any)
        return [mesh] if mesh is not None and len(mesh.Faces) else []
    return None


def _colours(attributes: Any, count: int) -> IntArray | None:
    """Return the colour of an object for each of its faces (n, 3), None where it has none of its own."""
    import rhino3dm

    if attributes.ColorSource != rhino3dm.ObjectColorSource.ColorFromObject:
        return None
    return np.tile(np.array(attributes.ObjectColor[:3], dtype=np.int64), (count, 1))


def _in_definition(item: Any) -> bool:
    return bool(item.Attributes.IsInstanceDefinitionObject)
