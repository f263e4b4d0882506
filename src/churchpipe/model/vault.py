"""Vaults and domes as courses: plane sections that are swept along the sides of a path in plan."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arguments import check_kind, finite, listed, one_of, positive, text, whole
from churchpipe.model.arrays import FloatArray, IntArray, ReadOnly, floats, indices, rows_of, store


@dataclass(frozen=True, slots=True)
class Section(ReadOnly):
    """Section of a course: corner (k, 2) m, a simple polygon in (d, z), counter-clockwise, d being the distance from the side's
    reference line, z height. lower, upper (2,) m: the middles of its joints with the courses below and above."""

    corner: FloatArray
    lower: FloatArray
    upper: FloatArray

    def __post_init__(self) -> None:
        corner = floats("Section.corner", self.corner, (None, 2))
        if len(corner) < 3 or _area(corner) <= 0:
            raise InputError("Section.corner", "not a polygon, counter-clockwise", found=corner.tolist(), expected="area > 0")
        store(
            self,
            corner=corner,
            lower=floats("Section.lower", self.lower, (2,)),
            upper=floats("Section.upper", self.upper, (2,)),
        )
        if np.linalg.norm(self.upper - self.lower) <= 0:
            raise InputError("Section", "both joints in one place", found=self.lower.tolist(), expected="a course of some height")

    @property
    def area(self) -> float:
        """Area, m2."""
        return _area(self.corner)

    @property
    def centroid(self) -> FloatArray:
        """Centroid (2,) m."""
        local = self.corner - self.corner[0]
        after = np.roll(local, -1, axis=0)
        cross = local[:, 0] * after[:, 1] - local[:, 1] * after[:, 0]
        return self.corner[0] + cross @ (local + after) / (3 * cross.sum())

    @property
    def mirrored(self) -> "Section":
        """The section on the other side of the reference line."""
        turned = np.array([-1.0, 1.0])
        return Section((self.corner * turned)[::-1], self.lower * turned, self.upper * turned)

    def stretched(self, ratio: float) -> "Section":
        """Return the section with all distances d multiplied by a ratio > 0."""
        scale = np.array([ratio, 1.0])
        return Section(self.corner * scale, self.lower * scale, self.upper * scale)

    @property
    def height(self) -> float:
        """Distance of its joints, m."""
        return float(np.linalg.norm(self.upper - self.lower))


@dataclass(frozen=True, slots=True)
class Side(ReadOnly):
    """One side of a path in plan: a point of the reference line, m, its normal and its direction, unit vectors (2,)."""

    origin: FloatArray
    normal: FloatArray
    along: FloatArray

    def __post_init__(self) -> None:
        values = {key: floats(f"Side.{key}", getattr(self, key), (2,)) for key in ("origin", "normal", "along")}
        store(self, **values)
        gram = np.array([self.normal @ self.normal - 1, self.along @ self.along - 1, self.normal @ self.along])
        if np.abs(gram).max() > 1e-9:
            raise InputError("Side", "directions are not orthonormal", found=f"{self.normal.tolist()}, {self.along.tolist()}")


@dataclass(frozen=True, slots=True)
class Run(ReadOnly):
    """A course along one side, cut into segments at stations: vertical planes s = a + c d, s along the side.

    stations (m + 1, 2): a in m, and c, in order along the side. stone (m,): the stone that each segment belongs to; all segments
    of one number, on any side, are one stone, and share whole faces. course: number of the course, -1 for a ring of voussoirs.
    part: macro-element. length: of the stones, m, as in the unit cell.
    """

    section: Section
    side: Side
    stations: FloatArray
    stone: IntArray
    course: int
    part: str
    length: float

    def __post_init__(self) -> None:
        where = f"Run of {text('Run.part', self.part)}"
        check_kind(f"{where}: section", self.section, Section)
        check_kind(f"{where}: side", self.side, Side)
        whole(f"{where}: course", self.course, least=-1)
        positive(f"{where}: length", self.length)
        count = rows_of(f"{where}: stone", self.stone)
        store(
            self,
            stations=floats(f"{where}: stations", self.stations, (count + 1, 2)),
            stone=indices(f"{where}: stone", self.stone, (count,)),
        )
        s = self.stations[:, :1] + self.stations[:, 1:] * self.section.corner[:, 0]
        if not count or (np.diff(s, axis=0) < -1e-12).any() or (np.diff(s, axis=0).max(axis=1) <= 0).any():
            raise InputError(
                where, "stations cross, or are none", found=self.stations.tolist(), expected="in order along the side"
            )

    @property
    def of_ring(self) -> bool:
        """Whether its stones are voussoirs of a ring, which lie in no course."""
        return self.course < 0

    @property
    def volume(self) -> FloatArray:
        """Volume of each segment (m,), m3: the area of the section times the length at its centroid."""
        return self.section.area * (np.diff(self.stations, axis=0) @ np.array([1.0, self.section.centroid[0]]))


@dataclass(frozen=True, slots=True)
class Vault:
    """A vault, a dome or a part of one: courses that fit on one another because they share joints, sides and mitres.

    beds: what the continuous joints follow, the "path", or the "section" where rings of voussoirs stand side by side. A ring's
    width is the `length` of its runs. shell: what it is in the second model: "facets" of a mid-surface; "bodies", each of its
    stones a rigid body with a name of its own as part; or "none", as masonry on the haunches, arches and ribs below a vault,
    which the shell refuses.
    """

    name: str
    runs: tuple[Run, ...]
    material: str = "default"
    beds: Literal["path", "section"] = "path"
    shell: Literal["facets", "bodies", "none"] = "facets"

    def __post_init__(self) -> None:
        where = f"Vault {text('Vault.name', self.name)}"
        one_of(f"{where}.beds", self.beds, "path", "section")
        text(f"{where}.material", self.material)
        one_of(f"{where}.shell", self.shell, "facets", "bodies", "none")
        store(self, runs=tuple(listed(f"{where}.runs", self.runs, Run)))
        if not self.runs:
            raise InputError(f"{where}.runs", "no course", expected="at least one")
        used = np.unique(np.concatenate([run.stone for run in self.runs]))
        if (used != np.arange(len(used))).any():
            raise InputError(
                f"{where}.runs", "stones are not numbered without gaps", found=used.tolist()[:8], expected="0, 1, 2 ..."
            )

    @property
    def stone_count(self) -> int:
        """Number of stones."""
        return 1 + max(int(run.stone.max()) for run in self.runs)

    @property
    def volume(self) -> float:
        """Volume, m3."""
        return float(sum(run.volume.sum() for run in self.runs))

    @property
    def parts(self) -> tuple[str, ...]:
        """Names of its macro-elements."""
        return tuple(dict.fromkeys(run.part for run in self.runs))

    @property
    def foot(self) -> float:
        """Height z of its lowest point, m."""
        return min(finite("foot", float(run.section.corner[:, 1].min())) for run in self.runs)


def _area(corner: FloatArray) -> float:
    local = corner - corner[0]
    after = np.roll(local, -1, axis=0)
    return 0.5 * float((local[:, 0] * after[:, 1] - local[:, 1] * after[:, 0]).sum())
