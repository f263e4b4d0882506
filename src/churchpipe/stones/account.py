"""Where the surface of the stones is in joints, nearly meets another stone or is free, and which tolerances decided that."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np

from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import TOUCHING, Contacts
from churchpipe.model.polyhedra import face_normals
from churchpipe.model.quantities import Quantity
from churchpipe.stones.contact_tolerances import thicknesses
from churchpipe.stones.counted_twice import counted_twice
from churchpipe.wording import counted

# How many stones, or pairs of stones, a message names.
NAMED = 8
TOO_WIDE = (
    "No contact gap joins faces farther apart than half the thickness of the thinner stone: grow the stones into their joints "
    "(--joint without --joint-mode keep), or draw them so that they meet."
)
# The tolerances of a case as options of the command line.
_OPTIONS = {
    "contact_gap_mm": "--contact-gap {:g}mm",
    "contact_angle_deg": "--contact-angle-deg {:g}",
    "overlap_mm": "--overlap {:g}mm",
}


@dataclass(frozen=True, slots=True)
class NearMiss:
    """Two stones that nearly meet: their names, how far apart (negative: how deep in each other) and turned, and where."""

    stones: tuple[str, ...]
    gap: Annotated[float, Quantity("_mm")]
    angle: Annotated[float, Quantity("_deg")]
    place: Annotated[tuple[float, ...], Quantity("_m")]


@dataclass(frozen=True, slots=True)
class NearMissAccount:
    """All near misses: least and greatest gap and angle, share of all area that meets or nearly meets, the largest ones, and the
    keys of [rigid] whose values would make joints of them."""

    count: int
    gap: Annotated[tuple[float, ...], Quantity("_mm")] = ()
    angle: Annotated[tuple[float, ...], Quantity("_deg")] = ()
    area_share: float = 0.0
    largest: tuple[NearMiss, ...] = ()
    joined_by: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Closed:
    """Joints that were closed across a gap."""

    count: int
    largest_gap: Annotated[float, Quantity("_mm")]


@dataclass(frozen=True, slots=True)
class Interpenetrating:
    """Joints of stones that lie in each other, and what counts twice in their weight, if that is worth a word: its volume and its
    share of that of the stones."""

    count: int
    deepest: Annotated[float, Quantity("_mm")]
    counted_twice: Annotated[float, Quantity("_m3")] = 0.0
    share: float = 0.0


@dataclass(frozen=True, slots=True)
class JointTolerances:
    """The tolerances that decided which faces meet, which of them the person gave, and which joints needed them."""

    contact_gap: Annotated[float, Quantity("_mm")]
    contact_angle: Annotated[float, Quantity("_deg")]
    overlap: Annotated[float, Quantity("_mm")]
    given: tuple[str, ...]
    closed: Closed
    interpenetrating: Interpenetrating


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


def joint_account(stones: Assemblage, contacts: Contacts) -> tuple[NearMissAccount, JointTolerances]:
    """Return what nearly meets, and what decided that the rest meets."""
    near, now = contacts.near_misses, contacts.tolerances
    widest, deepest = contacts.gap.max(axis=1, initial=0.0), (-contacts.gap).max(axis=1, initial=0.0)
    largest = np.argsort(-near.area, kind="stable")[:NAMED]
    found = NearMissAccount(0)
    near_enough = np.flatnonzero(_can_be_joined(stones, contacts)) if len(near) else np.zeros(0, dtype=np.int64)
    if len(near):
        found = NearMissAccount(
            len(near),
            (float(near.gap.min()), float(near.gap.max())),
            (float(near.angle.min()), float(near.angle.max())),
            near_miss_share(contacts),
            tuple(_near_miss(stones, contacts, row) for row in largest.tolist()),
            tolerances_that_join(contacts, near_enough) if len(near_enough) else {},
        )
    closed = Closed(int((widest > TOUCHING).sum()), float(widest.max(initial=0.0)))
    twice = counted_twice(stones, contacts)
    deep = Interpenetrating(
        int((deepest > TOUCHING).sum()),
        float(deepest.max(initial=0.0)),
        *((twice.volume, twice.share) if twice else ()),
    )
    return found, JointTolerances(now.contact_gap, now.contact_angle, now.overlap, tuple(now.given), closed, deep)


def joint_lines(near: NearMissAccount, now: JointTolerances, *, typed: bool = False) -> list[str]:
    """Return a `joint_account` as sentences. There are none for stones that fit exactly.

    typed: whether a tolerance is changed by an option of the command line, and not in a case.
    """
    closed, deep = now.closed, now.interpenetrating
    origin = "as asked for" if "contact_gap" in now.given else "proposed from the gaps of the stones"
    lines: list[str] = []
    if closed.count:
        lines.append(
            f"Joints closed across a gap: {closed.count}, up to {1e3 * closed.largest_gap:.3g} mm where widest; contact gap "
            f"{1e3 * now.contact_gap:.3g} mm, {origin}."
        )
    if deep.count:
        lines.append(
            f"Joints of stones that lie in each other: {deep.count}, up to {1e3 * deep.deepest:.3g} mm where deepest."
            + (f" {twice_words(deep.counted_twice, deep.share)}." if deep.counted_twice else "")
        )
    if near.count:
        named = "; ".join(near_miss_words(item) for item in near.largest[:3])
        low, high = (f"{1e3 * gap:.3g}" for gap in near.gap)
        remedy = _typed(near.joined_by) if typed else f"{_settings(near.joined_by)} in [rigid]"
        pairs = counted(near.count, "pair of faces nearly meets and is", "pairs of faces face each other and are")
        lines.append(
            f"Near misses: {pairs} no joint, {low} to {high} mm apart and up "
            f"to {math.degrees(near.angle[1]):.3g} degrees from parallel, {100 * near.area_share:.2g} % of all area that meets "
            f"or nearly meets. The largest: {named}. " + (f"{remedy} makes joints of them." if near.joined_by else TOO_WIDE)
        )
    return lines


def twice_words(volume: float, share: float) -> str:
    """Return what counts twice in the weight of stones as text: a volume, m3, and its share of that of the stones."""
    return f"What they share, {volume:.3g} m3 or {1e2 * share:.2g} % of the volume of the stones, counts twice in their weight"


def near_miss_words(item: NearMiss) -> str:
    """Return one near miss as text."""
    place = ", ".join(f"{x:.4g}" for x in item.place)
    return f"{' and '.join(item.stones)}, {1e3 * item.gap:.3g} mm and {math.degrees(item.angle):.3g} degrees, at ({place}) m"


def remedy_words(stones: Assemblage, contacts: Contacts, rows: IntArray) -> str:
    """Return as text, for an error, which faces nearly meet and which tolerances would join them."""
    near = contacts.near_misses
    order = rows[np.argsort(-near.area[rows], kind="stable")]
    named = "; ".join(near_miss_words(_near_miss(stones, contacts, row)) for row in order[:NAMED].tolist())
    more = f"; and {len(rows) - NAMED} more" if len(rows) > NAMED else ""
    words = f"Faces that nearly meet: {named}{more}. Close the gaps"
    near_enough = rows[_can_be_joined(stones, contacts)[rows]]
    if len(near_enough):
        wanted = tolerances_that_join(contacts, near_enough)
        words += (
            f", or join them with {_typed(wanted)} of check and import, {_settings(wanted)} in [rigid] of a case, "
            f"find_contacts(stones, {_arguments(wanted)}) in Python"
        )
    return words + "." + (f" {TOO_WIDE}" if len(near_enough) < len(rows) else "")


def _can_be_joined(stones: Assemblage, contacts: Contacts) -> BoolArray:
    """Return which near misses (n,) a tolerance can make joints of: none joins stones farther apart than half their thickness."""
    near = contacts.near_misses
    return np.abs(near.gap) <= 0.5 * thicknesses(stones)[near.stones].min(axis=1) + TOUCHING


def _near_miss(stones: Assemblage, contacts: Contacts, row: int) -> NearMiss:
    near = contacts.near_misses
    names = tuple(str(stones.block_id[stone]) for stone in near.stones[row])
    return NearMiss(names, float(near.gap[row]), float(near.angle[row]), tuple(near.place[row].tolist()))


def _arguments(wanted: Mapping[str, float]) -> str:
    """Return tolerances of a case as arguments in Python, which are in m and rad."""
    in_si = {"_mm": 1e-3, "_deg": math.pi / 180.0}
    split = ((name, f"_{unit}", value) for key, value in wanted.items() for name, _, unit in [key.rpartition("_")])
    return ", ".join(f"{name}={value * in_si[unit]:.4g}" for name, unit, value in split)


def _typed(wanted: Mapping[str, float]) -> str:
    return " ".join(_OPTIONS[key].format(value) for key, value in wanted.items())


def _settings(wanted: Mapping[str, float]) -> str:
    return ", ".join(f"{key} = {value:g}" for key, value in wanted.items())


def _above(value: float) -> float:
    """Return a value rounded up to two digits. An excess as small as rounding is not rounded up."""
    step = 10.0 ** (math.floor(math.log10(max(value, 1e-6))) - 1)
    return float(f"{math.ceil(value / step - 1e-6) * step:.6g}")
