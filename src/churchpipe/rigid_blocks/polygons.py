"""The polygons of joints, by their corners in the plane of each."""

from dataclasses import dataclass

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.contacts import Contacts
from churchpipe.wording import counted

# A polygon encloses the area of its interface, but for this share of it; the hull of one that is not convex encloses more.
_SAME_AREA = 1e-3
# Four corners make a parallelogram if no side differs from the one opposite by more than this share of the joint's size.
_SAME_SHAPE = 1e-3


@dataclass(frozen=True, slots=True)
class JointPolygons:
    """Interfaces as convex polygons, their contact points as corners in order.

    interface (nc,) of each corner; start (ni,), the first corner of each interface; after, before (nc,), the neighbours of a
    corner; count (ni,) of corners; middle (ni, 3) m, their mean; corner (nc, 2) m from there along t1 and t2; area (ni,) m2,
    negative where the corners run clockwise.
    """

    interface: IntArray
    start: IntArray
    after: IntArray
    before: IntArray
    count: IntArray
    middle: FloatArray
    corner: FloatArray
    area: FloatArray


def joint_polygons(contacts: Contacts) -> JointPolygons:
    """Return the polygons of interfaces.

    Raises
    ------
    InputError: the points of an interface are not the corners of a polygon in order.
    """
    count = contacts.points_per_interface
    if len(count) and count.min() < 3:
        raise _no_polygon(int(np.argmin(count)), counted(int(count.min()), "point"), "3 or more")
    polygons = polygons_of(contacts)
    wrong = np.flatnonzero(~(np.abs(polygons.area) > (1 - _SAME_AREA) * contacts.area))
    if len(wrong):
        first = int(wrong[0])
        raise _no_polygon(first, f"they enclose {abs(polygons.area[first]):.6g} m2", f"{contacts.area[first]:.6g} m2")
    return polygons


def polygons_of(contacts: Contacts) -> JointPolygons:
    """Return the polygons whose corners are the contact points of interfaces, three or more of each, in order."""
    count, interface, start = contacts.points_per_interface, contacts.interface_of_point, contacts.point_ptr[:-1]
    after, before = np.arange(len(interface)) + 1, np.arange(len(interface)) - 1
    after[contacts.point_ptr[1:] - 1], before[start] = start, contacts.point_ptr[1:] - 1
    middle = summed(contacts.point, start) / count[:, None]
    corner = np.einsum("kac,kc->ka", contacts.frame[interface, 1:], contacts.point - middle[interface])
    area = summed(cross(corner, corner[after]), start) / 2.0
    return JointPolygons(interface, start, after, before, count, middle, corner, area)


def parallelograms(polygons: JointPolygons, area: FloatArray) -> BoolArray:
    """Return which polygons (ni,) are parallelograms that enclose the areas (ni,) of their interfaces, to `_SAME_SHAPE`."""
    out = (polygons.count == 4) & (np.abs(np.abs(polygons.area) - area) <= _SAME_SHAPE * area)
    corner = polygons.corner[polygons.start[out][:, None] + np.arange(4)]
    skew = np.abs(corner[:, 0] - corner[:, 1] + corner[:, 2] - corner[:, 3]).max(axis=1)
    out[out] = skew <= _SAME_SHAPE * np.sqrt(area[out])
    return out


def summed(values: FloatArray, start: IntArray) -> FloatArray:
    """Return the sums of values (nc, ...) over each polygon, the first rows of which are given (ni,)."""
    return np.add.reduceat(values, start) if len(start) else np.zeros((0, *values.shape[1:]))


def cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return a x b of vectors in the plane, components last."""
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def _no_polygon(interface: int, found: str, expected: str) -> InputError:
    return InputError(
        f"contacts: interface {interface}",
        "its points are not its corners in order",
        found=found,
        expected=expected,
        remedy='Find the contacts of these stones, or use contact_model="corners" and no compressive strength.',
    )
