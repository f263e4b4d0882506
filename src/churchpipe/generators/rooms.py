"""The rooms of a church, between its walls, and what their vaults need of these."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, Literal

import numpy as np

from churchpipe.errors import InputError
from churchpipe.generators.arched import Hole
from churchpipe.generators.checks import together
from churchpipe.generators.church_plan import LEAST_ROOM, Plan, cross_walls
from churchpipe.generators.fields import coerce_fields
from churchpipe.generators.layout import CLOSE, WallLayout
from churchpipe.generators.profile import Profile, Shape
from churchpipe.model.quantities import Count, Length
from churchpipe.vaults.crossed import Corner


@dataclass(frozen=True, slots=True)
class RoomVault:
    """A vault over a room of a church. Walls end at its springing."""

    over: Annotated[str, "Room: nave, crossing, choir, or an apse by its name."]
    thickness: Annotated[Length, "Thickness."]
    courses: Annotated[Count, "Courses from springing to springing, an odd number; of a dome or half dome its rings."]
    kind: Annotated[
        Literal["barrel", "groin", "pavilion", "dome", "half_dome"],
        "A barrel runs along y; a pavilion, or a dome on slabs across the corners, lies over a square, a half dome over an apse.",
    ] = "barrel"
    springing: Annotated[Length | None, "Height of the springing; by default the top of the walls."] = None
    stone_length: Annotated[Length | None, "Length of the stones; by default that of the walls."] = None
    shape: Annotated[Shape, "Shape of the soffit."] = "round"
    rise: Annotated[Length | None, "Rise of the soffit, of a segmental or pointed vault."] = None
    heads: Annotated[Literal["staggered", "aligned"], "Head joints of neighbouring courses: staggered, or in one line."] = (
        "staggered"
    )
    corner: Annotated[Corner, "Which corner stones of crossed vaults run round the mitre: all, every other or none."] = "round"
    backing: Annotated[Length | None, "Height over the springing of masonry on the haunches."] = None
    sides: Annotated[Count, "Flat sides of the plan of a dome or half dome."] = 16
    shortest_stone: Annotated[
        Length | None, "Length below which stones of a dome's rings are not laid: such rings have half as many, twice as long."
    ] = None
    slab: Annotated[Length | None, "Height of the slabs across the corners below a dome; by default its thickness."] = None
    arches: Annotated[Count | None, "Number of arches below a barrel, or on the four sides of a groin vault."] = None
    arch_width: Annotated[Length | None, "Width of these arches."] = None
    arch_depth: Annotated[Length | None, "Depth of these arches; a barrel springs so far behind the faces of the walls."] = None
    rib_width: Annotated[Length | None, "Width of ribs below the groins of a groin vault."] = None
    rib_depth: Annotated[Length | None, "Depth of these ribs; the vault springs so far behind the faces of the walls."] = None

    def __post_init__(self) -> None:
        coerce_fields(self, "vault: ")
        together("vault", self, "arches", "arch_width", "arch_depth")
        together("vault", self, "rib_width", "rib_depth")
        of_kinds = {
            "arches": ("barrel", "groin"),
            "rib_width": ("groin",),
            "slab": ("dome",),
            "shortest_stone": ("dome", "half_dome"),
        }
        for key, kinds in of_kinds.items():
            if getattr(self, key) is not None and self.kind not in kinds:
                raise InputError(
                    f"vault.{key}", f"only a {' or '.join(kinds)} has one", found=f"kind = {self.kind}", expected="no such key"
                )
        if self.kind == "groin" and self.arches not in (None, 4):
            raise InputError("vault.arches", "a groin vault has four sides", found=self.arches, expected="4")

    @property
    def below(self) -> float:
        """Depth of the arches or ribs below the vault, m. The arches of a groin vault stand before its ends."""
        return (self.arch_depth if self.kind == "barrel" else self.rib_depth) or 0.0


@dataclass(frozen=True, slots=True)
class Room:
    """Inner faces of a room, x and y in m, its top, the thickness of the thinner wall beside it, the walls along y on both sides
    and those along x."""

    x: tuple[float, float]
    y: tuple[float, float]
    top: float
    thickness: float
    sides: tuple[WallLayout, ...]
    ends: tuple[WallLayout, ...]


def rooms_of(plan: Plan, walls: Sequence[WallLayout]) -> dict[str, Room]:
    """Return the rooms between the walls across the nave: nave, crossing and choir, as far as there are walls around them."""
    named = {wall.name: wall for wall in walls}
    left, right = named["nave_left"], named["nave_right"]
    x = (left.at + left.thickness / 2, right.at - right.thickness / 2)
    names = ["nave", *(["crossing"] if plan.transept else []), *(["choir"] if plan.choir else [])]
    across = [named[name] for name, _, _ in cross_walls(plan)]
    before = across[0] if plan.facade else None
    behind = across[1:] if plan.facade else across
    rooms: dict[str, Room] = {}
    for number, name in enumerate(names):
        after = behind[number] if number < len(behind) else None
        y = (before.at + before.thickness / 2 if before else 0.0, after.at - after.thickness / 2 if after else plan.nave.length)
        if y[1] - y[0] < LEAST_ROOM * plan.stone_length:
            found, expected = f"{y[1] - y[0]:.4g} m clear", f">= {plan.stone_length:g} m"
            raise InputError(f"church.{name}.length", "no room inside", found=found, expected=expected)
        ends = tuple(wall for wall in (before, after) if wall)
        top = min(z for wall in (left, right) for _, z in _tops(wall, y))
        rooms[name] = Room(x, y, top, min(left.thickness, right.thickness), (left, right), ends)
        before = after
    return rooms


def end_face(plan: Plan) -> float:
    """Return y of the outer face of the end wall, m."""
    assert plan.east
    return cross_walls(plan)[-1][2] + plan.east.thickness / 2


def check_fits(where: str, vault: RoomVault, room: Room) -> None:
    """Raise InputError unless walls with level tops at the springing carry the vault."""
    springing = room.top if vault.springing is None else vault.springing
    if abs(springing - room.top) > CLOSE:
        raise InputError(
            f"{where}.springing",
            "the walls go on beside the vault" if springing < room.top else "above the walls",
            found=f"z = {springing:g} m",
            expected=f"z = {room.top:g} m, the top of the walls",
        )
    deep = vault.thickness + vault.below
    if deep > room.thickness + CLOSE:
        raise InputError(
            f"{where}.thickness",
            "thicker than the walls that carry it",
            found=f"{deep:g} m with the arches or ribs below it" if vault.below else f"{vault.thickness:g} m",
            expected=f"<= {room.thickness:g} m",
        )
    carry = [(wall, room.y) for wall in room.sides]
    if vault.kind != "barrel":
        carry += [(wall, room.x) for wall in room.ends]
    for wall, span in carry:
        for s, z in _tops(wall, span):
            if abs(z - room.top) > CLOSE:
                raise InputError(
                    where,
                    f"the wall {wall.name} is not level under the vault",
                    found=f"z = {z:.4g} m at {wall.along} = {s:.4g} m",
                    expected=f"z = {room.top:g} m from {span[0]:.4g} to {span[1]:.4g} m",
                    remedy="Leave out its gable (ridge), or take a barrel." if vault.kind != "barrel" else "",
                )
    # Vaults other than barrels lie on the corners of the room as well, where a tower may begin.
    for wall, (low, high) in carry if vault.kind != "barrel" else ():
        for s, z in _tops(wall, (low - deep, high + deep)):
            if z > room.top + CLOSE:
                raise InputError(
                    where,
                    f"the wall {wall.name} goes on beside the vault, which lies on the corner of its room",
                    found=f"z = {z:.4g} m at {wall.along} = {s:.4g} m",
                    expected=f"z = {room.top:g} m from {low - deep:.4g} to {high + deep:.4g} m",
                    remedy="Give a tower at this corner a width of its own, or take a barrel.",
                )
    width, length = room.x[1] - room.x[0], room.y[1] - room.y[0]
    if vault.kind in ("pavilion", "dome") and abs(width - length) > CLOSE:
        raise InputError(
            f"{where}.kind",
            "the room is no square",
            found=f"{width:.4g} by {length:.4g} m",
            expected="equal sides, or a groin vault",
        )


def _tops(wall: WallLayout, span: tuple[float, float]) -> Iterator[tuple[float, float]]:
    """Return where the top of a wall turns within a span, and at its ends: (s, z) m."""
    for (s0, z0), (s1, z1) in pairwise(wall.top):
        low, high = max(s0, span[0]), min(s1, span[1])
        if high - low > CLOSE:
            yield from ((s, z0 + (z1 - z0) * (s - s0) / (s1 - s0)) for s in (low, high))


def check_ends(where: str, profile: Profile, room: Room, openings: Mapping[str, Sequence[Hole]]) -> None:
    """Raise InputError where a barrel rises above the gables at its ends, or hides the head of an opening in them.

    openings: those of each wall, in s along x and z, m.
    """
    soffit = profile.whole.joints[:, 0]
    order = np.argsort(soffit[:, 0])
    middle, crown = (room.x[0] + room.x[1]) / 2, float(profile.whole.joints[..., 1].max())
    for wall in room.ends:
        ridge = max(z for _, z in _tops(wall, room.x))
        if room.top + CLOSE < ridge < crown - CLOSE:
            raise InputError(
                where,
                f"the vault rises above the ridge of the wall {wall.name}",
                found=f"crown at z = {crown:.4g} m",
                expected=f"<= {ridge:g} m",
                remedy='A smaller rise (shape = "segmental"), or a higher ridge.',
            )
        for hole in openings.get(wall.name, ()):
            s0, _, s1, head = hole.outer
            if s1 < room.x[0] or s0 > room.x[1]:
                continue
            over = np.interp(np.array([s0, s1]) - middle, *soffit[order].T, left=room.top, right=room.top).min()
            if head > max(room.top, over) + CLOSE:
                raise InputError(
                    where,
                    f"springs below the head of the opening {hole.opening.name} in the wall {wall.name}",
                    found=f"head at z = {head:.4g} m, soffit over its sides at z = {over:.4g} m",
                    expected="openings below the soffit",
                    remedy="Lower or narrow the opening, or raise the walls.",
                )
