"""Bodies of a file mended to closed solids. Changes are counted, and a body that cannot be mended is named with its fault."""

from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from churchpipe.geometry.clusters import components
from churchpipe.geometry.warped import split_warped, warp
from churchpipe.model.arrays import FloatArray
from churchpipe.model.surfaces import DOUBLED, SurfaceFault, coincident, edges, surface_fault, weld, without_repeats

Face = tuple[int, ...]

# Changes that leave the shape as it is. They are always made.
WELDED: Final = "vertices at one place were welded"
TURNED: Final = "faces were turned to run like their neighbours"
OUTWARD: Final = "the body was inside out and was turned"
SPLIT: Final = "warped faces were split into triangles"
# Changes of the shape. They are made on request only.
DROPPED: Final = "faces given more than once were dropped"
INSIDE: Final = "faces given more than once inside the body were dropped, so that what they parted is one stone"
BARE: Final = "faces that bound nothing were dropped"
CLOSE: Final = "vertices that nearly met were joined"
JOINED: Final = "corners on an edge of a neighbour were put into it"
FILLED: Final = "holes of one face were closed"
REPAIRS: Final = (DROPPED, INSIDE, CLOSE, BARE, JOINED, FILLED)

# Vertices closer than this share of the body's size nearly meet.
NEARLY = 1e-5
NOTHING = SurfaceFault("it has no faces", "nothing with an area", 0, "faces that close a solid")
SHEET = SurfaceFault("it encloses nothing", "all its faces lie in one plane", 0, "faces around a volume")


@dataclass(frozen=True, slots=True)
class Mended:
    """A mended body: points (n, 3) and outward faces.

    changes: how often each kind of change was made. volume_before: volume inside the faces as given; of an open or doubled body,
    the value of the same sum over its faces. volume: that of the result. Both are in the unit of the points cubed. warp: the
    largest distance of a corner from the plane of its face. fault: what keeps the body from being a solid, None if nothing does.
    mendable: whether `repair` would mend it.
    """

    points: FloatArray
    faces: list[Face]
    changes: dict[str, int] = field(default_factory=dict)
    volume_before: float = 0.0
    volume: float = 0.0
    warp: float = 0.0
    fault: SurfaceFault | None = None
    mendable: bool = False


def mend(points: FloatArray, faces: Iterable[Sequence[int]], *, repair: bool) -> Mended:
    """Mend one body: points (n, 3), finite; faces of three vertices or more, indices below n.

    repair: drop faces given more than once, and flat ones with free edges on a closed body; join vertices that nearly meet, put
    corners into edges that they lie on, close holes of one face. Welding, turning and splitting leave the shape as it is and are
    done in any case. A body that needs nothing is returned as it is, and so is one that cannot be mended, with its own fault.
    """
    given = [tuple(face) for face in faces]
    before = signed_volume(points, given)
    changes: Counter[str] = Counter()
    if given and before > 0 and surface_fault(given) is None and not _doubled(points) and not _sheet(points, given, before):
        # Nearly every body of a file: closed, outward, each corner once.
        shell, changes[SPLIT], worst = split_warped(points, given)
        after = signed_volume(points, shell) if changes[SPLIT] else before
        return Mended(points, shell, dict(+changes), before, after, worst)
    corners, shell = _welded(points, given, changes)
    shell = _outward(corners, shell, changes)
    own = corners, shell
    if surface_fault(shell) and repair:
        corners, shell = _repaired(corners, shell, changes)
        shell = _outward(corners, shell, changes)
    fault = surface_fault(shell) if shell else NOTHING
    if fault is None and _sheet(corners, shell, before):
        fault = SHEET
    if fault:
        if repair and own[1]:
            # Faces that the repair added or dropped are not those of whoever reads the fault.
            corners, shell = own
            fault = surface_fault(shell) or fault
        mendable = not repair and mend(points, given, repair=True).fault is None
        return Mended(corners, shell, {}, before, before, fault=fault, mendable=mendable)
    shell, changes[SPLIT], worst = split_warped(corners, shell)
    return Mended(corners, shell, dict(+changes), before, signed_volume(corners, shell), worst)


def signed_volume(points: FloatArray, faces: Sequence[Face]) -> float:
    """Return the volume (m3) inside faces, negative when they point inwards. For open faces it is the value of the same sum."""
    return float(signed_volumes([(points, faces)])[0])


