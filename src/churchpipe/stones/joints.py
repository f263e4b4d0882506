"""Strength of the joints from the materials of the stones that meet there."""

from collections.abc import Sequence

import numpy as np

from churchpipe.errors import InputError
from churchpipe.geometry.walls import named_walls
from churchpipe.model.arguments import check_kind, listed
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts, check_contacts_of
from churchpipe.model.joint_group import JointGroup
from churchpipe.model.materials import JointStrength, by_name

# Stones whose boxes are this far apart have no joint, m.
_APART = 0.05


def joint_strength(
    stones: Assemblage, contacts: Contacts, materials: Sequence[JointStrength], groups: Sequence[JointGroup] = ()
) -> tuple[FloatArray, FloatArray]:
    """Return friction coefficient (ni,) and cohesion (ni,) Pa of each interface.

    Where two materials meet the weaker one rules; on the ground that of the stone. Butt joints have no cohesion.

    Parameters
    ----------
    stones
        The assemblage.
    contacts
        Its joints, from `find_contacts`.
    materials
        Strength of the joints of each masonry, by name.
    groups
        Joints with a strength of their own; of two that pick a joint, the one listed later rules.

    Raises
    ------
    InputError
        Arguments of the wrong kind; a stone of a material that is not among `materials`, or one that is there twice; a group of
        walls that are not there, or of no joint.
    """
    row, used = _materials_of(stones, contacts, materials)
    out: list[FloatArray] = []
    for values in ([one.friction for one in used], [one.cohesion for one in used]):
        weaker = _weaker(stones, contacts, row, values)
        # Ground on ground carries nothing that matters, but must be a number.
        out.append(np.where(np.isfinite(weaker), weaker, 0.0))
    friction, cohesion = out[0], np.where(contacts.kind == "butt", 0.0, out[1])
    for group in listed("joint_strength: groups", groups, JointGroup):
        chosen = joints_of(stones, contacts, group)
        if group.friction is not None:
            friction = np.where(chosen, group.friction, friction)
        if group.cohesion is not None:
            cohesion = np.where(chosen, group.cohesion, cohesion)
    return friction, cohesion


def joints_of(stones: Assemblage, contacts: Contacts, group: JointGroup) -> BoolArray:
    """Return which interfaces (ni,) a group picks.

    Raises
    ------
    InputError: walls that are not there, no such joint.
    """
    free = stones.panel[~stones.fixed]
    for name in group.named:
        if not name or name not in free:
            raise InputError(f"joints {group.name}", "no such wall", found=name, expected=named_walls(free))
    panels, held = stones.panel[contacts.blocks], stones.fixed[contacts.blocks]
    chosen = np.ones(len(contacts.blocks), dtype=np.bool_)
    if group.kind is not None:
        chosen &= contacts.kind == group.kind
    if group.walls:
        chosen &= (held | np.isin(panels, group.walls)).all(axis=1) & ~held.all(axis=1)
    if group.between is not None:
        chosen &= np.isin(panels, group.between).all(axis=1) & (panels[:, 0] != panels[:, 1])
    z = np.add.reduceat(contacts.point[:, 2], contacts.point_ptr[:-1]) / contacts.points_per_interface
    if group.above is not None:
        chosen &= z > group.above
    if group.below is not None:
        chosen &= z < group.below
    if not chosen.any():
        raise InputError(f"joints {group.name}", "no such joint", expected="kind, walls and heights that some joint has")
    return chosen


def check_group(stones: Assemblage, group: JointGroup) -> None:
    """Raise InputError for joints that no stones could have: of walls that stand apart, at heights without stones.

    It looks at the boxes of the stones alone, before joints are sought.
    """
    low, high = (edge.reduceat(stones.points, stones.block_point_ptr[:-1], axis=0) for edge in (np.minimum, np.maximum))
    free = ~stones.fixed
    tallest = float(high[free, 2].max())
    if (group.above or -np.inf) >= tallest or (np.inf if group.below is None else group.below) < float(low[free, 2].min()):
        found = " ".join(f"{key} {value:g} m" for key in ("above", "below") if (value := getattr(group, key)) is not None)
        raise InputError(f"joints {group.name}", "no stones there", found=found, expected=f"heights up to {tallest:.6g} m")
    if group.between is None:
        return
    first, second = (np.flatnonzero(free & (stones.panel == name)) for name in group.between)
    for stone in first.tolist():
        apart = np.maximum(low[second] - high[stone], low[stone] - high[second]).max(axis=1)
        if (apart < _APART).any():
            return
    found = " and ".join(group.between)
    raise InputError(f"joints {group.name}", "walls that do not meet", found=found, expected="two walls with joints between them")


def crushing_strength(stones: Assemblage, contacts: Contacts, materials: Sequence[JointStrength]) -> FloatArray | None:
    """Return the compressive strength (ni,) Pa of each interface, infinite where it does not crush; None where none does.

    Where two materials meet the weaker one rules; on the ground that of the stone. Arguments and errors as of `joint_strength`.
    """
    row, used = _materials_of(stones, contacts, materials)
    values = [np.inf if one.compressive_strength is None else one.compressive_strength for one in used]
    return _weaker(stones, contacts, row, values) if np.isfinite(values).any() else None


def _materials_of(
    stones: Assemblage, contacts: Contacts, materials: Sequence[JointStrength]
) -> tuple[IntArray, list[JointStrength]]:
    """Return which material each stone (nb,) has, supports any, of the materials that are used."""
    check_kind("joint_strength: stones", stones, Assemblage)
    check_kind("joint_strength: contacts", contacts, Contacts)
    check_contacts_of(stones, contacts)
    used = np.unique(stones.material[~stones.fixed])
    if not len(used):
        raise InputError("joint_strength: stones", "every stone is fixed", expected="at least one free stone")
    known = by_name(listed("joint_strength: materials", materials, JointStrength))
    unknown = [str(name) for name in used if name not in known]
    if unknown:
        raise InputError(
            "materials",
            "stones of an unknown material",
            found=", ".join(unknown),
            expected=", ".join(known),
            remedy=f"Add [material.{unknown[0]}] to the case.",
        )
    row = np.searchsorted(used, stones.material).clip(max=len(used) - 1)
    return row, [known[str(name)] for name in used]


def _weaker(stones: Assemblage, contacts: Contacts, row: IntArray, values: Sequence[float]) -> FloatArray:
    """Return the lesser value (ni,) of the two stones of each interface; supports have none."""
    return np.where(stones.fixed, np.inf, np.array(values)[row])[contacts.blocks].min(axis=1)
