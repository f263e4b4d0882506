"""Statuses of a limit analysis: what is stable, wedged or undecided, and why."""

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Literal

import numpy as np
import pytest

import churchpipe as cp
from churchpipe import generators
from churchpipe.conic.clarabel import solve_clarabel
from churchpipe.conic.polish import restore_balance
from churchpipe.conic.program import ConeProgram, ConeSolution
from churchpipe.conic.solve import solve
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.model.loads import LoadCase
from churchpipe.rigid_blocks.associative import associative_program, associative_state
from churchpipe.rigid_blocks.certificate import Certificate, certify
from churchpipe.rigid_blocks.equilibrium import equilibrium
from churchpipe.rigid_blocks.limit import limit_analysis, point_strength
from churchpipe.stones.contacts import find_contacts
from solids import box, on_ground, prism
from sound import laid

PUSH = LoadCase((1, 0, 0))


def lying_prism(outline: list[tuple[float, float]], z: tuple[float, float]) -> tuple[np.ndarray, list[list[int]]]:
    """A prism: a polygon in the x-y plane between two heights, m."""
    points, faces = prism(outline, 1.0)
    return np.column_stack([points[:, 0], points[:, 2], z[0] + points[:, 1] * (z[1] - z[0])]), faces


@pytest.mark.parametrize("solver", ["auto", "interior-point", "clarabel"])
def test_forces_on_the_edge_of_friction_are_balanced(solver: str) -> None:
    """A block over the notch of a U: it slides at mu exactly, and its corners press on few of the contact points."""
    u = lying_prism([(0, 0), (3, 0), (3, 2), (2, 2), (2, 1), (1, 1), (1, 2), (0, 2)], (0, 1))
    stones = on_ground(u, box((0.5, 2.5), (1.2, 1.8), (1, 2)), reach=9.0)
    state = limit_analysis(stones, find_contacts(stones), LoadCase((0, -1, 0)), 0.6, solver=solver)
    assert (state.status, state.load_factor) == ("optimal", pytest.approx(0.6, rel=1e-6))


@pytest.mark.parametrize("solver", ["auto", "interior-point", "clarabel", "cvxpy"])
@pytest.mark.parametrize("size", [0.01, 10.0])
def test_every_solver_certifies_a_tower_that_overturns(solver: str, size: float) -> None:
    """Eight equal stones turn about their edge at b / h = 1 / 4, be they pebbles or boulders."""
    tower = [box((0, size), (0, size), (i * size / 2, (i + 1) * size / 2)) for i in range(8)]
    stones = on_ground(*tower)
    state = limit_analysis(stones, find_contacts(stones), PUSH, 0.6, solver=solver)
    assert (state.status, state.load_factor) == ("optimal", pytest.approx(0.25, rel=1e-6))


def test_balancing_keeps_cohesive_forces_in_their_cones() -> None:
    rng = np.random.default_rng(2)
    for _ in range(20):
        stones = on_ground(*(box((s, s + 1), (0, 0.5), (0.4 * c, 0.4 * c + 0.4)) for c in range(4) for s in (0, 1, 2)))
        contacts = find_contacts(stones)
        balance = equilibrium(stones, contacts, PUSH)
        strength = point_strength(contacts, 0.6, 500.0, balance.force)
        program = associative_program(balance, strength)
        answer = solve_clarabel(program, duality_gap=1e-6)
        noisy = answer.x * (1.0 + 1e-6 * rng.normal(size=answer.x.shape))
        x, tau = restore_balance(program, noisy, answer.tau)
        found = certify(balance, strength, x, tau, answer.y)
        before = certify(balance, strength, noisy, answer.tau, answer.y)
        assert np.abs(program.residual(x, tau)).max() < 1e-13
        assert found.cone_violation <= 2.0 * before.cone_violation + 1e-12
        assert tau == pytest.approx(answer.tau, rel=1e-5)


def test_forces_that_miss_a_light_stone_are_mended() -> None:
    """Bounds that agree to nine digits are no result while one light stone is out of balance by more than 1e-6 of its load."""
    chip = box((0.4, 0.42), (0.2, 0.22), (3.0, 3.02))
    stones = on_ground(*(box((0, 1), (0, 0.5), (z, z + 1)) for z in range(3)), chip)
    contacts = find_contacts(stones)
    balance = equilibrium(stones, contacts, PUSH)
    strength = point_strength(contacts, 0.6, 0.0, balance.force)
    program = associative_program(balance, strength)
    answer = solve_clarabel(program)
    x, tau = restore_balance(program, answer.x, answer.tau)
    spoiled = x.copy()
    spoiled[contacts.interface_of_point == len(contacts.blocks) - 1, 0] *= 1.0 + 4e-6
    found = certify(balance, strength, spoiled, tau, answer.y)
    assert found.upper_bound - found.lower_bound < 1e-8
    assert found.equilibrium_residual < 1e-9
    assert not found.holds
    assert [text.partition(" over")[0] for text in found.lacks] == ["residual of a stone"]
    assert certify(balance, strength, *restore_balance(program, spoiled, tau), answer.y).holds


