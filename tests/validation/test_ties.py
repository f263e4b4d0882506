"""Ties: closed forms of elementary statics, bounds, and what the strength of a tie adds."""

from typing import Any

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.errors import InputError
from solids import box, on_ground, prism

PUSH = cp.LoadCase((1, 0, 0))


def tied(stones: cp.Assemblage, *ties: cp.Tie, friction: float = 2.0, load: cp.LoadCase = PUSH, **options: Any) -> cp.LimitState:
    return cp.limit_analysis(stones, cp.find_contacts(stones), load, friction, ties=ties, **options)


def assert_certified(state: cp.LimitState) -> None:
    assert state.status == "optimal"
    assert abs(state.upper_bound - state.lower_bound) <= 1e-6 * state.load_factor
    assert state.equilibrium_residual < 1e-8
    assert state.cone_violation < 1e-8


def post_and_wall(strength: float) -> tuple[cp.Assemblage, cp.Tie]:
    """A wall 1 x 4 m that overturns away from a fixed post, tied to it at 3.5 m."""
    wall, post = box((0, 1), (0, 1), (0, 4)), box((-3, -2), (0, 1), (0, 4))
    stones = cp.Assemblage.from_polyhedra([box((-9, 9), (-9, 9), (-1, 0)), wall, post], 18e3, fixed=[0, 2])
    return stones, cp.Tie("rod", start=(-2, 0.5, 3.5), end=(0, 0.5, 3.5), strength=strength)


@pytest.mark.parametrize("solver", ["auto", "interior-point", "clarabel"])
@pytest.mark.parametrize(("share", "expected"), [(0.0, 0.25), (0.02, 0.285), (0.05, 0.3375), (0.1, 0.425)])
def test_tied_block(share: float, expected: float, solver: str) -> None:
    # It turns about its outer edge: alpha = b/h + 2 T z / (W h).
    weight = 4 * 18e3
    stones, tie = post_and_wall(share * weight)
    state = tied(stones, tie, solver=solver)
    assert_certified(state)
    assert state.load_factor == pytest.approx(expected, rel=1e-6)
    assert state.tie_forces == pytest.approx([share * weight], rel=1e-6, abs=1e-3)
    assert state.tie_sensitivity == pytest.approx([2 * 3.5 / (weight * 4)], rel=1e-5)
    assert state.forces.shape == (len(cp.find_contacts(stones).point), 3)


def two_walls() -> tuple[cp.Assemblage, float]:
    """Walls 1 and .5 m thick, 4 m high; the weight of the first, N."""
    return on_ground(box((0, 1), (0, 1), (0, 4)), box((4, 4.5), (0, 1), (0, 4))), 4 * 18e3


@pytest.mark.parametrize(("share", "expected"), [(0.02, 0.205), (1.0, 5 / 24), (1e2, 5 / 24), (1e4, 5 / 24), (1e6, 5 / 24)])
def test_walls_tied_at_the_top(share: float, expected: float) -> None:
    # The thinner wall stands on the side of the push and hangs on the other; with a strong tie they turn together.
    stones, weight = two_walls()
    state = tied(stones, cp.Tie("beam", start=(1, 0.5, 4), end=(4, 0.5, 4), stones=(1, 2), strength=share * weight))
    assert_certified(state)
    assert state.load_factor == pytest.approx(expected, rel=1e-6)
    strong = share > 0.1
    assert state.tie_forces == pytest.approx([(1 / 48 if strong else share) * weight], rel=1e-5)
    assert state.tie_sensitivity * weight == pytest.approx([0.0 if strong else 4.0], abs=1e-5)


def piers(seed: int) -> tuple[cp.Assemblage, list[cp.Tie]]:
    """Stacks of random stones, the thinnest on the side of the push, tied to one another."""
    random = np.random.default_rng(seed)
    stones, left = [], 0.0
    for width in np.sort(random.uniform(0.4, 1.0, 3))[::-1]:
        bottom = 0.0
        for height in random.uniform(0.4, 0.9, 4):
            inset = random.uniform(0, 0.1 * width)
            stones.append(box((left + inset, left + width), (inset, 1), (bottom, bottom + height)))
            bottom += height
        left += width + 1.0
    laid = on_ground(*stones)
    weight = laid.weight.sum()
    centre = laid.centroid
    pairs = [(4, 8), (8, 12), (3, 7), (7, 12)]
    shares = random.uniform(0.002, 0.02, len(pairs))
    return laid, [
        cp.Tie(f"{i}-{j}", centre[i], centre[j], strength=share * weight) for (i, j), share in zip(pairs, shares, strict=True)
    ]


