"""What the bond of a facade with its side walls is worth.

Source: the free facade turns about its outer edge at the load factor (thickness / 2) / (height of its centroid), by moments.
"""

from typing import Any

import numpy as np
import pytest

import churchpipe as cp
from churchpipe import generators

THICKNESS, WIDTH, EAVES, RIDGE, FRICTION = 0.6, 5.0, 4.0, 5.0, 0.6
# Figures of the table in docs/walls.md.
TABLE = {"toothed": 0.486, "every 4th course": 0.363, "every 8th course": 0.220, "cracked above 2 m": 0.303, "butt": 0.172}


def facade(**junction: Any) -> tuple[cp.Assemblage, cp.Contacts]:
    """A gable facade with two side walls behind it."""
    walls = [{"walls": ("facade", side), **junction} for side in ("nave_left", "nave_right")]
    building = generators.church(
        course=0.5,
        stone_length=1.0,
        nave={"width": WIDTH - THICKNESS, "length": 3.0, "height": EAVES, "thickness": THICKNESS},
        facade={"thickness": THICKNESS, "ridge": RIDGE},
        junctions=walls if junction else (),
    )
    stones = cp.derive_blocks(building)
    return stones, cp.find_contacts(stones)


def without_dilatancy(stones: cp.Assemblage, contacts: cp.Contacts) -> cp.LimitState:
    """The state without dilatancy."""
    load = cp.LoadCase((0, -1, 0), panels=("facade",))
    return cp.limit_analysis(stones, contacts, load, FRICTION, flow="non-associative")


def load_factor(stones: cp.Assemblage, contacts: cp.Contacts, friction: Any = FRICTION) -> float:
    state = cp.limit_analysis(stones, contacts, cp.LoadCase((0, -1, 0), panels=("facade",)), friction)
    assert state.status == "optimal"
    assert state.upper_bound - state.lower_bound < 1e-6
    return state.load_factor


def test_the_weaker_the_bond_the_lower_the_load_factor() -> None:
    found = {
        "toothed": load_factor(*facade()),
        "every 4th course": load_factor(*facade(every=4)),
        "every 8th course": load_factor(*facade(every=8)),
        "cracked above 2 m": load_factor(*facade(every=2, cracked=(2.0, EAVES))),
        "butt": load_factor(*facade(every=0)),
    }
    for name, factor in found.items():
        assert factor == pytest.approx(TABLE[name], abs=5e-4)
    order = [found[name] for name in ("toothed", "every 4th course", "every 8th course", "butt")]
    assert order == sorted(order, reverse=True)
    assert found["butt"] < found["cracked above 2 m"] < found["toothed"]
    # Declared, the bond of walls that are toothed by themselves is what it was; cracked all over they are butt.
    assert load_factor(*facade(every=2)) == pytest.approx(found["toothed"], abs=1e-7)
    assert load_factor(*facade(every=2, cracked=(0.0, EAVES))) == pytest.approx(found["butt"], abs=1e-7)


def test_a_butt_facade_without_friction_at_its_sides_turns_over_by_itself() -> None:
    stones, contacts = facade(every=0)
    smooth = np.where(contacts.kind == "junction", 0.0, FRICTION)
    triangle = 0.5 * WIDTH * (RIDGE - EAVES)
    centroid = (WIDTH * EAVES * EAVES / 2 + triangle * (EAVES + (RIDGE - EAVES) / 3)) / (WIDTH * EAVES + triangle)
    assert load_factor(stones, contacts, smooth) == pytest.approx(THICKNESS / 2 / centroid, abs=1e-6)
    # Friction along the joint resists in an associative analysis only.
    state = without_dilatancy(stones, contacts)
    assert state.status == "converged"
    assert state.load_factor == pytest.approx(0.133, abs=5e-4)
    assert state.interval == pytest.approx((0.133, 0.149), abs=5e-4)
