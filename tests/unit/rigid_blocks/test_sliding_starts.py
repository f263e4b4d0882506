"""Where the search without dilatancy begins from forces that carry nothing, and where no start leads anywhere."""

import re
from dataclasses import replace
from itertools import pairwise, product
from typing import Any

import numpy as np
import pytest

from churchpipe.conic.program import ConeProgram, ConeSolution
from churchpipe.conic.solve import Solve, solver_for
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.model.loads import LoadCase
from churchpipe.model.results import StartRun
from churchpipe.rigid_blocks import central, sliding
from churchpipe.rigid_blocks.associative import associative_state
from churchpipe.rigid_blocks.certificate import Strength
from churchpipe.rigid_blocks.coulomb import CoulombState, Near, bipotential_gap, dead_load_start
from churchpipe.rigid_blocks.equilibrium import Equilibrium, equilibrium
from churchpipe.rigid_blocks.iterations import SlidingRun, certified_iteration, closed_gap, pair_of_programs, pairs_left
from churchpipe.rigid_blocks.limit import limit_analysis, point_strength
from churchpipe.rigid_blocks.selection import nearly, nearly_words
from churchpipe.rigid_blocks.settings import SchemeSettings
from churchpipe.rigid_blocks.sliding import SlidingOptions, sliding_analysis
from churchpipe.stones.contacts import find_contacts
from solids import Solid, box, moved, on_ground

PUSH = LoadCase((1, 0, 0))


WALL = [box((i + s, i + 1 + s), (0, 0.5), (z, z + 0.4)) for z, s in ((0, 0), (0.4, 0.5), (0.8, 0)) for i in range(3)]


def wall() -> tuple[Equilibrium, Strength, Contacts]:
    stones = on_ground(*WALL)
    contacts = find_contacts(stones)
    balance = equilibrium(stones, contacts, PUSH)
    return balance, point_strength(contacts, 0.6, 0.0, balance.force), contacts


@pytest.mark.parametrize("share", [0.0, 1e-3])
def test_a_start_that_carries_nothing_finds_its_way(share: float) -> None:
    balance, strength, contacts = wall()
    n = np.full(len(contacts.point), share / len(contacts.point))
    run = certified_iteration(balance, strength, n, solver_for(balance.wrenches))
    assert run is not None
    assert run.converged
    assert run.gap <= 1e-5 * run.load_factor


class OnlyAssociative:
    """A solver that fails wherever shear is limited whatever the normal force."""

    def __init__(self, solve: Solve) -> None:
        self._solve = solve

    def __call__(self, program: ConeProgram, /, **options: Any) -> ConeSolution:
        if not program.slope.any() and program.limit.any():
            nothing = np.full((program.points, 3), np.nan)
            return ConeSolution(nothing, np.nan, np.full(len(program.constant), np.nan), "failed", 0, 0.0, "test")
        return self._solve(program, **options)


@pytest.mark.parametrize("starts", [("centre",), ("dead-load", "associative")])
def test_what_a_result_cost_is_told_beside_the_associative_analysis(starts: tuple[Any, ...]) -> None:
    balance, strength, _ = wall()
    solve = solver_for(balance.wrenches)
    associative = associative_state(balance, strength, solve, 0.0)
    state = sliding_analysis(balance, strength, associative, SlidingOptions(starts=starts), solve)
    assert state.status == "converged"
    told = state.message.split("; ")[-1]
    times = f"{state.iterations / associative.iterations:.1f} times as many as in the associative analysis"
    searches = f" of {len(starts)} searches" if len(starts) > 1 else ""
    assert told == f"found in {state.iterations} steps{searches}, {times}"


