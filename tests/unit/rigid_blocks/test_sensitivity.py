"""What cohesion and weight would add to a load factor: difference quotients, and the twist of a block on its joint."""

import math
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import churchpipe as cp
from solids import box, moved, on_ground


def walls() -> tuple[cp.Assemblage, cp.Contacts]:
    """Two walls that meet, of stones of unequal size and weight, turned and far from the origin."""
    solids, names = [], [""]
    for wall, heights, ends in (
        ("long", (0.31, 0.27, 0.4, 0.22), ((0, 0.5, 1.3, 2.2), (0, 0.9, 1.7, 2.2))),
        ("short", (0.4, 0.33, 0.3), ((0.37, 0.8, 1.5), (0.37, 1.1, 1.5))),
    ):
        levels = np.concatenate([[0.0], np.cumsum(heights)])
        for course, up in enumerate(pairwise(levels.tolist())):
            for along in pairwise(ends[course % 2]):
                solids.append(box(along, (0, 0.37), up) if wall == "long" else box((1.0, 1.3), along, up))
                names.append(wall)
    turn = math.radians(37)
    rotation = np.array([[math.cos(turn), -math.sin(turn), 0], [math.sin(turn), math.cos(turn), 0], [0, 0, 1]])
    stones = moved(on_ground(*solids), rotation, np.array([310.0, -720.0, 4.2]))
    stones = replace(stones, panel=np.array(names), unit_weight=17e3 + 300 * np.arange(stones.count))
    return stones, cp.find_contacts(stones)


@pytest.mark.parametrize("panels", [None, ("long",)])
@pytest.mark.parametrize("profile", ["uniform", "linear"])
def test_weight_adds_what_new_analyses_find(profile: Any, panels: Any) -> None:
    stones, contacts = walls()
    # Along the outward normal of the long wall.
    load = cp.LoadCase((math.sin(math.radians(37)), -math.cos(math.radians(37)), 0), panels=panels, profile=profile)
    state = cp.limit_analysis(stones, contacts, load, 0.6, 2e3)
    rates, step = cp.sensitivities(state, stones, contacts, load), 20.0

    def factor(wall: str, more: float) -> float:
        own = (stones.panel == wall) & ~stones.fixed
        heavier = replace(stones, unit_weight=stones.unit_weight + own * more / stones.volume[own].sum())
        return cp.limit_analysis(heavier, contacts, load, 0.6, 2e3).load_factor

    assert np.abs(rates.weight).min() > 1e-7
    for wall, rate in zip(rates.panel.tolist(), rates.weight.tolist(), strict=True):
        assert rate == pytest.approx((factor(wall, step) - factor(wall, -step)) / (2 * step), rel=1e-3)


def test_cohesion_resists_twist_where_friction_acts() -> None:
    # A unit square on its joint twisted about the upright: c A times the mean distance from its centre under torsion, and times
    # that of its corners else.
    stones = on_ground(box((0, 1), (0, 1), (0, 1)))
    contacts, torque = cp.find_contacts(stones), np.zeros((2, 6))
    torque[1, 5] = 1e3
    load = cp.LoadCase(live=torque)
    for model, arm in (("corners", math.sqrt(0.5)), ("torsion", (math.sqrt(2) + math.asinh(1)) / 6)):
        state = cp.limit_analysis(stones, contacts, load, 0.6, 2e3, contact_model=model)
        assert state.load_factor == pytest.approx((0.6 * 18e3 + 2e3) * arm / 1e3, rel=1e-6)
        rates = cp.sensitivities(state, stones, contacts, load, contact_model=model)
        assert rates.cohesion == pytest.approx([arm / 1e3], rel=1e-5)
