"""What cohesion and weight would add to a load factor, wall by wall, from the mechanism found."""

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arguments import check_kind
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts, check_contacts_of
from churchpipe.model.gains import Sensitivities
from churchpipe.model.loads import LoadCase
from churchpipe.model.motion import velocity_at
from churchpipe.model.results import LimitState


def sensitivities(state: LimitState, stones: Assemblage, contacts: Contacts, load: LoadCase) -> Sensitivities:
    """Return what cohesion and weight would add to the load factor of an associative analysis.

    By virtual work of the mechanism found, f_L . u = W, with velocities u and weight W: cohesion c on an area A adds
    c A |v_t| / W, v_t the rate at which it slides; weight G of stones that are pushed adds G (u_z - alpha d . u) / W, d the
    direction of the load. The rates hold for small changes; a large one meets another mechanism, which makes less of it.

    Parameters
    ----------
    state
        Of the analysis.
    stones, contacts, load
        Of that analysis. A load that grows with height pushes masses in the shares of the stones as they are.

    Raises
    ------
    InputError
        Arguments of the wrong kind; a state without a mechanism of the lateral load, or of an analysis without dilatancy, which
        has no such rates.
    """
    check_kind("sensitivities: state", state, LimitState)
    check_kind("sensitivities: stones", stones, Assemblage)
    check_kind("sensitivities: contacts", contacts, Contacts)
    check_kind("sensitivities: load", load, LoadCase)
    check_contacts_of(stones, contacts)
    if state.flow != "associative" or not np.isfinite(state.load_factor) or not state.velocities.any():
        found = f"{state.flow}, {state.status}"
        raise InputError("sensitivities: state", "no rates", found=found, expected="an associative state with a load factor")
    weight = float(stones.weight.sum())
    interface = contacts.interface_of_point
    first, second = contacts.blocks[interface].T
    jump = velocity_at(stones, state.velocities, second, contacts.point) - velocity_at(
        stones, state.velocities, first, contacts.point
    )
    slip = np.linalg.norm(np.einsum("pac,pc->pa", contacts.frame[interface][:, 1:], jump), axis=1)
    mean = np.bincount(interface, slip, len(contacts.area)) / np.maximum(contacts.points_per_interface, 1)
    joint = contacts.area * mean / weight
    free = ~stones.fixed
    panel, which = np.unique(stones.panel[free], return_inverse=True)
    row = np.full(stones.count, -1)
    row[free] = which.ravel()
    sides = row[contacts.blocks]
    of_wall = sides >= 0
    share = joint[:, None] / np.maximum(of_wall.sum(axis=1), 1)[:, None]
    halves = np.broadcast_to(share, sides.shape)[of_wall].astype(np.float64)
    cohesion = np.bincount(sides[of_wall], halves, len(panel)).astype(np.float64)
    pushed = np.ones(stones.count) if load.panels is None else np.isin(stones.panel, load.panels).astype(np.float64)
    gain = state.velocities[:, 2] - state.load_factor * pushed * (state.velocities[:, :3] @ load.direction)
    volume = np.where(free, stones.volume, 0.0)[free]
    spread = volume / np.bincount(which.ravel(), volume)[which.ravel()]
    return Sensitivities(panel, cohesion, np.bincount(which.ravel(), spread * gain[free], len(panel)) / weight, joint)
