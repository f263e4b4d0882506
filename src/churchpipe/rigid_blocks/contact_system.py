"""The contact points of a balance as a run from the centre sees them: their state, their cones, and matrices for its steps."""

from dataclasses import dataclass
from functools import cached_property

import numba
import numpy as np

from churchpipe.conic.cholesky import Cholesky, NotDefiniteError
from churchpipe.conic.interior_point.coupling import Coupling, Touches
from churchpipe.conic.interior_point.normal import NormalMatrix
from churchpipe.conic.interior_point.second_order import SecondOrder, SecondOrderScaling
from churchpipe.conic.interior_point.wrenches import WrenchCoupling
from churchpipe.conic.wrenches import BODY
from churchpipe.model.arrays import FloatArray
from churchpipe.rigid_blocks.certificate import Strength
from churchpipe.rigid_blocks.equilibrium import Equilibrium
from churchpipe.rigid_blocks.settings import CentralSettings

# What is added to the diagonal of a matrix, over its entry there and over the largest of the stone, and more where that fails.
_REGULARISATION, _OF_STONE, _MORE = 1e-14, 1e-8, 100.0
_ATTEMPTS = 4


@dataclass(frozen=True, slots=True)
class ContactState:
    """Forces X and rates R of the points, both (3, nc), the load factor and the velocities y (6 nf,); or a step of all these.

    The rates are those of y, but at points that stopped short on the way.
    """

    forces: FloatArray
    load_factor: float
    y: FloatArray
    rates: FloatArray

    def plus(self, step: "ContactState", length: float = 1.0) -> "ContactState":
        """Return self + length step."""
        return ContactState(
            self.forces + length * step.forces,
            self.load_factor + length * step.load_factor,
            self.y + length * step.y,
            self.rates + length * step.rates,
        )


class ContactSystem:
    """The points of a balance, their cones, and the matrices of a step: structure and symbolic analysis, done once."""

    def __init__(self, balance: Equilibrium, strength: Strength, settings: CentralSettings) -> None:
        self.settings = settings
        self.friction, self.dead, self.live = strength.friction, balance.dead, balance.live
        self.points = len(self.friction)
        self.coupling = WrenchCoupling(balance.wrenches)
        self.cone = SecondOrder(3, 1, self.points)
        self.unit = self.cone.identity()[:, 0]
        self.factorisations = 0

    def couple(self, forces: FloatArray) -> FloatArray:
        """Return the wrenches (6 nf,) of forces (3, nc)."""
        return self.coupling.couple(np.concatenate([forces[0] / self.friction, forces[1], forces[2]]))

    def rates(self, y: FloatArray) -> FloatArray:
        """Return the rates (3, nc) of velocities y (6 nf,)."""
        out = self.coupling.spread(y).reshape(3, -1)
        out[0] /= self.friction
        return out

    def residual(self, at: ContactState) -> FloatArray:
        """Return what is left of the balance (6 nf,)."""
        return self.couple(at.forces) + self.dead + at.load_factor * self.live

    def roundness(self, rates: FloatArray) -> FloatArray:
        """Return r (nc,), what Z adds to the opening."""
        return np.sqrt(rates[1] ** 2 + rates[2] ** 2 + (self.settings.roundness * rates[0]) ** 2)

    def multipliers(self, rates: FloatArray) -> FloatArray:
        """Return Z (3, nc) of rates R (3, nc)."""
        return np.stack([rates[0] + self.roundness(rates), rates[1], rates[2]])

    def product(self, u: FloatArray, v: FloatArray) -> FloatArray:
        """Return the product u o v (3, nc) of the cones' algebra."""
        return self.cone.product(u[:, None], v[:, None])[:, 0]

    def reach(self, u: FloatArray, step: FloatArray) -> float:
        """Return 1 / t for the largest t with u + t step in the cones."""
        return float(self.reaches(u, step).max(initial=0.0))

    def reaches(self, u: FloatArray, step: FloatArray) -> FloatArray:
        """Return the same of each cone alone (nc,), at most 0 where there is no such t."""
        return self.cone.rates(u[:, None], step[:, None], step[:, None], np.zeros(1))[0]

    def scaling(self, forces: FloatArray, multipliers: FloatArray) -> SecondOrderScaling:
        """Return the Nesterov-Todd scaling W of forces and multipliers, both (3, nc)."""
        return self.cone.scaling(forces[:, None], multipliers[:, None])

    def recentre(self, product: FloatArray, low: float, high: float) -> FloatArray:
        """Return the correction that brings the eigenvalues of products (3, nc) into [low, high]."""
        return self.cone.recentre(product[:, None], low, high)[:, 0]

    @cached_property
    def balance(self) -> "Factor":
        """The matrix of the balance, A."""
        return Factor(self.coupling)

    @cached_property
    def velocities(self) -> "Factor":
        """Another matrix of that pattern, K."""
        return Factor(self.coupling)

    @cached_property
    def pair(self) -> "Factor":
        """The matrix of multipliers and velocities together, six rows of a stone of the one after six of the other."""
        return Factor(doubled(self.coupling), halves=2)

    def factorise(self, factor: "Factor", blocks: FloatArray) -> None:
        """Factorise one of these matrices, of blocks S (3, 3, nc), or (6, 6, nc) of the pair.

        Raises
        ------
        NotDefiniteError
        """
        self.factorisations += 1
        n = np.ones((len(blocks), self.points))
        n[::3] /= self.friction
        factor.factorise(np.ascontiguousarray(blocks * n[:, None] * n))


