"""Stones written in the formats that people bring, for the tests of their readers."""

import json
import struct
import zipfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage

Solid = tuple[str, FloatArray, list[list[int]], bool]


def solids(stones: Assemblage) -> Iterator[Solid]:
    """Name, points, faces and whether it is fixed, of each stone."""
    for i in range(stones.count):
        start, stop = stones.block_point_ptr[i : i + 2]
        faces = [
            (stones.face_nodes[stones.face_ptr[f] : stones.face_ptr[f + 1]] - start).tolist()
            for f in range(*stones.block_face_ptr[i : i + 2])
        ]
        fixed = bool(stones.fixed[i])
        yield f"ground-{i}" if fixed else str(stones.block_id[i]), stones.points[start:stop], faces, fixed


def triangles(points: FloatArray, faces: list[list[int]]) -> list[list[int]]:
    from churchpipe.geometry.warped import triangles as split

    return [list(triangle) for face in faces for triangle in split(points, face)]


def write_obj(
    stones: Assemblage,
    path: Path,
    *,
    triangulated: bool = False,
    digits: str = ".17g",
    bend: Callable[[FloatArray], FloatArray] = np.asarray,
) -> Path:
    """bend: moves the corners; a file may hold faces that are not plane."""
    lines, offset = ["# stones", "mtllib wall.mtl"], 1
    for name, corners, faces, _ in solids(stones):
        points = bend(corners)
        lines += [f"o {name}", "usemtl stone", *("v " + " ".join(f"{value:{digits}}" for value in point) for point in points)]
        around = triangles(points, faces) if triangulated else faces
        lines += ["f " + " ".join(str(node + offset) for node in face) for face in around]
        offset += len(points)
    path.write_text("\n".join(lines) + "\n")
    return path


def write_stl(stones: Assemblage, path: Path, *, binary: bool = False, digits: str = ".17g") -> Path:
    facets = [(name, points[t]) for name, points, faces, _ in solids(stones) for t in triangles(points, faces)]
    if binary:
        body = b"".join(struct.pack("<12fH", 0, 0, 0, *corners.ravel().astype(np.float32).tolist(), 0) for _, corners in facets)
        path.write_bytes(b"stones".ljust(80) + struct.pack("<I", len(facets)) + body)
        return path
    lines: list[str] = []
    for name, points, faces, _ in solids(stones):
        lines.append(f"solid {name}")
        for t in triangles(points, faces):
            corners = [f"vertex {x:{digits}} {y:{digits}} {z:{digits}}" for x, y, z in points[t].tolist()]
            lines += ["facet normal 0 0 0", "outer loop", *corners, "endloop", "endfacet"]
        lines.append(f"endsolid {name}")
    path.write_text("\n".join(lines) + "\n")
    return path


def write_ply(stones: Assemblage, path: Path, *, binary: bool = False) -> Path:
    parts = list(solids(stones))
    offsets = np.cumsum([0, *(len(points) for _, points, _, _ in parts)])
    points = np.concatenate([points for _, points, _, _ in parts])
    faces = [[node + int(o) for node in face] for (_, _, around, _), o in zip(parts, offsets, strict=False) for face in around]
    kind = "binary_little_endian" if binary else "ascii"
    header = f"ply\nformat {kind} 1.0\ncomment stones\nelement vertex {len(points)}\nproperty double x\nproperty double y\n"
    header += f"property double z\nelement face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    if binary:
        body = points.astype("<f8").tobytes() + b"".join(struct.pack(f"<B{len(f)}i", len(f), *f) for f in faces)
    else:
        rows = [" ".join(map(repr, point)) for point in points.tolist()] + [" ".join(map(str, [len(f), *f])) for f in faces]
        body = ("\n".join(rows) + "\n").encode()
    path.write_bytes(header.encode() + body)
    return path


def write_glb(stones: Assemblage, path: Path, colours: Sequence[tuple[int, int, int]] = (), by: str = "vertices") -> Path:
    import trimesh.visual.material

    scene = trimesh.Scene()
    for number, (name, points, faces, _) in enumerate(solids(stones)):
        # y is up in the format.
        mesh: Any = trimesh.Trimesh(points[:, [0, 2, 1]] * [1, 1, -1], triangles(points, faces), process=False)
        if colours and by == "vertices":
            mesh.visual.vertex_colors = colours[number]
        elif colours:
            stuff = trimesh.visual.material.PBRMaterial(baseColorFactor=[*colours[number], 255])
            mesh.visual = trimesh.visual.TextureVisuals(material=stuff)
        scene.add_geometry(mesh, node_name=name, geom_name=name)
    path.write_bytes(scene.export(file_type="glb"))
    return path


