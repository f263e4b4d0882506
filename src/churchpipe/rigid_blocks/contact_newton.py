"""Damped Newton steps for sliding without dilatancy: complementarity in the least-squares sense, the balance exactly.

At each contact point (n, t, w, v, mu as in `coulomb`) forces are X = (mu n, t) and rates R = (s, v), with the opening w = mu s.
Both X and the multipliers Z = (s + r, v), r^2 = |v|^2 + roundness^2 s^2, lie in the cone of vectors (a, b) with a >= |b|. Their
product is that of the cone's algebra, (a, b) o (a', b') = (a a' + b . b', a b' + a' b). A collapse state without dilatancy
balances the load, does unit work with it, and has X o Z = 0 at each point. On the way there every product is nu (1, 0, 0), with
a nu > 0 that falls.

A step changes forces, rates and load factor by dX, dR and dalpha. W is the Nesterov-Todd scaling, which maps X and Z to one
point; D = W^-1 dX and E = W J dR, J = dZ/dR, are the changes as seen there, and q is what D + E should be for the products to
fall as wanted. A step solves

    min 1/2 |D + E - q|^2 + 1/2 damping (|D|^2 + |E|^2) + pull dalpha    subject to the balance and to unit work

(Levenberg 1944, Marquardt 1963). The matrix of a plain Newton step is neither symmetric nor definite, since the rates of a
Coulomb point are no gradient. This one needs Cholesky factors only, of two matrices with the pattern of the normal matrix.
"""

from dataclasses import dataclass

import numba
import numpy as np

from churchpipe.conic.cholesky import Cholesky, NotDefiniteError
from churchpipe.conic.interior_point.normal import NormalMatrix
from churchpipe.conic.interior_point.second_order import SecondOrder, SecondOrderScaling
from churchpipe.conic.interior_point.wrenches import WrenchCoupling
from churchpipe.conic.wrenches import BODY
from churchpipe.model.arrays import BoolArray, FloatArray
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
    """The points of a balance, their cones, and the two matrices of a step: structure and symbolic analysis, done once."""

    def __init__(self, balance: Equilibrium, strength: Strength, settings: CentralSettings) -> None:
        self.settings = settings
        self.friction, self.dead, self.live = strength.friction, balance.dead, balance.live
        self.points = len(self.friction)
        self.coupling = WrenchCoupling(balance.wrenches)
        self.normal = NormalMatrix(self.coupling)
        self.factors = Cholesky(self.normal.pattern, BODY), Cholesky(self.normal.pattern, BODY)
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

    def factorise(self, which: int, compliance: FloatArray) -> FloatArray:
        """Factorise the matrix B S B^T of 3 x 3 blocks S (3, 3, nc), and return its solution for the live load.

        Raises
        ------
        NotDefiniteError
        """
        n = np.ones((3, self.points))
        n[0] /= self.friction
        values = self.normal.assemble(np.ascontiguousarray(compliance * n[:, None] * n))
        diagonal = values[self.normal.diagonal]
        shift = _REGULARISATION * (diagonal + _OF_STONE * np.repeat(diagonal.reshape(-1, BODY).max(axis=1), BODY))
        for attempt in range(_ATTEMPTS):
            values[self.normal.diagonal] = diagonal + _MORE**attempt * shift
            try:
                self.factors[which].factor(values)
                break
            except NotDefiniteError:
                if attempt == _ATTEMPTS - 1:
                    raise
        self.factorisations += 1
        return self.factors[which].solve(self.live)


class Scaled:
    """Vectors of the points in the scaling W of their cones, in which forces and multipliers are the same point (3, nc)."""

    def __init__(self, scaling: SecondOrderScaling) -> None:
        self._scaling = scaling
        self.point = scaling.point[:, 0]

    def scaled_forces(self, forces: FloatArray) -> FloatArray:
        """Return W^-1 of forces (3, nc)."""
        return self._scaling.solve(forces[:, None])[:, 0]

    def scaled(self, multipliers: FloatArray) -> FloatArray:
        """Return W of multipliers (3, nc)."""
        return self._scaling.apply(multipliers[:, None])[:, 0]

    def divide(self, product: FloatArray) -> FloatArray:
        """Return what a step W^-1 dX + W dR must be for the products (3, nc) to change by `product`."""
        return self._scaling.divide(product[:, None])[:, 0]


