"""Arms of friction that make a joint under uniform pressure resist torsion as it should."""

import numpy as np

from churchpipe.geometry.polygons import symmetric_parts
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.contacts import Contacts
from churchpipe.rigid_blocks.polygons import JointPolygons, cross, joint_polygons, summed

# A joint with less than this share of the largest force on one bears none.
_LOADED = 1e-9
# Iterations for a geometric median. The mean distance from it is stationary there, so that it needs few.
_WEISZFELD = 50
# The centre of pressure is taken so far inside, as a share of its distance from the centroid.
_INSIDE = 1e-3


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
    polygons = joint_polygons(contacts)
    arm = polygons.corner - _centroids(polygons)[polygons.interface]
    distance = summed(np.hypot(*arm.T), polygons.start) / polygons.count
    shrinkage = mean_distance(arm, polygons.after, polygons.start) / distance
    toward = np.einsum("kac,ka->kc", contacts.frame[polygons.interface, 1:], arm)
    return np.asarray(contacts.point - (1.0 - shrinkage[polygons.interface])[:, None] * toward)


def shift_about_pressure(contacts: Contacts, points: Contacts, n: FloatArray, before: FloatArray) -> FloatArray:
    """Return how far from each point its friction acts (np, 2) m, along t1 and t2, for normal forces n (np,).

    With p the centre of pressure of a joint, friction acts at p + xi (x_k - p). Uniform pressure is taken on the area that is
    symmetric about p (of a rectangle b x h with eccentricity e: the rectangle (b - 2 |e_b|) x (h - 2 |e_h|) of Meyerhof), and
    resists a torque of mu N times its mean distance from p. Forces n_k at the points resist mu min sum n_k |x_k - q|, where q,
    about which they turn, is their geometric median. xi is the ratio of the two, at most 1.

    contacts: the joints with their corners; points: the same joints with the points that n acts at; before (np, 2): the answer
    for joints without pressure.
    """
    return shift_in_polygons(joint_polygons(contacts), points, n, before)


def shift_in_polygons(polygons: JointPolygons, points: Contacts, n: FloatArray, before: FloatArray) -> FloatArray:
    """Return the shifts (np, 2) m of `shift_about_pressure` in joints of these polygons."""
    interface = points.interface_of_point
    place = np.einsum("kac,kc->ka", points.frame[interface, 1:], points.point - polygons.middle[interface])
    pressed = np.bincount(interface, n, minlength=len(polygons.start))
    loaded = pressed > _LOADED * pressed.max(initial=0.0)
    force = np.where(loaded, pressed, 1.0)
    centroid = _centroids(polygons)
    centre = np.stack([np.bincount(interface, n * along, minlength=len(force)) for along in place.T], axis=1) / force[:, None]
    # On an edge the area would be none.
    centre = np.where(loaded[:, None], centroid + (1.0 - _INSIDE) * (centre - centroid), centroid)
    corner, pointer = symmetric_parts(polygons.corner, np.append(polygons.start, len(polygons.corner)), centre)
    after = np.arange(len(corner)) + 1
    after[pointer[1:] - 1] = pointer[:-1]
    around = np.repeat(centre, np.diff(pointer), axis=0)
    arm = place - centre[interface]
    lever = _least_mean_distance(place, n, interface, centre, force)
    mean = mean_distance(corner - around, after, pointer[:-1])
    shrinkage = np.minimum(np.divide(mean, lever, out=np.ones_like(mean), where=lever > mean), 1.0)
    return np.where(loaded[interface, None], (shrinkage[interface] - 1.0)[:, None] * arm, before)


def _least_mean_distance(
    place: FloatArray, n: FloatArray, interface: IntArray, start: FloatArray, force: FloatArray
) -> FloatArray:
    """Return the mean distance (ni,) of points (np, 2) with weights n from their geometric median, by Weiszfeld's iteration."""
    count, median = len(force), start

    def total(values: FloatArray) -> FloatArray:
        return np.bincount(interface, values, minlength=count).astype(np.float64)

    for _ in range(_WEISZFELD):
        distance = np.maximum(np.hypot(*(place - median[interface]).T), 1e-12)
        pull = n / distance
        weight = np.maximum(total(pull), 1e-300)
        median = np.stack([total(pull * along) for along in place.T], axis=1) / weight[:, None]
    return total(n * np.hypot(*(place - median[interface]).T)) / force


def _centroids(polygons: JointPolygons) -> FloatArray:
    """Return the centroids (ni, 2) m of polygons, from the mean of their corners."""
    corner, following = polygons.corner, polygons.corner[polygons.after]
    twice = cross(corner, following)
    return summed((corner + following) * twice[:, None], polygons.start) / (6.0 * polygons.area[:, None])


def mean_distance(corner: FloatArray, after: IntArray, start: IntArray) -> FloatArray:
    """Return the mean distance (ni,) from the origin of the areas of polygons with these corners (nc, 2).

    after (nc,): the next corner; start (ni,): the first of each polygon. An edge at distance h from the origin, between s_1
    and s_2 along it, spans a triangle with the origin in which the integral of the distance is
    [h s r + h^3 asinh(s / h)] / 6 from s_1 to s_2, r^2 = h^2 + s^2; triangles count with the sign of their turn.
    """
    edge = corner[after] - corner
    along = edge / np.maximum(np.hypot(*edge.T), 1e-300)[:, None]
    turn = cross(corner, along)
    h = np.abs(turn)
    total = np.zeros(len(corner))
    for end, sign in ((corner[after], 1.0), (corner, -1.0)):
        s = (end * along).sum(axis=1)
        slope = np.divide(s, h, out=np.zeros_like(s), where=h > 0)
        total += sign * (h * s * np.hypot(h, s) + h**3 * np.arcsinh(slope))
    area = summed(cross(corner, corner[after]), start) / 2.0
    return summed(np.sign(turn) * total, start) / (6.0 * area)
