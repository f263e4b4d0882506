"""The stones of a building as flat arrays."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, cast

import numpy as np
import numpy.typing as npt

from churchpipe.errors import InputError
from churchpipe.model.arguments import describe
from churchpipe.model.arrays import (
    BoolArray,
    FloatArray,
    IntArray,
    NameArray,
    array_of,
    flags,
    floats,
    indices,
    names,
    one_each,
    pointer_of,
    pointers,
    rows_of,
    store,
    store_arrays,
)
from churchpipe.model.card import Shown
from churchpipe.model.doubts import doubt, doubt_argument
from churchpipe.model.materials import UnitWeight
from churchpipe.model.pictures import picture
from churchpipe.model.polyhedra import FLATNESS, LEAST_WARP, face_warps, solid_properties
from churchpipe.model.sizes import size_questions
from churchpipe.model.surfaces import DOUBLED, SurfaceFault, coincident, surface_fault, weld

Polyhedron = tuple[npt.ArrayLike, Sequence[Sequence[int]]]

REPAIR = "churchpipe.repair_polyhedra mends solids and says what it changed."


@dataclass(frozen=True, slots=True, repr=False)
class Assemblage(Shown):
    """Rigid blocks: polyhedra with planar faces, counter-clockwise seen from outside.

    Ragged data are flat arrays with pointers, as in a CSR matrix: stone i has the faces
    `block_face_ptr[i]:block_face_ptr[i + 1]` and the points `block_point_ptr[i]:block_point_ptr[i + 1]`; face f has the
    nodes `face_nodes[face_ptr[f]:face_ptr[f + 1]]`, indices into `points`.

    Fields: points (nv, 3) m; centroid (nb, 3) m; volume (nb,) m3; unit_weight (nb,) N/m3; material, panel (nb,) names;
    course (nb,), counted from 0 at the bottom, -1 unknown; fixed (nb,) True for ground; block_id (nb,) unique names; butts (nb,)
    True for stones that no mortar joins to those of other panels beside them, False if left out.
    """

    points: FloatArray
    face_nodes: IntArray
    face_ptr: IntArray
    block_face_ptr: IntArray
    block_point_ptr: IntArray
    centroid: FloatArray
    volume: FloatArray
    unit_weight: FloatArray
    material: NameArray
    panel: NameArray
    course: IntArray
    fixed: BoolArray
    block_id: NameArray
    butts: BoolArray = field(default_factory=lambda: np.empty(0, dtype=np.bool_))

    def __post_init__(self) -> None:
        nv, nb = rows_of("Assemblage.points", self.points), rows_of("Assemblage.volume", self.volume)
        nf = rows_of("Assemblage.face_ptr", self.face_ptr) - 1
        store_arrays(self, points=(None, 3), centroid=(nb, 3), volume=(nb,), unit_weight=(nb,), material=(nb,), panel=(nb,))
        store_arrays(self, fixed=(nb,), block_id=(nb,))
        store(
            self,
            face_nodes=indices("Assemblage.face_nodes", self.face_nodes, (None,), below=nv),
            face_ptr=pointers("Assemblage.face_ptr", self.face_ptr, nf, rows_of("Assemblage.face_nodes", self.face_nodes)),
            block_face_ptr=pointers("Assemblage.block_face_ptr", self.block_face_ptr, nb, nf),
            block_point_ptr=pointers("Assemblage.block_point_ptr", self.block_point_ptr, nb, nv),
            course=_courses(self.course, nb),
            butts=flags("Assemblage.butts", self.butts if np.size(self.butts) else np.zeros(nb, dtype=np.bool_), (nb,)),
        )
        _check_solids(self)

    @property
    def count(self) -> int:
        """Number of stones, ground included."""
        return len(self.volume)

    @property
    def coursed(self) -> BoolArray:
        """Which stones (nb,) lie in a course that is known: voussoirs lie in none."""
        return self.course >= 0

    @property
    def weight(self) -> FloatArray:
        """Weight of each stone (nb,), N; ground weighs nothing."""
        return np.where(self.fixed, 0.0, self.volume * self.unit_weight)

    @property
    def mean_unit_weights(self) -> dict[str, float]:
        """Unit weight of the free stones of each material, N/m3, the mean by volume where they differ."""
        found: dict[str, float] = {}
        for name in dict.fromkeys(self.material[~self.fixed].tolist()):
            own = ~self.fixed & (self.material == name)
            same = float(np.ptp(self.unit_weight[own])) == 0.0
            found[name] = float(self.unit_weight[own][0] if same else self.weight[own].sum() / self.volume[own].sum())
        return found

    def solid(self, stone: int) -> tuple[FloatArray, list[list[int]]]:
        """Return the points (n, 3) m and the faces of one stone."""
        start, stop = self.block_point_ptr[stone : stone + 2]
        faces = [
            (self.face_nodes[self.face_ptr[f] : self.face_ptr[f + 1]] - start).tolist()
            for f in range(*self.block_face_ptr[stone : stone + 2])
        ]
        return self.points[start:stop], faces

    @property
    def size(self) -> float:
        """Diagonal of the bounding box of the free stones, m."""
        free = self.points[np.repeat(~self.fixed, np.diff(self.block_point_ptr))]
        return float(np.linalg.norm(np.ptp(free if len(free) else self.points, axis=0)))

    @classmethod
    def from_polyhedra(
        cls,
        polyhedra: Iterable[Polyhedron],
        unit_weight: npt.ArrayLike,
        fixed: Iterable[int] = (),
        *,
        material: str | Sequence[str] = "default",
        panel: str | Sequence[str] = "",
        course: int | Sequence[int] = -1,
        block_id: Sequence[str] | None = None,
        butts: bool | Sequence[bool] = False,
    ) -> "Assemblage":
        """Build an assemblage from anybody's polyhedra.

        Parameters
        ----------
        polyhedra
            Pairs (vertices (n, 3) m, faces: lists of vertex indices). Faces are planar, closed and consistently oriented; a
            solid with all faces inward is turned inside out, and one that is closed only when vertices at one place are one
            vertex gets them welded. `churchpipe.repair_polyhedra` mends other solids.
        unit_weight
            N/m3, scalar or one a stone.
        fixed
            Indices of the stones that are ground, or a flag for each stone.
        material, panel, course, block_id, butts
            One value for all or one a stone; ids default to "B0", "B1", ...

        Raises
        ------
        InputError
            A solid that is open, flat or not planar, with its index.
        """
        # Models without units are given a weight of one.
        if units := not np.array_equal(unit_weight, 1.0):
            doubt_argument("from_polyhedra: unit_weight", unit_weight, UnitWeight, "unit_weight")
        points: list[FloatArray] = []
        nodes: list[int] = []
        face_sizes: list[int] = []
        block_faces: list[int] = []
        block_points: list[int] = []
        offset = 0
        for number, polyhedron in enumerate(checked_sequence("polyhedra", polyhedra, "pairs of vertices and faces")):
            array, faces = _welded(*checked_polyhedron(f"polyhedra[{number}]", polyhedron))
            for face in faces:
                nodes.extend(i + offset for i in face)
                face_sizes.append(len(face))
            points.append(array)
            block_faces.append(len(faces))
            block_points.append(len(array))
            offset += len(array)
        if not points:
            raise InputError("polyhedra", "no stones", found=0, expected="at least one polyhedron")
        count = len(points)
        fixed_flags = np.zeros(count, dtype=bool)
        given = fixed if np.ma.is_masked(fixed) else list(checked_sequence("fixed", fixed, "indices of stones, or flags"))
        chosen = array_of("fixed", given, "biu", "whole numbers")
        if chosen.dtype == np.bool_:
            chosen = np.flatnonzero(flags("fixed", chosen, (count,)))
        fixed_flags[indices("fixed", chosen, (None,), below=count)] = True
        made = assemble(
            points=np.concatenate(points),
            face_nodes=np.array(nodes, dtype=np.int64),
            face_ptr=pointer_of(face_sizes),
            block_face_ptr=pointer_of(block_faces),
            block_point_ptr=pointer_of(block_points),
            unit_weight=one_each("unit_weight", array_of("unit_weight", unit_weight, "iuf", "numbers").astype(np.float64), count),
            material=one_each("material", array_of("material", material, "Uiu", "texts").astype(np.str_), count),
            panel=one_each("panel", array_of("panel", panel, "Uiu", "texts").astype(np.str_), count),
            course=one_each("course", array_of("course", course, "iu", "whole numbers").astype(np.int64), count),
            fixed=fixed_flags,
            block_id=_ids(block_id, count),
            butts=one_each("butts", array_of("butts", butts, "b", "True or False"), count),
        )
        doubt(size_questions(made) if units else ())
        return made

    def show(self) -> Any:
        """Return a picture of the stones as they stand (`churchpipe.show`)."""
        return picture(self)

    def _rows(self) -> tuple[str, Mapping[str, object]]:
        rows = {
            "stones": self.count - int(self.fixed.sum()),
            "fixed": int(self.fixed.sum()),
            "weight, kN": float(self.weight.sum()) / 1e3,
            "macro-elements": ", ".join(sorted({str(name) for name in self.panel[~self.fixed]} - {""})),
        }
        return "Assemblage", rows


def assemble(
    *,
    points: FloatArray,
    face_nodes: IntArray,
    face_ptr: IntArray,
    block_face_ptr: IntArray,
    block_point_ptr: IntArray,
    unit_weight: FloatArray,
    material: NameArray,
    panel: NameArray,
    course: IntArray,
    fixed: BoolArray,
    block_id: NameArray,
    butts: BoolArray | None = None,
) -> Assemblage:
    """Build an `Assemblage` from flat arrays, computing volumes and centroids; inside-out solids are turned."""
    volume, centroid = solid_properties(points, face_nodes, face_ptr, block_face_ptr)
    if (volume < 0).any():
        face_nodes = _turn_faces(face_nodes, face_ptr, np.repeat(volume < 0, np.diff(block_face_ptr)))
        volume, centroid = solid_properties(points, face_nodes, face_ptr, block_face_ptr)
    return Assemblage(
        points=points,
        face_nodes=face_nodes,
        face_ptr=face_ptr,
        block_face_ptr=block_face_ptr,
        block_point_ptr=block_point_ptr,
        centroid=centroid,
        volume=volume,
        unit_weight=unit_weight,
        material=material,
        panel=panel,
        course=course,
        fixed=fixed,
        block_id=block_id,
        butts=np.zeros(len(fixed), dtype=np.bool_) if butts is None else butts,
    )


def checked_sequence(where: str, value: Any, of: str) -> Iterable[Any]:
    # An array without a dimension calls itself iterable.
    if (
        isinstance(value, str | bytes | Mapping)
        or not isinstance(value, Iterable)
        or getattr(cast("object", value), "shape", None) == ()
    ):
        raise InputError(where, "not a list", found=describe(cast("object", value)), expected=f"a list of {of}")
    return cast("Iterable[Any]", value)


def checked_polyhedron(where: str, value: Any) -> tuple[FloatArray, list[list[int]]]:
    """Return the vertices (n, 3) m and the faces of one solid, checked."""
    pair = list(cast("Sequence[Any]", value)) if isinstance(value, Sequence) and not isinstance(value, str) else []
    if len(pair) != 2:
        raise InputError(where, "not a pair", found=describe(cast("object", value)), expected="(vertices, faces)")
    points = floats(f"{where} vertices", pair[0], (None, 3))
    given = list(checked_sequence(f"{where} faces", pair[1], "faces"))
    if given and all(_is_plain(face, len(points)) for face in given):
        return points, [list(face) for face in given]
    faces = [_face(face) for face in given]
    for face in faces:
        if face.ndim != 1 or len(face) < 3 or face.dtype.kind not in "iu" or face.min() < 0 or face.max() >= len(points):
            raise InputError(where, "bad face", found=face.tolist(), expected=f"3 or more indices below {len(points)}")
    if not faces:
        raise InputError(where, "no faces", found=0, expected="4 or more faces that close a solid")
    return points, [face.tolist() for face in faces]


def _welded(points: FloatArray, faces: list[list[int]]) -> tuple[FloatArray, Sequence[Sequence[int]]]:
    if not len(coincident(points, np.zeros(len(points), dtype=np.int64))) or surface_fault(faces) is None:
        return points, faces
    welded = weld(points, faces)
    return welded if welded[1] else (points, faces)


def _is_plain(face: Any, count: int) -> bool:
    """Return whether a face is a good one of Python's own numbers, as those of most files are: arrays take ten times as long."""
    if type(face) not in (tuple, list) or len(face) < 3 or any(type(node) is not int for node in face):
        return False
    return min(face) >= 0 and max(face) < count