def stronger(tie: cp.Tie, by: float) -> cp.Tie:
    return cp.Tie(tie.name, tie.start, tie.end, tie.stones, strength=tie.strength + by)


@pytest.mark.parametrize(
    "seed",
    [
        0,
        3,
        *(pytest.param(seed, marks=pytest.mark.slow("docs/strengthening.md: the sensitivity to ties")) for seed in (1, 2, 4, 5)),
    ],
)
def test_sensitivity_is_the_difference_quotient(seed: int) -> None:
    stones, ties = piers(seed)
    contacts, weight = cp.find_contacts(stones), stones.weight.sum()

    def load_factor(ties: list[cp.Tie]) -> float:
        return cp.limit_analysis(stones, contacts, PUSH, 0.6, ties=ties).load_factor

    state = cp.limit_analysis(stones, contacts, PUSH, 0.6, ties=ties)
    assert_certified(state)
    assert state.load_factor > load_factor([]) + 1e-3
    assert (state.tie_sensitivity > 0).any()
    step = 1e-4 * weight
    for number, tie in enumerate(ties):
        up, down = (load_factor([*ties[:number], stronger(tie, by), *ties[number + 1 :]]) for by in (step, -step))
        assert state.tie_sensitivity[number] * weight == pytest.approx((up - down) / (2 * step) * weight, rel=1e-4, abs=1e-4)
        assert 0 <= state.tie_forces[number] <= tie.strength
        if state.tie_sensitivity[number] * weight > 1e-4:
            assert state.tie_forces[number] == pytest.approx(tie.strength, rel=1e-4)


def test_a_tie_of_no_strength_says_what_it_would_add() -> None:
    stones, weight = two_walls()
    state = tied(stones, cp.Tie("candidate", (1, 0.5, 4), (4, 0.5, 4), strength=0.0))
    assert_certified(state)
    assert state.load_factor == pytest.approx(0.125, rel=1e-6)
    assert state.tie_forces == pytest.approx([0.0])
    assert state.tie_sensitivity * weight == pytest.approx([4.0], rel=1e-5)


@pytest.mark.parametrize(("share", "expected"), [(0.0, 0.25), (0.05, 0.3375), (1e3, None)])
def test_without_dilatancy(share: float, expected: float | None) -> None:
    # A block that overturns does not slide: both flows agree. The strong tie makes it slide at .6.
    stones, tie = post_and_wall(share * 4 * 18e3)
    state = tied(stones, tie, friction=0.6, flow="non-associative")
    assert state.status == "converged"
    assert state.gap <= 1e-5 * state.load_factor
    if expected is None:
        associative = tied(stones, tie, friction=0.6)
        assert_certified(associative)
        assert state.load_factor <= associative.load_factor * (1 + 1e-6)
        assert 0 < state.tie_forces[0] < tie.strength
    else:
        assert state.load_factor == pytest.approx(expected, rel=1e-5)
        assert state.tie_forces == pytest.approx([tie.strength], rel=1e-4, abs=1.0)
        assert state.tie_sensitivity == pytest.approx([2 * 3.5 / (4 * 4 * 18e3)], rel=1e-3)


@pytest.mark.parametrize("method", ["default", "paper"])
def test_piers_without_dilatancy(method: str) -> None:
    stones, ties = piers(1)
    associative = tied(stones, *ties, friction=0.4)
    state = tied(stones, *ties, friction=0.4, flow="non-associative", method=method)
    assert state.status == "converged"
    assert state.load_factor <= associative.load_factor * (1 + 1e-3)
    assert state.load_factor > tied(stones, friction=0.4).load_factor
    assert state.interval[0] <= state.load_factor <= state.interval[1]
    assert (state.tie_forces <= [tie.strength * (1 + 1e-9) for tie in ties]).all()


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_the_run_from_the_centre_knows_ties(seed: int) -> None:
    # Piers that overturn have one load factor: the run with held tensions and the search from the dead load end at it. The state
    # that is reported is the lowest of its mechanism, whose gap may be 1e-5 of the load factor.
    stones, ties = piers(seed)
    state = tied(stones, *ties, friction=0.4, flow="non-associative")
    assert [run.start for run in state.starts] == ["centre", "dead-load"]
    assert all(run.converged for run in state.starts)
    assert state.starts[0].load_factor == pytest.approx(state.starts[1].load_factor, rel=1.1e-5)


def leaning() -> cp.Assemblage:
    """A block whose centroid lies beyond its base, beside an upright one."""
    return on_ground(prism([(0, 0), (1, 0), (3, 3), (2, 3)], 1.0), box((-4, -2), (0, 1), (0, 3)))