# The units of 3MF, m.
METRES = {"micron": 1e-6, "millimeter": 1e-3, "centimeter": 0.01, "inch": 0.0254, "foot": 0.3048, "meter": 1.0}


def write_3mf(stones: Assemblage, path: Path, *, unit: str = "millimeter") -> Path:
    factor = 1 / METRES.get(unit, 1.0)
    objects, items = [], []
    for number, (name, points, faces, _) in enumerate(solids(stones), 1):
        # The build plate places each object: it is written around its first corner.
        local, at = (points - points[0]) * factor, (points[0] * factor).tolist()
        vertices = "".join(f'<vertex x="{x!r}" y="{y!r}" z="{z!r}"/>' for x, y, z in local.tolist())
        around = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in triangles(points, faces))
        mesh = f"<mesh><vertices>{vertices}</vertices><triangles>{around}</triangles></mesh>"
        objects.append(f'<object id="{number}" type="model" name="{name}">{mesh}</object>')
        items.append(f'<item objectid="{number}" transform="1 0 0 0 1 0 0 0 1 {at[0]!r} {at[1]!r} {at[2]!r}"/>')
    core = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
    model = f'<?xml version="1.0"?><model unit="{unit}" xmlns="{core}"><resources>{"".join(objects)}</resources>'
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("3D/3dmodel.model", f"{model}<build>{''.join(items)}</build></model>")
    return path


def write_3dm(stones: Assemblage, path: Path, colours: Sequence[tuple[int, int, int]] = ()) -> Path:
    import rhino3dm as untyped

    # Its stubs take what can be set for read-only.
    rhino3dm: Any = untyped
    model = rhino3dm.File3dm()
    model.Settings.ModelUnitSystem = rhino3dm.UnitSystem.Meters
    for number, (name, points, faces, _) in enumerate(solids(stones)):
        mesh = rhino3dm.Mesh()
        mesh.Vertices.UseDoublePrecisionVertices = True
        for x, y, z in points.tolist():
            mesh.Vertices.AddPoint3d(x, y, z)
        for face in faces:
            for part in [face] if len(face) <= 4 else triangles(points, [face]):
                mesh.Faces.AddFace(*part)
        attributes = rhino3dm.ObjectAttributes()
        attributes.Name = name
        if colours:
            attributes.ColorSource, attributes.ObjectColor = rhino3dm.ObjectColorSource.ColorFromObject, (*colours[number], 255)
        model.Objects.AddMesh(mesh, attributes)
    assert model.Write(str(path), 8)
    return path


def write_compas(stones: Assemblage, path: Path, *, old: bool = False) -> Path:
    nodes, meshes = {}, {}
    for number, (_, points, faces, fixed) in enumerate(solids(stones)):
        vertex = {str(i): {"x": x, "y": y, "z": z} for i, (x, y, z) in enumerate(points.tolist())}
        mesh = {"attributes": {"name": "Block"}, "vertex": vertex, "face": {str(k): face for k, face in enumerate(faces)}}
        meshes[str(number)] = mesh | {"face": {str(k): [str(node) for node in face] for k, face in enumerate(faces)}}
        block = {"dtype": "compas_assembly.datastructures/Block", "data": mesh}
        nodes[str(number)] = {"x": 0.0, "is_support": fixed} | ({} if old else {"block": block})
    if old:
        table: object = {"assembly": {"attributes": {}, "vertex": nodes, "edge": {}}, "blocks": meshes}
    else:
        graph = {"dtype": "compas.datastructures/Graph", "data": {"attributes": {}, "node": nodes, "edge": {}}}
        table = {"dtype": "compas_assembly.datastructures/Assembly", "data": {"attributes": {}, "graph": graph}}
    path.write_text(json.dumps(table))
    return path


