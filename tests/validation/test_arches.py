"""Arches of straight-sided voussoirs.

Minimum thickness of the semicircle under its own weight, exact centroids: t/R = .107478 (Cocchetti and Rizzi 2020, R mean
radius); thresholds of the friction coefficient: .395832 for pure rotation, .309215 for any equilibrium (t/R = .200637).
Load factors of 27 voussoirs: independent calculations made for this project.
"""

import numpy as np
import pytest

from churchpipe.generators import arch
from churchpipe.model.loads import LoadCase
from churchpipe.model.results import LimitState
from churchpipe.rigid_blocks.limit import limit_analysis
from churchpipe.stones.blocks import derive_blocks
from churchpipe.stones.contacts import find_contacts


def push(thickness: float, friction: float, voussoirs: int = 27) -> LimitState:
    stones = derive_blocks(arch(mean_radius=1.0, thickness=thickness, width=1.0, voussoirs=voussoirs))
    return limit_analysis(stones, find_contacts(stones), LoadCase((1, 0, 0)), friction=friction)


@pytest.mark.parametrize(
    ("thickness", "friction", "expected"),
    [(0.2, 0.7, 0.284337), (0.15, 0.7, 0.145338), (0.15, 0.4, 0.052352), (0.2, 0.35, 0.045392)],
)
def test_load_factor(thickness: float, friction: float, expected: float) -> None:
    state = push(thickness, friction)
    assert state.status == "optimal"
    assert state.load_factor == pytest.approx(expected, abs=1e-6)
    assert state.upper_bound - state.lower_bound <= 1e-6 * state.load_factor


@pytest.mark.slow
def test_minimum_thickness_of_the_semicircle() -> None:
    # At the exact minimum the feasible set has no interior: alpha(t) is extrapolated to zero instead.
    thickness = np.array([0.109, 0.1105, 0.112])
    factors = [push(t, 0.7, voussoirs=400).load_factor for t in thickness]
    root = np.roots(np.polyfit(thickness, factors, 2))
    minimum = root[np.argmin(np.abs(root - 0.1075))]
    assert minimum == pytest.approx(0.107478, abs=2e-4)


@pytest.mark.parametrize(
    ("thickness", "friction", "status"),
    [
        (0.11, 0.40, "optimal"),
        (0.106, 0.70, "unstable"),
        (0.206, 0.312, "optimal"),
        (0.190, 0.312, "unstable"),
        (0.30, 0.300, "unstable"),
    ],
)
def test_thresholds_of_thickness_and_friction(thickness: float, friction: float, status: str) -> None:
    assert push(thickness, friction, voussoirs=100).status == status
