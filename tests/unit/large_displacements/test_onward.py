"""Where the motion of a step leads."""

from dataclasses import replace

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.large_displacements.moving_model import MovingModel, moving_model
from churchpipe.large_displacements.path import onward
from churchpipe.large_displacements.path_state import PathState, first_state
from churchpipe.large_displacements.settings import PATH
from churchpipe.large_displacements.state_program import state_program
from churchpipe.large_displacements.step import StepAnswer
from churchpipe.large_displacements.travelling import live_loads
from churchpipe.rigid_blocks.equilibrium import equilibrium
from solids import box, on_ground


def pushed() -> tuple[MovingModel, PathState]:
    """A block of 1 m on the ground, pushed along x."""
    stones = on_ground(box((0, 1), (0, 1), (0, 1)))
    contacts, load = cp.find_contacts(stones), cp.LoadCase((1, 0, 0))
    balance = equilibrium(stones, contacts, load)
    model = moving_model(stones, contacts, load, live_loads(stones, load), 0.4, balance, ~stones.fixed, 0.02, "auto")
    return model, first_state(model)


def test_a_misfit_is_a_share_of_the_load_factor_or_of_a_tenth_of_the_first_one() -> None:
    """Of a push that has nearly vanished a share tells nothing: an error of .1 % of the first load factor is 10 % of what is left
    when a hundredth is."""
    model, state = pushed()
    program = state_program(model, state)[1]
    assert program.least == PATH.least
    on_the_way = onward(model, replace(state, load_factor=0.4), np.zeros((2, 6)), 0.01, 0.0)
    further = onward(model, replace(on_the_way, load_factor=0.02), np.zeros((2, 6)), 0.01, 0.0)
    assert further.first == 0.4
    assert state_program(model, further)[1].least == pytest.approx(0.04)
    answer = StepAnswer("solved", np.zeros((4, 3)), 0.004, np.zeros(6), gap=0.0004, least=0.04)
    assert answer.misfit == pytest.approx(0.01)
    assert replace(answer, load_factor=0.4).misfit == pytest.approx(0.001)


@pytest.mark.parametrize(("last", "further"), [(0.01, 0.1), (0.02, 0.05), (0.005, 0.15), (1e-5, 0.15)])
def test_a_motion_goes_on_as_it_did_and_no_small_change_of_a_short_step_grows_large(last: float, further: float) -> None:
    """The block is a fifth faster than in the last step, and goes .01 m. Were that change continued at the rate of the last step
    however short this was, the block would go a hundred times too far after one of 1e-5 m."""
    model, state = pushed()
    velocity = np.zeros((2, 6))
    velocity[1, 0] = 1.0
    state = replace(state, before=0.8 * velocity, way=last)
    gone = onward(model, state, velocity, 0.01, 0.0).poses.centroid - state.poses.centroid
    assert gone[1] == pytest.approx([0.01 * (1 + further), 0, 0], rel=1e-9)
    assert further <= 0.5 * PATH.steady
