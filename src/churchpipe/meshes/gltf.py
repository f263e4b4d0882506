"""glTF and GLB: the meshes of the scene, placed, y up and in metres as the format has it."""

import json
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from churchpipe.findings import FindingsError
from churchpipe.meshes.source import Body, Source, face_colours, left_out, mixed, read_bytes, refused
from churchpipe.model.arrays import FloatArray

# What trimesh and NumPy raise when a file is nonsense.
BAD_SCENE = (ValueError, TypeError, AttributeError, LookupError, ArithmeticError, AssertionError, NotImplementedError, OSError)
MAGIC, JSON_CHUNK = b"glTF", b"JSON"
# Extensions of looks, which say nothing of where a surface is; and the one that places a mesh many times in one node.
LOOKS = ("KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_", "KHR_xmp")
INSTANCING = "EXT_mesh_gpu_instancing"


def read_gltf(path: Path) -> Source:
    """Read a GLB or glTF; each node with a mesh is a body, its material the mesh's.

    A mesh has a part (primitive) for each of its materials. Parts that close are bodies, numbered; others are one together.
    """
    import trimesh

    data = read_bytes(path, "gltf")
    announced = _announced(path, data)
    try:
        scene: Any = trimesh.load_scene(path, process=False, merge_primitives=False)
        geometry: dict[str, Any] = dict(scene.geometry)
        placed = [(node, *scene.graph[node]) for node in scene.graph.nodes_geometry]
    except (*BAD_SCENE, RecursionError) as error:
        raise _damaged(path, f"{type(error).__name__} {error}") from error
    if len(placed) != announced:
        found = f"{announced} meshes stand in its nodes, and {len(placed)} of them can be read in the scene that is shown"
        remedy = "Export it again, with all that belongs to the building in one scene."
        raise refused(path, "gltf", "E03", found, expected="all of them", remedy=remedy)
    source = Source([], "gltf", unit="m", up="y")
    others: Counter[str] = Counter()
    parts: dict[str, list[Body]] = {}
    for node, matrix, name in placed:
        mesh = geometry[name]
        if not isinstance(mesh, trimesh.Trimesh):
            others["lines and points"] += 1
            continue
        corners = np.asarray(mesh.vertices, dtype=np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
        triangles = np.asarray(mesh.faces, dtype=np.int64)
        if len(triangles) and (triangles.min() < 0 or triangles.max() >= len(corners)):
            raise _damaged(path, f"a triangle of {node} has a vertex beyond the {len(corners)} there are")
        material = getattr(mesh.visual, "material", None)
        stuff = getattr(material, "name", None)
        faces = [(a, b, c) for a, b, c in triangles.tolist()]
        shades = _shades(mesh.visual, material, len(corners))
        own = face_colours(shades, faces) if shades is not None and faces else None
        # Parts of one mesh stand in nodes of their own, whose names are new at each reading.
        owner = str(scene.graph.transforms.parents[node] if mesh.metadata.get("from_gltf_primitive") else node)
        body = Body(corners, faces, "node", owner, str(stuff) if stuff else "default", colours=own)
        parts.setdefault(owner, []).append(body)
    unlike = 0
    for own in parts.values():
        bodies, strange = _bodies(own)
        source.bodies += bodies
        unlike += strange
    source.findings += mixed(unlike)
    source.findings += left_out(others)
    return source


def _bodies(parts: list[Body]) -> tuple[list[Body], int]:
    """Return the bodies that the parts of one mesh are: each of them, or all together where one is open; and how many faces have
    another material than their body."""
    if len(parts) == 1:
        return parts, 0
    if all(_closes(part) for part in parts):
        return [replace(part, name=f"{part.name}-{number}") for number, part in enumerate(parts, 1)], 0
    offset = np.cumsum([0, *(len(part.points) for part in parts)]).tolist()
    faces = [tuple(node + start for node in face) for start, part in zip(offset, parts, strict=False) for face in part.faces]
    shades = [part.colours for part in parts if part.colours is not None]
    colours = np.concatenate(shades) if len(shades) == len(parts) else None
    whole = replace(parts[0], points=np.concatenate([part.points for part in parts]), faces=faces, colours=colours)
    return [whole], sum(len(part.faces) for part in parts if part.material != whole.material)


def _closes(part: Body) -> bool:
    """Return whether every edge of a part, by the places of its ends, belongs to two of its triangles, or to four."""
    place = np.unique(part.points, axis=0, return_inverse=True)[1].reshape(-1)
    nodes = place[np.array(part.faces, dtype=np.int64).reshape(-1, 3)]
    sides = np.sort(np.concatenate([nodes[:, [0, 1]], nodes[:, [1, 2]], nodes[:, [2, 0]]]), axis=1)
    return bool((np.unique(sides, axis=0, return_counts=True)[1] % 2 == 0).all())


def _shades(visual: Any, material: Any, count: int) -> FloatArray | None:
    """Return the colours (n, 3) of the vertices, 0 to 255: their own, or that of the material; None without any."""
    if getattr(visual, "kind", None) == "vertex":
        return np.asarray(visual.vertex_colors, dtype=np.float64)[:, :3]
    base = getattr(material, "baseColorFactor", None)
    return None if base is None else np.tile(np.asarray(base, dtype=np.float64)[:3], (count, 1))


def _announced(path: Path, data: bytes) -> int:
    """Return how many primitives the nodes of the file have; a file whose meshes need an extension is refused."""
    try:
        if data.startswith(MAGIC):
            length = int.from_bytes(data[12:16], "little")
            if data[16:20] != JSON_CHUNK or int.from_bytes(data[8:12], "little") != len(data):
                raise ValueError("its length is not the one that it announces")
            data = data[20 : 20 + length]
        table = json.loads(data)
        unread = [name for name in table.get("extensionsRequired", []) if not name.startswith(LOOKS)]
        unread += [INSTANCING for node in table.get("nodes", []) if INSTANCING in node.get("extensions", {})]
        if unread:
            found = f"meshes that are not read without {', '.join(dict.fromkeys(unread))}"
            raise refused(path, "gltf", "E21", found, remedy="Export without compression, quantization and GPU instances.")
        sizes = [len(mesh["primitives"]) for mesh in table.get("meshes", [])]
        return sum(sizes[node["mesh"]] for node in table.get("nodes", []) if "mesh" in node)
    except FindingsError:
        raise
    except (ValueError, TypeError, AttributeError, LookupError, RecursionError) as error:
        raise _damaged(path, str(error)) from error


def _damaged(path: Path, found: str) -> FindingsError:
    return refused(path, "gltf", "E03", f"the file is damaged: {found}", remedy="Export it again.")
