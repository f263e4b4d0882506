"""The walls of a house laid out from lines in plan: what they meet, and how far they reach."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, pairwise
from typing import Annotated, Literal

from churchpipe.bond.slivers import LEAST_WIDTH
from churchpipe.errors import InputError
from churchpipe.generators.arched import Given
from churchpipe.generators.fields import as_dataclass, coerce_fields
from churchpipe.generators.house_storeys import Storey, check_storeys
from churchpipe.generators.layout import WallLayout
from churchpipe.model.arguments import text
from churchpipe.model.quantities import Coordinate, Length

# Places closer than this are one, m: plans are measured to a millimetre.
CLOSE = 1e-6
# Gaps between the end of a wall and another wall that are questioned, m: few doors are as narrow and reach up to the top.
NEAR = 1.0


@dataclass(frozen=True, slots=True)
class HouseWall:
    """A straight wall along x or y: a line in plan from one end to the other.

    It reaches through each wall in whose thickness it ends, to the far face, so that it does not matter whether its ends are
    given on the outer face, the centreline or the inner face of the walls that it meets.
    """

    name: Annotated[str, "What openings, loads and reports call it."]
    start: Annotated[tuple[Coordinate, Coordinate], "x and y of one end of its line."]
    end: Annotated[tuple[Coordinate, Coordinate], "x and y of the other end, on the same x or the same y."]
    toward: Annotated[
        Literal["+x", "-x", "+y", "-y"] | None,
        "Side of the line that the wall lies on, where the line is a face of it, such as the outer one; by default its middle.",
    ] = None
    thickness: Annotated[Length | None, "Thickness; by default that of the house."] = None
    height: Annotated[Length | None, "Height, below a gable that of the eaves; by default that of the house."] = None
    ridge: Annotated[Length | None, "Height of the ridge of a gable, in the middle of the wall; by default there is none."] = None
    material: Annotated[str | None, "Name of its material; by default the first one."] = None
    storeys: Annotated[
        Sequence[Storey | Given],
        "Where it gets thinner: a table of each storey above the lowest, from below upwards. The line stays where it is: with "
        "`toward` that face is flush, without it the middle. Loads, ties, beams and reports know them as walls of their own, "
        "NAME storey 2 and so on.",
    ] = ()

    def __post_init__(self) -> None:
        where = f"wall {text('wall: name', self.name)}"
        coerce_fields(self, f"{where}: ")
        for key in ("start", "end"):
            if len(getattr(self, key)) != 2:
                raise InputError(f"{where}: {key}", "no place in plan", found=list(getattr(self, key)), expected="[x, y]")
        (x0, y0), (x1, y1) = self.start, self.end
        if (abs(x1 - x0) > CLOSE) == (abs(y1 - y0) > CLOSE):
            alike = abs(x1 - x0) <= CLOSE
            raise InputError(
                f"{where}: end",
                "no length" if alike else "neither along x nor along y",
                found=f"from ({x0:g}, {y0:g}) to ({x1:g}, {y1:g}) m",
                expected="another x, or another y" if alike else "the same x, or the same y, as its start",
                remedy="" if alike else "Walls meet at right angles here: turn the plan so that they lie along its axes.",
            )
        if self.toward is not None and self.toward[1] == self.along:
            expected = '"+y" or "-y"' if self.along == "x" else '"+x" or "-x"'
            raise InputError(
                f"{where}: toward", f"along the wall, which runs along {self.along}", found=self.toward, expected=expected
            )

    @property
    def along(self) -> Literal["x", "y"]:
        """The axis it runs along."""
        return "x" if abs(self.end[0] - self.start[0]) > CLOSE else "y"

    @property
    def own_storeys(self) -> tuple[Storey, ...]:
        """Its storeys above the lowest, checked each by itself."""
        return tuple(as_dataclass(Storey, f"wall {self.name}: storeys.{k}", one) for k, one in enumerate(self.storeys))

    @property
    def names(self) -> tuple[str, ...]:
        """The names of its storeys as walls, from below upwards; that of the lowest is its own."""
        return self.name, *(f"{self.name} storey {number}" for number in range(2, 2 + len(self.storeys)))

    def placed(self, thickness: float, level: float = 0.0) -> "Placed":
        """Return where it stands at a level, m, its ends as they are given. thickness: by default, m."""
        axis = 0 if self.along == "x" else 1
        thick = thickness if self.thickness is None else self.thickness
        thick = next((one.thickness for one in reversed(self.own_storeys) if one.above < level + CLOSE), thick)
        # Ends of one line may differ by rounding.
        line = (self.start[1 - axis] + self.end[1 - axis]) / 2
        away = {None: 0.0, "+": thick / 2, "-": -thick / 2}[self.toward and self.toward[0]]
        low, high = sorted((self.start[axis], self.end[axis]))
        return Placed(self.name, self.along, line + away, thick, (low, high))


@dataclass(frozen=True, slots=True)
class Placed:
    """Where a wall stands: along x or y, its centreline at y or x = `at`, thickness and the two ends of its span, m."""

    name: str
    along: Literal["x", "y"]
    at: float
    thickness: float
    span: tuple[float, float]

    @property
    def faces(self) -> tuple[float, float]:
        """Places of its two faces, across it, m."""
        return self.at - self.thickness / 2, self.at + self.thickness / 2


def house_walls(
    walls: Sequence[HouseWall], thickness: float, height: float, stone_length: float, *, x_first: bool
) -> list[WallLayout]:
    """Return the storeys of the walls of a house, wall by wall from below upwards, each reaching through those that it meets.

    Walls along x run through the junctions on even courses, those along y on odd ones, or the other way about, so that any two
    that meet are toothed.

    Parameters
    ----------
    thickness, height: of walls that have none of their own, m. stone_length: m. x_first: whether walls along x run through on
    course 0.

    Raises
    ------
    InputError: walls that lie in each other or in one line end to end, that all but meet, that are shorter than another one is
        thick; a ridge below the eaves; storeys that do not stand on each other.
    """
    for wall in walls:
        thick = thickness if wall.thickness is None else wall.thickness
        check_storeys(wall.name, wall.own_storeys, thick, height if wall.height is None else wall.height)
    levels = sorted({0.0, *(storey.above for wall in walls for storey in wall.own_storeys)})
    given = [[wall.placed(thickness, level) for wall in walls] for level in levels]
    placed = [[_reaching(wall, given[0], now) for wall in given[0]] for now in given]
    # Above, walls are nowhere nearer to each other than at the ground.
    for first, second in combinations(placed[0], 2):
        _check_pair(first, second, LEAST_WIDTH * stone_length)
    return [
        layout
        for number, wall in enumerate(walls)
        for layout in _storeys(wall, list(zip(levels, (now[number] for now in placed), strict=True)), height, x_first=x_first)
    ]


def _storeys(wall: HouseWall, placed: Sequence[tuple[float, Placed]], height: float, *, x_first: bool) -> Iterator[WallLayout]:
    """Yield the storeys of a wall that stands so at some levels, m."""
    parity: dict[str, Literal[0, 1]] = {"x": 0, "y": 1} if x_first else {"x": 1, "y": 0}
    eaves = height if wall.height is None else wall.height
    feet = [0.0, *(storey.above for storey in wall.own_storeys), eaves]
    for name, (foot, top) in zip(wall.names, pairwise(feet), strict=True):
        own = [(level, at) for level, at in placed if foot - CLOSE < level < top - CLOSE]
        at = own[0][1]
        line = _top(wall, own, top, gable=top == eaves)
        yield WallLayout(name, at.along, at.at, at.thickness, line, parity[at.along], foot=foot)


def loose_ends(walls: Sequence[WallLayout]) -> list[str]:
    """Return the sentences on walls that may have been meant to meet others: they end near one, or meet none at all."""
    said: list[str] = []
    walls = [wall for wall in walls if not wall.foot]
    for wall in walls:
        faces = [
            (other.name, other.at - other.thickness / 2, other.at + other.thickness / 2)
            for other in walls
            if other.along != wall.along and other.span[0] < wall.at < other.span[1]
        ]
        start, stop = wall.span
        for name, low, high in faces:
            gap = max(low - stop, start - high)
            if CLOSE < gap < NEAR:
                said.append(f"The wall {wall.name} ends {gap:.3g} m before the wall {name}, and does not meet it.")
        if len(walls) > 1 and not any(low < stop and high > start for _, low, high in faces):
            said.append(f"The wall {wall.name} meets no other wall, and stands by itself.")
    return said


def _top(wall: HouseWall, own: Sequence[tuple[float, Placed]], top: float, *, gable: bool) -> tuple[tuple[float, float], ...]:
    """Return the upper outline of a storey: gables slope from its ends to the ridge in its middle.

    own: how it stands from some levels on, m. Where a wall at its end gets thinner about its middle it steps back with it.
    """
    (start, stop), left, right = own[0][1].span, list[tuple[float, float]](), list[tuple[float, float]]()
    for level, placed in own[1:]:
        low, high = placed.span
        if abs(low - start) > CLOSE:
            left += [(start, level), (low, level)]
            start = low
        if abs(high - stop) > CLOSE:
            right = [(high, level), (stop, level), *right]
            stop = high
    ridge: list[tuple[float, float]] = []
    if wall.ridge is not None and gable:
        if not wall.ridge > top + CLOSE:
            raise InputError(
                f"wall {wall.name}: ridge", "not above the eaves", found=f"{wall.ridge:g} m", expected=f"> {top:g} m"
            )
        ridge = [((start + stop) / 2, wall.ridge)]
    return (*left, (start, top), *ridge, (stop, top), *right)


def _reaching(wall: Placed, ground: Sequence[Placed], now: Sequence[Placed]) -> Placed:
    """Return a wall at some level: from each end within the thickness of another wall it goes on to the far face of that one.

    wall: at the ground, where it shows which walls it ends at. ground, now: all walls at the ground, and at the level.
    """
    starts, stops = list[float](), list[float]()
    above = {other.name: other for other in now}
    for low, high, other in _across(wall, ground):
        if low - CLOSE <= wall.span[0] and wall.span[1] <= high + CLOSE:
            found, expected = f"{wall.span[1] - wall.span[0]:g} m", f"> {high - low:g} m"
            raise InputError(
                f"wall {wall.name}: end", f"no longer than the wall {other.name} is thick", found=found, expected=expected
            )
        if low - CLOSE <= wall.span[0] <= high + CLOSE:
            starts.append(above[other.name].faces[0])
        if low - CLOSE <= wall.span[1] <= high + CLOSE:
            stops.append(above[other.name].faces[1])
    start, stop = min(starts, default=wall.span[0]), max(stops, default=wall.span[1])
    return replace(above[wall.name], span=(start, stop))


def _across(wall: Placed, others: Sequence[Placed]) -> Iterator[tuple[float, float, Placed]]:
    """Yield the walls of the other direction that reach the strip of plan in which a wall lies, with their faces."""
    low, high = wall.faces
    for other in others:
        if other.along != wall.along and other.span[0] <= high + CLOSE and other.span[1] >= low - CLOSE:
            yield *other.faces, other


def _check_pair(first: Placed, second: Placed, least: float) -> None:
    """Raise InputError unless two walls cross squarely, or stand clear of each other."""
    if first.along == second.along:
        _check_parallel(first, second, least)
        return
    for wall, other in ((first, second), (second, first)):
        for low, high, _ in _across(wall, [other]):
            start, stop = wall.span
            for gap, problem in (
                (low - stop, f"all but meets the wall {other.name}"),
                (start - high, f"all but meets the wall {other.name}"),
                (stop - high, f"goes on beyond the wall {other.name} by less than a quarter of a stone"),
                (low - start, f"goes on beyond the wall {other.name} by less than a quarter of a stone"),
            ):
                if CLOSE < gap < least - CLOSE:
                    raise InputError(
                        f"wall {wall.name}: end",
                        problem,
                        found=f"{gap:.4g} m",
                        expected=f"0 m, or at least {least:.4g} m",
                        remedy=f"Let it end between {low:.6g} and {high:.6g} m, within the thickness of that wall.",
                    )


def _check_parallel(first: Placed, second: Placed, least: float) -> None:
    beside = min(first.faces[1], second.faces[1]) - max(first.faces[0], second.faces[0])
    shared = min(first.span[1], second.span[1]) - max(first.span[0], second.span[0])
    if beside <= CLOSE or shared <= -least + CLOSE:
        return
    where, axis = f"walls {first.name} and {second.name}", first.along
    if shared > CLOSE:
        raise InputError(
            where,
            "lie in one another",
            found=f"{shared:.4g} x {beside:.4g} m of both, through the walls across that they reach to",
            expected="walls beside each other",
            remedy=f"Give two walls in one line along {axis} as one wall from end to end, or move one of them.",
        )
    raise InputError(
        where,
        "meet end to end, without a bond",
        found=f"{max(-shared, 0.0):.4g} m between their ends",
        expected=f"one wall, or at least {least:.4g} m between them",
        remedy=f"Give them as one wall along {axis}.",
    )
