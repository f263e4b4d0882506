"""Domes of a church: a half dome on an apse, a dome on slabs across the corners of its crossing."""

import math

import numpy as np

from churchpipe.errors import InputError
from churchpipe.generators.church_parts import Apse
from churchpipe.generators.layout import CLOSE
from churchpipe.generators.rooms import Room, RoomVault, check_fits
from churchpipe.model.vault import Vault
from churchpipe.vaults.directrix import between, circular
from churchpipe.vaults.dome import add_rings
from churchpipe.vaults.squinches import add_squinches
from churchpipe.vaults.sweep import Courses


def half_dome(where: str, vault: RoomVault, apse: Apse, face: float, material: str) -> Vault:
    """Return a half dome on the wall of an apse, against the outer face of the end wall at y = face, m.

    Raises
    ------
    InputError: a dome thicker than the wall, or with a springing or a rise of its own.
    """
    if vault.thickness > apse.thickness + CLOSE:
        raise InputError(
            f"{where}.thickness",
            "thicker than the wall of the apse",
            found=f"{vault.thickness:g} m",
            expected=f"<= {apse.thickness:g} m",
        )
    _check_shape(where, vault, apse.height, "the top of the apse")
    courses = Courses()
    _add_hemisphere(where, courses, vault, apse.inner_radius, apse.height, (apse.centre, face), turn=math.pi)
    return courses.vault(f"vault_{vault.over}", material)


def crossing_dome(where: str, vault: RoomVault, room: Room, material: str) -> list[Vault]:
    """Return a dome over a square room, and the course below it, which spans the corners with slabs.

    The dome stands with its whole thickness on the octagon that walls and slabs leave open.

    Raises
    ------
    InputError: a room that is no square, or has walls that are not level or too thin; a springing or a rise of its own.
    """
    check_fits(where, vault, room)
    _check_shape(where, vault, room.top, "the top of the walls")
    half = (room.x[1] - room.x[0]) / 2
    reach = min(half + min(room.thickness, *(wall.thickness for wall in room.ends)), math.sqrt(2) * half)
    inner = half / math.cos(math.pi / 8) / math.cos(math.pi / vault.sides)
    if inner + vault.thickness > reach + CLOSE:
        raise InputError(
            f"{where}.thickness",
            "the dome reaches beyond the walls below it",
            found=f"outer radius {inner + vault.thickness:.4g} m",
            expected=f"<= {reach:.4g} m: half the room, {half:.4g} m, and the wall",
        )
    top = room.top + (vault.slab or vault.thickness)
    centre = ((room.x[0] + room.x[1]) / 2, (room.y[0] + room.y[1]) / 2)
    name = f"vault_{vault.over}"
    below, courses = Courses(), Courses()
    add_squinches(below, half, reach, (room.top, top), centre=centre, part=(f"{name}_slab", f"{name}_springer"))
    _add_hemisphere(where, courses, vault, inner, top, centre)
    return [courses.vault(name, material), below.vault(f"{name}_foot", material, shell="bodies")]


def _check_shape(where: str, vault: RoomVault, level: float, top: str) -> None:
    for key, given in (("springing", vault.springing), ("rise", vault.rise), ("backing", vault.backing)):
        if given is not None and not (key == "springing" and abs(given - level) < CLOSE):
            expected = f"z = {level:g} m, {top}" if key == "springing" else "no such key: it is a part of a sphere"
            raise InputError(f"{where}.{key}", "a dome has none of its own", found=f"{given:g} m", expected=expected)
    if vault.sides % 2 or vault.sides < 4 or vault.courses < 2:
        raise InputError(
            f"{where}.sides",
            "stones two sides wide do not go round",
            found=vault.sides,
            expected="an even number, two rings or more",
        )


def _add_hemisphere(
    where: str,
    courses: Courses,
    vault: RoomVault,
    inner: float,
    level: float,
    centre: tuple[float, float],
    turn: float = 2 * math.pi,
) -> None:
    """Add a dome of this inner radius, m, from z = level upwards, or a part of it within `turn` rad."""
    angles = np.pi / 2 / vault.courses * np.arange(vault.courses, dtype=np.float64)
    directrix = circular(inner, vault.thickness, angles).raised(level)
    crown = directrix.joints[-1] * np.array([0.0, 1.0])
    add_rings(
        courses,
        [*directrix.sections, between(directrix.joints[-1], crown)],
        centre=centre,
        sectors=vault.sides,
        width=2,
        part=f"vault_{vault.over}",
        stagger=vault.heads == "staggered",
        turn=turn,
        shortest=vault.shortest_stone or 0.0,
        where=where,
    )