def _face(face: Any) -> npt.NDArray[Any]:
    try:
        return np.asarray(face)
    except ValueError:
        return np.asarray(face, dtype=np.object_)


def _ids(block_id: Any, count: int) -> NameArray:
    ids = [f"B{i}" for i in range(count)] if block_id is None else list(checked_sequence("block_id", block_id, "names"))
    return names("block_id", ids, (count,))


def _turn_faces(face_nodes: IntArray, face_ptr: IntArray, turn: BoolArray) -> IntArray:
    """Reverse the node order of the flagged faces."""
    face_of = np.repeat(np.arange(len(turn)), np.diff(face_ptr))
    position = np.arange(len(face_nodes))
    mirrored = face_ptr[face_of] + face_ptr[face_of + 1] - 1 - position
    return face_nodes[np.where(turn[face_of], mirrored, position)]


def _courses(value: npt.ArrayLike, count: int) -> IntArray:
    shifted = indices("Assemblage.course", array_of("Assemblage.course", value, "iu", "whole numbers") + 1, (count,))
    return indices("Assemblage.course", shifted, (count,)) if count == 0 else _read_only(shifted - 1)


def _read_only(array: IntArray) -> IntArray:
    array.setflags(write=False)
    return array


def _check_solids(stones: Assemblage) -> None:
    nb = stones.count
    if not nb:
        raise InputError("Assemblage", "no stones", found=0, expected="at least one")
    if len(np.unique(stones.block_id)) != nb:
        ids, counts = np.unique(stones.block_id, return_counts=True)
        raise InputError("Assemblage.block_id", "names are not unique", found=str(ids[counts > 1][0]))
    free_weight = stones.unit_weight[~stones.fixed]
    if (free_weight <= 0).any():
        raise InputError(
            "Assemblage.unit_weight", "a free stone weighs nothing", found=float(free_weight.min()), expected="> 0 N/m3"
        )
    _check_closed(stones)
    if (stones.volume <= 0).any():
        bad = int(np.argmin(stones.volume))
        raise InputError(f"stone {stones.block_id[bad]}", "no volume", found=float(stones.volume[bad]), expected="> 0 m3")
    _check_once(stones)
    _check_planar(stones)


