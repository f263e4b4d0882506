"""Interfaces between stones and their contact points: geometry only."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated, Any, Literal, get_args

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arguments import check_kind, finite
from churchpipe.model.arrays import (
    BoolArray,
    FloatArray,
    IntArray,
    NameArray,
    ReadOnly,
    floats,
    pointer_of,
    pointers,
    rows_of,
    store,
    store_arrays,
)
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.card import Shown
from churchpipe.model.pictures import picture
from churchpipe.model.quantities import Quantity, Usual

# A contact point lies in the box of both its stones, or beyond it by this share of their diagonals at most.
_SLACK = 0.05
# What joints are; "butt": a junction of two walls without mortar, so without cohesion.
ContactKind = Literal["bed", "head", "radial", "junction", "butt", "base"]
KINDS: tuple[ContactKind, ...] = get_args(ContactKind)
# Faces nearer than this, m, touch: so much is lost where coordinates are rounded to six decimals.
TOUCHING = 1e-6

TOLERANCES = ("contact_gap", "contact_angle", "overlap")
GAP = Quantity("_mm", 0.0, above=True, usual=Usual(1e-6, 50, "joints of mortar are some 10 wide, those of drawn stones below 1"))
OVERLAP = Quantity("_mm", 0.0, above=True, usual=Usual(1e-6, 50, "stones that are drawn or scanned overlap by some mm"))


@dataclass(frozen=True, slots=True)
class ContactTolerances:
    """What faces may be apart and still make a joint.

    Fields: contact_gap, how far two faces may be apart, m; contact_angle, how far they may be from parallel, rad; overlap, how
    deep two stones may lie in each other, m; given: the names of those that the person gave, the others were proposed.
    """

    contact_gap: Annotated[float, GAP] = TOUCHING
    contact_angle: float = 1e-5
    overlap: Annotated[float, OVERLAP] = TOUCHING
    given: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for name in TOLERANCES:
            if not (number := finite(f"ContactTolerances.{name}", getattr(self, name))) > 0:
                raise InputError(f"ContactTolerances.{name}", "out of range", found=number, expected="> 0")
        store(self, given=tuple(self.given))


def _no_pairs() -> IntArray:
    return np.zeros((0, 2), dtype=np.int64)


def _none(*shape: int) -> FloatArray:
    return np.zeros((0, *shape))


@dataclass(frozen=True, slots=True)
class NearMisses(ReadOnly):
    """Pairs of faces that face each other closely and are no joint.

    Fields: stones (n, 2); gap (n,) m, how far the faces are apart in the middle of what they share, negative where they
    interpenetrate; angle (n,) rad between them; area (n,) m2 of what they share; place (n, 3) m, its middle;
    normal (n, 3) from the first stone to the second.
    """

    stones: IntArray = field(default_factory=_no_pairs)
    gap: FloatArray = field(default_factory=_none)
    angle: FloatArray = field(default_factory=_none)
    area: FloatArray = field(default_factory=_none)
    place: FloatArray = field(default_factory=lambda: _none(3))
    normal: FloatArray = field(default_factory=lambda: _none(3))

    def __post_init__(self) -> None:
        n = rows_of("NearMisses.stones", self.stones)
        store_arrays(self, stones=(n, 2), gap=(n,), angle=(n,), area=(n,), place=(n, 3), normal=(n, 3))

    def __len__(self) -> int:
        return len(self.stones)


@dataclass(frozen=True, slots=True, repr=False)
class Contacts(Shown):
    """Interfaces and their contact points.

    Fields: blocks (ni, 2), first and second stone; frame (ni, 3, 3), `frame_iac`: axis a (n, t1, t2) and component c
    (x, y, z) of interface i, n from the first stone to the second; area (ni,) m2; point (nc, 3) m, the vertices of each
    interface polygon; point_ptr (ni + 1,); kind (ni,) one of `KINDS`; gap (ni, 2) m, the least and the greatest distance
    between the two faces over the interface, negative where the stones interpenetrate, and angle (ni,) rad between them:
    zero where left out; near_misses: faces that nearly meet; tolerances: with which all this was found.

    Components at a contact are in the order n, t1, t2; forces act on the second stone; compression is positive.
    """

    blocks: IntArray
    frame: FloatArray
    area: FloatArray
    point: FloatArray
    point_ptr: IntArray
    kind: NameArray
    gap: FloatArray = field(default_factory=lambda: _none(2))
    angle: FloatArray = field(default_factory=_none)
    near_misses: NearMisses = field(default_factory=NearMisses)
    tolerances: ContactTolerances = field(default_factory=ContactTolerances)

    def __post_init__(self) -> None:
        ni, nc = rows_of("Contacts.blocks", self.blocks), rows_of("Contacts.point", self.point)
        check_kind("Contacts.near_misses", self.near_misses, NearMisses)
        check_kind("Contacts.tolerances", self.tolerances, ContactTolerances)
        store_arrays(self, blocks=(ni, 2), frame=(ni, 3, 3), area=(ni,), point=(nc, 3), kind=(ni,))
        store(
            self,
            point_ptr=pointers("Contacts.point_ptr", self.point_ptr, ni, nc),
            gap=floats("Contacts.gap", self.gap if rows_of("Contacts.gap", self.gap) else np.zeros((ni, 2)), (ni, 2)),
            angle=floats("Contacts.angle", self.angle if rows_of("Contacts.angle", self.angle) else np.zeros(ni), (ni,)),
        )
        gram = np.einsum("iac,ibc->iab", self.frame, self.frame)
        if ni and np.abs(gram - np.eye(3)).max() > 1e-9:
            raise InputError(
                "Contacts.frame", "axes are not orthonormal", expected="rows n, t1, t2 of unit length at right angles"
            )
        unknown = np.setdiff1d(self.kind, KINDS)
        if len(unknown):
            raise InputError("Contacts.kind", "unknown kind of interface", found=str(unknown[0]), expected=", ".join(KINDS))

    @property
    def interface_of_point(self) -> IntArray:
        """Interface of each contact point (nc,)."""
        return np.repeat(np.arange(len(self.blocks), dtype=np.int64), np.diff(self.point_ptr))

    @property
    def points_per_interface(self) -> IntArray:
        """Number of contact points of each interface (ni,)."""
        return np.diff(self.point_ptr)

    def selected(self, keep: BoolArray) -> "Contacts":
        """Return the interfaces that are kept (ni,), with the near misses of all."""
        of_points, count = np.repeat(keep, self.points_per_interface), self.points_per_interface[keep]
        return replace(
            self,
            **{name: getattr(self, name)[keep] for name in ("blocks", "frame", "area", "kind", "gap", "angle")},
            point=self.point[of_points],
            point_ptr=pointer_of(count),
        )

    def show(self) -> Any:
        """Return a picture of the joints, coloured by kind (`churchpipe.show`)."""
        return picture(self)

    def _rows(self) -> tuple[str, Mapping[str, object]]:
        counts = {str(kind): int((self.kind == kind).sum()) for kind in KINDS}
        rows = {"interfaces": len(self.blocks), "contact points": len(self.point), **{kind: n for kind, n in counts.items() if n}}
        return "Contacts", {**rows, "near misses": len(self.near_misses)}


def check_contacts_of(stones: Assemblage, contacts: Contacts) -> None:
    """Raise InputError for contacts made for another assemblage: of stones that are not there, or at points beside them."""
    if not len(contacts.blocks):
        return
    if contacts.blocks.max() >= stones.count:
        raise InputError(
            "contacts", "made for another assemblage", found=int(contacts.blocks.max()), expected=f"< {stones.count}"
        )
    low, high = (edge.reduceat(stones.points, stones.block_point_ptr[:-1], axis=0) for edge in (np.minimum, np.maximum))
    slack = _SLACK * np.linalg.norm(high - low, axis=1)[:, None]
    pair = contacts.blocks[contacts.interface_of_point]
    beside = [(contacts.point < (low - slack)[stone]) | (contacts.point > (high + slack)[stone]) for stone in pair.T]
    bad = np.flatnonzero(np.any(beside, axis=(0, 2)))
    if len(bad):
        first, second = stones.block_id[pair[bad[0]]]
        raise InputError(
            "contacts",
            "made for another assemblage",
            found=f"a contact of {first} and {second} at {contacts.point[bad[0]].round(4).tolist()} m, beside one of them",
            remedy="Find the contacts of these stones.",
        )
