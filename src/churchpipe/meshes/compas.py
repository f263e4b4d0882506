"""JSON of COMPAS: meshes, assemblies of blocks and models of elements, wherever in the file they stand."""

import json
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np

from churchpipe.meshes.source import Body, Face, Source, read_bytes, refused
from churchpipe.model.arrays import FloatArray

# What a mesh may stand in, with words of its own about the mesh.
_SUPPORT = "is_support"
_NAMES = ("name",)
# The ends of data types that hold a mesh.
_MESHES = ("Block", "Mesh", "Polyhedron")


@dataclass(frozen=True, slots=True)
class _Around:
    """What stands around a mesh: its key, whether it is ground, the frame that it is drawn in."""

    key: str = ""
    fixed: bool = False
    matrix: FloatArray | None = None


def read_compas(path: Path) -> Source:
    """Read the meshes of a COMPAS file; of an assembly the nodes say which blocks are supports."""
    try:
        table = json.loads(read_bytes(path, "compas").decode("utf-8-sig"), object_pairs_hook=_once)
        source = Source([], "compas")
        supports = _old_supports(table)
        lost: Counter[str] = Counter()
        for around, mesh in _meshes(table, _Around()):
            body = _body(mesh, around, supports)
            if body is None:
                lost["meshes"] += 1
            else:
                source.bodies.append(body)
    except (UnicodeDecodeError, json.JSONDecodeError) as error:
        found = f"the file is damaged or no JSON ({error})"
        raise refused(path, "compas", "E03", found, remedy="Export it again.") from error
    except RecursionError as error:
        raise refused(path, "compas", "E03", "lists or tables hundreds deep", remedy="Export it again.") from error
    if lost:
        found = f"the file is damaged: {lost['meshes']} meshes whose faces or vertices cannot be understood"
        expected = "vertices with x, y, z and faces of their keys"
        raise refused(path, "compas", "E03", found, expected=expected, remedy="Export it again.")
    return source


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Return a table; of keys given twice JSON would take the last without a word."""
    table = dict(pairs)
    if len(table) < len(pairs):
        keys = [key for key, _ in pairs]
        raise json.JSONDecodeError(f'the key "{next(key for key in keys if keys.count(key) > 1)}" is given twice', "", 0)
    return table


def _meshes(value: Any, around: _Around) -> Iterator[tuple[_Around, dict[str, Any]]]:
    """Yield each mesh with what stands around it; a table that says it is one and holds none, as it is."""
    if isinstance(value, list):
        for item in cast("list[Any]", value):
            yield from _meshes(item, around)
    if not isinstance(value, dict):
        return
    table = cast("dict[str, Any]", value)
    around = _Around(around.key, around.fixed or _is_support(table), _placed(table, around.matrix))
    if _is_mesh(table):
        yield around, table
        return
    found = False
    for key, item in table.items():
        own = key if key.isdigit() else around.key
        for each in _meshes(item, _Around(own, around.fixed, around.matrix)):
            found = True
            yield each
    if not found and str(table.get("dtype", "")).rpartition("/")[2] in _MESHES:
        yield around, table


def _is_mesh(table: dict[str, Any]) -> bool:
    # Vertices or faces without the others are a mesh too, a damaged one; vertices with edges are a graph.
    one = ("vertex" in table or "face" in table) and not ("edge" in table or "adjacency" in table)
    return one or ("vertices" in table and "faces" in table)


def _is_support(table: dict[str, Any]) -> bool:
    attributes = table.get("attributes")
    inner = attributes if isinstance(attributes, dict) else {}
    return table.get(_SUPPORT) is True or cast("dict[str, Any]", inner).get(_SUPPORT) is True


def _placed(table: dict[str, Any], outer: FloatArray | None) -> FloatArray | None:
    """Return the matrix (4, 4) that places what the table holds."""
    value: Any = table.get("transformation")
    while isinstance(value, dict):
        inner = cast("dict[str, Any]", value)
        value = inner.get("matrix", inner.get("data", inner.get("value")))
    if value is None:
        return outer
    try:
        matrix = np.array(value, dtype=np.float64)
    except (ValueError, TypeError):
        matrix = np.full((4, 4), np.nan)
    matrix = matrix if matrix.shape == (4, 4) else np.full((4, 4), np.nan)
    return matrix if outer is None else outer @ matrix


def _old_supports(table: Any) -> set[str]:
    """Return the keys of the blocks that the assembly of an older file, which stands beside them, calls supports."""
    assembly: Any = table.get("assembly") if isinstance(table, dict) else None
    nodes: Any = assembly.get("vertex", assembly.get("node")) if isinstance(assembly, dict) else None
    if not isinstance(nodes, dict):
        return set()
    return {key for key, node in cast("dict[str, Any]", nodes).items() if isinstance(node, dict) and _is_support(node)}


def _body(table: dict[str, Any], around: _Around, supports: set[str]) -> Body | None:
    try:
        points, faces = _vertices_and_faces(table)
    except (ValueError, TypeError, KeyError, OverflowError):
        return None
    if around.matrix is not None:
        points = points @ around.matrix[:3, :3].T + around.matrix[:3, 3]
    attributes: Any = table.get("attributes")
    words = cast("dict[str, Any]", attributes) if isinstance(attributes, dict) else {}
    name = next((str(words[key]) for key in _NAMES if words.get(key) not in (None, "", "Block", "Mesh")), "")
    name = name or (f"block-{around.key}" if around.key else "")
    return Body(points, faces, "mesh", name, "default", around.fixed or around.key in supports)


def _vertices_and_faces(table: dict[str, Any]) -> tuple[FloatArray, list[Face]]:
    """Return points (n, 3) and faces of a mesh, {"vertex": .., "face": ..}, or a polyhedron, {"vertices": .., "faces": ..}."""
    if "vertices" in table:
        rows = table["vertices"]
        number = {str(index): index for index in range(len(rows))}
        around = table["faces"]
    else:
        given: Any = table.get("default_vertex_attributes", table.get("dva"))
        default = {"x": 0.0, "y": 0.0, "z": 0.0} | (cast("dict[str, Any]", given) if isinstance(given, dict) else {})
        vertices: Mapping[str, Any] = table["vertex"]
        rows = [[{**default, **vertex}[axis] for axis in "xyz"] for vertex in vertices.values()]
        number = {str(key): index for index, key in enumerate(vertices)}
        around = list(table["face"].values())
    points = np.array([[float(value) for value in row] for row in rows], dtype=np.float64).reshape(-1, 3)
    faces = [tuple(number[str(key)] for key in face) for face in around]
    if not np.isfinite(points).all() or any(len(face) < 3 for face in faces):
        raise ValueError("a coordinate that is no number, or a face of two corners")
    return points, faces
