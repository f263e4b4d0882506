"""The shell takes the stones to be as long as they are laid."""

import numpy as np
import pytest

from churchpipe.generators import box
from churchpipe.model.building import BondRegion, Building, Panel, PlaneChart, UnitCell
from churchpipe.model.materials import Material
from churchpipe.shell_mesh.shell import derive_shell
from churchpipe.stones.blocks import derive_blocks

MATERIAL = Material("default", 18e3, 0.6)


@pytest.mark.parametrize(
    ("pattern", "lengths"), [("running", [2.6 / 3, 1.1]), ("stack", [2.6 / 3, 1.1]), ("header-stretcher", [0.9, 1.4])]
)
def test_stones_of_a_bay_that_is_divided_evenly_are_as_long_in_the_shell_as_they_are_laid(pattern, lengths):
    # Clear bays of 2.6 and 2.2 m, for stones of 1 m: three of .867 m and two of 1.1 m. In two leaves the bays are .8 m shorter:
    # two of .9 m and one of 1.4 m.
    building = box(length=3.4, width=3.0, courses=8, brick=(1.0, 0.4, 0.3), joints="bay", pattern=pattern, materials=(MATERIAL,))
    stones, shell = derive_blocks(building), derive_shell(building, 0.5)
    b = shell.unit_cells[shell.cell, 1]
    for panel in building.panels:
        assert isinstance(panel.chart, PlaneChart)
        (length,) = np.unique(b[shell.panel == panel.name])
        along = stones.points @ panel.chart.s_axis
        laid = [
            np.ptp(along[start:stop]) for start, stop in zip(stones.block_point_ptr[:-1], stones.block_point_ptr[1:], strict=True)
        ]
        assert np.abs(np.array(laid)[stones.panel == panel.name] - length).min() < 1e-9
    assert np.unique(b).tolist() == pytest.approx(lengths, abs=1e-9)


def test_each_bay_of_a_wall_has_its_own_stones_below_and_above_the_top_of_the_wall_that_crosses_it():
    # x is crossed from 2.7 to 3.3 m, up to 2.2 m: two bays of 2.7 m, five stones of .54 m each. y has bays of 2.55 m on one side
    # of x (four stones of .6375 m) and 3.05 m on the other (five of .61 m).
    shell = derive_shell(
        Building("cross", (_wall("x", (0, 0, 0), 6, 3.3, 0.9, 0), _wall("y", (3, -3, 0), 6.5, 2.2, 0.6, 1)), (MATERIAL,)), 0.5
    )
    middle, b = shell.points[shell.triangles].mean(axis=1), shell.unit_cells[shell.cell, 1]
    y = shell.panel == "y"
    assert np.unique(b[~y]).tolist() == pytest.approx([0.54])
    np.testing.assert_allclose(b[y], np.where(middle[y, 1] < 0, 0.6375, 0.61))


def test_a_bay_shorter_than_half_a_stone_keeps_the_length_that_was_asked_for():
    # y goes .2 m beyond the face of x.
    building = Building("t", (_wall("x", (0, 0, 0), 6, 2.2, 0.9, 0), _wall("y", (3, -0.65, 0), 4.0, 2.2, 0.6, 1)), (MATERIAL,))
    shell = derive_shell(building, 0.5)
    middle, b = shell.points[shell.triangles].mean(axis=1), shell.unit_cells[shell.cell, 1]
    y = shell.panel == "y"
    np.testing.assert_allclose(b[y], np.where(middle[y, 1] < 0, 0.57, 2.9 / 5))


def test_the_upper_part_of_a_wall_that_slopes_has_the_stones_of_its_whole_bay():
    # From 2.2 m on x is .6 m thick and not .9 m. There y, which slopes, has a bay of 3.7 m, six stones of .61667 m; below, one of
    # 3.55 m, six of .59167 m.
    slope = np.array([[0, 0], [4.45, 0], [4.45, 1.1], [2.45, 3.85], [0, 3.85]])
    walls = (
        _wall("x", (0, 0, 0), 6, 2.2, 0.9, 0),
        _wall("x above", (0, 0, 0), 6, 0, 0.6, 0, np.array([[0, 2.2], [6, 2.2], [6, 3.85], [0, 3.85]])),
        _wall("y", (3, -0.45, 0), 4.45, 3.85, 0.6, 1, slope),
    )
    shell = derive_shell(Building("buttress", walls, (MATERIAL,)), 0.5)
    middle, b = shell.points[shell.triangles].mean(axis=1), shell.unit_cells[shell.cell, 1]
    y = (shell.panel == "y") & (middle[:, 1] > 0.3)
    np.testing.assert_allclose(b[y], np.where(middle[y, 2] < 2.2, 3.55 / 6, 3.7 / 6))


def _wall(name, origin, length, height, thickness, parity, outline=None):
    axis = np.array([0, 1.0, 0] if name == "y" else [1.0, 0, 0])
    rectangle = np.array([[0, 0], [length, 0], [length, height], [0, height]], dtype=float)
    outline = rectangle if outline is None else outline
    bond = BondRegion("bond", outline, "running", UnitCell(a=0.275, b=0.57), joints="bay")
    return Panel(name, PlaneChart(np.array(origin, dtype=float), axis), outline, thickness, (bond,), runs_through=parity)
