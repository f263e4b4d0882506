"""Equilibrium of the free stones: A c + f_D + alpha f_L = 0, eq. (1)."""

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
import scipy.sparse as sp

from churchpipe.conic.pressed import PressedJoints
from churchpipe.conic.program import ConeProgram
from churchpipe.conic.wrenches import Balance, Wrenches, apply, pair_wrenches, transpose
from churchpipe.errors import InputError
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts, check_contacts_of
from churchpipe.model.loads import LoadCase, pushed_share
from churchpipe.model.names import ContactModel
from churchpipe.rigid_blocks.crushing import JointParts
from churchpipe.rigid_blocks.torsion import friction_points


class Balanced(Protocol):
    """What the analyses without dilatancy need to know of a balance: see `Equilibrium`."""

    @property
    def dead(self) -> FloatArray:
        """f_D."""
        ...

    @property
    def live(self) -> FloatArray:
        """f_L."""
        ...

    @property
    def points(self) -> int:
        """Number of contact points and ties."""
        ...

    @property
    def softness(self) -> FloatArray:
        """The rate (nc,) at which an elastic tie lengthens under a unit of tension, zero at all other points."""
        ...

    def residual(self, x: FloatArray, load_factor: float) -> FloatArray:
        """Return what is left of the balance of forces x (nc, 3)."""
        ...

    def rates(self, y: FloatArray) -> FloatArray:
        """Return how fast the points open and slide (nc, 3) with velocities y that do unit work with the live load."""
        ...

    def program(
        self,
        limit: FloatArray,
        slope: FloatArray,
        bound: FloatArray,
        linear: FloatArray | None = None,
        quadratic: FloatArray | None = None,
    ) -> ConeProgram:
        """Return the cone program of this balance."""
        ...


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """The balance of the free stones in the units of the analysis.

    The unit of force is the total weight of the free stones, the unit of length the mean size of a stone: any other choice
    hides errors in relative residuals. wrenches: A, what the forces (n, t1, t2) of contact points and ties do to the stones
    (force, moment about the centroid); dead f_D, live f_L (6 nf,); free (nf,) stones; count nb; force N and length m are the
    units. The last `ties` of these points are ties (`ties.with_ties`).

    Joints that crush have rows of their own below those of the stones, and further points after the ties, whose cones are those
    of friction of one: `pressed`, see `conic.pressed`. Dead and live then have these rows, too.
    """

    wrenches: Wrenches
    dead: FloatArray
    live: FloatArray
    free: IntArray
    count: int
    force: float
    length: float
    ties: int = 0
    pressed: PressedJoints | None = None

    @property
    def contacts(self) -> int:
        """Number of contact points."""
        return self.points - self.ties

    @property
    def points(self) -> int:
        """Number of contact points and ties."""
        return len(self.wrenches.frame)

    @property
    def softness(self) -> FloatArray:
        """Zeros (nc + nt + further,): ties of a limit analysis are rigid until they yield."""
        return np.zeros(self.balance.shape[1] // 3)

    @property
    def rows(self) -> int:
        """Number of rows of the stones."""
        return self.wrenches.shape[0]

    @cached_property
    def balance(self) -> Balance:
        """All rows in all points: what a cone program balances."""
        return self.wrenches if self.pressed is None else self.pressed.below(self.wrenches)

    def residual(self, x: FloatArray, load_factor: float) -> FloatArray:
        """Return what is left of the balance (rows,) of forces x (points, 3)."""
        return apply(self.balance, x) + self.dead + load_factor * self.live

    def rates(self, y: FloatArray) -> FloatArray:
        """Return how fast the points open and slide (points, 3) with velocities y (rows,); ties shorten."""
        return transpose(self.balance, y)

    def program(
        self,
        limit: FloatArray,
        slope: FloatArray,
        bound: FloatArray,
        linear: FloatArray | None = None,
        quadratic: FloatArray | None = None,
    ) -> ConeProgram:
        """Return the cone program of this balance; all arrays, one value a point, as there: no cost if None.

        The further points of joints that crush keep their own cones, and cost nothing.
        """
        price, curvature = (np.zeros(len(limit)) if each is None else each for each in (linear, quadratic))
        if self.pressed is not None:
            own = np.arange(len(limit)) < self.points
            limit, price, curvature = (np.where(own, each, 0.0) for each in (limit, price, curvature))
            slope = np.where(own, slope, 1.0)
        return ConeProgram(self.balance, self.dead, self.live, limit, slope, price, curvature, bound=bound)

    def velocities(self, y: FloatArray) -> FloatArray:
        """Return velocities (nb, 6) of all stones from multipliers (rows,) of the balance: f_L . u is 1 m per total weight."""
        out = np.zeros((self.count, 6))
        out[self.free] = y[: self.rows].reshape(-1, 6)
        out[:, 3:] /= self.length
        return out

    def multipliers(self, velocities: FloatArray) -> FloatArray:
        """Return multipliers (rows,) of velocities (nb, 6): the inverse of `velocities`, zero for joints that crush."""
        out = np.zeros(len(self.dead))
        out[: self.rows] = (velocities[self.free] * np.repeat([1.0, self.length], 3)).ravel()
        return out


def equilibrium(
    stones: Assemblage,
    contacts: Contacts,
    load: LoadCase,
    contact_model: ContactModel = "corners",
    parts: JointParts | None = None,
) -> Equilibrium:
    """Return the scaled balance of an assemblage under a load case.

    contact_model: where friction acts, see `limit_analysis`. parts: of the joints, whose centroids are the contact points then.

    Raises
    ------
    InputError: no free stone, contacts of another assemblage, or a load case that pushes nothing.
    """
    free = np.flatnonzero(~stones.fixed)
    if not len(free):
        raise InputError("stones", "every stone is fixed", expected="at least one free stone")
    check_contacts_of(stones, contacts)
    friction = friction_points(contacts) if contact_model == "torsion" else None
    if parts is not None:
        contacts, friction = parts.contacts, None if friction is None else parts.shares @ friction
    force = float(stones.weight.sum())
    length = float(np.cbrt(stones.volume[free].mean()))
    dead = np.zeros((stones.count, 6))
    dead[:, 2] = -stones.weight
    dead += _extra("LoadCase.dead", load.dead, stones.count)
    live = np.zeros((stones.count, 6))
    live[:, :3] = lateral_weight(stones, load)[:, None] * load.direction
    live += _extra("LoadCase.live", load.live, stones.count)
    if not live[free].any():
        remedy = "churchpipe.loaded gives it what the building carries." if load.multiplies else ""
        raise InputError(f"load {load.name}", "nothing is pushed", expected="a load on at least one free stone", remedy=remedy)
    unit = np.array([force] * 3 + [force * length] * 3)
    return Equilibrium(
        wrenches=contact_wrenches(stones, contacts, free, length, friction),
        dead=(dead / unit)[free].ravel(),
        live=(live / unit)[free].ravel(),
        free=free,
        count=stones.count,
        force=force,
        length=length,
    )


def lateral_weight(stones: Assemblage, load: LoadCase) -> FloatArray:
    """Return the weight (nb,) N that the load factor multiplies, by the load's panels and profile."""
    free = ~stones.fixed
    ground = stones.points[np.repeat(free, np.diff(stones.block_point_ptr)), 2].min()
    weight = np.zeros(stones.count)
    own, height = stones.weight[free], stones.centroid[free, 2] - ground
    weight[free] = own * pushed_share(load, stones.panel[free], own, height)
    return weight


def _extra(name: str, wrench: FloatArray | None, count: int) -> FloatArray:
    if wrench is None:
        return np.zeros((count, 6))
    if wrench.shape != (count, 6):
        raise InputError(name, "wrong shape", found=wrench.shape, expected=f"({count}, 6)")
    return wrench


def contact_wrenches(
    stones: Assemblage, contacts: Contacts, free: IntArray, length: float, friction: FloatArray | None = None
) -> Wrenches:
    """Return what the point forces (n, t1, t2) do to these stones (nf,): wrenches about their centroids, moments over length, m.

    friction (nc, 3) m: where t1 and t2 act, in the plane of the joint, None: where n does.
    """
    row_of = np.full(stones.count, -1, dtype=np.int64)
    row_of[free] = np.arange(len(free))
    interface = contacts.interface_of_point
    pairs = contacts.blocks[interface]
    shift = None
    if friction is not None:
        shift = np.einsum("kac,kc->ka", contacts.frame[interface, 1:], friction - contacts.point) / length
    return pair_wrenches(
        len(free),
        row_of[pairs],
        (contacts.point[:, None] - stones.centroid[pairs]) / length,
        contacts.frame,
        interface,
        shift,
    )


def check_connected(stones: Assemblage, contacts: Contacts, balance: Equilibrium) -> None:
    """Raise when a free stone has no contact at all or no path to a support: a solver would only say "infeasible"."""
    ones = np.ones(len(contacts.blocks))
    graph = sp.coo_matrix((ones, (contacts.blocks[:, 0], contacts.blocks[:, 1])), shape=(stones.count, stones.count))
    _, component = sp.csgraph.connected_components(graph, directed=False)
    loose = balance.free[~np.isin(component[balance.free], component[stones.fixed])]
    if len(loose):
        shown = ", ".join(stones.block_id[loose[:8]]) + (f" and {len(loose) - 8} more" if len(loose) > 8 else "")
        raise InputError(
            "stones",
            "no path of contacts to a support",
            found=shown,
            expected="every free stone connected to a fixed one",
            remedy="Fix a stone that rests on the ground, or close the gaps between stones (contact_gap).",
        )
