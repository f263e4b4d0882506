"""How far a run from the centre goes before it is left, and that it goes on from there."""

from itertools import pairwise

import numpy as np
import pytest

from churchpipe.model.arrays import BoolArray
from churchpipe.model.loads import LoadCase
from churchpipe.rigid_blocks import central_descent
from churchpipe.rigid_blocks.central_descent import Descent, falls_too_slowly, steps_left
from churchpipe.rigid_blocks.central_steps import Move
from churchpipe.rigid_blocks.contact_newton import ContactState, ContactSystem
from churchpipe.rigid_blocks.equilibrium import equilibrium
from churchpipe.rigid_blocks.limit import point_strength
from churchpipe.rigid_blocks.settings import CentralSettings
from models import facade


@pytest.mark.parametrize(("share", "most", "released"), [(0.5, 3, 0), (0.01, 100_000, 0), (0.5, 3, 2)])
def test_a_share_of_the_points_stops_short_but_no_more_than_a_few(
    monkeypatch: pytest.MonkeyPatch, share: float, most: int, released: int
) -> None:
    found: list[int] = []

    def blocked(_: ContactSystem, at: ContactState, __: float, ignored: int, ___: BoolArray | None) -> Move:
        found.append(ignored)
        return Move(at, 1.0, 0.1, released, np.zeros(at.forces.shape[1], bool))

    stones, contacts = facade("small")
    balance = equilibrium(stones, contacts, LoadCase((1, 0, 0)))
    strength = point_strength(contacts, 0.7, 0.0, balance.force)
    monkeypatch.setattr(central_descent, "advance", blocked)
    descent = Descent(balance, strength, 1e-5, CentralSettings(ignored=share, most_ignored=most, steps=6), short=True)
    while descent.lower():
        pass
    few = 3 if most == 3 else len(strength.friction) // 100
    # Later where points were released, which may free the others.
    begun = CentralSettings().held[released > 0]
    assert found == [0] * begun + [few] * (6 - begun)


def test_points_are_released_after_short_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    lengths = [0.5, 0.1, 0.1, 0.6, 0.1]
    kept = np.zeros(0, bool)
    found: list[bool] = []

    def stepped(_: ContactSystem, at: ContactState, __: float, ___: int, given: BoolArray | None) -> Move:
        found.append(given is kept)
        return Move(at, 1.0, lengths[len(found) - 1], 0, kept)

    stones, contacts = facade("small")
    balance = equilibrium(stones, contacts, LoadCase((1, 0, 0)))
    monkeypatch.setattr(central_descent, "advance", stepped)
    strength = point_strength(contacts, 0.7, 0.0, balance.force)
    descent = Descent(balance, strength, 1e-5, CentralSettings(steps=5), short=True)
    while descent.lower():
        pass
    assert found == [False, False, True, True, False]


@pytest.mark.parametrize(("fall", "left"), [(0.4, False), (0.8, True)])
def test_a_run_is_left_where_programs_would_close_it_sooner(fall: float, left: bool) -> None:
    """At gaps below a thousandth, from which one pair of programs closes it."""
    settings = CentralSettings()
    gaps = [2e-3 * fall**step for step in range(-4, 2)]
    assert not falls_too_slowly(gaps[:-2], 1e-5, settings)
    near = [0.5 * gap for gap in gaps]
    assert falls_too_slowly(near, 1e-5, settings) is left
    assert not falls_too_slowly(near, 0.9 * near[-1] / fall, settings)
    assert not falls_too_slowly(near[-2:], 1e-5, settings)


def test_the_steps_that_are_left_follow_from_the_last_three() -> None:
    gaps = [1.0, 8e-3, 4e-3, 2e-3, 1e-3]
    assert steps_left(gaps, 1e-3 / 2**5) == pytest.approx(5.0)
    assert np.isinf(steps_left(gaps[-3:], 1e-5))
    assert np.isinf(steps_left([1e-3, 2e-3, 1e-3, 1e-3], 1e-5))


def test_a_run_that_was_left_goes_on_from_where_it_was(monkeypatch: pytest.MonkeyPatch) -> None:
    """Left whenever it may be: at gaps that each are a tenth of the one before, and it arrives all the same."""
    stones, contacts = facade("small")
    balance = equilibrium(stones, contacts, LoadCase((1, 0, 0)))
    strength = point_strength(contacts, 0.7, 0.0, balance.force)
    straight = Descent(balance, strength, 1e-5, CentralSettings(), short=True)
    assert not straight.lower()
    monkeypatch.setattr(central_descent, "falls_too_slowly", lambda gaps, wanted, _: wanted < gaps[-1] <= 1e-2)
    descent, left = Descent(balance, strength, 1e-5, CentralSettings(), short=True), []
    while descent.lower():
        assert descent.nearest is not None
        left.append(descent.nearest.relative_gap)
    assert len(left) >= 2
    assert left[0] <= 1e-2
    assert all(later <= 0.1 * earlier for earlier, later in pairwise(left))
    assert descent.factorisations == straight.factorisations
    assert descent.run is not None
    assert straight.run is not None
    assert descent.run.load_factor == straight.run.load_factor
    assert descent.run.relative_gap <= 1e-5
