"""Constants of capacity curves and supports that move are checked, and each is described."""

import re
from dataclasses import fields

import pytest

from churchpipe.errors import InputError
from churchpipe.large_displacements.settings import PathSettings

NAMES = [field.name for field in fields(PathSettings)]


@pytest.mark.parametrize("name", NAMES)
def test_a_constant_is_positive_and_described(name: str) -> None:
    with pytest.raises(InputError, match=rf"PathSettings\.{name}: out of range; found 0; expected > 0"):
        PathSettings(**{name: 0})
    assert re.search(rf"\b{name}[:,`]", PathSettings.__doc__ or "")


@pytest.mark.parametrize(("name", "value", "expected"), [("worth", 1.0, "< 1"), ("further", 1.0, "> 1"), ("same", 1.5, "< 1")])
def test_shares_and_factors_have_their_ranges(name: str, value: float, expected: str) -> None:
    with pytest.raises(InputError, match=rf"PathSettings\.{name}: out of range; found {value}; expected {expected}"):
        PathSettings(**{name: value})
