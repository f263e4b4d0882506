"""The Python interface: what is drawn, followed or gone on from is of the right kind, and of the right stones."""

from collections.abc import Callable
from typing import Any, cast

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.errors import InputError
from solids import box, on_ground


def column(width: float) -> cp.Assemblage:
    """Return a stone .5 m high on the ground and a stone 1 m high on it."""
    return on_ground(box((0, width), (0, 1), (0, 0.5)), box((0, width), (0, 1), (0.5, 1.5)), unit_weight=2e4, reach=3)


STONES = column(0.5)
CONTACTS = cp.find_contacts(STONES)
PUSH = cp.LoadCase([1, 0, 0])
WIDTH = cp.SampledParameter(("width",), "normal", mean=0.5, standard_deviation=0.05)
FORCES = np.zeros((len(CONTACTS.point), 3))
POINTS = cp.sample_points([WIDTH], 4)


def curve(stones: cp.Assemblage = STONES, contacts: cp.Contacts = CONTACTS, **options: Any) -> cp.BlockCapacityCurve:
    return cp.block_pushover(stones, contacts, PUSH, 0.6, **options)


def report(results: list[Any]) -> None:
    cp.write_report("never.html", STONES, CONTACTS, results, materials=[])


def parameter(**numbers: Any) -> cp.SampledParameter:
    return cp.SampledParameter(
        **({"key": ("width",), "distribution": "normal", "mean": 0.5, "standard_deviation": 0.1} | numbers)
    )


def tie(**changed: Any) -> cp.Tie:
    return cp.Tie("t", (0, 0, 1), (1, 0, 1), strength=1e3, **changed)


def line(**changed: Any) -> cp.ThrustLine:
    return cp.thrust_line(STONES, CONTACTS, FORCES, "", **changed)


def ranked(**options: Any) -> tuple[cp.RankedTie, ...]:
    rod = cp.Tie("rod", (0.25, 0.5, 0.2), (0.25, 0.5, 1.2), (0, 2), strength=1e3)
    return cp.rank_ties(cp.limit_analysis(STONES, CONTACTS, PUSH, 0.6), [rod], STONES, CONTACTS, PUSH, 0.6, **options)


def verified(**options: Any) -> cp.Sensitivities:
    rates = cp.sensitivities(cp.limit_analysis(STONES, CONTACTS, PUSH, 0.6), STONES, CONTACTS, PUSH)
    return cp.verify_gains(rates, STONES, CONTACTS, PUSH, 0.6, **options)


def crushed(stones: cp.Assemblage, **options: Any) -> cp.LimitState:
    return cp.limit_analysis(stones, cp.find_contacts(stones), PUSH, 0.6, compressive_strength=1e6, **options)


