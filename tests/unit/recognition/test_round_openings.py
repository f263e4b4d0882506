"""Drawn round walls with arched openings: whole stones tell the wall, cut ones are counted and make no plane wall."""

import math
from dataclasses import replace

import numpy as np
import pytest

from churchpipe import derive_blocks, read_case, repair_polyhedra
from churchpipe.config.shell_table import shell_table
from churchpipe.errors import InputError
from churchpipe.model.arrays import ragged_indices
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import CylinderChart
from churchpipe.recognition.panels import FittedPanels, fit_panels
from churchpipe.resources import pipeline_folder

# Radii of the faces of the round tower.
FACES = (1.4, 2.0)


def drawn(name: str, *, named: bool = True) -> Assemblage:
    stones = derive_blocks(read_case(pipeline_folder() / "cases" / f"{name}.toml").building())
    return stones if named else replace(stones, panel=np.full(stones.count, ""))


def turned(stones: Assemblage, angle: float, digits: int) -> Assemblage:
    """Return stones turned in plan, as they are read from a file with so many digits."""
    about = np.array([[math.cos(angle), math.sin(angle), 0.0], [-math.sin(angle), math.cos(angle), 0.0], [0.0, 0.0, 1.0]])
    bodies = [(np.round(points @ about, digits), faces) for points, faces in map(stones.solid, range(stones.count))]
    bodies, _ = repair_polyhedra(bodies)
    return Assemblage.from_polyhedra(bodies, 18e3, np.flatnonzero(stones.fixed).tolist())


def off_circles(stones: Assemblage) -> set[str]:
    """Return the free stones of a tower about the origin that have a corner on neither circle."""
    found = set()
    for block in np.flatnonzero(~stones.fixed):
        own = ragged_indices(stones.block_point_ptr[block : block + 1], np.diff(stones.block_point_ptr)[block : block + 1])
        radius = np.linalg.norm(stones.points[own, :2], axis=1)
        if np.abs(np.subtract.outer(radius, FACES)).min(axis=1).max() > 1e-6:
            found.add(str(stones.block_id[block]))
    return found


@pytest.mark.parametrize("named", [True, False])
def test_a_drawn_round_tower_with_a_door_and_windows_is_one_wall_and_the_stones_cut_by_them(named: bool) -> None:
    stones = drawn("round_tower", named=named)
    fitted = fit_panels(stones)
    assert [type(panel.chart) for panel in fitted.panels] == [CylinderChart]
    assert fitted.panels[0].thickness == pytest.approx(0.6, abs=1e-9)
    assert set(fitted.unfit.tolist()) == off_circles(stones)
    note = shell_table(stones, {"default": False}).note
    name, cut = "round" if named else "curved-wall-1", len(fitted.unfit)
    assert note.startswith(f"1 wall fitted for the shell: {name}. {cut} stones fit none: ")
    assert note.endswith(f" {cut} of them lie in a round wall with corners off its two circles, as around an arched opening.")


def test_a_turned_and_rounded_round_tower_is_one_wall_too() -> None:
    exact = drawn("round_tower", named=False)
    fitted = fit_panels(turned(exact, 0.3, 3))
    assert [type(panel.chart) for panel in fitted.panels] == [CylinderChart]
    assert len(fitted.unfit) == len(off_circles(exact))


def test_stones_named_by_the_wall_that_was_fitted_to_them_are_fitted_alike() -> None:
    # A run names the stones of a drawing by their walls, and fits the walls again.
    first = fit_panels(drawn("round_tower", named=False))
    again = fit_panels(replace(drawn("round_tower"), panel=first.panel))
    assert [panel.name for panel in again.panels] == [panel.name for panel in first.panels]
    assert again.unfit.tolist() == first.unfit.tolist()


def test_an_apse_with_a_window_leaves_the_wall_that_it_is_toothed_into_whole() -> None:
    stones = drawn("apse_window", named=False)
    fitted = fit_panels(stones)
    wall = drawn("apse_window").panel == "wall"
    assert {panel.name for panel in fitted.panels} == {"curved-wall-1", "wall-1"}
    assert set(np.flatnonzero(fitted.panel == "wall-1")) == set(np.flatnonzero(wall))
    assert 0 < len(fitted.unfit) < 0.1 * np.count_nonzero(~wall)


def test_walls_that_are_no_building_are_no_shell(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*_args: object, **_kwargs: object) -> None:
        raise InputError("Building drawing", "names of panels and parts of vaults are not unique")

    monkeypatch.setattr(FittedPanels, "building", refused)
    table = shell_table(drawn("round_tower"), {"default": False})
    assert table.fitted is None
    assert table.note.startswith("No shell: Building drawing: names of panels")
