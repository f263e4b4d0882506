"""Stones of one wall that have names of their own, as courses and bays drawn on layers: each is a part of the wall."""

from itertools import pairwise

import ezdxf
import numpy as np
import pytest

from churchpipe.config.shell_table import shell_table
from churchpipe.errors import InputError
from churchpipe.generators import house
from churchpipe.geometry.planar import area, common, extent, polygon
from churchpipe.match import match_models
from churchpipe.meshes.reader import read_stones
from churchpipe.recognition.panels import fit_panels
from churchpipe.shell_mesh.shell import derive_shell
from churchpipe.stones.blocks import derive_blocks
from churchpipe.stones.contacts import find_contacts


def drawn(folder, tower=0, **layers):
    """Return the stones of a wall of 6 x 2 m, eight courses of bricks of 1 x .25 m in running bond, drawn as outlines.

    tower: courses from x = 2 to 4 above it. layers: x and z between which the middles of their stones lie; the others are on the
    layer WALL.
    """
    document = ezdxf.new("R2010")
    document.header["$INSUNITS"] = 6
    for course in range(8 + tower):
        joints = [0, 1, 2, 3, 4, 5, 6] if course % 2 == 0 else [0, 0.5, 1.5, 2.5, 3.5, 4.5, 5.5, 6]
        if course >= 8:
            joints = [2, 3, 4] if course % 2 == 0 else [2, 2.5, 3.5, 4]
        low, high = 0.25 * course, 0.25 * course + 0.25
        for left, right in pairwise(joints):
            middle = (left + right) / 2, (low + high) / 2
            held = [name for name, ((x0, x1), (z0, z1)) in layers.items() if x0 <= middle[0] <= x1 and z0 <= middle[1] <= z1]
            name = held[0] if held else "WALL"
            outline = [(left, low), (right, low), (right, high), (left, high)]
            document.modelspace().add_lwpolyline(outline, close=True, dxfattribs={"layer": name})
    document.saveas(folder / "wall.dxf")
    return read_stones(folder / "wall.dxf", thickness=0.4, support="base", unit_weight=18e3)[0]


WHOLE = (0, 6)
# Where the middles of the stones of a part lie, and the corners of the part.
PARTS = {
    "cornice": ((WHOLE, (1.75, 2)), ((0, 1.75), (6, 2))),
    "plinth": ((WHOLE, (0, 0.25)), ((0, 0), (6, 0.25))),
    "band": ((WHOLE, (0.75, 1.25)), ((0, 0.75), (6, 1.25))),
    "low band": ((WHOLE, (0.25, 0.5)), ((0, 0.25), (6, 0.5))),
    # Four courses end at x = 2 and 4, the other four half a stone further out: the border lies at their mean.
    "bay": (((2, 4), (0, 2)), ((1.75, 0), (4.25, 2))),
    # Courses 4 and 6 end at x = 2 and 4, courses 5 and 7 half a stone further out.
    "upper bay": (((2, 4), (1, 2)), ((1.75, 1), (4.25, 2))),
    "upper corner": (((4, 6), (1, 2)), ((3.75, 1), (6, 2))),
    # Two of its courses end at x = 2 and 4, the one between them at 1.5 and 4.5.
    "patch": (((2, 4), (0.5, 1.25)), ((2 - 0.5 / 3, 0.5), (4 + 0.5 / 3, 1.25))),
}


@pytest.mark.parametrize("name", PARTS)
def test_stones_within_a_wall_are_a_part_of_it_from_border_to_border(name, tmp_path):
    middles, (lowest, highest) = PARTS[name]
    (wall,) = fit_panels(drawn(tmp_path, PART=middles)).panels
    (part,) = wall.parts
    assert (wall.name, part.name) == ("WALL", "PART")
    np.testing.assert_allclose([part.outline.min(axis=0), part.outline.max(axis=0)], [lowest, highest], atol=1e-6)


