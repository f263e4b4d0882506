"""A roof that lies on walls out to their ends, where gables go on above it."""

import pytest

import churchpipe as cp
from churchpipe import generators

MASONRY = (cp.Material("default", 18e3, 0.6),)
GABLE = {"ridge": 4.2}
WALLS = [
    {"name": "south", "start": (0, 0), "end": (6, 0), "toward": "+y"},
    {"name": "north", "start": (0, 5), "end": (6, 5), "toward": "-y"},
    {"name": "west", "start": (0, 0), "end": (0, 5), "toward": "+x", **GABLE},
    {"name": "east", "start": (6, 0), "end": (6, 5), "toward": "-x", **GABLE},
]


@pytest.mark.parametrize(
    "element_size", [pytest.param(0.5, marks=pytest.mark.slow("docs/walls.md: a roof out to the gables, finer elements")), 0.8]
)
def test_a_roof_out_to_the_gables_does_not_bring_the_shell_down(element_size: float) -> None:
    """The slivers of the gables at their eaves do not bear it: the load is as if it began a little further in."""
    house = generators.house(walls=WALLS, course=0.3, stone_length=0.75, height=3.0, thickness=0.5, materials=MASONRY)
    stones, shell = cp.derive_blocks(house), cp.derive_shell(house, element_size=element_size)
    load = cp.LoadCase((1, 0, 0))
    found = []
    for begin in (None, 0.5):
        end = None if begin is None else 6.0 - begin
        roof = [cp.LineLoad(wall, dead=3e3, begin=begin, end=end) for wall in ("south", "north")]
        pushed = cp.shell_loaded(load, shell, stones, roof)
        # All of the roof is on the shell.
        assert -pushed.dead[:, 2].sum() == pytest.approx(2 * 3e3 * (6.0 - 2 * (begin or 0.0)))
        state = cp.shell_limit_analysis(shell, pushed, MASONRY)
        assert state.status == "optimal"
        found.append(state.load_factor)
    assert found[0] == pytest.approx(found[1], rel=0.03)
