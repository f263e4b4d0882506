"""Arms of friction that make a joint under uniform pressure resist torsion as it should."""

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.contacts import Contacts

# Corners in order enclose the area of their interface, but for this share of it.
_SAME_AREA = 1e-3


def friction_points(contacts: Contacts) -> FloatArray:
    """Return where the friction of each contact point acts (nc, 3) m: nearer to the centroid c of its interface than the point.

    It acts at c + xi (x_k - c), xi the mean distance of the interface's area from c over that of its corners: with friction
    at the corners themselves, a square resists 1.85 times the torque of uniform pressure.

    Raises
    ------
    InputError: the points of an interface are not the corners of a polygon in order.
    """
    if not len(contacts.blocks):
        return contacts.point
    count = contacts.points_per_interface[:, None]
    if count.min() < 3:
        raise _no_polygon(int(np.argmin(count)), f"{count.min()} points", "3 or more")
    interface, start = contacts.interface_of_point, contacts.point_ptr[:-1]
    middle = np.add.reduceat(contacts.point, start) / count
    axes = contacts.frame[:, 1:]
    corner = np.einsum("kac,kc->ka", axes[interface], contacts.point - middle[interface])
    after = np.arange(len(corner)) + 1
    after[contacts.point_ptr[1:] - 1] = start
    twice = _cross(corner, corner[after])
    area = np.add.reduceat(twice, start) / 2.0
    wrong = np.flatnonzero(~(np.abs(np.abs(area) - contacts.area) < _SAME_AREA * contacts.area))
    if len(wrong):
        first = int(wrong[0])
        raise _no_polygon(first, f"they enclose {abs(area[first]):.6g} m2", f"{contacts.area[first]:.6g} m2")
    centroid = np.add.reduceat((corner + corner[after]) * twice[:, None], start) / (6.0 * area[:, None])
    arm = corner - centroid[interface]
    distance = np.add.reduceat(np.hypot(*arm.T), start) / count[:, 0]
    shrinkage = mean_distance(arm, after, start) / distance
    toward = np.einsum("kac,ka->kc", axes[interface], arm)
    return np.asarray(contacts.point - (1.0 - shrinkage[interface])[:, None] * toward)


def mean_distance(corner: FloatArray, after: IntArray, start: IntArray) -> FloatArray:
    """Return the mean distance (ni,) from the origin of the areas of polygons with these corners (nc, 2).

    after (nc,): the next corner; start (ni,): the first of each polygon. An edge at distance h from the origin, between s_1
    and s_2 along it, spans a triangle with the origin in which the integral of the distance is
    [h s r + h^3 asinh(s / h)] / 6 from s_1 to s_2, r^2 = h^2 + s^2; triangles count with the sign of their turn.
    """
    edge = corner[after] - corner
    along = edge / np.maximum(np.hypot(*edge.T), 1e-300)[:, None]
    turn = _cross(corner, along)
    h = np.abs(turn)
    total = np.zeros(len(corner))
    for end, sign in ((corner[after], 1.0), (corner, -1.0)):
        s = (end * along).sum(axis=1)
        slope = np.divide(s, h, out=np.zeros_like(s), where=h > 0)
        total += sign * (h * s * np.hypot(h, s) + h**3 * np.arcsinh(slope))
    area = np.add.reduceat(_cross(corner, corner[after]), start) / 2.0
    return np.asarray(np.add.reduceat(np.sign(turn) * total, start) / (6.0 * area))


def _no_polygon(interface: int, found: str, expected: str) -> InputError:
    return InputError(
        f"contacts: interface {interface}",
        "its points are not its corners in order",
        found=found,
        expected=expected,
        remedy='Find the contacts of these stones, or use contact_model="corners".',
    )


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
