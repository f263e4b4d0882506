"""Rhino 3DM: meshes, and the render meshes of solids; block instances followed, layers as materials."""

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from churchpipe.findings import Finding
from churchpipe.meshes.source import Body, Face, Source, left_out, read_bytes, refused
from churchpipe.model.arrays import FloatArray

UNITS = {"Millimeters": "mm", "Centimeters": "cm", "Decimeters": "dm", "Meters": "m", "Kilometers": "km"}
UNITS |= {"Inches": "in", "Feet": "ft", "Yards": "yd"}
DEEPEST = 50
MESH_REMEDY = "Shade the view before you save, or turn it into a mesh with the command Mesh."


def read_3dm(path: Path) -> Source:
    """Read a 3DM: each mesh, solid and extrusion is a body by its name, its material the name of its layer."""
    import rhino3dm

    read_bytes(path, "3dm")
    model: Any = rhino3dm.File3dm.Read(str(path))
    if model is None:
        raise refused(path, "3dm", "E03", "the file is damaged or no 3DM", remedy="Open it in Rhino, audit it and save it again.")
    unit = UNITS.get(str(model.Settings.ModelUnitSystem).rpartition(".")[2])
    source = Source([], "3dm", unit=unit, files=(path,))
    others: Counter[str] = Counter()
    _Walk(source, model, others).visit([item for item in model.Objects if not _in_definition(item)], np.eye(4), 0)
    source.findings += left_out(others)
    return source


class _Walk:
    """A walk through the objects of a model, down into block definitions."""

    def __init__(self, source: Source, model: Any, others: Counter[str]) -> None:
        self._source, self._model, self._others = source, model, others
        self._by_id = {str(item.Attributes.Id): item for item in model.Objects}
        self._layers = {layer.Index: layer for layer in model.Layers}

    def visit(self, items: list[Any], matrix: FloatArray, depth: int) -> None:
        for item in items:
            layer = self._layers.get(item.Attributes.LayerIndex)
            kind = type(item.Geometry).__name__
            if not item.Attributes.Visible or (layer is not None and not layer.Visible):
                self._others["hidden objects"] += 1
            elif kind == "InstanceReference":
                self._follow(item.Geometry, matrix, depth)
            else:
                self._add(item, kind, layer.Name if layer is not None else "default", matrix)

    def _follow(self, reference: Any, matrix: FloatArray, depth: int) -> None:
        definition = self._model.InstanceDefinitions.FindId(reference.ParentIdefId)
        if definition is None or depth >= DEEPEST:
            found = "an instance of a block that is not defined" if definition is None else "blocks nested too deep"
            self._source.findings.append(Finding("E06", found, "its definition", "Insert the block again, or explode it."))
            return
        inner = [self._by_id[str(key)] for key in definition.GetObjectIds() if str(key) in self._by_id]
        move = np.array([[getattr(reference.Xform, f"M{i}{j}") for j in range(4)] for i in range(4)])
        self.visit(inner, matrix @ move, depth + 1)

    def _add(self, item: Any, kind: str, layer: str, matrix: FloatArray) -> None:
        name = item.Attributes.Name or ""
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
        self._source.bodies.append(Body(placed, faces, kind, label, layer))


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


def _in_definition(item: Any) -> bool:
    return bool(item.Attributes.IsInstanceDefinitionObject)
