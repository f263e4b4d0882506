"""The interval of a mechanism and the weights of stage B, against programs stated otherwise."""

import numpy as np
import pytest
import scipy.sparse as sp

from churchpipe.conic.clarabel import solve_clarabel
from churchpipe.conic.polish import restore_balance
from churchpipe.conic.program import ConeProgram
from churchpipe.conic.solve import solver_for
from churchpipe.model.arrays import FloatArray
from churchpipe.rigid_blocks.associative import associative_program
from churchpipe.rigid_blocks.certificate import Strength, cone_violation
from churchpipe.rigid_blocks.coulomb import (
    CoulombState,
    bipotential_gap,
    coulomb_state,
    dead_load_start,
    gap_coefficients,
    gap_shares,
    nearest_forces,
    sliding_velocities,
)
from churchpipe.rigid_blocks.equilibrium import Equilibrium, equilibrium
from churchpipe.rigid_blocks.interval import mechanism_ends, mechanism_interval
from churchpipe.rigid_blocks.iterations import certified_iteration
from churchpipe.rigid_blocks.limit import point_strength
from churchpipe.stones.contacts import find_contacts
from models import FERRIS_TIN_LOI_LOAD as LOAD
from models import TILTING_LOADS as LOADS
from models import ferris_tin_loi_wall as wall
from models import tilting_test as model


def problem(name: str) -> tuple[Equilibrium, Strength]:
    """Balance and strength of a wall of Ferris and Tin-Loi, or of S5."""
    if name == "S5":
        stones, contacts = model("S5")
        balance = equilibrium(stones, contacts, LOADS["S5"])
        return balance, point_strength(contacts, 0.7, 0.0, balance.force)
    stones = wall(int(name))
    contacts = find_contacts(stones)
    balance = equilibrium(stones, contacts, LOAD)
    return balance, point_strength(contacts, 0.65, 0.0, balance.force)


def certified(balance: Equilibrium, strength: Strength) -> CoulombState:
    """The state of the canonical start."""
    run = certified_iteration(balance, strength, dead_load_start(balance), solver_for(balance.wrenches))
    assert run is not None
    return CoulombState(run.x, run.load_factor, run.y, run.gap)


def farthest(balance: Equilibrium, strength: Strength, state: CoulombState, sign: float) -> float:
    """The end of the interval by Clarabel: sum n (w + mu |v|) + t . v <= 1e-5 alpha."""
    rate = balance.rates(state.y / (balance.live @ state.y))
    slip = np.hypot(rate[:, 1], rate[:, 2])
    cost = np.column_stack([np.abs(rate[:, 0]) + strength.friction * slip, rate[:, 1:]])
    # The row in the size of the others: its right side as large as the largest load. The slack is a point of its own.
    size = float(np.abs(balance.dead).max()) / (1e-5 * state.load_factor)
    row = sp.hstack([sp.csr_matrix(size * cost.reshape(1, -1)), sp.csr_matrix([[1.0, 0.0, 0.0]])])
    rows = [sp.hstack([balance.wrenches.tocsc(), sp.csr_matrix((len(balance.dead), 3))]), row]
    zero = np.zeros(len(cost) + 1)
    program = ConeProgram(
        balance=sp.csc_matrix(sp.vstack(rows)),
        constant=np.append(balance.dead, 0.0),
        growth=np.append(sign * balance.live, -sign * size * 1e-5),
        limit=zero,
        slope=np.append(strength.friction, 0.0),
        linear=zero,
        quadratic=zero,
    )
    answer = solve_clarabel(program, duality_gap=1e-7)
    assert answer.outcome == "solved"
    return sign * answer.tau


MORE = pytest.mark.slow("docs/validation.md: intervals of mechanisms")


@pytest.mark.parametrize("name", ["1", "3", "4", *(pytest.param(name, marks=MORE) for name in ("2", "5", "6", "S5"))])
def test_ends_are_certified_and_as_far_apart_as_may_be(name: str) -> None:
    balance, strength = problem(name)
    state = certified(balance, strength)
    found = mechanism_ends(balance, strength, state)
    low, high = (end.load_factor for end in found)
    assert (low, high) == mechanism_interval(balance, strength, state)
    for end in found:
        # The certificate again, from the arrays alone.
        assert 0 <= bipotential_gap(balance, strength, end.x, end.y) <= 1.00001e-5 * end.load_factor
        assert np.abs(balance.residual(end.x, end.load_factor)).max() < 1e-8
        assert cone_violation(end.x, strength) < 1e-8
    ends = [farthest(balance, strength, state, sign) for sign in (-1.0, 1.0)]
    # They are attained, so they lie inside; by 1e-4 of the load factor at most.
    close = 1e-4 * state.load_factor
    assert ends[0] - 1e-6 <= low <= ends[0] + close
    assert ends[1] - close <= high <= ends[1] + 1e-6
    assert low <= state.load_factor <= high