def fortran(value: float) -> str:
    """A number as 0.4555020D+02, eight digits more than the program writes."""
    mantissa, exponent = f"{value:.15E}".split("E")
    return f"{mantissa}D{int(exponent):+03d}"


def write_lmgc90(stones: Assemblage, folder: Path, *, moved: bool = True) -> Path:
    """BODIES.DAT with bodies around their centroids, turned by 90 degrees; DOF.INI turns them back and sets them in place."""
    folder.mkdir(exist_ok=True)
    bodies, places, driven = ["! File BODIES", ""], ["! DOF", "$steps      0                time= 0.0000000D+00", ""], [""]
    for number, (_, points, faces, fixed) in enumerate(solids(stones), 1):
        centre = stones.centroid[number - 1]
        local = points - centre
        local = local @ np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]) if moved else local
        node = centre - [1, 0, 0] if moved else centre
        around = triangles(points, faces)
        head = ["$bdyty", f" RBDY3  {number:5d}"]
        bodies += [*head, "$blmty", " PLAIN      1  behav  STONE  avrd= 0.1D+01  gyrd= 0.1D+01", "$nodty"]
        bodies += [" NO6xx      1                " + "  ".join(f"coo{k + 1}={fortran(v)}" for k, v in enumerate(node.tolist()))]
        bodies += ["                             coo4= 0.0D+00  coo5= 0.0D+00  coo6= 0.0D+00", "$tacty"]
        bodies += [f" POLYR      1  color  BLEUx  nb_vertex={len(points):5d}      nb_face={len(around):5d}"]
        bodies += [" " * 29 + "  ".join(f"coo{k + 1}={fortran(v)}" for k, v in enumerate(row)) for row in local.tolist()]
        bodies += [" " * 29 + "  ".join(f"ver{k + 1}= {node + 1:<14d}" for k, node in enumerate(face)) for face in around]
        bodies += ["$$$$$$", ""]
        if moved:
            places += [*head, "$nodty", " NO6xx      1                X(1)= 0.1D+01  X(2)= 0.0D+00  X(3)= 0.0D+00"]
            places += [" " * 29 + "a(1)= 0.0D+00  a(2)= 0.1D+01  a(3)= 0.0D+00"]
            places += [" " * 29 + "b(1)=-0.1D+01  b(2)= 0.0D+00  b(3)= 0.0D+00"]
            places += [" " * 29 + "g(1)= 0.0D+00  g(2)= 0.0D+00  g(3)= 0.1D+01", "$$$$$$"]
        if fixed:
            driven += [*head, "$nodty", " NO6xx      1", "$dofty  [CT......+......AMP]"]
            driven += [f" vlocy      {k}  0.0000000D+00  0.0000000D+00" for k in range(1, 7)] + ["$$$$$$"]
    (folder / "BODIES.DAT").write_text("\n".join(bodies) + "\n")
    (folder / "DRV_DOF.DAT").write_text("\n".join(driven) + "\n")
    if moved:
        (folder / "DOF.INI").write_text("\n".join(places) + "\n")
    return folder / "BODIES.DAT"


def write_3dec(stones: Assemblage, path: Path, *, version: int = 7) -> Path:
    lines = ["; stones", "model new" if version == 7 else "new"]
    for number, (_, points, faces, fixed) in enumerate(solids(stones), 1):
        # Clockwise from outside, as the program wants them.
        around = [[points[node].tolist() for node in face[::-1]] for face in faces]
        if version == 7:
            corners = [" ".join(f"({x!r},{y!r},{z!r})" for x, y, z in face) for face in around]
            lines += [f"block create polyhedron group 'stone{number}' ..."]
            lines += [f"  face {face}" + (" ..." if k + 1 < len(corners) else "") for k, face in enumerate(corners)]
            lines += [f"block fix range group 'stone{number}'"] if fixed else []
        else:
            corners = [" ".join(f"{x!r},{y!r},{z!r}" for x, y, z in face) for face in around]
            lines += [f"poly reg {number} mat 1 " + " &\n  ".join(f"face {face}" for face in corners)]
            lines += [f"fix range region {number}"] if fixed else []
    path.write_text("\n".join([*lines, "prop mat 1 density 2000", ""]))
    return path


