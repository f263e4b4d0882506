"""Loose fill on the back of a vault: its weight, where it acts, and what it does to the load factor."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import shapely

import churchpipe as cp
from churchpipe.errors import InputError
from churchpipe.generators import vault
from churchpipe.geometry.prism import prism_of
from solids import box

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


@pytest.mark.parametrize("gap", [1e-5, 5e-4, 2e-3])
def test_fill_lies_on_the_back_alone_where_joints_are_drawn_open(gap: float) -> None:
    """Its volume differs from that of closed stones by no more than the gaps, of which the crown has the deepest."""
    closed = cp.derive_blocks(BARREL)
    solids = [closed.solid(stone) for stone in range(closed.count)]
    free = ~closed.fixed
    for stone in np.flatnonzero(free).tolist():
        points, faces = solids[stone]
        middle, turn = points.mean(axis=0), np.linalg.svd(points - points.mean(axis=0))[2]
        local = (points - middle) @ turn.T
        solids[stone] = local * (1.0 - gap / np.ptp(local, axis=0)) @ turn + middle, faces
    stones = cp.Assemblage.from_polyhedra(solids, 18e3, fixed=closed.fixed, panel=closed.panel.tolist())
    expected = cp.with_fill(PUSH, closed, "vault", 1.1, 15e3, cp.find_contacts(closed)).dead
    of_python = cp.with_fill(PUSH, stones, "vault", 1.1, 15e3, cp.find_contacts(stones)).dead
    of_case = cp.loaded(PUSH, stones, cp.place_loads(stones, [cp.Fill(on=("vault",), unit_weight=15e3, top=1.1)])).dead
    for found in (of_python, of_case):
        assert expected is not None
        assert found is not None
        assert found[:, 2].sum() == pytest.approx(expected[:, 2].sum(), rel=5 * gap / 0.2 + 1e-4)


def test_fill_on_a_face_that_is_not_convex_does_not_depend_on_its_first_corner() -> None:
    outline = [(0, 0), (2, 0), (2, 2), (1.5, 2), (1.5, 0.5), (0.5, 0.5), (0.5, 2), (0, 2)]
    ground = box((-1, 3), (-1, 3), (-0.5, 0))
    for first in range(len(outline)):
        points, faces = prism_of(shapely.Polygon(outline[first:] + outline[:first]))
        stones = cp.Assemblage.from_polyhedra([ground, (points, faces)], 18e3, fixed=[0], panel=["", "trough"])
        load = cp.with_fill(PUSH, stones, "trough", 2.0, 15e3, cp.find_contacts(stones))
        assert load.dead is not None
        # 2.5 m2, 1 m deep, in the middle of the stone in plan.
        np.testing.assert_allclose(load.dead[1], [0, 0, -2.5 * 15e3, 0, 0, 0], atol=1e-8)


def test_fill_leaves_out_what_a_stone_stands_over() -> None:
    """A beam over two piers: the fill stands on it, and on what it does not reach."""
    solids = [box((0, 3), (0, 1), (0, 1)), box((0, 0.5), (0, 1), (1, 1.5)), box((1.5, 2), (0, 1), (1, 1.5))]
    solids.append(box((0, 2), (0, 1), (1.5, 2)))
    stones = cp.Assemblage.from_polyhedra([box((-1, 4), (-1, 2), (-1, 0)), *solids], 18e3, fixed=[0], panel=["", *"abcd"])
    placed = cp.place_loads(stones, [cp.Fill(on=("a", "d"), unit_weight=15e3, top=3.0)])
    weight = np.bincount(placed.stone, placed.weight, minlength=5) / 15e3
    np.testing.assert_allclose(weight, [0, 1 * 2, 0, 0, 2 * 1], atol=1e-9)


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
    other = cp.derive_blocks(vault(span=1.8, thickness=0.2, courses=9, stone_length=0.5, length=1.0, materials=MATERIAL))
    with pytest.raises(InputError, match=r"contacts: made for another assemblage"):
        cp.with_fill(PUSH, stones, "vault", 1.0, 15e3, cp.find_contacts(other))
    with pytest.raises(InputError, match=r"with_fill: load: not pushed alike at all heights"):
        cp.with_fill(cp.LoadCase((1, 0, 0), profile="linear"), stones, "vault", 1.0, 15e3, contacts)


def test_a_fill_of_a_case_on_stones_without_names_says_where_names_come_from() -> None:
    stones = cp.derive_blocks(BARREL)
    nameless = replace(stones, panel=np.full(stones.count, ""))
    fill = cp.Fill(on=("vault",), unit_weight=15e3, top=1.1)
    said = r"no such vault; found vault; expected stones with names of walls: the groups of an OBJ, .* \(docs/formats.md"
    with pytest.raises(InputError, match=said):
        cp.place_loads(nameless, [fill])
