"""A step of a large model whose last forces lead nowhere: forces that fit the last motion, velocities that fit these."""

from dataclasses import replace

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.conic.solve import solver_for
from churchpipe.large_displacements.moving_model import MovingModel, moving_model
from churchpipe.large_displacements.path_state import PathState, first_state
from churchpipe.large_displacements.search import Attempt, StepSearch
from churchpipe.large_displacements.settings import EXACTING, THRIFTY
from churchpipe.large_displacements.state_program import step_program
from churchpipe.large_displacements.step import StepAnswer, StepProgram, fitting_forces, without_dilatancy
from churchpipe.large_displacements.travelling import live_loads
from churchpipe.model.arrays import FloatArray
from churchpipe.rigid_blocks.coulomb import nearest_forces, sliding_velocities
from churchpipe.rigid_blocks.equilibrium import equilibrium
from churchpipe.rigid_blocks.iterations import SolveCount
from solids import box, on_ground


def pushed() -> tuple[MovingModel, PathState]:
    """A block of 1 m on the ground, pushed along x, friction .4."""
    stones = on_ground(box((0, 1), (0, 1), (0, 1)))
    contacts, load = cp.find_contacts(stones), cp.LoadCase((1, 0, 0))
    balance = equilibrium(stones, contacts, load)
    model = moving_model(stones, contacts, load, live_loads(stones, load), 0.4, balance, ~stones.fixed, 0.02, "auto")
    return model, first_state(model)


def on_a_slope(side: float) -> tuple[StepProgram, FloatArray, FloatArray]:
    """The block with a dead load along y of so much of its weight, forces (4, 3) from before, and a motion along x."""
    model, state = pushed()
    program = step_program(model, state)
    along, across = np.eye(6)[:2]
    forces = np.tile([0.05, 0.01, 0.01], (4, 1))
    return replace(program, dead=program.dead + side * across), forces, along / float(program.live @ along)


def test_forces_that_fit_the_last_motion_lead_on() -> None:
    program, forces, last = on_a_slope(0.2)
    solve = SolveCount(solver_for(program.balance, "interior-point"))
    # The friction of the last forces, .08 of the weight, does not hold the load across.
    assert sliding_velocities(program, program.strength, forces[:, 0], solve, alone=True) is None
    given = StepAnswer("failed", forces, np.nan, last)
    assert without_dilatancy(program, given, solve, THRIFTY, 6, lambda *_: False) is given
    solve.solves = 0
    fitting = fitting_forces(program, given, solve)
    assert fitting.outcome == "failed"
    assert np.array_equal(fitting.y, last)
    found = without_dilatancy(program, fitting, solve, THRIFTY, 6, lambda *_: False)
    assert found.outcome == "solved"
    assert found.load_factor == pytest.approx(np.sqrt(0.4**2 - 0.2**2), rel=5e-3)
    assert found.misfit <= THRIFTY.fitting
    assert found.residual < 1e-8
    assert found.violation < 1e-8
    # One program for the forces, one for the velocities; the forces are kept.
    assert solve.solves == 2
    assert np.array_equal(found.forces, fitting.forces)


def test_where_no_forces_carry_the_stones_no_more_is_asked() -> None:
    program, forces, last = on_a_slope(0.5)
    answer = StepAnswer("failed", forces, np.nan, last)
    solve = SolveCount(solver_for(program.balance, "interior-point"))
    assert fitting_forces(program, answer, solve) is answer
    assert solve.solves == 1
    alone = solve.iterations
    assert nearest_forces(program, program.strength, forces[:, 0], last, solve, nearness=0.003, x=forces) is None
    # Elsewhere forces that cannot be reached from near by are sought from nothing as well.
    assert solve.iterations - alone > alone


def test_a_search_from_forces_that_fit_the_last_motion_ends_where_there_are_none() -> None:
    for side, outcome in ((0.2, "solved"), (0.5, "failed")):
        program, forces, last = on_a_slope(side)
        solve, gap = solver_for(program.balance, "interior-point"), np.zeros(len(forces))
        search = StepSearch(program, gap, solve, lambda _: 0.01, lambda *_: False, 0.01, 0.02, THRIFTY)
        begun = Attempt(StepAnswer("failed", forces, np.nan, last), 0.01)
        assert search.by_pairs(begun, 6).answer.outcome == "failed"
        assert search.fitted(begun, 6, None).answer.outcome == outcome


@pytest.mark.parametrize("large", [False, True])
def test_gaps_of_less_than_a_thousandth_of_the_step_are_closed_in_a_large_model(large: bool) -> None:
    model, state = pushed()
    model = replace(model, held=np.array([large, False]))
    demands = THRIFTY if large else EXACTING
    for gap, closed in ((1.9e-5, large), (2.1e-5, False)):
        joints = replace(state.joints, rest=state.joints.rest - gap)
        assert joints.at(state.poses)[1] == pytest.approx(gap)
        program = step_program(model, replace(state, joints=joints))
        assert bool((program.closing == 0.0).all()) is closed
    assert demands is model.demands


@pytest.mark.slow
def test_a_curve_that_goes_on_says_where_its_ties_broke_and_finds_the_place_as_closely() -> None:
    """Killed just before the tie breaks it knew the place to a whole step, and afterwards said that it broke where it went on."""
    stones = on_ground(box((0, 1), (0, 1), (0, 4)), reach=8)
    contacts, weight = cp.find_contacts(stones), stones.weight[1]
    rod = {"strength": 0.1 * weight, "stiffness": 20 * weight, "pretension": 0.02 * weight, "ultimate": 0.1}
    given = stones, contacts, cp.LoadCase((1, 0, 0)), 0.7, [cp.Tie("rod", (0, 0.5, 3.5), (-3, 0.5, 0), **rod)]
    kept: list[cp.BlockCapacityCurve] = []
    whole = cp.block_pushover(*given, step=0.05, steps=12, keep=kept.append)
    assert whole.message.endswith("tie rod broke at a displacement of 66.7 mm")
    for part in kept[:-1]:
        again = cp.block_pushover(*given, step=0.05, steps=12, resume=part)
        np.testing.assert_allclose(again.displacement, whole.displacement, atol=1e-9)
        np.testing.assert_allclose(again.load_factor, whole.load_factor, atol=1e-9)
        assert again.message.endswith("tie rod broke at a displacement of 66.7 mm")
