"""The solids of a drawing: meshes, polyface meshes, bags of 3D faces and planar ACIS solids, welded and closed."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, cast

import numpy as np
from ezdxf.acis.const import AcisException
from ezdxf.acis.dxf import load_dxf
from ezdxf.acis.mesh import mesh_from_body
from ezdxf.entities.dxfentity import DXFEntity
from ezdxf.entities.mesh import Mesh
from ezdxf.entities.polyline import Polyface
from ezdxf.entities.solid import Face3d
from ezdxf.lldxf.const import DXFError
from ezdxf.render.mesh import MeshBuilder
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from churchpipe.dxf.schema import CORNER_TOLERANCE, LARGEST_COORDINATE
from churchpipe.geometry.hollows import with_voids
from churchpipe.geometry.mending import NEARLY, REPAIRS, mend
from churchpipe.geometry.parts import parts_of
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.surfaces import DOUBLED, edges, without_repeats

Faces = tuple[tuple[int, ...], ...]

# What ezdxf and NumPy raise when the data of an entity are nonsense.
BAD_ENTITY = (
    DXFError,
    AcisException,
    ValueError,
    TypeError,
    AttributeError,
    LookupError,
    ArithmeticError,
)


NOT_SANE = f"a coordinate is no number up to {LARGEST_COORDINATE:g}"


@dataclass(frozen=True, slots=True)
class Body:
    """A polyhedron in drawing units: points (n, 3) and faces as tuples of indices, outward when `flaw` is empty.

    flaw: why it is no stone ("" when it is one); spot (3,): where, as far as one point tells; warp: how far the corners of a
    face lay out of its plane before it was split into triangles, 0 when none did. voids: how many other bodies of its entity
    bound voids, in it or, of the first of several, in any of them.
    """

    points: FloatArray
    faces: Faces
    flaw: str = ""
    spot: tuple[float, float, float] | None = None
    warp: float = 0.0
    voids: int = 0

    @property
    def size(self) -> float:
        """Cube root of the volume of its box, which says how large it is even when it has a flaw."""
        return float(np.cbrt(np.prod(np.ptp(self.points, axis=0)))) if len(self.points) else 0.0


def is_sane(points: FloatArray) -> bool:
    """Are all coordinates numbers that a building can have?"""
    return bool((np.abs(points) <= LARGEST_COORDINATE).all())


def is_solid(entity: DXFEntity) -> bool:
    """Is the entity one body by itself (a 3D face is not)?"""
    return entity.dxftype() in ("MESH", "3DSOLID", "BODY") or isinstance(entity, Polyface)


def entity_bodies(entity: Any) -> list[Body]:
    """Return the bodies of a solid entity: a mesh may hold several closed ones, an ACIS solid several lumps."""
    if isinstance(entity, Mesh):
        points = np.array(entity.vertices.values, dtype=float).reshape(-1, 3)
        return _parted(points, [tuple(map(int, face)) for face in cast(list[Sequence[int]], entity.faces)])
    if isinstance(entity, Polyface):
        mesh = MeshBuilder.from_polyface(entity)
        return _parted(_points(mesh.vertices), [tuple(face) for face in mesh.faces])
    meshes = [mesh for body in load_dxf(entity) for mesh in mesh_from_body(body, merge_lumps=False)]
    return [make_body(_points(m.vertices), [tuple(f) for f in m.faces]) for m in meshes]


def smoothness(entity: Any) -> int:
    """Return how often the surface of a mesh is subdivided where it is seen; 0 where creases keep all of its edges sharp."""
    if not isinstance(entity, Mesh) or entity.dxf.subdivision_levels <= 0:
        return 0
    level = int(entity.dxf.subdivision_levels)
    faces = [tuple(map(int, face)) for face in cast(list[Sequence[int]], entity.faces)]
    drawn = {frozenset(side) for face in faces for side in zip(face, (*face[1:], face[0]), strict=True)}
    # A crease below 0 holds at any level, another one up to the level that it names.
    sharp = {
        frozenset(map(int, edge))
        for edge, crease in zip(cast(list[Sequence[int]], entity.edges), entity.creases, strict=False)
        if crease < 0 or crease >= level
    }
    return 0 if drawn <= sharp else level


def _parted(points: FloatArray, faces: list[tuple[int, ...]]) -> list[Body]:
    """Return each closed part of a mesh as a body, with the voids that other parts bound in it; the whole where one is open."""
    whole = make_body(points, faces)
    if not len(whole.points) or not is_sane(points) or max(map(max, faces)) >= len(points):
        return [whole]
    shells = parts_of(points, faces)
    parts = [[faces[number] for number in part] for part in with_voids(points, faces, shells)]
    voids = len(shells) - len(parts)
    if len(parts) < 2:
        return [replace(whole, voids=voids)]
    bodies: list[Body] = []
    for part in parts:
        used, inverse = np.unique(np.concatenate(part), return_inverse=True)
        around = np.split(inverse.ravel(), np.cumsum([len(face) for face in part])[:-1])
        bodies.append(make_body(points[used], [tuple(face.tolist()) for face in around]))
    bodies[0] = replace(bodies[0], voids=voids)
    return [whole] if any(body.flaw for body in bodies) else bodies


def make_body(points: FloatArray, faces: Iterable[Sequence[int]]) -> Body:
    """Weld, turn faces to agree with each other, split warped ones, and say what keeps the result from being a stone.

    A body that is sound as drawn is returned as drawn: same points, same order, same faces.
    """
    faces = tuple(tuple(map(int, face)) for face in faces)
    if not len(points) or not faces:
        return Body(np.zeros((0, 3)), (), "it has no faces")
    if not is_sane(points):
        return Body(np.zeros((1, 3)), (), NOT_SANE)
    if min(map(min, faces)) < 0 or max(map(max, faces)) >= len(points):
        return Body(points, faces, f"a face refers to a vertex beyond the {len(points)} there are")
    points, faces = _weld(points, faces)
    mended = mend(points, faces, repair=False)
    if mended.fault:
        spot = _place(points[mended.fault.vertex]) if faces else None
        # Faces have no numbers that the drawing would show.
        what = "" if mended.fault.problem == DOUBLED else f": {mended.fault.found}"
        return Body(points, faces, mended.fault.problem + what, spot)
    if mended.volume < 1e-12 * np.linalg.norm(np.ptp(points, axis=0)) ** 3:
        return Body(points, faces, "it has no volume", _place(points.mean(axis=0)))
    return Body(mended.points, tuple(mended.faces), warp=mended.warp)


def repaired(body: Body) -> tuple[Body, list[str]]:
    """Return a body with a flaw mended, and what was done; the body as it is, and nothing, where it cannot be mended."""
    if not body.faces or len(body.points) < 4:
        return body, []
    mended = mend(body.points, body.faces, repair=True)
    whole = make_body(mended.points, mended.faces) if mended.fault is None else body
    if whole.flaw:
        return body, []
    before, after = abs(mended.volume_before), mended.volume
    change = f"; volume {100 * (after / before - 1):+.3g} %" if before else ""
    return whole, [f"{what} ({count}){change}" for what, count in mended.changes.items() if what in REPAIRS]


def bag_bodies(faces: Sequence[Face3d]) -> tuple[list[tuple[Face3d, Body]], list[Face3d]]:
    """Sort loose 3D faces into solids; return each with its first face, and the faces that close nothing.

    Exploding a solid leaves its faces next to each other in the file, so a run of faces that closes is a stone. Shared corners
    alone would not tell stones apart that touch; where the faces of several come mixed, the side on which each is solid does.
    """
    if not faces:
        return [], []
    corners = [face_corners(face) for face in faces]
    label = _coincident(np.concatenate(corners), CORNER_TOLERANCE * float(np.median([np.ptp(c, axis=0).max() for c in corners])))
    return _closed_runs(faces, corners, label)


def nearly_closed(faces: Sequence[Face3d]) -> tuple[list[tuple[Face3d, Body, float]], list[Face3d]]:
    """Sort loose 3D faces, which close nothing as they are, into solids with corners joined that nearly meet, by as much as a
    repair joins those of other bodies; return each with its first face and how far its corners were moved at most, in drawing
    units, and the faces that still close nothing.
    """
    if not faces:
        return [], []
    corners = [face_corners(face) for face in faces]
    points = np.concatenate(corners)
    label = _coincident(points, NEARLY * float(np.median([np.linalg.norm(np.ptp(c, axis=0)) for c in corners])))
    moved = np.linalg.norm(points[label] - points, axis=1)
    ends = np.cumsum([len(c) for c in corners])
    closed, loose = _closed_runs(faces, np.split(points[label], ends[:-1]), label)
    found: list[tuple[Face3d, Body, float]] = []
    for face, body in closed:
        own = cKDTree(body.points).query(points[label])[0] == 0
        found.append((face, body, float(moved[own].max())))
    return found, loose


def _closed_runs(
    faces: Sequence[Face3d], corners: Sequence[FloatArray], label: IntArray
) -> tuple[list[tuple[Face3d, Body]], list[Face3d]]:
    """Return the bodies that runs of faces close, and the faces after the last; label (n,): which corners are one."""
    out: list[tuple[Face3d, Body]] = []
    ends = np.cumsum([len(c) for c in corners])
    open_edges: set[tuple[int, int]] = set()
    first = 0
    for number, nodes in enumerate(np.split(label, ends[:-1])):
        open_edges ^= {(min(a, b), max(a, b)) for a, b in edges(nodes.tolist()) if a != b}
        if not open_edges:
            run = range(first, number + 1)
            offsets = np.cumsum([0] + [len(corners[k]) for k in run])
            indices = [range(start, end) for start, end in pairwise(offsets)]
            out += [
                (faces[first], body) for body in _parted(np.concatenate([corners[k] for k in run]), list(map(tuple, indices)))
            ]
            first = number + 1
    return out, list(faces[first:])


def ground_plate(face: Face3d) -> list[Body]:
    """Return solids below a patch of ground: the patch (two triangles if it is not flat), thickened downwards."""
    corners = face_corners(face)
    depth = 0.1 * float(np.ptp(corners, axis=0).max())
    plates: list[Body] = []
    whole = [corners] if len(corners) == 3 or _flat(corners) else [corners[[0, 1, 2]], corners[[0, 2, 3]]]
    for patch in whole:
        normal = np.cross(patch[1] - patch[0], patch[2] - patch[0])
        length = float(np.linalg.norm(normal))
        if length == 0:
            continue
        # A level or sloping patch carries what is above it, however it was drawn; an upright one faces its own front.
        up = normal / length * (-1.0 if normal[2] < -1e-9 * length else 1.0)
        count = len(patch)
        top, bottom = tuple(range(count)), tuple(range(2 * count - 1, count - 1, -1))
        sides = [(i, (i + 1) % count, (i + 1) % count + count, i + count) for i in range(count)]
        plates.append(make_body(np.concatenate([patch, patch - depth * up]), [top, bottom, *sides]))
    return plates


def _points(vertices: Iterable[Any]) -> FloatArray:
    return np.array([(v.x, v.y, v.z) for v in vertices], dtype=float).reshape(-1, 3)


def face_corners(face: Face3d) -> FloatArray:
    """Return the corners (3, 3) or (4, 3) of a 3D face."""
    return _points(face.wcs_vertices())


def _flat(corners: FloatArray) -> bool:
    edges = corners[1:] - corners[0]
    return bool(abs(np.linalg.det(edges)) <= 1e-6 * np.linalg.norm(edges, axis=1).prod())


def _place(point: FloatArray) -> tuple[float, float, float]:
    x, y, z = point.tolist()
    return x, y, z


def _coincident(points: FloatArray, tolerance: float) -> IntArray:
    """Return the index of the first of the points that coincide with each (n,)."""
    pairs = cKDTree(points).query_pairs(tolerance, output_type="ndarray")
    count = len(points)
    if not len(pairs):
        return np.arange(count)
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    _, component = connected_components(graph, directed=False)
    _, first, inverse = np.unique(component, return_index=True, return_inverse=True)
    return first[inverse]


def _weld(points: FloatArray, faces: Faces) -> tuple[FloatArray, Faces]:
    label = _coincident(points, CORNER_TOLERANCE * float(np.linalg.norm(np.ptp(points, axis=0))))
    kept, new = np.unique(label, return_inverse=True)
    return points[kept], tuple(without_repeats([int(new[i]) for i in face] for face in faces))
