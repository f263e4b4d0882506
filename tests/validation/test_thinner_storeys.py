"""Walls that get thinner in an upper storey, against closed forms by moments.

A free wall of two storeys, b1 x h1 below b2 x h2, is pushed across by its own weight. With friction enough it turns about the
edge of a bed, and all above that bed with it, at (moment of its weight about the edge) / (moment of the same forces, level). The
least of all beds counts. With one face flush the wall is not symmetric, and the two ways differ.
"""

from typing import Any

import numpy as np
import pytest

import churchpipe as cp
from churchpipe import generators

# Thickness and height, m.
Storey = tuple[float, float]
MORE = pytest.mark.slow("docs/house.md: walls with a thinner storey, as a shell")
COURSE, LENGTH = 0.3, 3.0
MATERIALS = (cp.Material("default", 18e3, 0.9), cp.Material("light", 9e3, 0.9))


def wall(below: Storey, above: Storey, *, flush: bool, light: bool = False) -> cp.Building:
    """A free wall along x; below, above: thickness and height of its storeys, m. flush: its face at y = 0, else its middle."""
    storey = {"above": below[1], "thickness": above[0]} | ({"material": "light"} if light else {})
    given: dict[str, Any] = {"name": "a", "start": (0, 0), "end": (LENGTH, 0), "storeys": [storey]}
    if flush:
        given["toward"] = "+y"
    height = below[1] + above[1]
    return generators.house(
        course=COURSE, stone_length=0.75, height=height, thickness=below[0], walls=[given], materials=MATERIALS
    )


def turns_at(below: Storey, above: Storey, way: int, *, flush: bool, weights: tuple[float, float] = (1.0, 1.0)) -> float:
    """The least factor, of all beds: that of the foot and those between courses of either storey."""
    (b1, h1), (b2, h2) = below, above
    middles = (b1 / 2, b2 / 2) if flush else (0.0, 0.0)
    factors: list[float] = []
    for bed in COURSE * np.arange(round((h1 + h2) / COURSE)):
        in_upper = bed > h1 - 1e-9
        edge = (middles[1] + way * b2 / 2) if in_upper else (middles[0] + way * b1 / 2)
        parts = [] if in_upper else [(weights[0] * b1 * (h1 - bed), middles[0], (h1 - bed) / 2)]
        low = max(bed, h1)
        parts.append((weights[1] * b2 * (h1 + h2 - low), middles[1], (low + h1 + h2) / 2 - bed))
        factors.append(sum(w * way * (edge - y) for w, y, _ in parts) / sum(w * z for w, _, z in parts))
    return min(factors)


@pytest.mark.parametrize(
    ("below", "above", "flush"),
    [
        ((0.6, 3.0), (0.45, 3.0), True),
        ((0.6, 3.0), (0.45, 3.0), False),
        # A thin upper storey falls by itself, off its own bed.
        ((0.9, 3.0), (0.3, 3.0), True),
        ((0.9, 1.5), (0.3, 4.5), False),
        # Its weight at the back of the wall below holds that.
        ((0.9, 4.5), (0.45, 1.5), True),
    ],
)
@pytest.mark.parametrize("way", [1, -1])
def test_a_free_wall_turns_about_the_edge_of_a_bed(below: Storey, above: Storey, flush: bool, way: int) -> None:
    stones = cp.derive_blocks(wall(below, above, flush=flush))
    volume = LENGTH * (below[0] * below[1] + above[0] * above[1])
    assert float(stones.weight[~stones.fixed].sum()) == pytest.approx(18e3 * volume, rel=1e-9)
    state = cp.limit_analysis(stones, cp.find_contacts(stones), cp.LoadCase((0, way, 0)), 0.9)
    expected = turns_at(below, above, way, flush=flush)
    assert state.status == "optimal"
    assert state.load_factor == pytest.approx(expected, abs=1e-6)


