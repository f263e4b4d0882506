"""Loads that were placed on other stones are refused: they would press where nothing was meant to be pressed."""

import re
from typing import Any, cast

import pytest

import churchpipe as cp
from churchpipe.errors import InputError
from churchpipe.generators import box, wall

MASONRY = (cp.Material("default", 2e4, 0.6),)
SHORT, LONG = (wall(length=length, brick=(0.5, 0.25, 0.25), courses=3, materials=MASONRY) for length in (2.0, 3.0))
STONES, OTHERS = cp.derive_blocks(SHORT), cp.derive_blocks(LONG)
ROOF = cp.LineLoad("wall", dead=5e3, name="roof")
PUSH = cp.LoadCase((0, 1, 0))
FOREIGN = "loads: placed on another assemblage; found "


def test_loads_on_stones_that_are_not_there_are_refused() -> None:
    placed = cp.place_loads(OTHERS, [ROOF])
    with pytest.raises(InputError, match=rf"{FOREIGN}{placed.stone.max()}; expected stones 0 to {STONES.count - 1}"):
        cp.loaded(PUSH, STONES, placed)


def test_loads_beside_their_stones_are_refused() -> None:
    placed, shell = cp.place_loads(STONES, [ROOF]), cp.derive_shell(LONG, 0.5)
    said = re.escape(FOREIGN) + r"line load roof on wall-\S+ at \[.*\] m, beside it\. Place the loads on these stones"
    with pytest.raises(InputError, match=said):
        cp.loaded(PUSH, OTHERS, placed)
    with pytest.raises(InputError, match=said):
        cp.match_models(OTHERS, cp.find_contacts(OTHERS), shell, [placed])


def test_the_gate_says_that_it_takes_placed_loads() -> None:
    shell = cp.derive_shell(SHORT, 0.5)
    with pytest.raises(InputError, match=r"match_models: loads\[0\]: wrong kind; found LineLoad; expected a PlacedLoads"):
        cp.match_models(STONES, cp.find_contacts(STONES), shell, cast("Any", [ROOF]))


def test_a_shell_without_the_wall_of_a_load_is_refused() -> None:
    placed = cp.place_loads(STONES, [ROOF])
    room = cp.derive_shell(box(length=2.0, width=2.0, brick=(0.5, 0.25, 0.25), courses=3, materials=MASONRY), 0.5)
    said = "loads: on a wall that the shell does not have; found line load roof on wall; expected east, north, south, west"
    with pytest.raises(InputError, match=said):
        cp.shell_loaded(PUSH, room, STONES, placed)
