"""Capacity curves of models of which most stones are held: they do not depend on how far the halo reaches."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.model.block_curve import BlockCapacityCurve

CASES = Path(__file__).parents[2] / "pipeline" / "cases"


@cache
def curve(halo: int, name: str = "chapel", steps: int = 6, step: float = 0.04, pushed: str = "-y") -> BlockCapacityCurve:
    """The curve of a building, of which the facade falls outwards unless another load is named."""
    case = cp.read_case(CASES / f"{name}.toml")
    stones = cp.derive_blocks(case.building())
    load = next(load for load in case.loads if load.name == pushed)
    return cp.block_pushover(stones, cp.find_contacts(stones), load, 0.6, step=step, steps=steps, halo=halo)


@pytest.mark.slow("docs/capacity_curve.md: chapel -y, halos of two and of five contacts")
def test_a_narrower_halo_gives_the_same_curve() -> None:
    five, two = curve(5), curve(2)
    assert five.proved
    assert two.proved
    # The facade leaves as a whole: no stone runs ahead of it.
    assert min(five.largest[-1], two.largest[-1]) > 0.15
    way = np.linspace(0.0, min(five.displacement[-1], two.displacement[-1]), 50)
    wide, narrow = (np.interp(way, each.displacement, each.load_factor) for each in (five, two))
    assert np.abs(narrow - wide).max() <= 0.02 * five.load_factor[0]


@pytest.mark.slow("docs/capacity_curve.md: church -y, its start, and steps of half the length")
def test_the_curve_of_the_church_starts_without_dilatancy_and_does_not_depend_on_the_step() -> None:
    whole, half = curve(5, "church", 6), curve(5, "church", 11, 0.02)
    assert whole.proved
    assert half.proved
    # docs/church.md: the intervals of both certified starts.
    assert 0.2026 <= half.load_factor[0] <= 0.2143
    way = np.linspace(0.0, min(whole.displacement[-1], half.displacement[-1]), 50)
    one, other = (np.interp(way, each.displacement, each.load_factor) for each in (whole, half))
    assert whole.largest[-1] > 0.2
    assert np.abs(other - one).max() <= 0.02 * whole.load_factor[0]


@pytest.mark.slow("docs/capacity_curve.md: church, half a metre along x and y, and steps of half the length")
@pytest.mark.parametrize("pushed", ["+x", "-x", "+y"])
def test_the_curves_of_the_church_do_not_depend_on_the_step_until_stones_fall_together(pushed: str) -> None:
    whole, half = curve(5, "church", 15, 0.04, pushed), curve(5, "church", 30, 0.02, pushed)
    # Single light stones fall on the way.
    ends = [float(np.interp(0.5, each.largest, each.displacement)) for each in (whole, half)]
    assert min(whole.largest[-1], half.largest[-1]) > 0.5
    way = np.linspace(0.0, min(ends), 200)
    one, other = (np.interp(way, each.displacement, each.load_factor) for each in (whole, half))
    assert np.abs(other - one).max() <= 0.02 * whole.load_factor[0]


@pytest.mark.slow("docs/capacity_curve.md: church -y, past the stones that fall")
def test_steps_fit_past_stones_that_fall() -> None:
    past = curve(5, "church", 36)
    # What has fallen does not hold up the rest: most of the way is made after the first stone fell.
    assert 0.0 < past.fallen[0].displacement < 0.6 * past.displacement[-1]
    # Where a stone hangs until it falls a step or two are no equilibria.
    hanging, fell = past.misfit > 0.01, np.array([part.displacement for part in past.fallen])
    assert hanging.sum() <= 4
    assert all(np.abs(fell - at).min() < 1e-3 for at in past.displacement[hanging])


@pytest.mark.slow("docs/capacity_curve.md: tower of the church, and steps of half the length")
def test_the_curve_of_the_tower_begins_where_it_does_whatever_the_step() -> None:
    whole, half = curve(5, "church", 10, 0.04, "tower +x"), curve(5, "church", 19, 0.02, "tower +x")
    # Of the many motions without dilatancy as drawn none is chosen by the length of the step.
    assert whole.load_factor[0] == half.load_factor[0]
    assert whole.proved
    assert half.proved
    way = np.linspace(0.0, min(whole.displacement[-1], half.displacement[-1]), 50)
    one, other = (np.interp(way, each.displacement, each.load_factor) for each in (whole, half))
    assert min(whole.largest[-1], half.largest[-1]) > 0.25
    assert np.abs(other - one).max() <= 0.02 * whole.load_factor[0]


@pytest.mark.slow("docs/capacity_curve.md: tower of the church, past the voussoirs that hang on joints which open")
def test_the_curve_of_the_tower_goes_on_past_stones_that_hang() -> None:
    past = curve(5, "church", 30, 0.04, "tower +x")
    assert len(past.load_factor) == 30
    assert past.largest[-1] > 0.7
    # Without them forces and motion fit again.
    assert past.misfit[-5:].max() < 0.01
    assert sum(len(part.stones) for part in past.fallen) <= 12
