"""Recurrent stones: one shape, moved and turned about the vertical."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage

# Stones are one shape when they coincide to this, m; more only where the numbers themselves are coarser.
SAME_SHAPE = 2e-13
# Grid on which shapes are looked up, m.
LOOKUP_GRID = 1e-7


@dataclass(frozen=True, slots=True)
class Shape:
    """A stone with its first vertex in the origin: points (n, 3) m, faces; heading: of its first long edge in plan, rad."""

    points: FloatArray
    faces: tuple[tuple[int, ...], ...]
    heading: float


@dataclass(frozen=True, slots=True)
class Recurrence:
    """The shapes of an assemblage; for each stone its shape (nb,), its turn about z (nb,), degrees, and its place (nb, 3) m."""

    shapes: tuple[Shape, ...]
    shape: IntArray
    turn: FloatArray
    place: FloatArray


def find_recurrence(stones: Assemblage) -> Recurrence:
    """Find the stones that are one shape up to translation and rotation about z, vertices and faces in the same order.

    Each stone is checked against the points it will be drawn with, so nothing is moved by more than 2e-13 m (or a few units in
    the last place of its coordinates).
    """
    known: dict[tuple[object, ...], list[int]] = {}
    shapes: list[Shape] = []
    shape = np.zeros(stones.count, dtype=np.int64)
    turn = np.zeros(stones.count)
    place = stones.points[stones.block_point_ptr[:-1]]
    tolerance = SAME_SHAPE + 4 * np.finfo(float).eps * float(np.abs(stones.points).max())
    for index in range(stones.count):
        start, end = stones.block_point_ptr[index], stones.block_point_ptr[index + 1]
        points = stones.points[start:end] - place[index]
        faces = _faces(stones, index)
        heading = _heading(points)
        upright = _turned(points, -float(np.degrees(heading)))
        key = (faces, (np.rint(upright / LOOKUP_GRID) + 0.0).tobytes())
        for candidate in known.setdefault(key, []):
            angle = _clean_angle(float(np.degrees(heading - shapes[candidate].heading)))
            if np.abs(_turned(shapes[candidate].points, angle) - points).max() <= tolerance:
                shape[index], turn[index] = candidate, angle
                break
        else:
            shape[index] = len(shapes)
            known[key].append(len(shapes))
            shapes.append(Shape(points, faces, heading))
    return Recurrence(tuple(shapes), shape, turn, place)


def _faces(stones: Assemblage, index: int) -> tuple[tuple[int, ...], ...]:
    first, last = stones.block_face_ptr[index], stones.block_face_ptr[index + 1]
    pointer = stones.face_ptr[first : last + 1]
    nodes = (stones.face_nodes[pointer[0] : pointer[-1]] - stones.block_point_ptr[index]).tolist()
    ends = (pointer - pointer[0]).tolist()
    return tuple(tuple(nodes[a:b]) for a, b in pairwise(ends))


def _heading(points: FloatArray) -> float:
    """Return the direction in plan, rad, from the first vertex to the first of those that are far from it."""
    reach = np.hypot(points[:, 0], points[:, 1])
    far = int(np.argmax(reach > 0.3 * reach.max()))
    return float(np.arctan2(points[far, 1], points[far, 0]))


def _clean_angle(degrees: float) -> float:
    """Return the angle in (-180, 180], exact where it is a right angle but for rounding."""
    angle = 180.0 - (180.0 - degrees) % 360.0
    quarter = 90.0 * round(angle / 90.0)
    return (180.0 if quarter == -180.0 else quarter) + 0.0 if abs(angle - quarter) < 1e-10 else angle


def _turned(points: FloatArray, degrees: float) -> FloatArray:
    angle = np.radians(degrees)
    cosine, sine = float(np.cos(angle)), float(np.sin(angle))
    x, y = points[:, 0], points[:, 1]
    return np.stack([cosine * x - sine * y, sine * x + cosine * y, points[:, 2]], axis=1)
