"""The capacity curve of a model of which most stones are held: it does not depend on how far the halo reaches."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.model.block_curve import BlockCapacityCurve

CASE = Path(__file__).parents[2] / "pipeline" / "cases" / "chapel.toml"


@cache
def curve(halo: int) -> BlockCapacityCurve:
    """The curve of the chapel whose facade falls outwards."""
    case = cp.read_case(CASE)
    stones = cp.derive_blocks(case.building())
    load = next(load for load in case.loads if load.name == "-y")
    return cp.block_pushover(stones, cp.find_contacts(stones), load, 0.6, step=0.04, steps=6, halo=halo)


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
