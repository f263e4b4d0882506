"""Where the head joints of a course lie: the rules "grid" and "bay"."""

from collections.abc import Callable

import numpy as np

from churchpipe.bond.field import Field
from churchpipe.geometry.planar import distances
from churchpipe.geometry.polygons import TOLERANCE
from churchpipe.model.arrays import BoolArray, FloatArray

# A wall continues beyond a junction if there is masonry at this distance from the face of the junction, m.
END = 1e-6
# A stone may be longer than asked by this share of it, so that a bay of so many stones, and half of one, gets as many whether its
# length is exact or one that a file has rounded.
LONGER = 1e-3


def grid_joints(field: Field, b: float, offset: float) -> FloatArray:
    """Return the joints offset + k b within the wall, s in m; the ends of the wall are clipped."""
    low, high = field.span
    first, last = int(np.ceil((low - offset) / b - TOLERANCE)), int(np.floor((high - offset) / b + TOLERANCE))
    return offset + b * np.arange(first, last + 1, dtype=np.float64)


def bay_joints(field: Field, b: float, through: bool, height: float) -> FloatArray:
    """Return the joints of one course when each clear bay between junctions is divided evenly, s in m.

    A bay of length L takes m = round(L / b) stones of length b' = L / m. With k a whole number, courses that are cut by the
    crossing walls have joints at face + k b', courses that run through at face + (k + 1/2) b'. A course that runs through also
    crosses the junction itself. That stretch reaches from the last joint before the junction to the first one behind it, or to
    the end of the wall at this height. It is divided evenly, into the junction's length over b stones, rounded up, so that no
    straight joint rises at the corner.

    Parameters
    ----------
    field: the wall. b: target length of a stone, m. through: whether this course runs through. height: t in mid-course, m.
    """

    def inside(length: float) -> FloatArray:
        count = stones_in(length, b)
        return laid_length(length, b) * (np.arange(0.5, count) if through else np.arange(0.0, count + 1))

    def across(zone: FloatArray, start: float, stop: float) -> FloatArray:
        return np.linspace(start, stop, int(np.ceil((zone[1] - zone[0]) / b - LONGER)) + 1)

    return joints_by_bay(field, height, inside, across)


def joints_by_bay(
    field: Field, height: float, inside: Callable[[float], FloatArray], across: Callable[[FloatArray, float, float], FloatArray]
) -> FloatArray:
    """Return the joints of one course, s in m: those inside the clear bays, and those across the junctions that the wall owns.

    Parameters
    ----------
    field: the wall. height: t in mid-course, m. inside: function from the length of a bay to its joints, measured from its start.
    across: function from the two faces of a junction, the last joint before it and the first one behind it to the joints between
    these two. Where the wall ends at the junction at this height, its end takes the place of the missing joint.
    """
    joints: list[FloatArray] = []
    before, behind = field.zones[:, 0].copy(), field.zones[:, 1].copy()
    for bay, (start, stop) in enumerate(bays(field.span, field.zones)):
        if stop - start <= TOLERANCE:
            continue
        own = start + inside(stop - start)
        joints.append(own)
        if bay > 0:
            behind[bay - 1] = own[0]
        if bay < len(before):
            before[bay] = own[-1]
    # A wall that ends at the junction at this height, as a tower does above the roof, has no joint on its other side.
    before = np.where(_masonry(field, field.zones[:, 0] - END, height), before, field.zones[:, 0])
    behind = np.where(_masonry(field, field.zones[:, 1] + END, height), behind, field.zones[:, 1])
    for zone in np.flatnonzero(~_ceded(field, height)):
        joints.append(across(field.zones[zone], float(before[zone]), float(behind[zone])))
    return np.concatenate(joints) if joints else np.empty(0)


def bays(span: tuple[float, float], zones: FloatArray) -> FloatArray:
    """Return the clear bays (nz + 1, 2) of a wall from end to end (span) between its junctions (nz, 2), s in m; a bay may have no
    length."""
    return np.concatenate((span[:1], zones.ravel(), span[1:])).reshape(-1, 2)


def stones_in(length: float, b: float) -> int:
    """Return how many stones of about b m fit into a length; at least one."""
    # Half a stone always rounds up; Python's round would take the even number.
    return max(1, int(np.floor(length / b + 0.5 + LONGER)))


def laid_length(length: float, b: float) -> float:
    """Return how long the stones are, m, that divide a length evenly into as many as fit of about b m."""
    return length / stones_in(length, b)


def _masonry(field: Field, s: FloatArray, height: float) -> BoolArray:
    """Return whether there is masonry at s (n,) m at a height."""
    return distances(field.solid, np.stack([s, np.full(len(s), height)], axis=1)) == 0


def _ceded(field: Field, height: float) -> BoolArray:
    """Return for each zone whether another wall owns it at this height."""
    middle = field.zones.mean(axis=1)[:, None]
    s0, t0, s1, t1 = field.ceded.T
    return ((s0 < middle) & (middle < s1) & (t0 < height) & (height < t1)).any(axis=1)
