"""Stones drawn as solids without attributes: their layers name walls where each holds the stones of one."""

from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path

import ezdxf
import pytest

from churchpipe.dxf.reader import read_drawing
from churchpipe.recognition.panels import fit_panels, wall_names
from solids import Solid, box

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