def chapel_with_thick_walls(folder: Path) -> tuple[Assemblage, Contacts]:
    """The ready chapel with walls of 1 m, in which a few multipliers that stop short spoil all later steps."""
    ready = (Path(__file__).parents[3] / "pipeline" / "cases" / "chapel.toml").read_text(encoding="utf-8")
    (folder / "chapel.toml").write_text(ready.replace("thickness_m = 0.7", "thickness_m = 1.0"), encoding="utf-8")
    return laid(cp.read_case(folder / "chapel.toml").building())


@pytest.mark.slow
def test_thick_walls_with_cohesion(tmp_path: Path) -> None:
    stones, contacts = chapel_with_thick_walls(tmp_path)
    state = limit_analysis(stones, contacts, LoadCase((1, 0, 0), profile="linear"), 0.6, 20e3, solver="interior-point")
    assert (state.status, state.load_factor) == ("optimal", pytest.approx(0.4177915, rel=1e-6)), state.message


@pytest.mark.slow("docs/limits.md: a solver that stops short is followed by another")
@pytest.mark.parametrize(("direction", "expected"), [((1, 0, 0), 0.5928794), ((0, -1, 0), 0.5679193)])
def test_where_our_solver_stops_short_another_goes_on(
    direction: tuple[float, float, float], expected: float, tmp_path: Path
) -> None:
    """Of these two loads our own solver ends with bounds that agree to 2e-7 and velocities 1.3e-6 off, and without an answer."""
    stones, contacts = chapel_with_thick_walls(tmp_path)
    state = limit_analysis(stones, contacts, LoadCase(direction), 0.6, 20e3)
    assert (state.status, state.load_factor) == ("optimal", pytest.approx(expected, rel=1e-6)), state.message


@pytest.mark.parametrize("ratio", [1e6, 1e11, 1e12, 1e14])
def test_a_light_stone_between_heavy_ones(ratio: float) -> None:
    """Five cubes, light and heavy in turn: the stack tips about its edge at b / h = 1 / 5 whatever they weigh, as its resultant
    stands at half the height to within the share of the light ones."""
    cubes = [box((0, 1), (0, 1), (i, i + 1)) for i in range(5)]
    weights = 18e3 * np.array([1.0, 1.0, ratio, 1.0, ratio, 1.0])
    stones = Assemblage.from_polyhedra([box((-9, 9), (-9, 9), (-1, 0)), *cubes], weights, fixed=[0])
    state = limit_analysis(stones, find_contacts(stones), PUSH, 0.7, solver="interior-point")
    assert (state.status, state.load_factor) == ("optimal", pytest.approx(0.2, rel=1e-5))


@pytest.mark.parametrize(
    ("weights", "expected"), [([1e12, 1], 0.7), ([1e9, 1], 0.7), ([1e12, 1, 1e12], 1 / 3), ([1, 1e12, 1], 1 / 3)]
)
def test_the_weights_above_a_joint_may_be_of_any_size(weights: list[float], expected: float) -> None:
    """What passes a joint may be as light as the lighter of its stones or as heavy as what stands on them."""
    cubes = [box((0, 1), (0, 1), (i, i + 1)) for i in range(len(weights))]
    plate = box((-9, 9), (-9, 9), (-1, 0))
    stones = Assemblage.from_polyhedra([plate, *cubes], 18e3 * np.array([1.0, *weights]), fixed=[0])
    state = limit_analysis(stones, find_contacts(stones), PUSH, 0.7, solver="interior-point")
    assert (state.status, state.load_factor) == ("optimal", pytest.approx(expected, rel=1e-6))