def write_folder(stones: Assemblage, folder: Path) -> Path:
    folder.mkdir(exist_ok=True)
    for name, points, faces, _ in solids(stones):
        write_obj(Assemblage.from_polyhedra([(points, faces)], 1.0), folder / f"{name}.obj")
    return folder


WRITERS: dict[str, Callable[[Assemblage, Path], Path]] = {
    "obj": lambda stones, folder: write_obj(stones, folder / "wall.obj"),
    "obj-triangles": lambda stones, folder: write_obj(stones, folder / "wall.obj", triangulated=True),
    "stl": lambda stones, folder: write_stl(stones, folder / "wall.stl"),
    "ply": lambda stones, folder: write_ply(stones, folder / "wall.ply"),
    "ply-binary": lambda stones, folder: write_ply(stones, folder / "wall.ply", binary=True),
    "stl-binary": lambda stones, folder: write_stl(stones, folder / "wall.stl", binary=True),
    "glb": lambda stones, folder: write_glb(stones, folder / "wall.glb"),
    "3mf": lambda stones, folder: write_3mf(stones, folder / "wall.3mf"),
    "3dm": lambda stones, folder: write_3dm(stones, folder / "wall.3dm"),
    "compas": lambda stones, folder: write_compas(stones, folder / "wall.json"),
    "compas-old": lambda stones, folder: write_compas(stones, folder / "wall.json", old=True),
    "lmgc90": lambda stones, folder: write_lmgc90(stones, folder / "DATBOX"),
    "3dec": lambda stones, folder: write_3dec(stones, folder / "wall.3ddat"),
    "3dec-5": lambda stones, folder: write_3dec(stones, folder / "wall.dat", version=5),
    "folder": lambda stones, folder: write_folder(stones, folder / "stones"),
}


def fuzz_wall() -> Assemblage:
    """Twelve bricks in four courses on a plate, sizes with an exact binary form."""
    from solids import box

    bricks = [
        box((x + 0.125 * (z % 2), x + 0.25 + 0.125 * (z % 2)), (0, 0.125), (0.125 * z, 0.125 * z + 0.125))
        for z in range(4)
        for x in (0, 0.25, 0.5)
    ]
    return Assemblage.from_polyhedra([box((-1, 2), (-1, 1), (-0.5, 0)), *bricks], 18e3, fixed=[0])


def write_dxf_outlines(stones: Assemblage, folder: Path) -> Path:
    """The faces that look to -y as polylines with the depth as their DXF thickness, the ground on its layer."""
    import ezdxf

    document = ezdxf.new("R2010", units=6)
    for layer in ("WALL", "GROUND"):
        document.layers.add(layer)
    for _, points, _, fixed in solids(stones):
        (x, y, z), (right, back, top) = points.min(axis=0), points.max(axis=0)
        line = document.modelspace().add_lwpolyline([(x, z), (right, z), (right, top), (x, top)], close=True)
        line.dxf.layer, line.dxf.thickness = ("GROUND" if fixed else "WALL"), back - y
    document.saveas(folder / "wall.dxf")
    return folder / "wall.dxf"


def write_dxf_solids(stones: Assemblage, folder: Path) -> Path:
    """Meshes and polyface meshes in turn, as they come from an exploded drawing; the ground on its layer."""
    import ezdxf
    from ezdxf.render import MeshBuilder

    document = ezdxf.new("R2010", units=6)
    document.layers.add("CP-SUPPORT")
    for number, (_, points, faces, fixed) in enumerate(solids(stones)):
        builder = MeshBuilder()
        builder.add_mesh(vertices=points.tolist(), faces=faces)
        attributes = {"layer": "CP-SUPPORT" if fixed else "0"}
        render = builder.render_mesh if number % 2 else builder.render_polyface
        render(document.modelspace(), dxfattribs=attributes)
    document.saveas(folder / "wall.dxf")
    return folder / "wall.dxf"


def write_dxf_drawing(stones: Assemblage, folder: Path) -> Path:
    from churchpipe.dxf.writer import write_dxf

    write_dxf(stones, folder / "wall.dxf")
    return folder / "wall.dxf"


DXF_WRITERS: dict[str, Callable[[Assemblage, Path], Path]] = {
    "dxf": write_dxf_drawing,
    "dxf-outlines": write_dxf_outlines,
    "dxf-solids": write_dxf_solids,
}
