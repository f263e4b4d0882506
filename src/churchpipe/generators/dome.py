"""Domes and half domes, with drum, oculus and lantern."""

import math
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np

from churchpipe.errors import InputError
from churchpipe.generators.checks import whole_courses
from churchpipe.generators.fields import as_dataclass, coerce_fields, materials_of
from churchpipe.generators.masonry import DEFAULT_MATERIAL
from churchpipe.generators.profile import fixed_box, skewback, wall
from churchpipe.model.arrays import FloatArray
from churchpipe.model.building import Building, Support
from churchpipe.model.materials import UnitWeight
from churchpipe.model.quantities import Count, Length
from churchpipe.model.vault import Section
from churchpipe.vaults.directrix import Directrix, between, circular, polygon_section
from churchpipe.vaults.dome import add_rings
from churchpipe.vaults.sweep import Courses


@dataclass(frozen=True, slots=True)
class DomeParameters:
    """A dome about the z axis, or a half dome behind the plane y = 0."""

    span: Annotated[Length, "Clear diameter at the springing."]
    thickness: Annotated[Length, "Thickness."]
    rings: Annotated[Count, "Rings of stones, the closing stone among them."]
    sides: Annotated[Count, "Flat sides of the plan; of a half dome those of the half circle."] = 32
    stone_sides: Annotated[Count, "Sides of the plan that one stone covers."] = 2
    shortest_stone: Annotated[
        Length | None,
        "Length below which stones of rings towards the crown are not laid: such rings have half as many, twice as long.",
    ] = None
    rise: Annotated[Length | None, "Rise of the soffit; by default a half sphere."] = None
    laid: Annotated[
        Literal["staggered", "lunes"], "Rings staggered by half a stone, or lunes with upright joints from springing to crown."
    ] = "staggered"
    plan: Annotated[Literal["full", "half"], "A full dome or a half one."] = "full"
    oculus: Annotated[Length | None, "Clear diameter of the opening at the crown; the ring around it has a level back."] = None
    drum_height: Annotated[Length | None, "Height of the wall below; by default the dome springs from the ground."] = None
    drum_thickness: Annotated[Length | None, "Thickness of that wall."] = None
    drum_course: Annotated[Length | None, "Height of its courses."] = None
    lantern_height: Annotated[Length | None, "Height of a ring wall on the oculus."] = None
    lantern_thickness: Annotated[Length | None, "Thickness of that ring wall."] = None
    lantern_course: Annotated[Length | None, "Height of its courses."] = None
    front: Annotated[Literal["free", "wall"], "What stands before a half dome: nothing, or a wall that holds it."] = "free"

    def __post_init__(self) -> None:
        coerce_fields(self, "dome.")
        if self.sides < 3 or self.sides % self.stone_sides:
            raise InputError(
                "dome.sides",
                "stones do not go round",
                found=f"{self.sides} sides, {self.stone_sides} a stone",
                expected="3 sides or more, a multiple of stone_sides",
            )
        if self.laid == "staggered" and self.stone_sides % 2:
            raise InputError(
                "dome.stone_sides",
                "stones cannot be shifted by half",
                found=self.stone_sides,
                expected="an even number",
                remedy='Take stone_sides = 2, or laid = "lunes".',
            )
        if self.rise is not None and self.rise > self.span / 2 + 1e-9:
            raise InputError(
                "dome.rise", "higher than a half sphere", found=f"{self.rise:g} m", expected=f"<= {self.span / 2:g} m"
            )
        if self.rings < 2:
            raise InputError("dome.rings", "no ring below the closing stone", found=self.rings, expected=">= 2")
        if self.oculus is not None and self.oculus >= self.span:
            raise InputError("dome.oculus", "no dome is left", found=f"{self.oculus:g} m", expected=f"< {self.span:g} m")
        if self.front == "wall" and self.plan == "full":
            raise InputError("dome.front", "only a half dome has a front", found=self.front, expected='plan = "half"')
        for name, needs in (("drum", None), ("lantern", "oculus")):
            self._check_ring_wall(name, needs)

    def _check_ring_wall(self, name: str, needs: str | None) -> None:
        keys = [f"{name}_{key}" for key in ("height", "thickness", "course")]
        given = [getattr(self, key) for key in keys]
        if all(value is None for value in given):
            return
        for key, value in zip(keys, given, strict=True):
            if value is None:
                raise InputError(f"dome.{key}", "missing", expected=", ".join(keys))
        if needs and getattr(self, needs) is None:
            raise InputError(f"dome.{keys[0]}", f"needs an {needs}", expected=f"dome.{needs}")
        whole_courses(f"dome.{keys[0]}", given[0], given[2])
        widest = self.lantern_room if name == "lantern" else math.inf
        least = self.thickness if name == "drum" else 0.0
        if not least - 1e-9 <= given[1] <= widest + 1e-9:
            raise InputError(
                f"dome.{keys[1]}",
                "does not fit the dome",
                found=f"{given[1]:g} m",
                expected=f">= {least:g} m" if name == "drum" else f"<= {widest:.4g} m, the width of the closing ring",
            )

    @property
    def inner(self) -> float:
        """Radius of the soffit, m."""
        half = self.span / 2
        return half if self.rise is None else (half**2 + self.rise**2) / (2 * self.rise)

    @property
    def directrix(self) -> Directrix:
        """The meridian, from the springing to the closing stone or to the oculus."""
        start = math.acos(min(1.0, self.span / 2 / self.inner))
        if self.oculus is None:
            angles = start + (math.pi / 2 - start) / self.rings * np.arange(self.rings, dtype=np.float64)
        else:
            angles = np.linspace(start, math.acos(self.oculus / 2 / self.inner), self.rings + 1)
        level = (self.drum_height or 0.0) - self.inner * math.sin(start)
        return circular(self.inner, self.thickness, angles).raised(level)

    @property
    def stones_about(self) -> float:
        """About how many stones it has."""
        walls = ((self.drum_height, self.drum_course), (self.lantern_height, self.lantern_course))
        courses = [height / course for height, course in walls if height is not None and course is not None]
        return (self.rings + sum(courses)) * self.sides / self.stone_sides

    @property
    def lantern_room(self) -> float:
        """Width of the level back of the closing ring, m."""
        joints = self.directrix.joints
        return float(joints[-2, 1, 0] - joints[-1, 0, 0]) if self.oculus else 0.0


