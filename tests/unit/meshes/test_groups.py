"""Groups of an OBJ name the walls whose stones they hold, as layers of a drawing do."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.generators import house
from churchpipe.recognition.panels import fit_panels
from mesh_files import write_obj
from solids import box, prism


def grouped(path: Path, group: dict[str, str]) -> Path:
    """Put each object of an OBJ into its group."""
    lines = path.read_text().splitlines()
    path.write_text("\n".join(f"{line}\ng {group[line[2:]]}" if line[:2] == "o " else line for line in lines) + "\n")
    return path


def test_walls_of_stones_written_as_obj_come_back_by_their_names(tmp_path: Path) -> None:
    walls = [
        {"name": "south", "start": (0, 0), "end": (4, 0), "toward": "+y"},
        {"name": "west", "start": (0, 0), "end": (0, 3), "toward": "+x"},
    ]
    stones = cp.derive_blocks(house(course=0.5, stone_length=1.0, height=2.0, thickness=0.5, walls=walls))
    cp.write_obj(stones, tmp_path / "a.obj")
    read, _ = cp.read_stones(tmp_path / "a.obj", unit_weight=18e3)
    free = ~stones.fixed
    assert (
        dict(zip(read.block_id.tolist(), read.panel.tolist(), strict=True)).items()
        >= dict(zip(stones.block_id[free].tolist(), stones.panel[free].tolist(), strict=True)).items()
    )
    assert sorted(panel.name for panel in fit_panels(read).panels) == ["south", "west"]


def test_a_fill_lies_on_the_ring_of_a_bridge_that_a_group_names(tmp_path: Path) -> None:
    angle = np.linspace(np.pi / 4, 3 * np.pi / 4, 8)
    ring = [[(r * np.cos(a), r * np.sin(a)) for r, a in ((5.0, s), (5.6, s), (5.6, t), (5.0, t))] for s, t in pairwise(angle)]
    solids = [box((-6, 6), (-1, 3), (-1, 0)), *(prism(outline, 3.0) for outline in ring)]
    stones = cp.Assemblage.from_polyhedra(solids, 20e3, fixed=[0], block_id=["ground", *(f"v{k}" for k in range(7))])
    path = write_obj(stones, tmp_path / "a.obj")
    names = dict.fromkeys(stones.block_id.tolist(), "ring") | {"ground-0": "base"}
    read, _ = cp.read_stones(grouped(path, names), unit_weight=20e3)
    assert read.panel.tolist() == [""] + ["ring"] * 7
    load = cp.with_fill(cp.LoadCase((1, 0, 0)), read, "ring", 6.0, 18e3)
    # Between z = 6 and the chords of the extrados, 3 m wide.
    x, z = 5.6 * np.cos(angle), 5.6 * np.sin(angle)
    column = float(-np.trapezoid(6.0 - z, x))
    assert load.dead is not None
    assert load.dead[:, 2].sum() == pytest.approx(-18e3 * 3.0 * column)


def test_a_group_around_each_stone_names_no_walls(tmp_path: Path) -> None:
    stones = cp.Assemblage.from_polyhedra(
        [box((-1, 2), (-1, 1), (-1, 0)), box((0, 1), (0, 0.5), (0, 0.5)), box((0, 1), (0, 0.5), (0.5, 1))], 18e3, fixed=[0]
    )
    names = {name: name for name in ("ground-0", *stones.block_id.tolist())}
    path = grouped(write_obj(stones, tmp_path / "a.obj"), names)
    assert cp.read_stones(path, unit_weight=18e3, support="base")[0].panel.tolist() == [""] * 3