def test_the_two_ways_of_a_flush_wall_differ() -> None:
    below, above = (0.6, 3.0), (0.45, 3.0)
    inwards, outwards = (turns_at(below, above, way, flush=True) for way in (1, -1))
    # By hand, of a metre: 1.8 and 1.35 m3 at 1.5 and 4.5 m, 0.3 and 0.375 m from the inner edge, 0.3 and 0.225 m from the outer.
    assert inwards == pytest.approx((1.8 * 0.3 + 1.35 * 0.375) / (1.8 * 1.5 + 1.35 * 4.5), abs=1e-12)
    assert outwards == pytest.approx((1.8 * 0.3 + 1.35 * 0.225) / (1.8 * 1.5 + 1.35 * 4.5), abs=1e-12)


def test_a_lighter_upper_storey() -> None:
    below, above = (0.6, 3.0), (0.45, 3.0)
    stones = cp.derive_blocks(wall(below, above, flush=True, light=True))
    expected = LENGTH * 3.0 * (0.6 * 18e3 + 0.45 * 9e3)
    assert float(stones.weight[~stones.fixed].sum()) == pytest.approx(expected, rel=1e-9)
    state = cp.limit_analysis(stones, cp.find_contacts(stones), cp.LoadCase((0, -1, 0)), 0.9)
    assert state.load_factor == pytest.approx(turns_at(below, above, -1, flush=True, weights=(2.0, 1.0)), abs=1e-6)


@pytest.mark.parametrize(
    ("below", "above", "flush", "way"),
    [
        ((0.6, 3.0), (0.45, 3.0), True, 1),
        pytest.param((0.6, 3.0), (0.45, 3.0), True, -1, marks=MORE),
        pytest.param((0.6, 3.0), (0.45, 3.0), False, 1, marks=MORE),
        ((0.9, 3.0), (0.3, 3.0), True, 1),
    ],
)
def test_the_shell_turns_about_the_same_edges(below: Storey, above: Storey, flush: bool, way: int) -> None:
    """On the ground, or the upper storey on the lower one: each of them stands on a bed joint."""
    shell = cp.derive_shell(wall(below, above, flush=flush), 0.5)
    found = cp.shell_limit_analysis(shell, cp.LoadCase((0, way, 0)), MATERIALS)
    assert found.load_factor == pytest.approx(turns_at(below, above, way, flush=flush), rel=1e-6)


@MORE
@pytest.mark.parametrize(("where", "load", "aside", "level"), [("a", 10e3, 0.225, 3.0), ("a storey 2", 1e3, 0.0, 6.0)])
def test_a_floor_on_the_offset_and_a_roof_on_the_top(where: str, load: float, aside: float, level: float) -> None:
    # Both lie on the top of their storey, which needs no height: the floor in the middle of the offset of 0.15 m, 0.225 m from
    # the middle of the wall below; the roof in the middle of the thin wall.
    below, above, case = (0.6, 3.0), (0.45, 3.0), cp.LoadCase((0, -1, 0))
    building = wall(below, above, flush=True)
    loads = [cp.LineLoad(where, dead=load, eccentricity=aside, toward="+y")]
    stones, shell = cp.derive_blocks(building), cp.derive_shell(building, 0.25)
    w1, w2, arm = 18e3 * 0.6 * 3.0, 18e3 * 0.45 * 3.0, (0.3 if where == "a" else 0.225) + aside
    expected = (w1 * 0.3 + w2 * 0.225 + load * arm) / (w1 * 1.5 + w2 * 4.5 + load * level)
    state = cp.limit_analysis(stones, cp.find_contacts(stones), cp.loaded(case, stones, loads), 0.9)
    assert state.load_factor == pytest.approx(expected, abs=1e-6)
    found = cp.shell_limit_analysis(shell, cp.shell_loaded(case, shell, stones, loads), MATERIALS).load_factor
    assert found == pytest.approx(expected, rel=1e-6)
