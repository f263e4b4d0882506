"""The walls of a church laid out from its parts. x: across the nave, 0 in its middle; y: along it, 0 at the facade."""

from dataclasses import dataclass
from typing import Literal

from churchpipe.errors import InputError
from churchpipe.generators.church_parts import Apse, Chapel, Choir, CrossWall, Nave, Tower, Transept
from churchpipe.generators.layout import CLOSE, WallLayout
from churchpipe.generators.wall_bonds import OwnWall, own

SIDES: tuple[Literal["left"], Literal["right"]] = ("left", "right")
# Smallest clear width of a room between walls, in stone lengths.
LEAST_ROOM = 1.0


@dataclass(frozen=True, slots=True)
class Plan:
    """Parts of a church, checked against each other, and the stone length, m. x_first: whether walls across the nave run through
    junctions on even courses."""

    stone_length: float
    nave: Nave
    facade: CrossWall | None
    triumphal_arch: CrossWall | None
    transept: Transept | None
    choir_arch: CrossWall | None
    choir: Choir | None
    east: CrossWall | None
    tower: Tower | None
    chapel: Chapel | None
    apses: tuple[Apse, ...]
    x_first: bool
    walls: tuple[OwnWall, ...] = ()

    def __post_init__(self) -> None:
        for name, part, needs in (
            ("transept", self.transept, "triumphal_arch"),
            ("choir", self.choir, "triumphal_arch"),
            ("tower", self.tower, "transept"),
            ("chapel", self.chapel, "transept"),
            ("apses", self.apses, "east"),
        ):
            if part and getattr(self, needs) is None:
                raise InputError(f"church.{name}", f"needs the {needs} of the church", expected=f"a part [source.{needs}]")
        if (self.choir_arch is not None) != (self.choir is not None and self.transept is not None):
            raise InputError(
                "church.choir_arch",
                "given or left out wrongly",
                expected="a wall between transept and choir, where there are both",
            )
        if self.triumphal_arch and not (self.transept or self.choir):
            raise InputError("church.triumphal_arch", "nothing lies behind it", expected="a transept or a choir")
        if self.transept and not (self.choir_arch or self.east):
            raise InputError("church.transept", "open at the back", expected="a part [source.east] (or a choir and its arch)")
        if self.tower and self.chapel and self.tower.side == self.chapel.side:
            raise InputError("church.chapel.side", "the tower stands there", found=self.chapel.side, expected="the other side")
        eaves = max(map(self.eaves, SIDES))
        for wall in ("facade", "triumphal_arch", "choir_arch", "east"):
            ridge = getattr(getattr(self, wall), "ridge", None)
            if ridge is not None and ridge < eaves - CLOSE:
                raise InputError(f"church.{wall}.ridge", "below the eaves", found=f"{ridge:g} m", expected=f">= {eaves:g} m")
        room = self.inner("left") + self.inner("right")
        if room < LEAST_ROOM * self.stone_length:
            raise InputError(
                "church.nave.width", "no room inside", found=f"{room:.4g} m clear", expected=f">= {self.stone_length:g} m"
            )
        if self.transept:
            _check_transept(self, self.transept)

    def thickness(self, side: str) -> float:
        """Return the thickness of a side wall of the nave, m."""
        return own(self.walls, f"nave_{side}", "thickness", self.nave.thickness)

    def eaves(self, side: str) -> float:
        """Return the height of the eaves of a side wall of the nave, m."""
        return own(self.walls, f"nave_{side}", "height", self.nave.height)

    def inner(self, side: str) -> float:
        """Return the distance of the inner face of a side wall from the axis, m."""
        return (self.nave.width - self.thickness(side)) / 2

    def outer(self, side: str) -> float:
        """Return the distance of its outer face, m."""
        return (self.nave.width + self.thickness(side)) / 2

    @property
    def apse_names(self) -> list[str]:
        """The names of the apses: "apse", or "apse_1" and so on."""
        return ["apse"] if len(self.apses) == 1 else [f"apse_{number}" for number, _ in enumerate(self.apses, start=1)]

    def arm(self, side: str) -> tuple[str, float]:
        """Return the name of the macro-element that an arm of the transept forms, and the height of its walls, m."""
        if self.tower and self.tower.side == side:
            return "tower", self.tower.height
        if self.chapel and self.chapel.side == side:
            return "chapel", self.chapel.height
        return f"transept_{side}", self.arm_height

    @property
    def arm_height(self) -> float:
        """Height of the walls of an arm that is neither tower nor chapel, m."""
        height = self.transept.height if self.transept else None
        return self.nave.height if height is None else height

    def narrow_tower(self, side: str) -> float | None:
        """Return the width of a tower that takes only part of its arm, m."""
        return self.tower.width if self.tower and self.tower.side == side else None


