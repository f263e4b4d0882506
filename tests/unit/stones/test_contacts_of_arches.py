"""Joints of arches whose curved sides are chords, exactly as drawn."""

import pytest

from churchpipe.stones.contacts import find_contacts
from relieving_arch import HEIGHT, LENGTH, THICKNESS, arch_in_wall, stones_of


@pytest.mark.parametrize("stone", [0.4, 0.5, 0.6])
def test_narrow_joints_on_the_chords_of_an_arch_are_found_in_an_exact_drawing(stone: float) -> None:
    # The gaps between facets of several chords are no errors of drawing: they were taken for noise of 9 mm, and joints 1 to 9 mm
    # wide were left out.
    outlines = arch_in_wall(stone)
    shared = 0.5 * (sum(outline.length for outline in outlines) - 2 * (LENGTH + HEIGHT)) + LENGTH
    assert find_contacts(stones_of(outlines)).area.sum() == pytest.approx(shared * THICKNESS, rel=1e-6)
