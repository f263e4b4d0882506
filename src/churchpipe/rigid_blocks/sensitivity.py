"""What cohesion and weight would add to a load factor, wall by wall: from the mechanism found, and from new analyses."""

from dataclasses import replace
from typing import Any, get_args

import numpy as np
import numpy.typing as npt

from churchpipe.errors import InputError
from churchpipe.model.arguments import check_kind, one_of, whole
from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts, check_contacts_of
from churchpipe.model.gains import COHESION_MORE, WEIGHT_MORE, Sensitivities
from churchpipe.model.loads import LoadCase
from churchpipe.model.motion import velocity_at
from churchpipe.model.names import CONTACT_MODEL, ContactModel
from churchpipe.model.results import LimitState
from churchpipe.rigid_blocks.equilibrium import equilibrium, lateral_weight
from churchpipe.rigid_blocks.limit import limit_analysis, of_interfaces
from churchpipe.rigid_blocks.torsion import friction_points

# A mechanism does unit work with its own load, but for this: files keep fewer digits.
_UNIT_WORK = 1e-3


def sensitivities(
    state: LimitState,
    stones: Assemblage,
    contacts: Contacts,
    load: LoadCase,
    *,
    contact_model: ContactModel = CONTACT_MODEL,
) -> Sensitivities:
    """Return what cohesion and weight would add to the load factor of an associative analysis.

    By virtual work of the mechanism found, f_L . u = W, with velocities u and weight W: cohesion c on an area A adds
    c A |v_t| / W, v_t the rate at which it slides; weight G of stones that are pushed adds G (u_z - alpha d . u) / W, d the
    direction of the load. Of a load that grows with height d . u is the rate of the work of all that it pushes: more weight
    changes the shares of all stones. The rates hold for small changes; a large one meets another mechanism, which makes less of
    it.

    Parameters
    ----------
    state
        Of the analysis.
    stones, contacts, load
        Of that analysis. A load that grows with height pushes masses in the shares of the stones as they are.
    contact_model
        Of that analysis: where friction, and so cohesion, acts.

    Raises
    ------
    InputError
        Arguments of the wrong kind; a state of other stones or of another load; a state without a mechanism of the lateral load,
        or of an analysis without dilatancy, which has no such rates.
    """
    check_kind("sensitivities: state", state, LimitState)
    check_kind("sensitivities: stones", stones, Assemblage)
    check_kind("sensitivities: contacts", contacts, Contacts)
    check_kind("sensitivities: load", load, LoadCase)
    one_of("sensitivities: contact_model", contact_model, *get_args(ContactModel))
    check_contacts_of(stones, contacts)
    check_state_of("sensitivities", state, stones, contacts, load)
    if state.flow != "associative" or not np.isfinite(state.load_factor) or not state.velocities.any():
        found = f"{state.flow}, {state.status}"
        raise InputError("sensitivities: state", "no rates", found=found, expected="an associative state with a load factor")
    weight = float(stones.weight.sum())
    interface = contacts.interface_of_point
    first, second = contacts.blocks[interface].T
    place = friction_points(contacts) if contact_model == "torsion" else contacts.point
    jump = velocity_at(stones, state.velocities, second, place) - velocity_at(stones, state.velocities, first, place)
    slip = np.linalg.norm(np.einsum("pac,pc->pa", contacts.frame[interface][:, 1:], jump), axis=1)
    mean = np.bincount(interface, slip, len(contacts.area)) / np.maximum(contacts.points_per_interface, 1)
    joint = contacts.area * mean / weight
    free = ~stones.fixed
    panel, which = np.unique(stones.panel[free], return_inverse=True)
    cohesion = np.array([joint @ _share(stones, contacts, name) for name in panel.tolist()])
    gain = state.velocities[:, 2] - state.load_factor * _pushed(stones, load, state.velocities[:, :3] @ load.direction)
    volume = np.where(free, stones.volume, 0.0)[free]
    spread = volume / np.bincount(which.ravel(), volume)[which.ravel()]
    return Sensitivities(panel, cohesion, np.bincount(which.ravel(), spread * gain[free], len(panel)) / weight, joint)


