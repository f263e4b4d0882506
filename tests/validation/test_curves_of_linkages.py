"""Capacity curves of stones of many shapes against the statics of linkages (`linkages.py`), which know nothing of the program.

Each curve is made once as it is and once with the model turned by 37 degrees about the vertical and its stones in another order.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.model.arrays import FloatArray
from linkages import Body, Hinge, Linkage, Point, Pull, Slider
from solids import box, prism

MORE = pytest.mark.slow("docs/capacity_curve.md: linkages")
GROUND = box((-5, 5), (-5, 5), (-1, 0))
PLANE = [(-4.0, -1.0), (4.0, -1.0), (4.0, 0.0), (-4.0, 0.0)]


def curve_of(
    bodies: Sequence[Body],
    ground: Sequence[Any],
    friction: Any,
    direction: Point = (1.0, 0.0),
    *,
    ties: Sequence[dict[str, Any]] = (),
    loads: Sequence[cp.PointLoad] = (),
    turned: bool = False,
    **options: Any,
) -> cp.BlockCapacityCurve:
    """The curve of the bodies on fixed solids; friction: a number, or by the numbers of two stones, the ground's first."""
    solids = [*ground, *(prism(list(body.outline), 1.0) for body in bodies)]
    weights = [*[18e3] * len(ground), *(body.unit_weight for body in bodies)]
    order = np.random.default_rng(5).permutation(len(solids)) if turned else np.arange(len(solids))
    angle = np.radians(37.0) if turned else 0.0
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    stones = cp.Assemblage.from_polyhedra(
        [(np.asarray(solids[k][0]) @ turn.T, solids[k][1]) for k in order],
        [weights[k] for k in order],
        fixed=np.flatnonzero(order < len(ground)).tolist(),
    )
    contacts = cp.find_contacts(stones)
    if callable(friction):
        friction = np.array([friction(*sorted(pair)) for pair in order[contacts.blocks].tolist()])
    place = np.argsort(order)
    ends = [{"start": turn @ tie["start"], "end": turn @ tie["end"], "stones": tuple(place[[*tie["stones"]]])} for tie in ties]
    bars = [cp.Tie(**{**tie, **end}) for tie, end in zip(ties, ends, strict=True)]
    push = cp.LoadCase(turn @ [direction[0], 0.0, direction[1]])
    placed = cp.place_loads(stones, [cp.PointLoad(at=turn @ load.at, dead=load.dead, mass=load.mass) for load in loads])
    load = cp.loaded(push, stones, placed) if loads else push
    return cp.block_pushover(stones, contacts, load, friction, bars, **options)


def assert_follows(bodies: Sequence[Body], linkage: Linkage, within: float, *args: Any, **options: Any) -> FloatArray:
    plain, turned = (curve_of(bodies, *args, **options, turned=turned) for turned in (False, True))
    for curve in (plain, turned):
        assert curve.proved
        assert curve.load_factor == pytest.approx(linkage.load_factors(curve.displacement), abs=within)
    assert turned.d0 == pytest.approx(plain.d0, rel=1e-4, nan_ok=True)
    return plain.load_factor


