"""Loads that a building carries and that the load factor multiplies, such as a vehicle on a bridge."""

import json
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import linprog

import churchpipe as cp
from churchpipe.code_check import Site
from churchpipe.compare import safety, stone_parts
from churchpipe.config.case import read_case
from churchpipe.dxf.properties import decode_properties, encode_loads
from churchpipe.errors import InputError
from churchpipe.generators import arch, vault, wall
from churchpipe.io.recording import record_of
from churchpipe.loading.placing import place_loads
from churchpipe.loading.wrenches import loaded, shell_loaded
from churchpipe.model.loads import load_table
from churchpipe.report.of_stones import check_loads_in
from churchpipe.report.safety import check_table
from churchpipe.report.table import OF_PUSH, Row, factor_words
from solids import box

# A corbel: 3 m by 1 m by .5 m, 1 m of it on a pier.
CORBEL = cp.Assemblage.from_polyhedra([box((0, 1.6), (0, 1), (0, 1)), box((0, 3), (0, 1), (1, 1.5))], 20e3, fixed=[0])
AXLE = cp.PointLoad(at=(2.6, 0.5, 1.5), dead=1e3, name="axle")
GROWING = cp.LoadCase(multiplies=["axle"])
# .4 m thick and 2 m high: a thrust at its top tips it at a tenth of its weight, .2 m behind its toe, or pushes the uppermost of
# its eight courses off at an eighth of the friction.
WALL = wall(length=3.0, brick=(0.5, 0.4, 0.25), courses=8)
THRUST = cp.LineLoad("wall", thrust=1e3, toward="+y", name="rafters")
CASE = """
name = "bridge"
[source]
generator = "arch"
mean_radius_mm = 4000
thickness_mm = 500
width_mm = 1000
voussoirs = 25
half_angle_deg = 50
[material.stone]
unit_weight_kN_m3 = 22
friction = 0.6
[[point_loads]]
name = "axle"
at_m = [-1.5, 0.5, 3.9]
dead_kN = 10
[[load]]
multiplies = ["axle"]
"""


def test_a_corbel_tips_about_the_edge_of_its_pier() -> None:
    # Weight 30 kN with its middle .1 m behind the edge at x = 1.6 m; the load 1 m before it: 3 kN.
    load = loaded(GROWING, CORBEL, [AXLE])
    state = cp.limit_analysis(CORBEL, cp.find_contacts(CORBEL), load, friction=0.7)
    assert state.load_factor == pytest.approx(3.0, rel=1e-6)


def test_a_curve_follows_the_corbel_with_its_load() -> None:
    load = loaded(GROWING, CORBEL, [AXLE])
    curve = cp.block_pushover(CORBEL, cp.find_contacts(CORBEL), load, friction=0.9, step=0.1, steps=12)
    assert curve.proved
    turn = np.linalg.norm(curve.rotation[:, 1], axis=1)
    assert turn[-1] > 0.05
    # Arms about the edge: of the weight, .1 m behind it and .25 m above; of the load, 1 m before it and .5 m above.
    weight, axle = 0.1 * np.cos(turn) - 0.25 * np.sin(turn), np.cos(turn) + 0.5 * np.sin(turn)
    np.testing.assert_allclose(curve.load_factor, 30.0 * weight / axle, rtol=1e-6)
    # It is drawn against how far the axle goes down; the middle of the stone, behind the edge, goes up.
    np.testing.assert_allclose(curve.displacement, 0.5 - (0.5 * np.cos(turn) - np.sin(turn)), atol=1e-9)


@pytest.mark.parametrize("flow", ["associative", "non-associative"])
@pytest.mark.parametrize(("friction", "expected"), [(0.7, 0.7 / 8), (1.0, 0.1)], ids=["slides", "tips"])
def test_a_thrust_on_a_wall(friction: float, expected: float, flow: str) -> None:
    stones = cp.derive_blocks(WALL)
    load = loaded(cp.LoadCase(multiplies=["rafters"]), stones, [THRUST])
    state = cp.limit_analysis(stones, cp.find_contacts(stones), load, friction=friction, flow=flow)
    assert 3e3 * state.load_factor == pytest.approx(expected * stones.weight[~stones.fixed].sum(), rel=1e-5)


def test_an_axle_on_an_arch_is_the_load_that_presses_from_above() -> None:
    stones = cp.derive_blocks(vault(span=1.8, thickness=0.2, courses=27, stone_length=2.0, length=1.0))
    contacts = cp.find_contacts(stones)
    above = cp.load_from_above(stones, (0.5, 0.5), force=1e3)
    # Just below the back of the ring, of which the outer radius is 1.1 m.
    axle = cp.PointLoad(at=(0.5, 0.5, 0.96), dead=1e3, name="axle")
    grown = loaded(GROWING, stones, [axle])
    assert grown.live is not None
    assert above.live is not None
    np.testing.assert_allclose(grown.live, above.live, atol=1e-9)
    factors = [cp.limit_analysis(stones, contacts, load, friction=0.7).load_factor for load in (grown, above)]
    assert factors[0] == pytest.approx(factors[1], rel=1e-6)


