"""Stones that no shell is fitted to."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from churchpipe import derive_blocks, read_dxf, with_ring_beams, write_dxf
from churchpipe.config.shell_table import shell_table
from churchpipe.errors import InputError
from churchpipe.generators import box
from churchpipe.model.assemblage import Assemblage
from churchpipe.recognition.panels import fit_panels
from churchpipe.shell_mesh.shell import derive_shell
from solids import box as solid


@pytest.fixture(scope="module")
def room():
    return derive_blocks(box(length=2.0, width=1.5, brick=(0.5, 0.25, 0.25), courses=4))


def test_a_drawn_ring_beam_is_not_taken_for_a_course_of_its_wall(room, tmp_path):
    # Same material as the walls: weights agree, so that the match gate would not tell.
    write_dxf(with_ring_beams(room, ["south", "north"], height=0.25, unit_weight=18e3), tmp_path / "beam.dxf")
    drawn, _ = read_dxf(tmp_path / "beam.dxf", unit_weight=18e3)
    with pytest.raises(InputError, match="has no ring beams, such as beam on south"):
        fit_panels(drawn)
    table = shell_table(drawn, {"default": False})
    assert table.fitted is None
    assert table.note.startswith("No shell: the shell fitted to stones has no ring beams, such as beam on south;")


def test_an_import_says_as_the_run_does_that_walls_that_butt_have_no_shell(room):
    butting = replace(room, butts=room.panel == "east")
    note = shell_table(butting, {"default": False}).note
    assert note.startswith("No shell: the shell fitted to stones has no butt joints, as of the stones of east;")


def test_stones_that_project_beyond_their_wall_are_said_to():
    # Corbels, each longer than the wall is thick, in one of its courses.
    solids = [solid((-1.0, 5.0), (-1.0, 1.0), (-0.3, 0.0))]
    for course in range(8):
        ends = [0.0, *(0.25 * (course % 2) + 0.5 * np.arange(1 - course % 2, 8)), 4.0]
        for number, along in enumerate(pairwise(ends)):
            depth = 0.5 if course == 5 and number % 2 else 0.3
            solids.append(solid(along, (0.0, depth), (0.25 * course, 0.25 * (course + 1))))
    fitted = fit_panels(Assemblage.from_polyhedra(solids, 18e3, fixed=[0]))
    with pytest.raises(InputError, match=r"walls wall-1 and wall-2: they are parallel, .* stones that project beyond their wall"):
        derive_shell(fitted.building(), element_size=0.5)
