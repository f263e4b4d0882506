"""Joints with a strength of their own in the shell, where one strength stands for all joints of a facet."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arguments import check_kind, listed
from churchpipe.model.joint_group import JointGroup
from churchpipe.model.materials import JointStrength, by_name
from churchpipe.model.shell import ShellModel

# Heights closer than this are the same, m.
_WHOLE = 1e-6


def shell_joint_groups(
    shell: ShellModel, materials: Sequence[JointStrength], groups: Sequence[JointGroup]
) -> tuple[ShellModel, tuple[JointStrength, ...]]:
    """Return a shell whose facets have a material of their own where joints have a strength of their own, and all materials.

    Parameters
    ----------
    shell
        The mid-surfaces.
    materials
        Strength of the joints of each masonry, by name.
    groups
        Of walls, between heights, or both; or between a wall and the ring beam on it. Of two that pick a facet, the one listed
        later rules. Facets that lie only in part between the heights, and those that touch them, have the lesser strength of
        the group and of their own: a weak joint, such as a damp course, then runs through from end to end, and what slides on
        it is not held by the teeth of the mesh.

    Raises
    ------
    InputError
        A group of one kind of joints, or between other walls: a facet has one strength for all its joints. No such facet.
    """
    check_kind("shell_joint_groups: shell", shell, ShellModel)
    shell, materials = with_bearings(shell, listed("shell_joint_groups: materials", materials, JointStrength))
    known = by_name(materials)
    names = shell.material.astype(np.str_)
    for group in listed("shell_joint_groups: groups", groups, JointGroup):
        where = f"joints {group.name}"
        beam = next((name for name in group.between or () if name in shell.beams.name), None)
        if group.kind is not None or (group.between is not None and beam is None):
            found = group.kind or f"between {' and '.join(group.between or ())}"
            expected = (
                "walls, above or below alone, or a wall and its ring beam: the shell has one strength for all joints of a place"
            )
            raise InputError(
                where, "not in the shell", found=found, expected=expected, remedy="Rigid blocks take them as they are."
            )
        z = shell.points[shell.triangles, 2]
        low, high = z.min(axis=1), z.max(axis=1)
        above, below = -np.inf if group.above is None else group.above, np.inf if group.below is None else group.below
        named = np.isin(shell.panel, group.walls) if group.walls else np.ones(len(z), dtype=np.bool_)
        chosen = named & (high > above + _WHOLE) & (low < below - _WHOLE)
        whole = chosen & (low >= above - _WHOLE) & (high <= below + _WHOLE)
        if beam is not None:
            chosen &= np.isin(shell.panel, group.named) & (shell.beams.bearing == shell.beams.name.tolist().index(beam))
        if not chosen.any():
            raise InputError(where, "no such facet", expected="walls and heights that the shell has")
        given = {key: value for key in ("friction", "cohesion") if (value := getattr(group, key)) is not None}
        before = names
        if beam is None:
            chosen = named & np.isin(shell.triangles, shell.triangles[chosen]).any(axis=1)
        for name in np.unique(before[chosen]).tolist():
            own = _known(known, name)
            lesser = {key: min(value, getattr(own, key)) for key, value in given.items()}
            for other, strength, here in (
                (f"{name}, {group.name}", given, chosen & whole),
                (f"{name}, {group.name} in part", lesser, chosen & ~whole),
            ):
                mine = here & (before == name)
                if mine.any() and any(getattr(own, key) != value for key, value in strength.items()):
                    known[other] = replace(own, name=other, **strength)
                    names = np.where(mine, other, names)
    return replace(shell, material=names), tuple(known.values())


def with_bearings(shell: ShellModel, materials: Sequence[JointStrength]) -> tuple[ShellModel, tuple[JointStrength, ...]]:
    """Return a shell whose facets under ring beams have the lesser strength of beam and masonry, and all materials.

    Raises
    ------
    InputError: a material of the shell or of its beams is not given.
    """
    known = by_name(materials)
    names = shell.material.astype(np.str_)
    for number, (beam, material) in enumerate(zip(shell.beams.name.tolist(), shell.beams.material.tolist(), strict=True)):
        bears = f" under {beam}"
        under = shell.beams.bearing == number
        for name in np.unique(names[under]).tolist():
            # Of a facet that has its strength already, the group that gave it rules.
            if bears in name or name == material:
                continue
            own, above, other = _known(known, name), _known(known, material), f"{name}{bears}"
            weaker = {"friction": min(own.friction, above.friction), "cohesion": min(own.cohesion, above.cohesion)}
            known[other] = replace(own, name=other, **weaker)
            names = np.where(under & (names == name), other, names)
    return replace(shell, material=names), tuple(known.values())


def _known(known: Mapping[str, JointStrength], name: str) -> JointStrength:
    if name not in known:
        raise InputError("materials", "a material of the shell is not given", found=name, expected=", ".join(known))
    return known[name]
