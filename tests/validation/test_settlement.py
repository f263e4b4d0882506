"""Settlement and spreading of supports.

Beam on two bearings: by moments about the inner edge of the one that stays. Semicircular arch that spreads: the least thrust, its
hinges at the extrados of the crown and the intrados of each haunch; W the weight of the whole arch: H/W = .154042 at t/R = .2
(hinges 60.4 degrees from the crown), .175873 at t/R = .15 (57.8 degrees), computed for the continuous arch in the test.
"""

from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import churchpipe as cp
from churchpipe.errors import InputError
from churchpipe.generators import arch
from churchpipe.stones.blocks import derive_blocks
from solids import box, on_ground


def test_beam_on_two_bearings() -> None:
    # Bearings of .5 m at the ends of 4 m: the left one presses at its inner edge, x = .5, and the right one, which settles, at
    # the beam's end, x = 4: R = W (2 - .5)/(4 - .5) = .428571 W.
    stones = cp.Assemblage.from_polyhedra(
        [box((0, 0.5), (0, 1), (0, 1)), box((3.5, 4), (0, 1), (0, 1)), box((0, 4), (0, 1), (1, 1.5))], 18e3, fixed=[0, 1]
    )
    state = cp.settlement_analysis(stones, cp.find_contacts(stones), support=[1])
    weight = stones.weight.sum()
    assert state.status == "optimal"
    assert state.reaction == pytest.approx(1.5 / 3.5 * weight, rel=1e-6)
    # The beam turns about the inner edge of the left bearing as its end sinks by one.
    assert state.velocities[1] == pytest.approx([0, 0, -1, 0, 0, 0], abs=1e-6)
    assert state.velocities[2, 2] == pytest.approx(-1.5 / 3.5, abs=1e-5)
    assert state.opening.max() == pytest.approx(0.5 / 3.5, abs=1e-5)


def test_turning_bearing() -> None:
    # The right bearing turns down about the line of its inner edge: the beam may rest on that line, which resists no moment.
    stones = cp.Assemblage.from_polyhedra(
        [box((0, 0.5), (0, 1), (0, 1)), box((3.5, 4), (0, 1), (0, 1)), box((0, 4), (0, 1), (1, 1.5))], 18e3, fixed=[0, 1]
    )
    contacts, weight = cp.find_contacts(stones), stones.weight.sum()
    level = cp.settlement_analysis(stones, contacts, [1], (0, 1, 0), about=(3.5, 0, 1))
    assert level.reaction == pytest.approx(0.0, abs=1e-6 * weight)
    # About an axis far off it turns as it would sink.
    sunk = cp.settlement_analysis(stones, contacts, [1], (0, 1, 0), about=(-1e3, 0, 1))
    assert sunk.reaction / 1004 == pytest.approx(1.5 / 3.5 * weight, rel=1e-3)


def least_thrust(thickness: float) -> tuple[float, float]:
    """H/W and the angle from the crown, degrees, of the continuous semicircle with mean radius 1."""
    outer, inner = 1 + thickness / 2, 1 - thickness / 2
    mean = (outer**3 - inner**3) / (3 * thickness)

    def thrust(angle: float) -> float:
        weight = angle / np.pi
        centre = mean * (1 - np.cos(angle)) / angle
        return weight * (inner * np.sin(angle) - centre) / (outer - inner * np.cos(angle))

    found = minimize_scalar(lambda angle: -thrust(angle), bounds=(0.5, 1.5), method="bounded", options={"xatol": 1e-10})
    return thrust(found.x), float(np.degrees(found.x))


@pytest.mark.parametrize(("thickness", "thrust", "angle"), [(0.2, 0.154042, 60.4), (0.15, 0.175873, 57.8)])
def test_least_thrust_of_the_continuous_semicircle(thickness: float, thrust: float, angle: float) -> None:
    assert least_thrust(thickness) == (pytest.approx(thrust, abs=1e-6), pytest.approx(angle, abs=0.05))


@pytest.mark.parametrize(
    ("voussoirs", "thickness", "thrust", "error"),
    [(160, 0.2, 0.154044, 1e-6), (160, 0.15, 0.175873, 1e-5)],
)
def test_spreading_arch(voussoirs: int, thickness: float, thrust: float, error: float) -> None:
    stones = derive_blocks(arch(mean_radius=1.0, thickness=thickness, width=1.0, voussoirs=voussoirs))
    right = int(np.argmax(np.where(stones.fixed, stones.centroid[:, 0], -np.inf)))
    state = cp.settlement_analysis(stones, cp.find_contacts(stones), [right], (1, 0, 0), friction=0.75)
    assert state.status == "optimal"
    assert state.reaction / stones.weight.sum() == pytest.approx(thrust, abs=error)
    assert state.bound_gap < 1e-5
    without = cp.settlement_analysis(stones, cp.find_contacts(stones), [right], (1, 0, 0), friction=0.75, flow="non-associative")
    assert without.reaction == pytest.approx(state.reaction, rel=1e-5)


