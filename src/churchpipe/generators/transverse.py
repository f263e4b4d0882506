"""Transverse arches below a barrel, ribs below a groin vault and arches before its ends."""

import math

import numpy as np

from churchpipe.errors import InputError
from churchpipe.generators.profile import Profile, to_middle, under_soffit
from churchpipe.model.vault import Side
from churchpipe.vaults.barrel import add_barrel
from churchpipe.vaults.crossed import add_ribs, add_wall_arches
from churchpipe.vaults.directrix import Directrix
from churchpipe.vaults.sweep import Courses


def add_transverse(
    courses: Courses,
    profile: Profile,
    *,
    side: Side,
    span: tuple[float, float],
    count: int,
    width: float,
    depth: float,
    where: str,
    part: str,
    rings: bool = False,
) -> None:
    """Add arches below a barrel, the first at its start and the last at its end; one alone in the middle.

    Parameters
    ----------
    profile: of the barrel, whose bends the arches have. span: its ends, m. width, depth: of the arches, m. where: the
    parameters, for messages. part: macro-elements are part_1 and so on. rings: whether the barrel is laid in rings.

    Raises
    ------
    InputError: arches that do not fit beside each other.
    """
    room = span[1] - span[0] - width
    if room < (count - 1) * width - 1e-9:
        most = int((span[1] - span[0]) / width)
        raise InputError(f"{where}.arches", "no room between the arches", found=count, expected=f"<= {most}")
    starts = span[0] + (np.linspace(0.0, room, count) if count > 1 else np.array([room / 2]))
    bends, numbers = profile.whole, profile.voussoir
    if rings:
        bends, numbers = profile.halved, [half // 2 for half in range(2 * profile.courses)]
    below = under_soffit(bends.joints, depth)
    for number, start in enumerate(starts.tolist(), start=1):
        # One stone goes through the width of an arch.
        add_barrel(courses, below.sections, side, (start, start + width), 2 * width, part=f"{part}_{number}", numbers=numbers)


def add_groin_ribs(
    courses: Courses,
    profile: Profile,
    *,
    where: str,
    centre: tuple[float, float],
    ratio: float,
    reach: float,
    width: float,
    depth: float,
    part: str,
) -> None:
    """Add ribs below the groins of a vault with this profile across its first web.

    Parameters
    ----------
    ratio: span of the second web over that of the first. reach: distance from the middle to which the springing goes, m. width,
    depth: of the ribs, m. where: the parameters, for messages.

    Raises
    ------
    InputError: ribs that spring beside the corners.
    """
    widest = 2 * (reach - profile.span / 2) * ratio / math.hypot(1, ratio)
    if width > widest + 1e-9:
        raise InputError(
            f"{where}.rib_width",
            "ribs spring beside the corners",
            found=f"{width:g} m",
            expected=f"<= {widest:.4g} m",
            remedy="Narrower ribs, or a thicker vault.",
        )
    ribs = to_middle(under_soffit(profile.half.joints, depth))
    webs = ribs, [section.stretched(ratio) for section in ribs]
    add_ribs(courses, webs, centre=centre, ratio=ratio, width=width, part=part)


def add_groin_ends(
    courses: Courses,
    profile: Profile,
    *,
    centre: tuple[float, float],
    ratio: float,
    reach: float,
    width: float,
    depth: float,
    part: str,
) -> None:
    """Add an arch before each end of a groin vault, as deep as vault and arch together; arguments as in `add_groin_ribs`."""
    joints = profile.half.joints.copy()
    joints[:, 0] = under_soffit(joints, depth).joints[:, 0]
    arch = to_middle(Directrix(joints))
    ends = arch, [section.stretched(ratio) for section in arch]
    add_wall_arches(courses, ends, centre=centre, borders=(reach * ratio, reach), width=width, part=part)