def _check_transept(plan: Plan, transept: Transept) -> None:
    outer = max(map(plan.outer, SIDES))
    room = transept.width / 2 - transept.thickness - outer
    if room < LEAST_ROOM * plan.stone_length:
        raise InputError(
            "church.transept.width",
            "no room in its arms",
            found=f"{transept.width:g} m over all, {room:.4g} m clear beside the nave ({2 * outer:g} m wide)",
            expected=f">= {2 * (outer + transept.thickness + plan.stone_length):.4g} m",
        )
    behind = plan.choir_arch or plan.east
    front = plan.triumphal_arch
    deep = transept.depth - ((front.thickness if front else 0.0) + (behind.thickness if behind else 0.0)) / 2
    if deep < LEAST_ROOM * plan.stone_length:
        raise InputError(
            "church.transept.depth", "no room inside", found=f"{deep:.4g} m clear", expected=f">= {plan.stone_length:g} m"
        )
    if plan.tower and plan.tower.width is not None:
        widest = transept.width / 2 - outer - plan.stone_length
        if plan.tower.width > widest + CLOSE:
            raise InputError(
                "church.tower.width",
                "the tower is wider than the transept's arm",
                found=f"{plan.tower.width:g} m",
                expected=f"<= {widest:.4g} m, a passage beside the nave left free",
                remedy="Leave the width out: the tower then takes the whole arm, and the nave's side wall as its inner wall.",
            )
        narrowest = 2 * transept.thickness + plan.stone_length
        if plan.tower.width < narrowest - CLOSE:
            raise InputError(
                "church.tower.width", "no room inside", found=f"{plan.tower.width:g} m", expected=f">= {narrowest:.4g} m"
            )


def church_walls(plan: Plan) -> list[WallLayout]:
    """Return the straight walls: those across the nave from the facade on, the side walls, the outer walls of the transept."""
    across, along = (0, 1) if plan.x_first else (1, 0)
    walls = [_cross_wall(plan, name, wall, y, across) for name, wall, y in cross_walls(plan)]
    walls += [_side_wall(plan, side, along) for side in SIDES]
    if plan.transept:
        for side in SIDES:
            walls += _arm_walls(plan, plan.transept, side, along)
    return walls


def cross_walls(plan: Plan) -> list[tuple[str, CrossWall, float]]:
    """Return the walls across the nave: name, wall, y of its centreline, m."""
    y = plan.nave.length
    found = [("facade", plan.facade, 0.0), ("triumphal_arch", plan.triumphal_arch, y)]
    if plan.transept:
        y += plan.transept.depth
        found.append(("choir_arch", plan.choir_arch, y))
    if plan.choir:
        y += plan.choir.length
    found.append(("east", plan.east, y))
    return [(name, wall, at) for name, wall, at in found if wall]


