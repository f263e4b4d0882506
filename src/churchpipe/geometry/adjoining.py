"""Solids that share edges and faces, told apart by the side on which each of their faces is solid."""

from collections import defaultdict
from collections.abc import Sequence
from itertools import pairwise
from typing import Final

import numpy as np

from churchpipe.geometry.clusters import components
from churchpipe.geometry.mending import Face, signed_volumes
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.surfaces import edges, surface_fault

# Faces at an edge whose angles about it differ by less lie on each other, rad.
SAME_ANGLE: Final = 1e-5
# A part with less of the volume of a cube of its size encloses nothing.
NOTHING_INSIDE: Final = 1e-9


def encloses(points: FloatArray, parts: Sequence[Sequence[Face]]) -> list[bool]:
    """Return for each part whether its faces close, each edge between two of them, around a volume of either sign."""
    volumes = np.abs(signed_volumes([(points, part) for part in parts])).tolist()
    return [
        volume > NOTHING_INSIDE * _size(points, part) ** 3 and not _open(part)
        for part, volume in zip(parts, volumes, strict=True)
    ]


def adjoining(points: FloatArray, faces: Sequence[Face]) -> list[list[int]] | None:
    """Return the numbers of the faces of each of several solids, in whatever order the faces come; None where they tell none.

    About an edge at which more than two faces meet, each face opens a solid that the next face closes. This tells solids apart
    where all faces run counter-clockwise from outside. It is no answer where they do not, or where one solid is all there is.

    Parameters
    ----------
    points: corners (n, 3). faces: indices of corners; solids that touch use the same ones.
    """
    sharing: defaultdict[tuple[int, int], list[tuple[int, bool]]] = defaultdict(list)
    for number, face in enumerate(faces):
        for a, b in edges(face):
            sharing[min(a, b), max(a, b)].append((number, a < b))
    if any(len(around) % 2 for around in sharing.values()):
        return None
    normals = np.array([_normal(points[list(face)]) for face in faces])
    pairs: list[tuple[int, int]] = []
    for (a, b), around in sharing.items():
        found = _opened_and_closed(points[b] - points[a], around, normals)
        if found is None:
            return None
        pairs += found
    label = components(len(faces), np.array(pairs, dtype=np.int64))
    parts = [np.flatnonzero(label == k).tolist() for k in range(int(label.max()) + 1)] if len(label) else []
    solids = [[faces[number] for number in part] for part in parts]
    if len(parts) < 2 or any(map(surface_fault, solids)):
        return None
    volumes = signed_volumes([(points, solid) for solid in solids])
    return sorted(parts) if bool((volumes > 0).all()) and all(encloses(points, solids)) else None


def _opened_and_closed(along: FloatArray, around: list[tuple[int, bool]], normals: FloatArray) -> list[tuple[int, int]] | None:
    """Return the pairs of faces between which a solid lies at an edge; None where faces do not open and close solids in turn.

    around: numbers of faces, and whether each runs along the edge or against it.
    """
    if len(around) == 2:
        (first, one), (second, other) = around
        return [(first, second)] if one != other else None
    length = float(np.linalg.norm(along))
    if length == 0:
        return None
    axis = along / length
    numbers = [number for number, _ in around]
    into = np.cross(normals[numbers], axis) * np.where([forward for _, forward in around], 1.0, -1.0)[:, None]
    start = into[0] / max(float(np.linalg.norm(into[0])), 1e-300)
    angle = np.arctan2(into @ np.cross(axis, start), into @ start) % (2 * np.pi)
    # A face that runs against the edge has its solid on the side where the angle grows. Of two that lie on each other the one
    # that closes a solid comes before the one that opens the next.
    order = sorted(range(len(around)), key=lambda k: (_step(angle[k]), not around[k][1]))
    opens = [not around[k][1] for k in order]
    if any(one == other for one, other in pairwise([*opens, opens[0]])):
        return None
    order = order if opens[0] else [*order[1:], order[0]]
    return [(numbers[a], numbers[b]) for a, b in zip(order[::2], order[1::2], strict=True)]


def _step(angle: float) -> int:
    """Return an angle in steps of `SAME_ANGLE`, a full turn as none."""
    return round(angle / SAME_ANGLE) % round(2 * np.pi / SAME_ANGLE)


def _normal(corners: FloatArray) -> FloatArray:
    reach = corners - corners.mean(axis=0)
    normal = np.cross(reach, np.roll(reach, -1, axis=0)).sum(axis=0)
    length = float(np.linalg.norm(normal))
    return normal / length if length else normal


def _open(faces: Sequence[Face]) -> bool:
    uses: defaultdict[tuple[int, int], int] = defaultdict(int)
    for face in faces:
        for a, b in edges(face):
            uses[min(a, b), max(a, b)] += 1
    return any(count != 2 for count in uses.values())


def _size(points: FloatArray, faces: Sequence[Face]) -> float:
    nodes: IntArray = np.unique(np.concatenate([np.array(face) for face in faces]))
    return float(np.ptp(points[nodes], axis=0).max())
