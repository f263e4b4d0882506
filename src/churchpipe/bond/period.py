"""The period of a bond: the stones that, repeated in two directions, make an endless wall of it."""

from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arrays import FloatArray
from churchpipe.model.building import BondRegion

# "leaves": two leaves in running bond that no header ties.
# "butt": a stack whose joints have no cohesion, where a wall butts against another one.
BondName: TypeAlias = Literal["running", "stack", "english", "flemish", "leaves", "butt"]


@dataclass(frozen=True, slots=True)
class Period:
    """Stones (n, 3, 2), the least and the greatest coordinate of each, m, and steps (2, 2) by which they repeat, m.

    Coordinates: along the beds, up the courses, through the wall from its mid-surface. layer (n,): the depth of the surface about
    which each stone bends with the wall, zero where headers make the wall one body. Leaves that nothing ties bend about surfaces
    of their own and slide along each other; how much they slide grows along the wall, so no period can tell what friction there
    would do, and they count as if they did not touch.
    """

    stones: FloatArray
    steps: FloatArray
    layer: FloatArray

    @property
    def area(self) -> float:
        """Area of the wall that one period fills, m2."""
        (p1, p2), (q1, q2) = self.steps.tolist()
        return abs(p1 * q2 - p2 * q1)


def period_of(bond: str, a: float, b: float, h: float) -> Period:
    """Return the period of a bond of courses of height a, stones of length b, in a wall of thickness h, m.

    Raises
    ------
    InputError: unknown bond.
    """
    whole, leaves = (-h / 2, h / 2), ((-h / 2, 0.0), (0.0, h / 2))
    match bond:
        case "running":
            return _period([((0, b), 0, whole)], a, (b, 0), (b / 2, a))
        case "stack" | "butt":
            return _period([((0, b), 0, whole)], a, (b, 0), (0, a))
        case "leaves":
            return _period([((0, b), 0, leaf) for leaf in leaves], a, (b, 0), (b / 2, a), layers=(-h / 4, h / 4))
        case "flemish":
            # A header, then a stretcher in each leaf; the next header lies over the middle of the stretchers.
            stones = [((0, b / 2), 0, whole), *(((b / 2, 1.5 * b), 0, leaf) for leaf in leaves)]
            return _period(stones, a, (1.5 * b, 0), (0.75 * b, a))
        case "english":
            # A course of stretchers, then one of headers, a quarter of a stretcher further on.
            stretchers = [((0, b), 0, leaf) for leaf in leaves]
            headers = [((b / 4, 3 * b / 4), 1, whole), ((3 * b / 4, 5 * b / 4), 1, whole)]
            return _period([*stretchers, *headers], a, (b, 0), (0, 2 * a))
        case _:
            raise InputError("bond", "unknown", found=bond, expected=", ".join(get_args(BondName)))


def bond_name(region: BondRegion) -> BondName:
    """Return the bond whose period stands for a region in the shell.

    A ring of voussoirs is taken as running bond about its centre, and one stone, which does not yield, as running bond too.
    """
    match region.pattern:
        case "stack":
            return "stack"
        case "header-stretcher":
            return "leaves" if region.headers == "none" else region.headers
        case _:
            return "running"


def _period(
    stones: list[tuple[tuple[float, float], int, tuple[float, float]]],
    a: float,
    first: tuple[float, float],
    second: tuple[float, float],
    layers: tuple[float, ...] = (),
) -> Period:
    """stones: where each lies along its course, which course, and where through the wall."""
    boxes = [[along, (course * a, (course + 1) * a), through] for along, course, through in stones]
    return Period(np.array(boxes), np.array([first, second], dtype=np.float64), np.array(layers or (0.0,) * len(stones)))
