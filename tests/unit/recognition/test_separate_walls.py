"""Walls in one plane that do not touch: each has a panel of its own, and nothing of them is missing from the shell."""

import math
from dataclasses import replace

import numpy as np
import pytest

from churchpipe.config.shell_table import shell_table
from churchpipe.errors import InputError
from churchpipe.loading.placing import place_loads
from churchpipe.match import match_models
from churchpipe.model.carried import LineLoad
from churchpipe.recognition.panels import fit_panels
from churchpipe.recognition.separate_walls import separate_walls
from churchpipe.recognition.stone_walls import stone_walls
from churchpipe.shell_mesh.shell import derive_shell
from churchpipe.stones.contacts import find_contacts
from solids import box, on_ground, prism

THICKNESS = 0.6


def bricks(start, length, courses, brick=0.5, height=0.25):
    """A wall in running bond along x."""
    found = []
    for course in range(courses):
        edges = np.arange(0.0, length + brick, brick) - (0.5 * brick if course % 2 else 0.0)
        for low, high in zip(np.clip(edges[:-1], 0, length), np.clip(edges[1:], 0, length), strict=True):
            if high > low:
                found.append(box((start + low, start + high), (0.0, THICKNESS), (course * height, (course + 1) * height)))
        if edges[-1] < length:
            found.append(box((start + edges[-1], start + length), (0.0, THICKNESS), (course * height, (course + 1) * height)))
    return found


def voussoirs(count, begin, end, radius=2.0, depth=0.6, springing=0.0):
    """Part of an arch about x = 0, from one angle to another (rad)."""
    angle = np.linspace(begin, end, count + 1)
    spoke = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    inner, outer = radius * spoke + [0.0, springing], (radius + depth) * spoke + [0.0, springing]
    return [prism([tuple(p) for p in (inner[k], outer[k], outer[k + 1], inner[k + 1])], THICKNESS) for k in range(count)]


def gate(stones, loads=()):
    fitted = fit_panels(stones)
    shell = derive_shell(fitted.building(), 0.2)
    placed = [place_loads(fitted.stones, loads)] if loads else None
    return fitted, match_models(fitted.stones, find_contacts(stones), shell, placed)


@pytest.mark.parametrize(("count", "foot"), [(3, 0), (9, 0), (2, 3), (3, 3), (4, 3)])
def test_an_arch_that_ends_at_its_crown_passes(count, foot):
    # The last stone has one joint only: its bed lies between that joint and the face in which it ends.
    pier = [box((-2.6, -2.0), (0.0, THICKNESS), (0.3 * k, 0.3 * k + 0.3)) for k in range(foot)]
    fitted, match = gate(on_ground(*pier, *voussoirs(count, math.pi, 0.5 * math.pi, springing=0.3 * foot)))
    assert [panel.name for panel in fitted.panels] == ["wall-1"]
    assert match.passed, [figure for figure in match.figures if not figure.passed]


@pytest.mark.parametrize("count", [3, 8])
def test_two_halves_of_an_arch_are_two_walls(count):
    left, right = (voussoirs(count, foot, 0.5 * math.pi + lost) for foot, lost in ((math.pi, 0.15), (0.0, -0.15)))
    fitted, match = gate(on_ground(*left, *right))
    assert match.passed
    assert [[region.pieces for region in panel.regions] for panel in fitted.panels] == [[count], [count]]


def test_each_of_three_piers_in_a_row_is_a_wall():
    fitted, match = gate(on_ground(*bricks(0.0, 1.0, 6), *bricks(3.0, 2.0, 8), *bricks(7.0, 0.75, 4)))
    assert match.passed
    assert len(fitted.unfit) == 0
    assert sorted(float(np.ptp(panel.outline[:, 0])) for panel in fitted.panels) == pytest.approx([0.75, 1.0, 2.0])
    assert all(panel.outline[:, 0].min() == pytest.approx(0.0, abs=1e-9) for panel in fitted.panels)
    assert sorted(set(fitted.panel[1:].tolist())) == ["wall-1", "wall-2", "wall-3"]


def test_a_wall_apart_gets_a_name_that_no_part_of_another_has():
    stones = on_ground(*bricks(0.0, 2.0, 6), *bricks(3.0, 1.5, 6))
    (wall,), _ = stone_walls(stones, 1e-3)
    # As of stones that were joined to the wall from a plane of their own.
    joined = replace(wall, tag=np.where(wall.stones < 4, "wall-2", wall.tag))
    walls, _ = separate_walls(stones, [joined], 1e-3)
    assert [one.name for one in walls] == ["wall-1", "wall-3"]
    assert [sorted(set(one.tag.tolist())) for one in walls] == [["wall-1", "wall-2"], ["wall-3"]]


def test_the_note_of_an_import_says_which_names_no_load_can_have():
    piers = on_ground(*bricks(0.0, 2.0, 6), *bricks(3.0, 1.5, 6))
    assert "No stones are called" not in shell_table(piers, {"default": False}).note
    named = replace(piers, panel=np.where(piers.fixed, "", "piers"))
    said = (
        "fitted for the shell: piers, piers-2. No stones are called piers-2: a load on the name in the drawing reaches all walls"
    )
    assert said in shell_table(named, {"default": False}).note


def test_a_load_on_a_name_reaches_both_of_its_walls():
    stones = on_ground(*bricks(0.0, 2.0, 6), *bricks(3.0, 1.5, 6))
    named = replace(stones, panel=np.where(stones.fixed, "", "north"))
    fitted, match = gate(
        named, [LineLoad("north", begin=0.0, end=2.0, dead=5e3), LineLoad("north", begin=3.0, end=4.5, dead=5e3)]
    )
    assert [panel.name for panel in fitted.panels] == ["north", "north-2"]
    assert set(fitted.panel[1:].tolist()) == {"north"}
    assert match.passed, [figure for figure in match.figures if not figure.passed]


def test_walls_on_both_sides_of_a_wall_that_crosses_them_are_one():
    crossing = [
        box((1.0, 1.6), (-1.2 + 0.6 * k, -0.6 + 0.6 * k), (0.25 * c, 0.25 * c + 0.25)) for k in range(5) for c in range(6)
    ]
    fitted, match = gate(on_ground(*bricks(0.0, 1.0, 6), *bricks(1.6, 1.5, 6), *crossing))
    assert len(fitted.panels) == 2
    assert match.passed


def test_a_stone_too_far_from_its_wall_is_named():
    apart = on_ground(*bricks(0.0, 2.0, 6), box((4.0, 4.5), (0.0, THICKNESS), (0.0, 0.25)))
    fitted = fit_panels(apart)
    assert fitted.unfit.tolist() == [str(apart.block_id[-1])]
    with pytest.raises(InputError, match="no wall"):
        fit_panels(on_ground(box((4.0, 4.5), (0.0, THICKNESS), (0.0, 0.25))))
