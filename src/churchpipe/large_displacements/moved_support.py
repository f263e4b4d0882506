"""A support of a case that moves: cut out of the ground, followed, and the cracks at its end."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np

from churchpipe.errors import InputError
from churchpipe.large_displacements.cracks import path_cracks
from churchpipe.large_displacements.settlement_path import settlement_path
from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.model.joint_group import JointGroup
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import JointStrength
from churchpipe.model.names import CONTACT_MODEL
from churchpipe.model.progress import Progress
from churchpipe.model.settlement import SettlementPath
from churchpipe.stones.contacts import find_contacts
from churchpipe.stones.footing import Rectangle, footing
from churchpipe.stones.joints import crushing_strength, joint_strength


@dataclass(frozen=True, slots=True)
class MovedSupport:
    """Stones with their ground cut, their joints (ni), the path, and opening and slip (ni,) m of the joints at its end."""

    stones: Assemblage
    contacts: Contacts
    path: SettlementPath
    opening: FloatArray
    slip: FloatArray


def moved_support(
    stones: Assemblage,
    contacts: Contacts,
    settings: Mapping[str, Any],
    materials: Sequence[JointStrength],
    tolerances: Mapping[str, Any],
    dead_on: Callable[[Assemblage], LoadCase | None],
    progress: Progress | None = None,
    groups: Sequence[JointGroup] = (),
    resume: SettlementPath | None = None,
    keep: Callable[[SettlementPath], None] | None = None,
) -> MovedSupport:
    """Return what a movement of a case does; settings: the fields of its `MovementSettings`, and the solver; dead_on: a
    load case with what the building carries, on the stones with their ground cut; groups: joints with a strength of their
    own; resume, keep: as in `settlement_path`.

    Raises
    ------
    InputError: a support that is not there, or that cannot be cut out of the ground, by the name of the movement.
    """
    place: str | Rectangle = settings["support"] or cast(Rectangle, settings["within"])
    try:
        foot = footing(stones, contacts, place)
        joints = find_contacts(foot.stones, **tolerances) if foot.cut else contacts
        friction, _ = joint_strength(foot.stones, joints, materials, groups)
        path = settlement_path(
            foot.stones,
            joints,
            foot.support,
            friction=friction,
            dead=dead_on(foot.stones),
            furthest=settings["furthest"] if settings["about"] is None else settings["furthest_angle"],
            compressive_strength=crushing_strength(foot.stones, joints, materials),
            contact_model=settings.get("contact_model", CONTACT_MODEL),
            **{key: settings[key] for key in ("direction", "about", "step", "steps", "halo", "solver")},
            progress=progress,
            resume=resume,
            keep=keep,
        )
    except InputError as error:
        raise error.at(f"movements, {settings['name']}: {error.where}") from error
    shut = np.zeros(len(joints.blocks))
    cracks = path_cracks(foot.stones, joints, path, -1) if len(path.movement) else (shut, shut)
    return MovedSupport(foot.stones, joints, path, *cracks)