PAIR = [box((0, 1), (0, 1), (0, 1)), box((0, 1), (0, 1), (2, 3))]
LOOSE, APART, GROUND = (cp.Assemblage.from_polyhedra(PAIR, 2e4, fixed=held) for held in ([], [0], [0, 1]))
AT = cp.PointLoad(at=(0.5, 0.5, 3.0), dead=1e3)
CALLS: list[tuple[Callable[[], Any], str]] = [
    (lambda: parameter(key="width"), r"parameter: key: wrong kind; found 'width'; expected a list of str"),
    (lambda: parameter(key=()), r"parameter: key: nothing varies; expected a key of the case, or several"),
    (lambda: parameter(distribution="nromal"), r"parameter: distribution: unknown value; found nromal; expected \"normal\" or"),
    (lambda: parameter(distribution=None), r"parameter: distribution: unknown value; found None"),
    (lambda: parameter(mean="0.5"), r"parameter: mean: not a number; found '0\.5'"),
    (lambda: parameter(standard_deviation=np.nan), r"parameter: standard_deviation: out of range; found nan"),
    (lambda: parameter(low=-np.inf), r"parameter: low: out of range; found -inf; expected a finite number"),
    (lambda: cp.sample_points([WIDTH], 4, method=cast("Any", "latin")), r"sample_points: method: unknown value; found latin"),
    (lambda: cp.sample_points([WIDTH], -1), r"sample_points: number: out of range; found -1; expected a whole number from 1 to"),
    (lambda: cp.sample_points([WIDTH], 10**30), r"sample_points: number: out of range; .* a whole number from 1 to 1000000"),
    (lambda: cp.sample_points([WIDTH], cast("Any", "4")), r"sample_points: number: not a number; found '4'"),
    (lambda: cp.sample_points([WIDTH], 4, seed=-1), r"sample_points: seed: out of range; found -1"),
    (lambda: cp.sample_points([], 4), r"sample_points: parameters: nothing varies"),
    (lambda: cp.sample_points(cast("Any", WIDTH), 4), r"sample_points: parameters: wrong kind; found SampledParameter"),
    (lambda: cp.sample_points(cast("Any", ["width"]), 4), r"sample_points: parameters\[0\]: wrong kind; found 'width'"),
    (lambda: cp.assess_uncertainty(cast("Any", "x"), np.ones(4)), r"assess_uncertainty: points: not numbers; found 'x'"),
    (lambda: cp.assess_uncertainty(POINTS * np.nan, np.ones(4)), r"assess_uncertainty: points: not a finite number at index"),
    (lambda: cp.assess_uncertainty(POINTS, cast("Any", [1j] * 4)), r"assess_uncertainty: load_factors: not numbers"),
    (lambda: cp.assess_uncertainty(POINTS, np.ones(3)), r"assess_uncertainty: load_factors: wrong shape; found \(3,\)"),
    (lambda: cp.thrust_range(STONES, CONTACTS, [0], cast("Any", "x")), r"thrust_range: direction: not numbers; found 'x'"),
    (lambda: cp.outward_load(STONES, cast("Any", (0, 0, 0))), r"outward_load: axis: wrong shape; found \(3,\)"),
    (lambda: cp.outward_load(STONES, (np.inf, 0)), r"outward_load: axis: not a finite number"),
    (lambda: cp.load_from_above(STONES, cast("Any", "x"), 1.0), r"load_from_above: place: not numbers; found 'x'"),
    (lambda: cp.minimum_thickness(column, cast("Any", 0.1), cast("Any", None)), r"minimum_thickness: high: not a number"),
    (lambda: tie(ultimate=None), r"tie t: ultimate elongation: not a number; found None"),
    (lambda: tie(ultimate=np.nan), r"tie t: ultimate elongation: out of range; found nan"),
    (lambda: tie(governs=3), r"tie t: governs: not a text; found 3"),
    (lambda: tie(anchors=()), r"tie t: anchors: not two anchors; found 0; expected one at each end"),
    (lambda: tie(anchors=3), r"tie t: anchors: wrong kind; found 3; expected a list of Anchor"),
    (lambda: cp.limit_analysis(STONES, CONTACTS, PUSH, ties=cast("Any", np.array(0.5))), r"ties: wrong kind; found ndarray"),
    (lambda: cp.limit_analysis(STONES, CONTACTS, PUSH, flow=cast("Any", np.ones(2))), r"flow: unknown value; found ndarray"),
    (lambda: curve(state=3), r"block_pushover: state: wrong kind; found 3; expected a LimitState"),
    (lambda: curve(resume="x"), r"block_pushover: resume: wrong kind; found 'x'; expected a BlockCapacityCurve"),
    (
        lambda: cp.settlement_path(STONES, CONTACTS, [0], (0, 0, -1), resume=cast("Any", 3)),
        r"settlement_path: resume: wrong kind; found 3; expected a SettlementPath",
    ),
    (lambda: cp.with_fill(PUSH, STONES, cast("Any", 3), 1.0, 1e4), r"with_fill: panels: wrong kind; found 3"),
    (lambda: cp.with_fill(PUSH, STONES, "", 2.0, 1e4, cast("Any", 3)), r"with_fill: contacts: wrong kind; found 3"),
    (lambda: verified(cohesion="x"), r"cohesion: not numbers; found 'x'"),
    (lambda: verified(cohesion=np.ones(7)), r"cohesion: wrong shape; found \(7,\)"),
    (lambda: cp.check_soundness(STONES, CONTACTS, cast("Any", 3)), r"check_soundness: progress: not a function; found 3"),
    (lambda: cp.write_obj(cast("Any", None), "a.obj"), r"write_obj: assemblage: wrong kind; found None; .* derive_blocks"),
    (lambda: cp.write_obj(STONES, cast("Any", None)), r"write_obj: path: not a path; found None"),
    (lambda: cp.write_obj(STONES, "a\0b.obj"), r"write_obj: path: not a path; found 'a\\x00b\.obj'"),
    (lambda: cp.write_obj(STONES, "\ud800.obj"), r"write_obj: path: not a path; found '\\ud800\.obj'"),
    (lambda: cp.write_obj(STONES, "."), r"write_obj: the file cannot be written; found a folder of this name"),
    (lambda: cp.write_dxf(STONES, "a.dxf", units=cast("Any", np.ones(2))), r"units: not a unit drawings are written in"),
    (lambda: cp.generators.generate("wal", {}, (), "w"), r'generate: generator: unknown value; found wal; expected "wall" or'),
    (lambda: cp.generators.wall(length=1.2, brick=np.array(0.4), courses=3), r"wall.brick: not a list; found ndarray"),
    (lambda: cp.place_loads(STONES, cast("Any", np.array(0.5))), r"place_loads: loads: not a list; found ndarray"),
    (lambda: cp.Buttress("w", (1.0,), "+x", 0.5, cast("Any", None)), r"buttress of w: depth: not a number; found None"),
    (lambda: cp.Buttress("w", (1.0,), "+x", 0.5, 0.5, name=cast("Any", 3)), r"buttress of w: name: not a text; found 3"),
    (lambda: cp.RingBeam(("w",), cast("Any", None)), r"ring beam w: height: not a number; found None"),
    (lambda: cp.RingBeam(("w",), 0.3, name=cast("Any", np.ones(2))), r"ring beam: name: not a text; found ndarray"),
    (lambda: cp.RingBeam(("w",), 0.3, material=cast("Any", None)), r"ring beam: material: not a text; found None"),
    (lambda: cp.Fill(("v",), 1e4, 1.0, name=cast("Any", np.ones(2))), r"fill: name: not a text; found ndarray"),
    (lambda: cp.LineLoad("w", dead=1e3, eccentricity=cast("Any", np.ones(2))), r"line load w: eccentricity: not a number"),
    (lambda: cp.PointLoad("w", 1.0, dead=1e3, eccentricity=cast("Any", np.ones(2))), r"point load w: eccentricity: not a number"),
    (lambda: cp.Buttress("w", [1.0], cast("Any", []), 0.5, 0.5), r"buttress of w: toward: no side; found \[\]; expected \+x"),
    (lambda: cp.save(STONES, cast("Any", None)), r"save: path: not a path; found None"),
    (lambda: line(direction="x"), r"thrust_line: direction: not numbers; found 'x'"),
    (lambda: line(direction=(np.nan, 1)), r"thrust_line: direction: not a finite number at index \[0\]"),
    (lambda: line(direction=(1, 0, 0)), r"thrust_line: direction: wrong shape; found \(3,\); expected \(2\)"),
    (lambda: line(direction=(0, 0)), r"thrust_line: direction: no direction; found \[0\.0, 0\.0\]"),
    (lambda: line(through=None), r"thrust_line: through: not numbers; found None"),
    (lambda: line(through=(0, np.nan)), r"thrust_line: through: not a finite number at index \[1\]"),
    (lambda: ranked(ties=None), r"rank_ties: ties: wrong kind; found None; expected a list of Tie"),
    (lambda: crushed(STONES, crushing_parts=10**9), r"crushing_parts: out of range; .* a whole number from 2 to 64"),
    (lambda: crushed(APART), r"stones: no path of contacts to a support; found B1"),
    (lambda: cp.joint_strength(GROUND, cp.find_contacts(GROUND), []), r"joint_strength: stones: every stone is fixed"),
    (lambda: cp.place_loads(GROUND, [AT]), r"point load: no stone under it"),
    (lambda: cp.settlement_analysis(LOOSE, cp.find_contacts(LOOSE), [0]), r"support: a stone that is free; .* there are none"),
    (lambda: cp.thrust_line(STONES, CONTACTS, FORCES, cast("Any", 3)), r"panels: wrong kind; found 3; expected a list of str"),
    (lambda: report(cast("Any", 3)), r"write_report: results: not a list; found 3; expected a list of pairs"),
    (lambda: report([cast("Any", (PUSH,))]), r"write_report: results\[0\]: not a pair; found 1 entry; expected a load case and"),
    (lambda: report([cast("Any", PUSH)]), r"write_report: results\[0\]: wrong kind; found LoadCase"),
    (lambda: cp.with_buttresses(cast("Any", None), ()), r"with_buttresses: building: wrong kind; found None"),
]