def test_plinth_and_cornice_of_one_course_are_both_parts(tmp_path):
    stones = drawn(tmp_path, PLINTH=(WHOLE, (0, 0.25)), CORNICE=(WHOLE, (1.75, 2)))
    (wall,) = fit_panels(stones).panels
    levels = {part.name: (part.outline[:, 1].min(), part.outline[:, 1].max()) for part in wall.parts}
    assert levels == {"PLINTH": (0, 0.25), "CORNICE": (1.75, 2)}


# Courses above the facade, where the middles of the stones of the layer lie, the wall they are in, and the parts.
TOWERS = {
    # The facade goes on at both sides of the tower, and below it: a border by equal areas lay at z = 5/3, and was moved to 2.
    "from the middle": (8, {"TOWER": ((2, 4), (1, 4))}, "WALL", {("TOWER", 2, 1, 4, 4)}),
    # The stones of its one course in the facade begin at 1.5 and end at 4.5.
    "by one course": (8, {"TOWER": ((2, 4), (1.75, 4))}, "WALL", {("TOWER", 1.5, 1.75, 4.5, 4)}),
    # A tower that is the larger part has the name of the wall; the wings are both called as they were drawn.
    "from the ground": (10, {"TOWER": ((2, 4), (0, 5))}, "TOWER", {("WALL", 0, 0, 2, 2), ("WALL", 4, 0, 6, 2)}),
}


@pytest.mark.parametrize("name", TOWERS)
def test_a_tower_that_rises_out_of_a_wall_begins_where_its_stones_do(name, tmp_path):
    courses, layers, main, parts = TOWERS[name]
    fitted = fit_panels(stones := drawn(tmp_path, courses, **layers))
    (wall,) = fitted.panels
    assert wall.name == main
    # A part may reach beyond the outline of its wall, where nothing is.
    covered = [(part.name, common(polygon(part.outline), polygon(wall.outline))) for part in wall.parts]
    assert {(part, *np.round(extent(region), 6).tolist()) for part, region in covered} == parts
    match = match_models(fitted.stones, find_contacts(stones), derive_shell(fitted.building(), 0.5))
    assert [figure.name for figure in match.figures if not figure.passed] == []


def test_why_there_is_no_shell_says_where(tmp_path, monkeypatch):
    def refuse(*_args, **_kwargs):
        raise InputError("wall WALL: opening door", "lies beside the wall", found="8 to 9 m", expected="within 0 to 6 m")

    monkeypatch.setattr("churchpipe.config.shell_table.fit_panels", refuse)
    note = shell_table(drawn(tmp_path), {"default": False}).note
    assert note.startswith("No shell: wall WALL: opening door: lies beside the wall; the rigid blocks stand alone.")


def test_walls_are_whole_beside_walls_that_get_thinner():
    # The upper storey crosses the gables beside its thicker lower one: the foot of the gables goes on to the far face of that.
    storeys = [{"above": 1.5, "thickness": 0.4}]
    walls = [
        {"name": "south", "start": (0, 0), "end": (4, 0), "toward": "+y", "storeys": storeys},
        {"name": "north", "start": (0, 3), "end": (4, 3), "toward": "-y", "storeys": storeys},
        {"name": "west", "start": (0, 0), "end": (0, 3), "toward": "+x"},
        {"name": "east", "start": (4, 0), "end": (4, 3), "toward": "-x"},
    ]
    building = house(course=0.3, stone_length=0.8, height=3.0, thickness=0.5, walls=walls)
    stones = derive_blocks(building)
    fitted = fit_panels(stones).building()
    meant = {panel.name: polygon(panel.outline) for panel in building.panels}
    found = {panel.name: polygon(panel.outline) for panel in fitted.panels}
    assert found.keys() == meant.keys()
    for name, outline in found.items():
        assert area(common(outline, meant[name])) == pytest.approx(max(area(outline), area(meant[name])))
    assert match_models(stones, find_contacts(stones), derive_shell(fitted, 0.5)).passed
