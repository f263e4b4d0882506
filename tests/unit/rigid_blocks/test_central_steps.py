"""Steps of the run from the centre in which a few points stop short, or are released from their rates."""

from dataclasses import replace

import numpy as np
import pytest

from churchpipe.conic.interior_point.second_order import SecondOrder
from churchpipe.model.arrays import FloatArray
from churchpipe.model.loads import LoadCase
from churchpipe.rigid_blocks.central_start import first_rates
from churchpipe.rigid_blocks.central_steps import advance, least_product, left_behind
from churchpipe.rigid_blocks.contact_newton import ContactState, ContactSystem, Linearisation
from churchpipe.rigid_blocks.equilibrium import equilibrium
from churchpipe.rigid_blocks.limit import point_strength
from churchpipe.rigid_blocks.settings import CentralSettings
from models import facade


@pytest.fixture(scope="module")
def system() -> ContactSystem:
    stones, contacts = facade("small")
    balance = equilibrium(stones, contacts, LoadCase((1, 0, 0)))
    return ContactSystem(balance, point_strength(contacts, 0.7, 0.0, balance.force), CentralSettings())


@pytest.fixture(scope="module")
def beginning(system: ContactSystem) -> ContactState:
    """A state whose points all open, eight steps on, where a few points hold the next one."""
    at = first_rates(system)
    for _ in range(8):
        at = advance(system, at, 0.01, 0).at
    return at


def smallest(vectors: FloatArray) -> float:
    return SecondOrder(3, 1, vectors.shape[1]).margin(vectors[:, None])


def test_a_change_of_forces_gives_the_balance_back(system: ContactSystem, beginning: ContactState) -> None:
    at = replace(beginning, load_factor=1.1 * beginning.load_factor)
    linear = Linearisation(system, at.forces, system.multipliers(at.rates), at.rates, 0.01)
    left = system.residual(at)
    assert np.abs(left).max() > 1e-4
    assert np.abs(system.residual(at.plus(linear.balancing(left)))).max() < 1e-9 * np.abs(left).max()


def test_points_that_stop_short_let_a_step_go_farther(system: ContactSystem, beginning: ContactState) -> None:
    few = system.points // 50
    plain, long = advance(system, beginning, 0.01, 0), advance(system, beginning, 0.01, few)
    assert long.length > 1.1 * plain.length
    # All forces are inside their cones and all points open, whatever the length.
    for move in (plain, long):
        assert smallest(move.at.forces) > 0
        assert move.at.rates[0].min() > 0
    # The rates of a plain step are those of its velocities, of a long one but for a few points.
    lack = [np.abs(system.rates(move.at.y) - move.at.rates).max(axis=0) / np.abs(move.at.rates).max() for move in (plain, long)]
    assert lack[0].max() < 1e-9
    assert 0 <= (lack[1] > 1e-9).sum() <= few
    # Forces that stop short take little of the balance: less than the heaviest stone weighs.
    assert np.abs(system.residual(plain.at)).max() < 1e-9
    assert np.abs(system.residual(long.at)).max() < np.abs(system.dead).max()


def test_rates_that_stopped_short_are_caught_up_with(system: ContactSystem, beginning: ContactState) -> None:
    rates = beginning.rates.copy()
    rates[:, :5] *= 1.5
    at = replace(beginning, rates=rates)
    move = advance(system, at, 0.01, 5)
    before, after = (np.abs(system.rates(each.y) - each.rates)[:, :5].max() for each in (at, move.at))
    assert 0 < after < before


def lagging(beginning: ContactState, point: int) -> ContactState:
    """The state with rates at a point that make its product thirty times what it was."""
    rates = beginning.rates.copy()
    rates[:, point] *= 30.0
    return replace(beginning, rates=rates)


def test_a_point_with_a_large_product_is_left_behind(system: ContactSystem, beginning: ContactState) -> None:
    assert not left_behind(system, beginning).any()
    assert np.flatnonzero(left_behind(system, lagging(beginning, 20))).tolist() == [20]


def test_a_released_point_falls_by_its_force(system: ContactSystem, beginning: ContactState) -> None:
    at, nothing = lagging(beginning, 20), np.zeros(system.points, bool)
    plain, released = advance(system, at, 0.01, 5), advance(system, at, 0.01, 5, nothing)
    assert (plain.released, released.released) == (0, 1)
    before, with_rate, alone = (each.forces[0, 20] for each in (at, plain.at, released.at))
    assert alone < with_rate
    assert alone < before
    assert smallest(released.at.forces) > 0
    assert released.at.rates[0].min() > 0


def test_a_point_that_is_kept_is_not_released(system: ContactSystem, beginning: ContactState) -> None:
    at = lagging(beginning, 20)
    move = advance(system, at, 0.01, 5, left_behind(system, at))
    assert move.released == 0
    assert np.flatnonzero(move.kept).tolist() == [20]
    assert np.array_equal(move.at.forces, advance(system, at, 0.01, 5).at.forces)


def test_where_nothing_is_left_behind_a_step_is_as_without(system: ContactSystem, beginning: ContactState) -> None:
    plain, same = (advance(system, beginning, 0.01, 0, kept) for kept in (None, np.zeros(system.points, bool)))
    assert np.array_equal(plain.at.forces, same.at.forces)


def test_the_least_products_may_be_left_out(system: ContactSystem) -> None:
    forces, z = np.zeros((2, 3, system.points))
    forces[0] = z[0] = 1.0
    forces[0, :3] = 1e-6, 1e-5, 1e-4
    found = [least_product(system, forces, z, ignored) for ignored in range(4)]
    assert found == pytest.approx(np.array([1e-6, 1e-5, 1e-4, 1.0]), rel=5e-3)
