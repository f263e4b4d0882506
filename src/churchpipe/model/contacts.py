"""Interfaces between stones and their contact points: geometry only."""

from dataclasses import dataclass

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arrays import FloatArray, IntArray, NameArray, floats, indices, names, pointers, rows_of, store
from churchpipe.model.assemblage import Assemblage

# A contact point lies in the box of both its stones, or beyond it by this share of their diagonals at most.
_SLACK = 0.05
KINDS = ("bed", "head", "radial", "junction", "base")


@dataclass(frozen=True, slots=True)
class Contacts:
    """Interfaces and their contact points.

    Fields: blocks (ni, 2), first and second stone; frame (ni, 3, 3), `frame_iac`: axis a (n, t1, t2) and component c
    (x, y, z) of interface i, n from the first stone to the second; area (ni,) m2; point (nc, 3) m, the vertices of each
    interface polygon; point_ptr (ni + 1,); kind (ni,) one of `KINDS`.

    Components at a contact are in the order n, t1, t2; forces act on the second stone; compression is positive.
    """

    blocks: IntArray
    frame: FloatArray
    area: FloatArray
    point: FloatArray
    point_ptr: IntArray
    kind: NameArray

    def __post_init__(self) -> None:
        ni, nc = rows_of("Contacts.blocks", self.blocks), rows_of("Contacts.point", self.point)
        store(
            self,
            blocks=indices("Contacts.blocks", self.blocks, (ni, 2)),
            frame=floats("Contacts.frame", self.frame, (ni, 3, 3)),
            area=floats("Contacts.area", self.area, (ni,)),
            point=floats("Contacts.point", self.point, (nc, 3)),
            point_ptr=pointers("Contacts.point_ptr", self.point_ptr, ni, nc),
            kind=names("Contacts.kind", self.kind, (ni,)),
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
