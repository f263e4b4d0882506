"""A motion that nothing can hold is known by its work, though the solver that found it did not quite prove it."""

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.conic.solve import solver_for
from churchpipe.large_displacements.moving_model import moving_model
from churchpipe.large_displacements.path import first_state, step_program
from churchpipe.large_displacements.step import StepProgram, falls, solve_step
from churchpipe.large_displacements.travelling import live_loads
from churchpipe.rigid_blocks.equilibrium import equilibrium
from solids import box, on_ground


def overhanging(out: float) -> StepProgram:
    """A block of 1 m, pushed sideways, whose centroid lies beyond the edge below where it stands out by more than half."""
    stones = on_ground(box((0, 1), (0, 1), (0, 1)), box((0, 1), (out, out + 1), (1, 1.5)))
    contacts, load = cp.find_contacts(stones), cp.LoadCase((1, 0, 0))
    balance, moving = equilibrium(stones, contacts, load), np.array([False, True, True])
    model = moving_model(stones, contacts, load, live_loads(stones, load), 0.6, balance, moving, None, "auto")
    return step_program(model, first_state(model))


def test_a_block_beyond_the_edge_falls() -> None:
    program = overhanging(0.6)
    answer = solve_step(program, np.zeros(len(program.closing)), solver_for(program.balance))
    assert answer.outcome == "infeasible"
    y = answer.y / float(program.dead @ answer.y)
    assert falls(program, y)
    # Nearly proved is enough, the other way round or roughly is not.
    noise = np.random.default_rng(0).normal(size=len(y)) * np.abs(y).max()
    assert falls(program, y + 1e-5 * noise)
    assert not falls(program, y + 0.1 * noise)
    assert not falls(program, -y)
    assert not falls(program, 0.0 * y)


@pytest.mark.parametrize("seed", range(5))
def test_no_motion_of_a_block_that_stands_is_a_fall(seed: int) -> None:
    program = overhanging(0.3)
    assert not falls(program, np.random.default_rng(seed).normal(size=len(program.dead)))
