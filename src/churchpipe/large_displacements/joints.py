"""Contact points that travel with their stones, and how far each is open."""

from dataclasses import dataclass, fields

import numpy as np

from churchpipe.large_displacements.poses import Poses
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray, NameArray, pointer_of
from churchpipe.model.contacts import Contacts


@dataclass(frozen=True, slots=True)
class Joints:
    """Interfaces (ni) whose contact points (nc) are material points of both stones.

    blocks (ni, 2); frame (ni, 3, 3), rows n, t1, t2 in the axes of the first stone; area (ni,) m2; kind (ni,); point_ptr
    (ni + 1,); first, second (nc, 3) m, the point of either stone, an arm from its centroid in its axes. sliding (nc,): mu times
    the slip rate of the last step, see `solve_state`. rest (nc,) m: the gap as drawn, which counts as closed. place (nc, 2),
    rectangle and margin (ni,): as in `Touching`, of joints that crush. lever (nc, 3) m: where friction acts beside the point.
    pressing (nc,): the normal force of the last step over the weight; shear (nc, 3): its shear force, in the axes of the drawing.
    """

    blocks: IntArray
    frame: FloatArray
    area: FloatArray
    kind: NameArray
    point_ptr: IntArray
    first: FloatArray
    second: FloatArray
    sliding: FloatArray
    rest: FloatArray
    place: FloatArray
    rectangle: FloatArray
    margin: FloatArray
    lever: FloatArray
    pressing: FloatArray
    shear: FloatArray

    @property
    def pair(self) -> IntArray:
        """The two stones of each point (nc, 2)."""
        return self.blocks[self.interface]

    @property
    def interface(self) -> IntArray:
        """The interface of each point (nc,)."""
        return np.repeat(np.arange(len(self.blocks), dtype=np.int64), np.diff(self.point_ptr))

    def at(self, poses: Poses) -> tuple[Contacts, FloatArray]:
        """Return the contacts at these poses and the gap (nc,) m of each point, negative where stones overlap.

        Forces act at the point of the second stone and the normal turns with the first: so the balance's transpose gives the
        rates of these gaps exactly, however far they are open.
        """
        first, second = self.pair.T
        frame = np.einsum("kai,kji->kaj", self.frame, poses.rotation[self.blocks[:, 0]])
        near, far = poses.place(first, self.first), poses.place(second, self.second)
        gap = np.einsum("ki,ki->k", frame[self.interface, 0], far - near) - self.rest - self.margin[self.interface]
        return Contacts(self.blocks, frame, self.area, far, self.point_ptr, self.kind), gap

    def selected(self, keep: BoolArray) -> "Joints":
        """Return the interfaces that are kept (ni,)."""
        count = np.diff(self.point_ptr)
        kept = {len(keep): keep, len(self.sliding): np.repeat(keep, count)}
        values = {item.name: getattr(self, item.name) for item in fields(self) if item.name != "point_ptr"}
        return Joints(point_ptr=pointer_of(count[keep]), **{name: v[kept[len(v)]] for name, v in values.items()})


def joined(one: Joints, other: Joints) -> Joints:
    """Return the interfaces of both, those of the first before those of the other."""
    merged = {
        item.name: np.concatenate([getattr(one, item.name), getattr(other, item.name)])
        for item in fields(Joints)
        if item.name != "point_ptr"
    }
    return Joints(point_ptr=np.concatenate([one.point_ptr, one.point_ptr[-1] + other.point_ptr[1:]]), **merged)


def joints_of(
    contacts: Contacts,
    poses: Poses,
    gap: FloatArray | None = None,
    place: FloatArray | None = None,
    rectangle: FloatArray | None = None,
    margin: FloatArray | None = None,
) -> Joints:
    """Return the joints of contacts found at these poses.

    gap (nc,) m: how far each point is open; the contact's point is that of the second stone. place, rectangle, margin: of joints
    that crush, as in `Touching`.
    """
    count = len(contacts.blocks)
    first, second = contacts.blocks[contacts.interface_of_point].T
    n = contacts.frame[contacts.interface_of_point, 0]
    open_by = np.zeros(len(contacts.point)) if gap is None else gap
    return Joints(
        blocks=contacts.blocks,
        frame=np.einsum("kaj,kji->kai", contacts.frame, poses.rotation[contacts.blocks[:, 0]]),
        area=contacts.area,
        kind=contacts.kind,
        point_ptr=contacts.point_ptr,
        first=poses.arm(first, contacts.point - open_by[:, None] * n),
        second=poses.arm(second, contacts.point),
        sliding=np.zeros(len(contacts.point)),
        rest=np.zeros(len(contacts.point)),
        place=np.zeros((len(contacts.point), 2)) if place is None else place,
        rectangle=np.zeros(count) if rectangle is None else rectangle,
        margin=np.zeros(count) if margin is None else margin,
        lever=np.zeros((len(contacts.point), 3)),
        pressing=np.zeros(len(contacts.point)),
        shear=np.zeros((len(contacts.point), 3)),
    )