def dome(*, name: str = "dome", materials: tuple[UnitWeight, ...] = (DEFAULT_MATERIAL,), **parameters: Any) -> Building:
    """Return a dome; keywords: its keys in docs/reference_case.md, without unit, SI."""
    p = as_dataclass(DomeParameters, "dome", parameters)
    materials = materials_of("dome", materials)
    joints = p.directrix.joints
    laid: list[tuple[str, list[Section]]] = []
    outer = float(joints[0, 1, 0])
    if p.drum_height is not None and p.drum_thickness is not None and p.drum_course is not None:
        outer = max(outer, p.span / 2 + p.drum_thickness)
        rings = round(p.drum_height / p.drum_course)
        laid.append(("drum", wall(p.span / 2, p.span / 2 + p.drum_thickness, 0.0, rings, p.drum_course)))
    foot = skewback(joints[0], outer)
    if foot:
        laid.append(("skewback", [foot]))
    sections = p.directrix.sections
    if p.oculus is None:
        crown = joints[-1] * np.array([0.0, 1.0])
        sections = [*sections, between(joints[-1], crown)]
    else:
        sections = [*sections[:-1], _closing_ring(joints, p.lantern_thickness)]
    laid.append(("dome", sections))
    if p.lantern_height is not None and p.lantern_thickness is not None and p.lantern_course is not None:
        inner, low = float(joints[-1, 0, 0]), float(joints[-1, 1, 1])
        rings = round(p.lantern_height / p.lantern_course)
        laid.append(("lantern", wall(inner, inner + p.lantern_thickness, low, rings, p.lantern_course)))
    courses = Courses()
    add_rings(
        courses,
        [section for _, own in laid for section in own],
        centre=(0.0, 0.0),
        sectors=p.sides,
        width=p.stone_sides,
        part=[part for part, own in laid for _ in own],
        stagger=p.laid == "staggered",
        turn=math.pi if p.plan == "half" else 2 * math.pi,
        shortest=p.shortest_stone or 0.0,
    )
    supports = (_front(p),) if p.front == "wall" else ()
    return Building(name, (), materials, supports=supports, vaults=(courses.vault("dome", materials[0].name),))


def _closing_ring(joints: FloatArray, lantern: float | None) -> Section:
    """Return the section of the ring around the oculus: upright towards it, its back level, as wide as a lantern on it."""
    below, (inside, outside) = joints[-2], joints[-1]
    edge = max(float(outside[0]), float(inside[0]) + (lantern or 0.0))
    top = np.array([[inside[0], outside[1]], [edge, outside[1]]])
    corner = np.array([below[0], below[1], top[1], top[0], inside])
    return polygon_section(corner, below.mean(axis=0), top.mean(axis=0))


def _front(p: DomeParameters) -> Support:
    """Return a wall that does not move, before the plane y = 0: a half dome leans on it."""
    joints = p.directrix.joints
    reach, top = p.span / 2 + max(p.thickness, p.drum_thickness or 0.0), float(joints[..., 1].max()) + p.thickness
    return fixed_box("front", (-reach, reach), (-p.span / 4, 0.0), (0.0, top))
