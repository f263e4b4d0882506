"""Models, results and errors stay as they were checked: in copies, in other processes, and beside the arrays of their caller."""

import copy
import pickle
from array import array
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
import pandas as pd
import pytest

import churchpipe as cp
from churchpipe.errors import InputError, UsageError
from churchpipe.findings import Finding, Findings, FindingsError
from churchpipe.model.arrays import floats
from solids import box, on_ground

STONE = cp.Material("default", 18e3, 0.6)
WALL = cp.generators.wall(length=1.2, brick=(0.4, 0.25, 0.2), courses=3, materials=(STONE,))
STONES = on_ground(box((0, 1), (0, 1), (0, 2)))
CONTACTS = cp.find_contacts(STONES)
PUSH = cp.LoadCase((1, 0, 0))
TIE = cp.Tie("rod", (0.5, 0.5, 1.75), (-1.4, 0.5, -0.2), strength=2e3)
KEPT = [
    *(WALL, STONES, CONTACTS, PUSH, TIE, cp.derive_shell(WALL, 0.4)),
    cp.limit_analysis(STONES, CONTACTS, PUSH, 0.6, ties=[TIE]),
    cp.block_pushover(STONES, CONTACTS, PUSH, 0.6, steps=2),
]


def arrays(value: Any) -> list[np.ndarray]:
    """All arrays in a dataclass, in those within it, and in tuples of them."""
    if isinstance(value, np.ndarray):
        return [value]
    inner: list[Any] = []
    if is_dataclass(value):
        inner = [getattr(value, item.name) for item in fields(value)]
    elif isinstance(value, tuple):
        inner = [*value]
    return [found for one in inner for found in arrays(one)]


@pytest.mark.parametrize("way", [copy.copy, copy.deepcopy, lambda value: pickle.loads(pickle.dumps(value))])
@pytest.mark.parametrize("value", KEPT, ids=lambda value: type(value).__name__)
def test_a_copy_has_the_same_arrays_that_nobody_can_write_to(value: Any, way: Callable[[Any], Any]) -> None:
    before, after = arrays(value), arrays(way(value))
    assert len(before) == len(after) > 0
    for old, new in zip(before, after, strict=True):
        np.testing.assert_array_equal(new, old)
        assert not old.flags.writeable
        assert not new.flags.writeable


ERRORS = [
    InputError("a", "wrong", found=lambda: 0, expected="right", remedy="Mend it."),
    UsageError("--a", "wrong", found=(1, 2.0)),
    FindingsError(Findings("a.dxf", (Finding("E12", "no support"),))),
]


@pytest.mark.parametrize("error", ERRORS, ids=lambda error: type(error).__name__)
def test_an_error_comes_whole_from_another_process(error: InputError) -> None:
    sent = pickle.loads(pickle.dumps(error))
    assert (type(sent), str(sent), sent.where, sent.remedy) == (type(error), str(error), error.where, error.remedy)
    assert str(sent.found) == str(error.found)
    assert getattr(sent, "findings", None) == getattr(error, "findings", None)
    assert sent.at("b").where == "b"


@pytest.mark.parametrize("given", [array("d", [1.0, 2.0]), pd.Series([1.0, 2.0]), np.arange(4.0)[1:3]], ids=lambda one: type(one))
def test_what_the_caller_writes_later_changes_nothing(given: Any) -> None:
    kept = floats("x", given, (2,))
    before = kept.copy()
    given[0] = 9.0
    np.testing.assert_array_equal(kept, before)
