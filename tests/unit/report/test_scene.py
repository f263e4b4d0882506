"""The scene of a picture: its size, its smooth edges, and what lies under something translucent."""

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyvista as pv
from matplotlib.image import imread

from churchpipe.report.figures import scene


def drawn(path: Path, *things: tuple[Any, dict[str, Any]]) -> np.ndarray:
    with scene(path, (150, 110)) as plotter:
        for mesh, look in things:
            plotter.add_mesh(mesh, lighting=False, **look)
        plotter.view_xy()
    return imread(path)[..., :3]


def test_a_picture_has_the_size_that_is_asked_for_and_smooth_edges(tmp_path: Path) -> None:
    triangle = pv.Triangle([(0.0, 0.0, 0.0), (3.0, 0.5, 0.0), (0.2, 2.0, 0.0)])
    pixels = drawn(tmp_path / "triangle.png", (triangle, {"color": "black"}))
    assert pixels.shape == (110, 150, 3)
    # White, black, and of the pixels at the edges one to three samples of four.
    assert {0, 64, 128, 191, 255} <= {round(255 * float(grey)) for grey in np.unique(pixels)}


@pytest.mark.parametrize("opacity", [0.25, 0.6])
def test_what_is_translucent_lets_through_its_share_of_what_is_behind(opacity: float, tmp_path: Path) -> None:
    behind = pv.Plane(center=(0, 0, -1), direction=(0, 0, 1), i_size=3, j_size=3)
    before = pv.Plane(center=(0, 0, 0), direction=(0, 0, 1), i_size=3, j_size=3)
    pixels = drawn(tmp_path / "planes.png", (behind, {"color": "red"}), (before, {"color": "blue", "opacity": opacity}))
    np.testing.assert_allclose(pixels[55, 75], [1 - opacity, 0, opacity], atol=0.01)


def test_a_scene_in_which_something_fails_leaves_no_picture(tmp_path: Path) -> None:
    with pytest.raises(ZeroDivisionError), scene(tmp_path / "none.png", (150, 110)):
        raise ZeroDivisionError
    assert not list(tmp_path.iterdir())


def test_without_a_screen_a_picture_is_drawn_in_silence(tmp_path: Path) -> None:
    """As on a server, from which a notebook is used: VTK looks for an X server first, and complained."""
    drawing = "import sys; from churchpipe.report.figures import scene\nwith scene(sys.argv[1], (60, 40)): pass"
    environment = {name: value for name, value in os.environ.items() if name != "DISPLAY"}
    command = [sys.executable, "-c", drawing, str(tmp_path / "picture.png")]
    found = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert imread(tmp_path / "picture.png").shape[:2] == (40, 60)
    assert (found.stdout, found.stderr) == ("", "")
