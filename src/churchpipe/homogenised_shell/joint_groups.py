"""Joints with a strength of their own in the shell, where one strength stands for all joints of a facet."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arguments import check_kind, listed
from churchpipe.model.joint_group import JointGroup
from churchpipe.model.materials import JointStrength, by_name
from churchpipe.model.shell import ShellModel


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
        Of walls, between heights, or both; of two that pick a facet, the one listed later rules.

    Raises
    ------
    InputError
        A group of one kind of joints, or between walls: a facet has one strength for all its joints. No such facet.
    """
    check_kind("shell_joint_groups: shell", shell, ShellModel)
    known = by_name(listed("shell_joint_groups: materials", materials, JointStrength))
    names = shell.material.astype(np.str_)
    for group in listed("shell_joint_groups: groups", groups, JointGroup):
        where = f"joints {group.name}"
        if group.kind is not None or group.between is not None:
            found = group.kind or f"between {' and '.join(group.between or ())}"
            expected = "walls, above or below alone: the shell has one strength for all joints of a place"
            raise InputError(
                where, "not in the shell", found=found, expected=expected, remedy="Rigid blocks take them as they are."
            )
        z = shell.centroid[:, 2]
        chosen = np.isin(shell.panel, group.walls) if group.walls else np.ones(len(z), dtype=np.bool_)
        chosen &= (z > (-np.inf if group.above is None else group.above)) & (z < (np.inf if group.below is None else group.below))
        if not chosen.any():
            raise InputError(where, "no such facet", expected="walls and heights that the shell has")
        given = {key: value for key in ("friction", "cohesion") if (value := getattr(group, key)) is not None}
        for name in np.unique(names[chosen]).tolist():
            if name not in known:
                raise InputError("materials", "a material of the shell is not given", found=name, expected=", ".join(known))
            other = f"{name}, {group.name}"
            known[other] = replace(known[name], name=other, **given)
            names = np.where(chosen & (names == name), other, names)
    return replace(shell, material=names), tuple(known.values())
