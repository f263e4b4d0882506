"""The bonds of a building's walls: one for all walls, and others for the walls that are listed."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated, Any, Literal, Protocol

from churchpipe.errors import InputError
from churchpipe.generators.arched import ArchedOpening, Given, WallOpening
from churchpipe.generators.fields import as_dataclass, coerce_fields
from churchpipe.generators.masonry import Pattern, check_bond
from churchpipe.model.arrays import FloatArray
from churchpipe.model.building import BondRegion, Headers, UnitCell
from churchpipe.model.quantities import Length


@dataclass(frozen=True, slots=True)
class WallBond:
    """A bond of its own for one or more walls."""

    wall: Annotated[str | Sequence[str], "Name of the wall, or a list of them."]
    pattern: Annotated[Pattern, "Bond; header-stretcher is two stones thick."]
    headers: Annotated[Headers, "How headers tie the two leaves of header-stretcher bond."] = "english"
    stone_length: Annotated[Length | None, "Length of the stones; by default as elsewhere."] = None

    def __post_init__(self) -> None:
        coerce_fields(self, "bond: ")
        check_bond(f"bond of {', '.join(self.walls)}", self.pattern, self.headers)

    @property
    def walls(self) -> tuple[str, ...]:
        """The walls laid in it."""
        return (self.wall,) if isinstance(self.wall, str) else tuple(self.wall)


@dataclass(frozen=True, slots=True)
class OwnWall:
    """What one or more walls have of their own, unlike the others; what is left out is as elsewhere."""

    wall: Annotated[str | Sequence[str], "Name of the wall, or a list of them."]
    thickness: Annotated[Length | None, "Thickness."] = None
    height: Annotated[Length | None, "Height of the eaves, of a side wall of the nave."] = None
    material: Annotated[str | None, "Name of its material."] = None

    def __post_init__(self) -> None:
        coerce_fields(self, "walls: ")

    @property
    def walls(self) -> tuple[str, ...]:
        """The walls that it is about."""
        return (self.wall,) if isinstance(self.wall, str) else tuple(self.wall)


def own(walls: Sequence[OwnWall], name: str, key: Literal["thickness", "height", "material"], default: Any) -> Any:
    """Return what a wall has of its own, or the default."""
    return next((value for wall in walls if name in wall.walls if (value := getattr(wall, key)) is not None), default)


@dataclass(frozen=True, slots=True)
class Bonding:
    """How the walls of a building are laid: unit cell, rule of the joints, material, openings. Walls not in `bonds` are in
    running bond; `walls`: what some have of their own.
    """

    cell: UnitCell
    joints: Literal["grid", "bay"] = "bay"
    material: str = "default"
    openings: tuple[WallOpening, ...] = field(default=())
    bonds: tuple[WallBond, ...] = field(default=())
    walls: tuple[OwnWall, ...] = field(default=())

    def material_of(self, wall: str) -> str:
        """Return the name of the material of a wall."""
        return own(self.walls, wall, "material", self.material)

    def region(self, wall: str, outline: FloatArray) -> BondRegion:
        """Return the bond of a wall, over its outline (n, 2) m."""
        own = next((bond for bond in self.bonds if wall in bond.walls), WallBond(wall, "running"))
        cell = self.cell if own.stone_length is None else replace(self.cell, b=own.stone_length)
        return BondRegion("bond", outline, own.pattern, cell, joints=self.joints, headers=own.headers)


class Laid(Protocol):
    """The parameters of a building that say how its walls are laid."""

    @property
    def course(self) -> float: ...
    @property
    def stone_length(self) -> float: ...
    @property
    def joints(self) -> Literal["grid", "bay"]: ...
    @property
    def openings(self) -> Sequence[ArchedOpening | Given]: ...
    @property
    def bonds(self) -> Sequence[WallBond | Given]: ...


def bonding_of(where: str, parameters: Laid, material: str) -> Bonding:
    """Return how the walls of a building are laid. where: its generator, for messages; material: its name."""
    return Bonding(
        UnitCell(a=parameters.course, b=parameters.stone_length),
        parameters.joints,
        material,
        tuple(as_dataclass(ArchedOpening, f"{where}.openings.{k}", value) for k, value in enumerate(parameters.openings)),
        tuple(as_dataclass(WallBond, f"{where}.bonds.{k}", value) for k, value in enumerate(parameters.bonds)),
    )


def check_walls(bonding: Bonding, known: Sequence[str], where: str) -> None:
    """Raise InputError for an opening in, or a bond of, a wall that does not exist, and for a second bond of one wall."""
    named = [(f"opening {o.name}", o.walls) for o in bonding.openings] + [("bonds", b.walls) for b in bonding.bonds]
    for name, walls in named + [("walls", w.walls) for w in bonding.walls]:
        for wall in walls:
            if wall not in known:
                raise InputError(f"{where}: {name}", "no such wall", found=f'"{wall}"', expected=", ".join(known))
    listed = [wall for bond in bonding.bonds for wall in bond.walls]
    for wall in _twice(listed):
        raise InputError(f"{where}: bonds", "two bonds of one wall", found=wall, expected="each wall once")


def _twice(names: Iterable[str]) -> list[str]:
    found: set[str] = set()
    return [name for name in names if name in found or found.add(name)]
