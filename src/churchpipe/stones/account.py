"""Where the surface of the stones is in joints, nearly meets another stone or is free, and which tolerances decided that."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import TOUCHING, Contacts
from churchpipe.model.polyhedra import face_normals

# How many stones, or pairs of stones, a message names.
NAMED = 8
# The tolerances of a case as options of the command line.
_OPTIONS = {
    "contact_gap_mm": "--contact-gap {:g}mm",
    "contact_angle_deg": "--contact-angle-deg {:g}",
    "overlap_mm": "--overlap {:g}mm",
}


@dataclass(frozen=True, slots=True)
class SurfaceAccount:
    """The surface of each stone (nb,) m2: the total, the part in joints, and the part that nearly meets another stone."""

    surface: FloatArray
    joint: FloatArray
    near_miss: FloatArray

    @property
    def free(self) -> FloatArray:
        """The surface that faces no other stone (nb,) m2; negative where joints were counted twice."""
        return self.surface - self.joint - self.near_miss


def surface_account(stones: Assemblage, contacts: Contacts) -> SurfaceAccount:
    """Return how much of each stone's surface is in joints, nearly meets another stone, and is free."""
    vector, _, _ = face_normals(stones.points, stones.face_nodes, stones.face_ptr)
    owner = np.repeat(np.arange(stones.count), np.diff(stones.block_face_ptr))
    near = contacts.near_misses

    def per_stone(pairs: IntArray, area: FloatArray) -> FloatArray:
        return np.bincount(pairs.ravel(), np.repeat(area, 2), minlength=stones.count).astype(np.float64)

    surface = np.bincount(owner, np.linalg.norm(vector, axis=1), minlength=stones.count)
    return SurfaceAccount(
        surface.astype(np.float64), per_stone(contacts.blocks, contacts.area), per_stone(near.stones, near.area)
    )


def near_miss_share(contacts: Contacts) -> float:
    """Return the area of the near misses over that of near misses and joints together."""
    near = float(contacts.near_misses.area.sum())
    return near / (near + float(contacts.area.sum())) if near else 0.0


def tolerances_that_join(contacts: Contacts, rows: IntArray) -> dict[str, float]:
    """Return the values of contact_gap_mm, contact_angle_deg and overlap_mm that would make joints of some near misses.

    The gap is always among them, the others only where they must change.
    """
    near, now = contacts.near_misses, contacts.tolerances
    gap, angle, deep = near.gap[rows].max(initial=0.0), near.angle[rows].max(initial=0.0), -near.gap[rows].min(initial=0.0)
    # A gap that is given is compared with the least distance of two faces, a proposed one with the greatest distance too.
    wanted = {"contact_gap_mm": 1e3 * max(gap, now.contact_gap)}
    wanted |= {"contact_angle_deg": math.degrees(angle)} if angle > now.contact_angle else {}
    wanted |= {"overlap_mm": 1e3 * deep} if deep > now.overlap else {}
    return {key: _above(value) for key, value in wanted.items()}


def joints_record(stones: Assemblage, contacts: Contacts) -> dict[str, Any]:
    """Return the surfaces, near misses and tolerances under the keys of summary.json."""
    near, now = contacts.near_misses, contacts.tolerances
    widest, deepest = contacts.gap.max(axis=1, initial=0.0), (-contacts.gap).max(axis=1, initial=0.0)
    largest = np.argsort(-near.area, kind="stable")[:NAMED]
    near_record: dict[str, Any] = {"count": len(near)}
    if len(near):
        near_record |= {
            "gap_mm": [_figure(1e3 * float(near.gap.min())), _figure(1e3 * float(near.gap.max()))],
            "angle_deg": [_figure(math.degrees(float(edge))) for edge in (near.angle.min(), near.angle.max())],
            "area_share": _figure(near_miss_share(contacts)),
            "largest": [_near_miss(stones, contacts, row) for row in largest.tolist()],
            "joined_by": tolerances_that_join(contacts, np.arange(len(near))),
        }
    joints = {
        "contact_gap_mm": _figure(1e3 * now.contact_gap),
        "contact_angle_deg": _figure(math.degrees(now.contact_angle)),
        "overlap_mm": _figure(1e3 * now.overlap),
        "given": list(now.given),
        "closed": {"count": int((widest > TOUCHING).sum()), "largest_gap_mm": _figure(1e3 * float(widest.max(initial=0.0)))},
        "interpenetrating": {
            "count": int((deepest > TOUCHING).sum()),
            "deepest_mm": _figure(1e3 * float(deepest.max(initial=0.0))),
        },
    }
    return {"near_misses": near_record, "joints": joints}


