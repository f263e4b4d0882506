"""What stays the same while stones move: the drawing, loads and friction, and the lengths that steps are measured by."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import cast

import numpy as np
import numpy.typing as npt

from churchpipe.large_displacements.joints import Joints
from churchpipe.large_displacements.poses import start_poses
from churchpipe.large_displacements.renewal import PairValues, first_joints, pair_values
from churchpipe.large_displacements.settings import EXACTING, PATH, THRIFTY, Demands
from churchpipe.large_displacements.supports import SupportMovement
from churchpipe.large_displacements.travelling import TravellingLoads, dead_loads
from churchpipe.large_displacements.travelling_ties import TravellingTies, travelling_ties
from churchpipe.model.arrays import BoolArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.model.loads import LoadCase
from churchpipe.model.names import ContactModel
from churchpipe.model.ties import Tie
from churchpipe.rigid_blocks.equilibrium import Equilibrium
from churchpipe.rigid_blocks.torsion import friction_points


@dataclass(frozen=True, slots=True)
class MovingModel:
    """What stays the same on the way: stones as drawn, loads, friction of pairs.

    drawn: the joints as drawn, but for those between supports. driven: the loads that grow, or the support that moves.
    held (nb,): stones that are held still. moving N: the weight that moves at the start. force N and length m are the units of
    the programs. step m, turn rad: the largest displacement and rotation of a step. reach m: how far apart points may be that can
    still come to bear.
    strength: Pa, of pairs in compression; None: nothing crushes.
    """

    stones: Assemblage
    drawn: Joints
    dead: TravellingLoads
    driven: TravellingLoads | SupportMovement
    friction: PairValues
    held: BoolArray
    moving: float
    force: float
    length: float
    step: float
    reach: float
    solver: str
    ties: TravellingTies
    strength: PairValues | None = None
    contact_model: ContactModel = "corners"
    turn: float = PATH.turn

    @property
    def plain(self) -> bool:
        """True where nothing crushes and friction acts at the points of contact."""
        return self.strength is None and self.contact_model == "corners"

    @property
    def rest(self) -> float:
        """The largest gap or overlap of a joint as drawn, m. It is that of all joints, whichever stones are followed."""
        return float(np.abs(self.drawn.rest).max(initial=0.0))

    @property
    def large(self) -> bool:
        """True where most stones are held, or there are so many points that the certified analysis takes many minutes."""
        return bool(self.held.any()) or len(self.drawn.sliding) > PATH.large

    @property
    def least_factor(self) -> float:
        """The load factor below which a push is lost in the balance of the forces, `PATH.balance` of the weight."""
        driven = cast(TravellingLoads, self.driven)
        drawn = np.broadcast_to(np.eye(3), (self.stones.count, 3, 3))
        push = driven.rows(drawn, np.flatnonzero(~self.stones.fixed), self.force, self.length)
        return PATH.balance / max(float(np.abs(push).sum()), PATH.balance)

    @property
    def demands(self) -> Demands:
        """What the programs of a step must reach."""
        return THRIFTY if self.large else EXACTING


def moving_model(
    stones: Assemblage,
    contacts: Contacts,
    load: LoadCase,
    driven: TravellingLoads | SupportMovement,
    friction: npt.ArrayLike,
    balance: Equilibrium,
    moving: BoolArray,
    step: float | None,
    solver: str,
    ties: Sequence[Tie] = (),
    strength: npt.ArrayLike | None = None,
    contact_model: ContactModel = "corners",
) -> MovingModel:
    """Return the model of stones of which `moving` (nb,) go first; balance: theirs as drawn; step m, None: by their thickness."""
    size = thinnest(stones, moving)
    drawn = first_joints(contacts, stones, start_poses(stones), PATH.reach * size, crushing=strength is not None)
    if contact_model == "torsion":
        drawn = replace(drawn, lever=friction_points(contacts) - contacts.point)

    def of_pairs(value: npt.ArrayLike) -> PairValues:
        of_joints = np.broadcast_to(np.asarray(value, dtype=np.float64), contacts.area.shape)
        return pair_values(contacts.blocks, of_joints, stones.count)

    return MovingModel(
        stones=stones,
        # Supports do not bear on each other: one that moves past another is not held by it.
        drawn=drawn.selected(bearing(stones.fixed, contacts.blocks)),
        dead=dead_loads(stones, load),
        driven=driven,
        friction=of_pairs(friction),
        held=np.zeros(stones.count, dtype=bool),
        moving=float(stones.weight[moving].sum()),
        force=balance.force,
        length=balance.length,
        step=PATH.step * size if step is None else step,
        reach=PATH.reach * size,
        solver=solver,
        ties=travelling_ties(stones, ties),
        strength=None if strength is None else of_pairs(strength),
        contact_model=contact_model,
    )


def bearing(still: BoolArray, blocks: IntArray) -> BoolArray:
    """Return which interfaces of stones (ni, 2) are not between two still ones (nb,)."""
    first, second = blocks.T
    return ~(still[first] & still[second])


def thinnest(stones: Assemblage, moving: BoolArray) -> float:
    """Return the median over the moving stones of the least side of their boxes, m."""
    low, high = (edge.reduceat(stones.points, stones.block_point_ptr[:-1], axis=0) for edge in (np.minimum, np.maximum))
    return float(np.median((high - low)[moving].min(axis=1)))
