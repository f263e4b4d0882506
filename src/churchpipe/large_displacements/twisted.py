"""Where the friction of joints acts that resist torsion as uniform pressure does, while stones move."""

import numpy as np

from churchpipe.model.arrays import FloatArray
from churchpipe.model.contacts import Contacts
from churchpipe.rigid_blocks.polygons import polygons_of
from churchpipe.rigid_blocks.torsion import shift_in_polygons

# The mean distance of a line from its middle over that of its ends.
_LINE = 0.5


def friction_shift(contacts: Contacts, n: FloatArray, before: FloatArray) -> FloatArray:
    """Return how far from each point its friction acts (nc, 2) m, along t1 and t2, for normal forces n (nc,).

    Joints that bear on three points or more: see `shift_about_pressure`. Two points are a line, in which uniform pressure about
    its centre resists half the torque of its ends. Friction of a single point acts there. before (nc, 2): the answer for joints
    without pressure.
    """
    count, interface = contacts.points_per_interface, contacts.interface_of_point
    out = np.where(count[interface, None] > 1, before, 0.0)
    wide = count >= 3
    if wide.any():
        mine = wide[interface]
        part = contacts.selected(wide)
        out[mine] = shift_in_polygons(polygons_of(part), part, n[mine], before[mine])
    first = contacts.point_ptr[:-1][count == 2]
    force = n[first] + n[first + 1]
    pressed = force > 0
    first, force = first[pressed], force[pressed]
    for one, other in ((first, first + 1), (first + 1, first)):
        toward = (n[other] / force)[:, None] * (contacts.point[other] - contacts.point[one])
        out[one] = (1.0 - _LINE) * np.einsum("kac,kc->ka", contacts.frame[interface[one], 1:], toward)
    return out
