"""Starts near a solution: centred, quicker than others where they are near, and harmless where they are not."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from churchpipe.conic.cholesky import Cholesky
from churchpipe.conic.interior_point import InteriorPointSolver
from churchpipe.conic.interior_point import solver as solver_module
from churchpipe.conic.interior_point.coulomb import CoulombPoints
from churchpipe.conic.interior_point.warm import centred
from churchpipe.conic.program import ConeProgram, WarmStart
from churchpipe.conic.solve import Solve, solver_for
from churchpipe.model.arrays import FloatArray
from churchpipe.rigid_blocks.certificate import Strength
from churchpipe.rigid_blocks.coulomb import Near, nearest_forces, sliding_program, sliding_velocities
from churchpipe.rigid_blocks.equilibrium import Equilibrium, equilibrium
from churchpipe.rigid_blocks.iterations import SolveCount
from churchpipe.rigid_blocks.limit import point_strength
from cone_programs import KINDS_OF_POINTS, stated, three_stones
from models import TILTING_LOADS, tilting_test


@pytest.mark.parametrize(("limit", "slope"), [(0.0, 0.7), (0.3, 0.0), (0.0, 0.0), (0.2, 0.5)])
def test_a_start_is_inside_its_cones(limit: float, slope: float) -> None:
    # Forces on and outside the boundary, and multipliers of either sign.
    rng = np.random.default_rng(5)
    count = 200
    points = CoulombPoints(np.full(count, limit), np.full(count, slope), np.zeros(count), np.zeros(count))
    x, pull = rng.normal(size=(3, count)), rng.normal(size=(3, count))
    x[:, :50], pull[:, 25:75] = 0.0, 0.0
    found = centred(points, x, pull, 1e-4)
    assert (found[0] > 0).all()
    assert (np.hypot(found[1], found[2]) < limit + slope * found[0] + 1e-300).all() or not (limit or slope)


def test_a_centred_pair_stays() -> None:
    # s o z = mu e at both: |t| < mu n with z = mu s^-1, and the multipliers are those of these forces.
    rng = np.random.default_rng(6)
    count, mu = 100, 1e-3
    points = CoulombPoints(np.zeros(count), np.full(count, 0.6), np.zeros(count), np.zeros(count))
    x = np.stack([1.0 + rng.random(count), *(0.3 * rng.random((2, count)))])
    s = np.stack([0.6 * x[0], x[1], x[2]])
    z = mu * np.stack([s[0], -s[1], -s[2]]) / (s[0] ** 2 - s[1] ** 2 - s[2] ** 2)
    np.testing.assert_allclose(centred(points, x, np.stack([0.6 * z[0], z[1], z[2]]), mu), x, rtol=1e-9)


def tilted(test: str = "S5") -> tuple[Equilibrium, Strength, Solve, FloatArray]:
    """Return a tilting test, its solver, and normal forces that are as good as any to begin with."""
    stones, contacts = tilting_test(test)
    balance = equilibrium(stones, contacts, TILTING_LOADS[test])
    strength = point_strength(contacts, 0.7, 0.0, balance.force)
    solve = solver_for(balance.balance, "interior-point")
    found = solve(balance.program(strength.cohesion, strength.friction, strength.bound), duality_gap=1e-4)
    return balance, strength, solve, np.maximum(found.x[:, 0], 0.0)


@pytest.mark.slow
def test_forces_that_go_on_from_others_take_fewer_iterations() -> None:
    # Pairs of programs that come to rest: each finds velocities, and the forces that fit them, from those of the pair before.
    balance, strength, solve, n = tilted()
    fitting = partial(nearest_forces, balance, strength, solve=solve, nearness=3e-3, duality_gap=1e-3)
    x: FloatArray | None = None
    iterations: list[tuple[int, int]] = []
    for _ in range(5):
        y = sliding_velocities(balance, strength, n, solve, duality_gap=1e-3)
        assert y is not None
        cold, warm = fitting(n, y), fitting(n, y, x=x)
        assert cold is not None
        assert warm is not None
        assert warm.tau == pytest.approx(cold.tau, rel=1e-3)
        assert float(np.abs(balance.residual(warm.x, warm.tau)).max()) < 1e-12
        iterations.append((cold.iterations, warm.iterations))
        x, n = cold.x, np.maximum(cold.x[:, 0], 0.0)
    cold_ones, warm_ones = np.array(iterations[2:]).sum(axis=0)
    assert warm_ones <= 0.85 * cold_ones


def dissipation(program: ConeProgram, y: FloatArray) -> float:
    """Return the value that velocities y (m,) give their program, per unit work."""
    rates = program.rates(y / float(program.growth @ y))
    value = -float(program.constant @ y) / float(program.growth @ y)
    return value + float(program.limit @ np.hypot(rates[:, 1], rates[:, 2]))


def test_velocities_alone() -> None:
    # The value of their program is that of the whole one; the forces beside them are not asked for.
    balance, strength, solve, n = tilted()
    program = sliding_program(balance, strength, strength.shear(n))
    whole, alone = solve(program, duality_gap=1e-5), solve(program, duality_gap=1e-6, velocities=True)
    rates = program.rates(alone.y / float(program.growth @ alone.y))
    assert float(rates[:, 0].min()) > -1e-6 * float(np.abs(rates).max())
    assert dissipation(program, alone.y) == pytest.approx(whole.tau, rel=2e-5)


@pytest.mark.slow
def test_velocities_that_go_on_from_others_take_half_the_iterations() -> None:
    # The mechanisms of normal forces that have changed by a hundredth at random, from the one of before.
    balance, strength, solve, n = tilted()
    before = solve(sliding_program(balance, strength, strength.shear(n)), duality_gap=1e-3)
    from_nothing, from_before = SolveCount(solve), SolveCount(solve)
    find = partial(sliding_velocities, balance, strength, duality_gap=1e-3, alone=True)
    for seed in range(3, 9):
        changed = n * (1.0 + 0.01 * np.random.default_rng(seed).uniform(-1, 1, len(n)))
        cold, warm = find(changed, from_nothing), find(changed, from_before, near=Near(before.x, before.y))
        assert cold is not None
        assert warm is not None
        program = sliding_program(balance, strength, strength.shear(changed))
        assert dissipation(program, warm) == pytest.approx(dissipation(program, cold), rel=2e-3)
    assert from_before.iterations <= from_nothing.iterations / 2


def test_a_start_that_is_not_near_a_solution_is_given_up() -> None:
    # A thousandth of the normal forces holds so much less that another start is better.
    balance, strength, solve, n = tilted()
    before = solve(sliding_program(balance, strength, strength.shear(n)), duality_gap=1e-3)
    less = sliding_program(balance, strength, 1e-3 * strength.shear(n))
    near = WarmStart(before.x, before.tau, before.y, only=True)
    answer = solve(less, duality_gap=1e-3, near=near, velocities=True)
    assert answer.outcome == "failed"
    assert "no solution near the start" in answer.message
    assert answer.iterations < 20
    assert solve(less, duality_gap=1e-3, near=replace(near, only=False), velocities=True).outcome == "solved"


@pytest.mark.parametrize("kind", KINDS_OF_POINTS, ids=str)
def test_a_start_far_away_changes_nothing(kind: dict[str, float]) -> None:
    program = stated(three_stones(), **kind)
    rng = np.random.default_rng(7)
    solver = InteriorPointSolver(program.balance)
    cold = solver.solve(program)
    far = WarmStart(rng.normal(size=cold.x.shape), 50.0, rng.normal(size=cold.y.shape))
    warm = solver.solve(program, near=far)
    assert warm.outcome == cold.outcome
    if cold.outcome == "solved":
        assert warm.tau == pytest.approx(cold.tau, rel=2e-6)


@pytest.mark.parametrize(("only", "outcome"), [(False, "solved"), (True, "failed")])
def test_a_start_that_leads_nowhere_is_left_unless_nothing_else_is_to_be_tried(only: bool, outcome: str) -> None:
    program = stated(three_stones())
    rng = np.random.default_rng(7)
    x, y = rng.normal(size=(program.points, 3)), rng.normal(size=len(program.constant))
    near = WarmStart(1e6 * x, 50.0, y, only=only)
    assert InteriorPointSolver(program.balance).solve(program, near=near).outcome == outcome


@pytest.mark.parametrize("only", [False, True])
def test_a_start_that_leads_nowhere_is_paid_for(only: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    program = stated(three_stones())
    rng = np.random.default_rng(7)
    near = WarmStart(1e6 * rng.normal(size=(program.points, 3)), 50.0, rng.normal(size=len(program.constant)), only=only)
    solver = InteriorPointSolver(program.balance)
    cold = solver.solve(program)
    factorised: list[int] = []
    factor = Cholesky.factor_again
    monkeypatch.setattr(Cholesky, "factor_again", lambda matrix: (factorised.append(1), factor(matrix))[1])
    warm = solver.solve(program, near=near)
    assert warm.iterations == len(factorised)
    assert only or warm.iterations > cold.iterations


@pytest.mark.slow
def test_a_start_that_has_come_near_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    # From the iterate at which it stopped, where another one is begun anew.
    balance, strength, solve, n = tilted("S22")
    before = solve(sliding_program(balance, strength, strength.shear(n)), duality_gap=1e-3)
    changed = n * (1.0 + 0.01 * np.random.default_rng(3).uniform(-1, 1, len(n)))
    monkeypatch.setattr(solver_module, "WARM_ITERATIONS", 8)
    costs: list[int] = []
    for close in (0.0, 1.0):
        monkeypatch.setattr(solver_module, "CLOSE", close)
        count = SolveCount(solve)
        near = Near(before.x, before.y)
        assert sliding_velocities(balance, strength, changed, count, duality_gap=5e-7, alone=True, near=near) is not None
        costs.append(count.iterations)
    assert costs[0] > 8 + 1
    assert costs[1] <= costs[0] - 5


def test_a_loop_factorises_no_more_often_than_it_may(monkeypatch: pytest.MonkeyPatch) -> None:
    balance, strength, solve, n = tilted()
    before = solve(sliding_program(balance, strength, strength.shear(n)), duality_gap=1e-3)
    monkeypatch.setattr(solver_module, "WARM_ITERATIONS", 3)
    count = SolveCount(solve)
    near = Near(before.x, before.y, only=True)
    assert sliding_velocities(balance, strength, n, count, duality_gap=1e-6, alone=True, near=near) is None
    assert count.iterations == 3
