"""Faces around a solid: corners given more than once, and what keeps faces from closing it."""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from churchpipe.model.arrays import FloatArray, IntArray

Face = Sequence[int]

DOUBLED = "a face lies on another"
CROWDED = "more than two faces meet at an edge"


@dataclass(frozen=True, slots=True)
class SurfaceFault:
    """Why faces close no solid: the problem, what was found at which vertex, and what was expected."""

    problem: str
    found: str
    vertex: int
    expected: str


def edges(face: Face) -> Iterator[tuple[int, int]]:
    """Yield the directed edges of a face."""
    return zip(face, (*face[1:], face[0]), strict=True)


def weld(points: FloatArray, faces: Iterable[Face]) -> tuple[FloatArray, list[tuple[int, ...]]]:
    """Join the vertices (n, 3) that lie at one place, to the last digit; faces that lose corners by it keep the others."""
    # Adding zero makes one of the two zeros.
    _, first, inverse = np.unique(points + 0.0, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first, kind="stable")
    rank = np.empty(len(order), dtype=np.int64)
    rank[order] = np.arange(len(order))
    label = rank[inverse.ravel()].tolist()
    return points[first[order]], without_repeats([label[i] for i in face] for face in faces)


def without_repeats(faces: Iterable[Face]) -> list[tuple[int, ...]]:
    """Return faces without corners that repeat the one before; those of which fewer than three corners stay are left out."""
    cleaned = (tuple(a for a, b in edges(face) if a != b) for face in faces)
    return [face for face in cleaned if len(face) >= 3]


def coincident(points: FloatArray, owner: IntArray) -> IntArray:
    """Return the owners, sorted, of which two points (n, 3) or more lie at one place; owner (n,)."""
    order = np.lexsort((points[:, 2], points[:, 1], points[:, 0], owner))
    same = (points[order[1:]] == points[order[:-1]]).all(axis=1) & (owner[order[1:]] == owner[order[:-1]])
    # To find what is unique among nothing takes as long as all else for one stone.
    return np.unique(owner[order[1:]][same]) if same.any() else owner[:0]


def surface_fault(faces: Sequence[Face]) -> SurfaceFault | None:
    """Return why faces do not close a solid and agree on its outside, None when they do."""
    if (twin := _doubled(faces)) is not None:
        found = f"face {twin[1]} has the corners of face {twin[0]}"
        return SurfaceFault(DOUBLED, found, faces[twin[1]][0], "each face once")
    uses = Counter((min(a, b), max(a, b)) for face in faces for a, b in edges(face))
    for (vertex, _), count in uses.items():
        if count == 1:
            expected = "every edge shared by two faces"
            return SurfaceFault("its faces do not close a solid", "an open edge", vertex, expected)
        if count > 2:
            return SurfaceFault(CROWDED, f"{count} faces", vertex, "two faces at every edge")
    directed = Counter(edge for face in faces for edge in edges(face))
    for (vertex, _), count in directed.items():
        if count > 1:
            found = "two faces that run along their common edge in one direction"
            return SurfaceFault("its faces run in mixed directions", found, vertex, "all counter-clockwise from outside")
    return None


def _doubled(faces: Sequence[Face]) -> tuple[int, int] | None:
    seen: dict[tuple[int, ...], int] = {}
    for number, face in enumerate(faces):
        first = seen.setdefault(tuple(sorted(face)), number)
        if first != number:
            return first, number
    return None
