"""The curve of a vault from its span, shape and rise, and what stands or lies beside it: walls, skewbacks, backing."""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arrays import FloatArray
from churchpipe.model.building import Support
from churchpipe.model.vault import Section
from churchpipe.vaults.directrix import Directrix, between, block, circular, pointed, polygon_section, to_crown

Shape = Literal["round", "segmental", "pointed"]


@dataclass(frozen=True, slots=True)
class Profile:
    """Clear span, thickness and height of the springing of a vault, m; shape and rise, m, of its soffit (None: a half circle);
    courses from springing to springing, an odd number, so that a key is in the middle. where: the parameters, for messages."""

    where: str
    span: float
    thickness: float
    courses: int
    shape: Shape = "round"
    rise: float | None = None
    springing: float = 0.0

    def __post_init__(self) -> None:
        if self.courses % 2 == 0 or self.courses < 3:
            raise InputError(
                f"{self.where}.courses",
                "no key in the middle",
                found=self.courses,
                expected=f"an odd number, such as {self.courses | 1}",
            )
        half, rise = self.span / 2, self.rise
        if (rise is not None) != (self.shape != "round"):
            raise InputError(
                f"{self.where}.rise", "given or left out wrongly", found=rise, expected="a rise of segmental and pointed vaults"
            )
        if rise is not None and (rise < half) != (self.shape == "segmental"):
            expected = f"{'<' if self.shape == 'segmental' else '>'} half the span, {half:g} m"
            raise InputError(f"{self.where}.rise", f"no {self.shape} vault", found=f"{rise:g} m", expected=expected)

    @property
    def inner(self) -> float:
        """Radius of the soffit, m."""
        half, rise = self.span / 2, self.height
        return half + self.centre if self.shape == "pointed" else (half**2 + rise**2) / (2 * rise)

    @property
    def height(self) -> float:
        """Height of the soffit's crown over the springing, m."""
        return self.span / 2 if self.rise is None else self.rise

    @property
    def centre(self) -> float:
        """Distance of the centres of a pointed vault from its middle, m."""
        half = self.span / 2
        return (self.height**2 - half**2) / (2 * half) if self.shape == "pointed" else 0.0

    @property
    def start(self) -> float:
        """Angle of the springing joint over the level, rad."""
        return math.asin(1 - self.height / self.inner) if self.shape == "segmental" else 0.0

    @property
    def level(self) -> float:
        """Height of the circle's centre, m."""
        return self.springing - self.inner * math.sin(self.start)

    @property
    def whole(self) -> Directrix:
        """The curve from springing to springing; a pointed one has an upright joint more, in the middle of its key."""
        if self.shape == "pointed":
            return pointed(self.inner, self.thickness, self.centre, self._steps()).raised(self.level)
        angles = np.linspace(self.start, math.pi - self.start, self.courses + 1)
        return circular(self.inner, self.thickness, angles).raised(self.level)

    @property
    def voussoir(self) -> list[int]:
        """The course of each section of `whole`."""
        if self.shape != "pointed":
            return list(range(self.courses))
        half = (self.courses - 1) // 2
        return [*range(half + 1), *range(half, self.courses)]

    @property
    def halved(self) -> Directrix:
        """The curve with twice as many joints, which rings of voussoirs need."""
        if self.shape == "pointed":
            steps = np.linspace(0.0, 1.0, self.courses + 1).tolist()
            return pointed(self.inner, self.thickness, self.centre, steps).raised(self.level)
        angles = np.linspace(self.start, math.pi - self.start, 2 * self.courses + 1)
        return circular(self.inner, self.thickness, angles).raised(self.level)

    @property
    def half(self) -> Directrix:
        """The curve from the right springing to the key; of a pointed vault to the crown."""
        below = (self.courses - 1) // 2
        if self.shape == "pointed":
            return Directrix(self.whole.joints[: below + 2])
        return circular(self.inner, self.thickness, to_crown(below, self.start)[:-1]).raised(self.level)

    def _steps(self) -> list[float]:
        below = (self.courses - 1) // 2
        return [*(k / (below + 0.5) for k in range(below + 1)), 1.0]


def to_middle(half: Directrix) -> list[Section]:
    """Return the sections of half a vault to d = 0. Half a key closes a curve that ends before, its back and soffit level."""
    last = half.joints[-1]
    return half.sections if abs(last[:, 0]).max() < 1e-9 else [*half.sections, between(last, last * np.array([0.0, 1.0]))]


def fixed_box(name: str, x: tuple[float, float], y: tuple[float, float], z: tuple[float, float]) -> Support:
    """Return a fixed block with its faces at these places, m."""
    corner = np.array([[a, b, c] for c in z for a, b in ((x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1]))])
    return Support(name, corner, ((3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)))


def wall(inner: float, outer: float, low: float, courses: int, height: float) -> list[Section]:
    """Return the sections of a wall's courses, m, from z = low upwards."""
    levels = low + height * np.arange(courses + 1)
    return [block(inner, outer, a, b) for a, b in pairwise(levels.tolist())]


def skewback(joint: FloatArray, outer: float) -> Section | None:
    """Return the section of the stone between a level bed and the lowest joint (2, 2) m of a vault; None where that is level.

    outer: d of its outer face, m, at least that of the joint.
    """
    inside, outside = joint
    if outside[1] - inside[1] < 1e-9:
        return None
    corner = np.array([inside, [outer, inside[1]], [outer, outside[1]], outside])
    foot = np.array([(inside[0] + outer) / 2, inside[1]])
    return polygon_section(corner, foot, joint.mean(axis=0))


def backing(joints: FloatArray, outer: float, height: float) -> list[Section]:
    """Return the sections of a backing on the back of a vault, out to d = `outer` and up to z = `height`, m, in level courses.

    joints (m + 1, 2, 2): of the vault's courses from the springing. The backing ends with the last of its joints within the
    height.
    """
    found: list[Section] = []
    for (_, low), (_, high) in pairwise(joints):
        if high[1] > height + 1e-9 or high[1] <= low[1] + 1e-9:
            break
        corner = np.array([low, [outer, low[1]], [outer, high[1]], high])
        found.append(
            polygon_section(corner, np.array([(low[0] + outer) / 2, low[1]]), np.array([(high[0] + outer) / 2, high[1]]))
        )
    return found


def under_soffit(joints: FloatArray, depth: float) -> Directrix:
    """Return the curve of an arch of this depth, m, below the soffit of a vault, with its joints (m + 1, 2, 2)."""
    inner, outer = joints[:, 0], joints[:, 1]
    ray = (outer - inner) / np.linalg.norm(outer - inner, axis=1, keepdims=True)
    return Directrix(np.stack([inner - depth * ray, inner], axis=1))