@pytest.mark.parametrize("slope", [pytest.param(np.radians(6), marks=MORE), np.radians(-6)])
def test_a_block_on_a_slope(slope: float) -> None:
    along, up = np.array([np.cos(slope), np.sin(slope)]), np.array([-np.sin(slope), np.cos(slope)])
    outline = [tuple(map(float, p)) for p in (0 * along, 0.6 * along, 0.6 * along + 2 * up, 2 * up)]
    edge = 4 * np.tan(slope)
    base = prism([(-4, -edge - 1), (4, edge - 1), (4, edge), (-4, -edge)], 1.0)
    toe = outline[1]
    linkage = Linkage([Body(outline)], [Hinge(0, toe, None, toe)])
    assert_follows([Body(outline)], linkage, 1e-7, [base], 0.9, step=0.03)
    slides = curve_of([Body(outline)], [base], 0.2, step=0.03, furthest=0.3)
    assert slides.load_factor == pytest.approx(np.tan(np.arctan(0.2) + slope), abs=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize(("direction", "toe"), [pytest.param((1.0, 0.0), (1.0, 0.0), marks=MORE), ((-1.0, 0.0), (0.0, 0.0))])
def test_an_irregular_stone(direction: Point, toe: Point) -> None:
    body = Body([(0, 0), (1, 0), (0.8, 1.7), (0.1, 1.9)])
    linkage = Linkage([body], [Hinge(0, toe, None, toe)], direction=direction)
    assert_follows([body], linkage, 1e-7, [GROUND], 0.9, direction, step=0.04)


def test_an_eccentric_roof_travels_with_its_wall() -> None:
    body = Body([(0, 0), (0.6, 0), (0.6, 3), (0, 3)])
    roof = 0.3 * body.weight
    linkage = Linkage(
        [body], [Hinge(0, (0.6, 0), None, (0.6, 0))], dead=[(0, (0.1, 3), (0, -roof))], live=[(0, (0.1, 3), (roof, 0))]
    )
    load = cp.PointLoad(at=(0.1, 0.5, 3), dead=roof, mass=roof)
    first = assert_follows([body], linkage, 1e-7, [GROUND], 0.9, loads=[load], step=0.03)[0]
    assert first == pytest.approx((0.3 + 0.3 * 0.5) / (1.5 + 0.3 * 3))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("stiffness", "pretension", "strength", "ultimate"),
    [
        pytest.param(0.5, 0.01, 0.06, np.inf, marks=MORE),
        (3.0, 0.0, 0.04, 0.3),
        pytest.param(0.2, 0.0, 0.2, 0.08, marks=MORE),
    ],
)
def test_a_slanted_bar(stiffness: float, pretension: float, strength: float, ultimate: float) -> None:
    body = Body([(0, 0), (0.6, 0), (0.6, 3), (0, 3)])
    drawn = float(np.hypot(2, 1.2))

    def tension(length: float) -> float:
        longer = length - drawn
        return body.weight * min(pretension + stiffness * longer, strength) if longer < ultimate else 0.0

    linkage = Linkage([body], [Hinge(0, (0.6, 0), None, (0.6, 0))], pulls=[Pull(0, (0, 2.7), None, (-2, 1.5), tension)])
    bar = {
        "name": "bar",
        "start": np.array([-2, 0.5, 1.5]),
        "end": np.array([0, 0.5, 2.7]),
        "stones": (1, 2),
        "strength": strength * body.weight,
        "stiffness": stiffness * body.weight,
        "pretension": pretension * body.weight,
        "ultimate": ultimate,
    }
    post = box((-2.5, -2), (-1, 2), (0, 4))
    assert_follows([body], linkage, 1e-7, [GROUND, post], 0.9, ties=[bar], step=0.03)


@pytest.mark.slow
def test_a_portal_of_unequal_columns() -> None:
    left, right = Body([(0, 0), (0.5, 0), (0.5, 2.4), (0, 2.4)]), Body([(2.6, 0), (3.2, 0), (3.2, 2.4), (2.6, 2.4)])
    lintel = Body([(0, 2.4), (3.2, 2.4), (3.2, 2.9), (0, 2.9)])
    toes = [Hinge(0, (0.5, 0), None, (0.5, 0)), Hinge(1, (3.2, 0), None, (3.2, 0))]
    linkage = Linkage([left, right, lintel], [*toes, Hinge(2, (0, 2.4), 0, (0, 2.4)), Hinge(2, (2.6, 2.4), 1, (2.6, 2.4))])
    assert_follows([left, right, lintel], linkage, 1e-4, [GROUND], 0.9, step=0.04)


@pytest.mark.slow
@pytest.mark.parametrize("friction", [pytest.param(0.0, marks=MORE), 0.25])
def test_three_blocks_against_a_prop(friction: float) -> None:
    # The lower two turn as one about their toe, the upper one leans on the foot of the prop and slides up along it.
    t, low, top, foot = 0.25, 1.9, 2.7, 2.5
    blocks = [Body([(0, a), (t, a), (t, b), (0, b)]) for a, b in ((0, 1.0), (1.0, low), (low, top))]
    both = Body([(0, 0), (t, 0), (t, low), (0, low)])
    linkage = Linkage(
        [both, blocks[2]],
        [Hinge(0, (t, 0), None, (t, 0)), Hinge(1, (0, low), 0, (0, low))],
        [Slider(None, (t, foot), 1, (t, low), (0.0, 1.0), -friction)],
    )

    def of(one: int, _: int) -> float:
        return friction if one == 1 else 0.7

    prop = box((t, t + 0.3), (0, 1), (foot, 3.2))
    assert_follows(blocks, linkage, 2e-4, [GROUND, prop], of, step=0.015)