def most_carried(
    radius: float, thickness: float, half_angle: float, voussoirs: int, weight: float, place: float, stone: int
) -> float:
    """Return the largest force at x = place on a voussoir under which a line of thrust stays in a plane arch: linear programming
    over the thrust, its height and its slope at the left springing, weight (of a unit of area). Nothing slides."""
    angle = np.linspace(-half_angle, half_angle, voussoirs + 1)
    out = np.stack([np.sin(angle), np.cos(angle)], axis=1)
    joint, along = radius * out, np.stack([np.cos(angle), -np.sin(angle)], axis=1)
    rows: list[np.ndarray] = []
    sides: list[float] = []
    carried, moment = 0.0, 0.0
    for k in range(voussoirs + 1):
        # Of what acts from the left at the middle of this joint: (horizontal, vertical, moment) for H, V, M, the force, and 1.
        x, z = joint[k] - joint[0]
        on = float(k > stone)
        normal = np.array([along[k, 0], along[k, 1], 0.0, -on * along[k, 1], -carried * along[k, 1]])
        bending = np.array([z, -x, 1.0, on * (joint[k, 0] - place), carried * joint[k, 0] - moment])
        for sign in (1.0, -1.0):
            row = sign * bending - 0.5 * thickness * normal
            rows.append(row[:4])
            sides.append(-row[4])
        if k < voussoirs:
            low, high = radius - thickness / 2, radius + thickness / 2
            corner = np.array([low * out[k], high * out[k], high * out[k + 1], low * out[k + 1]])
            after = np.roll(corner, -1, axis=0)
            cross = corner[:, 0] * after[:, 1] - after[:, 0] * corner[:, 1]
            own = weight * abs(0.5 * cross.sum())
            middle = float((cross * (corner + after)[:, 0]).sum() / (3 * cross.sum()))
            carried, moment = carried + own, moment + own * middle
    found = linprog([0, 0, 0, -1], A_ub=np.array(rows), b_ub=sides, bounds=[(0, None), (None, None), (None, None), (0, None)])
    assert found.status == 0
    return float(found.x[3])


@pytest.mark.parametrize(("x", "z", "stone"), [(-1.5, 3.9, 7), (-2.4, 3.3, 3), (-0.7, 3.92, 9)])
def test_an_axle_on_an_arch_against_lines_of_thrust(x: float, z: float, stone: int) -> None:
    stones = cp.derive_blocks(arch(mean_radius=4.0, thickness=0.5, width=1.0, voussoirs=25, half_angle=np.radians(50.0)))
    load = loaded(GROWING, stones, [cp.PointLoad(at=(x, 0.5, z), dead=1e3, name="axle")])
    state = cp.limit_analysis(stones, cp.find_contacts(stones), load, friction=1.5)
    free = ~stones.fixed
    weight = float(stones.weight[free].sum() / stones.volume[free].sum())
    expected = most_carried(4.0, 0.5, np.radians(50.0), 25, weight, x, stone)
    assert 1e3 * state.load_factor == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("along", [0.3, 1.4, 2.2])
def test_a_load_that_a_wall_carries_however_large_is_unbounded(along: float) -> None:
    # It presses on its own stones alone: most of the others feel nothing of it.
    stones, beam = cp.derive_blocks(WALL), cp.PointLoad("wall", along, dead=1e3, name="beam")
    load = loaded(cp.LoadCase(multiplies=["beam"]), stones, [beam])
    state = cp.limit_analysis(stones, cp.find_contacts(stones), load, 0.6)
    assert (state.status, state.load_factor) == ("unbounded", np.inf)
    assert "wedged" in state.message


def test_what_is_multiplied_is_not_there_otherwise_and_the_rest_stays() -> None:
    roof = cp.PointLoad(at=(0.8, 0.5, 1.5), dead=7e3, name="roof")
    placed = place_loads(CORBEL, [roof, AXLE])
    load, push = loaded(GROWING, CORBEL, placed), loaded(cp.LoadCase((1, 0, 0)), CORBEL, placed)
    assert load.dead[:, 2].sum() == pytest.approx(-7e3)
    assert load.live[:, 2].sum() == pytest.approx(-1e3)
    assert not load.live[:, :2].any()
    # Both are dead loads, and masses, of a push.
    assert push.dead[:, 2].sum() == pytest.approx(-8e3)
    assert push.live[:, 0].sum() == pytest.approx(8e3)
    check_loads_in("report", load, CORBEL, placed)


def stones_of(thrust: float) -> cp.LimitState:
    stones = cp.derive_blocks(WALL)
    load = loaded(cp.LoadCase((0, 1, 0)), stones, [cp.LineLoad("wall", thrust=thrust, toward="+y")])
    return cp.limit_analysis(stones, cp.find_contacts(stones), load, friction=0.7)


