"""From the courses of a vault to its stones: unions of segments, whose shared faces cancel."""

from collections import Counter, defaultdict

import numpy as np

from churchpipe.geometry.clusters import clusters
from churchpipe.model.arrays import FloatArray, IntArray, NameArray
from churchpipe.model.vault import Run, Side, Vault

# Corners that two segments compute by different sums are one when closer than this, m.
_ONE = 1e-8


def places(side: Side, points: FloatArray, stations: FloatArray) -> FloatArray:
    """Return the places (m, k, 3) m, `places_ikc`, of points (k, 2) of a section at stations (m, 2) of a side."""
    s = stations[:, :1] + stations[:, 1:] * points[:, 0]
    plan = side.origin + points[:, :1] * side.normal + s[:, :, None] * side.along
    return np.concatenate([plan, np.broadcast_to(points[:, 1:], (len(s), len(points), 1))], axis=2)


def vault_stones(vault: Vault) -> list[tuple[FloatArray, list[IntArray]]]:
    """Return each stone as its points (n, 3) m and the corners of its faces, counter-clockwise seen from outside."""
    owner, faces, points = _segments(vault)
    node = clusters(points, _ONE)
    place = points[np.unique(node, return_index=True)[1]]
    kept: dict[int, dict[tuple[int, ...], IntArray]] = defaultdict(dict)
    for stone, face in zip(owner, faces, strict=True):
        corner = node[face]
        # Corners on an axis, at which several stations meet, are one; so a face may vanish.
        corner = corner[corner != np.roll(corner, 1)]
        if len(corner) < 3:
            continue
        key = tuple(sorted(corner.tolist()))
        # A face between two segments of one stone is there twice.
        if kept[stone].pop(key, None) is None:
            kept[stone][key] = corner
    return [_local(place, list(kept[stone].values())) for stone in range(vault.stone_count)]


def _segments(vault: Vault) -> tuple[list[int], list[IntArray], FloatArray]:
    """Return the stone of each face, the faces as corners, and the points (n, 3) m of all segments."""
    owner: list[int] = []
    faces: list[IntArray] = []
    points: list[FloatArray] = []
    count = 0
    for run in vault.runs:
        place = places(run.side, run.section.corner, run.stations)
        size = len(run.section.corner)
        ring = np.arange(size)
        after = np.roll(ring, -1)
        for number, stone in enumerate(run.stone.tolist()):
            first, last = count + number * size + ring, count + (number + 1) * size + ring
            sides = np.stack([first[after], first, last, last[after]], axis=1)
            segment = [first, last[::-1], *sides]
            faces += segment if _right_handed(run) else [face[::-1] for face in segment]
            owner += [stone] * len(segment)
        points.append(place.reshape(-1, 3))
        count += points[-1].shape[0]
    return owner, faces, np.concatenate(points)


def _right_handed(run: Run) -> bool:
    normal, along = run.side.normal, run.side.along
    return bool(normal[0] * along[1] - normal[1] * along[0] > 0)


def _local(place: FloatArray, faces: list[IntArray]) -> tuple[FloatArray, list[IntArray]]:
    used, number = np.unique(np.concatenate(faces), return_inverse=True)
    return place[used], np.split(number.ravel(), np.cumsum([len(face) for face in faces])[:-1])


def stone_parts(vault: Vault) -> tuple[NameArray, IntArray, NameArray]:
    """Return the macro-element, the course and the name of each stone (n,).

    Names are "part-course-number", numbered in each course, and "part-number" of voussoirs.
    """
    part, course = np.empty(vault.stone_count, dtype=np.object_), np.empty(vault.stone_count, dtype=np.int64)
    group: dict[int, str] = {}
    for run in vault.runs:
        part[run.stone], course[run.stone] = run.part, run.course
        group |= dict.fromkeys(run.stone.tolist(), run.part if run.of_ring else f"{run.part}-{run.course:02d}")
    number: Counter[str] = Counter()
    names: list[str] = []
    for stone in range(vault.stone_count):
        names.append(f"{group[stone]}-{number[group[stone]]:03d}")
        number[group[stone]] += 1
    return part.astype(np.str_), course, np.array(names)
