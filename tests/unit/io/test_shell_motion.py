"""What the file of a shell's mechanism calls its motion."""

from pathlib import Path

import numpy as np
import pytest
import pyvista

from churchpipe.generators import wall
from churchpipe.io.shell_vtu import write_shell_mechanism
from churchpipe.model.results import CapacityCurve, Status
from churchpipe.shell_mesh.shell import derive_shell


@pytest.mark.parametrize(("status", "name"), [("converged", "displacement"), ("unstable", "velocity")])
def test_the_motion_of_a_shell_that_falls_is_no_displacement(tmp_path: Path, status: Status, name: str) -> None:
    shell = derive_shell(wall(length=1.5, brick=(0.5, 0.3, 0.25), courses=4), 0.5)
    nothing, moved = np.zeros(0), 2.0 * shell.points
    plastic = np.ones((len(shell.triangles), 6))
    state = CapacityCurve(nothing, nothing, 0, moved, nothing, plastic, np.zeros((len(plastic), 0)), (), status)
    write_shell_mechanism(tmp_path / "mechanism.vtu", shell, state)
    grid = pyvista.read(tmp_path / "mechanism.vtu")
    assert {"displacement", "velocity"} & set(grid.point_data) == {name}
    np.testing.assert_array_equal(grid.point_data[name], moved)
