"""Sections of the courses of a vault: between joints across its thickness, from springing to springing or to the crown."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arrays import FloatArray, floats, store
from churchpipe.model.vault import Section

# Corners closer than this are one, m.
_ONE = 1e-9


@dataclass(frozen=True, slots=True)
class Directrix:
    """The curve of a vault: joints (m + 1, 2, 2) m, the inner and the outer point (d, z) of each joint, from the right springing
    upwards, straight from one to the next."""

    joints: FloatArray

    def __post_init__(self) -> None:
        store(self, joints=floats("Directrix.joints", self.joints, (None, 2, 2)))
        if len(self.joints) < 2:
            raise InputError("Directrix.joints", "no course", found=len(self.joints), expected="2 joints or more")

    @property
    def sections(self) -> list[Section]:
        """The sections between its joints."""
        return [between(lower, upper) for lower, upper in zip(self.joints[:-1], self.joints[1:], strict=True)]

    def raised(self, by: float) -> "Directrix":
        """Return the curve moved up, m."""
        return Directrix(self.joints + np.array([0.0, by]))


def between(lower: FloatArray, upper: FloatArray) -> Section:
    """Return the section between two joints (2, 2) m, inner and outer points; a joint may be a single point."""
    corner = np.array([lower[0], lower[1], upper[1], upper[0]])
    return polygon_section(corner, lower.mean(axis=0), upper.mean(axis=0))


def polygon_section(corner: FloatArray, lower: FloatArray, upper: FloatArray) -> Section:
    """Return a section of corners (k, 2) m in either sense, without those that are there twice."""
    apart = np.linalg.norm(corner - np.roll(corner, 1, axis=0), axis=1) > _ONE
    kept = corner[apart]
    x, z = (kept - kept[0]).T
    turn = float(x @ np.roll(z, -1) - z @ np.roll(x, -1))
    return Section(kept if turn > 0 else kept[::-1], lower, upper)


def block(inner: float, outer: float, low: float, high: float) -> Section:
    """Return the section of a course of a wall: its faces at d = inner and outer, its beds at z = low and high, m."""
    corner = np.array([(inner, low), (outer, low), (outer, high), (inner, high)])
    middle = (inner + outer) / 2
    return polygon_section(corner, np.array([middle, low]), np.array([middle, high]))


def circular(inner: float, thickness: float, angles: FloatArray, centre: float = 0.0) -> Directrix:
    """Return an arc of a circle of this inner radius, m, about (centre, 0), with joints at angles (m + 1,) rad from the level."""
    ray = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    # A quarter turn is upright to the last digit.
    ray[np.abs(ray) < 1e-15] = 0.0
    return Directrix(ray[:, None, :] * np.array([inner, inner + thickness])[:, None] + np.array([centre, 0.0]))


def to_crown(courses: int, start: float = 0.0) -> FloatArray:
    """Return the angles (courses + 2,) rad of the joints of half an arc and of its crown: courses, and half a key."""
    step = (math.pi / 2 - start) / (courses + 0.5)
    return np.append(start + step * np.arange(courses + 1), math.pi / 2)


def pointed(inner: float, thickness: float, centre: float, pieces: Sequence[float]) -> Directrix:
    """Return a pointed arch, springing to springing: arcs of an inner radius, m, about (-centre, 0) and (centre, 0).

    pieces: where the joints of the right half lie, from 0 at the springing to 1 at the crown. The joint of the crown is upright.
    """
    apex = math.acos(centre / inner)
    right = circular(inner, thickness, apex * np.asarray(pieces), -centre).joints.copy()
    right[-1] = [[0.0, math.sqrt(radius**2 - centre**2)] for radius in (inner, inner + thickness)]
    left = right[-2::-1] * np.array([-1.0, 1.0])
    return Directrix(np.concatenate([right, left]))
