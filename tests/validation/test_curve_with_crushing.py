"""Capacity curves of stones whose joints crush, against a block that stands on a strip of its toe.

A block b x h x d of weight W turned by the angle t bears on the strip of width a = N / (f d) at its toe, where f is its strength
in compression and N what presses on its base. The resultant stands in the middle of the strip, so that

    alpha = tan(atan((b - a) / h) - t),    N = W (cos t - alpha sin t)

and it turns about the inner edge of the strip. As drawn that is alpha = (b - a) / h, the closed form of test_crushing.py.
"""

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.model.arrays import FloatArray
from solids import box, on_ground

B, H = 0.9, 12.0
PUSH = cp.LoadCase((1, 0, 0))


def wall(courses: int, upside_down: bool = False) -> cp.Assemblage:
    stones = [box((0, B), (0, 1), (H * i / courses, H * (i + 1) / courses)) for i in range(courses)]
    if upside_down:
        ground = box((-9, 9), (-5, 5), (-1, 0))
        return cp.Assemblage.from_polyhedra([*reversed(stones), ground], 18e3, fixed=[courses])
    return on_ground(*stones)


def expected(turn: FloatArray, weight: float, strength: float) -> tuple[FloatArray, FloatArray]:
    """Load factor and width of the strip, m, at these angles."""
    alpha = np.zeros_like(turn)
    for _ in range(60):
        a = weight * (np.cos(turn) - alpha * np.sin(turn)) / strength
        alpha = np.tan(np.arctan((B - a) / H) - turn)
    return alpha, a


@pytest.mark.parametrize(
    ("strength", "first"),
    [pytest.param(1e6, 0.0588, marks=pytest.mark.slow("docs/capacity_curve.md: a wall that crushes")), (0.5e6, 0.0426)],
)
def test_rocking_wall_that_crushes(strength: float, first: float) -> None:
    stones = wall(1)
    curve = cp.block_pushover(stones, cp.find_contacts(stones), PUSH, 0.7, step=0.02, compressive_strength=strength)
    weight = float(stones.weight[1])
    assert curve.status == "vanished"
    assert curve.load_factor[0] == pytest.approx(first, abs=1e-6)
    turn = curve.rotation[:, 1, 1]
    alpha, a = expected(turn, weight, strength)
    assert curve.load_factor == pytest.approx(alpha, abs=1e-6)
    # It turns about the inner edge of the strip: that edge stays on the ground, while the toe sinks into it.
    arm = np.stack([B / 2 - a, np.full_like(a, -H / 2)], axis=1)
    edge = curve.position[:, 1, 2] - np.sin(turn) * arm[:, 0] + np.cos(turn) * arm[:, 1]
    assert np.abs(edge).max() < 1e-3 * B
    assert curve.proved
    # What the load does the weight, and the work of crushing, have taken.
    work = np.trapezoid(curve.load_factor, curve.displacement) * weight
    lifted = (curve.position[-1, 1, 2] - curve.position[0, 1, 2]) * weight
    assert work == pytest.approx(lifted + curve.dissipation[-1], rel=1e-2)


@pytest.mark.slow
def test_a_strong_wall_rocks_as_one_that_does_not_crush() -> None:
    stones = wall(1)
    contacts = cp.find_contacts(stones)
    hard, strong = (cp.block_pushover(stones, contacts, PUSH, 0.7, step=0.05, compressive_strength=f) for f in (None, 1e9))
    share = float(stones.weight[1]) / 1e9 / B
    assert strong.load_factor[0] == pytest.approx(hard.load_factor[0], rel=2 * share)
    assert strong.d0 == pytest.approx(hard.d0, rel=1e-3)


@pytest.mark.slow
def test_wall_of_courses_whatever_their_order() -> None:
    curves = []
    for upside_down in (False, True):
        stones = wall(4, upside_down)
        curves.append(cp.block_pushover(stones, cp.find_contacts(stones), PUSH, 0.7, step=0.04, compressive_strength=1e6))
    weight = float(B * H * 18e3)
    whole = expected(np.zeros(1), weight, 1e6)[0][0]
    for curve in curves:
        assert curve.load_factor[0] == pytest.approx(whole, abs=1e-5)
        assert curve.proved
    assert curves[0].d0 == pytest.approx(curves[1].d0, rel=1e-2)
