"""What an elastic tie adds to the gap of forces and velocities without dilatancy."""

from dataclasses import dataclass

import numpy as np
import pytest

from churchpipe.rigid_blocks.certificate import Strength
from churchpipe.rigid_blocks.coulomb import elastic_pull, gap_shares


@dataclass(frozen=True)
class _Ties:
    """Ties alone, which lengthen at given rates (nt,)."""

    stretch: np.ndarray
    softness: np.ndarray

    @property
    def live(self) -> np.ndarray:
        return np.ones(1)

    @property
    def points(self) -> int:
        return len(self.stretch)

    def rates(self, _y: np.ndarray) -> np.ndarray:
        return np.column_stack([-self.stretch, np.zeros((len(self.stretch), 2))])


_STRENGTH = 1.5


def _shares(tension: np.ndarray, stretch: np.ndarray, softness: float) -> np.ndarray:
    zero = np.zeros_like(stretch)
    ties, strength = _Ties(stretch, zero + softness), Strength(zero, zero, zero + _STRENGTH)
    return gap_shares(ties, strength, np.column_stack([tension, zero, zero]), np.ones(1))  # type: ignore[arg-type]


@pytest.mark.parametrize("softness", [0.2, 3.0])
def test_the_share_is_what_the_tension_misses_of_fenchels_equality(softness: float) -> None:
    """Energy of the tension plus its conjugate at the stretch, less their product; the conjugate by a fine grid of tensions."""
    rng = np.random.default_rng(3)
    tension, stretch = rng.uniform(0, _STRENGTH, 40), rng.uniform(-2, 6, 40)
    every = np.linspace(0, _STRENGTH, 200_001)
    conjugate = np.array([(every * each - 0.5 * softness * every**2).max() for each in stretch])
    expected = 0.5 * softness * tension**2 + conjugate - tension * stretch
    assert _shares(tension, stretch, softness) == pytest.approx(expected, abs=1e-9)
    assert (_shares(tension, stretch, softness) >= 0).all()


def test_a_tie_adds_nothing_where_it_pulls_as_it_lengthens() -> None:
    """It is slack where it shortens, pulls by stretch over softness, and by no more than its strength."""
    stretch, softness = np.array([-1.0, 0.5, 9.0]), 2.0
    zero = np.zeros(3)
    ties, strength = _Ties(stretch, zero + softness), Strength(zero, zero, zero + _STRENGTH)
    pull = elastic_pull(ties, strength, ties.rates(np.ones(1)))  # type: ignore[arg-type]
    assert pull == pytest.approx([0.0, 0.25, _STRENGTH])
    assert _shares(pull, stretch, softness) == pytest.approx(zero, abs=1e-15)
