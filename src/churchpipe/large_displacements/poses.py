"""Where rigid stones are: finite rotations and translations, moved exactly."""

from copy import copy
from dataclasses import dataclass

import numpy as np

from churchpipe.model.arrays import BoolArray, FloatArray, IntArray, floats, store
from churchpipe.model.assemblage import Assemblage

# Below this angle, rad, the series of the screw motion is exact to rounding.
_SMALL = 1e-4


@dataclass(frozen=True, slots=True)
class Poses:
    """Positions of stones: centroid (nb, 3) m and rotation (nb, 3, 3) from the axes of the drawing."""

    centroid: FloatArray
    rotation: FloatArray

    def __post_init__(self) -> None:
        centroid = floats("Poses.centroid", self.centroid, (None, 3))
        store(self, centroid=centroid, rotation=floats("Poses.rotation", self.rotation, (len(centroid), 3, 3)))

    def place(self, stone: IntArray, arm: FloatArray) -> FloatArray:
        """Return where points (n, 3) of these stones (n,) are; arms from the centroid in the axes of the drawing."""
        return self.centroid[stone] + np.einsum("kij,kj->ki", self.rotation[stone], arm)

    def arm(self, stone: IntArray, place: FloatArray) -> FloatArray:
        """Return the arms (n, 3) of points of these stones (n,), in the axes of the drawing."""
        return np.einsum("kji,kj->ki", self.rotation[stone], place - self.centroid[stone])

    def moved(self, twist: FloatArray) -> "Poses":
        """Return the poses after a screw motion (nb, 6) m and rad, translation of the centroid and rotation.

        A stone that turns about an axis at rest keeps that axis where it is, however far it turns: the velocity is constant in
        space, and not that of the centroid.
        """
        turn, drift = screw(twist[:, 3:])
        return Poses(self.centroid + np.einsum("kij,kj->ki", drift, twist[:, :3]), np.einsum("kij,kjl->kil", turn, self.rotation))


def start_poses(stones: Assemblage) -> Poses:
    """Return the poses of stones as drawn."""
    return Poses(stones.centroid, np.broadcast_to(np.eye(3), (stones.count, 3, 3)).copy())


def displaced(stones: Assemblage, poses: Poses, fixed: BoolArray | None = None) -> Assemblage:
    """Return the stones at other poses; fixed (nb,): which are, if not those of the drawing.

    A rigid motion leaves sound stones sound: they are not looked at again, which would take longer than all else in a step.
    """
    owner = np.repeat(np.arange(stones.count), np.diff(stones.block_point_ptr))
    points = poses.place(owner, stones.points - stones.centroid[owner])
    out = copy(stones)
    store(out, points=points, centroid=poses.centroid, fixed=stones.fixed if fixed is None else fixed)
    return out


def screw(rotation: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the rotations (n, 3, 3) of rotation vectors (n, 3) rad, and the means (n, 3, 3) of the rotation on its way there."""
    angle = np.linalg.norm(rotation, axis=1)
    small = angle < _SMALL
    safe = np.where(small, 1.0, angle)
    square = angle**2
    first = np.where(small, 1 - square / 6, np.sin(safe) / safe)
    second = np.where(small, 0.5 - square / 24, (1 - np.cos(safe)) / safe**2)
    third = np.where(small, 1 / 6 - square / 120, (safe - np.sin(safe)) / safe**3)
    cross = np.zeros((len(rotation), 3, 3))
    x, y, z = rotation.T
    cross[:, 0, 1], cross[:, 0, 2], cross[:, 1, 2] = -z, y, -x
    cross -= cross.transpose(0, 2, 1)
    twice = cross @ cross
    turn = np.eye(3) + first[:, None, None] * cross + second[:, None, None] * twice
    drift = np.eye(3) + second[:, None, None] * cross + third[:, None, None] * twice
    return turn, drift


def rotation_vectors(rotation: FloatArray) -> FloatArray:
    """Return the rotation vectors (n, 3) rad of rotations (n, 3, 3), each shorter than pi."""
    skew = 0.5 * (rotation - rotation.transpose(0, 2, 1))
    sine = np.stack([skew[:, 2, 1], skew[:, 0, 2], skew[:, 1, 0]], axis=1)
    cosine = 0.5 * (np.trace(rotation, axis1=1, axis2=2) - 1)
    length = np.linalg.norm(sine, axis=1)
    angle = np.arctan2(length, cosine)
    return sine * np.where(length > 0, angle / np.where(length > 0, length, 1.0), 1.0)[:, None]
