"""A wall with a flat head: stones over the opening that friction alone holds."""

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.rigid_blocks.limit import limit_program
from churchpipe.rigid_blocks.loose import any_load_words, held_fast, loose_stones, loose_words
from flat_heads import flat_headed_wall


@pytest.mark.slow
@pytest.mark.parametrize(
    ("top", "count", "toppling"),
    [(2.25, 3, 0.2342), pytest.param(2.5, 5, 0.2056, marks=pytest.mark.slow("docs/limits.md: stones over an opening"))],
)
def test_the_building_leads_and_the_stones_over_the_opening_are_named(top: float, count: int, toppling: float) -> None:
    stones, contacts = flat_headed_wall(top)
    load = cp.LoadCase((0, -1, 0))
    state = cp.limit_analysis(stones, contacts, load, 0.6, flow="non-associative")
    # The wall turns about its lower edge, which no joint that slides takes part in: the associative value.
    assert toppling == pytest.approx(cp.limit_analysis(stones, contacts, load, 0.6).load_factor, abs=1e-4)
    assert (state.status, round(state.load_factor, 4)) == ("converged", toppling)
    assert [run.start for run in state.starts] == ["centre", "held"]
    assert state.starts[0].load_factor < 0
    assert f"does not lead: in it {count} stones (" in state.message
    assert "come out whatever pushes: friction alone holds them" in state.message


def test_a_mechanism_of_the_building_is_not_loose() -> None:
    stones, contacts = flat_headed_wall(2.25)
    balance, strength, _ = limit_program(stones, contacts, cp.LoadCase((0, -1, 0)), 0.6)
    speeds = np.zeros((len(balance.free), 6))
    speeds[-3:, 0] = 1.0
    loose = loose_stones(balance, speeds.ravel())
    assert np.flatnonzero(loose).tolist() == [len(loose) - 3, len(loose) - 2, len(loose) - 1]
    speeds[: len(speeds) // 2, 1] = 0.5
    assert not loose_stones(balance, speeds.ravel()).any()
    firm = held_fast(balance, strength, loose).friction
    touched = np.asarray(np.isin(contacts.blocks, balance.free[loose]).any(axis=1))[contacts.interface_of_point]
    assert firm[touched] == pytest.approx(10 * 0.6)
    assert firm[~touched] == pytest.approx(0.6)


def test_what_is_said_of_loose_stones() -> None:
    names = np.array(["N1", "N2", "N3", "N4"])
    assert loose_words(np.array([True, False, False, False]), names) == (
        "in it 1 stone (N1) comes out whatever pushes: friction alone holds it, and over an opening it needs "
        "a lintel, an arch or a tie"
    )
    assert "in it 4 stones (N1, N2, N3, ...) come out" in loose_words(np.ones(4, dtype=bool), names)
    assert any_load_words(-0.2, -0.1) == "in it stones fall under the dead load alone"
    assert any_load_words(-0.001, 0.3) == "it fits any load factor from 0.0000 to 0.3000"
