"""Capacity curves of stones that twist, with friction about the centres of pressure.

The references are those of test_torsion.py. They do not change while a stone turns on a plane about the normal of its joint.
"""

import numpy as np
import pytest

import churchpipe as cp
from solids import box, on_ground

MU = 0.7


def twisted(b: float, h: float, e: tuple[float, float] = (0.0, 0.0), **options: str) -> cp.BlockCapacityCurve:
    """A flat block that is twisted; most of its load stands e beside its middle, and it is twisted about that point."""
    stones = on_ground(box((-b / 2, b / 2), (-h / 2, h / 2), (0, 0.1)))
    weight = float(stones.weight.sum())
    dead, live = np.zeros((2, stones.count, 6))
    dead[-1] = [0, 0, -9 * weight, -10 * weight * e[1], 10 * weight * e[0], 0]
    # A curve wants a force; this one does next to nothing.
    live[-1, [2, 5]] = -1e-9 * weight, weight
    load = cp.LoadCase(dead=dead, live=live)
    return cp.block_pushover(stones, cp.find_contacts(stones), load, MU, step=0.01, steps=6, **options)


@pytest.mark.parametrize(("b", "h", "printed"), [(1, 1, 0.267819), (2, 1, 0.415263)])
def test_a_block_that_turns_on_the_ground(b: float, h: float, printed: float) -> None:
    curve = twisted(b, h, contact_model="torsion")
    assert curve.load_factor == pytest.approx(np.full(6, 10 * printed), rel=1e-5)
    assert curve.rotation[-1, 1, 2] > 0.02
    assert curve.proved
    corners = twisted(b, h)
    assert corners.load_factor == pytest.approx(np.full(6, 10 * MU * np.hypot(b, h) / 2), rel=1e-5)


def test_eccentric_pressure() -> None:
    b, h, e = 1.2, 0.7, (0.2, 0.0)
    curve = twisted(b, h, e, contact_model="torsion")
    x, y = (size * ((np.arange(600) + 0.5) / 600 - 0.5) for size in (b - 2 * e[0], h))
    arm = np.hypot(*np.meshgrid(x, y)).mean()
    assert curve.load_factor[0] == pytest.approx(10 * MU * arm, rel=5e-3)


@pytest.mark.slow
def test_rocking_is_untouched() -> None:
    stones = on_ground(box((0, 0.5), (0, 1), (0, 2)), box((0, 0.5), (0, 1), (2, 4)))
    contacts, load = cp.find_contacts(stones), cp.LoadCase((1, 0, 0))
    corners, torsion = (
        cp.block_pushover(stones, contacts, load, MU, step=0.05, contact_model=model) for model in ("corners", "torsion")
    )
    assert torsion.load_factor == pytest.approx(corners.load_factor, abs=1e-7)
    assert torsion.d0 == pytest.approx(0.25, abs=1e-6)
