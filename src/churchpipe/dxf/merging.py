"""Coplanar faces of stones merged, so that a stone cut into triangles has the faces of the one that was not."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from churchpipe.dxf.stones import Stone
from churchpipe.geometry.dissolve import dissolve


def with_merged_faces(stones: Sequence[Stone]) -> list[Stone]:
    """Return stones, in m, with the coplanar faces of each merged, and without vertices that no face needs.

    Stones of the layout that churchpipe writes are left as they are, so that they come back as they were written.
    """
    merged = iter(_merged([stone for stone in stones if not stone.tagged]))
    return [stone if stone.tagged else next(merged) for stone in stones]


def _merged(stones: Sequence[Stone]) -> list[Stone]:
    if not stones:
        return []
    offsets = np.cumsum([0, *(len(stone.points) for stone in stones)])
    faces = [np.array(face) + o for stone, o in zip(stones, offsets, strict=False) for face in stone.faces]
    owner = np.repeat(np.arange(len(stones)), [len(stone.faces) for stone in stones])
    nodes, pointer, first = dissolve(
        np.concatenate([stone.points for stone in stones]),
        np.concatenate(faces),
        np.cumsum([0, *(len(face) for face in faces)]),
    )
    merged = np.split(nodes, pointer[1:-1])
    out: list[Stone] = []
    for index, around in enumerate(_grouped(merged, owner[first], len(stones))):
        used, inverse = np.unique(np.concatenate(around) - offsets[index], return_inverse=True)
        rings = np.split(inverse.ravel(), np.cumsum([len(face) for face in around])[:-1])
        out.append(replace(stones[index], points=stones[index].points[used], faces=tuple(tuple(r.tolist()) for r in rings)))
    return out


def _grouped(faces: list[np.ndarray], owner: np.ndarray, count: int) -> list[list[np.ndarray]]:
    groups: list[list[np.ndarray]] = [[] for _ in range(count)]
    for face, index in zip(faces, owner.tolist(), strict=True):
        groups[index].append(face)
    return groups
