"""Barrel, groin and cloister vaults, on the ground or on walls of their own."""

from dataclasses import dataclass
from functools import partial
from typing import Annotated, Any, Literal

import numpy as np

from churchpipe.errors import InputError
from churchpipe.generators.checks import together, whole_courses
from churchpipe.generators.fields import as_dataclass, coerce_fields, materials_of
from churchpipe.generators.masonry import DEFAULT_MATERIAL
from churchpipe.generators.profile import Profile, Shape, backing, fixed_box, skewback, to_middle, wall
from churchpipe.generators.transverse import add_groin_ends, add_groin_ribs, add_transverse
from churchpipe.model.building import Building, Support
from churchpipe.model.materials import UnitWeight
from churchpipe.model.quantities import Count, Length
from churchpipe.model.vault import Section, Side, Vault
from churchpipe.vaults.barrel import add_arches, add_barrel
from churchpipe.vaults.crossed import Corner, add_cloister, add_groin
from churchpipe.vaults.sweep import Courses


@dataclass(frozen=True, slots=True)
class VaultParameters:
    """A vault about the origin; a barrel spans x and runs along y."""

    span: Annotated[Length, "Clear span between the springings."]
    thickness: Annotated[Length, "Thickness."]
    courses: Annotated[Count, "Courses from springing to springing, an odd number."]
    stone_length: Annotated[Length, "Length of the stones, about."]
    kind: Annotated[
        Literal["barrel", "groin", "pavilion", "octagonal"],
        "Kind of vault.",
    ] = "barrel"
    length: Annotated[Length | None, "Length of a barrel."] = None
    second_span: Annotated[Length | None, "Clear span of a groin vault along y; by default the same."] = None
    shape: Annotated[Shape, "Shape of the soffit."] = "round"
    rise: Annotated[Length | None, "Rise of the soffit, of a segmental or pointed vault."] = None
    laid: Annotated[
        Literal["courses", "rings"], "A barrel in courses along it, or in rings: arches as wide as a stone is long."
    ] = "courses"
    heads: Annotated[Literal["staggered", "aligned"], "Head joints of neighbouring courses: staggered, or in one line."] = (
        "staggered"
    )
    corner: Annotated[Corner, "Which corner stones of crossed vaults run round the mitre: all, every other or none."] = "round"
    wall_height: Annotated[Length | None, "Height of walls or piers below; by default the vault springs from the ground."] = None
    wall_thickness: Annotated[Length | None, "Thickness of these walls."] = None
    wall_course: Annotated[Length | None, "Height of their courses."] = None
    wall_top: Annotated[Length | None, "Height to which the walls of a barrel go on outside it."] = None
    backing: Annotated[Length | None, "Height over the springing of masonry on the haunches."] = None
    arches: Annotated[Count | None, "Number of arches below a barrel, or on the four sides of a groin vault."] = None
    arch_width: Annotated[Length | None, "Width of these arches."] = None
    arch_depth: Annotated[Length | None, "Depth of these arches."] = None
    rib_width: Annotated[Length | None, "Width of ribs below the groins of a groin vault."] = None
    rib_depth: Annotated[Length | None, "Depth of these ribs, measured across the vault's thickness."] = None
    foot: Annotated[Literal["ground", "abutments"], "What carries it: the ground, or fixed stones that may settle or spread."] = (
        "ground"
    )

    def __post_init__(self) -> None:
        coerce_fields(self, "vault.")
        _ = self.profile
        barrel = self.kind == "barrel"
        for key, allowed, of in (
            ("length", barrel, "barrel"),
            ("wall_top", barrel, "barrel"),
            ("second_span", self.kind == "groin", "groin vault"),
            ("arches", barrel or self.kind == "groin", "barrel or a groin vault"),
            ("rib_width", self.kind == "groin", "groin vault"),
            ("foot", barrel or self.kind == "groin", "barrel or a groin vault"),
        ):
            if getattr(self, key) not in (None, "ground") and not allowed:
                raise InputError(f"vault.{key}", f"only a {of} has one", found=f"kind = {self.kind}", expected="no such key")
        if barrel and self.length is None:
            raise InputError("vault.length", "missing", expected="the length of the barrel")
        if self.laid == "rings" and not barrel:
            raise InputError("vault.laid", "only a barrel is laid in rings", found=self.kind, expected='laid = "courses"')
        together("vault", self, "wall_height", "wall_thickness", "wall_course")
        together("vault", self, "arches", "arch_width", "arch_depth")
        together("vault", self, "rib_width", "rib_depth")
        if self.wall_height is not None and self.wall_course is not None:
            whole_courses("vault.wall_height", self.wall_height, self.wall_course)
        self._check_walls()

    def _check_walls(self) -> None:
        least = self.thickness + self.below
        if self.wall_thickness is not None and self.wall_thickness < least - 1e-9:
            raise InputError(
                "vault.wall_thickness",
                "the vault does not fit on its walls",
                found=f"{self.wall_thickness:g} m",
                expected=f">= {least:g} m: the vault and its arches or ribs",
            )
        for key, given, names in (("arch_depth", self.arch_depth, "arches"), ("rib_depth", self.rib_depth, "ribs")):
            if given is not None and given >= self.span / 2:
                raise InputError(f"vault.{key}", "no opening is left", found=given, expected=f"< {self.span / 2:g} m")
            if given is not None and self.shape == "segmental":
                raise InputError(
                    f"vault.{key}",
                    f"{names} under a segmental vault would spring below it",
                    found=self.shape,
                    expected='shape = "round" or "pointed"',
                )
        if self.kind == "groin" and self.arches not in (None, 4):
            raise InputError("vault.arches", "a groin vault has four sides", found=self.arches, expected="4")
        if self.arches and self.kind == "groin" and self.wall_height is not None:
            raise InputError("vault.arches", "arches of a groin vault spring from the ground", expected="no wall_height")
        if self.wall_top is None:
            return
        if self.shape == "segmental":
            expected, remedy = 'shape = "round" or "pointed", which spring upright', "Or leave wall_top out."
            problem = "no wall goes on beside a segmental vault, whose skewbacks take its place"
            raise InputError("vault.wall_top", problem, found=self.shape, expected=expected, remedy=remedy)
        if self.wall_height is None or self.wall_course is None:
            raise InputError("vault.wall_top", "no wall goes on", expected="wall_height and wall_course, of the walls below")
        if self.wall_top <= self.wall_height or not self.beside > 1e-6:
            raise InputError(
                "vault.wall_top",
                "no wall goes on beside the vault",
                found=f"{self.wall_top:g} m, {self.beside:g} m thick",
                expected=f"> {self.wall_height:g} m, and walls thicker than vault and arches, {least:g} m",
            )
        whole_courses("vault.wall_top", self.wall_top - self.wall_height, self.wall_course)

    @property
    def ratio(self) -> float:
        """Span of a groin vault along y over that along x."""
        return (self.second_span or self.span) / self.span

    @property
    def below(self) -> float:
        """Depth of the arches or ribs below the vault, m."""
        return max(self.arch_depth or 0.0, self.rib_depth or 0.0)

    @property
    def profile(self) -> Profile:
        """The curve of the vault."""
        return Profile("vault", self.span, self.thickness, self.courses, self.shape, self.rise, self.wall_height or 0.0)

    @property
    def face(self) -> float:
        """Distance of the walls' inner faces from the middle, m: they carry arches and ribs, too."""
        return self.span / 2 - self.below

    @property
    def beside(self) -> float:
        """Width that the walls have left outside the springing, m."""
        return (self.wall_thickness or 0.0) - self.thickness - self.below

    @property
    def outer(self) -> float:
        """Distance of the outermost point of walls or springing from the middle, m."""
        if self.wall_thickness is not None:
            return self.face + self.wall_thickness
        return float(self.profile.whole.joints[0, 1, 0])