@pytest.mark.parametrize(
    ("rounds", "told"),
    [
        (12, "2 rounds of friction about the centres of pressure, the last of which changed the load factor by less than 0.01 %"),
        # Friction about the centres of pressure raises the load factor from .578 to .589.
        (1, "the centres of pressure did not come to rest: the load factor still changed by 2 %"),
        (0, "the centres of pressure did not come to rest"),
    ],
)
def test_rounds_of_friction_are_told_in_words(rounds: int, told: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("churchpipe.rigid_blocks.limit._ROUNDS", rounds)
    stones = on_ground(*WALL)
    push = LoadCase((1, 1, 0))
    state = limit_analysis(stones, find_contacts(stones), push, 0.6, flow="non-associative", contact_model="torsion")
    assert state.status == ("converged" if rounds > 2 else "not-converged")
    # What is wrong stands first.
    assert state.message.split("; ")[-1 if rounds > 2 else 0] == told


def test_what_is_not_certified_says_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    stones, push = on_ground(*WALL), LoadCase((1, 1, 0))
    contacts = find_contacts(stones)
    certified = limit_analysis(stones, contacts, push, 0.6, flow="non-associative")
    assert "certified" not in certified.message
    # No state has so small a gap.
    monkeypatch.setattr("churchpipe.rigid_blocks.sliding_state.BIPOTENTIAL_GAP", 1e-30)
    state = limit_analysis(stones, contacts, push, 0.6, flow="non-associative")
    assert state.status == "not-converged"
    assert re.search(
        r"% of it at a joint of \w+ and \w+: look whether it is as built; so no load factor is certified", state.message
    )
    least = min(state.load_factor, state.interval[0])
    assert f"take no more than {least:.4f}, the least found" in state.message
    assert "a somewhat smaller friction" in state.message
    # What is said to help does: with less friction it is smaller.
    monkeypatch.undo()
    assert limit_analysis(stones, contacts, push, 0.55, flow="non-associative").load_factor < least


def test_where_no_start_leads_anywhere_the_associative_forces_are_told() -> None:
    balance, strength, _ = wall()
    solve = OnlyAssociative(solver_for(balance.wrenches))
    associative = associative_state(balance, strength, solve, 0.0)
    options = SlidingOptions(starts=("dead-load", "associative"))
    state = sliding_analysis(balance, strength, associative, options, solve)
    assert state.status == "not-converged"
    assert state.load_factor == pytest.approx(associative.load_factor)
    assert 0 < state.gap < np.inf
    assert state.interval[0] <= state.load_factor <= state.interval[1]
    assert "no start gave a feasible step" in state.message
    assert state.equilibrium_residual < 1e-8


def test_the_run_from_the_centre_needs_no_forces_to_begin_with() -> None:
    balance, strength, _ = wall()
    solve = OnlyAssociative(solver_for(balance.wrenches))
    associative = associative_state(balance, strength, solve, 0.0)
    state = sliding_analysis(balance, strength, associative, SlidingOptions(starts=("centre",)), solve)
    assert state.status == "converged"
    assert 0 <= state.gap <= 1e-5 * state.load_factor


def test_a_search_without_patience_gives_up_where_the_gap_falls_no_more() -> None:
    balance, strength, _ = wall()
    # A gap below rounding is never reached.
    settings = SchemeSettings(bipotential_gap=1e-14, patience=2)
    run = closed_gap(balance, strength, dead_load_start(balance), solver_for(balance.wrenches), settings)
    assert run is not None
    gaps = [step.gap for step in run.history]
    assert 2 < len(gaps) < 30
    assert all(min(gaps[:k]) < 0.5 * min(gaps[: k - 3]) for k in range(4, len(gaps) - 1))


@pytest.mark.parametrize("onward", [False, True])
def test_onward_programs_begin_near_the_ones_before_them(onward: bool) -> None:
    balance, strength, _ = wall()
    solve, near = solver_for(balance.wrenches), list[bool]()

    def counted(program: ConeProgram, /, **options: Any) -> ConeSolution:
        near.append(options["near"] is not None)
        return solve(program, **options)

    # A gap below rounding is never reached.
    settings = SchemeSettings(bipotential_gap=1e-14, stage_b=3)
    run = closed_gap(balance, strength, dead_load_start(balance), counted, settings, onward=onward)
    assert run is not None
    assert run.relative_gap < 1e-4
    assert len(near) >= 6
    # The first program is one for velocities from nothing, the second for forces from nothing.
    assert not any(near[:2])
    assert all(near[2:]) is onward
    assert any(near) is onward


@pytest.mark.parametrize("kind", ["turned", "shuffled", "thin", "enlarged"])
def test_the_canonical_start_is_the_same_for_equal_models(kind: str) -> None:
    """The least-squares dead-load forces of the points at one edge of a joint, sorted: to 1e-8 of the largest."""
    bodies = [box((i + s, i + 1 + s), (0, 0.5), (z, z + 0.4)) for z, s in ((0, 0), (0.4, 0.4), (0.8, 0.1)) for i in range(3)]
    stones, straight, still = on_ground(*bodies), np.eye(3), np.zeros(3)
    turn = np.array([[np.cos(0.3), -np.sin(0.3), 0.0], [np.sin(0.3), np.cos(0.3), 0.0], [0.0, 0.0, 1.0]])
    order = np.random.default_rng(3).permutation(stones.count).tolist()
    same = {
        "turned": moved(stones, turn, still),
        "shuffled": moved(stones, straight, still, order=order),
        "thin": moved(stones, np.diag([1.0, 0.2, 1.0]), still),
        "enlarged": moved(stones, straight, still, 3.7),
    }[kind]
    first, second = (np.sort(dead_load_start(equilibrium(each, find_contacts(each), PUSH))) for each in (stones, same))
    np.testing.assert_allclose(second, first, rtol=0, atol=1e-8 * first.max())


class FoundByRounding:
    """A search of which every further attempt ends where it is told to."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, lower: SlidingRun, again: SlidingRun | None) -> None:
        self._ends = [lower, again]
        monkeypatch.setattr(sliding, "certified_iteration", self)

    def __call__(self, *_: Any, **__: Any) -> SlidingRun | None:
        return self._ends.pop(0)


@pytest.mark.parametrize(
    ("again", "leads", "said"),
    [
        (0.9, 0.9, ""),
        (0.95, 0.95, "rounding decides between these"),
        (0.99, 1.0, "a ten-millionth ends elsewhere"),
        (None, 1.0, "a ten-millionth ends elsewhere"),
    ],
)
def test_a_search_leads_where_another_one_is_as_low(
    monkeypatch: pytest.MonkeyPatch, again: float | None, leads: float, said: str
) -> None:
    """A state lower than that from the centre, found once more, another one, or none clearly lower than the centre."""
    balance, strength, _ = wall()
    solve = solver_for(balance.wrenches)
    associative = associative_state(balance, strength, solve, 0.0)
    options = SlidingOptions()
    centre = sliding_analysis(balance, strength, associative, SlidingOptions(starts=("centre",)), solve)
    run = certified_iteration(balance, strength, dead_load_start(balance), solve)
    assert run is not None

    def at(share: float) -> SlidingRun:
        return replace(run, load_factor=share * centre.load_factor, gap=0.0, converged=True)

    # Intervals of one point: the lower states are of mechanisms of their own.
    monkeypatch.setattr(sliding, "mechanism_ends", lambda *given: (given[2], given[2]))
    FoundByRounding(monkeypatch, at(0.9), None if again is None else at(again))
    state = sliding_analysis(balance, strength, associative, options, solve)
    assert state.load_factor == pytest.approx(leads * centre.load_factor, rel=1e-6)
    assert 0.9 * centre.load_factor in state.fixed_points
    told = [words for words in ("rounding decides between these", "a ten-millionth ends elsewhere") if words in state.message]
    assert told == ([said] if said else [])


def toothed_corner(order: int, digits: type = float) -> Assemblage:
    """Two toothed walls .3 m thick, 3 m and 2.4 m long, nine courses of stones .4 m long and .2 m high, listed by chance."""
    boxes: list[Solid] = []
    for course, (axis, side) in product(range(9), enumerate((3.0, 2.4))):
        first = 0.0 if axis == course % 2 else 0.3
        for along in pairwise(np.append(np.arange(first, side, 0.4), side)):
            x, y = (along, (0.0, 0.3)) if axis == 0 else ((0.0, 0.3), along)
            boxes.append(box(x, y, (0.2 * course, 0.2 * (course + 1))))
    listed = [boxes[k] for k in np.random.default_rng(order).permutation(len(boxes))]
    return on_ground(*((points.astype(digits).astype(float), faces) for points, faces in listed))


@pytest.mark.parametrize(("push", "spread"), [((1, 0, 0), 1e-3), ((-1, 0, 0), 5e-3)])
def test_neither_the_order_of_stones_nor_the_digits_of_a_file_lead(push: tuple[float, float, float], spread: float) -> None:
    """Along +x the last step of the run goes 3 % along its states; along -x two searches end in mechanisms .4 % apart."""
    found: list[float] = []
    for order, digits in ((1, float), (2, float), (1, np.float32)):
        stones = toothed_corner(order, digits)
        state = limit_analysis(stones, find_contacts(stones), LoadCase(push), 0.6, flow="non-associative")
        found.append(state.load_factor)
    assert found[0] == pytest.approx(found[1], rel=1e-3)
    assert found[0] == pytest.approx(found[2], rel=spread)


def test_programs_that_come_to_nothing_are_paid_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """Runs that stop near a state, which no programs close."""
    balance, strength, _ = wall()
    solve = solver_for(balance.wrenches)
    costs: list[int] = []

    def nothing(*arguments: Any, **_: Any) -> None:
        answer = arguments[3](balance.program(strength.cohesion, strength.friction, strength.bound))
        costs.append(answer.iterations)

    monkeypatch.setattr(central, "closed_gap", nothing)
    run = central.from_centre(balance, strength, 1e-20, solve)
    assert run is not None
    assert run.solves == len(costs) > 0
    assert run.iterations > sum(costs) > 0


@pytest.mark.parametrize("closes", [True, False])
def test_forces_are_kept_where_velocities_alone_close_the_gap(closes: bool) -> None:
    balance, strength, contacts = wall()
    solve = solver_for(balance.wrenches)
    last = certified_iteration(balance, strength, dead_load_start(balance), solve)
    assert last is not None
    assert last.converged
    n, near = np.maximum(last.x[:, 0], 0.0), Near(last.x, last.y)
    settings = SchemeSettings(duality_gap=5e-7, roughest=5e-7)
    nothing = np.zeros(len(contacts.point))
    state = pair_of_programs(balance, strength, n, last, nothing, solve, settings, near, 0.0, closes=closes)
    assert state is not None
    assert bool((state.x == last.x).all()) is closes
    assert state.gap == pytest.approx(bipotential_gap(balance, strength, state.x, state.y))
    assert state.relative_gap <= 1e-5


@pytest.mark.parametrize("iterations", [30, 31])
def test_velocities_are_sought_from_nothing_once_a_start_near_the_last_ones_came_to_nothing(iterations: int) -> None:
    """A program that takes more iterations than a start is given was begun anew, or stopped near its end."""
    balance, strength, _ = wall()
    solve = solver_for(balance.wrenches)
    last = certified_iteration(balance, strength, dead_load_start(balance), solve)
    assert last is not None
    starts: list[bool] = []

    def counted(*arguments: Any, **options: Any) -> ConeSolution:
        answer = solve(*arguments, **options)
        # Programs of forces begin near the last ones all along.
        starts.append(options["near"] is not None)
        return replace(answer, iterations=iterations) if options.get("velocities") else answer

    settings = SchemeSettings(bipotential_gap=1e-300, stage_b=3, duality_gap=5e-7, roughest=5e-7)
    near = Near(last.x, last.y)
    run = closed_gap(balance, strength, np.maximum(last.x[:, 0], 0.0), counted, settings, near=near, gap=last.relative_gap)
    assert run is not None
    assert starts[:6:2] == ([True, True, True] if iterations == 30 else [True, False, False])
    assert all(starts[1:6:2])
    assert run.relative_gap <= 1e-5


def test_the_pairs_that_are_left_follow_from_the_last() -> None:
    states = [CoulombState(np.zeros((1, 3)), 0.5, np.zeros(6), 0.5 * gap) for gap in (8e-4, 4e-4)]
    assert pairs_left(states[0], states[1], 1e-4) == pytest.approx(2.0)
    assert np.isinf(pairs_left(states[1], states[0], 1e-4))


@pytest.mark.parametrize(("outlook", "pairs"), [(np.inf, 4), (1e-3, 2)])
def test_a_search_gives_up_where_its_rate_leads_nowhere(outlook: float, pairs: int) -> None:
    balance, strength, _ = wall()
    settings = SchemeSettings(bipotential_gap=1e-300, stage_b=4, outlook=outlook)
    run = closed_gap(balance, strength, dead_load_start(balance), solver_for(balance.wrenches), settings)
    assert run is not None
    assert len(run.history) == pairs


def test_a_leader_without_any_load_factor_is_measured_too() -> None:
    # Where nothing rubs the load factor is zero, and a gap counts against a thousandth of the weight.
    leader = StartRun("dead-load", 0.0, True, 1e-9, (0.0, 0.0), ())
    near, far = (StartRun("associative", -0.01, False, gap, (np.nan, np.nan), ()) for gap in (5e-7, 5e-6))
    assert nearly([leader, near, far], leader) == [near]
    assert "by 0.0e+00 of the load factor" in nearly_words(replace(leader, gap=0.0))