def _check_closed(stones: Assemblage) -> None:
    # A closed, consistently oriented surface uses each edge once in each direction.
    node, pointer = stones.face_nodes, stones.face_ptr
    successor = np.arange(len(node)) + 1
    successor[pointer[1:] - 1] = pointer[:-1]
    count = len(stones.points) + 1
    edge = np.sort(node * count + node[successor])
    twin = np.sort(node[successor] * count + node)
    # Nearly always they are the same, and to find what differs among a million takes as long as all other checks together.
    alone = edge[:0] if np.array_equal(edge, twin) else np.setdiff1d(edge, twin)
    odd = np.append(edge[:-1][np.diff(edge) == 0], alone) // count
    suspect = np.searchsorted(stones.block_point_ptr, odd, side="right") - 1
    for stone in np.unique(suspect).tolist():
        points, faces = stones.solid(stone)
        if fault := surface_fault(faces):
            raise _refusal(str(stones.block_id[stone]), fault, points)


def _check_once(stones: Assemblage) -> None:
    # Of a solid with vertices at one place it may be the faces that are there twice, each time closed.
    for stone in coincident(stones.points, np.repeat(np.arange(stones.count), np.diff(stones.block_point_ptr))).tolist():
        points, faces = weld(*stones.solid(stone))
        fault = surface_fault(faces)
        if fault and fault.problem == DOUBLED:
            raise _refusal(str(stones.block_id[stone]), fault, points)


def _refusal(name: str, fault: SurfaceFault, points: FloatArray) -> InputError:
    x, y, z = points[fault.vertex]
    found = f"{fault.found} at ({x:.6g}, {y:.6g}, {z:.6g}) m"
    return InputError(f"stone {name}", fault.problem, found=found, expected=fault.expected, remedy=REPAIR)


def _check_planar(stones: Assemblage) -> None:
    height, extent = face_warps(stones.points, stones.face_nodes, stones.face_ptr)
    if (height > FLATNESS * extent + LEAST_WARP).any():
        face = int(np.argmax(height / np.maximum(extent, 1e-300)))
        stone = int(np.searchsorted(stones.block_face_ptr, face, side="right")) - 1
        raise InputError(
            f"stone {stones.block_id[stone]}",
            f"face {face - stones.block_face_ptr[stone]} is not planar",
            found=f"{height[face]:.3g} m out of plane",
            expected="within 1e-6 of the face's size and 1e-6 m",
            remedy="Split the face into triangles; " + REPAIR,
        )
