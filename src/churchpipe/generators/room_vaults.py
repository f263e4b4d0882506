"""Vaults over the rooms of a church, on the tops of its walls."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Annotated, Literal

import numpy as np

from churchpipe.errors import InputError
from churchpipe.generators.church_parts import Apse
from churchpipe.generators.church_plan import Plan, cross_walls
from churchpipe.generators.fields import coerce_fields
from churchpipe.generators.layout import CLOSE, WallLayout
from churchpipe.generators.profile import Profile, Shape, backing, skewback, to_middle
from churchpipe.model.quantities import Count, Length
from churchpipe.model.vault import Section, Side, Vault
from churchpipe.vaults.barrel import add_barrel
from churchpipe.vaults.crossed import Corner, add_cloister, add_groin
from churchpipe.vaults.directrix import between, circular
from churchpipe.vaults.dome import add_rings
from churchpipe.vaults.sweep import Courses


@dataclass(frozen=True, slots=True)
class RoomVault:
    """A vault over a room of a church. Walls end at its springing."""

    over: Annotated[str, "Room: nave, crossing, choir, or an apse by its name."]
    thickness: Annotated[Length, "Thickness."]
    courses: Annotated[Count, "Courses from springing to springing, an odd number; of a half dome its rings."]
    kind: Annotated[
        Literal["barrel", "groin", "pavilion", "half_dome"],
        "A barrel runs along y, a pavilion lies over a square, a half dome over an apse.",
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
    sides: Annotated[Count, "Flat sides of the plan of a half dome."] = 16

    def __post_init__(self) -> None:
        coerce_fields(self, "vault: ")


@dataclass(frozen=True, slots=True)
class _Room:
    """Inner faces of a room, x and y in m, its top, the thickness of the thinner wall beside it, the walls along y on both sides
    and those along x."""

    x: tuple[float, float]
    y: tuple[float, float]
    top: float
    thickness: float
    sides: tuple[WallLayout, ...]
    ends: tuple[WallLayout, ...]


def room_vaults(
    plan: Plan, walls: Sequence[WallLayout], vaults: Sequence[RoomVault], stone_length: float, material: str
) -> list[Vault]:
    """Return the vaults of a church.

    Raises
    ------
    InputError: a room that there is not, a vault that does not fit on its walls, with the numbers.
    """
    rooms = _rooms(plan, walls)
    apses = dict(zip(plan.apse_names, plan.apses, strict=True))
    found: list[Vault] = []
    taken: set[str] = set()
    for number, vault in enumerate(vaults):
        where = f"church.vaults.{number}"
        if vault.over not in {*rooms, *apses}:
            raise InputError(f"{where}.over", "no such room", found=vault.over, expected=", ".join([*rooms, *apses]))
        if vault.over in taken:
            raise InputError(f"{where}.over", "has a vault already", found=vault.over, expected="one vault a room")
        taken.add(vault.over)
        if (vault.kind == "half_dome") != (vault.over in apses):
            expected = 'kind = "half_dome"' if vault.over in apses else 'kind = "barrel", "groin" or "pavilion"'
            raise InputError(f"{where}.kind", f"no vault for {vault.over}", found=vault.kind, expected=expected)
        if vault.over in apses:
            found.append(_half_dome(where, vault, apses[vault.over], _face(plan), material))
        else:
            found += _over_room(where, vault, rooms[vault.over], vault.stone_length or stone_length, material)
    return found


def _rooms(plan: Plan, walls: Sequence[WallLayout]) -> dict[str, _Room]:
    """Return the rooms between the walls across the nave: nave, crossing and choir, as far as there are walls around them."""
    named = {wall.name: wall for wall in walls}
    left, right = named["nave_left"], named["nave_right"]
    x = (left.at + left.thickness / 2, right.at - right.thickness / 2)
    names = ["nave", *(["crossing"] if plan.transept else []), *(["choir"] if plan.choir else [])]
    across = [named[name] for name, _, _ in cross_walls(plan)]
    before = across[0] if plan.facade else None
    behind = across[1:] if plan.facade else across
    rooms: dict[str, _Room] = {}
    for number, name in enumerate(names):
        after = behind[number] if number < len(behind) else None
        y = (before.at + before.thickness / 2 if before else 0.0, after.at - after.thickness / 2 if after else plan.nave.length)
        ends = tuple(wall for wall in (before, after) if wall)
        top = min(z for wall in (left, right) for _, z in _tops(wall, y))
        rooms[name] = _Room(x, y, top, min(left.thickness, right.thickness), (left, right), ends)
        before = after
    return rooms


def _face(plan: Plan) -> float:
    """Return y of the outer face of the end wall, m."""
    assert plan.east
    return cross_walls(plan)[-1][2] + plan.east.thickness / 2


def _over_room(where: str, vault: RoomVault, room: _Room, stone_length: float, material: str) -> list[Vault]:
    _check_fits(where, vault, room)
    span, length = room.x[1] - room.x[0], room.y[1] - room.y[0]
    profile = Profile(where, span, vault.thickness, vault.courses, vault.shape, vault.rise, room.top)
    outer = span / 2 + room.thickness
    half = profile.whole if vault.kind == "barrel" else profile.half
    name = f"vault_{vault.over}"
    foot = skewback(half.joints[0], max(float(half.joints[0, 1, 0]), outer))
    laid: list[tuple[str, list[Section]]] = [(f"{name}_skewback", [foot])] if foot else []
    if vault.backing is not None:
        layers = backing(half.joints, outer, room.top + vault.backing)
        if not layers:
            least = half.joints[1, 1, 1] - room.top
            raise InputError(
                f"{where}.backing", "lower than the first course", found=f"{vault.backing:g} m", expected=f">= {least:.4g} m"
            )
        laid.append((f"{name}_backing", layers))
    courses, filled = Courses(), Courses()
    stagger = vault.heads == "staggered"
    middle = ((room.x[0] + room.x[1]) / 2, (room.y[0] + room.y[1]) / 2)
    if vault.kind == "barrel":
        lay = partial(
            add_barrel,
            side=Side(np.array([middle[0], 0.0]), np.array([1.0, 0.0]), np.array([0.0, 1.0])),
            span=room.y,
            stone_length=stone_length,
            stagger=stagger,
        )
        for part, sections in laid:
            to = filled if part.endswith("backing") else courses
            lay(to, sections, part=f"{part}_right")
            lay(to, [section.mirrored for section in sections], part=f"{part}_left")
        lay(courses, profile.whole.sections, part=name, numbers=profile.voussoir)
    elif vault.kind == "groin":
        ratio = length / span
        lay = partial(add_groin, centre=middle, ratio=ratio, stone_length=stone_length, corner=vault.corner, stagger=stagger)
        reach = float(half.joints[0, 1, 0]) if not laid else outer
        for part, sections in [*laid, (name, to_middle(half))]:
            webs = sections, [section.stretched(ratio) for section in sections]
            lay(
                filled if part.endswith("backing") else courses, webs, borders=(reach * ratio, reach), part=part, key=part == name
            )
    else:
        lay = partial(add_cloister, centre=middle, sides=4, stone_length=stone_length, corner=vault.corner, stagger=stagger)
        for part, sections in [*laid, (name, to_middle(half))]:
            lay(filled if part.endswith("backing") else courses, sections, part=part, key=part == name)
    found = [courses.vault(name, material)]
    return [*found, filled.vault(f"{name}_backing", material, surface=False)] if filled.runs else found


def _check_fits(where: str, vault: RoomVault, room: _Room) -> None:
    """Raise InputError unless walls with level tops at the springing carry the vault."""
    springing = room.top if vault.springing is None else vault.springing
    if abs(springing - room.top) > CLOSE:
        raise InputError(
            f"{where}.springing",
            "the walls go on beside the vault" if springing < room.top else "above the walls",
            found=f"z = {springing:g} m",
            expected=f"z = {room.top:g} m, the top of the walls",
        )
    if vault.thickness > room.thickness + CLOSE:
        raise InputError(
            f"{where}.thickness",
            "thicker than the walls that carry it",
            found=f"{vault.thickness:g} m",
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
    width, length = room.x[1] - room.x[0], room.y[1] - room.y[0]
    if vault.kind == "pavilion" and abs(width - length) > CLOSE:
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


def _half_dome(where: str, vault: RoomVault, apse: Apse, face: float, material: str) -> Vault:
    """Return a half dome on the wall of an apse, against the outer face of the end wall."""
    if vault.thickness > apse.thickness + CLOSE:
        raise InputError(
            f"{where}.thickness",
            "thicker than the wall of the apse",
            found=f"{vault.thickness:g} m",
            expected=f"<= {apse.thickness:g} m",
        )
    for key, given in (("springing", vault.springing), ("rise", vault.rise), ("backing", vault.backing)):
        if given is not None and not (key == "springing" and abs(given - apse.height) < CLOSE):
            expected = f"z = {apse.height:g} m, the top of the apse" if key == "springing" else "no such key: it is half a sphere"
            raise InputError(f"{where}.{key}", "a half dome has none of its own", found=f"{given:g} m", expected=expected)
    if vault.sides % 2 or vault.courses < 2:
        raise InputError(
            f"{where}.sides",
            "stones two sides wide do not go round",
            found=vault.sides,
            expected="an even number, two rings or more",
        )
    angles = np.pi / 2 / vault.courses * np.arange(vault.courses, dtype=np.float64)
    directrix = circular(apse.inner_radius, vault.thickness, angles).raised(apse.height)
    crown = directrix.joints[-1] * np.array([0.0, 1.0])
    courses = Courses()
    add_rings(
        courses,
        [*directrix.sections, between(directrix.joints[-1], crown)],
        centre=(apse.centre, face),
        sectors=vault.sides,
        width=2,
        part=f"vault_{vault.over}",
        stagger=vault.heads == "staggered",
        turn=np.pi,
    )
    return courses.vault(f"vault_{vault.over}", material)
