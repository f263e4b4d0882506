"""Beds of stones that are drawn without courses: which of their joints the match gate takes for beds."""

import pytest
import shapely

from churchpipe.match import match_models
from churchpipe.recognition.panels import fit_panels
from churchpipe.shell_mesh.shell import derive_shell
from churchpipe.stones.contacts import find_contacts
from relieving_arch import arch_in_wall, stones_of

# A door below the arch, and the lintel over it.
DOOR, LINTEL = shapely.box(1.5, 0.0, 2.5, 1.5), shapely.box(1.25, 1.5, 2.75, 1.75)


def _stairs() -> list[shapely.Polygon]:
    return [shapely.box(0.4 * s, 0.2 * t, 0.4 * (s + 1), 0.2 * (t + 1)) for s in range(6) for t in range(s + 1)]


def _with_a_door() -> list[shapely.Polygon]:
    cut = shapely.get_parts([outline.difference(DOOR).difference(LINTEL) for outline in arch_in_wall(0.5)])
    return [*(part for part in cut if part.area > 1e-9), LINTEL]


@pytest.mark.parametrize(
    "outlines",
    [
        # The first step has one neighbour beside it and stands on the ground: it is no voussoir.
        pytest.param(_stairs, id="steps in stack bond"),
        # The stones of the wall beside a voussoir share more of its surface than the voussoirs that it lies on.
        pytest.param(lambda: arch_in_wall(0.5), id="relieving arch"),
        pytest.param(_with_a_door, id="relieving arch over a lintel"),
    ],
)
def test_no_stone_is_turned(outlines) -> None:
    stones = stones_of(outlines())
    fitted = fit_panels(stones)
    match = match_models(fitted.stones, find_contacts(stones), derive_shell(fitted.building(), element_size=0.3))
    assert {figure.name: figure.shell for figure in match.figures}["stones turned by more than 20 degrees"] == 0
    assert match.passed
