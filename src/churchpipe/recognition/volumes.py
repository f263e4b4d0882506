"""A wall that is given whole, as one closed volume without stones: its mid-plane, its outline and its thickness."""

from dataclasses import dataclass

import numpy as np

from churchpipe.errors import InputError
from churchpipe.geometry.planar import Polygon, area, pieces, polygon, united
from churchpipe.geometry.polygons import snap
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.building import PlaneChart
from churchpipe.model.polyhedra import face_normals, solid_properties
from churchpipe.recognition.wall_planes import outward

# Faces that lean less than this against the front are the front, or the back (rad); those at right angles to it within this are
# its ends, its top and the sides of its openings.
FACING, SQUARE = 0.15, 0.05
# The front is looked for among faces whose normals rise less than this.
STEEP = 0.5
# A wall leans no more than this (rad), and its two faces are flat within this share of its thickness.
UPRIGHT, EVEN = 0.02, 0.02
# Share of the volume that may lie outside of outline x thickness: the roughness of a scan.
ROUGH = 0.01
# A body turns when more than this share of its upright area is at a slant to the largest of it.
TURNING = 0.25
# Only so many of the largest faces may say where the front is.
LARGEST = 200


@dataclass(frozen=True, slots=True)
class WallVolume:
    """A wall without stones: its chart, its outline less openings m, thickness m and volume m3, which of a body whose faces are
    not quite flat differs a little from area x thickness."""

    chart: PlaneChart
    region: Polygon
    thickness: float
    volume: float


def wall_volume(points: FloatArray, faces: "list[tuple[int, ...]]", base: float) -> WallVolume:
    """Return the wall that a closed body is: two upright parallel faces, and everything else at right angles to them.

    points (n, 3) m; faces: corners of each, counter-clockwise from outside. base: height of t = 0, m.

    Raises
    ------
    InputError: the body is no wall; the message says why, and where.
    """
    nodes = np.concatenate([np.array(face, dtype=np.int64) for face in faces])
    pointer = np.cumsum([0, *map(len, faces)])
    area_vector, normal, mean = face_normals(points, nodes, pointer)
    size = np.linalg.norm(area_vector, axis=1)
    across = _front_normal(area_vector, normal, size)
    _check_plane(normal, size, across)
    slope = normal @ across
    front, back = slope > np.cos(FACING), slope < -np.cos(FACING)
    offset = points @ across
    far, near = (_level(offset, nodes, pointer, side, size) for side in (front, back))
    thickness = far - near
    _check_single(points @ across, nodes, pointer, front, back)
    _check_even(points, offset, nodes, pointer, (front, back), (far, near))
    askew = ~front & ~back & (np.abs(slope) > np.sin(SQUARE)) & (size > 1e-6 * size.sum())
    if askew.any():
        worst = int(np.argmax(np.where(askew, size, 0.0)))
        raise _no_wall(
            "a side is not at right angles to its front",
            f"{np.degrees(np.arccos(abs(slope[worst]))):.3g} degrees to the front, {_at(mean[worst])}",
            "two parallel upright faces, and ends, top and reveals at right angles to them",
            "Square it up: at a corner one wall runs to the far face of the other, at a slant one ends square before the other, "
            "and a splayed reveal has its mean width.",
        )
    along = np.cross([0.0, 0.0, 1.0], across)
    start = float((points @ along).min())
    chart = PlaneChart(0.5 * (far + near) * across + start * along + np.array([0.0, 0.0, base]), along)
    flat = np.stack([snap(points @ along - start), snap(points[:, 2] - base)], axis=1)
    region = united([polygon(flat[nodes[pointer[k] : pointer[k + 1]]]) for k in np.flatnonzero(front)])
    found = pieces(region)
    if len(found) != 1:
        raise _no_wall("its front is in pieces", f"{len(found)} pieces", "one front", "Make each piece a body of its own.")
    volume = float(solid_properties(points, nodes, pointer, np.array([0, len(faces)]))[0][0])
    excess = area(found[0]) * thickness / volume - 1
    if abs(excess) > ROUGH:
        raise _no_wall(
            "its volume is not that of its front times its thickness",
            f"{area(found[0]):.6g} m2 x {thickness:.6g} m for {volume:.6g} m3",
            "openings that go through, and the same outline in front and behind",
            "Fill niches, or give their back as a thinner wall of its own.",
        )
    return WallVolume(chart, found[0], thickness, volume)