class Factor:
    """The normal matrix of a coupling and its factor; of halves=2 the second half of the rows of each stone is negative."""

    def __init__(self, coupling: Coupling, halves: int = 1) -> None:
        self._normal = NormalMatrix(coupling)
        negative = np.arange(coupling.rows) // BODY % 2 == 1 if halves == 2 else None
        self._signs = np.ones(coupling.rows) if negative is None else np.where(negative, -1.0, 1.0)
        self._factor = Cholesky(self._normal.pattern, coupling.block, negative)
        self.solve = self._factor.solve

    def factorise(self, compliance: FloatArray) -> None:
        """Factorise the matrix of these blocks (d, d, nc), d 3 for each half."""
        values = self._normal.assemble(compliance)
        diagonal = values[self._normal.diagonal]
        size = np.abs(diagonal)
        shift = self._signs * _REGULARISATION * (size + _OF_STONE * np.repeat(size.reshape(-1, BODY).max(axis=1), BODY))
        for attempt in range(_ATTEMPTS):
            values[self._normal.diagonal] = diagonal + _MORE**attempt * shift
            try:
                self._factor.factor(values)
                return
            except NotDefiniteError:
                if attempt == _ATTEMPTS - 1:
                    raise


def doubled(coupling: Coupling) -> Coupling:
    """Return the coupling of two forces at each point with two halves of the rows of each stone, the first and the second."""
    touches, dimension, block = coupling.values.shape
    values = np.zeros((touches, 2 * dimension, 2 * block))
    values[:, :dimension, :block] = values[:, dimension:, block:] = coupling.values
    return Coupling(Touches(2 * coupling.rows, coupling.pointer, coupling.blocks, values))


def multiply(blocks: FloatArray, v: FloatArray, *, transposed: bool = False) -> FloatArray:
    """Return blocks_ijk v_jk, or blocks_jik v_jk (3, nc)."""
    out = np.empty_like(v)
    _multiply(blocks.transpose(1, 0, 2) if transposed else blocks, v, out)
    return out


@numba.njit(cache=True)
def _multiply(blocks: FloatArray, v: FloatArray, out: FloatArray) -> None:
    """Write blocks_ijk v_jk into out_ik."""
    for k in range(v.shape[1]):
        a, b, c = v[0, k], v[1, k], v[2, k]
        for i in range(3):
            out[i, k] = blocks[i, 0, k] * a + blocks[i, 1, k] * b + blocks[i, 2, k] * c
