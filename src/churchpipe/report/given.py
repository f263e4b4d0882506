"""Paths of the stones obtained in Python, with the records that the report reads: capacity curves and supports that move."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any, cast

import numpy as np

from churchpipe.code_check import NO_PUSH, Site
from churchpipe.errors import InputError
from churchpipe.halved_steps import careful_check
from churchpipe.io.movement_record import Shift, Turn, movement_record, widest_cracks
from churchpipe.io.recording import curve_record_of, halved_record
from churchpipe.large_displacements.cracks import path_cracks
from churchpipe.model.arguments import check_kind, describe
from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage, checked_sequence
from churchpipe.model.block_curve import BlockCapacityCurve
from churchpipe.model.checks import DisplacementCheck
from churchpipe.model.contacts import Contacts, check_contacts_of
from churchpipe.model.digests import differing, of_load
from churchpipe.model.joint_group import JointGroup
from churchpipe.model.loads import LoadCase, direction_name
from churchpipe.model.materials import JointStrength
from churchpipe.model.placed_loads import Applied
from churchpipe.model.settlement import SettlementPath
from churchpipe.report.of_stones import check_loads_in
from churchpipe.report.paths import Followed
from churchpipe.wording import counted

Curve = BlockCapacityCurve | tuple[LoadCase, BlockCapacityCurve] | tuple[LoadCase, BlockCapacityCurve, BlockCapacityCurve]
Curves = Curve | Iterable[Curve]
Settled = SettlementPath | tuple[Assemblage, Contacts, SettlementPath]
Settlements = Settled | Mapping[str, Settled]

_CURVE, _SETTLEMENT = "write_report: curve", "write_report: settlement"
NOT_TOLD = "the load pushes more than the weight of the stones: give what the stones carry as loads="


def crushing(materials: Sequence[JointStrength]) -> bool:
    """Return whether all materials crush."""
    return bool(materials) and all(one.compressive_strength is not None for one in materials)


def unchecked(load: LoadCase, applied: Applied) -> str:
    """Return why a load case can have no check: it pushes no weight, or masses in its `live` that are not among what the stones
    carry; "" where it can."""
    if not load.direction.any():
        return NO_PUSH
    return "" if load.live is None or applied.loads.mass.any() else NOT_TOLD


def curves_given(
    curve: Curves,
    results: Sequence[LoadCase],
    stones: Assemblage,
    materials: Sequence[JointStrength],
    groups: Sequence[JointGroup],
    applied: Applied,
    site: Site | None,
) -> list[Followed]:
    """Return the capacity curves of the stones with their records and checks; results: the loads of the other results.

    Raises
    ------
    InputError: no curves, curves of other stones or of another load, a curve without its load, a pair of unlike curves.
    """
    out: list[Followed] = []
    for number, (load, one, halved) in enumerate(_with_loads(curve, results), 1):
        for path in (one, *([halved] if halved else [])):
            path.check_of(_CURVE, stones)
            _check_made_with(path, load, one)
        check_loads_in(f"{_CURVE}[{number - 1}]", load, stones, applied.loads)
        record = curve_record_of(one, stones, load, materials, groups)
        check = DisplacementCheck(message=unchecked(load, applied))
        if not check.message:
            check = careful_check(one, halved, stones, load, site, applied, crushing=crushing(materials))
        more = halved_record(one, halved) if halved else None
        known = record.status in ("converged", "not-converged")
        # Also the name of a file.
        out.append((replace(record, name=f"curve{number}", **({"check": check, "halved": more} if known else {})), one))
    return out


def _with_loads(
    curve: Curves, results: Sequence[LoadCase]
) -> Iterable[tuple[LoadCase, BlockCapacityCurve, BlockCapacityCurve | None]]:
    """Yield load and curve of each that is given, and the curve with steps half as long, if there is one."""
    if isinstance(curve, BlockCapacityCurve):
        loads = {(load.name, *load.direction.tolist(), load.panels, load.profile): load for load in results}
        if len(loads) != 1:
            expected = "results of one load, which is then that of the curve"
            remedy = "Give the curve with its load: curve=[(load, curve)]."
            raise InputError(_CURVE, "its load is not known", found=counted(len(loads), "load"), expected=expected, remedy=remedy)
        yield next(iter(loads.values())), curve, None
        return
    kinds = "a BlockCapacityCurve, or a list of pairs of a load case and one"
    if isinstance(curve, str) or not isinstance(curve, Iterable):
        raise InputError(_CURVE, "wrong kind", found=describe(curve), expected=kinds)
    if isinstance(curve, tuple) and curve and isinstance(curve[0], LoadCase):
        curve = [cast("Curve", curve)]
    for number, entry in enumerate(checked_sequence(_CURVE, curve, kinds)):
        where = f"{_CURVE}[{number}]"
        check_kind(where, entry, tuple, list)
        if len(entry) not in (2, 3):
            found, expected = counted(len(entry), "entry", "entries"), "a load case and its curve"
            raise InputError(where, "not a pair", found=found, expected=expected)
        check_kind(where, entry[0], LoadCase)
        for one in entry[1:]:
            check_kind(where, one, BlockCapacityCurve)
        yield entry[0], entry[1], entry[2] if len(entry) == 3 else None


def movements_given(
    settlement: Settlements,
    stones: Assemblage,
    contacts: Contacts,
    materials: Sequence[JointStrength],
    groups: Sequence[JointGroup],
    applied: Applied,
) -> list[tuple[Shift | Turn, Assemblage, Contacts, SettlementPath]]:
    """Return the paths of supports with their records, stones and joints; those without stones are of the report's.

    Raises
    ------
    InputError: no paths, paths of other stones.
    """
    named: Mapping[Any, Any] = settlement if isinstance(settlement, Mapping) else {"": settlement}
    out: list[tuple[Shift | Turn, Assemblage, Contacts, SettlementPath]] = []
    for name, one in named.items():
        where = f"{_SETTLEMENT} {name}" if name else _SETTLEMENT
        parts: tuple[Any, ...] = cast("tuple[Any, ...]", one) if isinstance(one, tuple) else (stones, contacts, one)
        if len(parts) != 3:
            raise InputError(
                where, "no path", found=counted(len(parts), "entry", "entries"), expected="stones, contacts and path"
            )
        own, joints, path = parts
        check_kind(where, path, SettlementPath)
        check_kind(where, own, Assemblage)
        check_kind(where, joints, Contacts)
        check_contacts_of(own, joints)
        path.check_of(where, own)
        direction, turns = _support_motion(own, path)
        way = f"support that {'turns about' if turns else 'moves along'} {direction_name(direction)}" if direction.any() else ""
        settings = {
            "name": str(name) or way or "support",
            "direction": direction.tolist(),
            "about": () if turns else None,
            "without_ties": bool(applied.ties),
        }
        cracks = [] if not len(path.movement) else _cracks(own, joints, path)
        record = movement_record(path, settings, own, materials, cracks, groups)
        out.append((replace(record, name=settings["name"]), own, joints, path))
    return out


def _cracks(stones: Assemblage, contacts: Contacts, path: SettlementPath) -> list[Any]:
    return widest_cracks(stones, contacts, *path_cracks(stones, contacts, path, -1))


def _support_motion(stones: Assemblage, path: SettlementPath) -> tuple[FloatArray, bool]:
    """Return the unit vector (3,) along or about which the support moves, zeros where it does not, and whether it turns: fixed
    stones move with the support alone."""
    if len(path.movement) < 2:
        return np.zeros(3), False
    shift, turn = (part[-1, stones.fixed] - part[0, stones.fixed] for part in (path.position, path.rotation))
    turns = bool(turn.any())
    moved = turn if turns else shift
    furthest = moved[int(np.argmax(np.linalg.norm(moved, axis=1)))]
    length = float(np.linalg.norm(furthest))
    return (furthest / length if length > 0 else np.zeros(3)), turns


def _check_made_with(path: BlockCapacityCurve, load: LoadCase, beside: BlockCapacityCurve) -> None:
    """Raise InputError where a curve is known to be of another load than the one given with it, or of other joints than the curve
    that it stands beside."""
    if not of_load(path.given, load):
        expected = "the load case that its block_pushover was called with"
        remedy = "Give each curve with its own load: curve=[(load, curve)]."
        raise InputError(_CURVE, "a curve of another load", found=f"a pair with {load.name}", expected=expected, remedy=remedy)
    if differ := differing(beside.given, path.given):
        problem = "two curves of one entry that were made with other values"
        remedy = "The second one is the same call with halved=True."
        raise InputError(_CURVE, problem, found=f"another {', '.join(differ)}", remedy=remedy)
