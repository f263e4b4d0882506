"""Which faces of a body are one stone: those that are connected, or that close in the order they were written."""

from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence

import numpy as np

from churchpipe.geometry.adjoining import adjoining, encloses
from churchpipe.geometry.clusters import clusters
from churchpipe.geometry.mending import NEARLY, Face
from churchpipe.model.arrays import FloatArray
from churchpipe.model.surfaces import edges


def parts_of(points: FloatArray, faces: Sequence[Face]) -> list[list[int]]:
    """Return the numbers of the faces of each part, in order of their first.

    Faces that share vertices and close are a part. The others, such as the facets of an STL, are joined where their vertices lie
    at one place; where several solids meet so, a run of faces that closes is a part, for programs write one after the other.
    Where faces come in another order, the side on which each is solid tells them apart.
    """
    parts: list[list[int]] = []
    open_parts: list[list[int]] = []
    for part in _connected(faces, [(node,) for face in faces for node in face], [len(face) for face in faces]):
        (parts if _closes(faces, part) else open_parts).append(part)
    rest = sorted(number for part in open_parts for number in part)
    if rest:
        places, inverse = np.unique(points + 0.0, axis=0, return_inverse=True)
        label = inverse.ravel().tolist()
        welded = {number: tuple(label[node] for node in faces[number]) for number in rest}
        keys = [(min(a, b), max(a, b)) for number in rest for a, b in edges(welded[number])]
        open_parts = []
        for part in _connected(rest, keys, [len(faces[number]) for number in rest]):
            numbers = [rest[k] for k in part]
            for run in _solids(places, welded, numbers):
                (parts if _closes(welded, run) else open_parts).append(run)
        parts += _nearly_meeting(points, faces, open_parts)
    return sorted(parts)


def _solids(points: FloatArray, welded: dict[int, Face], part: list[int]) -> list[list[int]]:
    """Return the solids that connected faces are, by the order they were written or else by the sides of the faces."""
    runs = [part] if _closes(welded, part) else _runs(welded, part)
    if all(encloses(points, [[welded[number] for number in run] for run in runs])):
        return runs
    apart = adjoining(points, [welded[number] for number in part])
    return runs if apart is None else [[part[k] for k in solid] for solid in apart]


def _nearly_meeting(points: FloatArray, faces: Sequence[Face], parts: list[list[int]]) -> list[list[int]]:
    """Join open parts whose vertices nearly meet: the faces of a body whose corners were rounded apart."""
    if len(parts) < 2:
        return parts
    nodes = [sorted({node for number in part for node in faces[number]}) for part in parts]
    size = float(np.median([np.linalg.norm(np.ptp(points[list(part)], axis=0)) for part in nodes]))
    used = np.concatenate(nodes)
    label = clusters(points[used], max(NEARLY * size, 1e-300)).tolist()
    joined = _connected(parts, [(key,) for key in label], [len(part) for part in nodes])
    return [sorted(number for k in group for number in parts[k]) for group in joined]


def _connected(faces: Sequence[object], keys: Sequence[tuple[int, ...]], sizes: Sequence[int]) -> list[list[int]]:
    """Return the groups of faces that have keys in common, directly or by others; keys: those of each face in turn."""
    parent = list(range(len(faces)))

    def root(number: int) -> int:
        while parent[number] != number:
            parent[number] = parent[parent[number]]
            number = parent[number]
        return number

    first: dict[tuple[int, ...], int] = {}
    position = 0
    for number, size in enumerate(sizes):
        for key in keys[position : position + size]:
            a, b = root(first.setdefault(key, number)), root(number)
            parent[max(a, b)] = min(a, b)
        position += size
    groups: defaultdict[int, list[int]] = defaultdict(list)
    for number in range(len(faces)):
        groups[root(number)].append(number)
    return list(groups.values())


def _closes(faces: Sequence[Face] | dict[int, Face], part: Iterable[int]) -> bool:
    """Is every edge shared by two faces, or every face there more than once?"""
    around = [faces[number] for number in part]
    uses = Counter((min(a, b), max(a, b)) for face in around for a, b in edges(face) if a != b)
    if all(count == 2 for count in uses.values()):
        return bool(uses)
    return min(Counter(frozenset(face) for face in around).values()) > 1


def _runs(faces: dict[int, Face], part: list[int]) -> list[list[int]]:
    """Cut faces, in the order they were written, where those so far close; the last run may be open."""
    runs: list[list[int]] = []
    run: list[int] = []
    open_edges: set[tuple[int, int]] = set()
    for number in part:
        run.append(number)
        open_edges ^= {(min(a, b), max(a, b)) for a, b in edges(faces[number]) if a != b}
        if not open_edges and len(run) > 3:
            runs.append(run)
            run = []
    return [*runs, run] if run else runs