def shell_of(load: cp.LoadCase, thrust: float) -> cp.ShellLimitState:
    stones, shell = cp.derive_blocks(WALL), cp.derive_shell(WALL, element_size=0.4)
    carried = [cp.LineLoad("wall", thrust=thrust, toward="+y", name="rafters")]
    return cp.shell_limit_analysis(shell, shell_loaded(load, shell, stones, carried), [cp.JointStrength("default", 0.7)])


@pytest.mark.parametrize("model", ["stones", "shell"])
def test_as_a_dead_load_it_is_carried_until_the_load_factor(model: str) -> None:
    analysed: Callable[[float], cp.LimitState | cp.ShellLimitState] = stones_of
    stones = cp.derive_blocks(WALL)
    factor = 0.7 / 8 * stones.weight[~stones.fixed].sum() / 3e3
    if model == "shell":
        factor = shell_of(cp.LoadCase(multiplies=["rafters"]), 1e3).load_factor
        analysed = partial(shell_of, cp.LoadCase((0, 1, 0)))
    assert analysed(0.999e3 * factor).status == "optimal"
    assert analysed(1.001e3 * factor).status == "unstable"


def test_no_earthquake_is_checked_and_the_mechanism_is_measured_along_the_load() -> None:
    load = loaded(GROWING, CORBEL, [AXLE])
    state = cp.limit_analysis(CORBEL, cp.find_contacts(CORBEL), load, friction=0.7)
    check = safety(CORBEL, state, load, Site(ground_acceleration=1.5, soil_factor=1.2))
    assert check.message.startswith("the load pushes no weight")
    assert check.satisfied is None
    assert stone_parts(CORBEL, state, load) == {}
    record = record_of(state, load, [cp.JointStrength("default", 0.7)])
    assert (record.load, record.multiplies, record.direction) == ("axle", ("axle",), (0.0, 0.0, 0.0))
    # A section on earthquakes would be about nothing, unless the case asks for them.
    assert check_table([Row(replace(record, check=replace(check, a_g=np.nan)))]) is None
    shown = check_table([Row(replace(record, check=check))])
    assert shown is not None
    assert shown["refused"][0][1] == check.message
    assert factor_words([record], OF_PUSH)[0] == "load factor of axle: how many times it is carried, 1 as it is given"


@pytest.mark.parametrize(
    ("load", "loads", "said"),
    [
        (cp.LoadCase(multiplies=["axel"]), [AXLE], "load axel: multiplies: no such load; found axel; expected axle"),
        (GROWING, [cp.PointLoad(at=(2.6, 0.5, 1.5), mass=1e3, name="axle")], "a mass alone, which nothing pushes"),
    ],
    ids=["unknown", "mass"],
)
def test_nothing_to_multiply(load: cp.LoadCase, loads: list[cp.PointLoad], said: str) -> None:
    with pytest.raises(InputError, match=said):
        loaded(load, CORBEL, loads)


def test_what_was_never_given_to_a_load_is_told_by_both_models() -> None:
    with pytest.raises(InputError, match=r"load axle: nothing is pushed; .* churchpipe\.loaded gives it"):
        cp.limit_analysis(CORBEL, cp.find_contacts(CORBEL), GROWING, friction=0.7)
    shell = cp.derive_shell(WALL, element_size=1.0)
    with pytest.raises(InputError, match=r"load axle: nothing is pushed; expected loads named axle\. churchpipe\.shell_loaded"):
        cp.shell_limit_analysis(shell, GROWING, [cp.JointStrength("default", 0.7)])


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"direction": (1, 0, 0), "multiplies": ["axle"]}, "two loads in one"),
        ({"multiplies": []}, "nothing grows"),
        ({"multiplies": ["axle"], "panels": ["wall"]}, "no weight is pushed"),
        ({}, "nothing is pushed"),
    ],
)
def test_contradictions(keys: dict[str, object], said: str) -> None:
    with pytest.raises(InputError, match=said):
        cp.LoadCase(**keys)


def test_a_case_names_what_is_multiplied(tmp_path: Path) -> None:
    file = tmp_path / "bridge.toml"
    file.write_text(CASE)
    (load,) = read_case(file).loads
    assert (load.name, load.multiplies) == ("axle", ("axle",))
    assert load_table(load, defaults=False) == {"name": "axle", "multiplies": ["axle"]}
    file.write_text(CASE.replace('["axle"]', '["axel"]'))
    with pytest.raises(InputError, match=r'line 18, load\.0\.multiplies: no such load; found axel; .* Did you mean "axle"'):
        read_case(file)
    file.write_text(CASE.replace('multiplies = ["axle"]', ""))
    with pytest.raises(InputError, match=r"load\.0: nothing is pushed; .*expected a direction, .* multiplies"):
        read_case(file)


def test_a_drawing_keeps_it() -> None:
    properties = encode_loads([GROWING])
    assert json.loads(properties[0][1])["multiplies"] == ["axle"]
    _, (load,), findings = decode_properties(properties)
    assert not findings
    assert (load.name, load.multiplies, load.direction.any()) == ("axle", ("axle",), False)