def joints_lines(record: Mapping[str, Any]) -> list[str]:
    """Return a `joints_record` as sentences. There are none for stones that fit exactly."""
    now, near = record["joints"], record["near_misses"]
    closed, deep = now["closed"], now["interpenetrating"]
    origin = "as asked for" if "contact_gap" in now["given"] else "proposed from the gaps of the stones"
    lines: list[str] = []
    if closed["count"]:
        lines.append(
            f"Joints closed across a gap: {closed['count']}, up to {closed['largest_gap_mm']:g} mm where widest; contact gap "
            f"{now['contact_gap_mm']:g} mm, {origin}."
        )
    if deep["count"]:
        lines.append(f"Joints of stones that lie in each other: {deep['count']}, up to {deep['deepest_mm']:g} mm where deepest.")
    if near["count"]:
        named = "; ".join(near_miss_words(item) for item in near["largest"][:3])
        low, high = near["gap_mm"]
        lines.append(
            f"Near misses: {near['count']} pairs of faces face each other and are no joint, {low:g} to {high:g} mm apart and up "
            f"to {near['angle_deg'][1]:g} degrees from parallel, {100 * near['area_share']:.2g} % of all area that meets or "
            f"nearly meets. The largest: {named}. {_settings(near['joined_by'])} in [rigid] makes joints of them."
        )
    return lines


def near_miss_words(item: Mapping[str, Any]) -> str:
    """Return one near miss of a record as text."""
    first, second = item["stones"]
    place = ", ".join(f"{x:g}" for x in item["place_m"])
    return f"{first} and {second}, {item['gap_mm']:g} mm and {item['angle_deg']:g} degrees, at ({place}) m"


def remedy_words(stones: Assemblage, contacts: Contacts, rows: IntArray) -> str:
    """Return as text, for an error, which faces nearly meet and which tolerances would join them."""
    near = contacts.near_misses
    order = rows[np.argsort(-near.area[rows], kind="stable")]
    named = "; ".join(near_miss_words(_near_miss(stones, contacts, row)) for row in order[:NAMED].tolist())
    more = f"; and {len(rows) - NAMED} more" if len(rows) > NAMED else ""
    wanted = tolerances_that_join(contacts, rows)
    typed = " ".join(_OPTIONS[key].format(value) for key, value in wanted.items())
    return (
        f"Faces that nearly meet: {named}{more}. Close the gaps, or join them with {typed} of check and import, "
        f"{_settings(wanted)} in [rigid] of a case."
    )


def _near_miss(stones: Assemblage, contacts: Contacts, row: int) -> dict[str, Any]:
    near = contacts.near_misses
    return {
        "stones": [str(stones.block_id[stone]) for stone in near.stones[row]],
        "gap_mm": _figure(1e3 * float(near.gap[row])),
        "angle_deg": _figure(math.degrees(float(near.angle[row]))),
        "place_m": [_figure(float(x), 4) for x in near.place[row]],
    }


def _settings(wanted: Mapping[str, float]) -> str:
    return ", ".join(f"{key} = {value:g}" for key, value in wanted.items())


def _figure(value: float, digits: int = 3) -> float:
    return float(f"{value:.{digits}g}")


def _above(value: float) -> float:
    """Return a value rounded up to two digits. An excess as small as rounding is not rounded up."""
    step = 10.0 ** (math.floor(math.log10(max(value, 1e-6))) - 1)
    return _figure(math.ceil(value / step - 1e-6) * step, 6)