def test_wedged_stones_say_so() -> None:
    wall = box((1, 2), (0, 1), (0, 4))
    stones = Assemblage.from_polyhedra([box((-9, 9), (-9, 9), (-1, 0)), wall, box((0, 1), (0, 1), (0, 2))], 18e3, fixed=[0, 1])
    contacts = find_contacts(stones)
    for flow in ("associative", "non-associative"):
        state = limit_analysis(stones, contacts, PUSH, 0.7, flow=flow)
        assert (state.status, state.load_factor, state.flow) == ("unbounded", np.inf, flow)
        assert "wedged" in state.message
        assert ("need no friction" in state.message) == (flow == "non-associative")
        assert state.equilibrium_residual < 1e-8
        # The certificate, again from the arrays: forces within friction that balance the push alone.
        balance = equilibrium(stones, contacts, PUSH)
        x = state.forces / balance.force
        assert np.abs(balance.wrenches.apply(x) + balance.live).max() < 1e-8
        assert (np.hypot(x[:, 1], x[:, 2]) <= 0.7 * x[:, 0] + 1e-8).all()


@pytest.mark.parametrize("taper", [0.2, 0.6])
def test_a_wedge_of_friction_alone_slides_without_dilatancy(taper: float) -> None:
    """A keystone drawn upwards out of its jaws: sliding that dilates is wedged (mu .5 beyond the taper), but without dilatancy
    the faces only part, so that it leaves when the pull equals its weight."""
    half = 1 + taper / 2
    jaws = [prism([(-3, 0), (-1, 0), (-half, 1), (-3, 1)], 1), prism([(1, 0), (3, 0), (3, 1), (half, 1)], 1)]
    key = prism([(-1, 0), (1, 0), (half, 1), (-half, 1)], 1)
    stones = Assemblage.from_polyhedra([box((-9, 9), (-9, 9), (-1, 0)), *jaws, key], 18e3, fixed=[0, 1, 2])
    contacts, lift = find_contacts(stones), LoadCase((0, 0, 1))
    assert limit_analysis(stones, contacts, lift, 0.5).status == "unbounded"
    state = limit_analysis(stones, contacts, lift, 0.5, flow="non-associative")
    assert (state.status, state.load_factor) == ("converged", pytest.approx(1.0, rel=1e-4))
    alone = limit_analysis(stones, contacts, lift, 0.5, flow="non-associative", start="associative")
    assert [run.start for run in alone.starts] == ["dead-load"]


@pytest.mark.slow
def test_an_arch_that_is_pressed_at_its_crown_says_why_it_has_no_load_factor() -> None:
    """With friction a thick arch of few stones holds any load at its crown; sliding without dilatancy is not decided by that, and
    the search once ended at a load factor of -3.9. With a compressive strength there is one."""
    stones = cp.derive_blocks(generators.arch(mean_radius=1.0, thickness=0.4, width=0.5, voussoirs=3, half_angle=np.radians(60)))
    contacts = find_contacts(stones)
    live = np.zeros((stones.count, 6))
    live[int(np.argmax(stones.centroid[:, 2])), 2] = -1e3
    load = LoadCase(name="crown", live=live)
    dilating = limit_analysis(stones, contacts, load, 0.7)
    assert dilating.status == "unbounded"
    assert "a compressive strength gives a load factor" in dilating.message
    state = limit_analysis(stones, contacts, load, 0.7, flow="non-associative", start="dead-load")
    assert state.status == "not-converged"
    assert np.isnan([state.load_factor, *state.interval]).all()
    assert state.message.startswith("no load factor is known: the load wedges the stones")
    assert "give their compressive strength" in state.message
    assert limit_analysis(stones, contacts, load, 0.7, compressive_strength=2e6).status == "optimal"


def test_a_certificate_names_what_it_lacks() -> None:
    found = Certificate(0.39659686, 0.39659687, 4.6e-10, 0.0, 4.3e-6, 2e-9)
    assert not found.holds
    assert found.lacks == ("residual of a stone over its load 4.3e-06, allowed 1e-06",)
    assert len(Certificate(0.3, 0.4, 1.0, 1.0, 1.0, 1.0).lacks) == 5


def test_arrays_decide_where_a_solver_stops_short() -> None:
    """Our own solver ends this wall, whose stones hang over, a little above its tolerance; its mechanism proves the fall."""
    places = [(0, 0), (0, 1), (1, 1), (2, 1), (2, 2), (3, 0), (3, 1), (3, 2)]
    bricks = [
        box((column + 0.5 * (course % 2), column + 0.5 * (course % 2) + 1), (0, 0.5), (0.4 * course, 0.4 * course + 0.4))
        for course, column in places
    ]
    stones = on_ground(*bricks)
    state = limit_analysis(stones, find_contacts(stones), LoadCase((1, 0, 0)), 0.3, solver="interior-point")
    assert state.status == "unstable"


