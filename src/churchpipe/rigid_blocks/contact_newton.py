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

(Levenberg 1944, Marquardt 1963). With B the balance, A = B W^2 B^T, M = B W^2 J B^T and K = B J^T W^2 J B^T its velocities y and
the multipliers u of the balance solve

    [ A   M                             ] [ u ]
    [ M^T  - damping (2 + damping) K    ] [ y ]  = given,  and the load does given work on both.

The matrix of a plain Newton step is neither symmetric nor definite, since the rates of a Coulomb point are no gradient. This one
is symmetric and quasidefinite: it has a factor in any order (`conic.multifrontal`), and
`contact_directions` has another way as well.
"""

import numpy as np

from churchpipe.conic.interior_point.second_order import SecondOrderScaling
from churchpipe.model.arrays import BoolArray, FloatArray
from churchpipe.rigid_blocks.contact_directions import Blocks, ExactDirections, GradientDirections
from churchpipe.rigid_blocks.contact_system import ContactState, ContactSystem, multiply


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
        system.factorise(system.balance, self._plain)
        self._lever = system.balance.solve(system.live)
        self._stiffness = float(system.live @ self._lever)
        blocks = Blocks(self._plain, self._mixed, both, damping * (2.0 + damping) / (1.0 + damping))
        gradients = system.settings.gradients
        self._directions = (
            GradientDirections(system, blocks, self._lever, 1.0 + damping) if gradients else ExactDirections(system, blocks)
        )

    def tangent(self, rates: FloatArray) -> FloatArray:
        """Return J of rates (3, nc)."""
        return np.stack([(self._slope * rates).sum(axis=0), rates[1], rates[2]])

    def step(self, target: FloatArray, residual: FloatArray, excess: float, pull: float) -> ContactState:
        """Return the step towards D + E = target (3, nc) that removes a residual (6 nf,) of the balance and an excess of work."""
        system, damping, live = self._system, self._damping, self._system.live
        wanted = self.scaled(target) / (1.0 + damping)
        raised = self._bound * (np.stack([np.zeros(system.points), wanted[1], wanted[2]]) + self._slope * wanted[0])
        rows = system.couple(wanted) + residual
        u, y, load_factor = self._directions.find(rows, damping * system.couple(raised), excess, pull)
        rates = system.rates(y)
        forces = wanted - multiply(self._mixed, rates) - multiply(self._plain, system.rates(u))
        # Brings the step into balance to rounding.
        more = self.balancing(system.couple(forces) + live * load_factor + residual)
        return ContactState(forces + more.forces, load_factor + more.load_factor, y, rates)

    def balancing(self, residual: FloatArray) -> ContactState:
        """Return the change of forces and load, smallest in the scaling, that removes a residual (6 nf,) of the balance."""
        system = self._system
        left = system.balance.solve(residual)
        share = float(system.live @ left) / self._stiffness
        forces = -multiply(self._plain, system.rates(left - self._lever * share))
        return ContactState(forces, -share, np.zeros_like(residual), np.zeros_like(forces))


def squared(scaling: SecondOrderScaling) -> FloatArray:
    """Return W^2 (3, 3, nc) of a scaling."""
    w, square = scaling.w[:, 0], scaling.eta[0] ** 2
    blocks = 2.0 * w[:, None] * w[None]
    blocks[0, 0] -= 1.0
    blocks[1, 1] += 1.0
    blocks[2, 2] += 1.0
    return blocks * square