def signed_volumes(solids: Sequence[tuple[FloatArray, Sequence[Face]]]) -> FloatArray:
    """Return `signed_volume` of each solid (ns,)."""
    fans = [[(f[0], f[i], f[i + 1]) for f in faces for i in range(1, len(f) - 1)] for _, faces in solids]
    owner = np.repeat(np.arange(len(solids)), [len(fan) for fan in fans])
    if not len(owner):
        return np.zeros(len(solids))
    first = np.cumsum([0, *(len(points) for points, _ in solids)])[:-1]
    triangles = np.concatenate([np.array(fan, dtype=np.int64).reshape(-1, 3) for fan in fans]) + first[owner, None]
    # Measured from a corner of the solid: far from the origin the products would lose their last digits.
    origin = triangles[np.searchsorted(owner, owner), 0]
    points = np.concatenate([points for points, _ in solids])
    a, b, c = (points[triangles] - points[origin][:, None]).transpose(1, 0, 2)
    return np.bincount(owner, np.einsum("ij,ij->i", np.cross(a, b), c) / 6, len(solids)).astype(np.float64)


def flat(points: FloatArray, faces: Sequence[Face]) -> bool:
    """Return whether all faces lie in one plane, and not on a line of it."""
    corners = points[sorted({node for face in faces for node in face})]
    spread = np.linalg.svd(corners - corners.mean(axis=0), compute_uv=False)
    return len(spread) == 3 and bool(spread[2] <= NEARLY * spread[0] < spread[1])


def _sheet(points: FloatArray, faces: Sequence[Face], volume: float) -> bool:
    """Return whether closed faces lie on each other in one plane; most bodies have too much volume to be looked at."""
    return abs(volume) <= NEARLY * float(np.ptp(points, axis=0).max()) ** 3 and flat(points, faces)


def _doubled(points: FloatArray) -> bool:
    """Return whether two vertices are at one place."""
    return len(coincident(points, np.zeros(len(points), dtype=np.int64))) > 0


def _welded(points: FloatArray, faces: list[Face], changes: Counter[str]) -> tuple[FloatArray, list[Face]]:
    """Join equal vertices of a body that is open, that has edges between them, or that proves to be two equal bodies then."""
    if not _doubled(points):
        return points, faces
    welded = weld(points, faces)
    if surface_fault(faces) is None:
        fault = surface_fault(welded[1])
        # An edge of no length leaves a face on a line, which would pass for a warped one.
        collapsed = fault is None and any(bool((points[a] == points[b]).all()) for face in faces for a, b in edges(face))
        if not collapsed and not (fault and fault.problem == DOUBLED):
            return points, faces
    changes[WELDED] += len(points) - len(welded[0])
    return welded


def _outward(points: FloatArray, faces: list[Face], changes: Counter[str]) -> list[Face]:
    """Turn faces to run like their neighbours, and the body so that it looks outwards; nothing where three or more faces meet."""
    users = _users(faces)
    if any(len(sharing) > 2 for sharing in users.values()):
        return faces
    closed = surface_fault(faces) is None
    # The separate surfaces of a sound body are turned together, because one of them may bound a hollow.
    out = list(faces)
    for shell in [range(len(faces))] if closed else _shells(out, users):
        if signed_volume(points, [out[k] for k in shell]) < 0:
            for k in shell:
                out[k] = out[k][::-1]
    turned = sum(a != b for a, b in zip(out, faces, strict=True))
    if turned == len(faces) > 0:
        changes[OUTWARD] += 1
    else:
        changes[TURNED] += turned
    return out


def _shells(faces: list[Face], users: dict[tuple[int, int], list[int]]) -> list[list[int]]:
    """Make the faces of each connected part run alike, in place; return the parts."""
    shells: list[list[int]] = []
    seen: set[int] = set()
    for start in range(len(faces)):
        if start in seen:
            continue
        seen.add(start)
        shell = [start]
        for current in shell:
            for a, b in edges(faces[current]):
                for other in users[min(a, b), max(a, b)]:
                    if other not in seen:
                        seen.add(other)
                        shell.append(other)
                        if (a, b) in edges(faces[other]):
                            faces[other] = faces[other][::-1]
        shells.append(shell)
    return shells


def _users(faces: Sequence[Face]) -> dict[tuple[int, int], list[int]]:
    """Return edge -> the faces that have it."""
    users: defaultdict[tuple[int, int], list[int]] = defaultdict(list)
    for number, face in enumerate(faces):
        for a, b in edges(face):
            users[min(a, b), max(a, b)].append(number)
    return users


def _repaired(points: FloatArray, faces: list[Face], changes: Counter[str]) -> tuple[FloatArray, list[Face]]:
    """Make the changes that may alter the shape, one after another, until the body is a solid."""
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    faces = _once(faces, changes)
    if surface_fault(_alike(faces)):
        points, faces = _joined(points, faces, NEARLY * size, changes)
        faces = _once(faces, changes)
    if surface_fault(_alike(faces)):
        points, faces = _without_fins(points, faces, changes)
    if surface_fault(_alike(faces)):
        faces = _with_edge_corners(points, faces, NEARLY * size, changes)
    if surface_fault(_alike(faces)):
        faces = _filled(points, _alike(faces), NEARLY * size, changes)
    return points, faces


