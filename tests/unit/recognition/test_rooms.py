"""A room in both ways: the shell of a case, and the shell fitted to its stones, which have the lengths that were laid."""

from dataclasses import replace

import numpy as np
import pytest

from churchpipe.generators import box
from churchpipe.homogenised_shell.limit import shell_limit_analysis
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import Material
from churchpipe.recognition.panels import fit_panels
from churchpipe.shell_mesh.shell import derive_shell
from churchpipe.stones.blocks import derive_blocks

MATERIAL = Material("default", 18e3, 0.6)


@pytest.mark.parametrize(
    "seed", [None, *(pytest.param(seed, marks=pytest.mark.slow("docs/shell.md: random rooms")) for seed in range(5))]
)
def test_the_shell_of_a_room_is_as_strong_as_the_one_fitted_to_its_stones(seed):
    length, width, stone = (
        (3.4, 3.4, 1.0) if seed is None else np.random.default_rng(seed).uniform([3, 3, 0.6], [5, 5, 1.1]).tolist()
    )
    room = box(length=length, width=width, courses=10, brick=(stone, 0.4, 0.3), joints="bay", materials=(MATERIAL,))
    drawn = replace(room, panels=fit_panels(derive_blocks(room)).panels)
    found, expected = (
        shell_limit_analysis(derive_shell(building, 0.4), LoadCase([1, 0, 0]), room.materials).load_factor
        for building in (room, drawn)
    )
    assert found == pytest.approx(expected, rel=5e-3)
    if seed is None:
        assert found == pytest.approx(0.3256, abs=5e-5)
