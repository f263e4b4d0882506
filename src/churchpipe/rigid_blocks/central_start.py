"""The first steps of the run from the centre: those of associative friction, until all points open and the load does unit work.

Far from a state it matters little which rates a force belongs to. Those of associative friction make a convex program, whose
interior point takes long steps from anywhere, and whose Newton matrix needs one factorisation. Rates in the middle of its cones
open faster than they slide, which is more than a point without dilatancy asks for. The steps are those of Mehrotra (1992), with
the centrality correctors of Gondzio (1996).
"""

from typing import NamedTuple

import numpy as np

from churchpipe.model.arrays import FloatArray
from churchpipe.rigid_blocks.central_steps import CENTRING, LEAST, SHORTER, SHORTEST, WIN, ahead_of, least_product, recentring
from churchpipe.rigid_blocks.contact_newton import ContactState, ContactSystem, Scaled, multiply, squared

# Steps at most, and the error of the work of the load after which the products follow from the rates.
_STEPS, _WORKS = 40, 0.1
# Sweeps that bring a step into balance to rounding.
_SWEEPS = 2


class _Step(NamedTuple):
    """A step of forces, load and velocities, and that of the multipliers (3, nc)."""

    move: ContactState
    multipliers: FloatArray


def first_rates(system: ContactSystem) -> ContactState:
    """Return a state whose points all open, near unit work: from multipliers of their own, which the rates approach.

    Raises
    ------
    NotDefiniteError
    """
    settings, points, unit = system.settings, system.points, system.unit
    at = ContactState(settings.force / points * unit, 0.0, np.zeros_like(system.live), np.zeros((3, points)))
    z = unit
    for _ in range(_STEPS):
        excess = float(system.live @ at.y) - 1.0
        if at.rates[0].min(initial=np.inf) > 0 and abs(excess) < _WORKS:
            break
        step, length = _advance(system, at, z, excess)
        at, z = at.plus(step.move, length), z + length * step.multipliers
    return at


def _advance(system: ContactSystem, at: ContactState, z: FloatArray, excess: float) -> tuple[_Step, float]:
    """Return the next step of forces and multipliers z (3, nc), and its length."""
    settings, points = system.settings, system.points
    matrix = _Matrix(system, at.forces, z)
    lack, residual = at.rates - z, system.residual(at)
    mean = float((at.forces * z).sum()) / points
    shift = matrix.scaled(lack)

    def towards(product: FloatArray) -> _Step:
        move = matrix.step(matrix.divide(product) - shift, residual, excess)
        return _Step(move, move.rates + lack)

    def longest(step: _Step, fraction: float = 1.0) -> float:
        steepest = max(system.reach(at.forces, step.move.forces), system.reach(z, step.multipliers))
        return min(1.0, fraction / max(steepest, 1e-3))

    products = system.product(matrix.point, matrix.point)
    affine = towards(-products)
    reach = longest(affine)
    target = max(1.0 / points, min(max((1.0 - reach) ** 3, CENTRING[0]), CENTRING[1]) * mean)
    both = system.product(matrix.scaled_forces(affine.move.forces), matrix.scaled(affine.multipliers))
    step = towards(target * system.unit - products - reach**2 * both)
    length = longest(step)
    for _ in range(settings.correctors):
        if length >= 1.0:
            break
        ahead = ahead_of(length)
        there = matrix.scaled_forces(at.forces + ahead * step.move.forces), matrix.scaled(z + ahead * step.multipliers)
        fix = recentring(system, system.product(*there), target)
        more = matrix.step(matrix.divide(fix), np.zeros_like(residual), 0.0)
        longer = _Step(step.move.plus(more), step.multipliers + more.rates)
        found = longest(longer)
        if found < length + WIN:
            break
        step, length = longer, found
    # A whole step leaves nothing of what the balance lacks.
    length = longest(step, settings.fraction)
    while least_product(system, at.forces + length * step.move.forces, z + length * step.multipliers) < LEAST:
        length *= SHORTER
        if length < SHORTEST:
            break
    return step, length


class _Matrix(Scaled):
    """The matrix of a step from one state, factorised: B W^2 B^T, W the Nesterov-Todd scaling of forces and multipliers."""

    def __init__(self, system: ContactSystem, forces: FloatArray, z: FloatArray) -> None:
        scaling = system.scaling(forces, z)
        super().__init__(scaling)
        self._system, self._square = system, squared(scaling)
        self._lever = system.factorise(0, self._square)
        self._stiffness = float(system.live @ self._lever)

    def step(self, target: FloatArray, residual: FloatArray, excess: float) -> ContactState:
        """Return the step W^-1 dX + W dR = target (3, nc) that removes a residual (6 nf,) and an excess of work."""
        system = self._system
        wanted = self.scaled(target)
        y = system.factors[0].solve(system.couple(wanted) + residual)
        load_factor = -(excess + float(system.live @ y)) / self._stiffness
        y += load_factor * self._lever
        rates = system.rates(y)
        forces = wanted - multiply(self._square, rates)
        for _ in range(_SWEEPS):
            left = system.factors[0].solve(system.couple(forces) + load_factor * system.live + residual)
            more = float(system.live @ left) / self._stiffness
            forces, load_factor = forces - multiply(self._square, system.rates(left - more * self._lever)), load_factor - more
        return ContactState(forces, load_factor, y, rates)