def test_a_tie_holds_what_falls_by_itself() -> None:
    stones = leaning()
    assert tied(stones).status == "unstable"
    weak, firm, strong = (cp.Tie("t", (-2, 0.5, 2.5), (1.75, 0.5, 2.5), strength=strength) for strength in (100.0, 15e3, 40e3))
    fallen = tied(stones, weak)
    assert fallen.status == "unstable"
    assert fallen.tie_forces == pytest.approx([100.0], rel=1e-5)
    assert np.isnan(fallen.tie_sensitivity).all()
    # About their toes, kNm: the tie 2.5 T holds the leaning block, 27 + 81 alpha, and turns the upright one, 108 - 162 alpha.
    for tie, expected in ((firm, (15 * 2.5 - 27) / 81), (strong, (108 - 27) / (81 + 162))):
        state = tied(stones, tie)
        assert_certified(state)
        assert state.load_factor == pytest.approx(expected, rel=1e-6)


def test_wedged_stones_leave_the_tie_slack() -> None:
    stones = cp.Assemblage.from_polyhedra(
        [box((0, 1), (0, 1), (0, 1)), box((-1, 0), (0, 1), (0, 2)), box((1, 2), (0, 1), (0, 2)), box((0, 1), (0, 1), (-1, 0))],
        18e3,
        fixed=[1, 2, 3],
    )
    state = tied(stones, cp.Tie("t", (-0.5, 0.5, 0.5), (0.5, 0.5, 0.5), strength=1e4))
    assert state.status == "unbounded"
    assert state.tie_forces == pytest.approx([0.0])


STONES = two_walls()[0]
BAD: list[tuple[dict[str, Any], str]] = [
    ({"name": ""}, "Tie.name: no name"),
    ({"strength": -1.0}, "tie t: strength: out of range; found -1.0; expected >= 0 N"),
    ({"strength": float("nan")}, "tie t: strength: out of range; found nan"),
    ({"strength": "1"}, "tie t: strength: not a number"),
    ({"end": (1, 0.5, 4)}, "tie t: no length"),
    ({"end": (1, 0.5)}, "tie t: end: wrong shape"),
    ({"end": (2, 0.5, 4)}, "tie t: end: no stone at the anchor"),
    ({"end": (4, 0.5, 4.001)}, "tie t: end: no stone at the anchor.*the nearest stone, B., is 0.001 m away"),
    ({"start": (1, 0.5, 0)}, "tie t: start: several stones at the anchor; found B0 .0., B1 .1. at"),
    ({"end": (0.5, 0.5, 2)}, "tie t: both ends on one stone; found B1"),
    ({"stones": (1, 1)}, "tie t: both ends on one stone; found stones 1 and 1"),
    ({"stones": (1, 7)}, "tie t: stones: no such stone; found 7; expected indices < 3"),
    ({"stones": (1, -1)}, "tie t: stones: index out of range; found -1; expected >= 0"),
    ({"stones": 1}, "tie t: stones: wrong shape"),
]


@pytest.mark.parametrize(("changed", "said"), BAD)
def test_bad_ties(changed: dict[str, Any], said: str) -> None:
    arguments: dict[str, Any] = {"name": "t", "start": (1, 0.5, 4), "end": (4, 0.5, 4), "strength": 1e3} | changed
    with pytest.raises(InputError, match=said):
        tied(STONES, cp.Tie(**arguments))


def test_tie_between_fixed_stones() -> None:
    stones, _ = post_and_wall(1.0)
    with pytest.raises(InputError, match="tie t: both ends on fixed stones; found B0 and B2"):
        tied(stones, cp.Tie("t", (5, 0, -0.5), (-2.5, 0.5, 2), strength=1.0))


def test_two_ties_of_one_name() -> None:
    both = [cp.Tie("t", (1, 0.5, height), (4, 0.5, height), strength=1e3) for height in (3, 4)]
    with pytest.raises(InputError, match="ties: two ties of one name; found t; expected a name each"):
        tied(STONES, *both)


def test_ties_of_another_kind() -> None:
    with pytest.raises(InputError, match=r"limit_analysis: ties\[0\]: wrong kind"):
        tied(STONES, "rod")


def test_an_anchor_on_a_notched_face_belongs_to_what_it_touches() -> None:
    # The front of an L is not convex: the notch is no part of it.
    angle = prism([(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)], 1.0)
    stones = on_ground(angle, box((5, 6), (0, 1), (0, 3)))
    assert tied(stones, cp.Tie("t", (0.5, 0, 2), (5, 0, 2), strength=1.0)).status == "optimal"
    with pytest.raises(InputError, match=r"start: no stone at the anchor.*the nearest stone, B\d, is around it"):
        tied(stones, cp.Tie("t", (2, 0, 2), (5, 0, 2), strength=1.0))