def test_what_a_solver_gave_up_counts_by_what_it_proves() -> None:
    """The arrays of an answer are proof enough, whether or not its solver was content; others are none."""
    stones = on_ground(*(box((s, s + 1), (0, 0.5), (0.4 * c, 0.4 * c + 0.4)) for c in range(4) for s in (0, 1, 2)))
    contacts = find_contacts(stones)
    balance = equilibrium(stones, contacts, PUSH)
    strength = point_strength(contacts, 0.6, 500.0, balance.force)

    def gives_up(program: ConeProgram, *, spoilt: float = 0.0, **_: object) -> ConeSolution:
        answer = solve(program)
        return replace(answer, y=answer.y * np.where(np.arange(len(answer.y)) % 3, 1.0, 1.0 + spoilt), outcome="failed")

    proved = associative_state(balance, strength, gives_up, 0.0)
    assert (proved.status, proved.load_factor) == ("optimal", limit_analysis(stones, contacts, PUSH, 0.6, 500.0).load_factor)
    assert associative_state(balance, strength, partial(gives_up, spoilt=1e-3), 0.0).status == "failed"


def test_a_house_with_weak_mortar_has_a_load_factor() -> None:
    """Solvers stop short of their tolerance where cohesion is next to nothing: what they found is proved all the same."""
    mortar = cp.Material("default", unit_weight=18e3, friction=0.57, cohesion=1e3)
    walls = [
        {"name": "south", "start": (0, 0), "end": (4.95, 0), "toward": "+y"},
        {"name": "north", "start": (0, 3.85), "end": (4.95, 3.85), "toward": "-y"},
        {"name": "west", "start": (0, 0), "end": (0, 3.85), "toward": "+x"},
        {"name": "east", "start": (4.95, 0), "end": (4.95, 3.85), "toward": "-x", "thickness": 0.35},
        {"name": "inner", "start": (0, 2.25), "end": (4.95, 2.25), "thickness": 0.35, "height": 1.2},
    ]
    openings = [
        {"name": "window", "wall": "south", "centre": 2.228, "width": 0.9, "height": 0.9, "sill": 0.3},
        {"name": "door", "wall": "inner", "centre": 2.475, "width": 1.0, "height": 0.6, "lintel_bearing": 0.25},
    ]
    size = {"course": 0.3, "stone_length": 1.0, "height": 1.5, "thickness": 0.4, "joints": "grid"}
    stones = cp.derive_blocks(generators.house(**size, walls=walls, openings=openings, materials=(mortar,)))
    push = LoadCase((-0.8056550590255067, -0.5923849473666657, 0))
    state = limit_analysis(stones, find_contacts(stones), push, mortar.friction, mortar.cohesion)
    # The value is that of a cone program of the same joints, written apart from this one.
    assert (state.status, state.load_factor) == ("optimal", pytest.approx(0.608609, abs=2e-6))


def test_a_vault_that_is_made_heavier_does_not_collapse_where_it_has_no_weight() -> None:
    # Of a load along gravity the load factor -1 takes all weight away: every motion balances there, and none is a collapse.
    stones = cp.derive_blocks(generators.vault(span=3.7, thickness=0.45, courses=9, stone_length=1.0, length=1.0))
    contacts = cp.find_contacts(stones)
    assert limit_analysis(stones, contacts, LoadCase((0, 0, -1)), friction=0.7).status == "unbounded"
    state = limit_analysis(stones, contacts, LoadCase((0, 0, -1)), friction=0.7, flow="non-associative")
    assert state.status == "not-converged"
    assert np.isnan([state.load_factor, *state.interval]).all()
    assert state.message.endswith("the search ended at -1, where no load is left")
    # Lifted, it loses its weight at 1, and flies.
    lifted = limit_analysis(stones, contacts, LoadCase((0, 0, 1)), friction=0.7, flow="non-associative")
    assert lifted.load_factor == pytest.approx(1, abs=1e-5)


@pytest.mark.parametrize("flow", ["associative", "non-associative"])
def test_without_friction_nothing_is_pushed_to_zero(flow: Literal["associative", "non-associative"]) -> None:
    stones = on_ground(box((0, 1), (0, 1), (0, 2)))
    contacts = find_contacts(stones)
    state = limit_analysis(stones, contacts, PUSH, 0.0, flow=flow)
    assert state.status in ("optimal", "converged")
    assert state.load_factor == pytest.approx(0.0, abs=1e-9)
    curve = cp.block_pushover(stones, contacts, PUSH, 0.0, steps=2)
    assert (curve.status, curve.d0) == ("vanished", pytest.approx(0.0, abs=1e-9))
