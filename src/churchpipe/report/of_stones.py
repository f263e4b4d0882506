"""Whether a limit state is of the stones, the load and the ties that it is reported with: its forces balance there."""

from collections.abc import Sequence

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.model.loads import LoadCase
from churchpipe.model.names import GOOD
from churchpipe.model.placed_loads import PlacedLoads
from churchpipe.model.results import LimitState
from churchpipe.model.ties import Tie
from churchpipe.rigid_blocks.certificate import Strength
from churchpipe.rigid_blocks.equilibrium import equilibrium
from churchpipe.rigid_blocks.ties import with_ties

# Shares of the weight, and of weight times the size of a stone, that the forces of an analysis do not leave.
_LEFT = 1e-4
# Normals of the joints of a stone span no direction of which they have a smaller share.
_FLAT = 1e-3


def check_state_of(
    where: str, state: LimitState, stones: Assemblage, contacts: Contacts, load: LoadCase, ties: Sequence[Tie] = ()
) -> None:
    """Raise InputError for a limit state whose forces do not balance the load case on these stones with these ties.

    A state without a load factor has no such forces, and passes where its numbers of stones and points are theirs.
    """
    what = "a result of another structure, load or ties"
    remedy = "Give the stones, contacts, load case and ties that its limit_analysis was called with."
    for name, own, here in (
        ("stones", len(state.velocities), stones.count),
        ("contact points", len(state.forces), len(contacts.point)),
        ("ties", len(state.tie_forces), len(ties)),
    ):
        if own != here:
            raise InputError(where, what, found=f"one of {own} {name}", expected=f"one of {here}", remedy=remedy)
    if state.status not in GOOD:
        return
    force, moment, worst = _left(state, stones, contacts, load, ties)
    if max(force, moment) > _LEFT:
        found = (
            f"forces that leave {force:.2g} of the weight, and a moment of {moment:.2g} of it times a stone's size, at {worst}"
        )
        raise InputError(where, what, found=found, expected=f"forces that balance {load.name}", remedy=remedy)


def check_loads_in(where: str, load: LoadCase, stones: Assemblage, placed: PlacedLoads) -> None:
    """Raise InputError where a load, of what the stones carry, presses stones on which nothing of it is in the load case."""
    dead, live = (np.zeros((stones.count, 6)) if given is None else given for given in (load.dead, load.live))
    if dead.shape != (stones.count, 6):
        raise InputError(where, "a load case of other stones", found=dead.shape, expected=f"({stones.count}, 6)")
    acting = np.concatenate([dead, live], axis=1) if load.multiplies else dead
    absent = placed.dead.any(axis=1) & ~stones.fixed[placed.stone] & ~acting[placed.stone].any(axis=1)
    if absent.any():
        name = str(placed.load[absent][0])
        raise InputError(
            where,
            "loads= names a load that the load case has not",
            found=f"{name}, and nothing of it in {load.name}",
            expected="the load cases that the analyses were made with",
            remedy="Give the load case that churchpipe.loaded made of it, and its result, or leave that load out.",
        )


def _left(
    state: LimitState, stones: Assemblage, contacts: Contacts, load: LoadCase, ties: Sequence[Tie]
) -> tuple[float, float, str]:
    """Return the largest force and moment that are left on a stone, and its name.

    Of moments those about normals of a stone's joints are left out: the state does not tell where friction acts against torsion.
    """
    balance = equilibrium(stones, contacts, load)
    zero = np.zeros(len(contacts.point))
    balance, _ = with_ties(balance, Strength(zero, zero, np.full(len(zero), np.inf)), stones, ties)
    x = np.zeros((balance.points, 3))
    x[: balance.contacts] = state.forces / balance.force
    x[balance.contacts :, 0] = state.tie_forces / balance.force
    endless = state.status == "unbounded"
    # Those forces balance the lateral load alone.
    left = balance.wrenches.apply(x) + (balance.live if endless else balance.dead + state.load_factor * balance.live)
    wrench = left.reshape(-1, 2, 3)
    moment = _across(wrench[:, 1], stones, contacts, balance.free)
    sizes = np.stack([np.linalg.norm(wrench[:, 0], axis=1), np.linalg.norm(moment, axis=1)])
    worst = balance.free[int(np.argmax(sizes.max(axis=0)))]
    return float(sizes[0].max()), float(sizes[1].max()), str(stones.block_id[worst])


def _across(moment: FloatArray, stones: Assemblage, contacts: Contacts, free: IntArray) -> FloatArray:
    """Return moments (nf, 3) on stones without what acts about the normals of their joints."""
    normal = contacts.frame[:, 0]
    spread = np.zeros((stones.count, 3, 3))
    for side in (0, 1):
        np.add.at(spread, contacts.blocks[:, side], normal[:, :, None] * normal[:, None, :])
    values, axes = np.linalg.eigh(spread[free])
    flat = values <= _FLAT * values.max(axis=1, keepdims=True)
    parts = np.einsum("sij,si->sj", axes, moment)
    return np.asarray(np.einsum("sij,sj->si", axes, np.where(flat, parts, 0.0)))
