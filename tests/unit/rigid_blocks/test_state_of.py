"""A state, and what is made of it, is used with the stones and the load that it is of, and with no others."""

from collections.abc import Callable
from typing import Any

import pytest

import churchpipe as cp
from churchpipe.generators import wall
from churchpipe.stones.blocks import derive_blocks

BAR = cp.Tie("tie", (0.25, 0.0, 0.6), (1.75, 0.0, 0.6), strength=1e3)


def pile(height: float) -> tuple[cp.Assemblage, cp.Contacts]:
    stones = derive_blocks(wall(length=2.0, height=height, thickness=0.5, brick=(0.5, 0.5, 0.25)))
    return stones, cp.find_contacts(stones)


def rates(state: cp.LimitState, stones: cp.Assemblage, contacts: cp.Contacts, load: cp.LoadCase) -> Any:
    return cp.sensitivities(state, stones, contacts, load)


def ranks(state: cp.LimitState, stones: cp.Assemblage, contacts: cp.Contacts, load: cp.LoadCase) -> Any:
    return cp.rank_ties(state, [BAR], stones, contacts, load, verify=0)


@pytest.mark.parametrize("use", [rates, ranks])
def test_a_state_of_other_stones_or_of_another_load_is_refused(use: Callable[..., Any]) -> None:
    low, high, across = pile(0.75), pile(1.0), cp.LoadCase((0, 1, 0))
    state = cp.limit_analysis(*low, across)
    assert use(state, *low, across)
    with pytest.raises(cp.InputError, match="other stones"):
        use(state, *high, across)
    with pytest.raises(cp.InputError, match="another load"):
        use(state, *low, cp.LoadCase((0, 1, 0), profile="linear"))


def test_rates_of_other_stones_are_refused() -> None:
    low, high, across = pile(0.75), pile(1.0), cp.LoadCase((0, 1, 0))
    found = cp.sensitivities(cp.limit_analysis(*low, across), *low, across)
    assert cp.verify_gains(found, *low, across).with_weight[0] > 0
    said = "verify_gains: rates: are of other stones; found walls wall; 30 joints; expected wall; 42 joints"
    with pytest.raises(cp.InputError, match=said):
        cp.verify_gains(found, *high, across)
    with pytest.raises(cp.InputError, match="contacts: made for another assemblage"):
        cp.verify_gains(found, low[0], high[1], across)


def test_a_study_refuses_contacts_of_other_stones() -> None:
    with pytest.raises(cp.InputError, match="contacts: made for another assemblage"):
        cp.LimitStudy(pile(0.75)[0], pile(1.0)[1])
