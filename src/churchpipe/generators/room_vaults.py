"""Vaults over the rooms of a church, on the tops of its walls."""

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np

from churchpipe.errors import InputError
from churchpipe.generators.arched import Hole
from churchpipe.generators.church_plan import Plan
from churchpipe.generators.layout import CLOSE, WallLayout
from churchpipe.generators.profile import Profile, backing, skewback, to_middle
from churchpipe.generators.room_domes import crossing_dome, half_dome
from churchpipe.generators.rooms import Room, RoomVault, check_ends, check_fits, end_face, rooms_of
from churchpipe.generators.transverse import add_groin_ends, add_groin_ribs, add_transverse
from churchpipe.model.vault import Section, Side, Vault
from churchpipe.vaults.barrel import add_barrel
from churchpipe.vaults.crossed import add_cloister, add_groin
from churchpipe.vaults.sweep import Courses


def room_vaults(
    plan: Plan,
    walls: Sequence[WallLayout],
    vaults: Sequence[RoomVault],
    stone_length: float,
    material: str,
    openings: Mapping[str, Sequence[Hole]],
) -> list[Vault]:
    """Return the vaults of a church. openings: those of each wall.

    Raises
    ------
    InputError: a room that there is not, a vault that does not fit on its walls, with the numbers.
    """
    rooms = rooms_of(plan, walls)
    apses = dict(zip(plan.apse_names, plan.apses, strict=True))
    found: list[Vault] = []
    vaulted: set[str] = set()
    for number, vault in enumerate(vaults):
        where = f"church.vaults.{number}"
        if vault.over not in {*rooms, *apses}:
            raise InputError(f"{where}.over", "no such room", found=vault.over, expected=", ".join([*rooms, *apses]))
        if vault.over in vaulted:
            raise InputError(f"{where}.over", "has a vault already", found=vault.over, expected="one vault a room")
        vaulted.add(vault.over)
        if (vault.kind == "half_dome") != (vault.over in apses):
            expected = 'kind = "half_dome"' if vault.over in apses else 'kind = "barrel", "groin", "pavilion" or "dome"'
            raise InputError(f"{where}.kind", f"no vault for {vault.over}", found=vault.kind, expected=expected)
        if vault.kind == "dome":
            found += crossing_dome(where, vault, rooms[vault.over], material)
        elif vault.over in apses:
            found.append(half_dome(where, vault, apses[vault.over], end_face(plan), material))
        else:
            found += _over_room(where, vault, rooms[vault.over], vault.stone_length or stone_length, material, openings)
    return found


def _over_room(
    where: str, vault: RoomVault, room: Room, stone_length: float, material: str, openings: Mapping[str, Sequence[Hole]]
) -> list[Vault]:
    check_fits(where, vault, room)
    span, length = room.x[1] - room.x[0], room.y[1] - room.y[0]
    outer = span / 2 + room.thickness
    # Arches and ribs stand on the walls before the vault.
    clear = span + 2 * vault.below
    profile = Profile(where, clear, vault.thickness, vault.courses, vault.shape, vault.rise, room.top)
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
    courses, filled, under = Courses(), Courses(), Courses()
    stagger = vault.heads == "staggered"
    middle = ((room.x[0] + room.x[1]) / 2, (room.y[0] + room.y[1]) / 2)
    if vault.kind == "barrel":
        check_ends(where, profile, room, openings)
        side = Side(np.array([middle[0], 0.0]), np.array([1.0, 0.0]), np.array([0.0, 1.0]))
        lay = partial(add_barrel, side=side, span=room.y, stone_length=stone_length, stagger=stagger)
        for part, sections in laid:
            to = filled if part.endswith("backing") else courses
            lay(to, sections, part=f"{part}_right")
            lay(to, [section.mirrored for section in sections], part=f"{part}_left")
        lay(courses, profile.whole.sections, part=name, numbers=profile.voussoir)
        if vault.arches is not None and vault.arch_width is not None and vault.arch_depth is not None:
            arches = {"count": vault.arches, "width": vault.arch_width, "depth": vault.arch_depth}
            add_transverse(under, profile, side=side, span=room.y, where=where, part=f"{name}_arch", **arches)
    elif vault.kind == "groin":
        ratio = length / span
        lay = partial(add_groin, centre=middle, ratio=ratio, stone_length=stone_length, corner=vault.corner, stagger=stagger)
        reach = float(half.joints[0, 1, 0]) if not laid else outer
        for part, sections in [*laid, (name, to_middle(half))]:
            webs = sections, [section.stretched(ratio) for section in sections]
            lay(
                filled if part.endswith("backing") else courses, webs, borders=(reach * ratio, reach), part=part, key=part == name
            )
        if vault.rib_width is not None and vault.rib_depth is not None:
            ribs = {"width": vault.rib_width, "depth": vault.rib_depth, "part": f"{name}_rib"}
            add_groin_ribs(under, profile, where=where, centre=middle, ratio=ratio, reach=reach, **ribs)
        if vault.arch_width is not None and vault.arch_depth is not None:
            _check_on_walls(where, vault.arch_width, room, (reach, reach * ratio))
            arches = {"width": vault.arch_width, "depth": vault.arch_depth, "part": f"{name}_arch"}
            add_groin_ends(under, profile, centre=middle, ratio=ratio, reach=reach, **arches)
    else:
        lay = partial(add_cloister, centre=middle, sides=4, stone_length=stone_length, corner=vault.corner, stagger=stagger)
        for part, sections in [*laid, (name, to_middle(half))]:
            lay(filled if part.endswith("backing") else courses, sections, part=part, key=part == name)
    beside = ((filled, "backing"), (under, "arches"))
    others = [more.vault(f"{name}_{part}", material, shell="none") for more, part in beside if more.runs]
    return [courses.vault(name, material), *others]


def _check_on_walls(where: str, width: float, room: Room, reach: tuple[float, float]) -> None:
    """Raise InputError where arches of a width stand beyond the walls; reach: where the vault ends, m from the middle."""
    left = [room.thickness + (room.x[1] - room.x[0]) / 2 - reach[0]]
    left += [end.thickness + (room.y[1] - room.y[0]) / 2 - reach[1] for end in room.ends]
    if width > min(left) + CLOSE:
        raise InputError(
            f"{where}.arch_width",
            "the walls are too thin for arches outside the vault",
            found=f"{width:g} m",
            expected=f"<= {max(min(left), 0.0):.4g} m",
            remedy="Leave out backing and skewbacks, which reach to the outer faces of the walls." if min(left) < CLOSE else "",
        )
