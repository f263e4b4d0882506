"""Transverse arches below a barrel."""

import numpy as np

from churchpipe.errors import InputError
from churchpipe.generators.profile import Profile, under_soffit
from churchpipe.model.vault import Side
from churchpipe.vaults.barrel import add_barrel
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