def test_a_support_that_pushes() -> None:
    """A fixed stone is driven against a block: friction on its face presses the block down, so that p = mu (W + mu p)."""
    block, driver = box((0, 1), (0, 1), (0, 1)), box((-1, 0), (0, 1), (0, 0.5))
    stones = cp.Assemblage.from_polyhedra([box((-5, 5), (-5, 5), (-1, 0)), block, driver], 18e3, fixed=[0, 2])
    contacts = cp.find_contacts(stones)
    state = cp.settlement_analysis(stones, contacts, [2], (1, 0, 0), friction=0.3)
    assert (state.status, state.reaction / 18e3) == ("optimal", pytest.approx(-0.3 / (1 - 0.09), rel=1e-6))
    path = cp.settlement_path(stones, contacts, [2], (1, 0, 0), friction=0.3, furthest=0.2)
    # Once it slides without dilatancy, the friction on its face is not known: it may press the block down, or lift it.
    assert (path.reaction / 18e3 > -0.301 / (1 - 0.09)).all()
    assert (path.reaction / 18e3 < -0.299 / (1 + 0.09)).all()


def test_a_support_that_moves_in_on_an_arch_is_pushed_with_its_greatest_thrust() -> None:
    stones = derive_blocks(arch(mean_radius=1.0, thickness=0.2, width=1.0, voussoirs=27))
    contacts = cp.find_contacts(stones)
    right = int(np.argmax(np.where(stones.fixed, stones.centroid[:, 0], -np.inf)))
    state = cp.settlement_analysis(stones, contacts, [right], (-1, 0, 0), friction=0.7)
    assert state.reaction == pytest.approx(-cp.thrust_range(stones, contacts, [right], (1, 0, 0), 0.7).greatest, rel=1e-6)


BEAM = cp.Assemblage.from_polyhedra(
    [box((0, 0.5), (0, 1), (0, 1)), box((3.5, 4), (0, 1), (0, 1)), box((0, 4), (0, 1), (1, 1.5)), box((9, 10), (0, 1), (0, 1))],
    18e3,
    fixed=[0, 1, 3],
)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"support": [7]}, "settlement_analysis: support: index out of range; found 7"),
        ({"support": [-1]}, "settlement_analysis: support: index out of range"),
        ({"support": []}, "settlement_analysis: support: no stones"),
        (
            {"support": [2]},
            r"support: a stone that is free; found B2 \(stone 2\); expected fixed stones: 0, 1, 3",
        ),
        ({"support": [3]}, "settlement_analysis: support: nothing stands on it; found B3"),
        ({"support": "pier"}, "settlement_analysis: support: not indices of stones"),
        ({"support": None}, "settlement_analysis: support: not indices of stones"),
        ({"direction": (0, 0, 0)}, "settlement_analysis: direction: no direction"),
        ({"direction": (0, 0, np.nan)}, "settlement_analysis: direction: not a finite number"),
        ({"direction": (0, 1)}, "settlement_analysis: direction: wrong shape"),
        ({"friction": -0.1}, "friction: out of range"),
        ({"flow": "dilatant"}, "settlement_analysis: flow: unknown value"),
        ({"contact_model": "balls"}, "settlement_analysis: contact_model: unknown value"),
        ({"stones": 3}, "settlement_analysis: stones: wrong kind"),
    ],
)
def test_bad_arguments(options: dict[str, Any], said: str) -> None:
    given = {"stones": BEAM, "contacts": cp.find_contacts(BEAM), "support": [1]} | options
    with pytest.raises(InputError, match=said):
        cp.settlement_analysis(**given)


def test_unstable_stones_settle_no_more() -> None:
    stones = on_ground(box((0, 1), (0, 1), (0, 1)), box((0.6, 1.6), (0, 1), (1, 2)))
    state = cp.settlement_analysis(stones, cp.find_contacts(stones), [0])
    assert state.status == "unstable"
    assert "dead load" in state.message
    assert np.isnan(state.reaction)


def test_a_support_that_nothing_needs_keeps_no_reaction() -> None:
    stones = cp.Assemblage.from_polyhedra(
        [box((0, 3), (0, 1), (0, 1)), box((3, 4), (0, 1), (0, 1)), box((0, 4), (0, 1), (1, 1.5))], 18e3, fixed=[0, 1]
    )
    state = cp.settlement_analysis(stones, cp.find_contacts(stones), [1])
    assert state.status == "optimal"
    assert state.reaction == pytest.approx(0.0, abs=1e-6 * stones.weight.sum())
    assert np.abs(state.velocities[2]).max() < 1e-5