def _pushed(stones: Assemblage, load: LoadCase, along: FloatArray) -> FloatArray:
    """Return the work (nb,) that a load does more at a load factor of one, for each newton more of a stone; along (nb,): the way
    of each along the load.

    Of f_i = W_i z_i (sum W) / (sum W z) = W_i s_i, which a newton more of stone k changes by s_k itself, and all others by
    (1 - s_k) / sum W of what they are; where all are pushed alike, s is 1.
    """
    if not load.direction.any():
        return np.zeros(stones.count)
    lateral = lateral_weight(stones, load)
    chosen = np.ones(stones.count) if load.panels is None else np.isin(stones.panel, load.panels).astype(np.float64)
    share = np.divide(lateral, stones.weight, out=np.zeros(stones.count), where=stones.weight > 0)
    return share * along + chosen * (1.0 - share) * float(lateral @ along) / float(lateral.sum())


def check_state_of(where: str, state: LimitState, stones: Assemblage, contacts: Contacts, load: LoadCase) -> None:
    """Raise an InputError where a state is of other stones, or of another load: its velocities do unit work with its own."""
    remedy = "give the stones, contacts and load of the analysis that made it"
    counts = (("stones", len(state.velocities), stones.count), ("contact points", len(state.forces), len(contacts.point)))
    for name, found, expected in counts:
        if found != expected:
            raise InputError(f"{where}: state", f"has other {name}", found=found, expected=str(expected), remedy=remedy)
    if not np.isfinite(state.load_factor) or not state.velocities.any():
        return
    balance = equilibrium(stones, contacts, load)
    work = float(balance.live @ balance.multipliers(state.velocities))
    if abs(work - 1.0) > _UNIT_WORK:
        found = f"its mechanism does {work:.4g} of the unit work with this one"
        raise InputError(f"{where}: state", "is of another load, or of other stones", found=found, expected="1", remedy=remedy)


def verify_gains(
    rates: Sensitivities,
    stones: Assemblage,
    contacts: Contacts,
    load: LoadCase,
    friction: npt.ArrayLike = 0.6,
    cohesion: npt.ArrayLike = 0.0,
    *,
    best: int = 3,
    **options: Any,
) -> Sensitivities:
    """Return rates with the load factors of new analyses: 10 kPa more cohesion, or 10 kN more weight, in one wall at a time.

    Parameters
    ----------
    rates
        From `sensitivities`.
    stones, contacts, load, friction, cohesion
        The analysis of that state.
    best
        How many walls are analysed of those that cohesion would help most, and of those that weight would.
    options
        Further arguments of `limit_analysis`.

    Raises
    ------
    InputError
        Arguments of the wrong kind; rates or contacts of other stones.
    """
    check_kind("verify_gains: rates", rates, Sensitivities)
    check_kind("verify_gains: stones", stones, Assemblage)
    check_kind("verify_gains: contacts", contacts, Contacts)
    check_contacts_of(stones, contacts)
    walls = np.unique(stones.panel[~stones.fixed])
    if not np.array_equal(rates.panel, walls) or len(rates.joint) != len(contacts.area):
        raise InputError(
            "verify_gains: rates",
            "are of other stones",
            found=f"walls {', '.join(rates.panel.tolist())}; {len(rates.joint)} joints",
            expected=f"{', '.join(walls.tolist())}; {len(contacts.area)} joints",
            remedy="Give the stones and contacts from which sensitivities made them.",
        )
    best = whole("verify_gains: best", best, least=0)
    present = of_interfaces("cohesion", cohesion, contacts)
    with_cohesion, with_weight = rates.with_cohesion.copy(), rates.with_weight.copy()
    for wall in np.argsort(-rates.cohesion, kind="stable")[:best].tolist():
        more = present + COHESION_MORE * _share(stones, contacts, str(rates.panel[wall]))
        with_cohesion[wall] = limit_analysis(stones, contacts, load, friction, more, **options).load_factor
    for wall in np.argsort(-rates.weight, kind="stable")[:best].tolist():
        own = (stones.panel == rates.panel[wall]) & ~stones.fixed
        heavier = replace(stones, unit_weight=stones.unit_weight + own * (WEIGHT_MORE / stones.volume[own].sum()))
        with_weight[wall] = limit_analysis(heavier, contacts, load, friction, cohesion, **options).load_factor
    return replace(rates, with_cohesion=with_cohesion, with_weight=with_weight)


def _share(stones: Assemblage, contacts: Contacts, wall: str) -> FloatArray:
    """Return the share of a wall in each interface (ni,): half of those with its neighbours, all of those with supports."""
    free = ~stones.fixed[contacts.blocks]
    own = free & (stones.panel[contacts.blocks] == wall)
    return np.asarray(own.sum(axis=1) / np.maximum(free.sum(axis=1), 1))