def test_a_state_that_is_not_certified_has_the_gap_of_a_certified_one_beside_its_own() -> None:
    balance, strength = problem("4")
    solve = solver_for(balance.wrenches)
    answer = solve(associative_program(balance, strength), duality_gap=1e-6)
    state = coulomb_state(balance, strength, answer.x, answer.tau, solve)
    assert state is not None
    assert state.relative_gap > 1e-3
    low, high = mechanism_ends(balance, strength, state)
    assert low.load_factor < state.load_factor <= high.load_factor
    # Its forces may be the nearest to its motion that there are.
    assert low.relative_gap > state.relative_gap + 0.5e-5
    assert max(low.relative_gap, high.relative_gap) <= state.relative_gap + 1.00001e-5


def test_coefficients_of_the_gap() -> None:
    """With joints of any kind, cohesion and bounds: gap = coefficients . x + constant, for any forces within the bounds."""
    balance, strength = problem("4")
    random = np.random.default_rng(1)
    count = len(strength.friction)
    bound = np.where(random.random(count) < 0.5, 2.0, np.inf)
    strength = Strength(strength.friction, random.random(count), bound)
    n, angle = random.random(count), random.uniform(0.0, 2 * np.pi, count)
    shear = strength.shear(n) * random.random(count)
    x = np.column_stack([n, shear * np.cos(angle), shear * np.sin(angle)])
    y = random.normal(size=len(balance.dead))
    y *= np.sign(balance.live @ y)
    coefficients, constant = gap_coefficients(balance, strength, y)
    assert float((coefficients * x).sum()) + constant == pytest.approx(bipotential_gap(balance, strength, x, y), rel=1e-12)


def weighted(shares: FloatArray, excess: FloatArray) -> float:
    return float(((1.0 + excess) * shares).sum())


def test_stressed_velocities_are_the_best_for_the_weighted_gap() -> None:
    balance, strength = problem("6")
    solve = solver_for(balance.wrenches)
    # The associative forces: far from any state without dilatancy.
    program = associative_program(balance, strength)
    answer = solve(program)
    x, _ = restore_balance(program, answer.x, answer.tau)
    random = np.random.default_rng(7)
    n = np.maximum(x[:, 0], 0.0)
    excess = np.where(random.random(len(n)) < 0.1, 20.0, 0.0)
    first = sliding_velocities(balance, strength, n, solve)
    second = sliding_velocities(balance, strength, n, solve, stressed=(excess, x))
    assert first is not None
    assert second is not None
    before, after = (gap_shares(balance, strength, x, y) for y in (first, second))
    assert (before >= 0).all()
    assert before.sum() == pytest.approx(bipotential_gap(balance, strength, x, first), rel=1e-12)
    assert before.sum() > 1e-2
    assert before.sum() <= after.sum() * (1 + 1e-6)
    assert weighted(after, excess) < 0.95 * weighted(before, excess)


def test_weights_keep_a_state_without_gap() -> None:
    balance, strength = problem("4")
    state = certified(balance, strength)
    solve = solver_for(balance.wrenches)
    n = np.maximum(state.x[:, 0], 0.0)
    excess = np.random.default_rng(3).uniform(0.0, 50.0, len(n))
    y = sliding_velocities(balance, strength, n, solve, stressed=(excess, state.x))
    assert y is not None
    bound = weighted(gap_shares(balance, strength, state.x, state.y), excess)
    assert weighted(gap_shares(balance, strength, state.x, y), excess) <= bound + 1e-6
    assert bipotential_gap(balance, strength, state.x, y) <= bound + 1e-6


def test_excess_takes_forces_from_opening_joints() -> None:
    balance, strength = problem("6")
    state = certified(balance, strength)
    solve = solver_for(balance.wrenches)
    n = np.full(len(state.x), float(state.x[:, 0].mean()))
    rate = balance.rates(state.y)
    opening = np.maximum(rate[:, 0], 0.0)
    plain = nearest_forces(balance, strength, n, state.y, solve, nearness=0.1)
    stressed = nearest_forces(balance, strength, n, state.y, solve, nearness=0.1, excess=np.full(len(n), 10.0))
    assert plain is not None
    assert stressed is not None
    assert stressed.x[:, 0] @ opening < 0.5 * (plain.x[:, 0] @ opening)