def vault(*, name: str = "vault", materials: tuple[UnitWeight, ...] = (DEFAULT_MATERIAL,), **parameters: Any) -> Building:
    """Return a vault; keywords: its keys in docs/reference_case.md, without unit, SI."""
    p = as_dataclass(VaultParameters, "vault", parameters)
    material = materials_of("vault", materials)[0].name
    laid = {"barrel": _barrel, "groin": _groin}.get(p.kind, _cloister)(p, material)
    if p.foot == "ground":
        return Building(name, (), materials, vaults=tuple(laid))
    return Building(name, (), materials, ground=None, supports=tuple(_abutments(p)), vaults=tuple(laid))


def _abutments(p: VaultParameters) -> list[Support]:
    """Return fixed stones below springings or walls: of a barrel right and left, of a groin vault under each corner."""
    ratio = p.ratio
    x = (p.face, p.outer)
    y = (0.0, p.length) if p.length is not None else (p.face * ratio, p.outer * ratio)
    depth = p.outer - p.face
    if p.kind == "barrel":
        return [fixed_box(f"abutment_{name}", _signed(x, sign), y, (-depth, 0.0)) for name, sign in (("right", 1), ("left", -1))]
    corners = [(1, 1), (-1, 1), (-1, -1), (1, -1)]
    return [
        fixed_box(f"abutment_{number}", _signed(x, sx), _signed(y, sy), (-depth, 0.0))
        for number, (sx, sy) in enumerate(corners, start=1)
    ]


def _signed(span: tuple[float, float], sign: float) -> tuple[float, float]:
    return span if sign > 0 else (-span[1], -span[0])


