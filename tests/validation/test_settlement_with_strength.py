"""Supports that move under stones that crush, and whose friction resists torsion as uniform pressure does.

Beam on two bearings: each is pressed in a strip along its edge, as wide as its force over the compressive strength. Pad that
turns under a block: uniform pressure p on a square of side a resists mu p times the integral of the distance from its middle,
mu W a (sqrt 2 + asinh 1) / 6 = .382598 mu W a; friction at its corners mu W a / sqrt 2.
"""

import numpy as np
import pytest
from scipy.optimize import brentq

import churchpipe as cp
from solids import box

BEAM = cp.Assemblage.from_polyhedra(
    [box((0, 0.5), (0, 1), (0, 1)), box((3.5, 4), (0, 1), (0, 1)), box((0, 4), (0, 1), (1, 1.5))], 18e3, fixed=[0, 1]
)
WEIGHT, STRENGTH = 36e3, 200e3


def reaction_by_hand() -> float:
    """The force of the right bearing, at the beam's end, where the left one presses at its inner edge; N on 1 m of width."""

    def moment(right: float) -> float:
        left = WEIGHT - right
        at_left, at_right = 0.5 - left / STRENGTH / 2, 4.0 - right / STRENGTH / 2
        return left * at_left + right * at_right - WEIGHT * 2.0

    return float(brentq(moment, 0.0, WEIGHT / 2))


@pytest.mark.parametrize("flow", ["associative", "non-associative"])
def test_bearing_that_crushes(flow: str) -> None:
    state = cp.settlement_analysis(BEAM, cp.find_contacts(BEAM), [1], flow=flow, compressive_strength=STRENGTH)
    assert state.status == "optimal"
    assert reaction_by_hand() > 1.02 * 1.5 / 3.5 * WEIGHT
    assert state.reaction == pytest.approx(reaction_by_hand(), rel=1e-6)
    # Forces are given at the corners of the joints all the same.
    assert state.forces[:, 0].sum() == pytest.approx(WEIGHT, rel=1e-6)


def test_a_bearing_whose_strength_is_unknown_presses_along_its_edge() -> None:
    contacts = cp.find_contacts(BEAM)
    endless = cp.settlement_analysis(BEAM, contacts, [1], compressive_strength=np.full(len(contacts.area), np.inf))
    assert endless.reaction == pytest.approx(1.5 / 3.5 * WEIGHT, rel=1e-6)


def test_thrusts_of_bearings_that_crush() -> None:
    found = cp.thrust_range(BEAM, cp.find_contacts(BEAM), [1], (0, 0, -1), compressive_strength=STRENGTH)
    # The greatest is what the least of the other bearing leaves.
    assert (found.least, found.greatest) == pytest.approx((reaction_by_hand(), WEIGHT - reaction_by_hand()), rel=1e-6)


def test_path_of_a_bearing_that_crushes() -> None:
    path = cp.settlement_path(BEAM, cp.find_contacts(BEAM), [1], compressive_strength=STRENGTH, step=0.01, furthest=0.03)
    assert path.least == pytest.approx(reaction_by_hand(), rel=1e-6)
    # Without crushing it is 3 % smaller. The beam leans as it sinks by 30 mm, and rests less on its end.
    assert path.reaction[0] == pytest.approx(reaction_by_hand(), rel=1e-6)
    assert path.reaction == pytest.approx(reaction_by_hand(), rel=5e-3)
    assert max(path.residual.max(), path.violation.max()) < 1e-8


def test_a_beam_falls_whose_bearings_bear_too_little() -> None:
    state = cp.settlement_analysis(BEAM, cp.find_contacts(BEAM), [1], compressive_strength=30e3)
    assert (state.status, state.message) == ("unstable", "the dead load alone brings it down")


@pytest.mark.parametrize(
    ("contact_model", "arm"), [("torsion", 0.25 * (np.sqrt(2) + np.arcsinh(1)) / 3), ("corners", 0.25 * np.sqrt(2))]
)
@pytest.mark.parametrize("flow", ["associative", "non-associative"])
def test_pad_that_turns_below_a_block(contact_model: str, arm: float, flow: str) -> None:
    # Two smooth pegs, so low that they press at the height of the pad, keep the block from turning with it.
    ground, pad = box((-3, 3), (-3, 3), (-2, -1)), box((-0.25, 0.25), (-0.25, 0.25), (-1, 0))
    block, pegs = box((-1, 1), (-1, 1), (0, 1)), [box((0.8, 1), (1, 2), (0, 0.002)), box((-1, -0.8), (-2, -1), (0, 0.002))]
    stones = cp.Assemblage.from_polyhedra([ground, pad, block, *pegs], 18e3, fixed=[0, 1, 3, 4])
    contacts = cp.find_contacts(stones)
    friction = np.where((contacts.blocks == 1).any(axis=1), 0.6, 0.0)
    state = cp.settlement_analysis(
        stones, contacts, [1], (0, 0, 1), friction, about=(0, 0, 0), flow=flow, contact_model=contact_model
    )
    assert state.status == "optimal"
    assert state.reaction == pytest.approx(-0.6 * stones.weight[2] * arm, rel=1e-5 if flow == "associative" else 1e-3)