class Linearisation(Scaled):
    """The matrices of the steps from one state, factorised."""

    def __init__(
        self,
        system: ContactSystem,
        forces: FloatArray,
        multipliers: FloatArray,
        rates: FloatArray,
        damping: float,
        released: BoolArray | None = None,
    ) -> None:
        """multipliers (3, nc): Z of the rates. released (nc,): points whose products fall by D = q, whatever E is.

        Raises
        ------
        NotDefiniteError
        """
        self._system, self._damping = system, damping
        scaling = system.scaling(forces, multipliers)
        super().__init__(scaling)
        rounded = np.maximum(system.roundness(rates), 1e-300)
        self._slope = np.stack([1.0 + system.settings.roundness**2 * rates[0] / rounded, rates[1] / rounded, rates[2] / rounded])
        plain = squared(scaling)
        # J = (1, 0, 0)^T slope^T + diag(0, 1, 1): W^2 J and J^T W^2 J.
        lower = np.array([0.0, 1.0, 1.0])
        mixed = plain[:, :1] * self._slope + plain * lower[None, :, None]
        both = self._slope[:, None] * mixed[0] + mixed * lower[:, None, None]
        # What D + E of a released point would add to the matrices is left out.
        self._bound = np.ones(system.points) if released is None else np.where(released, 0.0, 1.0)
        self._plain, self._mixed = plain / (1.0 + damping), self._bound * mixed / (1.0 + damping)
        both *= self._bound
        self._both = damping * (2.0 + damping) / (1.0 + damping) * both
        self._lever = system.factorise(0, self._plain)
        self._guess = system.factorise(1, (1.0 + damping) * both)
        self._stiffness, self._guess_work = float(system.live @ self._lever), float(system.live @ self._guess)

    def tangent(self, rates: FloatArray) -> FloatArray:
        """Return J of rates (3, nc)."""
        return np.stack([(self._slope * rates).sum(axis=0), rates[1], rates[2]])

    def step(self, target: FloatArray, residual: FloatArray, excess: float, pull: float) -> ContactState:
        """Return the step towards D + E = target (3, nc) that removes a residual (6 nf,) of the balance and an excess of work."""
        system, damping, live = self._system, self._damping, self._system.live
        wanted = self.scaled(target) / (1.0 + damping)
        raised = self._bound * (np.stack([np.zeros(system.points), wanted[1], wanted[2]]) + self._slope * wanted[0])
        free = self._solve(0, system.couple(wanted) + residual)
        idle = self._idle(free) - self._lever * (pull / self._stiffness)
        right = damping * system.couple(raised) + system.couple(multiply(self._mixed, system.rates(idle), True))
        y, crossed = self._velocities(right, excess)
        rates = system.rates(y)
        lack = free - crossed
        gain = (float(live @ lack) + pull) / self._stiffness
        u = system.rates(lack - self._lever * gain)
        forces = wanted - multiply(self._mixed, rates) - multiply(self._plain, u)
        load_factor = -gain
        # Brings the step into balance to rounding.
        more = self.balancing(system.couple(forces) + live * load_factor + residual)
        return ContactState(forces + more.forces, load_factor + more.load_factor, y, rates)

    def balancing(self, residual: FloatArray) -> ContactState:
        """Return the change of forces and load, smallest in the scaling, that removes a residual (6 nf,) of the balance."""
        system = self._system
        left = self._solve(0, residual)
        share = float(system.live @ left) / self._stiffness
        forces = -multiply(self._plain, system.rates(left - self._lever * share))
        return ContactState(forces, -share, np.zeros_like(residual), np.zeros_like(forces))

    def _velocities(self, right: FloatArray, excess: float) -> tuple[FloatArray, FloatArray]:
        """Return dy with H dy = right, f_L . dy = -excess, and A^-1 C dy (see `_hessian`), by conjugate gradients."""
        y = self._guess * (-excess / self._guess_work)
        left, crossed = right, np.zeros_like(right)
        if excess:
            bent, crossed = self._hessian(y)
            left = right - bent
        change = self._near(left)
        along, size = change, float(left @ change)
        goal = self._system.settings.inner**2 * size
        for _ in range(self._system.settings.inner_steps):
            if not size > goal:
                break
            bent, more = self._hessian(along)
            length = size / float(along @ bent)
            y, crossed, left = y + length * along, crossed + length * more, left - length * bent
            change = self._near(left)
            before, size = size, float(left @ change)
            along = change + (size / before) * along
        return y, crossed

    def _hessian(self, y: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return H y and A^-1 C y, with the matrix A of the forces and C = B W^2 J B^T, over 1 + damping."""
        system = self._system
        rates = system.rates(y)
        crossed = self._solve(0, system.couple(multiply(self._mixed, rates)))
        idle = system.rates(self._idle(crossed))
        return system.couple(multiply(self._both, rates) + multiply(self._mixed, idle, True)), crossed

    def _idle(self, u: FloatArray) -> FloatArray:
        """Return a solution with the matrix of the forces (6 nf,) as the one that does no work with the live load."""
        return u - self._lever * (float(self._system.live @ u) / self._stiffness)

    def _near(self, rows: FloatArray) -> FloatArray:
        """Return the solution without work of the live load with the matrix that stands for H."""
        found = self._solve(1, rows)
        return found - self._guess * (float(self._system.live @ found) / self._guess_work)

    def _solve(self, which: int, rows: FloatArray) -> FloatArray:
        return self._system.factors[which].solve(rows)


def squared(scaling: SecondOrderScaling) -> FloatArray:
    """Return W^2 (3, 3, nc) of a scaling."""
    w, square = scaling.w[:, 0], scaling.eta[0] ** 2
    blocks = 2.0 * w[:, None] * w[None]
    blocks[0, 0] -= 1.0
    blocks[1, 1] += 1.0
    blocks[2, 2] += 1.0
    return blocks * square


def multiply(blocks: FloatArray, v: FloatArray, transposed: bool = False) -> FloatArray:
    """Return blocks_ijk v_jk, or blocks_jik v_jk (3, nc)."""
    out = np.empty_like(v)
    _multiply(blocks, v, transposed, out)
    return out


@numba.njit(cache=True)
def _multiply(blocks: FloatArray, v: FloatArray, transposed: bool, out: FloatArray) -> None:
    """Write blocks_ijk v_jk, or blocks_jik v_jk, into out_ik."""
    for k in range(v.shape[1]):
        a, b, c = v[0, k], v[1, k], v[2, k]
        if transposed:
            for i in range(3):
                out[i, k] = blocks[0, i, k] * a + blocks[1, i, k] * b + blocks[2, i, k] * c
        else:
            for i in range(3):
                out[i, k] = blocks[i, 0, k] * a + blocks[i, 1, k] * b + blocks[i, 2, k] * c
