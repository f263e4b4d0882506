"""The masonry of a building, and straight walls made of it."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from churchpipe.errors import InputError
from churchpipe.generators.checks import Brick
from churchpipe.generators.openings import OpeningLike, holes_and_lintels, rectangle
from churchpipe.model.building import BondRegion, Headers, Panel, PlaneChart, UnitCell
from churchpipe.model.materials import Material

Pattern = Literal["running", "stack", "header-stretcher"]

# The masonry of the tilting tests S5 and S22 (Malena et al. 2019, section 4.1).
DEFAULT_MATERIAL = Material("default", unit_weight=28.6e3, friction=0.7)


@dataclass(frozen=True, slots=True)
class Masonry:
    """What all walls of one building have in common.

    cell: course height and stone length, m. courses: their number. thickness: m. material: its name. The rest is as in
    `BondRegion`.
    """

    cell: UnitCell
    courses: int
    thickness: float
    material: str
    pattern: Pattern = "running"
    headers: Headers = "english"
    joints: Literal["grid", "bay"] = "grid"
    through_offset: float = 0.0
    cut_offset: float | None = None


def straight_wall(
    name: str,
    masonry: Masonry,
    corner: tuple[float, float],
    along: Literal["x", "y"],
    length: float,
    *,
    runs_through: Literal[0, 1] = 0,
    openings: Iterable[OpeningLike] = (),
    where: str = "openings.{}",
) -> Panel:
    """Return a wall from z = 0 whose plan is a rectangle.

    Parameters
    ----------
    corner: x and y of the rectangle's lowest corner, m. along: the axis it runs along. length: m. runs_through: parity of the
    courses on which it runs through its junctions. openings: measured from the corner. where: their place
    in messages, with {} for the number of one of several.
    """
    half = masonry.thickness / 2
    outline = rectangle(0.0, 0.0, length, masonry.courses * masonry.cell.a)
    holes, lintels = holes_and_lintels(where, openings, length, masonry.courses, masonry.cell)
    bond = BondRegion(
        "bond",
        outline,
        masonry.pattern,
        masonry.cell,
        joints=masonry.joints,
        through_offset=masonry.through_offset,
        cut_offset=masonry.cut_offset,
        headers=masonry.headers,
    )
    if along == "x":
        chart = PlaneChart(np.array([corner[0], corner[1] + half, 0.0]), np.array([1.0, 0.0, 0.0]))
    else:
        chart = PlaneChart(np.array([corner[0] + half, corner[1], 0.0]), np.array([0.0, 1.0, 0.0]))
    return Panel(
        name,
        chart,
        outline,
        masonry.thickness,
        (bond, *lintels),
        material=masonry.material,
        openings=holes,
        runs_through=runs_through,
    )


def bonded_offset(brick: Brick, thickness: float) -> float:
    """Return the joint offset of courses that run through, m: half a brick where the brick is no longer than the wall is thick,
    else 0.

    With offset 0 such a brick would end in the face of the wall that it crosses, and the corner would have no bond with the
    course above.
    """
    return brick[0] / 2 if brick[0] <= thickness * (1 + 1e-9) else 0.0


def check_bond(where: str, pattern: str, headers: str) -> None:
    """Raise InputError for headers of a bond that has none."""
    if headers != "english" and pattern != "header-stretcher":
        raise InputError(f"{where}.headers", f"{pattern} bond has none", found=headers, expected='pattern = "header-stretcher"')


def thickness_of(where: str, pattern: Pattern, brick: Brick, given: float | None) -> float:
    """Return the thickness of a wall, m: as given, by default that of the brick, or of two side by side in header-stretcher bond.

    Raises
    ------
    InputError: two bricks side by side are not as thick as the wall.
    """
    if pattern != "header-stretcher":
        return brick[1] if given is None else given
    if given is not None and abs(given - 2 * brick[1]) > 1e-9:
        raise InputError(
            f"{where}.thickness",
            "header-stretcher bond is two stones thick",
            found=f"{given:g} m for stones {brick[1]:g} m thick",
            expected=f"{2 * brick[1]:g} m",
        )
    return 2 * brick[1]
