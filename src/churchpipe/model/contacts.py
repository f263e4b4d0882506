"""Interfaces between stones and their contact points: geometry only."""

from dataclasses import dataclass

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arrays import FloatArray, IntArray, NameArray, floats, indices, names, pointers, rows_of, store

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