def _alike(faces: list[Face]) -> list[Face]:
    out, users = list(faces), _users(faces)
    if all(len(sharing) <= 2 for sharing in users.values()):
        _shells(out, users)
    return out


def _once(faces: list[Face], changes: Counter[str]) -> list[Face]:
    """Keep one of several faces with the same corners. An even number of them inside a body that is closed without them is
    dropped.
    """
    groups: defaultdict[frozenset[int], list[int]] = defaultdict(list)
    for number, face in enumerate(faces):
        groups[frozenset(face)].append(number)
    first = [faces[group[0]] for group in groups.values()]
    odd = [faces[group[0]] for group in groups.values() if len(group) % 2]
    if odd and surface_fault(_alike(first)) and not surface_fault(_alike(odd)):
        changes[INSIDE] += len(faces) - len(odd)
        return odd
    changes[DROPPED] += len(faces) - len(first)
    return first


def _joined(points: FloatArray, faces: list[Face], reach: float, changes: Counter[str]) -> tuple[FloatArray, list[Face]]:
    """Join vertices that are closer to each other than `reach`, m."""
    from scipy.spatial import cKDTree

    label = components(len(points), cKDTree(points).query_pairs(reach, output_type="ndarray"))
    _, first, inverse = np.unique(label, return_index=True, return_inverse=True)
    changes[CLOSE] += len(points) - len(first)
    return points[first], without_repeats([int(inverse[node]) for node in face] for face in faces)


def _without_fins(points: FloatArray, faces: list[Face], changes: Counter[str]) -> tuple[FloatArray, list[Face]]:
    """Drop flat fins, which hang with a free edge on a body that is closed without them."""
    uses = {edge: len(sharing) for edge, sharing in _users(faces).items()}
    kept, fins = list(faces), list[Face]()
    while free := [face for face in kept if any(uses[min(edge), max(edge)] == 1 for edge in edges(face))]:
        fins += free
        kept = [face for face in kept if face not in free]
        uses = {edge: len(sharing) for edge, sharing in _users(kept).items()}
    if not fins or not kept or surface_fault(_alike(kept)):
        return points, faces
    # A stone that lost a face comes apart as well; it is no fin.
    beside = [(a, b) for sharing in _users(fins).values() for a in sharing for b in sharing if a < b]
    label = components(len(fins), np.array(beside, dtype=np.int64).reshape(-1, 2))
    if not all(flat(points, [fins[k] for k in np.flatnonzero(label == one)]) for one in np.unique(label)):
        return points, faces
    changes[BARE] += len(fins)
    used = np.unique(np.concatenate(kept))
    number = dict(zip(used.tolist(), range(len(used)), strict=True))
    return points[used], [tuple(number[node] for node in face) for face in kept]


def _with_edge_corners(points: FloatArray, faces: list[Face], reach: float, changes: Counter[str]) -> list[Face]:
    """Put vertices of open edges into other open edges that pass within `reach`, m, of them."""
    open_edges = [edge for edge, sharing in _users(faces).items() if len(sharing) == 1]
    nodes = np.array(sorted({node for edge in open_edges for node in edge}), dtype=np.int64)
    between: dict[tuple[int, int], list[int]] = {}
    for a, b in open_edges:
        along, offset = points[b] - points[a], points[nodes] - points[a]
        share = offset @ along / (along @ along)
        near = np.linalg.norm(offset - share[:, None] * along, axis=1) <= reach
        inside = near & (share > 0) & (share < 1) & (nodes != a) & (nodes != b)
        if inside.any():
            between[a, b] = nodes[inside][np.argsort(share[inside])].tolist()
    out: list[Face] = []
    for face in faces:
        ring: list[int] = []
        for a, b in edges(face):
            ring += [a, *between.get((a, b), between.get((b, a), [])[::-1])]
        changes[JOINED] += len(ring) - len(face)
        out.append(tuple(ring))
    return out


def _filled(points: FloatArray, faces: list[Face], reach: float, changes: Counter[str]) -> list[Face]:
    """Close holes that one flat face closes; the faces around them run alike."""
    directed = {edge for face in faces for edge in edges(face)}
    after: dict[int, int] = {}
    for a, b in directed:
        if (b, a) not in directed:
            if b in after:
                return faces
            after[b] = a
    out = list(faces)
    while after:
        start = next(iter(after))
        ring = [start]
        while (node := after.pop(ring[-1], None)) is not None and node != start:
            ring.append(node)
        if node is None or len(ring) < 3 or warp(points[ring])[0] > 10 * reach:
            return faces
        out.append(tuple(ring))
        changes[FILLED] += 1
    return out
