"""A damped Newton step against the least-squares problem that it solves, written out and solved densely."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from churchpipe.model.arrays import FloatArray
from churchpipe.model.loads import LoadCase
from churchpipe.rigid_blocks.central_start import first_rates
from churchpipe.rigid_blocks.central_steps import advance
from churchpipe.rigid_blocks.contact_newton import ContactState, ContactSystem, Linearisation
from churchpipe.rigid_blocks.equilibrium import equilibrium
from churchpipe.rigid_blocks.limit import point_strength
from churchpipe.rigid_blocks.settings import CentralSettings
from churchpipe.stones.contacts import find_contacts
from solids import box, on_ground

DAMPING, PULL, EXCESS = 0.03, 0.4, 0.1


@pytest.fixture(scope="module")
def system() -> ContactSystem:
    courses = ((0.0, 2.0, 4.0), (0.0, 1.0, 3.0, 4.0), (0.0, 2.0, 4.0))
    bricks = [
        box((left, right), (0.0, 1.0), (0.5 * course, 0.5 * course + 0.5))
        for course, joints in enumerate(courses)
        for left, right in pairwise(joints)
    ]
    stones = on_ground(*bricks)
    contacts = find_contacts(stones)
    balance = equilibrium(stones, contacts, LoadCase((1, 0, 0)))
    exact = replace(CentralSettings(), inner=1e-7, inner_steps=100)
    return ContactSystem(balance, point_strength(contacts, 0.7, 0.0, balance.force), exact)


@pytest.fixture(scope="module")
def at(system: ContactSystem) -> ContactState:
    state = first_rates(system)
    for _ in range(2):
        state = advance(system, state, 0.01, 0).at
    return state


def matrices(system: ContactSystem, linear: Linearisation) -> tuple[FloatArray, FloatArray, FloatArray]:
    """W^-1 of forces, W J B^T of velocities, and B of forces, as dense matrices; forces component first."""
    size = 3 * system.points
    inverse = np.stack([linear.scaled_forces(unit.reshape(3, -1)).ravel() for unit in np.eye(size)], axis=1)
    rates = [linear.scaled(linear.tangent(system.rates(unit))).ravel() for unit in np.eye(len(system.live))]
    balance = np.stack([system.couple(unit.reshape(3, -1)) for unit in np.eye(size)], axis=1)
    return inverse, np.stack(rates, axis=1), balance


def test_steps_are_those_of_the_damped_least_squares(system: ContactSystem, at: ContactState) -> None:
    linear = Linearisation(system, at.forces, system.multipliers(at.rates), at.rates, DAMPING)
    inverse, onto, balance = matrices(system, linear)
    size, rows = inverse.shape[0], len(system.live)
    random = np.random.default_rng(3)
    # min 1/2 |D + E - q|^2 + 1/2 damping (|D|^2 + |E|^2) + pull dalpha, D = W^-1 dX, E = W J B^T dy, by its Lagrangian.
    both = np.hstack([inverse, onto, np.zeros((size, 1))])
    alone = np.zeros((2, size, both.shape[1]))
    alone[0, :, :size], alone[1, :, size:-1] = inverse, onto
    hessian = both.T @ both + DAMPING * sum(part.T @ part for part in alone)
    bound = np.zeros((rows + 1, both.shape[1]))
    bound[:rows, :size], bound[:rows, -1], bound[rows, size:-1] = balance, system.live, system.live
    whole = np.block([[hessian, bound.T], [bound, np.zeros((rows + 1, rows + 1))]])
    # Later steps reuse the directions of the first.
    for _ in range(3):
        target, residual = random.normal(size=(3, system.points)), 1e-3 * random.normal(size=rows)
        linear_part = both.T @ target.ravel()
        linear_part[-1] -= PULL
        found = np.linalg.lstsq(whole, np.concatenate([linear_part, -residual, [-EXCESS]]), rcond=1e-15)[0]
        step = linear.step(target, residual, EXCESS, PULL)
        assert np.abs(system.couple(step.forces) + step.load_factor * system.live + residual).max() < 1e-10
        assert float(system.live @ step.y) == pytest.approx(-EXCESS, rel=1e-9)
        for name, ours, dense in (
            ("D", linear.scaled_forces(step.forces).ravel(), inverse @ found[:size]),
            ("E", linear.scaled(linear.tangent(step.rates)).ravel(), onto @ found[size : size + rows]),
        ):
            assert np.abs(ours - dense).max() < 1e-6 * np.abs(dense).max(), name
        assert step.load_factor == pytest.approx(found[size + rows], rel=1e-6)


def test_directions_tried_for_one_right_side_serve_the_next(system: ContactSystem, at: ContactState) -> None:
    linear = Linearisation(system, at.forces, system.multipliers(at.rates), at.rates, DAMPING)
    target, nothing = np.random.default_rng(4).normal(size=(3, system.points)), np.zeros(len(system.live))
    solves = [0]
    factor = system.factors[0].solve

    def counted(right: FloatArray) -> FloatArray:
        solves[0] += 1
        return factor(right)

    system.factors[0].solve = counted
    try:
        first = linear.step(target, nothing, 0.0, 0.0)
        once, solves[0] = solves[0], 0
        again = linear.step(2.0 * target, nothing, 0.0, 0.0)
    finally:
        del system.factors[0].solve
    assert np.abs(again.y - 2.0 * first.y).max() < 1e-6 * np.abs(again.y).max()
    # What is left are those of the target and of the balance.
    assert (once > 4, solves[0]) == (True, 2)
