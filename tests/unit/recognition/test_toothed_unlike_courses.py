"""Drawn walls toothed into one another on courses of unlike height: which of the two fills each part of their junction."""

from itertools import pairwise

import numpy as np
import pytest

from churchpipe.errors import InputError
from churchpipe.match import match_models
from churchpipe.model.assemblage import Assemblage
from churchpipe.recognition.panels import fit_panels
from churchpipe.shell_mesh.shell import derive_shell
from churchpipe.stones.contacts import find_contacts
from solids import box

ALONG, ACROSS, STONE = 0.4, 0.3, 0.6
UNLIKE = (0.4, 0.2, 0.3, 0.2, 0.35, 0.15, 0.25, 0.25)
TURNS = (0.3, 0.2) * 4
GROUND = box((-1.0, 4.0), (-1.0, 4.0), (-0.2, 0.0))


def _row(start: float, stop: float, first: float):
    """Return where the stones of a course begin and end, the first one so long."""
    ends = [start, *np.arange(start + first, stop - 0.1 * STONE, STONE), stop]
    return list(pairwise(ends))


def _walls(heights, middle: float, bonds) -> tuple[Assemblage, list[float]]:
    """Return a wall along x and one behind it that starts in it, `middle` from its end, and their volumes, m3; bonds: on which
    courses the second wall runs through."""
    solids, panel, levels = [], [], np.concatenate([[0.0], np.cumsum(heights)])
    for course, z in enumerate(pairwise(levels)):
        if bonds(course):
            along = _row(0.0, middle, STONE) if middle > 0 else []
            along += _row(middle + ACROSS, 3.0, 0.5 * STONE)
            across = _row(0.0, 2.5, STONE)
        else:
            along, across = _row(0.0, 3.0, STONE), _row(ALONG, 2.5, 0.5 * STONE)
        solids += [box(x, (0.0, ALONG), z) for x in along] + [box((middle, middle + ACROSS), y, z) for y in across]
        panel += ["along"] * len(along) + ["across"] * len(across)
    stones = Assemblage.from_polyhedra([GROUND, *solids], 18e3, fixed=[0], panel=["", *panel])
    return stones, [float(stones.volume[stones.panel == name].sum()) for name in ("along", "across")]


def _alternating(course: int) -> bool:
    return course % 2 == 1


@pytest.mark.parametrize("heights", [UNLIKE, TURNS], ids=["unlike", "in turn"])
@pytest.mark.parametrize("middle", [0.0, 1.2], ids=["corner", "T"])
def test_walls_are_toothed_on_courses_of_unlike_height(heights, middle) -> None:
    stones, volumes = _walls(heights, middle, _alternating)
    fitted = fit_panels(stones)
    shell = derive_shell(fitted.building(), element_size=0.5)
    for name, volume in zip(("along", "across"), volumes, strict=True):
        assert abs(shell.weight[shell.panel == name].sum() / (18e3 * volume) - 1) < 1e-6
    assert match_models(fitted.stones, find_contacts(stones), shell).passed


def test_a_wall_may_be_first_at_one_end_and_second_at_the_other() -> None:
    heights = np.arange(9) * 0.25
    solids, panel = [], []
    for course, z in enumerate(pairwise(heights)):
        left, right = course % 2 == 1, course % 2 == 0
        along = _row(ACROSS if left else 0.0, 3.0 - ACROSS if right else 3.0, STONE)
        solids += [box(x, (0.0, ALONG), z) for x in along]
        panel += ["along"] * len(along)
        for name, start, runs in (("left", 0.0, left), ("right", 3.0 - ACROSS, right)):
            across = _row(0.0 if runs else ALONG, 2.5, STONE)
            solids += [box((start, start + ACROSS), y, z) for y in across]
            panel += [name] * len(across)
    stones = Assemblage.from_polyhedra([GROUND, *solids], 18e3, fixed=[0], panel=["", *panel])
    fitted = fit_panels(stones)
    assert match_models(fitted.stones, find_contacts(stones), derive_shell(fitted.building(), element_size=0.5)).passed


@pytest.mark.parametrize("middle", [0.0, 1.2], ids=["corner", "T"])
@pytest.mark.parametrize(("every", "turns"), [(3, 8), (4, 6), (12, 2)])
def test_walls_with_few_bonding_stones_have_no_shell(every: int, turns: int, middle: float) -> None:
    # The shell would overrate their bond, and weights tell it only where walls are short.
    stones, _ = _walls((0.25,) * 12, middle, lambda course: course % every == 1)
    fitted = fit_panels(stones)
    message = rf"junction of across and along: .* too seldom for the shell \(they take turns at {turns} of 11 beds\)"
    with pytest.raises(InputError, match=message):
        fitted.building()
    assert sorted(set(fitted.panel.tolist())) == ["", "across", "along"]


def test_half_courses_that_are_toothed_two_by_two_are_bonded_at_each_bed_of_the_other_wall() -> None:
    solids, panel = [], []
    for course, z in enumerate(pairwise(np.arange(9) * 0.25)):
        runs, half = course % 2 == 1, 0.5 * sum(z)
        along = _row(ACROSS if runs else 0.0, 3.0, STONE)
        across = _row(0.0 if runs else ALONG, 2.5, STONE)
        solids += [box(x, (0.0, ALONG), z) for x in along]
        solids += [box((0.0, ACROSS), y, part) for y in across for part in ((z[0], half), (half, z[1]))]
        panel += ["along"] * len(along) + ["across"] * 2 * len(across)
    stones = Assemblage.from_polyhedra([GROUND, *solids], 18e3, fixed=[0], panel=["", *panel])
    assert not fit_panels(stones).seldom


def test_nothing_joins_walls_of_a_drawing_that_butt() -> None:
    stones, _ = _walls((0.25,) * 8, 0.0, lambda _: False)
    shell = derive_shell(fit_panels(stones).building(), element_size=0.5)
    nodes = [set(shell.triangles[shell.panel == name].ravel().tolist()) for name in ("along", "across")]
    assert all(nodes)
    assert not nodes[0] & nodes[1]


def test_courses_of_one_height_need_no_account_of_what_a_wall_fills() -> None:
    stones, _ = _walls((0.25,) * 8, 0.0, _alternating)
    assert not any(len(panel.filled) for panel in fit_panels(stones).panels)