def _barrel(p: VaultParameters, material: str) -> list[Vault]:
    """Return a barrel along y, with what stands below and beside it on both sides."""
    assert p.length is not None
    side = Side(np.zeros(2), np.array([1.0, 0.0]), np.array([0.0, 1.0]))
    stagger = p.heads == "staggered"
    lay = partial(add_barrel, side=side, span=(0.0, p.length), stone_length=p.stone_length, stagger=stagger)
    courses, rings, filled, under = Courses(), Courses(), Courses(), Courses()
    for part, sections in _below(p):
        for suffix, mirrored in (("right", sections), ("left", [section.mirrored for section in sections])):
            lay(filled if part == "backing" else courses, mirrored, part=f"{part}_{suffix}")
    profile = p.profile
    if p.laid == "courses":
        lay(courses, profile.whole.sections, part="vault", numbers=profile.voussoir)
    else:
        cuts = np.linspace(0.0, p.length, max(1, round(p.length / p.stone_length)) + 1)
        add_arches(rings, profile.halved.sections, side, cuts, part="vault", stagger=stagger)
    if p.arches is not None and p.arch_width is not None and p.arch_depth is not None:
        lay = partial(add_transverse, side=side, span=(0.0, p.length), count=p.arches, width=p.arch_width, depth=p.arch_depth)
        lay(under, profile, where="vault", part="arch", rings=p.laid == "rings")
    found = _collected(material, courses, filled, under)
    return [*found, rings.vault("rings", material, beds="section")] if rings.runs else found


def _collected(material: str, courses: Courses, filled: Courses, under: Courses) -> list[Vault]:
    """Return a vault with what it stands on, the masonry on its haunches, and the arches below or before it."""
    found = [courses.vault("vault", material)] if courses.runs else []
    found += [filled.vault("backing", material, shell="none")] if filled.runs else []
    return [*found, under.vault("arches", material, shell="none")] if under.runs else found


def _below(p: VaultParameters) -> list[tuple[str, list[Section]]]:
    """Return what stands on the right of a vault: walls, skewback, backing, walls that go on, each with its name."""
    directrix = p.profile.halved if p.laid == "rings" else p.profile.whole if p.kind == "barrel" else p.profile.half
    joints = directrix.joints
    found: list[tuple[str, list[Section]]] = []
    if p.wall_height is not None and p.wall_course is not None:
        found.append(("wall", wall(p.face, p.outer, 0.0, round(p.wall_height / p.wall_course), p.wall_course)))
    foot = skewback(joints[0], p.outer)
    if foot:
        found.append(("skewback", [foot]))
    upper = p.wall_top is not None
    if p.backing is not None:
        reach = p.span / 2 + p.thickness if upper else p.outer
        layers = backing(joints, reach, p.profile.springing + p.backing)
        if not layers:
            raise InputError(
                "vault.backing",
                "lower than the first course of the vault",
                found=f"{p.backing:g} m",
                expected=f">= {joints[1, 1, 1] - p.profile.springing:.4g} m",
            )
        found.append(("backing", layers))
    if p.wall_top is not None and p.wall_height is not None and p.wall_course is not None:
        count = round((p.wall_top - p.wall_height) / p.wall_course)
        found.append(("upper_wall", wall(p.span / 2 + p.thickness, p.outer, p.wall_height, count, p.wall_course)))
    return found


def _groin(p: VaultParameters, material: str) -> list[Vault]:
    """Return two barrels that cross; walls become piers in the four corners."""
    ratio = p.ratio
    border = p.outer
    stagger = p.heads == "staggered"
    lay = partial(
        add_groin,
        centre=(0.0, 0.0),
        ratio=ratio,
        stone_length=p.stone_length,
        corner=p.corner,
        stagger=stagger,
    )
    courses, filled, under = Courses(), Courses(), Courses()
    for part, sections in [*_below(p), ("vault", to_middle(p.profile.half))]:
        named = "pier" if part == "wall" else part
        webs = sections, [section.stretched(ratio) for section in sections]
        lay(filled if part == "backing" else courses, webs, borders=(border * ratio, border), part=named, key=part == "vault")
    if p.arch_width is not None and p.arch_depth is not None:
        lay = partial(add_groin_ends, centre=(0.0, 0.0), ratio=ratio, reach=border, part="arch")
        lay(under, p.profile, width=p.arch_width, depth=p.arch_depth)
    if p.rib_width is not None and p.rib_depth is not None:
        lay = partial(add_groin_ribs, where="vault", centre=(0.0, 0.0), ratio=ratio, reach=border, part="rib")
        lay(under, p.profile, width=p.rib_width, depth=p.rib_depth)
    return _collected(material, courses, filled, under)


def _cloister(p: VaultParameters, material: str) -> list[Vault]:
    """Return a pavilion or an octagonal vault on walls around it."""
    lay = partial(
        add_cloister,
        centre=(0.0, 0.0),
        sides=4 if p.kind == "pavilion" else 8,
        stone_length=p.stone_length,
        corner=p.corner,
        stagger=p.heads == "staggered",
    )
    courses, filled = Courses(), Courses()
    for part, sections in [*_below(p), ("vault", to_middle(p.profile.half))]:
        lay(filled if part == "backing" else courses, sections, part=part, key=part == "vault")
    return _collected(material, courses, filled, Courses())
