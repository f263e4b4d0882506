"""Joists that lose their seats: a rocking block of 1 x 4 m that draws a joist away from what it rests on, by plane geometry.

The block turns about its toe by theta. The end of the joist, 3.5 m up at its back, and the centroid, 2 m up, go where that turn
takes them; the joist falls where the distance of its ends has grown by its bearing length.
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

import churchpipe as cp
from churchpipe.code_check import Site
from churchpipe.displacement_check import displacement_check
from churchpipe.large_displacements.seats import lost_seat
from churchpipe.model.stone_path import FallenStones
from churchpipe.spectrum import SiteSpectrum
from solids import box, on_ground

STONES = on_ground(box((0, 1), (0, 1), (0, 4)), reach=8)
CONTACTS = cp.find_contacts(STONES)
PUSH = cp.LoadCase((1, 0, 0))
WEIGHT = STONES.weight[1]
SITE = Site(1.5, spectrum=SiteSpectrum(amplification=2.5, start=0.5, soil="B"))


def joist(seat: float, *, seated: bool = True) -> cp.Tie:
    strength, stiffness = 0.02 * WEIGHT, 5 * WEIGHT
    return cp.Tie("j", (0, 0.5, 3.5), (-3, 0.5, 0), strength=strength, stiffness=stiffness, ultimate=seat, seated=seated)


def turned(theta: float, x: float, z: float) -> tuple[float, float]:
    """Return where a point is when the block has turned about its toe (1, 0)."""
    return 1 + (x - 1) * np.cos(theta) + z * np.sin(theta), z * np.cos(theta) - (x - 1) * np.sin(theta)


def displacement_at(seat: float) -> float:
    """Return how far the centroid has gone where the joist has become longer by its seat, m."""
    drawn = np.hypot(3, 3.5)

    def left(theta: float) -> float:
        x, z = turned(theta, 0, 3.5)
        return np.hypot(x + 3, z) - drawn - seat

    return turned(brentq(left, 0, 0.24), 0.5, 2)[0] - 0.5


@pytest.mark.slow("docs/displacement_check.md: lost seats")
@pytest.mark.parametrize("seat", [0.05, 0.1, 0.2, 0.35])
def test_no_limit_state_goes_beyond_a_lost_seat(seat: float) -> None:
    curve = cp.block_pushover(STONES, CONTACTS, PUSH, 0.7, [joist(seat)], step=0.02)
    lost = lost_seat(curve, STONES, [joist(seat)])
    assert lost is not None
    at = float(np.interp(lost.step, np.arange(len(curve.displacement)), curve.displacement))
    assert at == pytest.approx(displacement_at(seat), abs=2e-4)
    check = displacement_check(curve, STONES, PUSH, SITE, seat=lost)
    free = displacement_check(curve, STONES, PUSH, SITE)
    for name, share in (("SLV", 0.4), ("SLC", 0.6)):
        assert free.limit_states[name].displacement == pytest.approx(share * check.d0, rel=1e-9)
        assert check.limit_states[name].displacement == pytest.approx(min(share * check.d0, at), rel=1e-9)
        assert check.limit_states[name].a_g <= free.limit_states[name].a_g
    assert check.lost_seat.startswith(f"Joist j loses its seat at {1e3 * at:.3g} mm")
    assert free.lost_seat == ""


@pytest.mark.slow
def test_ties_that_are_no_joists_and_joists_that_hold_lose_no_seat() -> None:
    curve = cp.block_pushover(STONES, CONTACTS, PUSH, 0.7, [joist(0.1, seated=False)], step=0.05)
    assert lost_seat(curve, STONES, [joist(0.1, seated=False)]) is None
    assert lost_seat(curve, STONES, [joist(np.inf)]) is None
    assert lost_seat(curve, STONES, []) is None
    assert lost_seat(curve.until(1), STONES, [joist(0.3)]) is None


def test_a_joist_falls_with_a_stone_that_bears_it() -> None:
    curve = cp.block_pushover(STONES, CONTACTS, PUSH, 0.7, [joist(np.inf)], step=0.05, steps=6)
    fallen = replace(curve, fallen=(FallenStones(float(curve.displacement[3]), np.array([1]), 3),))
    lost = lost_seat(fallen, STONES, [joist(np.inf)])
    assert lost is not None
    assert (lost.joist, lost.step) == ("j", 3.0)
