"""Solids that share edges and faces, told apart by the side on which each of their faces is solid."""

import math
from collections import defaultdict
from collections.abc import Sequence
from typing import Final

import numpy as np

from churchpipe.geometry.clusters import components
from churchpipe.geometry.mending import Face, signed_volume, signed_volumes
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.surfaces import edges, surface_fault

# Solids at an edge are at least so thick, as a share of a turn, where all of them together fill no more than the other share.
THIN, FEW = 0.003, 0.1
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
    where all faces run alike, counter-clockwise from outside or clockwise. It is no answer where they do not, or where one solid
    is all there is. Faces that close no solid, as those of a stone of which one is missing, are the last ones, each of their
    connected parts by itself.

    Parameters
    ----------
    points: corners (n, 3). faces: indices of corners; solids that touch use the same ones.
    """
    if signed_volume(points, faces) < 0:
        faces = [face[::-1] for face in faces]
    sharing: defaultdict[tuple[int, int], list[tuple[int, bool]]] = defaultdict(list)
    for number, face in enumerate(faces):
        for a, b in edges(face):
            sharing[min(a, b), max(a, b)].append((number, a < b))
    normals = np.array([_normal(points[list(face)]) for face in faces])
    pairs = [pair for (a, b), around in sharing.items() for pair in _opened_and_closed(points[b] - points[a], around, normals)]
    label = components(len(faces), np.array(pairs, dtype=np.int64).reshape(-1, 2))
    parts = [np.flatnonzero(label == k).tolist() for k in range(int(label.max()) + 1)] if len(label) else []
    bodies = [[faces[number] for number in part] for part in parts]
    sound = [surface_fault(body) is None for body in bodies]
    solids = [body for body, closed in zip(bodies, sound, strict=True) if closed]
    if len(parts) < 2 or not solids or not all(encloses(points, solids)):
        return None
    if signed_volumes([(points, solid) for solid in solids]).min() <= 0:
        return None
    return [part for closed in (True, False) for part, own in zip(parts, sound, strict=True) if own is closed]


def _opened_and_closed(along: FloatArray, around: list[tuple[int, bool]], normals: FloatArray) -> list[tuple[int, int]]:
    """Return the pairs of faces between which a solid lies at an edge; none where not as many faces close solids as open them.

    around: numbers of faces, and whether each runs along the edge or against it.
    """
    if len(around) == 2:
        return [(around[0][0], around[1][0])]
    numbers, forward = (np.array(column) for column in zip(*around, strict=True))
    length = float(np.linalg.norm(along))
    if length == 0 or 2 * forward.sum() != len(around):
        return []
    axis = along / length
    into = np.cross(normals[numbers], axis) * np.where(forward, 1.0, -1.0)[:, None]
    start = into[0] / max(float(np.linalg.norm(into[0])), 1e-300)
    angle = np.arctan2(into @ np.cross(axis, start), into @ start) % (2 * np.pi)
    # A face that runs against the edge has its solid on the side where the angle grows. Where solids touch, the face that closes
    # one lies on the face that opens the next, and which of them comes first is chance once corners are rounded. But those that
    # open, and those that close, follow each other as their solids do, and all solids together fill no more than a turn.
    opens, closes = (side[np.argsort(angle[side])] for side in (np.flatnonzero(~forward), np.flatnonzero(forward)))
    filled = float((angle[closes] - angle[opens]).sum()) / (2 * np.pi)
    place = np.arange(len(opens)) + math.floor(1 - filled)
    thick = angle[closes[place % len(opens)]] / (2 * np.pi) + place // len(opens) - angle[opens] / (2 * np.pi)
    if thick.sum() < FEW and thick.min() < THIN:
        # Solids fill the whole turn, and rounding has added to it: each face was paired with the one that it lies on.
        place += 1
    return list(zip(numbers[opens].tolist(), numbers[closes[place % len(opens)]].tolist(), strict=True))


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
