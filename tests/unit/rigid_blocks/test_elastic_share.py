"""What an elastic tie adds to the gap of forces and velocities without dilatancy."""

import numpy as np
import pytest
import scipy.sparse as sp

from churchpipe.large_displacements.step import StepProgram
from churchpipe.model.arrays import FloatArray
from churchpipe.rigid_blocks.certificate import Strength
from churchpipe.rigid_blocks.coulomb import elastic_pull, gap_shares

STRENGTH = 1.5
MOTION = np.ones(1)


def ties(stretch: FloatArray, softness: float) -> StepProgram:
    """A program of ties alone (nt,), which `MOTION` lengthens at these rates."""
    zero = np.zeros_like(stretch)
    shorter = np.column_stack([-stretch, zero, zero]).reshape(1, -1)
    strength = Strength(zero, zero, zero + STRENGTH)
    return StepProgram(sp.csc_matrix(shorter), np.zeros(1), np.ones(1), strength, zero, len(stretch), 1, zero + softness)


def shares(program: StepProgram, tension: FloatArray) -> FloatArray:
    zero = np.zeros_like(tension)
    return gap_shares(program, program.strength, np.column_stack([tension, zero, zero]), MOTION)


@pytest.mark.parametrize("softness", [0.2, 3.0])
def test_the_share_is_what_the_tension_misses_of_fenchels_equality(softness: float) -> None:
    """Energy of the tension plus its conjugate at the stretch, less their product; the conjugate by a fine grid of tensions."""
    rng = np.random.default_rng(3)
    tension, stretch = rng.uniform(0, STRENGTH, 40), rng.uniform(-2, 6, 40)
    every = np.linspace(0, STRENGTH, 200_001)
    conjugate = np.array([(every * each - 0.5 * softness * every**2).max() for each in stretch])
    expected = 0.5 * softness * tension**2 + conjugate - tension * stretch
    found = shares(ties(stretch, softness), tension)
    assert found == pytest.approx(expected, abs=1e-9)
    assert (found >= 0).all()


def test_a_tie_adds_nothing_where_it_pulls_as_it_lengthens() -> None:
    """It is slack where it shortens, pulls by stretch over softness, and by no more than its strength."""
    program = ties(np.array([-1.0, 0.5, 9.0]), 2.0)
    pull = elastic_pull(program, program.strength, program.rates(MOTION))
    assert pull == pytest.approx([0.0, 0.25, STRENGTH])
    assert shares(program, pull) == pytest.approx(np.zeros(3), abs=1e-15)