def _transept_walls(plan: Plan) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return y of the faces of the walls before and behind the transept, m."""
    assert plan.transept
    depth = {y: wall.thickness / 2 for _, wall, y in cross_walls(plan)}
    front, back = plan.nave.length, plan.nave.length + plan.transept.depth
    return (front - depth[front], front + depth[front]), (back - depth[back], back + depth[back])


def _cross_wall(plan: Plan, name: str, wall: CrossWall, y: float, parity: Literal[0, 1]) -> WallLayout:
    eaves = max(map(plan.eaves, SIDES))
    ridge = eaves if wall.ridge is None else wall.ridge
    left: list[tuple[float, float]] = [(-plan.outer("left"), plan.eaves("left"))]
    right: list[tuple[float, float]] = [(plan.outer("right"), plan.eaves("right"))]
    parts: list[tuple[str, float, float]] = []
    transept = plan.transept
    if transept and (name == "triumphal_arch" or abs(y - plan.nave.length - transept.depth) < CLOSE):
        place = "front" if name == "triumphal_arch" else "back"
        reach = transept.width / 2
        for side, sign in (("left", -1.0), ("right", 1.0)):
            arm, height = plan.arm(side)
            rise = (ridge - plan.eaves(side)) * (1 - plan.inner(side) / plan.outer(side))
            steps = _arm_top(plan, reach, height, plan.eaves(side) + rise, side)
            if side == "left":
                left = [(-s, z) for s, z in steps]
            else:
                right = steps[::-1]
            narrow = plan.narrow_tower(side)
            stop = plan.inner(side) if narrow is None else reach - narrow
            parts.append((f"{arm}_{place}", *_sorted(sign * reach, sign * stop)))
            if narrow is not None:
                parts.append((f"transept_{side}_{place}", *_sorted(sign * stop, sign * plan.inner(side))))
    top = [*left, *([(0.0, ridge)] if ridge > eaves + CLOSE else []), *right]
    return WallLayout(name, "x", y, wall.thickness, tuple(top), parity, tuple(parts))


def _sorted(first: float, second: float) -> tuple[float, float]:
    return min(first, second), max(first, second)


def _arm_top(plan: Plan, reach: float, height: float, gable: float, side: str) -> list[tuple[float, float]]:
    """Return the top of one arm of a cross wall from its end inwards, distances from the axis and z, m; gable: z of the gable
    over the inner face of the side wall."""
    eaves, narrow = plan.eaves(side), plan.narrow_tower(side)
    steps = [(reach, height)]
    if narrow is not None:
        steps.append((reach - narrow, height))
        height = plan.arm_height
        steps.append((reach - narrow, height))
    if abs(height - eaves) < CLOSE:
        return [*steps, (plan.outer(side), eaves)]
    edge, end = (plan.inner(side), gable) if height > eaves else (plan.outer(side), eaves)
    return [*steps, (edge, height), (edge, end)]


def _side_wall(plan: Plan, side: Literal["left", "right"], parity: Literal[0, 1]) -> WallLayout:
    walls = cross_walls(plan)
    start = -plan.facade.thickness / 2 if plan.facade else 0.0
    last = walls[-1][2] + walls[-1][1].thickness / 2 if walls else 0.0
    stop = max(last, plan.nave.length)
    eaves = plan.eaves(side)
    top = [(start, eaves), (stop, eaves)]
    parts: list[tuple[str, float, float]] = []
    if plan.transept:
        (first, _), (_, end) = _transept_walls(plan)
        arm, height = plan.arm(side)
        if plan.narrow_tower(side) is not None:
            arm, height = f"transept_{side}", plan.arm_height
        if height > eaves + CLOSE:
            top = [(start, eaves), (first, eaves), (first, height), (end, height)]
            if stop > end + CLOSE:
                top += [(end, eaves), (stop, eaves)]
        parts.append((f"{arm}_inner", first, end))
    sign = -1.0 if side == "left" else 1.0
    return WallLayout(f"nave_{side}", "y", sign * plan.nave.width / 2, plan.thickness(side), tuple(top), parity, tuple(parts))


def _arm_walls(plan: Plan, transept: Transept, side: Literal["left", "right"], parity: Literal[0, 1]) -> list[WallLayout]:
    """Return the outer wall of an arm, and the inner wall of a tower narrower than its arm."""
    (start, _), (_, stop) = _transept_walls(plan)
    arm, height = plan.arm(side)
    sign = -1.0 if side == "left" else 1.0
    reach = transept.width / 2
    top = ((start, height), (stop, height))
    part = ((f"{arm}_outer", start, stop),)
    thickness = own(plan.walls, f"transept_{side}", "thickness", transept.thickness)
    walls = [WallLayout(f"transept_{side}", "y", sign * (reach - thickness / 2), thickness, top, parity, part)]
    narrow = plan.narrow_tower(side)
    if narrow is not None:
        at = sign * (reach - narrow + transept.thickness / 2)
        walls.append(WallLayout("tower_inner", "y", at, transept.thickness, top, parity))
    return walls