def _front_normal(area_vector: FloatArray, normal: FloatArray, size: FloatArray) -> FloatArray:
    """Return the level unit normal (3,) of the front: the direction, forwards and backwards, that most area faces."""
    upright = np.flatnonzero(np.abs(normal[:, 2]) < STEEP)
    largest = upright[np.argsort(-size[upright])[:LARGEST]]
    if not len(largest):
        raise _no_wall("it has no upright face", "none", "two upright parallel faces", "Check which axis points up: --up.")
    facing = np.abs(normal[largest] @ normal.T) > np.cos(FACING)
    best = normal[largest[np.argmax(facing @ size)]]
    slope = normal @ best
    total = area_vector[slope > np.cos(FACING)].sum(axis=0) - area_vector[slope < -np.cos(FACING)].sum(axis=0)
    total /= np.linalg.norm(total)
    if abs(total[2]) > np.sin(UPRIGHT):
        raise _no_wall(
            "it leans",
            f"{np.degrees(np.arcsin(abs(total[2]))):.3g} degrees",
            "an upright wall",
            "Stand it up before the import. Where it is a stone of an arch, draw the whole ring as one outline.",
        )
    level = np.array([total[0], total[1], 0.0]) / np.hypot(total[0], total[1])
    return level if outward(level) else -level


def _check_plane(normal: FloatArray, size: FloatArray, across: FloatArray) -> None:
    """Raise InputError for a body that turns: much of its upright area is neither parallel nor at right angles to its front."""
    upright = np.abs(normal[:, 2]) < STEEP
    slope = np.abs(normal @ across)
    aslant = upright & (slope < np.cos(FACING)) & (slope > np.sin(FACING))
    if size[aslant].sum() > TURNING * size[upright].sum():
        raise _no_wall(
            "it is curved, or several walls at slants",
            f"{100 * size[aslant].sum() / size[upright].sum():.0f} % of its upright faces neither along the front nor across it",
            "a plane wall",
            "Cut it into plane lengths and give each as a body of its own; "
            "churchpipe generate apse, or tower, lays curved walls from dimensions.",
        )


def _check_single(offset: FloatArray, nodes: IntArray, pointer: IntArray, front: BoolArray, back: BoolArray) -> None:
    """Raise InputError for a body in which one wall stands behind another: a back that lies in front of a front."""
    mean = np.add.reduceat(offset[nodes], pointer[:-1]) / np.diff(pointer)
    behind, before = float(mean[front].min()), float(mean[back].max())
    if before > behind:
        raise _no_wall(
            "it is several walls in one body",
            f"walls one behind the other, {before - behind:.4g} m apart",
            "one wall a body",
            "Cut the building where its walls meet, and give each wall as a body of its own.",
        )


def _level(offset: FloatArray, nodes: IntArray, pointer: IntArray, side: BoolArray, size: FloatArray) -> float:
    """Return where the front or the back lies along the normal: the mean of its faces by area, m."""
    mean = np.add.reduceat(offset[nodes], pointer[:-1]) / np.diff(pointer)
    if not side.any():
        raise _no_wall("it has a front and no back", "one face", "two parallel upright faces", "Close the body.")
    return round(float(np.average(mean[side], weights=size[side])), 12)


def _check_even(
    points: FloatArray,
    offset: FloatArray,
    nodes: IntArray,
    pointer: IntArray,
    sides: tuple[BoolArray, BoolArray],
    levels: tuple[float, float],
) -> None:
    """Raise InputError where a corner of the front or the back does not lie in its plane."""
    thickness = levels[0] - levels[1]
    owner = np.repeat(np.arange(len(pointer) - 1), np.diff(pointer))
    for side, level, other in zip(sides, levels, levels[::-1], strict=True):
        corner = nodes[side[owner]]
        off = np.abs(offset[corner] - level)
        worst = int(corner[np.argmax(off)])
        if off.max() > EVEN * abs(thickness):
            usual = float(np.median(np.abs(offset[corner] - other)))
            raise _no_wall(
                "its thickness is not constant",
                f"{abs(offset[worst] - other):.4g} m thick {_at(points[worst])}, {usual:.4g} m where most of it is",
                f"one thickness, to {100 * EVEN:g} %",
                "Cut the body where the thickness changes, or where walls meet, and give each part as a body of its own.",
            )


def _at(point: FloatArray) -> str:
    return f"at ({', '.join(f'{value:.3f}' for value in point.tolist())}) m"


def _no_wall(problem: str, found: str, expected: str, remedy: str) -> InputError:
    return InputError("the body", problem, found=found, expected=expected, remedy=remedy)
