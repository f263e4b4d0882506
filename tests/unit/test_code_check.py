"""The safety check of Circolare 7/2019, C8.7.1.2, by hand: single bodies, two stones, and columns of many stones."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from churchpipe.code_check import Floor, Site, activation, along, floor_questions, low_floor_questions, verified
from churchpipe.compare import safety
from churchpipe.errors import InputError
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.checks import SafetyCheck
from churchpipe.model.loads import LoadCase
from churchpipe.model.quantities import GRAVITY
from churchpipe.rigid_blocks.limit import limit_analysis
from churchpipe.stones.contacts import find_contacts
from solids import box, on_ground

PUSH = LoadCase((1, 0, 0))


def column(courses: int, width: float = 1.0, height: float = 4.0) -> Assemblage:
    """A column of a square plan, `width` wide and `height` high, 20 kN/m3, cut into courses."""
    levels = np.linspace(0, height, courses + 1)
    boxes = [box((0, width), (0, width), (low, high)) for low, high in pairwise(levels)]
    return on_ground(*boxes, unit_weight=20e3)


def check(stones: Assemblage, friction: float, site: Site | None = None, load: LoadCase = PUSH) -> SafetyCheck:
    return safety(stones, limit_analysis(stones, find_contacts(stones), load, friction), load, site)


def test_a_body_that_overturns_takes_part_wholly() -> None:
    # One stone of 1 x 1 x 4 m, 80 kN: it turns over at width over height.
    found = check(column(1), 0.7)
    assert found.alpha0 == pytest.approx(0.25, rel=1e-6)
    assert found.mass_fraction == pytest.approx(1, rel=1e-9)
    assert found.moving_weight == pytest.approx(80e3, rel=1e-9)
    assert found.participating_mass == pytest.approx(1e3 * 80 / 9.80665, rel=1e-9)
    assert found.a0 == pytest.approx(0.25 * 9.80665 / 1.35, rel=1e-6)
    assert found.confidence_factor == 1.35


def test_stones_that_slide_alike_take_part_wholly() -> None:
    # Beds with cohesion leave the joint on the ground alone to slide; without, any of them may, and e* is that of the mixture.
    stones = column(4, width=4.0)
    contacts = find_contacts(stones)
    state = limit_analysis(stones, contacts, PUSH, 0.3, np.where(contacts.kind == "base", 0.0, 1e5))
    found = safety(stones, state, PUSH, None)
    assert found.alpha0 == pytest.approx(0.3, rel=1e-6)
    assert found.mass_fraction == pytest.approx(1, rel=1e-6)
    assert found.moving_stones == 4
    assert found.participating_mass == pytest.approx(1e3 * 20 * 4 * 4 * 4 / 9.80665, rel=1e-6)


def test_twenty_courses_that_overturn() -> None:
    # d_x at the centroids is proportional to i - 1/2: e* = (n^2 / 2)^2 / (n sum (i - 1/2)^2) = 3 n^2 / (4 n^2 - 1).
    found = check(column(20), 0.7)
    assert found.moving_stones == 20
    assert found.mass_fraction == pytest.approx(3 * 400 / (4 * 400 - 1), rel=1e-5)
    assert found.mass_fraction == pytest.approx(0.7505, abs=5e-5)
    assert found.participating_mass == pytest.approx(1e3 * found.mass_fraction * 80 / 9.80665, rel=1e-9)


def test_where_a_mechanism_begins() -> None:
    # Two wide courses of 1 m, which stay, and a slender stone on them, which turns over.
    stones = on_ground(box((-2, 3), (0, 1), (0, 1)), box((-2, 3), (0, 1), (1, 2)), box((0, 1), (0, 1), (2, 6)))
    site = Site(1.5, soil_factor=1.2)
    above = check(stones, 0.7, site)
    assert above.begins == pytest.approx(2.0)
    [question] = floor_questions([("+x", above), ("+x", above), ("-x", check(column(4), 0.7, site))])
    assert question.startswith("What moves under +x begins 2.00 m above the foot of the building")
    assert "[check.floor]" in question
    # Not of one that begins at the ground, that knows its floor, or that is compared with no site.
    floored = replace(site, floor=Floor(2.0, 6.0, 2, 3.0))
    assert not floor_questions(
        [("-x", check(column(4), 0.7, site)), ("+x", check(stones, 0.7, floored)), ("+x", check(stones, 0.7))]
    )


def test_a_floor_below_where_a_mechanism_begins() -> None:
    # The stone on two courses turns over 2 m above the ground: a_Z = S_e gamma Z / H at .5 m is a quarter of what is due.
    stones = on_ground(box((-2, 3), (0, 1), (0, 1)), box((-2, 3), (0, 1), (1, 2)), box((0, 1), (0, 1), (2, 6)))
    low, due = (check(stones, 0.7, Site(1.5, soil_factor=1.2, floor=Floor(z, 6.0, 2, 9.0))) for z in (0.5, 2.0))
    assert low.floor_demand == pytest.approx(due.floor_demand / 4)
    assert low.zeta_e > due.zeta_e
    [question] = low_floor_questions([("+x", low), ("+x", due), ("+x", low), ("-x", None)])
    assert question.startswith("What moves under +x begins 2.00 m above the foot of the building")
    assert "check.floor.height_m is 0.5 m" in question
    # The model may be the upper part of a building, so that a floor above where the mechanism begins in it asks nothing.
    higher = check(stones, 0.7, Site(1.5, soil_factor=1.2, floor=Floor(5.0, 6.0, 2, 9.0)))
    assert not low_floor_questions([("+x", higher), ("+x", check(stones, 0.7, Site(1.5, soil_factor=1.2)))])


def test_two_stones_by_hand() -> None:
    # 10 kN move by 1, 30 kN by 3: sum P d = 100, sum P d^2 = 280, sum P = 40; e* = 100^2 / (40 x 280) = 25 / 28.
    weight, displacement = np.array([10e3, 30e3]), np.array([1.0, 3.0])
    found = activation(0.2, weight, weight, displacement, confidence_factor=1.0)
    assert found.mass_fraction == pytest.approx(25 / 28, rel=1e-12)
    assert found.participating_mass == pytest.approx(25 / 28 * 40e3 / GRAVITY, rel=1e-12)
    assert found.a0 == pytest.approx(0.2 * GRAVITY * 28 / 25, rel=1e-12)
    assert found.a0_lumped == pytest.approx(0.2 * GRAVITY, rel=1e-12)
    assert activation(0.2, weight, weight, 7 * displacement).mass_fraction == pytest.approx(25 / 28, rel=1e-12)


def test_a_load_on_a_part_is_spread_over_all_that_moves() -> None:
    # Pushed: 30 kN alone; its work .2 x 90 over the 100 of all that moves.
    weight, displacement = np.array([10e3, 30e3]), np.array([1.0, 3.0])
    found = activation(0.2, weight, np.array([0.0, 30e3]), displacement, confidence_factor=1.0)
    assert found.alpha0 == pytest.approx(0.18, rel=1e-12)


def test_a_load_that_grows_with_height_gives_the_same_acceleration() -> None:
    # A column of stones overturns about its edge under any load: sum P d_x is that of the weights alone.
    uniform = check(column(20), 0.7)
    linear = check(column(20), 0.7, load=LoadCase((1, 0, 0), profile="linear"))
    assert linear.alpha0 == pytest.approx(uniform.alpha0, rel=1e-5)
    assert linear.a0 == pytest.approx(uniform.a0, rel=1e-5)


def verify(acceleration: float, site: Site) -> SafetyCheck:
    return verified(SafetyCheck(a0=acceleration, a0_lumped=acceleration, confidence_factor=1.35), site)


def test_the_verdict_by_hand() -> None:
    # a_g S / q = 2.4 x 1.25 / 2 = 1.5; a0* = 1.8: a_g,SLV = 2 x 1.8 / 1.25 = 2.88, zeta = 1.2.
    found = verify(1.8, Site(2.4, 1.25))
    assert (found.demand, found.satisfied) == (1.5, True)
    assert math.isnan(found.floor_demand)
    assert (found.a_g_slv, found.zeta_e) == (pytest.approx(2.88), pytest.approx(1.2))
    assert verify(1.5, Site(2.4, 1.25)).satisfied
    assert not verify(1.4999, Site(2.4, 1.25)).satisfied


def test_the_floor_above_the_ground_by_hand() -> None:
    # n = 2: gamma = 6/5; psi = 6/12; a_Z = 5 x 1.2 x .5 x sqrt(1 + .0004 x 25) = 3 sqrt(1.01).
    floor = Floor(height=6, building_height=12, storeys=2, spectral_acceleration=5)
    assert floor.acceleration == pytest.approx(3 * math.sqrt(1.01), rel=1e-12)
    found = verify(1.5, Site(2.4, 1.0, floor=floor))
    assert found.floor_demand == pytest.approx(1.5 * math.sqrt(1.01))
    assert found.demand == 1.2
    assert not found.satisfied
    assert found.zeta_e == pytest.approx(1 / math.sqrt(1.01))
    assert found.a_g_slv == pytest.approx(2.4 / math.sqrt(1.01))
    # At the ground the floor asks nothing.
    low = Floor(height=0, building_height=12, storeys=2, spectral_acceleration=5)
    assert verify(1.5, Site(2.4, 1.0, floor=low)).zeta_e == pytest.approx(1.25)


def test_the_check_leads_with_the_careful_fraction() -> None:
    # Twenty courses that overturn: a0* = .25 g / 1.35 = 1.816 with e* = 1, and 1.816 / .7505 = 2.420 with e* of the stones. A
    # demand of 2.2 m/s2 lies between them: .8255 is what an engineer must see first, not the 1.1 of the stones.
    found = check(column(20), 0.7, Site(2.2, 2.0))
    assert found.demand == pytest.approx(2.2)
    assert found.zeta_e == pytest.approx(0.25 * GRAVITY / 1.35 / 2.2, rel=1e-5)
    assert found.satisfied is False
    assert found.a_g_slv == pytest.approx(found.zeta_e * 2.2)
    assert found.zeta_e_stones == pytest.approx(found.zeta_e / found.mass_fraction, rel=1e-9)
    assert found.satisfied_stones is True


def test_a_larger_behaviour_factor_is_never_worse() -> None:
    indices = [verify(1.0, Site(2.0, 1.2, behaviour_factor=q)).zeta_e for q in (1.0, 1.5, 2.0, 3.0)]
    assert np.all(np.diff(indices) > 0)
    np.testing.assert_allclose(np.array(indices) / [1.0, 1.5, 2.0, 3.0], indices[0])


def test_a_larger_confidence_factor_is_worse() -> None:
    stones = column(3)
    first, second = (check(stones, 0.7, Site(1.5, 1.2, confidence_factor=factor)) for factor in (1.0, 1.35))
    assert first.a0 / second.a0 == pytest.approx(1.35, rel=1e-9)
    assert first.zeta_e / second.zeta_e == pytest.approx(1.35, rel=1e-9)
    assert (second.a_g, second.soil_factor, second.q, second.demand) == (1.5, 1.2, 2.0, pytest.approx(0.9))


def test_what_has_no_check_says_why() -> None:
    stones = column(1)
    load = LoadCase((1, 0, 0.5))
    assert "not horizontal" in check(stones, 0.7, load=load).message
    with pytest.raises(InputError, match="not horizontal"):
        along(load.direction, np.zeros((1, 6)))


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        ({"load_factor": math.nan}, "no load factor"),
        ({"displacement": np.array([1.0, -1.0])}, "does not move along the load"),
        ({"displacement": np.zeros(2)}, "does not move along the load"),
        ({"displacement": np.ones(3)}, "different bodies"),
        ({"confidence_factor": 0.9}, "confidence_factor"),
    ],
)
def test_what_cannot_be_checked(change: dict, problem: str) -> None:
    good = {"load_factor": 0.2, "weight": np.ones(2), "pushed": np.ones(2), "displacement": np.ones(2)}
    with pytest.raises(InputError, match=problem):
        activation(**good | change)


@pytest.mark.parametrize(
    ("values", "problem"),
    [
        ((0.0, 1.2), "ground_acceleration"),
        ((1.5, -1.0), "soil_factor"),
        ((1.5, 1.2, 0.5), "behaviour_factor"),
        ((1.5, 1.2, 2.0, 0.5), "confidence_factor"),
        ((math.nan, 1.2), "ground_acceleration"),
    ],
)
def test_a_site_out_of_range(values: tuple[float, ...], problem: str) -> None:
    with pytest.raises(InputError, match=problem):
        Site(*values)


def test_a_mechanism_above_the_building_is_an_error() -> None:
    with pytest.raises(InputError, match="check: height: out of range; found 13; expected from 0 to the building_height of 12 m"):
        Floor(height=13, building_height=12, storeys=2, spectral_acceleration=5)
