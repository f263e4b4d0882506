"""Loose fill on the back of a vault: its weight, where it acts, and what it does to the load factor."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.errors import InputError
from churchpipe.generators import vault

MATERIAL = (cp.Material("default", 18e3, 0.7),)
BARREL = vault(span=1.8, thickness=0.2, courses=27, stone_length=0.5, length=1.0, materials=MATERIAL)
PUSH = cp.LoadCase((1, 0, 0))


def test_fill_weighs_what_lies_above_the_back() -> None:
    stones = cp.derive_blocks(BARREL)
    contacts = cp.find_contacts(stones)
    load = cp.with_fill(PUSH, stones, "vault", 1.1, 15e3, contacts)
    # Between the level at the outer radius and a half circle of 27 chords.
    back = 27 * math.sin(math.pi / 27) / 2 * 1.1**2
    expected = 15e3 * (2 * 1.1 * 1.1 - back)
    assert load.dead is not None
    assert load.live is not None
    assert -load.dead[:, 2].sum() == pytest.approx(expected, rel=1e-9)
    assert load.live[:, 0].sum() == pytest.approx(expected, rel=1e-9)
    # About the middle of the springing: the weight has no moment, the push that of the mass at its own height.
    origin = np.array([0.0, 0.5, 0.0])
    turn = [wrench[:, 3:] + np.cross(stones.centroid - origin, wrench[:, :3]) for wrench in (load.dead, load.live)]
    assert np.abs(turn[0].sum(axis=0)).max() < 1e-6 * expected
    chord = np.array([1.1 * np.array([math.cos(a), math.sin(a)]) for a in np.linspace(0, math.pi, 28)])
    height = sum((a[0] - b[0]) * (1.1**2 - (a[1] ** 2 + a[1] * b[1] + b[1] ** 2) / 3) / 2 for a, b in pairwise(chord))
    assert turn[1].sum(axis=0)[1] == pytest.approx(15e3 * height, rel=1e-9)


def test_fill_of_the_shell_is_that_of_the_stones() -> None:
    shell = cp.derive_shell(BARREL, 0.1)
    load = cp.with_fill(PUSH, shell, "vault", 1.1, 15e3)
    back = 27 * math.sin(math.pi / 27) / 2 * 1.1**2
    assert load.dead is not None
    # Facets hinge in the middle of the courses' beds, where the vault is a little thinner than between them.
    assert -load.dead[:, 2].sum() == pytest.approx(15e3 * (2 * 1.1 * 1.1 - back), rel=0.01)


def test_fill_of_a_case_is_that_of_python() -> None:
    """A table of fill comes to the same forces and moments on each stone as `with_fill`: its mass lies half way up."""
    stones = cp.derive_blocks(BARREL)
    placed = cp.place_loads(stones, [cp.Fill(on=("vault",), unit_weight=15e3, top=1.1)])
    of_case, of_python = cp.loaded(PUSH, stones, placed), cp.with_fill(PUSH, stones, "vault", 1.1, 15e3, cp.find_contacts(stones))
    for name in ("dead", "live"):
        first, second = getattr(of_case, name), getattr(of_python, name)
        np.testing.assert_allclose(first, second, atol=1e-9 * np.abs(second).max())
    # What bears a column is still what it stands on.
    back = placed.foot[:, [0, 2]]
    assert np.hypot(*back.T).max() < 1.1
    assert np.hypot(*back.T).min() > 1.1 * math.cos(math.pi / 54) - 1e-9


def test_fill_is_pushed_with_the_part_that_bears_it() -> None:
    stones = cp.derive_blocks(BARREL)
    right = (stones.panel == "vault") & (stones.centroid[:, 0] > 0.1)
    stones = replace(stones, panel=np.where(right, "right", stones.panel))
    load = cp.LoadCase((1, 0, 0), panels=("right",))
    placed = cp.place_loads(stones, [cp.Fill(on=("vault", "right"), unit_weight=15e3, top=1.1)])
    of_case = cp.loaded(load, stones, placed)
    of_python = cp.with_fill(load, stones, ("vault", "right"), 1.1, 15e3, cp.find_contacts(stones))
    assert of_python.live is not None
    assert not of_python.live[~right].any()
    for name in ("dead", "live"):
        first, second = getattr(of_case, name), getattr(of_python, name)
        np.testing.assert_allclose(first, second, atol=1e-9 * np.abs(second).max())


def test_fill_changes_the_load_factor_of_both_models_alike() -> None:
    stones, shell = cp.derive_blocks(BARREL), cp.derive_shell(BARREL, 0.2)
    contacts = cp.find_contacts(stones)
    filled = cp.limit_analysis(stones, contacts, cp.with_fill(PUSH, stones, "vault", 0.6, 15e3, contacts), 0.7)
    bare = cp.limit_analysis(stones, contacts, PUSH, 0.7)
    of_shell = [cp.shell_limit_analysis(shell, load, MATERIAL) for load in (PUSH, cp.with_fill(PUSH, shell, "vault", 0.6, 15e3))]
    assert filled.status == of_shell[1].status == "optimal"
    assert (filled.load_factor > bare.load_factor) == (of_shell[1].load_factor > of_shell[0].load_factor)


def test_what_cannot_be_filled_is_named() -> None:
    stones = cp.derive_blocks(BARREL)
    contacts = cp.find_contacts(stones)
    with pytest.raises(InputError, match=r"with_fill: panels: no such panel; found roof; expected ground, vault"):
        cp.with_fill(PUSH, stones, "roof", 1.0, 15e3, contacts)
    nameless = replace(stones, panel=np.full(stones.count, ""))
    with pytest.raises(InputError, match=r"no such panel; found roof; expected stones with names of walls"):
        cp.with_fill(PUSH, nameless, "roof", 1.0, 15e3, contacts)
    with pytest.raises(InputError, match=r"with_fill: level: no back lies below it; found -1 m"):
        cp.with_fill(PUSH, stones, "vault", -1.0, 15e3, contacts)
    with pytest.raises(InputError, match=r"with_fill: contacts: missing"):
        cp.with_fill(PUSH, stones, "vault", 1.0, 15e3)
    with pytest.raises(InputError, match=r"with_fill: load: not pushed alike at all heights"):
        cp.with_fill(cp.LoadCase((1, 0, 0), profile="linear"), stones, "vault", 1.0, 15e3, contacts)
