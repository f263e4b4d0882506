"""Walls of a house that get thinner in upper storeys: each storey is a wall of its own, which what names the wall finds."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, product
from typing import Annotated

from churchpipe.errors import InputError
from churchpipe.generators.arched import ArchedOpening, WallOpening
from churchpipe.generators.fields import coerce_fields
from churchpipe.generators.house_openings import FlatOpening
from churchpipe.generators.layout import CLOSE, WallLayout
from churchpipe.generators.wall_bonds import WallBond
from churchpipe.model.building import Junction
from churchpipe.model.quantities import Length

# Of each wall its storeys, from below upwards.
Storeys = Mapping[str, Sequence[WallLayout]]


@dataclass(frozen=True, slots=True)
class Storey:
    """What a wall is above a height: thinner than below, or of another material."""

    above: Annotated[Length, "Height at which it begins, between courses."]
    thickness: Annotated[Length, "Thickness, at most that of the storey below."]
    material: Annotated[str | None, "Name of its material; by default that of the wall."] = None

    def __post_init__(self) -> None:
        coerce_fields(self, "storey: ")


def check_storeys(wall: str, storeys: Sequence[Storey], thickness: float, eaves: float) -> None:
    """Raise InputError unless the storeys of a wall lie above each other, and each stands on the one below.

    thickness: of the lowest, m. eaves: height of the wall, below its gable, m.
    """
    foot = 0.0
    for number, storey in enumerate(storeys):
        where = f"wall {wall}: storeys.{number}"
        if not foot + CLOSE < storey.above < eaves - CLOSE:
            raise InputError(
                f"{where}.above",
                "not within its wall" if storey.above > foot + CLOSE else "not above the storey below",
                found=f"{storey.above:g} m",
                expected=f"> {foot:g} m and < {eaves:g} m, the height of the wall below any gable",
                remedy="List storeys from below upwards, each with the height at which it begins.",
            )
        if storey.thickness > thickness + CLOSE:
            raise InputError(
                f"{where}.thickness",
                "thicker than what it stands on",
                found=f"{storey.thickness:g} m above {storey.above:g} m",
                expected=f"at most {thickness:g} m",
                remedy="A house has no corbels: a storey that juts out can be drawn, and read with churchpipe import.",
            )
        foot, thickness = storey.above, storey.thickness


def openings_in_storeys(openings: Sequence[WallOpening], storeys: Storeys) -> tuple[WallOpening, ...]:
    """Return openings with the storeys that they lie in as their walls.

    Raises
    ------
    InputError: an opening that reaches from one storey of its wall into the next.
    """
    return tuple(_in_storeys(opening, storeys) for opening in openings)


def _in_storeys(opening: WallOpening, storeys: Storeys) -> WallOpening:
    walls = tuple(_storey_of(opening, wall, storeys[wall]) if wall in storeys else wall for wall in opening.walls)
    if isinstance(opening, FlatOpening):
        return replace(opening, walls=walls)
    return replace(opening, wall=walls) if isinstance(opening, ArchedOpening) else opening


def _storey_of(opening: WallOpening, wall: str, storeys: Sequence[WallLayout]) -> str:
    hole = opening.hole(wall, opening.centres[0], opening.name)
    low, high = hole.outer[1], hole.outer[3]
    for below, above in pairwise(storeys):
        level = above.foot
        if high <= level + CLOSE:
            return below.name
        if low < level - CLOSE:
            raise InputError(
                f"wall {wall}: opening {opening.name}",
                f"reaches across {level:g} m, where a storey of the wall begins",
                found=f"z = {low:.4g} to {high:.4g} m with its {hole.around}",
                expected=f"at most {level:g} m, or from there on",
                remedy=f"Move it, let the storey begin elsewhere, or end the opening at {level:g} m and go on with another one.",
            )
    return storeys[-1].name


def bonds_of_storeys(bonds: Sequence[WallBond], storeys: Storeys) -> tuple[WallBond, ...]:
    """Return bonds that hold for all storeys of their walls, but for those that have one of their own."""
    named = {wall for bond in bonds for wall in bond.walls}
    return tuple(
        replace(bond, wall=[name for wall in bond.walls for name in _upwards(wall, storeys) if name == wall or name not in named])
        for bond in bonds
    )


def junctions_of_storeys(junctions: Sequence[Junction], storeys: Storeys) -> tuple[Junction, ...]:
    """Return junctions of walls as such of all their storeys that stand side by side."""
    out: list[Junction] = []
    for junction in junctions:
        first, second = (_upwards(wall, storeys) for wall in junction.walls)
        level = [(one, other) for one, other in product(first, second) if _level(one, other, storeys)]
        # What does not meet is told where the stones are laid.
        out += [replace(junction, walls=pair) for pair in level or [junction.walls]]
    return tuple(out)


def _upwards(wall: str, storeys: Storeys) -> list[str]:
    return [storey.name for storey in storeys[wall]] if wall in storeys else [wall]


def _level(first: str, second: str, storeys: Storeys) -> bool:
    """Whether two storeys share some height."""
    known = {storey.name: storey for own in storeys.values() for storey in own}
    pair = [known[name] for name in (first, second) if name in known]
    return max(one.foot for one in pair) < min(one.height for one in pair) - CLOSE if len(pair) == 2 else False
