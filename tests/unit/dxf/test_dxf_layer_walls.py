"""Stones drawn as solids without attributes: their layers name walls where each holds the stones of one."""

import math
from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path

import ezdxf
import numpy as np
import pytest

from churchpipe.dxf.reader import read_drawing
from churchpipe.recognition.panels import fit_panels, wall_names
from solids import Solid, box, prism

THICK, HIGH = 0.3, 0.25


def wall(x: float, y: float, *, along: int = 0, courses: int = 3) -> list[Solid]:
    """A wall of stones in running bond, 1.5 m long in x (along 0) or y, from a corner on."""
    out: list[Solid] = []
    for course in range(courses):
        ends = [0.0, 0.5, 1.0, 1.5] if course % 2 else [0.0, 0.25, 0.75, 1.25, 1.5]
        for low, high in pairwise(ends):
            reach = [(x, x + THICK), (y, y + THICK)]
            start = (x, y)[along]
            reach[along] = (start + low, start + high)
            out.append(box(reach[0], reach[1], (HIGH * course, HIGH * (course + 1))))
    return out


def drawn(path: Path, layers: Mapping[str, list[Solid]]) -> Path:
    document = ezdxf.new("R2010")
    document.header["$INSUNITS"] = 6
    for layer, solids in {"GROUND": [box((-1, 9), (-1, 9), (-0.5, 0))], **layers}.items():
        for points, faces in solids:
            with document.modelspace().add_mesh(dxfattribs={"layer": layer}).edit_data() as mesh:
                mesh.vertices, mesh.faces = points.tolist(), [list(face) for face in faces]
    document.saveas(path)
    return path


def test_layers_name_the_walls_whose_stones_they_hold(tmp_path: Path) -> None:
    path = drawn(tmp_path / "a.dxf", {"Nave": wall(0, 0), "aisle": wall(0, 3, along=1), "post": wall(4, 4)[:1]})
    drawing = read_drawing(path, unit_weight=18e3)
    stones = drawing.stones
    assert stones.panel.tolist() == [""] + ["NAVE"] * 11 + ["AISLE"] * 11 + ["POST"]
    assert sorted(panel.name for panel in fit_panels(stones).panels) == ["AISLE", "NAVE", "POST"]
    (unnamed,) = [finding for finding in drawing.findings if finding.code == "W22"]
    assert "named by handle, and walls by layer where each layer holds the stones of one plane wall" in unnamed.found


SEVERAL = {
    "one layer for all": {"STONES": wall(0, 0) + wall(0, 3)},
    "layers by storey": {"LOW": wall(0, 0, courses=1) + wall(4, 0, along=1, courses=1), "HIGH": wall(0, 5)},
    "layer 0": {"0": wall(0, 0), "AISLE": wall(0, 3)},
    "layers of the layout": {"CP-SOLID": wall(0, 0), "AISLE": wall(0, 3)},
}


@pytest.mark.parametrize("layers", SEVERAL.values(), ids=SEVERAL)
def test_layers_with_stones_of_several_walls_name_none(layers: Mapping[str, list[Solid]], tmp_path: Path) -> None:
    stones = read_drawing(drawn(tmp_path / "a.dxf", layers), unit_weight=18e3).stones
    assert set(stones.panel) == {""}
    # Where some were named, the walls of the others would not be known by their stones.
    assert set(wall_names(stones, None)) >= {"wall-1", "wall-2"}


def rubble(x: float, y: float, *, along: int = 0) -> list[Solid]:
    """A wall of stones through its whole thickness whose joints slant, so that each is a wedge."""
    courses: list[Solid] = []
    for course in range(3):
        for k in range(5):
            ends = [(0.3 * k + (0.02 * (-1) ** (k + level) if 0 < k < 5 else 0.0)) for level in (course, course + 1)]
            after = [(0.3 * (k + 1) + (0.02 * (-1) ** (k + 1 + level) if k < 4 else 0.0)) for level in (course, course + 1)]
            low, high = (
                [HIGH * level + (0.01 * (-1) ** j if 0 < level < 3 else 0.0) for j in (k, k + 1)]
                for level in (course, course + 1)
            )
            points, faces = prism([(ends[0], low[0]), (after[0], low[1]), (after[1], high[1]), (ends[1], high[0])], THICK)
            points = points if not along else points[:, [1, 0, 2]]
            courses.append((points + np.array([x, y, 0.0]), faces if not along else [face[::-1] for face in faces]))
    return courses


def test_a_layer_of_wedges_that_are_two_walls_names_none(tmp_path: Path) -> None:
    # They touch, as the stones of a vault do.
    layers = {"RUBBLE": rubble(0, 0) + rubble(0, THICK, along=1)}
    stones = read_drawing(drawn(tmp_path / "a.dxf", layers), unit_weight=18e3).stones
    assert set(stones.panel) == {""}
    assert set(wall_names(stones, None)) >= {"wall-1", "wall-2"}


def test_a_barrel_has_the_name_of_its_layer(tmp_path: Path) -> None:
    angle = [math.pi * (1 + k) / 10 for k in range(9)]
    barrel: list[Solid] = []
    for course, (s, t) in enumerate(pairwise(angle)):
        outline = [(4 + r * math.cos(a), 1 + r * math.sin(a)) for r, a in ((2.0, s), (2.4, s), (2.4, t), (2.0, t))]
        for low, high in pairwise([0, 1, 2] if course % 2 else [0, 0.5, 1.5, 2]):
            points, faces = prism(outline, high - low)
            barrel.append((points + np.array([0.0, 5 + low, 0.0]), faces))
    stones = read_drawing(drawn(tmp_path / "a.dxf", {"Ring": barrel, "aisle": wall(0, 3, along=1)}), unit_weight=18e3).stones
    assert stones.panel.tolist() == [""] + ["RING"] * len(barrel) + ["AISLE"] * 11