@pytest.mark.parametrize(("call", "said"), CALLS)
def test_what_is_wrong_is_named(call: Callable[[], Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        call()


def test_a_tie_without_end_of_its_elongation_never_breaks() -> None:
    assert tie(ultimate=np.inf).ultimate == np.inf


def test_the_steps_of_other_stones_are_not_gone_on_from() -> None:
    """As many stones, in other places: their motion says nothing of these."""
    other = column(0.6)
    begun = curve(other, cp.find_contacts(other), steps=3)
    with pytest.raises(InputError, match=r"block_pushover: resume: steps of other stones; .* from where stone B1 is"):
        curve(resume=begun)
    again = curve(other, cp.find_contacts(other), resume=begun, steps=4)
    assert len(again.load_factor) == 4


def test_whole_numbers_may_be_floats() -> None:
    """As they come from a column of a table."""
    np.testing.assert_array_equal(cp.sample_points([WIDTH], 4, seed=cast("Any", 1.0)), cp.sample_points([WIDTH], 4, seed=1))
    assert len(ranked(verify=1.0)) == 1
    assert crushed(STONES, crushing_parts=np.int64(8)).load_factor == crushed(STONES).load_factor


@pytest.mark.parametrize("length", [1e-300, 1.0, 1e200])
def test_the_length_of_the_direction_of_a_support_changes_nothing(length: float) -> None:
    moved = cp.settlement_analysis(STONES, CONTACTS, [0], (0, 0, -length), friction=0.6)
    # What stands on it: two stones .5 m and 1 m high, .5 m2 in plan.
    assert moved.reaction == pytest.approx(1.5 * 0.5 * 2e4, rel=1e-6)
