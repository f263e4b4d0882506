"""Stones that fill the crossing of two walls: of which wall they are."""

from dataclasses import replace

import numpy as np
import pytest

from churchpipe.generators import house
from churchpipe.match import match_models
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.materials import Material
from churchpipe.recognition.panels import fit_panels
from churchpipe.shell_mesh.shell import derive_shell
from churchpipe.stones.blocks import derive_blocks
from churchpipe.stones.contacts import find_contacts


def corner_with_a_window() -> Assemblage:
    """Two toothed walls; the lintel of a window beside the corner ends at it, and leaves a stone that is just the crossing."""
    walls = [
        {"name": "south", "start": (0, 0), "end": (3.0, 0), "thickness": 0.42, "toward": "+y"},
        {"name": "west", "start": (0, 0), "end": (0, 3.0), "thickness": 0.26, "toward": "+x"},
    ]
    window = {"name": "window", "wall": "west", "centre": 0.98, "width": 0.75, "sill": 0.9, "height": 0.9}
    size = {"course": 0.3, "stone_length": 0.5, "height": 2.4, "thickness": 0.4, "first_course": "y"}
    return derive_blocks(house(**size, walls=walls, openings=[window], materials=(Material("default", 20e3, 0.6),)))


@pytest.mark.parametrize("turn", [0.0, 0.6])
def test_a_stone_that_is_just_a_crossing_is_of_the_wall_whose_turn_it_is(turn: float) -> None:
    drawn = corner_with_a_window()
    turned = np.array([[np.cos(turn), np.sin(turn), 0.0], [-np.sin(turn), np.cos(turn), 0.0], [0.0, 0.0, 1.0]])
    stones = replace(drawn, points=drawn.points @ turned, centroid=drawn.centroid @ turned, panel=np.full(drawn.count, ""))
    fitted = fit_panels(stones)
    assert len({*zip(drawn.panel.tolist(), fitted.panel.tolist(), strict=True)}) == len(np.unique(drawn.panel))
    shell = derive_shell(fitted.building(), element_size=0.5)
    assert match_models(fitted.stones, find_contacts(stones), shell).passed
