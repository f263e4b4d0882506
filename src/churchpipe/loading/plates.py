"""Anchor plates on the faces of stones."""

import numpy as np

from churchpipe.errors import InputError
from churchpipe.geometry.punching import level_frame
from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.polyhedra import face_normals
from churchpipe.model.ties import Anchor

# A plate lies on faces that look its way to this cosine, and whose planes pass it within this distance, m.
_SAME_WAY = 0.9
_APART = 2e-3
# The least part of a plate that has masonry under it.
_COVERED = 0.999


def plate_on(stones: Assemblage, where: str, centre: FloatArray, outward: FloatArray, size: tuple[float, float]) -> Anchor:
    """Return the stones under a plate of this width and height (m), each with its share by area and where that is pressed.

    Parameters
    ----------
    centre: of the plate (3,) m, on the face. outward: unit vector (3,) that the face looks along.

    Raises
    ------
    InputError: no face there, or one that the plate overhangs.
    """
    faces = _faces_at(stones, centre, outward, 0.5 * float(np.hypot(*size)))
    parts: list[tuple[int, float, FloatArray]] = []
    for face in faces:
        corners = stones.points[stones.face_nodes[stones.face_ptr[face] : stones.face_ptr[face + 1]]]
        _, (normal,), _ = face_normals(corners, np.arange(len(corners)), np.array([0, len(corners)]))
        frame = level_frame(normal)
        inside = _within((corners - centre) @ frame.T, 0.5 * np.array(size))
        area, middle = _area_and_middle(inside)
        if area > 0:
            stone = int(np.searchsorted(stones.block_face_ptr, face, side="right")) - 1
            parts.append((stone, area, centre + middle @ frame))
    covered = sum(area for _, area, _ in parts) / (size[0] * size[1])
    if covered < _COVERED:
        raise InputError(
            where,
            "its plate is not on masonry" if not parts else "its plate overhangs the masonry",
            found=f"{100 * covered:.3g} % of {size[0]:g} x {size[1]:g} m at {centre.round(4).tolist()} m on stones",
            expected="a plane face of stones under all of it",
            remedy="Move it from the opening or the edge, make it smaller, or look whether the bar ends on the wall's face.",
        )
    stone = np.array([stone for stone, _, _ in parts])
    share = np.array([area for _, area, _ in parts])
    return Anchor(stone, np.array([point for *_, point in parts]), share / share.sum(), stones.panel[stone])


def _faces_at(stones: Assemblage, centre: FloatArray, outward: FloatArray, reach: float) -> list[int]:
    low, high = (edge.reduceat(stones.points, stones.block_point_ptr[:-1], axis=0) for edge in (np.minimum, np.maximum))
    near = np.flatnonzero(((low <= centre + reach) & (high >= centre - reach)).all(axis=1))
    found: list[int] = []
    for stone in near.tolist():
        for face in range(*stones.block_face_ptr[stone : stone + 2]):
            corners = stones.points[stones.face_nodes[stones.face_ptr[face] : stones.face_ptr[face + 1]]]
            _, (normal,), (mean,) = face_normals(corners, np.arange(len(corners)), np.array([0, len(corners)]))
            if normal @ outward > _SAME_WAY and abs((mean - centre) @ normal) < _APART:
                found.append(face)
    return found


def _within(polygon: FloatArray, half: FloatArray) -> FloatArray:
    """Return the part (n, 2) of a polygon in a rectangle of these half sides about the origin."""
    for axis in (0, 1):
        for sign in (1.0, -1.0):
            kept: list[FloatArray] = []
            room = half[axis] - sign * polygon[:, axis]
            for k in range(len(polygon)):
                after = (k + 1) % len(polygon)
                if room[k] >= 0:
                    kept.append(polygon[k])
                if np.sign(room[k]) * np.sign(room[after]) < 0:
                    kept.append(polygon[k] + room[k] / (room[k] - room[after]) * (polygon[after] - polygon[k]))
            polygon = np.array(kept).reshape(-1, 2)
    return polygon


def _area_and_middle(polygon: FloatArray) -> tuple[float, FloatArray]:
    if len(polygon) < 3:
        return 0.0, np.zeros(2)
    after = np.roll(polygon, -1, axis=0)
    cross = polygon[:, 0] * after[:, 1] - after[:, 0] * polygon[:, 1]
    double = float(cross.sum())
    if not abs(double) > 1e-12:
        return 0.0, np.zeros(2)
    return 0.5 * abs(double), np.asarray((cross @ (polygon + after)) / (3 * double))
