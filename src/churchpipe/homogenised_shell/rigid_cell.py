"""The periodic cell of rigid stones of any bond: its joints, and how they close when the wall is strained and the stones move.

A stone in the period that lies at v (a sum of steps of the bond) moves like the plate there: translation E v in the plane and
-1/2 v chi v out of it, and the rotation that turns the plate's normal by chi v. E is the membrane strain, chi the curvature. In
every period each stone has the same motion of its own besides, a translation and a rotation about its centre. The translation of
the first stone would move the wall as a whole, so it is none.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from churchpipe.bond.period import Period, period_of
from churchpipe.model.arrays import FloatArray

# Stones closer than this share of the least size of a stone touch.
_TOUCH = 1e-9
# A period's stones touch those of periods at most so many steps away.
_AWAY = 2


@dataclass(frozen=True, slots=True)
class RigidCell:
    """A periodic cell and the closing of its joints per area of wall, closing_kci (corners, 3, 6 + motions), 1/m and 1/m2.

    Corner k, component c (normal, closing positive; two along the joint), variable i (the six strains, then the motions of the
    stones). Corner forces f_kc, N, make the stress sum_kc f_kc closing_kci, and the sums for the motions vanish.
    area: of the wall that the cell fills, m2; joints (nj,): areas of the joints, m2, each with four corners one after the other.
    Motions: rotation of the first stone, then translation and rotation of the others, without those that no joint feels.
    """

    closing: FloatArray
    area: float
    joints: FloatArray


@dataclass(frozen=True, slots=True)
class _Joint:
    """A rectangle `sides` (3, 2) between stones `lower` and `upper`, that one of the period at `place` (2,); normal: axis 0-2."""

    lower: int
    upper: int
    place: FloatArray
    sides: FloatArray
    normal: int


@lru_cache(maxsize=256)
def rigid_cell(bond: str, a: float, b: float, h: float) -> RigidCell:
    """Return the cell of a bond of courses of height a, stones of length b, in a wall of thickness h, m.

    Raises
    ------
    InputError: unknown bond.
    """
    period = period_of(bond, a, b, h)
    found = _joints(period)
    out = np.concatenate([_closing(period, joint, _corners(joint.sides)) for joint in found]) / period.area
    # A translation that no joint feels, as of a leaf that nothing ties, is no unknown.
    out = out[..., np.append(np.ones(6, dtype=np.bool_), np.abs(out[..., 6:]).max(axis=(0, 1)) > 0)]
    areas = np.array([float(np.prod(np.delete(np.ptp(joint.sides, axis=1), joint.normal))) for joint in found], dtype=np.float64)
    for array in (out, areas):
        array.setflags(write=False)
    return RigidCell(out, period.area, areas)


def _joints(period: Period) -> list[_Joint]:
    least = _TOUCH * float(np.ptp(period.stones, axis=2).min())
    out: list[_Joint] = []
    steps = np.arange(-_AWAY, _AWAY + 1)
    for lower, first in enumerate(period.stones):
        for i, j in ((i, j) for i in steps for j in steps):
            place = np.append(np.array([i, j]) @ period.steps, 0.0)
            for upper in np.flatnonzero(period.layer == period.layer[lower]).tolist():
                stone = period.stones[upper]
                second = stone + place[:, None]
                for normal in range(3):
                    sides = np.stack([np.maximum(first[:, 0], second[:, 0]), np.minimum(first[:, 1], second[:, 1])], axis=1)
                    meets = abs(second[normal, 0] - first[normal, 1]) <= least
                    if meets and (np.delete(sides[:, 1] - sides[:, 0], normal) > least).all():
                        sides[normal] = first[normal, 1]
                        out.append(_Joint(lower, upper, place[:2], sides, normal))
    return out


def _corners(sides: FloatArray) -> FloatArray:
    """Return the corners (4, 3) of a rectangle, in order."""
    flat = np.flatnonzero(np.ptp(sides, axis=1) > 0)
    out = np.repeat(sides[None, :, 0], 4, axis=0)
    out[:, flat[0]] = sides[flat[0], [0, 0, 1, 1]]
    out[:, flat[1]] = sides[flat[1], [0, 1, 1, 0]]
    return out


def _closing(period: Period, joint: _Joint, points: FloatArray) -> FloatArray:
    """Return the closing (points, 3, 6 + motions) of a joint: normal, along the first of the other two axes and the second."""
    count = len(period.stones)
    v1, v2 = joint.place
    y3 = points[:, 2] - period.layer[joint.lower]
    r1, r2 = points[:, 0] - v1, points[:, 1] - v2
    zero, one = np.zeros(len(points)), np.ones(len(points))
    plate = np.stack(
        [
            np.stack([v1 * one, zero, v2 / 2 * one, y3 * v1, zero, y3 * v2 / 2], axis=1),
            np.stack([zero, v2 * one, v1 / 2 * one, zero, y3 * v2, y3 * v1 / 2], axis=1),
            np.stack([zero, zero, zero, -v1 * (v1 / 2 + r1), -v2 * (v2 / 2 + r2), -(v1 * v2 + v2 * r1 + v1 * r2) / 2], axis=1),
        ],
        axis=1,
    )
    own = np.zeros((len(points), 3, 6 * count))
    for stone, place, sign in ((joint.upper, joint.place, 1.0), (joint.lower, np.zeros(2), -1.0)):
        arm = points - np.append(place, 0.0) - period.stones[stone].mean(axis=1)
        own[:, :, 6 * stone : 6 * stone + 3] += sign * np.eye(3)
        # Rotation w moves the arm r by w x r.
        own[:, :, 6 * stone + 3 : 6 * stone + 6] += sign * np.cross(np.eye(3)[None], arm[:, None]).swapaxes(1, 2)
    opening = np.concatenate([plate, own[:, :, 3:]], axis=2)
    others = [axis for axis in range(3) if axis != joint.normal]
    return -opening[:, [joint.normal, *others]]
