"""Equilibrium of the free stones: A c + f_D + alpha f_L = 0, eq. (1)."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
import scipy.sparse as sp

from churchpipe.conic.program import ConeProgram
from churchpipe.errors import InputError
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts, check_contacts_of
from churchpipe.model.loads import LoadCase, pushed_share
from churchpipe.rigid_blocks.torsion import friction_points

ContactModel = Literal["corners", "torsion"]


@dataclass(frozen=True, slots=True)
class Equilibrium:
    """The balance of the free stones in the units of the analysis.

    The unit of force is the total weight of the free stones, the unit of length the mean size of a stone: any other choice
    hides errors in relative residuals. matrix (6 nf, 3 nc) of the forces (n, t1, t2) on wrenches (force, moment about the
    centroid); dead, live (6 nf,); free (nf,) stones; count nb; force N and length m are the units. The last `ties` points are
    ties (`ties.with_ties`).
    """

    matrix: sp.csc_matrix
    dead: FloatArray
    live: FloatArray
    free: IntArray
    count: int
    force: float
    length: float
    ties: int = 0

    @property
    def contacts(self) -> int:
        """Number of contact points."""
        return self.matrix.shape[1] // 3 - self.ties

    def program(
        self,
        limit: FloatArray,
        slope: FloatArray,
        bound: FloatArray,
        linear: FloatArray | None = None,
        quadratic: FloatArray | None = None,
    ) -> ConeProgram:
        """Return the cone program of this balance; all arrays, one value a point (nc + nt,), as there: no cost if None."""
        price, curvature = (np.zeros(len(limit)) if each is None else each for each in (linear, quadratic))
        return ConeProgram(self.matrix, self.dead, self.live, limit, slope, price, curvature, bound=bound)

    def velocities(self, y: FloatArray) -> FloatArray:
        """Return velocities (nb, 6) of all stones from multipliers (6 nf,) of the balance: f_L . u is 1 m per total weight."""
        out = np.zeros((self.count, 6))
        out[self.free] = y.reshape(-1, 6)
        out[:, 3:] /= self.length
        return out

    def multipliers(self, velocities: FloatArray) -> FloatArray:
        """Return the multipliers (6 nf,) of velocities (nb, 6): the inverse of `velocities`."""
        return (velocities[self.free] * np.repeat([1.0, self.length], 3)).ravel()


def equilibrium(stones: Assemblage, contacts: Contacts, load: LoadCase, contact_model: ContactModel = "corners") -> Equilibrium:
    """Return the scaled balance of an assemblage under a load case; contact_model: where friction acts, see `limit_analysis`.

    Raises
    ------
    InputError: no free stone, contacts of another assemblage, or a load case that pushes nothing.
    """
    free = np.flatnonzero(~stones.fixed)
    if not len(free):
        raise InputError("stones", "every stone is fixed", expected="at least one free stone")
    check_contacts_of(stones, contacts)
    friction = friction_points(contacts) if contact_model == "torsion" else contacts.point
    force = float(stones.weight.sum())
    length = float(np.cbrt(stones.volume[free].mean()))
    dead = np.zeros((stones.count, 6))
    dead[:, 2] = -stones.weight
    dead += _extra("LoadCase.dead", load.dead, stones.count)
    live = np.zeros((stones.count, 6))
    live[:, :3] = lateral_weight(stones, load)[:, None] * load.direction
    live += _extra("LoadCase.live", load.live, stones.count)
    if not live[free].any():
        raise InputError(f"load {load.name}", "nothing is pushed", expected="a load on at least one free stone")
    unit = np.array([force] * 3 + [force * length] * 3)
    return Equilibrium(
        matrix=contact_matrix(stones, contacts, free, length, friction),
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


def contact_matrix(
    stones: Assemblage, contacts: Contacts, free: IntArray, length: float, friction: FloatArray | None = None
) -> sp.csc_matrix:
    """Return the matrix (6 nf, 3 nc) of point forces (n, t1, t2) on wrenches of these stones (nf,), moments over length, m.

    friction (nc, 3) m: where t1 and t2 act, None: where n does.
    """
    sliding = contacts.point if friction is None else friction
    place = np.stack([contacts.point, sliding, sliding], axis=1)
    row_of = np.full(stones.count, -1, dtype=np.int64)
    row_of[free] = np.arange(len(free))
    interface = contacts.interface_of_point
    axes = contacts.frame[interface]
    data, rows, columns = [], [], []
    for side, sign in ((0, -1.0), (1, 1.0)):
        block = contacts.blocks[interface, side]
        chosen = np.flatnonzero(row_of[block] >= 0)
        arm = (place[chosen] - stones.centroid[block[chosen]][:, None]) / length
        # wrench_iac: axis a of point i, component c of force and moment.
        wrench = np.concatenate([axes[chosen], np.cross(arm, axes[chosen])], axis=2) * sign
        data.append(wrench.ravel())
        rows.append(np.broadcast_to((6 * row_of[block[chosen]])[:, None, None] + np.arange(6), wrench.shape).ravel())
        columns.append(np.broadcast_to((3 * chosen)[:, None, None] + np.arange(3)[:, None], wrench.shape).ravel())
    shape = (6 * len(free), 3 * len(contacts.point))
    matrix = sp.coo_matrix((np.concatenate(data), (np.concatenate(rows), np.concatenate(columns))), shape=shape)
    return sp.csc_matrix(matrix)
